"""The lemmas of docs/motion.md on whole motions: locality, end game, reversal, parity.

Judged by point sets and by sampling all pairs of bars, on random paths.
"""

import itertools
from collections import deque

import numpy as np
import pytest
from examples import examples
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from oracles import (
    pose_bend_deg,
    reversed_motion,
    rod_fault,
    rod_rule,
    segment_distances,
    swept_points,
)
from polycubes import STEPS, polycubes
from walks import beside, paths, walks

import lineup as lu
from lineup import grid, kinematics
from lineup.kinematics import QUARTER, Move
from lineup.motion.plan import motion_of, states_of

EXACT, DEG = 1e-9, 1e-6
EAST, NORTH, UP, WEST, SOUTH, DOWN = range(6)


def word(letters, origin=(0, 0, 0)):
    steps = [grid.DIRECTIONS[grid.LETTERS.index(c)] for c in letters]
    return np.vstack([origin, *steps]).cumsum(axis=0)


def motion(start, rows, straight=True, **fields):
    rows = np.array(rows, int).reshape(-1, 4)
    return lu.Motion(start, rows, 1.0, 90.0, straight, "for a test", **fields)


def seen(moved):
    """Least distance of bars two or more apart, and largest bend, at twelve moments of a move."""
    poses = list(lu.frames(moved, substeps=12))
    k, m = np.triu_indices(len(moved.start) - 1, 2)
    ends = [np.concatenate([pose[joint] for pose in poses]) for joint in (k, k + 1, m, m + 1)]
    return segment_distances(*ends).min(initial=np.inf), max(map(pose_bend_deg, poses))


def keeps_clear(moved):
    """Whether all that is seen of a motion has clearance 1 and bends of at most 90 degrees."""
    clearance, bend_deg = seen(moved)
    return clearance >= 1 - EXACT and bend_deg <= 90 + DEG


@st.composite
def plans(draw, max_bars=12):
    """A walk and a peel plan that straightens it: voxels, and states as lists."""
    voxels = draw(walks(min_bars=5, max_bars=max_bars))
    unfolding = lu.unfold(lu.VoxelPath(voxels), "peel", tries=2, patience=200)
    assume(unfolding.straight)
    return voxels, states_of(unfolding).tolist()


# Lemmas 6, 7: infinite rods, locality -------------------------------------------------------------


@given(plans())
@settings(max_examples=15, deadline=None)
def test_a_plan_with_infinite_rods_keeps_clear(plan):
    voxels, states = plan
    assert rod_fault(voxels, states) == ""
    assert keeps_clear(motion_of(voxels, np.array(states)))


def ways(start, goal, blocked, longest):
    """All simple ways from start to goal of at most so many steps, past what is blocked."""
    todo = [(start,)]
    while todo:
        way = todo.pop()
        if way[-1] == goal:
            yield way
        elif len(way) <= longest:
            near = sorted(v for v in beside(way[-1]) if v not in blocked and v not in way)
            todo += [(*way, v) for v in near]


@st.composite
def changes(draw):
    """A plan, joints o and t that one end passes while the other rests, and a new way there.

    The states at which the end is last at joint o and first at joint t come with them.
    """
    voxels, states = draw(plans())
    end = draw(st.integers(0, 1))
    passed = sorted({s[end] for s in states}, reverse=bool(end))
    assume(len(passed) > 1)
    k = draw(st.integers(0, len(passed) - 2))
    o, t = passed[k], passed[min(k + draw(st.integers(1, 3)), len(passed) - 1)]
    first = max(m for m, s in enumerate(states) if s[end] == o)
    last = min(m for m, s in enumerate(states) if s[end] == t)
    rests = {tuple(s[1 - end :: 2]) for s in states[first : last + 1]}
    assume(len(rests) == 1)
    low, high = min(o, t), max(o, t)
    points = [tuple(v) for v in voxels.tolist()]
    others = set(points[: low + 1] + points[high:]) - {points[high]}
    new = draw(st.sampled_from(sorted(ways(points[low], points[high], others, high - low + 2))))
    assume(list(new) != points[low : high + 1])
    changed = np.array(points[:low] + list(new) + points[high + 1 :])
    return voxels, states, changed, end, (o, t), (first, last)


def spliced(states, changed, end, span, places, reach):
    """The plan with its piece from place to place led past the changed joints anew, if it can be.

    Only the piece is searched, under the rules; all before and after is taken over.
    """
    (o, t), (first, last) = span, places
    grown = len(changed) - 1 - max(s[1] for s in states)

    def shifted(state):
        a, b, da, db = state
        high = max(o, t)
        return [a + grown * (a >= high), b + grown * (b >= high), da, db]

    entry, leave = shifted(states[first]), shifted(states[last])
    came, todo = {tuple(entry): None}, deque([entry])
    inward = (1, -1)[end]
    while todo and tuple(leave) not in came:
        old = todo.popleft()
        nexts = [[*old] for _ in range(7)]
        nexts[6][end] += inward
        for d in range(6):
            nexts[d][2 + end] = d
        for new in nexts:
            beyond = (new[end] - leave[end]) * inward > 0
            if not beyond and tuple(new) not in came and not rod_rule(changed, old, new):
                came[tuple(new)] = old
                todo.append(new)
    if tuple(leave) not in came:
        return None
    route = [leave]
    while route[-1] != entry:
        route.append(came[tuple(route[-1])])
    return (
        [shifted(s) for s in states[:first]]
        + route[::-1]
        + [shifted(s) for s in states[last + 1 :]]
    )


@given(changes())
@examples(60)
def test_a_change_that_passes_the_rule_leaves_a_valid_plan(change):
    voxels, states, changed, end, span, places = change
    reach = int(np.ptp(np.vstack([voxels, changed]), axis=0).max()) + 1
    new = {tuple(v) for v in changed.tolist()} - {tuple(v) for v in voxels.tolist()}
    assume(new.isdisjoint(swept_points(voxels, states, places[0], reach)))
    plan = spliced(states, changed, end, span, places, reach)
    assume(plan is not None)
    assert rod_fault(changed, plan) == ""
    assert keeps_clear(motion_of(changed, np.array(plan)))


def test_a_new_voxel_in_an_earlier_sweep_is_hit_by_it():
    """The first condition of locality: all rules hold for the new piece, yet a rod hits it."""
    voxels = word("DDDEEEE", origin=(-1, 0, 3))
    peels = [(0, b, EAST, UP) for b in (7, 6, 5, 4)]
    states = [*peels, *((0, b, EAST, SOUTH) for b in (4, 3, 2, 1))]
    assert rod_fault(voxels, states) == ""
    assert keeps_clear(motion_of(voxels, np.array(states)))
    changed = np.insert(voxels, 1, [(0, 0, 3), (0, 0, 2)], axis=0)
    assert {(0, 0, 3), (0, 0, 2)} <= swept_points(voxels, states, len(peels), 9)
    states = [(a, b + 2, da, db) for a, b, da, db in states]
    states += [(0, b, EAST, SOUTH) for b in (2, 1)]
    assert rod_fault(changed[:7], [(0, 6, EAST, SOUTH), *states[5:]]) == ""
    assert rod_fault(changed, states) == "step 2: the ray after a peel of end 1 is blocked"
    assert seen(motion_of(changed, np.array(states)))[0] < EXACT


def test_with_rods_as_long_as_they_are_a_change_elsewhere_breaks_a_later_move():
    """The same two peels keep clear of a voxel until two more joints make the rod longer."""
    short = word("WDDDDEEE", origin=(0, 0, 4))
    peels = [(Move.PEEL, 7, 8, UP), (Move.PEEL, 6, 7, UP)]
    assert keeps_clear(motion(short, peels))
    longer = np.insert(short, 8, [(1, -1, 0), (2, -1, 0)], axis=0)
    first = [(Move.PEEL, b, b + 1, UP) for b in (9, 8)]
    assert keeps_clear(motion(longer, [*first, (Move.PEEL, 7, 8, UP)]))
    everything = [*first, (Move.PEEL, 7, 8, UP), (Move.PEEL, 6, 7, UP)]
    assert seen(motion(longer, everything))[0] < EXACT


# Lemma 8: end game --------------------------------------------------------------------------------


@pytest.mark.parametrize("lengths", list(itertools.product((0, 1, 3), repeat=2)))
def test_the_last_bar_is_lined_up_by_two_free_swings_at_most(lengths):
    for da, db in itertools.product(range(6), repeat=2):
        if da == EAST or db == WEST:  # a rod would lie on the bar
            continue
        rod_a, rod_b = (
            np.outer(np.arange(1, n + 1), grid.DIRECTIONS[d])
            for n, d in zip(lengths, (da, db), strict=True)
        )
        voxels = np.vstack([rod_a[::-1], [(0, 0, 0), (1, 0, 0)], np.array([1, 0, 0]) + rod_b])
        a = lengths[0]
        last = motion_of(voxels, np.array([(a, a + 1, da, db)]))
        assert len(last) == (a > 0 and da != WEST) + (lengths[1] > 0 and db != EAST)
        assert keeps_clear(last)
        assert pose_bend_deg(list(lu.frames(last))[-1]) == 0


# Lemma 9: reversal, and A -> line -> B ------------------------------------------------------------


def backwards(pose, after, row, n_poses):
    """The row of the reversed move, from the poses before and after."""
    kind, joint, other, value = row
    if kind == Move.DOOR:
        return kind, joint, other, -value
    if kind == Move.PULL:
        return kind, other, joint, STEPS.index(tuple(pose[other] - after[other]))
    if kind == Move.TILT:
        return kind, joint, other, n_poses - 1
    if kind == Move.BEND:
        return kind, joint, value, other
    return kind, joint, other, STEPS.index(tuple(pose[other] - pose[joint]))


def quarters(bars, axis):
    """Angles of a lattice pose's bars about an axis, for a BEND; 0 for bars along it."""
    across = np.delete(bars, axis, axis=1)
    angle = np.arctan2(bars[:, (axis + 2) % 3], bars[:, (axis + 1) % 3])
    return np.where(across.any(axis=1), np.rint(angle / (np.pi / 2)), 0).astype(int) * QUARTER


@st.composite
def moves(draw):
    """One move of any kind, of a random pose, whether or not it is free of collisions."""
    start, kind = draw(paths()), draw(st.sampled_from(list(Move)))
    last, bars = len(start) - 1, np.diff(start, axis=0)
    joint = draw(st.integers(0, last))
    other = draw(st.sampled_from([k for k in (joint - 1, joint + 1) if 0 <= k <= last]))
    fields = {}
    if kind in (Move.PEEL, Move.SWING):
        along = int(np.abs(start[other] - start[joint]).argmax())
        row = (kind, joint, other, draw(st.sampled_from([d for d in range(6) if d % 3 != along])))
    elif kind == Move.DOOR:
        apart = np.abs(start[:, None] - start[None])
        on_a_line = apart.max(axis=2) == apart.sum(axis=2)
        joints = np.argwhere(np.triu(on_a_line & (apart.sum(axis=2) > 0), 2))
        assume(len(joints))
        row = (kind, *draw(st.sampled_from(joints.tolist())), draw(st.sampled_from([1, -1])))
    elif kind == Move.TILT:
        towards = draw(st.integers(0, 5))
        rests = (grid.bar_directions(start) % 3) == towards % 3
        target = np.where(rests, grid.bar_directions(start), towards)
        fields = {"poses": np.stack([target, grid.bar_directions(start)])}
        row = (kind, 0, last, 0)
    elif kind == Move.PULL:
        head = draw(st.sampled_from([0, last]))
        back = start[abs(head - 1)] - start[head]
        free = [d for d in range(6) if STEPS[d] != tuple(back)]
        row = (kind, head, last - head, draw(st.sampled_from(free)))
    else:
        axis = draw(st.integers(0, 2))
        turn = draw(st.lists(st.integers(-2, 2), min_size=last, max_size=last))
        before = quarters(bars, axis)
        fields = {"angles": np.stack([before, before + QUARTER * np.array(turn)])}
        row = (kind, axis, 0, 1)
    return motion(start, [row], False, **fields)


def moved_at(one, t):
    return kinematics.moved(one.start.astype(float), one.moves[0], one, t)


@given(moves(), st.floats(0, 1))
@examples(140)
def test_every_move_reversed_is_a_move_of_its_kind_through_the_same_poses(one, t):
    row = tuple(one.moves[0].tolist())
    after = np.rint(moved_at(one, 1.0)).astype(int)
    back = motion(
        after,
        [backwards(one.start, after, row, len(one.poses))],
        False,
        poses=one.poses,
        angles=one.angles,
    )
    assert back.moves[0, 0] == row[0]
    assert np.allclose(moved_at(back, 1.0), one.start, atol=EXACT)
    assert np.allclose(moved_at(back, 1 - t), moved_at(one, t), atol=EXACT)


def rotations():
    """The 24 rotations of the lattice."""
    for axes in itertools.permutations(range(3)):
        for signs in itertools.product((1, -1), repeat=3):
            turn = np.zeros((3, 3), int)
            turn[range(3), axes] = signs
            if round(np.linalg.det(turn)) == 1:
                yield turn


def rotated(one, turn):
    """The same motion of the chain turned as a whole."""
    direction = [STEPS.index(tuple(turn @ d)) for d in grid.DIRECTIONS]
    rows = one.moves.copy()
    named = np.isin(rows[:, 0], (Move.PEEL, Move.SWING))
    rows[named, 3] = np.array(direction)[rows[named, 3]]
    poses = np.array(direction, np.int8)[one.poses]
    return motion(one.start @ turn.T, rows, one.straight, poses=poses)


@given(walks(7, 7), walks(7, 7))
@settings(max_examples=10, deadline=None)
def test_two_unfoldings_joined_at_the_line_lead_from_one_shape_to_the_other(a, b):
    there, home = (lu.unfold(lu.VoxelPath(v), tries=2, patience=200) for v in (a, b))
    assume(there.straight and home.straight)
    line = list(lu.frames(there))[-1]
    back = reversed_motion(home)
    fits = [
        t
        for t in rotations()
        if np.array_equal(np.diff(back.start @ t.T, axis=0), np.diff(line, axis=0))
    ]
    assert len(fits) == 4  # the line can still be rolled about itself
    back = rotated(back, fits[0])
    tilts = back.moves[:, 0] == Move.TILT
    rows = back.moves + np.outer(tilts, [0, 0, 0, len(there.poses)])
    joined = motion(
        a,
        np.vstack([there.moves, rows]),
        len(back) == 0,
        poses=np.vstack([p for p in (there.poses, back.poses) if p.size] or [there.poses]),
        goal=b,
    )
    assert keeps_clear(joined)
    end = list(lu.frames(joined))[-1]
    assert np.array_equal(np.diff(end, axis=0) @ fits[0], np.diff(b, axis=0))
    assert lu.certify(joined).reason == "certified"


# Lemma 10: parity ---------------------------------------------------------------------------------


@given(paths())
@examples(80)
def test_colours_alternate_so_that_every_contraction_and_every_way_between_is_even(voxels):
    colours = grid.colour(voxels)
    assert (colours[1:] != colours[:-1]).all()
    assert abs(2 * int(colours.sum()) - len(voxels)) == len(voxels) % 2
    assert (colours[0] != colours[-1]) == (len(voxels) % 2 == 0)
    apart = np.abs(voxels[:, None] - voxels[None]).sum(axis=2)
    steps = np.arange(len(voxels))
    assert ((apart - (steps[:, None] - steps[None])) % 2 == 0).all()
    i, j = np.argwhere(apart == 1).T
    assert ((np.abs(j - i) - 1) % 2 == 0).all()


@given(polycubes(9))
@settings(max_examples=30, deadline=None)
def test_no_path_has_more_than_twice_the_rarer_colour_and_one(occupancy):
    voxels = [tuple(v) for v in np.argwhere(occupancy).tolist()]
    rarer = min(np.bincount(grid.colour(np.array(voxels)), minlength=2))
    longest, todo = 0, [(v,) for v in voxels]
    while todo:
        way = todo.pop()
        longest = max(longest, len(way))
        todo += [(*way, v) for v in beside(way[-1]) if v in voxels and v not in way]
    assert longest <= 2 * rarer + 1


# Small paths --------------------------------------------------------------------------------------


def all_paths(n_bars):
    """Every simple lattice path of so many bars, one of each class under lattice symmetries.

    New axes come in order, each with its positive direction first.
    """
    todo = [((0, 0, 0),)]
    while todo:
        way = todo.pop()
        if len(way) > n_bars:
            yield np.array(way)
            continue
        n_axes = int((np.ptp(way, axis=0) > 0).sum())
        for v in beside(way[-1]):
            step = np.subtract(v, way[-1])
            axis = int(np.abs(step).argmax())
            if v not in way and (axis < n_axes or (axis == n_axes and step[axis] > 0)):
                todo.append((*way, v))


@pytest.mark.parametrize(
    ("n_bars", "n_classes"),
    [(5, 92), pytest.param(9, 39_640, marks=pytest.mark.slow)],
)
def test_every_small_path_has_a_plan(n_bars, n_classes):
    """All tried: up to ten voxels, peels and swings at the two ends are enough."""
    count = 0
    for voxels in all_paths(n_bars):
        unfolding = lu.unfold(lu.VoxelPath(voxels), "peel", tries=3, patience=1000)
        assert unfolding.straight
        if count % 20 == 0:
            assert rod_fault(voxels, states_of(unfolding)) == ""
        assert lu.certify(unfolding).ok
        count += 1
    assert count == n_classes


NO_PLAN = word("WNEDSSUUUNNDESW")


def test_a_path_of_sixteen_voxels_has_no_plan():
    """All states that peels and swings of its two ends reach under the rules: 13 bars are left."""
    last = len(NO_PLAN) - 1
    todo = [(0, last, da, db) for da, db in itertools.product(range(6), repeat=2)]
    reached = set(todo)
    while todo:
        old = todo.pop()
        news = [(old[0] + 1, *old[1:]), (old[0], old[1] - 1, *old[2:])]
        news += [(*old[:2], d, old[3]) for d in range(6)] + [(*old[:3], d) for d in range(6)]
        for new in news:
            if new not in reached and not rod_rule(NO_PLAN, old, new):
                reached.add(new)
                todo.append(new)
    assert min(b - a for a, b, _, _ in reached) == 13


def test_the_path_without_a_plan_is_not_locked():
    """Peels and swings of inner joints straighten it."""
    opening = [(Move.SWING, 4, 5, NORTH), (Move.SWING, 6, 7, NORTH)]
    first = [(Move.PEEL, 3, 4, EAST), (Move.PEEL, 0, 1, NORTH), (Move.SWING, 2, 3, NORTH)]
    rest = [(Move.SWING, 9, 10, NORTH), (Move.PEEL, 11, 12, WEST), (Move.SWING, 11, 12, NORTH)]
    end = [(Move.SWING, 13, 14, NORTH), (Move.PEEL, 14, 15, NORTH)]
    unfolding = motion(NO_PLAN, [*first, *opening, *rest, *end])
    assert keeps_clear(unfolding)
    assert pose_bend_deg(list(lu.frames(unfolding))[-1]) == 0
