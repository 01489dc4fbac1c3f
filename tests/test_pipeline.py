"""Algorithm 1 from end to end."""

import numpy as np
import pandas as pd
import pytest
import trimesh

import lineup as lu
from lineup.pipeline import table2_task

KINDS = ("models", "foldings", "certificates")


def check_design(design, blocks):
    assert len(design.models) == len(design.foldings) == len(design.certificates)
    for solid, folding, certificate in zip(
        design.models, design.foldings, design.certificates, strict=True
    ):
        assert len(folding.path) == 2 * blocks
        assert lu.certify_path(folding.path, solid).ok
        assert certificate.ok
        assert certificate == lu.certify(folding.motion)
        assert certificate.clearance >= 1 - 1e-9


def test_names_files_meshes_and_solids_become_poses_of_one_chain(tmp_path):
    ball = trimesh.creation.icosphere()
    ball.export(tmp_path / "ball.ply")
    sources = ["mug", tmp_path / "ball.ply", ball, lu.VoxelSolid(np.ones((4, 4, 4), bool))]
    design = lu.lineup(sources, blocks=30)
    check_design(design, 30)
    assert design.table["model"].tolist() == ["mug", "ball", "model3", "model4"]
    assert design.table["certified"].all()


def test_a_model_that_fails_is_a_row_and_stops_no_other(tmp_path):
    told = []
    sources = [tmp_path / "none.obj", "duck", lu.VoxelSolid(np.ones((2, 2, 2), bool), name="dice")]
    design = lu.lineup(sources, blocks=30, progress=lambda *said: told.append(said))
    check_design(design, 30)
    failures = design.table["failure"].tolist()
    assert "none.obj" in failures[0]
    assert failures[2].startswith("the longest path found has 8 of the 60 voxels")
    assert len(design.models) == 1
    assert told[-1] == ("dice", f"failed: {failures[2]}")
    assert ("duck", "done") in told


def test_the_row_says_what_was_measured(tmp_path):
    row = table2_task("mug", 60, 0, folder=tmp_path, progress=lambda stage: None)
    solid = lu.load(tmp_path / "mug.solid.json")
    folding = lu.load(tmp_path / "mug.folding.json")
    assert row["voxels"] == solid.size
    assert row["length"] == len(folding.path) == 120
    assert row["bound"] == lu.path_bound(solid)
    assert row["moves"] == len(folding.motion)
    assert row["gap"] == row["bound"] - round(row["folded_coverage"] * solid.size) >= 0
    assert row["certified"]
    assert 0.5 < row["surface_kept"] <= 1
    assert row["source"] in ("procedural", "folder", "original")


def test_equal_seeds_give_equal_bytes(tmp_path):
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        table2_task("teddy", 40, 3, folder=tmp_path / name, progress=lambda stage: None)
    for kind in ("solid", "folding"):
        one, other = (tmp_path / n / f"teddy.{kind}.json" for n in ("a", "b"))
        assert one.read_bytes() == other.read_bytes()


def test_bad_use_is_refused():
    with pytest.raises(ValueError, match="there are no models"):
        lu.lineup([])
    with pytest.raises(ValueError, match="models must be a list, got 'duck' alone"):
        lu.lineup("duck")
    for blocks in (-3, 0, 1, 2.5, "many"):
        with pytest.raises(ValueError, match="blocks must be an integer of at least 2, got"):
            lu.lineup(["duck"], blocks=blocks)
    with pytest.raises(ValueError, match="seed must be an integer of at least 0, got -1"):
        lu.lineup(["duck"], seed=-1)


def test_two_models_of_one_name_are_not_stored_over_each_other(tmp_path):
    with pytest.raises(ValueError, match="under one name: duck, duck"):
        lu.lineup(["duck", "duck"], blocks=20, folder=tmp_path / "new")
    assert not (tmp_path / "new").exists()


def test_a_name_that_is_no_model_is_told_the_near_ones():
    assert lu.lineup(["dukc"], blocks=20).table["failure"][0] == (
        "unknown model 'dukc'; did you mean duck?"
    )


def test_a_design_with_a_failed_model_is_stored_and_loads(tmp_path):
    dice = lu.VoxelSolid(np.ones((2, 2, 2), bool), name="dice")
    design = lu.lineup(["mug", dice], blocks=20, folder=tmp_path / "new")
    stored = lu.load(lu.save(design, tmp_path / "new"))
    assert [solid.name for solid in stored.models] == ["mug"]
    assert stored.table["model"].tolist() == ["mug", "dice"]
    assert stored.table["failure"][1] == design.table["failure"][1]


@pytest.fixture(scope="module")
def two_poses():
    dice = lu.VoxelSolid(np.ones((2, 2, 2), bool), name="dice")
    return lu.lineup(
        ["mug", dice, lu.VoxelSolid(np.ones((5, 5, 2), bool), name="plate")], blocks=20
    )


def check_added(after, before):
    """Whatever was in a design is in it still, the very same."""
    n = len(before.models)
    for kind in KINDS:
        earlier = getattr(before, kind)
        assert all(a is b for a, b in zip(getattr(after, kind)[:n], earlier, strict=True))
    earlier = after.table.iloc[: len(before.table)][before.table.columns]
    pd.testing.assert_frame_equal(earlier, before.table, check_dtype=False)
    assert len(after.table) == len(before.table) + 1


@pytest.mark.parametrize("source", ["duck", "mesh", "solid", "mug"])
def test_a_model_is_added_to_a_chain_and_no_other_changes(source, two_poses):
    made = {
        "mesh": trimesh.creation.icosphere(),
        "solid": lu.VoxelSolid(np.ones((4, 4, 4), bool), name="cube"),
    }
    design = lu.add(two_poses, made.get(source, source))
    check_added(design, two_poses)
    check_design(design, 20)
    assert len(design.models) == len(two_poses.models) + 1
    assert design.table["model"].tolist() == [
        *["mug", "dice", "plate"],
        {"mesh": "model4", "solid": "cube"}.get(source, source),
    ]
    assert design.table["certified"].tolist()[-1] is True
    assert design.table["failure"].tolist()[-1] == ""


def test_what_is_added_is_what_lineup_makes(two_poses):
    added = lu.add(two_poses, "duck", seed=3).foldings[-1]
    (alone,) = lu.lineup(["duck"], blocks=20, seed=3).foldings
    assert np.array_equal(added.path.voxels, alone.path.voxels)
    assert np.array_equal(added.motion.moves, alone.motion.moves)


def test_a_model_that_cannot_be_added_is_a_row_with_its_reason(two_poses, tmp_path):
    told = []
    small = lu.VoxelSolid(np.ones((3, 3, 3), bool))
    design = lu.add(two_poses, small, progress=lambda *said: told.append(said))
    check_added(design, two_poses)
    assert len(design.models) == len(two_poses.models)
    reason = design.table["failure"].tolist()[-1]
    assert reason.startswith("the longest path found has 26 of the 40 voxels")
    assert told[-1] == ("model4", f"failed: {reason}")
    stored = lu.load(lu.save(design, tmp_path))
    check_added(lu.add(stored, "duck"), stored)


def test_a_chain_without_one_length_takes_no_model(two_poses):
    none = lu.lineup(["dukc"], blocks=20)
    with pytest.raises(ValueError, match="of one even length, and the design has no folding"):
        lu.add(none, "mug")
    other = lu.lineup(["mug"], blocks=30)
    mixed = lu.Design(
        *(getattr(two_poses, kind) + getattr(other, kind) for kind in KINDS), two_poses.table
    )
    with pytest.raises(ValueError, match="and the design has foldings of 40, 60 voxels"):
        lu.add(mixed, "mug")
    with pytest.raises(ValueError, match="seed must be an integer of at least 0"):
        lu.add(two_poses, "mug", seed=-1)
