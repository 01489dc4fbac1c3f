"""What folded chains bear: statics, beams, balance, and tables that only push."""

import numpy as np
import pytest
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st
from strands import LEANING, TRIPOD, level, path, walk

import lineup as lu
from lineup.stress import BONDINGS, measured, network, solving
from lineup.stress.dissection import dissected
from lineup.stress.results import GRAVITY, shortfall, summary
from lineup.stress.support import level_axes, tip_margin, upward

PASCAL = 1130 * GRAVITY * 0.01  # the weight of a voxel over its face, at 10 mm
NEWTON = PASCAL * 1e-4


def upright(n):
    return path([(0, 0, z) for z in range(n)])


def forces(result):
    """(F, 3) force and torque of each row, in voxel weights and voxels, and the rows' middles."""
    newton, pitch = result.setting.newton, result.setting.pitch_mm
    middle = result.table[["x", "y", "z"]].to_numpy(float)
    return result.force_n / newton, result.torque_nmm / (newton * pitch), middle


def unbalanced(result):
    """(n, 6) what is left on each voxel, summed anew from the rows of the table."""
    n, (force, torque, middle) = len(result.voxels), forces(result)
    left = np.zeros((n, 6))
    left[:, :3] = -upward(result.setting.up)
    for row, (first, second) in enumerate(result.table[["first", "second"]].to_numpy(int)):
        for voxel, sign in ((first, 1), (second, -1)):
            if voxel >= 0:
                arm = middle[row] - result.voxels[voxel]
                left[voxel, :3] += sign * force[row]
                left[voxel, 3:] += sign * (torque[row] + np.cross(arm, force[row]))
    return left


# Closed forms


@pytest.mark.parametrize("bonding", sorted(BONDINGS))
@pytest.mark.parametrize(("pitch_mm", "density"), [(10, 1130), (3.5, 2000)])
def test_a_hanging_column_bears_what_is_below_it(bonding, pitch_mm, density):
    result = lu.strength(upright(9), None, pitch_mm, density=density, bonding=bonding, held="+z")
    weight = density * GRAVITY * (pitch_mm / 1e3) ** 3
    expected = weight * np.arange(1, 10)
    np.testing.assert_allclose(result.table["normal_n"], expected, rtol=1e-9)
    area = (pitch_mm / 1e3) ** 2
    np.testing.assert_allclose(result.table["traction_pa"], expected / area, rtol=1e-9)
    assert result.mass_kg == pytest.approx(9 * weight / GRAVITY)
    assert result.reason == "held at +z"


def test_a_standing_column_bears_what_is_above_it():
    table = lu.strength(upright(7)).table
    inner = table[table["kind"] != "table"]
    np.testing.assert_allclose(inner["normal_n"], -NEWTON * np.arange(6, 0, -1), rtol=1e-9)
    ground = table[table["kind"] == "table"]
    assert ground["direction"].tolist() == ["D"]
    np.testing.assert_allclose(ground["normal_n"], [-7 * NEWTON], rtol=1e-9)
    assert (table["moment_nmm"] < 1e-9).all()


def test_a_column_shortens_as_its_springs_say():
    result = lu.strength(upright(6), bonding="solid", held="-z")
    # The top comes down by what each face gives: half a voxel at the wall, one each above.
    given_way = 6 / 2 + sum(range(1, 6))
    assert result.sag_mm == pytest.approx(given_way * PASCAL / 2.6e9 * 10, rel=1e-9)


@pytest.mark.parametrize("n", [1, 4, 19])
def test_a_cantilever_one_voxel_thick_has_the_moments_of_a_beam(n):
    table = lu.strength(level(n + 1), held="-x").table
    moment = NEWTON * 10 * np.append(np.arange(n, 0, -1) ** 2 / 2, (n + 1) ** 2 / 2)
    np.testing.assert_allclose(table["moment_nmm"], moment, rtol=1e-9)
    np.testing.assert_allclose(table["tension_pa"], 6 * moment / 1e3 * 1e6, rtol=1e-9)
    np.testing.assert_allclose(table["shear_n"][:-1], NEWTON * np.arange(n, 0, -1), rtol=1e-9)
    np.testing.assert_allclose(table["torsion_nmm"], 0, atol=1e-9)


def test_a_long_cantilever_bends_as_a_beam_does():
    n, x = 24, 23.5  # long, and where the centre of the last voxel is
    sag = lu.strength(level(n), bonding="solid", held="-x").sag_mm
    bending = 12 * x**2 * (6 * n**2 - 4 * n * x + x**2) / 24
    shear = 2 * (1 + network.POISSON) * (n * x - x**2 / 2)
    expected = (bending + shear) * PASCAL / 2.6e9 * 10
    assert sag == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize(("high", "off"), [(2, 0.01), (3, 0.013), (4, 0.022)])
def test_the_edge_stress_of_a_thick_cantilever_is_that_of_a_beam(high, off):
    """Sections 3 to 8 voxels from the wall, of a beam `high` voxels high and 20 long."""
    n = 20
    voxels = np.array([(x, 0, z) for z in range(high) for x in (range(n), range(n)[::-1])[z % 2]])
    table = lu.strength(path(voxels), bonding="solid", held="-x").table
    for x in range(3, 9):
        section = table[table["x"] == x + 0.5]
        assert len(section) == high
        moment = high * (n - 1 - x) ** 2 / 2
        expected = PASCAL * moment * (high / 2) / (high**3 / 12)
        assert section["tension_pa"].max() == pytest.approx(expected, rel=off)


def test_an_arm_twists_what_it_hangs_from():
    """A level bar from the wall with an arm to its side: torsion is the arm's moment, exactly."""
    voxels = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (2, 1, 0), (2, 2, 0), (2, 3, 0)]
    table = lu.strength(path(voxels), held="-x", bonding="chain").table
    np.testing.assert_allclose(table["torsion_nmm"][:2], NEWTON * 10 * 6, rtol=1e-9)


@settings(max_examples=25)
@given(st.integers(0, 10**6), st.integers(3, 20))
def test_the_chain_alone_bears_what_statics_says(seed, length):
    """No strand touches another, so each face bears all that lies beyond it on the chain."""
    voxels = walk(seed, length, (4, 4, 4))
    if len(voxels) < 2:
        return
    result = lu.strength(path(voxels), bonding="chain")
    if not result.stands:
        return
    table, (force, torque, middle) = result.table, forces(result)
    first = table["first"].to_numpy(int)
    ground = (table["kind"] == "table").to_numpy()
    for k in np.flatnonzero(~ground):
        beyond = ground & (first > first[k])
        loads = [(voxels[j], (0, 0, -1), (0, 0, 0)) for j in range(first[k] + 1, len(voxels))]
        loads += [(middle[j], force[j], torque[j]) for j in np.flatnonzero(beyond)]
        total = sum(np.asarray(load[1], float) for load in loads)
        moment = sum(np.cross(at - middle[k], f) + t for at, f, t in loads)
        np.testing.assert_allclose(force[k], total, atol=1e-6)
        np.testing.assert_allclose(torque[k], moment, atol=1e-6)


# Balance


@examples(80)
@given(
    st.integers(0, 10**6), st.sampled_from(sorted(BONDINGS)), st.sampled_from(["+z", "-y", "+x"])
)
def test_all_is_balanced_or_the_body_tips_over(seed, bonding, up):
    voxels = walk(seed, 24, (4, 3, 3))
    if len(voxels) < 2:
        return
    result = lu.strength(path(voxels), bonding=bonding, up=up)
    ground = result.table["kind"] == "table"
    if not result.stands:
        assert result.margin_mm <= 0
        assert result.safety == 0
        assert result.worst == -1
        assert np.isnan(result.force_n).all()
        return
    assert np.abs(unbalanced(result)).max() < 1e-6
    (force, torque, middle), axis = forces(result), upward(up)
    reaction, at = force[ground], middle[ground]
    np.testing.assert_allclose(reaction.sum(axis=0), len(voxels) * axis, atol=1e-6)
    moment = np.cross(at - result.centre, reaction).sum(axis=0) + torque[ground].sum(axis=0)
    np.testing.assert_allclose(moment, 0, atol=1e-6)
    assert (reaction @ axis >= -1e-12).all()
    assert np.abs(np.delete(reaction, int(np.abs(axis).argmax()), axis=1)).max() < 1e-12
    touching = result.table[result.table["kind"] == "touch"]
    assert (touching["normal_n"] <= 1e-12).all()
    assert (touching["shear_n"] <= 1e-12).all()
    assert (bonding == "none") or not len(touching)


@settings(max_examples=20)
@given(st.integers(0, 10**6))
def test_where_one_is_held_all_is_balanced_too(seed):
    voxels = walk(seed, 20, (3, 4, 3))
    if len(voxels) < 2:
        return
    result = lu.strength(path(voxels), held="+y", up=(1.0, -2.0, 0.5))
    assert np.abs(unbalanced(result)).max() < 1e-6
    assert (result.table["kind"] == "held").sum() == (voxels[:, 1] == voxels[:, 1].max()).sum()


def test_a_body_on_three_corners():
    result = lu.strength(TRIPOD, up=(1, 1, 1))
    ground = result.table[result.table["kind"] == "table"]
    assert result.stands
    assert ground["direction"].tolist() == ["", "", ""]
    assert ground["traction_pa"].isna().all()
    assert ground["normal_n"].sum() == pytest.approx(-len(TRIPOD) * NEWTON)
    assert np.abs(unbalanced(result)).max() < 1e-6
    corner = ground[["x", "y", "z"]].to_numpy(float)
    # Three points bear what levers say.
    axes = level_axes(upward((1, 1, 1)))
    levers = np.vstack([axes @ corner.T, np.ones(3)])
    borne = np.linalg.solve(levers, np.append(axes @ result.centre, 1.0)) * len(TRIPOD)
    np.testing.assert_allclose(-ground["normal_n"] / NEWTON, borne, rtol=1e-6)


# A table that only pushes


def test_what_would_lift_off_is_not_held_down():
    held = lu.strength(LEANING, bonding="solid", held="-z")
    assert held.table.loc[held.table["kind"] == "held", "normal_n"].max() > 0.1 * NEWTON
    result = lu.strength(LEANING, bonding="solid")
    ground = result.table[result.table["kind"] == "table"].set_index("first")["normal_n"]
    assert result.reason == "stands"
    assert ground.max() <= 0
    assert ground[[2, 3]].tolist() == [0, 0]  # the foot arches
    assert (ground[[0, 1, 4]] < 0).all()
    assert summary(result)["on_table"] == 3


def test_a_table_that_holds_down_is_caught(monkeypatch):
    """Planted: all points stay closed, so some pull."""

    def glued(stiffness, load, contact, share, voxels):
        held = stiffness + contact.T @ contact.multiply(share[:, None])
        u = solving.solver(held.tocsr(), dissected(voxels, held))(load)
        return u, np.maximum(-share * (contact @ u), 0)

    monkeypatch.setattr(measured, "balanced", glued)
    with pytest.raises(ArithmeticError, match="not balanced"):
        lu.strength(LEANING, bonding="solid")


@pytest.mark.parametrize("reach", range(1, 9))
def test_when_a_hook_tips_over(reach):
    """A post of three voxels with an arm: by hand."""
    hook = [(0, 0, 0), (0, 0, 1), (0, 0, 2)] + [(x, 0, 2) for x in range(1, reach + 1)]
    centre = reach * (reach + 1) / 2 / (3 + reach)
    result = lu.strength(path(hook))
    assert result.margin_mm == pytest.approx(10 * (0.5 - centre), abs=1e-9)
    assert result.stands == (centre < 0.5)
    if centre > 0.5:
        out = f"{10 * (centre - 0.5):.1f} mm outside of"
        assert result.reason == f"tips over: its centre of mass is {out} what it rests on"
        assert shortfall(result) == result.reason
    assert lu.strength(path(hook), held="-z").stands


def test_right_over_the_edge_is_no_balance():
    step = [(0, 0, 0), (0, 0, 1), (0, 0, 2), (1, 0, 2), (1, 0, 3), (1, 0, 4)]
    result = lu.strength(path(step))
    assert result.reason == "tips over: its centre of mass is on the edge of what it rests on"
    assert lu.strength(path(step[:-1])).stands


@given(st.integers(0, 10**6))
def test_the_margin_is_that_of_the_support_function(seed):
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 6, (int(rng.integers(1, 9)), 2)).astype(float)
    centre = rng.uniform(-1, 7, 2)
    angle = np.linspace(0, 2 * np.pi, 20_001)
    ways = np.stack([np.cos(angle), np.sin(angle)])
    expected = ((points @ ways).max(axis=0) - centre @ ways).min()
    assert tip_margin(points, centre) == pytest.approx(expected, abs=2e-3)


def test_without_velcro_strands_rest_on_each_other():
    """Two columns side by side and a lid: the lid's free end lies on the second column."""
    voxels = [(1, 0, 0), (0, 0, 0), (0, 0, 1), (0, 0, 2), (1, 0, 2), (1, 0, 1)]
    # The chain ends in (1, 0, 1), which touches (1, 0, 0) below and (0, 0, 1) beside.
    touching = lu.strength(path(voxels), bonding="none")
    alone = lu.strength(path(voxels), bonding="chain")
    rows = touching.table[touching.table["kind"] == "touch"].set_index(["first", "second"])
    assert rows.loc[(0, 5), "normal_n"] < -0.5 * NEWTON
    assert rows.loc[(2, 5), "normal_n"] == pytest.approx(0, abs=NEWTON)
    assert touching.sag_mm < alone.sag_mm
