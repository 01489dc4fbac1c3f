"""Poses keep every bar's length, and a motion can be played backwards."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from oracles import pose_bend_deg, reversed_motion

import lineup as lu
from lineup import kinematics
from lineup.kinematics import Move

EAST, NORTH, UP, WEST, SOUTH, DOWN = range(6)


def motion(start, moves, poses=(), straight=True):
    poses = np.array(poses, np.int8).reshape(len(poses), max(len(start) - 1, 0))
    moves = np.array(moves, int).reshape(-1, 4)
    return lu.Motion(np.array(start), moves, 1.0, 90.0, straight, "straight", poses)


STAIR = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (1, 1, 1), (2, 1, 1), (2, 1, 2), (2, 2, 2)]
HAIRPIN = [(0, 0, 0), (1, 0, 0), (1, 0, 1), (2, 0, 1), (2, 0, 0), (3, 0, 0), (4, 0, 0)]
MOTIONS = {
    "peel": motion(STAIR, [(Move.PEEL, 4, 5, EAST), (Move.PEEL, 3, 2, SOUTH)], straight=False),
    "swing": motion(STAIR, [(Move.SWING, 2, 3, NORTH), (Move.SWING, 4, 3, SOUTH)], straight=False),
    "door": motion(HAIRPIN, [(Move.DOOR, 1, 4, 1), (Move.DOOR, 1, 4, -1)], straight=False),
    "tilt": motion(STAIR, [(Move.TILT, 0, 6, 0)], [[UP] * 6]),
}
MOTIONS["mixed"] = motion(
    HAIRPIN,
    [(Move.DOOR, 1, 4, -1), (Move.SWING, 3, 4, EAST), (Move.PEEL, 2, 3, SOUTH)],
    straight=False,
)


def lengths(pose):
    return np.linalg.norm(np.diff(pose, axis=0), axis=1)


@pytest.mark.parametrize("name", MOTIONS)
def test_bars_keep_their_length_at_every_substep(name):
    for pose in lu.frames(MOTIONS[name], substeps=9):
        assert pose.dtype == np.float64
        assert_allclose(lengths(pose), 1, atol=1e-12)


@pytest.mark.parametrize("name", MOTIONS)
def test_joints_at_rest_rest(name):
    start, move = MOTIONS[name].start, MOTIONS[name].moves[0]
    _, joint, other, _ = move.tolist()
    here = {
        "peel": np.arange(joint + 1),
        "swing": np.arange(joint + 1),
        "tilt": np.arange(1),
        "door": np.r_[: joint + 1, other : len(start)],
        "mixed": np.r_[: joint + 1, other : len(start)],
    }[name]
    moving = np.setdiff1d(np.arange(len(start)), here)
    pose = kinematics.moved(start.astype(float), move, MOTIONS[name], 0.3)
    assert_array_equal(pose[here], start[here])
    assert (np.linalg.norm(pose[moving] - start[moving], axis=1) > 0.1).any()


def test_what_each_kind_does_by_hand():
    """STAIR is E N U E U N; the first bar of HAIRPIN that turns goes from up to south."""
    shown = {name: list(lu.frames(m)) for name, m in MOTIONS.items()}
    assert_array_equal(shown["peel"][1][4:], [(2, 1, 1), (3, 1, 1), (3, 2, 1)])
    assert_array_equal(shown["peel"][2][:4], [(0, -1, 1), (1, -1, 1), (1, 0, 1), (1, 1, 1)])
    assert_array_equal(
        shown["swing"][1][2:], [(1, 1, 0), (1, 2, 0), (2, 2, 0), (2, 3, 0), (2, 3, -1)]
    )
    assert_array_equal(shown["door"][1][1:5], [(1, 0, 0), (1, -1, 0), (2, -1, 0), (2, 0, 0)])
    assert_array_equal(shown["door"][2], HAIRPIN)
    assert_array_equal(shown["tilt"][1], [(0, 0, z) for z in range(7)])


def test_half_way_of_a_peel_is_at_45_degrees():
    half = kinematics.moved(MOTIONS["peel"].start.astype(float), *first("peel"), 0.5)
    assert_allclose(half[5] - half[4], [np.sqrt(0.5), 0, np.sqrt(0.5)], atol=1e-12)
    assert_allclose(half[6] - half[5], [0, 1, 0], atol=1e-12)


def first(name):
    return MOTIONS[name].moves[0], MOTIONS[name]


@pytest.mark.parametrize("every", [1, 2, 3, 100])
@pytest.mark.parametrize("substeps", [1, 4])
def test_first_and_last_pose_always_come(every, substeps):
    mixed = MOTIONS["mixed"]
    everything = list(lu.frames(mixed))
    shown = list(lu.frames(mixed, every, substeps))
    n_shown = len({*range(every, len(mixed) + 1, every), len(mixed)})
    assert len(shown) == 1 + n_shown * substeps
    assert_array_equal(shown[0], mixed.start)
    assert_array_equal(shown[-1], everything[-1])


def test_a_motion_without_moves_has_one_pose():
    assert len(list(lu.frames(motion(STAIR, []), every=5, substeps=5))) == 1


def test_a_shown_pose_is_the_callers_own():
    poses = lu.frames(MOTIONS["peel"])
    next(poses)[:] = 99
    assert next(poses).max() < 99


@pytest.mark.parametrize("name", MOTIONS)
def test_backwards_shows_the_same_poses(name):
    there = list(lu.frames(MOTIONS[name], substeps=4))
    back = list(lu.frames(reversed_motion(MOTIONS[name]), substeps=4))
    # A tilt rests on joint 0 and a limb may hang on either side, so compare shapes, not places.
    for a, b in zip(there, back[::-1], strict=True):
        assert_allclose(a - a[0], b - b[0], atol=1e-9)


def test_the_tilt_ends_straight():
    assert pose_bend_deg(list(lu.frames(MOTIONS["tilt"]))[-1]) == 0


@pytest.mark.parametrize(("every", "substeps"), [(0, 1), (1, 0), (-1, 1)])
def test_bad_steps_are_refused(every, substeps):
    with pytest.raises(ValueError, match="at least 1, got"):
        list(lu.frames(MOTIONS["peel"], every, substeps))


def test_an_unknown_kind_of_move_is_refused():
    with pytest.raises(ValueError, match="unknown kind of move 9"):
        list(lu.frames(motion(STAIR, [(9, 1, 2, 0)])))
