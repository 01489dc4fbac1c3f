"""What a certificate says of where and when: the nearest bars, the most bent joint, the extent."""

import numpy as np
import pytest
from chains import (
    DOWN,
    EAST,
    NORTH,
    UP,
    boustrophedon,
    chains,
    motion,
    peeled,
    peeled_from_both_ends,
    single,
    walk,
    wander,
)
from examples import examples
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from oracles import pose_bend_deg, reversed_motion, sampled_move

import lineup as lu
from lineup import grid, kinematics
from lineup.kinematics import Move

SEEDS = st.integers(0, 2**32 - 1)
NEAR = 1e-6
ROD_TIP_RISES = motion(walk("EDDDWWUEU"), [(Move.PEEL, 7, 8, UP)])


def lattice_poses(shown):
    """The poses before each move, and the last one."""
    poses = [shown.start.astype(float)]
    for move in shown.moves:
        poses.append(np.rint(kinematics.moved(poses[-1], move, shown, 1.0)))
    return poses


def sampled_box(poses):
    """Sides of the box of all blocks in these poses, unturned."""
    return np.ptp(np.concatenate(poses), axis=0) + 1


def wandering(seed, n_bars=14, n_moves=8):
    rng = np.random.default_rng(seed)
    good = wander(rng, int(rng.integers(3, n_bars)), n_moves, 0.3, 180.0)
    return motion(good.start, good.moves[: lu.certify(good, 0.3, 180.0).where])


@settings(max_examples=20)
@given(SEEDS)
def test_the_nearest_bars_come_that_near_in_that_move(seed):
    trial = wandering(seed)
    verdict = lu.certify(trial, 0.3, 180.0)
    where, a, b = verdict.nearest
    assert 0 <= a <= b - 2
    assert b < len(trial.start) - 1
    if where < 0:
        assert (a, b, verdict.clearance) == (0, 2, 1.0)
        return
    pose = lattice_poses(trial)[where]
    pair = np.array([a]), np.array([b])
    found, _ = sampled_move(trial, pose, trial.moves[where], samples=65, pairs=pair)
    assert found == pytest.approx(verdict.clearance, abs=NEAR)


@settings(max_examples=20)
@given(SEEDS)
def test_the_most_bent_joint_bends_that_far_in_that_move(seed):
    trial = wandering(seed)
    verdict = lu.certify(trial, 0.3, 180.0)
    where, joint = verdict.most_bent
    poses = lattice_poses(trial)
    if where < 0 and joint < 0:
        assert all(pose_bend_deg(pose) == 0 for pose in poses)
        return
    bends = [pose_bend_deg(p[joint - 1 : joint + 2]) for p in poses[max(where, 0) : where + 2]]
    assert max(bends) == pytest.approx(verdict.bend_deg)
    before = [pose_bend_deg(p) for p in poses[: where + 1]]
    assert max(before, default=0) < verdict.bend_deg - NEAR


@examples(48)
@given(SEEDS)
def test_the_extent_is_that_of_all_poses_shown(seed):
    """Of arcs, too: at 128 steps a quarter they are met within a ten-thousandth of their radius."""
    trial = wandering(seed)
    verdict = lu.certify(trial, 0.3, 180.0)
    shown = sampled_box(list(lu.frames(trial, substeps=128)))
    assert (verdict.extent >= shown - 1e-9).all()
    assert (verdict.extent <= shown + 1e-3).all()


@settings(max_examples=20)
@given(chains(), st.integers(0, 5))
def test_the_extent_of_a_tilt_is_that_of_all_poses_shown(start, d):
    bars = grid.bar_directions(start)
    assume((bars != (d + 3) % 6).all())
    assume((bars != d).any())
    unfold = single(start, (Move.TILT, 0, len(bars), 0), [d] * len(bars))
    for tilt in (unfold, reversed_motion(unfold)):
        shown = sampled_box(list(lu.frames(tilt, substeps=128)))
        extent = lu.certify(tilt).extent
        assert (extent >= shown - 1e-9).all()
        assert (extent <= shown + 1e-3).all()


def test_arcs_reach_farther_than_their_ends():
    """A knee of 3 and 4 turns about its end: halfway its tip is 5 away, straight ahead."""
    knee = motion(walk("EEENNNN"), [(Move.SWING, 0, 1, DOWN), (Move.SWING, 0, 1, EAST)])
    assert lu.certify(knee).extent == (4.0, 5.0, 4.0)
    knee = motion(walk("EEENNNN"), [(Move.SWING, 0, 1, NORTH)])
    assert lu.certify(knee).extent == (1 + 4 + 3, 1 + 5, 1)
    tilt = single(walk("EU"), (Move.TILT, 0, 2, 0), [UP, UP])
    assert lu.certify(tilt).extent == (2, 1, 3)


@pytest.mark.parametrize("direction", [NORTH, UP])
def test_a_motion_and_its_reversal_reach_as_far(direction):
    start = boustrophedon(4, 6, 1) if direction == NORTH else boustrophedon(3, 3, 4)
    for unfold in (peeled(start, direction), peeled_from_both_ends(start, direction)):
        there, back = lu.certify(unfold), lu.certify(reversed_motion(unfold))
        assert there.extent == back.extent
        assert there.extent[direction] == len(start)


def test_a_place_that_comes_near_is_told_whether_or_not_it_is_a_fault():
    thin, thick = lu.certify(ROD_TIP_RISES, diameter=0.41), lu.certify(ROD_TIP_RISES)
    assert thin.where == -1
    assert thick.where == 0
    assert thin.nearest == thick.nearest == (0, 0, 8)
    assert thin.clearance == thick.clearance == pytest.approx(np.sqrt(2) - 1)


FLAT = peeled(boustrophedon(3, 4, 1), NORTH)


def test_a_motion_that_stays_in_its_box_is_certified():
    extent = lu.certify(FLAT).extent
    assert extent[1:] == (12, 1)
    assert lu.certify(FLAT, within=extent).ok
    assert lu.certify(FLAT, within=(np.inf, 12, np.inf)).ok


@pytest.mark.parametrize("axis", range(3))
def test_a_motion_that_leaves_its_box_is_refused_by_the_first_move_out(axis):
    extent = list(lu.certify(FLAT).extent)
    extent[axis] -= 1e-6
    verdict = lu.certify(FLAT, within=tuple(extent))
    assert not verdict.ok
    assert f"along axis {axis}, more than" in verdict.reason
    k = verdict.where
    assert verdict.moves_checked == k + 1
    reach = [lu.certify(motion(FLAT.start, FLAT.moves[:m])).extent[axis] for m in range(k + 2)]
    assert max(reach[:-1], default=0) <= extent[axis] < reach[-1]


def test_a_tilt_that_leaves_its_box_is_refused():
    tilt = single(walk("EUNU"), (Move.TILT, 0, 4, 0), [UP] * 4)
    verdict = lu.certify(tilt, within=(2, 2, 4.9))
    assert (verdict.ok, verdict.where) == (False, 0)
    assert verdict.reason == "the blocks reach over 5 along axis 2, more than the 4.9 of the box"


def test_a_start_that_fits_into_no_box_is_refused():
    verdict = lu.certify(FLAT, within=(2, 9, 9))
    assert (verdict.where, verdict.moves_checked) == (-1, 0)
    assert verdict.reason == "the blocks reach over 3 along axis 0, more than the 2 of the box"


@pytest.mark.parametrize(
    "within", [(1, 2), 5.0, (1, 2, 0), (1, 2, -3), (1, 2, np.nan), (1, 2, 3, 4)]
)
def test_bad_boxes_are_refused(within):
    with pytest.raises(ValueError, match="within must be three positive numbers"):
        lu.certify(FLAT, within=within)
