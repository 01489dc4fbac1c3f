"""The operation manual: what its rows say, that a hand can follow them, that faults are noticed."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest
from chains import walk
from hands import BOXES, folded, hand, letter, named
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from test_motion import seeds
from test_slots import even_walk

import lineup as lu
from lineup import grid
from lineup.joints import slot_violations
from lineup.manual import reading
from lineup.manual.assembly import assembly_of
from lineup.manual.documents import csv_text, document_of, json_text
from lineup.manual.rows import BlockRow, rows_of
from lineup.motion import plan
from lineup.transformation.reversal import reversal


@pytest.fixture(scope="module", params=BOXES, ids=named)
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
    assert lu.certify(goal, joints=assembly.joints).ok


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


def test_a_folding_for_slots_stays_one_and_only_these_need_a_manner(folding):
    assembly = assembly_of(folding)
    for_slots = not len(slot_violations(folding.motion))
    assert (assembly.joints == "slotted") == for_slots
    manners = [row.manner for row in rows_of(assembly)]
    assert any(manners) == (for_slots and len(manners) > 2)


# Read back


def test_the_path_comes_back_exactly_and_its_motion_is_certified(folding, tmp_path):
    for file in written(folding, tmp_path):
        again = lu.read_manual(file)
        assert np.array_equal(again.path.voxels, folding.path.voxels)
        assembly = assembly_of(folding)
        assert np.array_equal(again.motion.moves, assembly.folding.motion.moves)
        assert lu.certify(again.motion, joints=assembly.joints).ok
        backwards = reversal(again.motion)
        assert lu.certify(backwards, joints=assembly.joints).ok
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


def planned(seed, joints="slotted"):
    """A random path with a motion whose blocks keep to their slots, or, "sparing", mostly do."""
    rng = np.random.default_rng(seed)
    voxels = even_walk(rng, int(rng.integers(2, 60)), int(rng.integers(2, 6)))
    box, cells = plan.path_grid(voxels)
    bias = float(rng.choice([0.02, 0.5]))
    states = plan.peel_plan(box, cells, rng, bias=bias, joints=joints)
    return lu.Folding(lu.VoxelPath(voxels), plan.motion_of(voxels, states, joints))


def for_slots(joints="slotted"):
    """Those of them that end straight, and did not begin so."""
    return st.builds(planned, seeds, st.just(joints)).filter(
        lambda made: made.motion.straight and len(made.motion)
    )


def read(rows):
    """The motion that rows tell of, by way of CSV."""
    return reading._followed([*parsed(csv_text(rows))], 0.999, 90.0).motion


# In some, the ends may not take turns as they might without slots.
@example(planned(86))
@example(planned(159))
@settings(max_examples=60)
@given(for_slots())
def test_any_folding_for_slots_comes_back_move_by_move(made):
    assembly = assembly_of(made)
    again = read(rows_of(assembly))
    assert np.array_equal(again.moves, assembly.folding.motion.moves)
    verdict = lu.certify(again, joints="slotted")
    assert (verdict.ok, verdict.violations) == (True, 0)
    document = json.loads(json_text(document_of(assembly, lu.Certificate(True, ""), "")))
    by_hand = replace(hand(document), goal=assembly.places)
    assert lu.certify(by_hand, joints="slotted").ok


@settings(max_examples=30)
@given(for_slots("sparing"))
def test_a_folding_that_twists_few_pieces_comes_back_move_by_move(made):
    assembly = assembly_of(made)
    assert np.array_equal(read(rows_of(assembly)).moves, assembly.folding.motion.moves)


@settings(max_examples=30)
@given(for_slots(), st.data())
def test_a_lost_or_needless_manner_is_noticed(made, data):
    rows = rows_of(assembly_of(made))
    k = data.draw(st.integers(0, len(rows) - 1))
    if rows[k].manner:
        rows[k] = rows[k].model_copy(update={"manner": ""})
        said = "(twists|manner) is "
    else:
        rows[k] = rows[k].model_copy(
            update={"manner": data.draw(st.sampled_from(["straighten", "hinge first"]))}
        )
        said = "manner is "
    with pytest.raises(ValueError, match=said):
        read(rows)


def parsed(text):
    for k, entries in enumerate(csv.DictReader(text.splitlines()), start=1):
        yield reading._csv_row(k, entries)


# Faults are noticed

BENDS = ["", "E", "EN", "UU", "SW"]
ENTRIES = {
    "manner": ["", "straighten", "hinge first", "gently"],
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
    if right:
        reading._followed([BlockRow(**row) for row in rows], 0.999, 90.0)
    else:
        with pytest.raises(ValueError, match=r".+"):
            reading._followed([BlockRow(**row) for row in rows], 0.999, 90.0)


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


def test_another_version_is_refused_with_what_to_do(texts, tmp_path):
    head, *rows = csv.reader(texts[1].splitlines())
    at = head.index("manner")
    old = [",".join([*row[:at], *row[at + 1 :]]) for row in (head, *rows)]
    (tmp_path / "it.csv").write_text("\n".join(old))
    said = "this program reads version 2 of lineup-manual; write the manual anew"
    with pytest.raises(ValueError, match=f"it.csv: no column manner: {said}"):
        lu.read_manual(tmp_path / "it.csv")
    document = json.loads(texts[0]) | {"version": 1}
    for row in document["rows"]:
        del row["manner"]
    (tmp_path / "it.json").write_text(json.dumps(document))
    with pytest.raises(ValueError, match=f"it.json: version: 1, and {said}"):
        lu.read_manual(tmp_path / "it.json")


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
