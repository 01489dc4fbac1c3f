"""What folded chains bear: symmetry, scale, what is what, planted faults and refusals."""

from contextlib import suppress
from itertools import permutations, product

import numpy as np
import pytest
from examples import examples
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar
from scipy.sparse.linalg import splu
from strands import LEANING, boustrophedon, level, path, walk

import lineup as lu
from lineup.stress import dissection, faces, measured, network, solving
from lineup.stress.contacts import table_points
from lineup.stress.results import (
    BUCKLING_N,
    RESIN_PA,
    TENSION_PA,
    Setting,
    shortfall,
    summary,
)
from lineup.stress.support import upward

# Symmetry and scale


TURNS = [
    np.eye(3, dtype=int)[list(order)] * np.array(signs)[:, None]
    for order in permutations(range(3))
    for signs in product((1, -1), repeat=3)
]


@pytest.mark.parametrize("turn", TURNS[1::5], ids=str)
@pytest.mark.parametrize("bonding", ["velcro", "none"])
def test_turned_and_mirrored_it_bears_the_same(turn, bonding):
    voxels = boustrophedon(4, 2, 2)
    before = lu.strength(path(voxels), bonding=bonding, up=(0, 0, 1))
    up = tuple((turn @ (0, 0, 1)).tolist())
    after = lu.strength(path(voxels @ turn.T + (5, -3, 9)), bonding=bonding, up=up)
    columns = ["normal_n", "shear_n", "moment_nmm", "torsion_nmm", "traction_pa"]
    keys = ["kind", "first", "second"]
    a, b = (r.table.sort_values(keys)[columns].to_numpy(float) for r in (before, after))
    np.testing.assert_allclose(a, b, rtol=1e-6, atol=1e-6 * np.abs(a).max())
    assert after.safety == pytest.approx(before.safety, rel=1e-6)
    assert after.margin_mm == pytest.approx(before.margin_mm)


def test_stress_grows_with_density_and_pitch():
    shape = LEANING
    one = lu.strength(shape, None, 10, density=1000)
    other = lu.strength(shape, None, 25, density=3000)
    for name in ("traction_pa", "tension_pa", "compression_pa"):
        np.testing.assert_allclose(other.table[name], 7.5 * one.table[name], rtol=1e-9)
    np.testing.assert_allclose(other.table["normal_n"], 7.5 * 2.5**2 * one.table["normal_n"])
    np.testing.assert_allclose(other.sag_mm, 7.5 * 2.5 * one.sag_mm)


def test_young_s_modulus_sets_the_sag_alone():
    a, b = (lu.strength(LEANING, young_pa=e) for e in (1e9, 4e9))
    assert a.sag_mm == pytest.approx(4 * b.sag_mm)
    assert a.table.equals(b.table)


@pytest.mark.parametrize("bonding", ["velcro", "none", "solid"])
def test_the_safety_factor_is_that_by_which_loads_may_grow(bonding):
    shape = path(boustrophedon(6, 3, 3))
    first = lu.strength(shape, bonding=bonding)
    again = lu.strength(shape, bonding=bonding, density=1130 * first.safety)
    assert again.safety == pytest.approx(1)
    row = again.table.iloc[again.worst]
    strong = row["kind"] in ("printed", "held")
    loads = [
        row["tension_pa"] / (RESIN_PA if strong else TENSION_PA),
        row["compression_pa"] / RESIN_PA,
        -row["normal_n"] / BUCKLING_N,
    ]
    assert np.nanmax(loads) == pytest.approx(1)
    heavier = lu.strength(shape, bonding=bonding, density=1131 * first.safety)
    assert shortfall(heavier).endswith("gives way, at a safety factor of 0.999")
    assert shortfall(first) == ""


# What is what


def test_kinds_of_faces():
    voxels = boustrophedon(2, 2, 1)
    kinds = lu.strength(path(voxels)).table[["kind", "first", "second", "direction"]]
    assert kinds.values.tolist() == [
        ["hinge", 0, 1, "E"],
        ["velcro", 0, 3, "N"],
        ["printed", 1, 2, "N"],
        ["hinge", 2, 3, "W"],
        *(["table", k, -1, "D"] for k in range(4)),
    ]
    odd = measured.measured(voxels, Setting(), start=7).table
    assert odd[["kind", "first", "second"]].values.tolist()[:2] == [
        ["printed", 7, 8],
        ["velcro", 7, 10],
    ]
    shares = faces.inner_faces(voxels, lu.Bonding(0.9, 0.4, 0.2))
    assert shares.share.tolist() == [0.4, 0.2, 0.9, 0.4]


@given(st.integers(0, 10**6), st.integers(2, 30))
def test_faces_are_all_that_touch(seed, length):
    voxels = walk(seed, length, (3, 3, 3))
    if len(voxels) < 2:
        return
    found = faces.inner_faces(voxels, lu.Bonding())
    apart = np.abs(voxels[:, None] - voxels).sum(axis=2)
    expected = np.argwhere(np.triu(apart == 1))
    assert np.array_equal(np.stack([found.first, found.second], axis=1), expected)
    assert np.array_equal(voxels[found.second] - voxels[found.first], found.normal)


def test_points_of_a_face_carry_an_even_pressure_and_a_slope_exactly():
    points = table_points(np.array([(0, 0, 0)]), upward("+z"))
    assert points.share.sum() == pytest.approx(faces.AT_SUPPORT)
    second = (points.share[:, None] * points.arm**2).sum(axis=0)
    np.testing.assert_allclose(second[:2], faces.AT_SUPPORT / 12)
    assert np.abs(points.arm[:, :2]).max() == 0.5


def test_the_path_counts_not_the_solid():
    solid = lu.VoxelSolid(np.ones((4, 2, 1), bool), name="plate")
    result = lu.strength(path(boustrophedon(3, 2, 1)), solid)
    assert result.name == "plate"
    assert len(result.voxels) == 6
    assert summary(result)["on_table"] == 6


def test_a_sag_beyond_the_model_is_told():
    soft = lu.strength(level(12), held="-x", young_pa=1e5)
    assert soft.sag_mm > 10
    assert soft.safety > 1
    assert soft.reason.startswith("held at -x, but sags by ")
    assert shortfall(soft) == soft.reason


# Solvers


def system(voxels, bonding):
    """The stiffness of a body on a table where all points push, and its weight."""
    caught = []

    def catch(stiffness, load, contact, share, _):
        caught.append(((stiffness + contact.T @ contact.multiply(share[:, None])).tocsr(), load))
        return np.zeros(len(load)), np.zeros(len(share))

    with pytest.MonkeyPatch.context() as patch, suppress(ArithmeticError):
        patch.setattr(measured, "balanced", catch)
        lu.strength(path(voxels), bonding=bonding)
    return caught[0]


@pytest.mark.parametrize("small", [8, 24])
@pytest.mark.parametrize("bonding", sorted(faces.BONDINGS))
def test_factors_of_parts_solve_the_system(bonding, small, monkeypatch):
    """Against SuperLU; a body of several parts, with a gap that a cut finds."""
    monkeypatch.setattr(dissection, "SMALL", small)
    voxels = boustrophedon(7, 5, 4)
    voxels = np.vstack([voxels, voxels[-1:] + [(0, 0, k) for k in range(1, 30)]])
    matrix, load = system(voxels, bonding)
    found = dissection.factorized(dissection.dissected(voxels, matrix), matrix)(load)
    expected = splu(matrix.tocsc()).solve(load)
    np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-9 * np.abs(expected).max())


@examples(260)
@given(st.integers(0, 10**6), st.integers(10, 60))
def test_parts_are_cut_apart(seed, length):
    voxels = walk(seed, length, (5, 4, 5))
    if len(voxels) < 2:
        return
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(dissection, "SMALL", 8)
        inner = faces.inner_faces(voxels, lu.Bonding())
        ties = network.stretch(inner, len(voxels))
        found = dissection.dissected(voxels, (ties.T @ ties).tocsr())
    assert sorted(found.order) == list(range(len(voxels)))
    part_of = np.repeat(range(len(found.parts)), [p.stop - p.start for p in found.parts])
    above = {k: number for number, part in enumerate(found.parts) for k in part.below}
    place = np.argsort(found.order)
    for pair in zip(inner.first, inner.second, strict=True):
        low, high = sorted(int(part_of[place[v]]) for v in pair)
        while low < high:
            low = above[low]  # what touches is in one line of parts
        assert low == high


def test_what_is_not_positive_definite_has_no_cholesky_factors():
    voxels = boustrophedon(4, 4, 3)
    matrix, _ = system(voxels, "velcro")
    with pytest.raises(np.linalg.LinAlgError):
        dissection.factorized(dissection.dissected(voxels, matrix), -matrix)


@pytest.mark.parametrize("bonding", ["none", "solid"])
def test_factors_that_serve_for_several_steps_lead_to_the_same(bonding, monkeypatch):
    shape = path(boustrophedon(6, 5, 3))
    often = lu.strength(shape, bonding=bonding)
    again = lu.strength(shape, bonding=bonding)
    assert often.table.equals(again.table)
    monkeypatch.setattr(
        solving,
        "_near",
        lambda held, load, _: (splu(solving.whole(held).tocsc()).solve(load), True),
    )
    plain = lu.strength(shape, bonding=bonding)
    a, b = (r.table["tension_pa"].dropna().to_numpy() for r in (often, plain))
    np.testing.assert_allclose(a, b, atol=1e-6 * a.max())


@given(st.integers(0, 10**6), st.integers(0, 12))
def test_a_step_goes_as_far_as_the_energy_falls(seed, points):
    """Against a search along the step; half of the points are just open or just closed."""
    rng = np.random.default_rng(seed)
    gap, lift = rng.normal(size=(2, points)).round(1)
    gap[: points // 2] = 0
    share, own = rng.uniform(0.1, 9, points), rng.uniform(0.1, 2)
    pull = rng.uniform(0.1, 5) - float((share * np.minimum(gap, 0)) @ lift)
    assume(pull > 0)

    def energy(t):
        return own * t**2 / 2 + float(share @ np.minimum(gap + t * lift, 0) ** 2) / 2

    start = -pull - float((share * np.minimum(gap, 0)) @ lift)
    far = minimize_scalar(lambda t: energy(t) + start * t, bounds=(0, 100), method="bounded")
    found = solving.length(pull, own, gap, lift, share)
    assert energy(found) + start * found <= far.fun + 1e-9


def test_no_end_is_an_error_and_not_a_result(monkeypatch):
    monkeypatch.setattr(solving, "_STEPS", 1)
    with pytest.raises(ArithmeticError, match="no balance found in 1 steps"):
        lu.strength(LEANING, bonding="solid")


FAULTS = {
    "a lever on the wrong side": (network, "_at", lambda arm, own=network._at: own(-arm)),
    "half a lever": (network, "_at", lambda arm, own=network._at: own(arm / 2)),
    "forces a thousandth too large": (
        measured,
        "face_forces",
        lambda *a, own=network.face_forces: tuple(1.001 * part for part in own(*a)),
    ),
    "no moments": (
        measured,
        "face_forces",
        lambda *a, own=network.face_forces: (own(*a)[0], 0 * own(*a)[1]),
    ),
    "weight to the side": (
        measured,
        "weights",
        lambda n, up, own=network.weights: own(n, np.roll(up, 1)),
    ),
    "half the weight": (
        measured,
        "weights",
        lambda n, up, own=network.weights: own(n, up) / 2,
    ),
}


@pytest.mark.parametrize("fault", sorted(FAULTS))
def test_faults_in_the_solution_are_caught(fault, monkeypatch):
    monkeypatch.setattr(*FAULTS[fault])
    with pytest.raises(ArithmeticError):
        lu.strength(path(boustrophedon(4, 3, 2)), bonding="velcro")


# Refusals


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"pitch_mm": 0}, "pitch_mm must be positive, got 0"),
        ({"density": float("nan")}, "density must be positive"),
        ({"young_pa": -1}, "young_pa must be positive"),
        ({"bonding": "glue"}, "unknown bonding 'glue'; known: .*'none'.*'velcro'"),
        ({"up": "z"}, "up must be one of .* got 'z'"),
        ({"up": (0, 0, 0)}, "up must be one of"),
        ({"held": "floor"}, "a side must be one of .* got 'floor'"),
    ],
)
def test_bad_options_are_refused(options, words):
    with pytest.raises(ValueError, match=words):
        lu.strength(level(3), **options)


@pytest.mark.parametrize("shares", [{"hinge": 0}, {"printed": np.inf}, {"velcro": -0.1}])
def test_bad_bondings_are_refused(shares):
    with pytest.raises(ValueError, match="printed and hinge must be positive"):
        lu.Bonding(**shares)


@pytest.mark.parametrize(
    ("voxels", "words"),
    [
        ([(0, 0, 0)], "2 or more voxels, got 1"),
        ([(0, 0, 0), (1, 1, 0)], "voxels 0 and 1 of the path do not share a face"),
        ([(0, 0, 0), (1, 0, 0), (0, 0, 0)], "visits a voxel twice"),
    ],
)
def test_what_is_no_chain_is_refused(voxels, words):
    with pytest.raises(ValueError, match=words):
        lu.strength(path(voxels))


def test_a_path_of_another_solid_is_refused():
    solid = lu.VoxelSolid(np.ones((3, 2, 1), bool))
    with pytest.raises(ValueError, match=r"voxel 3 of the path, \(3, 0, 0\), is not in the solid"):
        lu.strength(level(5), solid)
