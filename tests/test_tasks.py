"""What experiments run: rows hold what they promise, and agree with the library called by hand."""

from pathlib import Path

import numpy as np
import pytest

import lineup as lu
from lineup import experiment as experiments
from lineup.experiment import TASKS, Experiment, function_of, read_experiment, tasks
from lineup.tasks import bonding, motions, orientations, paths, trimming

ROOT = Path(__file__).parents[1]
CONFIGS = sorted((ROOT / "experiments").glob("*.yaml"))
SOLID = lu.VoxelSolid(np.ones((4, 3, 2), bool), name="brick", source={"kind": "test", "iou": 1.0})


@pytest.fixture
def run(monkeypatch, tmp_path):
    """A task on a brick of 4 x 3 x 2 voxels, whatever model it asks for."""

    def run(module, task, **settings):
        monkeypatch.setattr(module, "solid_of", lambda *asked: SOLID)
        told = []
        row = task(model="brick", voxels=24, **settings, folder=tmp_path, progress=told.append)
        assert set(row) == set(module.COLUMNS)
        assert told[0] == "voxelize"
        return row

    return run


def test_path(run):
    row = run(paths, paths.path, method="layered")
    assert (row["length"], row["coverage"], row["gap"], row["surface"]) == (24, 1, 0, 1)
    assert row["certified"]
    refined = run(paths, paths.path, method="refined")
    assert (refined["length"], refined["n_voxels"], refined["gap"]) == (8 * 24, 24, 0)


def test_path_is_judged(run, monkeypatch):
    gap = lu.VoxelPath(np.array([(0, 0, 0), (2, 0, 0)]))
    monkeypatch.setattr(paths, "made", lambda *asked: gap)
    assert not run(paths, paths.path, method="layered")["certified"]


def test_orientation(run):
    row = run(orientations, orientations.orientation)
    assert (row["layers"], row["nodes"], row["mscs"], row["lean_deg"]) == (2, 2, 0, 0)
    assert row["layered"] == row["bound"] == 1


@pytest.mark.parametrize(
    ("up", "tilt", "azimuth", "direction", "lean"),
    [
        ("-z", 0, 0, "-z", 180),
        ("+y", 0, 0, "+y", 90),
        ("+z", 90, 90, (0, 1, 0), 90),
        ("+z", 45, 0, (0.5**0.5, 0, 0.5**0.5), 45),
    ],
)
def test_directions(up, tilt, azimuth, direction, lean):
    found = orientations.direction_of(up, tilt, azimuth)
    assert found == direction if isinstance(direction, str) else found == pytest.approx(direction)
    assert orientations.lean_deg(found) == pytest.approx(lean)


def test_the_24_orientations_differ():
    """Of a brick with a corner gone, which no rotation leaves as it is but the first."""
    shape = np.ones((2, 3, 4), bool)
    shape[0, 0, 0] = shape[1, 0, 0] = shape[0, 1, 0] = False
    turned = [
        orientations.turned(lu.VoxelSolid(shape), turn).occupancy.astype(int) for turn in range(4)
    ]
    assert len({(t.shape, t.tobytes()) for t in turned}) == 4
    assert len({orientations.direction_of(up, 0, 0) for up in orientations.AXES}) == 6


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"up": "up"}, "up must be one of"),
        ({"up": "+x", "tilt_deg": 10}, "a tilt is from up \\+z, and up is \\+x"),
        ({"turn": 4}, "turn must be 0, 1, 2 or 3"),
    ],
)
def test_orientations_that_are_none(run, settings, message):
    with pytest.raises(ValueError, match=message):
        run(orientations, orientations.orientation, **settings)


def test_trimming_takes_what_it_may_and_no_more(run):
    none = run(trimming, trimming.trimming, item="layered", method="exact")
    assert (none["least"], none["removable"], none["surface_lost"]) == (24, 0, 0)
    half = run(trimming, trimming.trimming, item="layered", method="exact", loss=0.5)
    assert half["least"] == 12  # all voxels of the brick are surface
    assert half["surface_lost"] == 0.5
    assert run(trimming, trimming.trimming, item="layered", method="paper", loss=0.5)["least"] == 24


@pytest.mark.parametrize("least", [1, 2, 7, 50])
def test_the_shortest_is_found(least):
    assert trimming.shortest(100, lambda length: length >= 2 * least) == 2 * least


def test_motion(run):
    row = run(motions, motions.motion, method="peel")
    assert (row["straight"], row["certified"], row["straightness"]) == (True, True, 1)
    stuck = run(motions, motions.motion, method="energy", steps=1)
    assert not stuck["certified"]
    assert 0 < stuck["straightness"] < 1


def test_bonding(run):
    rows = {name: run(bonding, bonding.bonding, bonding=name) for name in ("solid", "none")}
    assert all(row["stands"] for row in rows.values())
    assert rows["solid"]["mass_kg"] == pytest.approx(24 * 1130 * 1e-6)
    assert rows["solid"]["sag_mm"] < rows["none"]["sag_mm"]


@pytest.mark.parametrize("file", CONFIGS, ids=lambda file: file.stem)
def test_configs_are_fit_to_run(file, tmp_path, monkeypatch):
    monkeypatch.setattr(experiments, "source_digest", lambda module: "any")
    experiment = read_experiment(file)
    assert tasks(experiment, tmp_path)
    assert len(tasks(experiment, tmp_path, "quick")) <= 8


@pytest.mark.parametrize("task", sorted(set(TASKS) - {"table2"}))
def test_every_column_is_documented(task):
    page = (ROOT / "experiments" / "FORMAT.md").read_text()
    section = page.partition(f"## Task `{task}`")[2].partition("\n## ")[0]
    module = function_of(TASKS[task]).__module__
    columns = __import__(module, fromlist=["COLUMNS"]).COLUMNS
    assert [name for name in columns if f"`{name}`" not in section] == []


def test_a_column_that_the_task_does_not_make_is_refused_before_anything_runs(tmp_path):
    grids = [{"model": "duck", "voxels": 100, "method": "layered"}]
    layout = {"index": "model", "values": "colour"}
    experiment = Experiment(title="t", task="path", grids=grids, table=layout)
    with pytest.raises(ValueError, match="table: unknown column 'colour'; task 'path' has: model"):
        tasks(experiment, tmp_path)
