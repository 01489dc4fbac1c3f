"""Shells: walls of the thickness asked for, in one piece, without voids, and with vents."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from polycubes import polycubes

import lineup as lu
from lineup import cli
from lineup.shells import depths

CUBE = lu.VoxelSolid(np.ones((9, 9, 9), bool))


def test_a_cube_loses_its_core_and_a_vent():
    hollow = lu.shell(CUBE, 2)
    assert hollow.size == 9**3 - 5**3 - 2
    assert hollow.source["shell"] == {
        "thickness": [2] * 9,
        "saved": 127,
        "vents": [[4, 4, 0, 1]],
        "filled": 0,
    }
    assert not hollow.occupancy[4, 4, :7].any()


@settings(max_examples=25)
@given(polycubes(max_voxels=8))
def test_shells_of_any_solid(occupancy):
    big = lu.refine(lu.mend(occupancy), 4)
    depth = depths(big.occupancy)
    hollow = lu.shell(big, 1)  # every cube of 4 x 4 x 4 has a core
    told = hollow.source["shell"]
    gone = big.occupancy & ~hollow.occupancy
    drilled = np.zeros_like(gone)
    for x, y, low, high in told["vents"]:
        drilled[x, y, low : high + 1] = True
    assert not (hollow.occupancy & ~big.occupancy).any()
    assert told["saved"] == gone.sum()
    assert (gone == drilled)[depth == 1].all()
    assert (hollow.occupancy & (depth > 1)).sum() == told["filled"]


def test_depth_against_its_definition():
    occupancy = np.zeros((6, 5, 4), bool)
    occupancy[:4] = occupancy[:, :3] = True
    depth = depths(occupancy)
    padded = np.pad(occupancy, 5)
    for x, y, z in np.argwhere(occupancy) + 5:
        near = next(
            d
            for d in range(1, 6)
            if not padded[x - d : x + d + 1, y - d : y + d + 1, z - d : z + d + 1].all()
        )
        assert depth[x - 5, y - 5, z - 5] == near


@pytest.mark.parametrize("thickness", [lambda z: 3 if z < 4 else 1, [3] * 4 + [1] * 5])
def test_thickness_may_vary_by_layer(thickness):
    hollow = lu.shell(CUBE, thickness)
    assert hollow.source["shell"]["thickness"] == [3, 3, 3, 3, 1, 1, 1, 1, 1]
    assert (~hollow.occupancy[:, :, 3]).sum() == 3 * 3
    assert (~hollow.occupancy[:, :, 5]).sum() == 7 * 7


def test_two_cavities_get_two_vents():
    """A dumbbell; the neck, three voxels wide, is all wall but for its core."""
    occupancy = np.zeros((14, 5, 5), bool)
    occupancy[:5] = occupancy[9:] = True
    occupancy[5:9, 2, 2] = True
    told = lu.shell(lu.VoxelSolid(occupancy), 1).source["shell"]
    assert told["vents"] == [[2, 2, 0, 0], [11, 2, 0, 0]]


def test_a_cavity_that_cannot_be_vented_is_refused():
    """Plugs below and above every column: any straight hole would cut one off."""
    occupancy = np.ones((3, 3, 3), bool)
    with pytest.raises(ValueError, match="thickness must be an integer of at least 1, got 0"):
        lu.shell(lu.VoxelSolid(occupancy), 0)
    with pytest.raises(ValueError, match="no thinner than the solid.*a thickness of 1 or less"):
        lu.shell(lu.VoxelSolid(occupancy), 2)
    with pytest.raises(ValueError, match="more voxels would do"):
        lu.shell(lu.VoxelSolid(np.ones((3, 3, 2), bool)), 1)
    with pytest.raises(ValueError, match="2 numbers for 3 layers"):
        lu.shell(lu.VoxelSolid(occupancy), [1, 1])
    with pytest.raises(ValueError, match="got 1.5"):
        lu.shell(lu.VoxelSolid(occupancy), lambda z: 1.5)


def test_a_shell_folds_and_certifies():
    hollow = lu.shell(lu.VoxelSolid(np.ones((5, 5, 5), bool)), 1)
    folding = lu.fold(hollow, rounds=200, trial_rounds=20)
    assert lu.certify(folding.motion).ok
    assert lu.certify_path(folding.path, hollow).ok
    assert folding.path.coverage(hollow) > 0.8


def test_a_shell_of_a_mesh_has_the_count_asked_for():
    ball = trimesh.creation.icosphere(subdivisions=3)
    plain, hollow = lu.voxelize(ball, 200), lu.voxelize(ball, 200, shell=1)
    assert abs(hollow.size - 200) <= 0.1 * 200
    assert (hollow.source["note"] == "") == (abs(hollow.size - 200) <= 4)
    assert hollow.pitch < plain.pitch
    assert hollow.source["iou"] > plain.source["iou"]
    assert hollow.source["target"] == 200
    with pytest.raises(ValueError, match="no thinner"):
        lu.voxelize(trimesh.creation.box((9, 9, 1)), 81, shell=2)


@pytest.mark.slow
def test_the_command(tmp_path):
    assert (
        cli.run(["voxelize", "duck", "--voxels", "120", "--shell", "1", "--out", str(tmp_path)])
        == 0
    )
    hollow = lu.load(tmp_path / "duck.solid.json")
    assert hollow.source["shell"]["saved"] > 0
