"""How a manual lays out the work: actions, steps, turns of the ends, which side is down."""

from itertools import pairwise
from types import SimpleNamespace

import networkx as nx
import numpy as np
import pytest
from chains import walk
from hands import BOXES, folded, named
from hypothesis import given, settings
from hypothesis import strategies as st
from test_slots import twisting_peels

import lineup as lu
from lineup import grid
from lineup.manual import build, grade, turns
from lineup.manual.actions import HINGE_FIRST, Action, actions_of
from lineup.manual.assembly import assembly_of
from lineup.manual.documents import document_of
from lineup.manual.grade import grade_of
from lineup.manual.steps import LEAST, MOST, MOST_BY_BOTH, MOST_LAYERS, steps_of
from lineup.motion._chain import link
from lineup.motion._search import keeps_rules
from lineup.motion._slots import may_detour, may_swap, plan_keeps_slots
from lineup.motion.plan import path_grid, rod_plan


@pytest.fixture(scope="module", params=BOXES, ids=named)
def folding(request):
    return folded(*request.param)


# Actions and steps


def test_actions_undo_the_motion_move_by_move(folding):
    base, actions = actions_of(folding.motion)
    poses = list(lu.frames(folding.motion))
    voxels = folding.path.voxels
    a, b = base
    for action, after in pairwise((None, *actions, None)):
        if action and not action.swings:
            a, b = min(a, action.joint), max(b, action.joint)
        if after and after.manner == HINGE_FIRST:  # the piece comes into place together with it
            assert (action.joint, action.moves) == (after.before, after.moves + 1)
            continue
        pose = poses[action.moves] if action else poses[-1]
        assert np.array_equal(pose[a : b + 1] - pose[a], voxels[a : b + 1] - voxels[a])
        for rod in (pose[b:], pose[: a + 1]):
            assert (np.ptp(rod, axis=0) > 0.5).sum() <= 1
        if action and action.end == 1 and b + 1 < len(voxels):
            assert np.array_equal(pose[b + 1] - pose[b], grid.DIRECTIONS[action.loose])
        if action and action.end == 0 and a > 0:
            assert np.array_equal(pose[a - 1] - pose[a], grid.DIRECTIONS[action.loose])
    assert (a, b) == (0, len(voxels) - 1)
    assert [action.moves for action in actions][-1] == 0


def test_steps_say_to_which_move_the_body_is_built(folding):
    assembly = assembly_of(folding)
    document = document_of(assembly, lu.Certificate(True, ""), "")
    poses = list(lu.frames(assembly.folding.motion))
    voxels = folding.path.voxels
    done = 2
    for row in document.steps:
        done += row.voxels
        assert row.voxels_in_place == done
        there = np.flatnonzero(assembly.number <= assembly.steps[row.step - 1].stop)
        pose = poses[row.moves]
        assert np.array_equal(pose[there] - pose[there[0]], voxels[there] - voxels[there[0]])
        assert row.size == tuple((np.ptp(assembly.places[there], axis=0) + 1).tolist())
    assert done == len(voxels)


@settings(max_examples=60)
@given(st.data())
def test_steps_are_of_a_size_that_a_hand_does_at_a_time(data):
    n = data.draw(st.integers(2, 200))
    climbs = data.draw(st.lists(st.integers(0, n), max_size=12))
    places = np.ones((n, 3), int)
    places[:, 2] += np.isin(np.arange(n), climbs).cumsum()
    head = data.draw(st.integers(0, n - 2))
    order = [(0, j) for j in range(head - 1, -1, -1)]
    tail = [(1, j) for j in range(head + 2, n)]
    cut = data.draw(st.integers(0, len(tail)))
    laid = [Action(e, j, 0, 0, 0) for e, j in (*tail[:cut], *order, *tail[cut:])]
    swing = data.draw(st.integers(0, len(laid)))
    actions = [
        *laid[:swing],
        *([Action(1, 0, 0, 1, 0)] if swing < len(laid) else []),
        *laid[swing:],
    ]
    steps = steps_of(places, actions)
    assert [k for step in steps for k in step] == list(range(len(actions)))
    sizes = [sum(not actions[k].swings for k in step) for step in steps]
    assert all(size <= MOST for size in sizes)
    for step, after in pairwise(steps):
        last, first = actions[step[-1]], actions[after[0]]
        assert not last.swings
        same = (last.end, last.joint // 2) == (first.end, first.joint // 2)
        assert first.swings or not same
    for (step, size), (after, then) in pairwise(zip(steps, sizes, strict=True)):
        joints = [actions[k].joint for k in (*step, *after)]
        few_layers = len({*places[joints, 2].tolist()}) <= MOST_LAYERS
        short = len(step) + len(after) <= 8
        ends = {actions[k].end for k in (*step, *after) if not actions[k].swings}
        fits = size + then <= (MOST if len(ends) == 1 else MOST_BY_BOTH)
        assert not (short and few_layers and fits and min(size, then) < LEAST)


# The ends take turns


@given(twisting_peels())
@settings(max_examples=100)
def test_an_end_that_needs_two_moves_for_the_slots_makes_both_or_none(case):
    voxels, state, end, capsule = case
    box, cells = path_grid(voxels)
    chain = link(box, cells)
    joints = state[end] + np.arange(3) * (1, -1)[end]
    way = np.stack([joints, np.full(3, state[2 + end])], axis=1).astype(np.int32)
    then_swings = way.copy()
    then_swings[2] = way[1, 0], (way[1, 1] + 1) % 6
    alone = int(may_detour(box, chain, state, end, capsule))
    both = 1 if alone else 2 if may_swap(box, chain, state, end) else 0
    assert turns._at_once(box, chain, state, end, way, True) == both
    for other in (way[:2], then_swings):
        assert turns._at_once(box, chain, state, end, other, True) == alone
    assert turns._at_once(box, chain, state, end, way, False) == 1
    assert turns._at_once(box, chain, state, end, way[:1], True) == 0


@pytest.mark.parametrize("joints", ["free", "slotted"])
@pytest.mark.parametrize("seed", range(6))
def test_ends_change_as_seldom_as_the_rules_let_them(seed, joints):
    made = folded((3, 3, 2), seed, joints)
    states, _ = rod_plan(made.motion)
    ways = [turns._way(states, end) for end in (0, 1)]
    cells = path_grid(made.path.voxels)
    chain = link(*cells)
    graph = nx.DiGraph()
    last = tuple(len(way) - 1 for way in ways)
    for i, j in np.ndindex(*(len(way) for way in ways)):
        for end, n in ((0, 1), (1, 1), (0, 2), (1, 2)):
            run = [(i + k, j) if end == 0 else (i, j + k) for k in range(n + 1)]
            to = run[-1]
            if to[end] > last[end]:
                continue
            passed = [(ways[0][p][0], ways[1][q][0], ways[0][p][1], ways[1][q][1]) for p, q in run]
            passed = np.array(passed, np.int32)
            if keeps_rules(cells[0], chain, passed) and (
                joints == "free" or plan_keeps_slots(cells[0], chain, passed)
            ):
                for before in (0, 1):
                    change = turns._change(int(ways[before][(i, j)[before], 0]), before)
                    cost = change if before != end and (i, j) != (0, 0) else 0
                    graph.add_edge((i, j, before), (*to, end), cost=cost)
    goals = [(*last, 0), (*last, 1)]
    least = min(
        nx.dijkstra_path_length(graph, (0, 0, start), goal, "cost")
        for start in (0, 1)
        for goal in goals
        if graph.has_node((0, 0, start))
        and graph.has_node(goal)
        and nx.has_path(graph, (0, 0, start), goal)
    )
    ends = turns._fewest(cells[0], chain, *ways, joints == "slotted")
    assert turns._cost(turns._states(ends, ways)) == least


@pytest.mark.parametrize(
    ("box", "changes"),
    [
        *[(((4, 3, 2), 0), False), (((4, 3, 2), 1), True), (((4, 3, 2), 2), False)],
        *[((*box, "slotted"), True) for box in (((4, 4, 4), 0), ((3, 3, 5), 0))],
    ],
)
def test_another_order_of_the_ends_is_certified_and_final(box, changes):
    motion = folded(*box).motion
    ordered = turns.with_few_turns(motion)
    assert (ordered is not motion) == changes
    assert lu.certify(ordered, joints=[*box, "free"][2]).ok
    assert turns._cost(rod_plan(ordered)[0]) <= turns._cost(rod_plan(motion)[0])
    assert turns.with_few_turns(ordered) is ordered
    assert ordered.straight
    assert np.array_equal(ordered.start, motion.start)


# How it lies, and how hard it is


def test_each_lie_is_a_rotation_that_puts_its_side_down():
    corner = walk("ENU")
    for down in build.LYING:
        lie = build.build_of(down, corner)
        assert round(np.linalg.det(lie.turn)) == 1
        assert lie.letters[grid.LETTERS.index(down)] == "D"
        assert (lie.places(corner).min(axis=0) == 1).all()


def test_the_model_lies_so_that_voxels_come_from_above(folding):
    base, actions = actions_of(folding.motion)
    voxels = folding.path.voxels
    order = [*base, *(action.joint for action in actions if not action.swings)]
    toil = {}
    for down in build.LYING:
        places = build.build_of(down, voxels).places(voxels)[order]
        below = [
            k
            for k in range(len(order))
            if any((q[:2] == places[k, :2]).all() and q[2] > places[k, 2] for q in places[:k])
        ]
        assert build.covered(build.build_of(down, voxels).places(voxels), base, actions) == [
            order[k] for k in below
        ]
        ends = [action.end for action in actions if not action.swings]
        runs = list(zip(ends, places[2:, 2].tolist(), strict=True))
        toil[down] = len(below) + sum(x != y for x, y in pairwise(runs))
    assert toil[build.best_build(voxels, base, actions).down] == min(toil.values())


def test_a_straight_line_is_as_easy_as_can_be():
    line = walk("EEE")
    still = lu.Motion(line, np.empty((0, 4), int), 0.999, 90.0, True, "straight")
    counts = grade_of(assembly_of(lu.Folding(lu.VoxelPath(line), still))).counts
    expected = {"blocks": 2, "visits": 1, "limbs": 1, "swings": 0, "turns": 0, "covered": 0}
    assert counts == expected | {"points": 2 + 4, "grade": 1, "minutes": 2}


def test_an_arch_has_two_limbs():
    arch = SimpleNamespace(places=1 + np.abs(walk("UUUEEEDDD")))
    assert grade._limbs(arch) == 2
    assert grade._limbs(SimpleNamespace(places=arch.places[:5])) == 1


def test_points_and_minutes_are_those_of_the_formats_page(folding):
    assembly = assembly_of(folding)
    counts = grade_of(assembly).counts
    weights = {"blocks": 1, "visits": 4, "limbs": 10, "swings": 6, "turns": 2, "covered": 2}
    points = sum(w * counts[name] for name, w in weights.items()) - 10
    assert counts["points"] == points
    assert counts["grade"] == 1 + sum(points >= least for least in (100, 300, 900, 2700))
    swings = [action for action in assembly.actions if action.swings]
    assert counts["swings"] == len(swings)
    bends = len(assembly.folding.motion) - len(swings)
    seconds = 15 * bends + 90 * len(assembly.steps) + 60 * len(swings)
    assert 60 * (counts["minutes"] - 1) < seconds <= 60 * counts["minutes"]
