"""Motions backwards, turned and joined; from shape to shape through the line or inside a box."""

from itertools import permutations

import numpy as np
import pytest

import lineup as lu
from lineup.grid import DIRECTIONS, bar_directions
from lineup.kinematics import QUARTER, Move
from lineup.transformation.reversal import TURNS, joined, reversal, turned, words
from lineup.transformation.stowing import one_ended_plans, passed_on, stowed

QUICK = {"rounds": 400, "trial_rounds": 100}


def walk(letters):
    steps = DIRECTIONS[["ENUWSD".index(letter) for letter in letters]]
    return np.vstack([np.zeros((1, 3), int), steps.cumsum(axis=0)])


def motion_of(letters, rows, poses=(), angles=()):
    n_bars = len(letters)
    poses = np.array(poses, np.int8).reshape(len(poses), n_bars if len(poses) else 0)
    angles = np.array(angles, np.int32).reshape(len(angles), n_bars if len(angles) else 0)
    return lu.Motion(walk(letters), np.array(rows), 1.0, 90.0, False, "", poses, angles)


Q = QUARTER
EVERY_KIND = {
    "peel": motion_of("ENNU", [(Move.PEEL, 1, 2, 0), (Move.PEEL, 3, 2, 5)]),
    "swing": motion_of("ENNU", [(Move.SWING, 1, 2, 0), (Move.SWING, 3, 2, 5)]),
    "door": motion_of("UENWU", [(Move.DOOR, 1, 4, 1), (Move.DOOR, 1, 4, 1), (Move.DOOR, 1, 4, -1)]),
    "tilt": motion_of("UENWU", [(Move.TILT, 0, 5, 0)], poses=[[2] * 5]),
    "pull": motion_of("UENWU", [(Move.PULL, 5, 0, 2)] * 3 + [(Move.PULL, 0, 5, 4)]),
    "bend": motion_of(
        "UENWU",
        [(Move.BEND, 1, 0, 1), (Move.BEND, 1, 1, 2)],
        angles=[[0, Q, 0, -Q, 0], [9, Q, 0, 7 - Q, -9], [4 * Q, Q, 0, 0, Q]],
    ),
    "bends and a swing": motion_of(
        "EUN",
        [(Move.BEND, 2, 0, 1), (Move.SWING, 1, 2, 1), (Move.BEND, 2, 2, 3)],
        angles=[[0, 0, Q], [Q, 0, 2 * Q], [Q, Q, 2 * Q], [2 * Q, Q, 3 * Q]],
    ),
}


def poses_of(motion, substeps=4):
    return np.array(list(lu.frames(motion, substeps=substeps)))


@pytest.mark.parametrize("name", sorted(EVERY_KIND))
def test_a_reversal_passes_through_the_same_poses(name):
    forth = EVERY_KIND[name]
    back = reversal(forth)
    shown, again = poses_of(forth), poses_of(back)[::-1]
    shift = shown[0, 0] - again[0, 0]
    at_ends = slice(None) if name != "pull" else slice(0, None, 4)
    np.testing.assert_array_equal(np.rint(shown[0]), np.rint(again[0] + shift))
    relative = [poses - poses[:, :1] for poses in (shown[at_ends], again[at_ends])]
    np.testing.assert_allclose(*relative, atol=1e-9)
    np.testing.assert_array_equal(reversal(back).moves, forth.moves)


@pytest.mark.parametrize("name", sorted(EVERY_KIND))
def test_a_turned_motion_is_the_motion_turned(name):
    shown = poses_of(EVERY_KIND[name])
    for turn in TURNS:
        again = poses_of(turned(EVERY_KIND[name], turn))
        np.testing.assert_allclose(again, shown @ turn.T, atol=1e-9)


@pytest.mark.parametrize("name", sorted(EVERY_KIND))
def test_words_are_the_bars_of_the_poses(name):
    motion = EVERY_KIND[name]
    for word, pose in zip(words(motion), lu.frames(motion), strict=True):
        bars = np.diff(pose, axis=0)
        if np.abs(bars - np.rint(bars)).max() < 1e-9:
            np.testing.assert_array_equal(word, bar_directions(np.rint(pose).astype(np.int32)))


def test_there_are_24_turns():
    assert len({turn.tobytes() for turn in TURNS}) == 24
    assert all(np.linalg.det(turn) > 0 for turn in TURNS)
    np.testing.assert_array_equal(TURNS[0], np.eye(3))


def test_a_motion_that_ends_between_lattice_poses_has_no_reversal():
    with pytest.raises(ValueError, match="between lattice poses"):
        reversal(motion_of("EN", [(Move.BEND, 2, 0, 1)], angles=[[0, Q], [5, Q]]))


def test_joined_motions_keep_their_poses_and_angles_apart():
    first = EVERY_KIND["tilt"]
    *_, last = words(first)
    second = motion_of("UUUUU", [(Move.BEND, 0, 0, 1)], angles=[[Q] * 5, [0] * 5])
    np.testing.assert_array_equal(last, bar_directions(second.start))
    both = joined(joined(first, second, ""), reversal(joined(first, second, "")), "there and back")
    shown = poses_of(both, substeps=1)
    np.testing.assert_allclose(shown[-1], shown[0], atol=1e-9)
    assert both.moves[:, 3].tolist() == [0, 1, 2, 1]
    assert len(both.poses) == 2


def folded(seed, shape=(4, 4, 3), **options):
    solid = lu.VoxelSolid(np.ones(shape, bool))
    return lu.fold(solid, seed=seed, length=24, **QUICK, **options)


def test_every_ordered_pair_of_shapes_is_one_certified_motion():
    shapes = [folded(0), folded(1, (3, 3, 3)), folded(2, (12, 2, 2))]
    for a, b in permutations(shapes, 2):
        motion = lu.transform(a, b)
        verdict = lu.certify(motion)
        assert verdict.ok, verdict.reason
        assert motion.reason == "reaches its goal"
        np.testing.assert_array_equal(motion.start, a.path.voxels)
        np.testing.assert_array_equal(motion.goal, b.path.voxels)  # as B stands, not turned


def test_a_motion_that_lies_about_its_goal_is_refused():
    a, b, other = folded(0), folded(1, (3, 3, 3)), folded(3, (6, 4, 1))
    good = lu.transform(a, b)
    for goal in (a.path.voxels, other.path.voxels, b.path.voxels[::-1], b.path.voxels[:-1]):
        bad = lu.Motion(good.start, good.moves, 1.0, 90.0, False, "", goal=goal)
        assert "goal" in lu.certify(bad).reason


def test_a_mirror_image_is_another_shape():
    screw = walk("ENUENU")
    still = lu.Motion(screw, np.empty((0, 4), int), 1.0, 90.0, False, "", goal=screw[:, [1, 0, 2]])
    assert "goal" in lu.certify(still).reason
    twisted = lu.Motion(screw, np.empty((0, 4), int), 1.0, 90.0, False, "", goal=screw @ TURNS[7].T)
    assert lu.certify(twisted).ok


def test_what_does_not_unfold_is_transformed_into_nothing():
    a, b = folded(0), folded(1, (3, 3, 3))
    stuck = lu.Motion(a.path.voxels, np.empty((0, 4), int), 1.0, 90.0, False, "stuck")
    motion = lu.transform(stuck, b)
    assert len(motion) == 0
    assert not motion.straight
    assert motion.reason == "the motion of A does not end straight"
    assert not lu.certify(motion).ok


def test_chains_of_two_lengths_are_refused():
    with pytest.raises(ValueError, match="24 and 48 joints"):
        lu.transform(folded(0), lu.fold(lu.VoxelSolid(np.ones((4, 4, 3), bool)), **QUICK))


@pytest.mark.parametrize("box", [(1, 2), (0, 3, 3)])
def test_bad_boxes_are_refused(box):
    with pytest.raises(ValueError, match="three positive numbers"):
        lu.transform(folded(0), folded(0), within=box)


@pytest.fixture(scope="module")
def cubes():
    solid = lu.VoxelSolid(np.ones((5, 5, 6), bool))
    return [lu.fold(solid, seed=seed, length=144, **QUICK) for seed in (0, 1)]


def test_a_stowed_chain_is_certified_and_short(cubes):
    motion = cubes[0].motion
    plans = one_ended_plans(motion, 0)
    assert plans
    for end, states in plans:
        away = stowed(motion.start, end, states, strand=20)
        verdict = lu.certify(away)
        assert verdict.ok, verdict.reason
        assert max(verdict.extent) < 2 * 20 + 3 * 6
        bars = bar_directions(away.goal)
        strand = bars[:20] if end else bars[-20:]
        assert (strand == strand[0]).all()


def test_the_stow_passes_to_the_other_end_and_back(cubes):
    motion = cubes[0].motion
    end, states = one_ended_plans(motion, 0)[0]
    away = stowed(motion.start, end, states, strand=20)
    there = passed_on(away.goal, end, 20)
    back = passed_on(there.goal, 1 - end, 20)
    for part in (there, back):
        verdict = lu.certify(part)
        assert verdict.ok, verdict.reason
    np.testing.assert_array_equal(
        np.sort(np.ptp(back.goal, axis=0)), np.sort(np.ptp(away.goal, axis=0))
    )


def test_a_transformation_stays_in_the_box_asked_for(cubes):
    box = (60, 45, 60)
    motion = lu.transform(*cubes, within=box)
    assert motion.reason == "reaches its goal"
    verdict = lu.certify(motion, within=box)
    assert verdict.ok, verdict.reason
    assert max(verdict.extent) < 144
    hull = np.vstack([(pose.min(axis=0), pose.max(axis=0)) for pose in lu.frames(motion, every=7)])
    assert (np.ptp(hull, axis=0) + 1 <= np.add(verdict.extent, 1e-6)).all()


def test_a_box_that_is_too_small_is_said_to_be(cubes):
    motion = lu.transform(*cubes, within=(9, 9, 9))
    assert len(motion) == 0
    assert "the smallest box found" in motion.reason


def test_equal_runs_give_equal_bytes(cubes, tmp_path):
    files = [
        lu.save(lu.transform(*cubes, within=(60, 60, 60)), tmp_path / name) for name in ("a", "b")
    ]
    assert files[0].read_bytes() == files[1].read_bytes()
