"""Through a tube and into a capsule: what is free, what is certified, and honest refusals."""

import numpy as np
import pytest
from test_gliding import nearest

import lineup as lu
from lineup import grid
from lineup.scenarios import LEAD

SHAPE = lu.layered_path(lu.VoxelSolid(np.ones((3, 3, 2), bool)))
TALL = lu.layered_path(lu.VoxelSolid(np.ones((2, 3, 3), bool)))


def solid_cells(around):
    return np.argwhere(grid.surface(around.occupancy)) + around.origin


def check_run(scenario):
    motion = scenario.motion
    assert scenario.certificate.ok, scenario.certificate.reason
    again = lu.certify(motion, motion.diameter, motion.max_bend_deg, obstacles=scenario.obstacles)
    assert again == scenario.certificate
    poses = list(lu.frames(motion, every=3, substeps=3))
    assert nearest(poses, solid_cells(scenario.obstacles)) >= 0.5 - 1e-9
    assert np.array_equal(poses[-1], motion.goal)
    return poses


@pytest.mark.parametrize("before", [None, TALL])
def test_through_a_tube(before):
    scenario = lu.through_tube(before, SHAPE, radius=2.0, bend_radius=4.0)
    wall, line = scenario.obstacles, scenario.centre_line
    first, beyond = wall.origin[0], wall.origin[0] + wall.occupancy.shape[0]
    poses = check_run(scenario)
    assert (poses[0][:, 0] < first).all()
    assert (poses[-1][:, 0] >= beyond + LEAD - 1).all()
    for pose in poses:
        inside = pose[(pose[:, 0] >= first) & (pose[:, 0] <= beyond - 1)]
        apart = np.linalg.norm(inside[:, None] - line, axis=2).min(axis=1, initial=np.inf)
        assert (apart <= 2.0 - 0.5).all()
    straight = not np.diff(scenario.motion.start, n=2, axis=0).any()
    assert straight == (before is None)


def test_the_centre_line_bends_as_it_should_and_the_tube_is_round_it():
    scenario = lu.through_tube(None, SHAPE, radius=2.0, bend_radius=6.0)
    line, wall = scenario.centre_line, scenario.obstacles
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    tangents = np.diff(line, axis=0) / steps[:, None]
    turned = np.linalg.norm(np.diff(tangents, axis=0), axis=1) / steps[1:]
    assert turned.max() == pytest.approx(1 / 6, rel=1e-3)
    assert steps.max() <= 0.0501
    rise = 2 * 6 * (1 - np.cos(np.pi / 3))
    length = 2 * (LEAD + 6 * np.sin(np.pi / 3))
    np.testing.assert_allclose(line[-1], (length, 0, rise), atol=1e-9)
    corners = np.stack(np.meshgrid(*[[-0.5, 0.5]] * 3), axis=-1).reshape(-1, 3)
    free = np.argwhere(~wall.occupancy) + wall.origin
    for cell in free[:: max(1, len(free) // 60)]:
        reach = np.linalg.norm((cell + corners)[:, None] - line, axis=2).max(axis=0)
        assert reach.min() <= 2.0


def test_a_narrow_tube_is_a_result_with_a_reason():
    for radius in (0.6, 1.0):
        scenario = lu.through_tube(None, SHAPE, radius=radius, bend_radius=5.0)
        assert scenario.motion.reason == f"no way leads through a tube of radius {radius:g} " + (
            "and into shape B"
        )
        assert not scenario.certificate.ok
        assert len(scenario.motion) == 0


def test_tubes_that_make_no_sense_are_refused():
    with pytest.raises(ValueError, match="radius and bend_radius"):
        lu.through_tube(None, SHAPE, radius=3, bend_radius=2)
    with pytest.raises(ValueError, match="18 and 8 joints"):
        lu.through_tube(SHAPE, lu.VoxelPath(SHAPE.voxels[:8]))


def test_into_a_capsule():
    scenario = lu.into_capsule(3.2, 9.0, sweeps=300)
    motion, axis = scenario.motion, scenario.centre_line
    poses = check_run(scenario)
    assert len(motion.start) % 2 == 0
    assert not np.diff(motion.start, n=2, axis=0).any()
    assert np.linalg.norm(axis[1] - axis[0]) + 2 * 3.2 == pytest.approx(9.0)
    nearest_on_axis = np.clip(motion.goal[:, 2], axis[0, 2], axis[1, 2])
    away = np.abs(motion.goal - np.insert(axis[0, :2], 2, 0)) * (1, 1, 0)
    away[:, 2] = np.abs(motion.goal[:, 2] - nearest_on_axis)
    assert (np.linalg.norm(away, axis=1) < 3.2 - 0.5).all()
    shell = np.pad(scenario.obstacles.occupancy, 1)
    outside = np.argwhere(shell[1:-1, 1:-1, 1:-1]) + scenario.obstacles.origin
    start = poses[0]
    low, high = outside.min(axis=0), outside.max(axis=0)
    assert ((start < low) | (start > high)).any(axis=1).all()
    assert not grid.voids(shell).any()  # the port leads in


def test_capsules_that_make_no_sense_are_refused():
    with pytest.raises(ValueError, match="twice the radius"):
        lu.into_capsule(5, 9)
    with pytest.raises(ValueError, match="no room"):
        lu.into_capsule(1, 2)
