"""The judge, which looks bars up by their cells, against the comparison of all with all."""

import os

import numpy as np
import pytest
from all_pairs import move_clearance, outcome
from chains import boustrophedon, motion, peeled, peeled_from_both_ends, turns, walk, wander
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import reversed_motion

import lineup as lu
from lineup import grid, kinematics

SEEDS = st.integers(0, 2**32 - 1)
WORDS = {"malformed": "malformed", "touch": "come within", "bend": "bend of"}


def pose_before(good, k):
    pose = good.start.astype(float)
    for move in good.moves[:k]:
        pose = np.rint(kinematics.moved(pose, move, good, 1.0))
    return pose.astype(int)


def check(trial, diameter=0.999, max_bend_deg=90.0):
    """The same verdict and the same numbers, whatever is wrong; the fault, "" if none."""
    verdict, slow = (
        lu.certify(trial, diameter, max_bend_deg),
        outcome(trial, diameter, max_bend_deg),
    )
    assert verdict.where == slow.where
    assert verdict.clearance == pytest.approx(slow.clearance, abs=1e-12)
    assert verdict.bend_deg == pytest.approx(slow.bend_deg, abs=1e-9)
    if slow.fault:
        assert WORDS[slow.fault] in verdict.reason
        assert verdict.moves_checked == slow.where + 1
    where, a, b = verdict.nearest
    if where >= 0:
        move, pose = trial.moves[where].tolist(), pose_before(trial, where)
        near = move_clearance(pose, *move, only=(a, b))
        assert near == pytest.approx(verdict.clearance, abs=1e-12)
    return slow.fault


@examples(60)
@given(SEEDS, st.sampled_from([(0.999, 90.0), (0.6, 90.0), (0.3, 180.0)]))
def test_random_motions(seed, limits):
    """Anything that moves may move, ends, middles, limbs, in any order: thin bars get far."""
    rng = np.random.default_rng(seed)
    check(wander(rng, int(rng.integers(3, 40)), int(rng.integers(0, 25)), *limits), *limits)


@pytest.mark.slow
@settings(max_examples=600)
@given(SEEDS, st.sampled_from([(0.999, 90.0), (0.6, 90.0), (0.3, 180.0)]))
def test_long_random_motions(seed, limits):
    rng = np.random.default_rng(seed)
    check(wander(rng, int(rng.integers(3, 120)), int(rng.integers(0, 100)), *limits), *limits)


def there_and_back(unfold, fold):
    """From one shape to a line and on to another shape of as many voxels."""
    moves = np.vstack([unfold.moves, reversed_motion(fold).moves])
    return motion(unfold.start, moves, straight=False)


PEEL, SWING, DOOR = kinematics.Move.PEEL, kinematics.Move.SWING, kinematics.Move.DOOR
UP, NORTH = grid.LETTERS.index("U"), grid.LETTERS.index("N")
BLOCK, SHEET = boustrophedon(4, 3, 5), boustrophedon(10, 6, 1)
LONG = {
    "from one end": peeled(BLOCK, UP),
    "from both ends": peeled_from_both_ends(BLOCK, UP),
    "a sheet": peeled_from_both_ends(SHEET, NORTH),
}
LONG |= {f"{name}, folding": reversed_motion(unfold) for name, unfold in LONG.items()}
LONG["from shape to shape"] = there_and_back(
    LONG["from both ends"], peeled(boustrophedon(5, 6, 2), UP)
)


@pytest.mark.parametrize("name", LONG)
def test_long_motions_are_good_as_they_are(name):
    assert lu.certify(LONG[name]).ok
    assert check(LONG[name]) == ""


def planted(good, fault, rng):
    """A motion with something wrong, or at least odd, in it."""
    k = int(rng.integers(len(good)))
    moves = good.moves.tolist()
    kind, joint, other, value = moves[k]
    if fault == "skipped":
        del moves[k]
    elif fault == "swapped":
        moves[k : k + 2] = moves[k : k + 2][::-1]
    elif fault == "to another side":
        moves[k] = kind, joint, other, int(rng.integers(6))
    elif fault == "at another joint":
        by = int(rng.choice([-2, -1, 1, 2]))
        moves[k] = kind, joint + by, other + by, value
    elif fault == "whole end instead of a rod":
        moves[k] = 1 - kind, joint, other, value
    else:
        candidates = turns(pose_before(good, k))
        moves.insert(k, candidates[rng.integers(len(candidates))])
    return motion(good.start, moves, good.straight)


# What is wrong, and what has to be found for it somewhere; some of these are harmless elsewhere.
PLANTED = {
    "skipped": "malformed",
    "swapped": "",
    "to another side": "touch",
    "at another joint": "malformed",
    "whole end instead of a rod": "touch",
    "any move put in": "touch",
}


@examples(60)
@given(st.sampled_from(sorted(LONG)), st.sampled_from(sorted(PLANTED)), SEEDS)
def test_faults_deep_inside_long_motions(name, fault, seed):
    check(planted(LONG[name], fault, np.random.default_rng(seed)))


@pytest.mark.slow
@pytest.mark.parametrize("fault", PLANTED)
def test_planted_faults_are_faults(fault):
    rng = np.random.default_rng(5)
    found = {check(planted(LONG[name], fault, rng)) for name in LONG for _ in range(30)}
    assert PLANTED[fault] in found


@pytest.mark.slow
@pytest.mark.skipif("LINEUP_MODELS" not in os.environ, reason="needs meshes in LINEUP_MODELS")
@pytest.mark.parametrize("fault", [None, *PLANTED])
def test_faults_in_the_motion_of_a_mesh(folding, fault):
    rng = np.random.default_rng(7)
    for good in (folding.motion, reversed_motion(folding.motion)):
        check(planted(good, fault, rng) if fault else good)


@pytest.fixture(scope="module")
def folding():
    return lu.fold(lu.model("bunny", voxels=800))


def rested(joints, moves):
    """A chain under a sheet that, once its last bar has waved for long, is a body found by place.

    Of its last three joints a hinge, a corner sqrt(2) from it, and the bar that waves.
    """
    sheet = [(-(2 - x if y % 2 == 0 else x), y, 0) for y in range(17, 3, -1) for x in range(3)]
    start = np.array([*sheet, *joints])
    last = len(start) - 1
    waves = [(PEEL, last - 1, last, UP), (PEEL, last - 1, last, NORTH)] * 60
    moves = [(kind, joint % len(start), other % len(start), to) for kind, joint, other, to in moves]
    return lu.certify(motion(start, [*waves, *moves], False), 0.5)


def test_a_corner_that_passes_between_lattice_points_is_seen_by_place():
    joints = walk("SSWWSSEEEN", (0, 4, 0))[1:]
    verdict = rested(joints, [(SWING, -3, -2, NORTH)])
    assert verdict.clearance == pytest.approx(2 - np.sqrt(2))
    assert verdict.nearest[0] == 120


def test_a_limb_of_the_body_is_seen_where_it_has_turned_to():
    """A bump of two bars' width turns down into the way of the corner."""
    joints = walk("SUWDWSSSEEEN", (0, 4, 0))[1:]
    door, swing = (DOOR, -12, -9, -1), (SWING, -3, -2, NORTH)
    assert rested(joints, [swing]).clearance == 1
    verdict = rested(joints, [door, swing])
    assert verdict.clearance == pytest.approx(2 - np.sqrt(2))
    assert verdict.nearest[0] == 121
