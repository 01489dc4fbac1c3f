"""What the slots of the printed block let a chain do, against poses sampled during the moves."""

import numpy as np
import pytest
from examples import examples
from hypothesis import assume, given
from hypothesis import strategies as st
from oracles import reversed_motion
from test_judging import boustrophedon, motion, peeled, walk
from test_judging_bends import bent, quarters, turnings
from test_judging_sampled import chains, single, turns

import lineup as lu
from lineup import grid
from lineup.joints import slot_violations
from lineup.kinematics import QUARTER, Move, moved

EAST, NORTH, UP, WEST, SOUTH, DOWN = range(6)


def oblique(pose, bar):
    """Whether the hinges at both ends of a capsule are bent, in planes neither one nor square."""
    before, capsule, after = (pose[k + 1] - pose[k] for k in (bar - 1, bar, bar + 1))
    sides = [np.cross(capsule, before), np.cross(capsule, after)]
    if min(np.linalg.norm(side) for side in sides) < 1e-4:
        return False
    first, second = (side / np.linalg.norm(side) for side in sides)
    return 1e-3 < abs(first @ second) < 1 - 1e-6


def twisted(trial, samples):
    """Rows (move, bar) of `slot_violations`, by sampling."""
    rows, pose = [], trial.start.astype(float)
    for k, move in enumerate(trial.moves):
        poses = [moved(pose, move, trial, t) for t in np.linspace(0, 1, samples)]
        bars = range(1, len(pose) - 2, 2)
        rows += [(k, bar) for bar in bars if any(oblique(p, bar) for p in poses)]
        pose = poses[-1] if move[0] == Move.BEND else np.rint(poses[-1])
    return rows


def even(start):
    return start[: len(start) - len(start) % 2]


@examples(240)
@given(chains(), st.data())
def test_peels_swings_and_doors_agree_with_sampling(start, data):
    start = even(start)
    rows = turns(start)
    assume(rows)
    trial = single(start, data.draw(st.sampled_from(rows)))
    assert slot_violations(trial).tolist() == [list(row) for row in twisted(trial, 9)]


@examples(120)
@given(chains(), st.data())
def test_turns_in_a_row_agree_with_each_by_itself(start, data):
    pose, rows, alone = even(start), [], []
    for k in range(6):
        could = turns(pose)
        if not could or len(np.unique(pose, axis=0)) < len(pose):
            break
        rows.append(data.draw(st.sampled_from(could)))
        trial = single(pose, rows[-1])
        alone += [[k, bar] for _, bar in slot_violations(trial).tolist()]
        pose = np.rint(moved(pose.astype(float), trial.moves[0], trial, 1.0)).astype(np.int32)
    assert slot_violations(motion(even(start), rows)).tolist() == alone


@examples(240)
@given(chains(), st.data())
def test_tilts_agree_with_sampling(start, data):
    start = even(start)
    bars = grid.bar_directions(start).tolist()
    to_one_way = data.draw(st.booleans())
    target = [
        data.draw(st.sampled_from(sorted({d, (d + 1) % 6, (d + 2) % 6, (d + 4) % 6}))) for d in bars
    ]
    if to_one_way:
        target = [data.draw(st.integers(0, 5))] * len(bars)
        assume(all((d + 3) % 6 != target[0] for d in bars))
    trial = single(start, (Move.TILT, 0, len(bars), 0), target)
    assert slot_violations(trial).tolist() == [list(row) for row in twisted(trial, 17)]


@examples(80)
@given(chains(max_bars=8), st.booleans(), st.integers(0, 5))
def test_pulls_agree_with_sampling(start, by_the_last, value):
    start = even(start)
    last, step = len(start) - 1, grid.DIRECTIONS[value]
    head = start[-1] - start[-2] if by_the_last else start[0] - start[1]
    assume((head + step).any())
    row = (Move.PULL, last, 0, value) if by_the_last else (Move.PULL, 0, last, value)
    trial = single(start, row)
    assert slot_violations(trial).tolist() == [list(r) for r in twisted(trial, 40 * len(start))]


@examples(100)
@given(turnings())
def test_bends_agree_with_sampling(trial):
    start = even(trial.start)
    angles = trial.angles[:, : len(start) - 1]
    assume(np.diff(angles, axis=0).any())
    trial = bent(start, int(trial.moves[0, 1]), angles, straight=False)
    found = slot_violations(trial).tolist()
    seen = [list(row) for row in twisted(trial, 65)]
    assert all(row in found for row in seen)
    # A turn of less than the 1e-3 that `oblique` sees is none to it.
    steps = np.abs(np.diff(np.diff(angles, axis=0)))
    assert found == seen or steps[steps > 0].min() < 2000


# Bar 1 is the capsule; each row says which bars it can twist between.
TURNS = {
    "hinge swings about a capsule that is bent": ("ENU", (Move.SWING, 2, 3, EAST), [[0, 1]]),
    "hinge swings about a capsule that is straight": ("NNU", (Move.SWING, 2, 3, EAST), []),
    "hinge bends in the plane of the other bend": ("ENE", (Move.SWING, 2, 3, NORTH), []),
    "hinge bends across the plane of the other bend": ("ENN", (Move.SWING, 2, 3, UP), []),
    "capsule swings about a hinge": ("ENUEN", (Move.SWING, 3, 4, NORTH), []),
    "peel of a hinge beside a capsule": ("ENUUE", (Move.PEEL, 2, 3, WEST), [[0, 1]]),
    "peel of a hinge between two capsules": (
        "ENUNE",
        (Move.PEEL, 2, 3, EAST),
        [[0, 1], [0, 3]],
    ),
    "peel of a capsule": ("ENU", (Move.PEEL, 1, 2, WEST), []),
    "door on straight capsules": ("EEENWWW", (Move.DOOR, 2, 5, 1), []),
    "door that begins with a capsule on its axis": (
        "UNENWUE",
        (Move.DOOR, 1, 5, 1),
        [[0, 1]],
    ),
    "door on bent capsules": ("UENWU", (Move.DOOR, 1, 4, 1), []),
}


@pytest.mark.parametrize("name", TURNS)
def test_moves_by_hand(name):
    word, row, rows = TURNS[name]
    trial = single(walk(word), row)
    assert slot_violations(trial).tolist() == rows
    assert [list(r) for r in twisted(trial, 9)] == rows


def test_free_joints_are_not_asked_about():
    crank = single(walk("ENU"), (Move.SWING, 2, 3, EAST))
    free, slotted = lu.certify(crank), lu.certify(crank, joints="slotted")
    assert (free.where, free.violations, slotted.violations) == (-1, 0, 1)


def test_the_first_move_against_the_slots_is_named_and_all_are_counted():
    moves = [
        (Move.SWING, 2, 3, EAST),
        (Move.SWING, 2, 3, UP),
        (Move.SWING, 2, 3, NORTH),
        (Move.SWING, 1, 2, EAST),
    ]
    straightened = motion(walk("ENU"), moves)
    assert lu.certify(straightened).ok
    verdict = lu.certify(straightened, joints="slotted")
    assert (verdict.ok, verdict.where, verdict.violations, verdict.moves_checked) == (
        False,
        0,
        2,
        4,
    )
    assert verdict.reason == "bar 1 would twist in its slots, bent at both ends"
    gentle = motion(walk("ENU"), moves[2:])
    assert lu.certify(gentle, joints="slotted").ok
    assert lu.certify(reversed_motion(gentle), joints="slotted").ok


def test_a_flat_shape_keeps_to_the_slots():
    """Peels in its own plane, and a bend of it, leave every plane what it is."""
    flat = peeled(boustrophedon(6, 5, 1), NORTH)
    assert lu.certify(flat, joints="slotted").ok
    start = flat.start
    rows = [quarters(start, 2), np.full(len(start) - 1, QUARTER)]
    assert lu.certify(bent(start, 2, rows), joints="slotted").ok


def test_a_fault_of_the_motion_comes_before_one_of_the_slots():
    crank = motion(walk("ENU"), [(Move.SWING, 2, 3, EAST), (Move.SWING, 2, 3, EAST)])
    verdict = lu.certify(crank, joints="slotted")
    assert verdict.reason.startswith("malformed: (SWING, 2, 3, 0)")
    assert (verdict.where, verdict.violations) == (1, 1)


def test_a_bend_goes_on_out_of_the_slots():
    """The hinges beside capsule 1, which lies along z, turn apart and then as one."""
    rows = np.array([[0, 0, QUARTER], [0, 0, 5], [7, 0, 12]])
    assert slot_violations(bent(walk("EUN"), 2, rows, False)).tolist() == [[0, 1], [1, 1]]
    rows = np.array([[0, 0, QUARTER], [0, 0, 2 * QUARTER]])  # from square to square
    assert slot_violations(bent(walk("EUN"), 2, rows, False)).tolist() == [[0, 1]]


def test_half_a_block_is_refused():
    verdict = lu.certify(motion(walk("EE"), []), joints="slotted")
    assert verdict.reason == "start: 3 joints are no chain of blocks, which have two each"
    with pytest.raises(ValueError, match="even number of joints, got 3"):
        slot_violations(motion(walk("EE"), []))


NO_TURNS = {
    "a bar to its own direction": (Move.PEEL, 1, 2, EAST),
    "a bar straight back": (Move.SWING, 1, 2, WEST),
    "to no direction": (Move.PEEL, 1, 2, 6),
    "two bars as one": (Move.PEEL, 1, 3, NORTH),
    "a bar beyond the end": (Move.SWING, 3, 4, UP),
    "a door off the lattice": (Move.DOOR, 0, 3, 1),
    "a door backwards": (Move.DOOR, 2, 0, 1),
    "a door by half a turn": (Move.DOOR, 0, 2, 2),
}


@pytest.mark.parametrize("row", NO_TURNS.values(), ids=NO_TURNS)
def test_a_move_that_turns_nothing_by_90_degrees_is_refused(row):
    with pytest.raises(ValueError, match=r"move \[.*\] does not turn a bar by 90 degrees"):
        slot_violations(motion(walk("EEN"), [row]))


def test_unknown_joints_are_refused():
    with pytest.raises(ValueError, match="unknown joints 'ball'; known: free, slotted"):
        lu.certify(motion(walk("E"), []), joints="ball")
