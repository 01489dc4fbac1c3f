"""Motions that the judge must certify, and the faults that it must find."""

import numpy as np
import pytest
from chains import EAST, NORTH, SOUTH, UP, WEST, boustrophedon, motion, peeled, walk
from oracles import reversed_motion

import lineup as lu
from lineup import grid
from lineup.kinematics import Move


def spiral(turns):
    word = "".join(c * ((k + 3) // 2) for k, c in zip(range(turns), "ENWS" * turns, strict=False))
    return walk(word)[::-1]


GOOD = {
    "one voxel": motion([(5, 5, 5)], []),
    "one bar": motion(walk("N"), []),
    "straight already": motion(walk("EEEEE"), []),
    "block": peeled(boustrophedon(5, 4, 3), UP),
    "flat": peeled(boustrophedon(6, 5, 1), NORTH),
    "spiral from its rim": peeled(spiral(9), UP),
    "spiral from its middle": peeled(spiral(9)[::-1], UP),
    "stair tilted": motion(walk("ENUUEE"), [(Move.TILT, 0, 6, 0)], poses=[[UP] * 6]),
    "swing": motion(walk("EEENNN"), [(Move.SWING, 3, 4, EAST)]),
    "swing of end 0": motion(walk("EEENNN"), [(Move.SWING, 3, 2, SOUTH)]),
}


@pytest.mark.parametrize("name", GOOD)
def test_good_motions_are_certified_both_ways(name):
    good = GOOD[name]
    there, back = lu.certify(good), lu.certify(reversed_motion(good))
    assert (there.ok, there.reason, there.where) == (True, "certified", -1)
    assert there.moves_checked == len(good)
    assert back.ok
    assert (there.clearance, there.bend_deg) == (back.clearance, back.bend_deg)
    assert there.clearance == (1.0 if len(good.start) > 3 else np.inf)
    assert there.bend_deg == (90.0 if len(good) else 0.0)


def test_no_tolerance_is_needed_for_touching_blocks():
    assert lu.certify(GOOD["block"], diameter=1.0).ok


def test_a_shape_may_unfold_to_a_line_and_fold_to_another():
    unfold, fold = GOOD["flat"], reversed_motion(peeled(boustrophedon(3, 10, 1), NORTH))
    assert (np.diff(fold.start, axis=0) == (0, 1, 0)).all()
    both = motion(unfold.start, np.vstack([unfold.moves, fold.moves]), straight=False)
    assert lu.certify(both).ok


# Planted faults: what is wrong, the move that fails (-1: start or end), the judge's words.
BLOCK, FLAT = GOOD["block"], GOOD["flat"]
LINE = motion(walk("EEEE"), [], straight=True)
SWAPPABLE = motion(
    walk("EEEENUS"),
    [
        (Move.DOOR, 4, 7, -1),
        (Move.DOOR, 4, 7, 1),
        (Move.DOOR, 4, 7, -1),
        (Move.SWING, 5, 6, EAST),
        (Move.PEEL, 7, 6, WEST),
    ],
)
ROD_TIP_RISES = walk("EDDDWWUEU", start=(1, 0, 2))


def altered(good, k, row=None, **fields):
    """A motion with move k left out or replaced."""
    moves = good.moves.tolist()
    moves[k : k + 1] = [] if row is None else [row]
    return motion(good.start, moves, **fields)


def swapped(good, k):
    moves = good.moves.tolist()
    moves[k : k + 2] = moves[k + 1], moves[k]
    return motion(good.start, moves)


def one(word, move, **fields):
    return motion(walk(word), [move], **fields)


def tilt(word, target, **fields):
    bars = len(word)
    pose = [grid.LETTERS.index(c) for c in target]
    return one(word, (Move.TILT, 0, bars, 0), poses=[pose], **fields)


FAULTS = {
    "no voxel": (motion(np.empty((0, 3), int), []), -1, "start: it has no voxel"),
    "voxel twice": (
        motion(walk("EENWSUU"), []),
        -1,
        "start: steps 1 and 5 visit one voxel",
    ),
    "gap": (
        motion(np.delete(BLOCK.start, 7, axis=0), []),
        -1,
        "start: voxels 6 and 7 do not share a face",
    ),
    "shortened bar": (
        motion(BLOCK.start[[0, 1, 1, 2]], []),
        -1,
        "start: voxels 1 and 2 do not share a face",
    ),
    "diagonal bar": (
        motion([(0, 0, 0), (1, 0, 0), (2, 1, 0)], []),
        -1,
        "start: voxels 1 and 2 do not share a face",
    ),
    "rod through a voxel": (
        one("EENNWWSE", (Move.PEEL, 6, 7, WEST)),
        0,
        "come within 0, less than the diameter 0.999",
    ),
    "peel into what it carries": (
        one("EESWW", (Move.PEEL, 0, 1, NORTH)),
        0,
        "bars 0 and 3 come within 0,",
    ),
    "rod tip rises past a voxel": (
        motion(ROD_TIP_RISES, [(Move.PEEL, 7, 8, UP)]),
        0,
        "bars 0 and 8 come within 0.414214,",
    ),
    "rod sweeps over a voxel": (
        one("EEEEUNNWD", (Move.SWING, 4, 3, NORTH)),
        0,
        "bars 1 and 8 come within 0,",
    ),
    "arc through the middle of a bar": (
        one("NNWWDSSSEEEU", (Move.SWING, 9, 10, NORTH)),
        0,
        "bars 0 and 11 come within 0,",
    ),
    "limb of a door touches": (
        one("DDESENUWU", (Move.DOOR, 3, 6, -1)),
        0,
        "bars 3 and 8 come within 0,",
    ),
    "swapped moves": (swapped(SWAPPABLE, 0), 0, "bars 2 and 4 come within 0,"),
    "bend of 180": (
        one("EEN", (Move.SWING, 2, 3, WEST), straight=False),
        0,
        "come within 0,",
    ),
    "bend of 180, no bars two apart": (
        one("EN", (Move.SWING, 1, 2, WEST), straight=False),
        0,
        "bend of 180 degrees at joint 1",
    ),
    "antiparallel target": (
        one("EN", (Move.SWING, 1, 2, SOUTH)),
        0,
        "malformed: (SWING, 1, 2, 4) must turn its bar to a direction 0..5 perpendicular",
    ),
    "bar that lies there already": (
        one("EN", (Move.PEEL, 1, 2, NORTH)),
        0,
        "malformed: (PEEL, 1, 2, 1) must turn",
    ),
    "no such direction": (
        one("EN", (Move.PEEL, 1, 2, 6)),
        0,
        "malformed: (PEEL, 1, 2, 6) must turn",
    ),
    "wrong direction": (
        altered(FLAT, 3, (Move.PEEL, 25, 26, SOUTH)),
        3,
        "come within 0,",
    ),
    "skipped move": (altered(FLAT, 10), -1, "not straight: the last pose bends at joint 16"),
    "shifted joints": (
        altered(FLAT, 3, (Move.PEEL, 26, 27, NORTH)),
        3,
        "malformed: (PEEL, 26, 27, 1) must turn",
    ),
    "joint that is not there": (
        altered(FLAT, 5, (Move.PEEL, 29, 30, NORTH)),
        5,
        "malformed: (PEEL, 29, 30, 1) names joints that",
    ),
    "negative joint": (
        one("EN", (Move.PEEL, 0, -1, UP)),
        0,
        "malformed: (PEEL, 0, -1, 2) names joints that",
    ),
    "joints that are no bar": (
        altered(FLAT, 5, (Move.PEEL, 22, 24, NORTH)),
        5,
        "malformed: (PEEL, 22, 24, 1) names joints that",
    ),
    "unknown kind": (altered(FLAT, 2, (9, 26, 27, 1)), 2, "malformed: (9, 26, 27, 1) is of no"),
    "door off the lattice lines": (
        one("ENWUE", (Move.DOOR, 0, 5, 1)),
        0,
        "malformed: (DOOR, 0, 5, 1) must turn by value 1 or -1 about a lattice line",
    ),
    "door by a half turn": (
        one("ENW", (Move.DOOR, 0, 3, 2)),
        0,
        "malformed: (DOOR, 0, 3, 2) must turn by value 1 or -1",
    ),
    "door that turns nothing": (
        one("EEE", (Move.DOOR, 0, 3, 1)),
        0,
        "malformed: (DOOR, 0, 3, 1) must turn by value 1 or -1",
    ),
    "door without a limb": (
        one("ENW", (Move.DOOR, 1, 2, 1)),
        0,
        "malformed: (DOOR, 1, 2, 1) names joints that",
    ),
    "door backwards": (
        one("ENW", (Move.DOOR, 3, 0, 1)),
        0,
        "malformed: (DOOR, 3, 0, 1) names joints that",
    ),
    "one move early": (
        motion(FLAT.start, FLAT.moves[:-1]),
        -1,
        "not straight: the last pose bends at joint 1",
    ),
    "straight flag lies": (
        motion(FLAT.start, FLAT.moves, straight=False),
        -1,
        "ends straight, but the motion says that it does not",
    ),
    "straight nowhere": (
        motion(FLAT.start, FLAT.moves[:-1], straight=False),
        -1,
        "ends not straight, and is straight nowhere before",
    ),
    "tilt against": (
        tilt("UEDE", "UUDU"),
        0,
        "not monotone: bar 2 steps against the others' direction",
    ),
    "tilt apart": (tilt("EUN", "UUW"), 0, "not monotone: its bars neither turn all to one"),
    "tilt beside a resting bar": (
        tilt("EUUWU", "UUUWU"),
        0,
        "not monotone: bar 3 rests on an axis of bars that turn",
    ),
    "tilt of nothing": (tilt("UU", "UU"), 0, "malformed: (TILT, 0, 2, 0) must turn some bars"),
    "tilt by a half turn": (tilt("EU", "WU"), 0, "malformed: (TILT, 0, 2, 0) must turn some bars"),
    "tilt onto itself": (
        tilt("UUUU", "ENWS", straight=False),
        0,
        "the tilt's last pose is not simple: steps 0 and 4 visit one voxel",
    ),
    "tilt without a pose": (
        one("EU", (Move.TILT, 0, 2, 0)),
        0,
        "malformed: (TILT, 0, 2, 0) has no row in poses of shape (0, 2)",
    ),
    "tilt to no direction": (
        one("EU", (Move.TILT, 0, 2, 0), poses=[[2, 6]]),
        0,
        "malformed: (TILT, 0, 2, 0) leads to a direction outside 0..5",
    ),
    "tilt of a part": (
        one("EU", (Move.TILT, 0, 1, 0), poses=[[2, 2]]),
        0,
        "malformed: (TILT, 0, 1, 0) must name the joints 0 and 2",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_planted_faults_are_refused(name):
    bad, where, words = FAULTS[name]
    verdict = lu.certify(bad)
    assert not verdict.ok
    assert verdict.where == where
    assert words in verdict.reason
    if where >= 0:
        assert verdict.moves_checked == where + 1


def test_the_motion_that_is_swapped_above_is_good():
    assert lu.certify(SWAPPABLE).ok


@pytest.mark.parametrize("k", range(len(FLAT)))
def test_no_move_can_be_skipped_or_doubled(k):
    assert not lu.certify(altered(FLAT, k)).ok
    doubled = motion(FLAT.start, np.insert(FLAT.moves, k, FLAT.moves[k], axis=0))
    verdict = lu.certify(doubled)
    assert verdict.where == k + 1
    assert verdict.reason.startswith("malformed")


def test_a_doctored_record_is_judged_by_what_it_holds():
    """Bars of float length never enter a record; written in behind its back, they are seen."""
    bad = motion(FLAT.start, FLAT.moves)
    start = FLAT.start.astype(float)
    start[4:] -= (0.5, 0, 0)
    object.__setattr__(bad, "start", start)
    verdict = lu.certify(bad)
    assert verdict.reason == "start: voxels 3 and 4 do not share a face"
    assert np.isnan(verdict.extent).all()
    with pytest.raises(ValueError, match="start must be an integer array"):
        motion(start, FLAT.moves)


def test_what_a_motion_says_of_itself_is_not_used():
    boast = lu.Motion(FLAT.start, FLAT.moves, 0.1, 180.0, True, "certified, of course")
    verdict = lu.certify(boast, diameter=1.01)
    assert verdict.reason == "start: bars 0 and 2 are 1 apart"
    assert (verdict.ok, verdict.diameter, verdict.max_bend_deg) == (False, 1.01, 90.0)


def test_thin_bars_pass_where_thick_ones_touch():
    tip = motion(ROD_TIP_RISES, [(Move.PEEL, 7, 8, UP)], straight=False)
    assert "straight nowhere" in lu.certify(tip, diameter=0.41421).reason
    assert "come within" in lu.certify(tip, diameter=0.41422).reason


def test_bends_are_judged_at_the_limit_given():
    assert lu.certify(FLAT, max_bend_deg=89.0).reason == "start: bend of 90 degrees at joint 5"
    fold = one("EE", (Move.SWING, 1, 2, UP), straight=False)
    assert lu.certify(fold).ok
    assert lu.certify(fold, max_bend_deg=89.0).reason == "bend of 90 degrees at joint 1"


@pytest.mark.parametrize("diameter", [0.0, -1.0, np.nan, np.inf])
def test_bad_diameters_are_refused(diameter):
    with pytest.raises(ValueError, match="diameter must be a positive number"):
        lu.certify(LINE, diameter=diameter)


@pytest.mark.parametrize("bend", [0.0, -90.0, 180.1, np.nan])
def test_bad_bends_are_refused(bend):
    with pytest.raises(ValueError, match="max_bend_deg must be"):
        lu.certify(LINE, max_bend_deg=bend)
