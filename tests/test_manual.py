"""The operation manual: what its rows say, that a hand can follow them, that faults are noticed."""

import csv
import json
from itertools import pairwise
from types import SimpleNamespace

import networkx as nx
import numpy as np
import pytest
from chains import walk
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import lineup as lu
from lineup import grid
from lineup.joints import slot_violations
from lineup.kinematics import Move
from lineup.manual import build, grade, reading, turns
from lineup.manual.actions import Action, actions_of
from lineup.manual.assembly import assembly_of
from lineup.manual.documents import csv_text, document_of, json_text
from lineup.manual.grade import grade_of
from lineup.manual.rows import BlockRow, rows_of
from lineup.manual.steps import LEAST, MOST, MOST_LAYERS, steps_of
from lineup.motion._chain import link
from lineup.motion._search import keeps_rules
from lineup.motion.plan import path_grid, rod_states
from lineup.transformation.reversal import reversal

BOXES = [((5, 4, 2), 0), ((4, 4, 4), 0), ((3, 3, 5), 0), ((2, 2, 1), 0), ((5, 3, 4), 9)]


def folded(shape, seed):
    return lu.fold(lu.VoxelSolid(np.ones(shape, bool)), seed=seed, rounds=60, trial_rounds=10)


@pytest.fixture(scope="module", params=BOXES, ids=lambda box: "x".join(map(str, box[0])))
def folding(request):
    return folded(*request.param)


@pytest.fixture(scope="module")
def texts():
    """A manual as its two texts, and the folding it was written from."""
    made = folded((3, 3, 4), 0)
    assembly = assembly_of(made)
    document = document_of(assembly, lu.certify(assembly.folding.motion), "brick")
    return json_text(document), csv_text(document.rows), assembly.folding


def written(folding, tmp_path, name="it"):
    """JSON and CSV files of a folding, without the booklet."""
    assembly = assembly_of(folding)
    motion = assembly.folding.motion
    document = document_of(assembly, lu.certify(motion, motion.diameter, motion.max_bend_deg), name)
    files = tmp_path / f"{name}.json", tmp_path / f"{name}.csv"
    files[0].write_text(json_text(document))
    files[1].write_text(csv_text(document.rows))
    return files


def hand(document):
    """A hand that knows nothing but the rows, and the base, as they are on the card.

    It holds a straight line whose base is in its place, and bends one joint after the other.
    """
    rows = document["rows"]
    n = 2 * len(rows)
    places = np.zeros((n, 3), int)
    base = sorted(
        joint
        for row in rows
        for joint, at in ((2 * row["block"] - 2, row["at1"]), (2 * row["block"] - 1, row["at2"]))
        if at == 0
    )
    a, b = base
    along = np.array(document["base"][1]) - document["base"][0]
    line = np.array(document["base"][0]) + np.outer(np.arange(n) - a, along)
    places[:] = line
    loose = {"head": letter(-along), "tail": letter(along)}
    events = {}
    for row in rows:
        laid = sorted(
            (at, joint)
            for joint, at in (
                (2 * row["block"] - 2, row["at1"]),
                (2 * row["block"] - 1, row["at2"]),
            )
            if at
        )
        for (at, joint), bend in zip(laid, row["bends"], strict=True):
            events[at] = (joint, bend)
        for text in row["swings"].split():
            at, end, ways = text.split(":")
            events[int(at)] = (end, ways)
    moves = []
    for at in range(1, max(events) + 1):
        what, way = events[at]
        if isinstance(what, str):
            assert loose[what] == way[0]
            k, beyond = (a, a - 1) if what == "head" else (b, b + 1)
            moves.append((Move.SWING, k, beyond, grid.LETTERS.index(way[1])))
            loose[what] = way[1]
            continue
        end = "head" if what < a else "tail"
        before = a if end == "head" else b
        assert abs(what - before) == 1
        if way != loose[end]:
            moves.append((Move.PEEL, before, what, grid.LETTERS.index(way)))
        a, b = min(a, what), max(b, what)
    return lu.Motion(line, np.array(moves, int).reshape(-1, 4), 0.999, 90.0, False, "by hand")


def letter(step):
    return grid.LETTERS[grid.DIRECTIONS.tolist().index(list(step))]


# What the rows say


def test_rows_agree_with_the_path_and_with_the_joint_word(folding):
    path = folding.path.voxels
    rows = rows_of(assembly_of(folding))
    word = lu.joint_word(folding)
    bars = [grid.LETTERS[d] for d in grid.bar_directions(path)]
    joints = ["", *word.letters, ""]
    assert sorted(row.block for row in rows) == list(range(1, len(path) // 2 + 1))
    for row in rows:
        k = 2 * row.block - 2
        assert np.array_equal(row.voxels, path[k : k + 2])
        assert row.hinge == bars[k] == row.frame[0]
        assert row.piece == (bars[k + 1] if k + 1 < len(bars) else "")
        assert (row.joint1, row.joint2) == (joints[k], joints[k + 1])
        x, y, z = (grid.DIRECTIONS[grid.LETTERS.index(c)] for c in row.frame)
        assert np.array_equal(np.cross(x, y), z)
    first = next(row for row in rows if row.block == 1)
    assert [letter(axis) for axis in word.frame.T] == list(first.frame)


def test_a_hand_that_follows_the_rows_is_never_blocked_and_ends_in_the_body(folding):
    document = json.loads(
        json_text(document_of(assembly_of(folding), lu.Certificate(True, ""), ""))
    )
    motion = hand(document)
    *_, last = lu.frames(motion)
    assembly = assembly_of(folding)
    assert np.array_equal(last - last[0], assembly.places - assembly.places[0])
    goal = lu.Motion(motion.start, motion.moves, 0.999, 90.0, False, "", goal=assembly.places)
    assert lu.certify(goal).ok


def test_rows_come_in_the_order_in_which_blocks_are_done(folding):
    rows = rows_of(assembly_of(folding))
    assert [row.order for row in rows] == list(range(1, len(rows) + 1))
    done = [max(row.at1, row.at2) for row in rows]
    assert done == sorted(done)
    steps = [row.step for row in rows]
    assert steps == sorted(steps)


def test_twists_are_those_of_the_judge(folding):
    assembly = assembly_of(folding)
    motion = assembly.folding.motion
    judged = len({k for k, _ in slot_violations(motion).tolist()})
    assert sum(row.twists for row in rows_of(assembly)) == judged == len(assembly.twists)
    assert all(action.lays_hinge or action.swings for action in assembly.twisting)


# Read back


def test_the_path_comes_back_exactly_and_its_motion_is_certified(folding, tmp_path):
    for file in written(folding, tmp_path):
        again = lu.read_manual(file)
        assert np.array_equal(again.path.voxels, folding.path.voxels)
        assert np.array_equal(again.motion.moves, assembly_of(folding).folding.motion.moves)
        assert lu.certify(again.motion).ok
        backwards = reversal(again.motion)
        assert lu.certify(backwards).ok
        *_, body = lu.frames(backwards)
        assert np.array_equal(body - body[0], folding.path.voxels - folding.path.voxels[0])


def test_json_keeps_the_diameter_that_was_judged(tmp_path):
    thick = folded((2, 2, 2), 0)
    motion = lu.Motion(thick.path.voxels, thick.motion.moves, 0.9, 120.0, True, "straight")
    json_file, csv_file = written(lu.Folding(thick.path, motion), tmp_path)
    again = lu.read_manual(json_file).motion
    assert (again.diameter, again.max_bend_deg) == (0.9, 120.0)
    assert lu.read_manual(csv_file).motion.diameter == 0.999


@settings(max_examples=15)
@given(st.data())
def test_any_folding_comes_back(data):
    shape = data.draw(st.tuples(*[st.integers(1, 3)] * 3).filter(lambda s: np.prod(s) > 3))
    made = folded(shape, data.draw(st.integers(0, 20)))
    assume(len(made.path) % 2 == 0)
    rows = csv_text(rows_of(assembly_of(made)))
    again = reading._followed([*parsed(rows)], 0.999, 90.0)
    assert np.array_equal(again.path.voxels, made.path.voxels)


def parsed(text):
    for k, entries in enumerate(csv.DictReader(text.splitlines()), start=1):
        yield reading._csv_row(k, entries)


# Faults are noticed

BENDS = ["", "E", "EN", "UU", "SW"]
ENTRIES = {
    "end": ["head", "tail", "base"],
    "frame": ["ENU", "UEN", "WSU"],
    "swings": ["", "1:head:EN", "3:tail:UD", "2:tail:NE 1:head:SU"],
    "bends": BENDS,
    "loose": BENDS,
    "hinge": list(grid.LETTERS),
    "piece": list(grid.LETTERS),
    "joint1": list("SyYzZ"),
    "joint2": list("SyYzZ"),
}


@settings(max_examples=150)
@given(st.data())
def test_any_wrong_entry_of_a_row_is_noticed(texts, data):
    rows = [row.model_dump() for row in parsed(texts[1])]
    row = data.draw(st.sampled_from(rows))
    name = data.draw(st.sampled_from(sorted(row)))
    if isinstance(row[name], int):
        wrong = max(0, row[name] + data.draw(st.sampled_from([-2, -1, 1, 2])))
    else:
        wrong = data.draw(st.sampled_from(ENTRIES[name]))
    right = row[name] == wrong
    row[name] = wrong
    changed = [BlockRow(**row) for row in rows]
    if right:
        reading._followed(changed, 0.999, 90.0)
    else:
        with pytest.raises(ValueError, match=r".+"):
            reading._followed(changed, 0.999, 90.0)


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda rows: [rows[1], rows[0], *rows[2:]], "out of order"),
        (lambda rows: rows[:3] + rows[4:], "missing"),
        (lambda rows: rows[:-1], "row 17: piece is"),
        (lambda rows: [*rows, rows[-1]], "missing or out of order"),
        (lambda rows: [], "not of blocks"),
        (lambda rows: [r.replace(",E,", ",Q,", 1) for r in rows], "row [0-9]+: .*pattern"),
        (lambda rows: [r.replace(",", ",,", 1) for r in rows], "row 1: "),
        (lambda rows: [r.rsplit(",", 1)[0] for r in rows], "row 1: layer: "),
        (lambda rows: ['"' + rows[0], *rows[1:]], "row 1: |end of"),
    ],
)
def test_spoilt_rows_are_refused_in_one_line(texts, tmp_path, spoil, said):
    head, *rows = texts[1].splitlines()
    file = tmp_path / "it.csv"
    file.write_text("\n".join([head, *spoil(rows)]))
    with pytest.raises(ValueError, match=said) as refusal:
        lu.read_manual(file)
    assert str(refusal.value).startswith(str(file))
    assert "\n" not in str(refusal.value)


def change(value):
    match value:
        case bool():
            return not value
        case int() | float():
            return value + 1
        case str():
            return value[::-1] + value[:2]
        case list():
            return [change(value[0]), *value[1:]]
        case dict():
            name = sorted(value)[0]
            return value | {name: change(value[name])}


FIELDS = ("format", "version", "voxels", "blocks", "origin", "frame", "word")
MORE = ("build", "base", "grade", "steps", "rows")


@pytest.mark.parametrize("name", [*FIELDS, *MORE])
def test_a_wrong_field_of_the_document_is_noticed(texts, tmp_path, name):
    document = json.loads(texts[0])
    file = tmp_path / "it.json"
    file.write_text(json.dumps(document))
    lu.read_manual(file)
    file.write_text(json.dumps(document | {name: change(document[name])}))
    with pytest.raises(ValueError, match=name.rstrip("s")):
        lu.read_manual(file)


def test_what_is_no_manual_is_refused(tmp_path):
    with pytest.raises(FileNotFoundError, match="no file"):
        lu.read_manual(tmp_path / "none.json")
    (tmp_path / "it.pdf").write_text("")
    with pytest.raises(ValueError, match=r"\.json or \.csv"):
        lu.read_manual(tmp_path / "it.pdf")
    (tmp_path / "it.json").write_text("{}")
    with pytest.raises(ValueError, match="it.json: "):
        lu.read_manual(tmp_path / "it.json")


def test_motions_that_no_hand_follows_are_refused():
    solid = lu.VoxelSolid(np.ones((3, 2, 2), bool))
    with pytest.raises(ValueError, match="peels and swings"):
        assembly_of(lu.fold(solid, "pull"))
    path = walk("ENWU")[:4]
    stuck = lu.Motion(path, np.empty((0, 4), int), 0.999, 90.0, False, "stuck")
    with pytest.raises(ValueError, match="stuck"):
        assembly_of(lu.Folding(lu.VoxelPath(path), stuck))
    odd = lu.unfold(lu.VoxelPath(path[:3]), method="peel")
    with pytest.raises(ValueError, match="even number"):
        assembly_of(lu.Folding(lu.VoxelPath(path[:3]), odd))


# Actions and steps


def test_actions_undo_the_motion_move_by_move(folding):
    base, actions = actions_of(folding.motion)
    poses = list(lu.frames(folding.motion))
    voxels = folding.path.voxels
    a, b = base
    for action in (None, *actions):
        if action and not action.swings:
            a, b = min(a, action.joint), max(b, action.joint)
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
        assert not (short and few_layers and min(size, then) < LEAST)


# The ends take turns


@pytest.mark.parametrize("seed", range(6))
def test_ends_change_as_seldom_as_the_rules_let_them(seed):
    made = folded((3, 3, 2), seed)
    states = rod_states(made.motion)
    ways = [turns._way(states, end) for end in (0, 1)]
    cells = path_grid(made.path.voxels)
    chain = link(*cells)
    graph = nx.DiGraph()
    last = tuple(len(way) - 1 for way in ways)
    for i, j in np.ndindex(*(len(way) for way in ways)):
        for end in (0, 1):
            to = (i + 1, j) if end == 0 else (i, j + 1)
            if to[end] > last[end]:
                continue
            pair = [
                (*ways[0][p][:1], *ways[1][q][:1], ways[0][p][1], ways[1][q][1])
                for p, q in ((i, j), to)
            ]
            if keeps_rules(cells[0], chain, np.array(pair, np.int32)):
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
    ends = turns._fewest(cells[0], chain, *ways)
    assert turns._cost(turns._states(ends, ways)) == least


@pytest.mark.parametrize("seed", range(4))
def test_another_order_of_the_ends_is_certified_and_final(seed):
    motion = folded((4, 3, 2), seed).motion
    ordered = turns.with_few_turns(motion)
    assert lu.certify(ordered).ok
    assert turns._cost(rod_states(ordered)) <= turns._cost(rod_states(motion))
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
