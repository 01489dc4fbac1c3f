"""Orientations: the directions tried, the objective, the front, and that rows tell the truth."""

import numpy as np
import pandas as pd
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from matplotlib.figure import Figure

import lineup as lu
from lineup import cli, draw, headings, orientation

PENCIL = trimesh.creation.box((1.0, 1.0, 6.0))


@pytest.fixture(scope="module")
def table():
    """Eight evaluations: the axes, and two tilts of the best of them."""
    return lu.rank_orientations(PENCIL, voxels=48, evaluations=8, finalists=2, starts=1)


@pytest.fixture
def bricks(monkeypatch):
    """In place of solids and paths: bricks, the higher the more upright, none towards +x."""

    def fitted(surface, voxels, name, provenance):
        x, _, z = provenance["up"]
        if x > 0.9:
            raise ValueError("no such luck")
        brick = np.ones((2, 2, 2 + round(2 * abs(z))), bool)
        return lu.VoxelSolid(brick, source={"iou": round(0.7 + 0.2 * z, 3)})

    def whole(solid, seed, starts):
        return lu.VoxelPath(np.argwhere(solid.occupancy))

    monkeypatch.setattr(orientation, "fitted", fitted)
    monkeypatch.setattr(orientation, "layered_path", whole)


def test_rows_say_what_the_library_says(table):
    for row in (table.iloc[0], table.iloc[-1]):
        up = (row["up_x"], row["up_y"], row["up_z"])
        solid = lu.voxelize(PENCIL, voxels=48, up=up)
        walk = lu.traverse(lu.reeb_graph(solid))
        assert (row["voxels"], row["iou"]) == (solid.size, solid.source["iou"])
        assert row["mscs"] == len(walk.mscs)
        assert row["layered"] == lu.layered_path(solid, starts=1).coverage(solid)
        if row["folded"] == row["folded"]:
            assert row["folded"] == lu.fold(solid).path.coverage(solid)


def test_the_order_is_that_of_the_objective(table):
    terms = table[list(orientation.WEIGHTS)].astype(float).fillna(0.0)
    score = sum(weight * terms[name] for name, weight in orientation.WEIGHTS.items())
    np.testing.assert_allclose(table["score"], score)
    folded = table["folded"].notna()
    assert folded.tolist() == sorted(folded, reverse=True)
    assert folded.sum() == 2
    for part in (table[folded], table[~folded]):
        assert part["score"].is_monotonic_decreasing
    assert "upright" in set(table[folded]["kind"])


def test_the_budget_is_kept_and_no_direction_comes_twice(bricks):
    told = []
    found = lu.rank_orientations(
        PENCIL, evaluations=24, finalists=1, progress=lambda what, stage: told.append(stage)
    )
    assert len(found) == 24
    ups = found[["up_x", "up_y", "up_z"]].to_numpy(float)
    np.testing.assert_allclose(np.linalg.norm(ups, axis=1), 1)
    for k, up in enumerate(ups):
        assert (headings.apart_deg(up, np.delete(ups, k, axis=0)) > 2).all()
    assert {"upright", "axis", "sphere", "refined"} == set(found["kind"])
    assert told.count("done") + sum(stage.startswith("failed") for stage in told) == 25


def test_equal_seeds_give_equal_tables(bricks):
    first, again, other = (
        lu.rank_orientations(PENCIL, evaluations=12, finalists=0, seed=seed) for seed in (3, 3, 4)
    )
    pd.testing.assert_frame_equal(first, again)
    assert not first["up_x"].equals(other["up_x"])


def test_the_search_goes_towards_the_best(bricks):
    """The bricks are the better the more upright: tilts stay near, ever nearer."""
    found = lu.rank_orientations(PENCIL, evaluations=24, finalists=0)
    near = found[found["kind"] == "refined"]["tilt_deg"]
    assert len(near) == 8
    assert near.median() < 25
    assert found["kind"].iloc[0] == "upright"


def test_weights_decide(bricks):
    only = dict.fromkeys(orientation.WEIGHTS, 0.0)
    flat = lu.rank_orientations(
        PENCIL, evaluations=9, finalists=0, weights=only | {"layered": 1.0, "iou": 0.1}
    )
    high = lu.rank_orientations(PENCIL, evaluations=9, finalists=0, weights=only | {"iou": 1.0})
    assert high["iou"].dropna().is_monotonic_decreasing
    assert flat["score"].iloc[0] == pytest.approx(1.0 + 0.1 * flat["iou"].iloc[0])
    assert high["folded"].isna().all()
    assert high["certified"].isna().all()


def test_a_direction_without_a_solid_is_a_row(bricks):
    found = lu.rank_orientations(PENCIL, evaluations=6, finalists=0)
    assert found["reason"].tolist() == ["ok"] * 5 + ["no such luck"]
    assert np.isnan(found["score"].iloc[-1])
    assert not found["pareto"].iloc[-1]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"evaluations": 0}, "evaluations must be at least 1"),
        ({"finalists": -1}, "finalists must be at least 0"),
        ({"weights": {"beauty": 1}}, "there is no weight 'beauty'"),
        ({"weights": {"iou": -1}}, "the weight of iou must be at least 0"),
        ({"front": ("voxels",)}, "the front is between some of"),
        ({"front": ()}, "the front is between some of"),
    ],
)
def test_bad_options_are_refused(options, words):
    with pytest.raises(ValueError, match=words):
        lu.rank_orientations(PENCIL, voxels=40, **options)


@given(arrays(float, (7, 3), elements=st.integers(0, 3).map(float)))
def test_the_front_against_its_definition(values):
    front = orientation.on_front(values)
    for k, row in enumerate(values):
        beaten = any((other >= row).all() and (other > row).any() for other in values)
        assert front[k] == (not beaten)


def test_a_body_rests_on_the_faces_it_stands_on():
    """A brick rests on all six; a leaning tower does not stand on its foot."""
    brick = np.array([(x, y, z) for x in (0, 1) for y in (0, 2) for z in (0, 3)], float)
    ups = headings.resting(brick, brick.mean(axis=0))
    assert sorted(map(tuple, ups.tolist())) == sorted(map(tuple, headings.AXES.tolist()))
    assert set(map(tuple, ups[:2].tolist())) == {(1.0, 0, 0), (-1.0, 0, 0)}
    tower = brick + brick[:, 2:] * (1.0, 0, 0)
    ups = headings.resting(tower, tower.mean(axis=0))
    assert (0.0, 0.0, 1.0) not in set(map(tuple, ups.tolist()))
    assert len(ups) == 4
    assert not len(headings.resting(brick[:4], brick[0]))


def test_solid_angles_of_a_closed_body_are_a_whole_sphere():
    mesh = trimesh.creation.icosphere(subdivisions=1)
    assert headings._solid_angles(mesh.triangles - 0.3).sum() == pytest.approx(4 * np.pi)


def test_spread_directions_leave_no_large_hole():
    ups = headings.spread(100, np.random.default_rng(0))
    np.testing.assert_allclose(ups.mean(axis=0), 0, atol=0.02)
    for probe in headings.spread(40, np.random.default_rng(1)):
        assert headings.apart_deg(probe, ups).min() < 15


def test_tilts_are_as_wide_as_asked():
    rng = np.random.default_rng(0)
    for up in headings.AXES:
        lean = headings.tilted(up, 20.0, rng)
        assert headings.apart_deg(lean, up[None])[0] == pytest.approx(20)


def test_footing_against_a_mean():
    occupancy = np.zeros((5, 3, 4), bool)
    occupancy[1:3, 1, 0] = occupancy[1:5, 1, 1] = True
    base, margin = orientation.footing(lu.VoxelSolid(occupancy))
    # The centre is at x = (2 * 1.5 + 4 * 2.5) / 6 = 13 / 6; the base ends at 2.5.
    assert (base, margin) == (2, pytest.approx(2.5 - 13 / 6))


def test_the_picture(table):
    figure = draw.orientations(table)
    assert isinstance(figure, Figure)
    assert f"{int(table['pareto'].sum())} on the Pareto front" in figure.axes[2].get_title()
    with pytest.raises(ValueError, match="nothing to draw"):
        draw.orientations(table.assign(reason="no"))


def test_the_command(tmp_path, capsys, bricks):
    PENCIL.export(tmp_path / "pencil.stl")
    options = ["--evaluations", "3", "--finalists", "1", "--weight", "iou=2"]
    given = ["orient", str(tmp_path / "pencil.stl"), *options, "--out", str(tmp_path)]
    assert cli.run(given) == 0
    table = pd.read_csv(tmp_path / "pencil.orientations.csv")
    assert len(table) == 3
    assert (tmp_path / "pencil.orientations.png").stat().st_size > 1000
    assert "best: up (" in capsys.readouterr().out
    assert cli.run(["orient", "duck", "--weight", "iou"]) == 2
    assert "a weight is given as NAME=VALUE" in capsys.readouterr().err
