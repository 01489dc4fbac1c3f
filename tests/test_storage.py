"""What is saved loads back exactly, and nothing malformed is let in."""

import dataclasses
import json

import numpy as np
import pandas as pd
import pytest
from examples import examples
from hypothesis import given
from hypothesis import strategies as st
from polycubes import polycubes

import lineup as lu
from lineup import grid, notation
from lineup.kinematics import Move
from lineup.storage import plain

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.int32)
WORDS = st.text(grid.LETTERS, min_size=1, max_size=40)
ORIGINS = st.tuples(*[st.integers(-1000, 1000)] * 3)


@st.composite
def motions(draw):
    """Any moves at all: storage keeps what it is given, and judging is not its business."""
    word = draw(WORDS)
    last = len(word)
    poses = draw(st.lists(st.text(grid.LETTERS, min_size=last, max_size=last), max_size=3))
    joint = st.integers(0, last)
    turn = st.tuples(st.sampled_from([Move.PEEL, Move.SWING]), joint, joint, st.integers(0, 5))
    rows = [
        turn.filter(lambda row: abs(row[1] - row[2]) == 1),
        st.tuples(st.just(Move.DOOR), joint, joint, st.sampled_from([1, -1])),
    ]
    if poses:
        tilt = st.integers(0, len(poses) - 1).map(lambda k: (Move.TILT, 0, last, k))
        rows.append(tilt)
    moves = draw(st.lists(st.one_of(rows), max_size=30))
    return lu.Motion(
        notation.positions(draw(ORIGINS), word),
        np.array(moves, np.int32).reshape(-1, 4),
        draw(st.floats(0.1, 1.0)),
        draw(st.sampled_from([90.0, 120.0])),
        draw(st.booleans()),
        draw(st.text(st.characters(codec="utf-8"), max_size=20)),
        np.array([notation.directions(p) for p in poses], np.int8).reshape(
            len(poses), last if poses else 0
        ),
        goal=notation.positions(draw(ORIGINS), word[::-1] if draw(st.booleans()) else word)
        if draw(st.booleans())
        else np.empty((0, 3), np.int32),
    )


def same(a, b):
    """Every field equal, arrays with type and shape too."""
    if isinstance(a, np.ndarray):
        return a.dtype == b.dtype and a.shape == b.shape and np.array_equal(a, b)
    if hasattr(a, "__dataclass_fields__"):
        return all(same(getattr(a, f), getattr(b, f)) for f in a.__dataclass_fields__)
    if isinstance(a, pd.DataFrame):
        return a.equals(b)
    if isinstance(a, tuple):
        return len(a) == len(b) and all(map(same, a, b))
    return a == b or (a != a and b != b)


def round_trip(obj, folder):
    file = lu.save(obj, folder / "obj.json")
    written = file.read_bytes()
    loaded = lu.load(file)
    assert same(obj, loaded)
    assert lu.save(loaded, file).read_bytes() == written
    assert [p.name for p in folder.iterdir()] == ["obj.json"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("storage")


@examples(280)
@given(polycubes(30), st.floats(1e-6, 1e6), st.text(st.characters(codec="utf-8"), max_size=10))
def test_solid_round_trip(folder, occupancy, pitch, name):
    source = {"file": name, "dropped": 3, "iou": 0.25, "up": None, "axes": [1, 2]}
    round_trip(lu.VoxelSolid(occupancy, pitch, name, source), folder)


@examples(360)
@given(ORIGINS, WORDS, st.integers(1, 4))
def test_path_round_trip(folder, origin, word, refinement):
    voxels = notation.positions(origin, word)
    visits = np.array([[0, 2, 5, 1]], np.int32)
    round_trip(lu.VoxelPath(voxels, visits, voxels[:2] + 7, refinement, "layered"), folder)


@examples(120)
@given(motions())
def test_motion_and_folding_round_trip(folder, motion):
    round_trip(motion, folder)
    round_trip(lu.Folding(lu.VoxelPath(motion.start), motion), folder)


def a_design():
    path = lu.VoxelPath(SQUARE)
    motion = lu.Motion(SQUARE, np.empty((0, 4), np.int32), 0.999, 90.0, False, "stuck")
    solid = lu.VoxelSolid(np.ones((2, 2, 1), bool), name="square")
    verdict = lu.Certificate(
        *(False, "not straight", 3, 0.999, float("inf"), 90.0, float("nan"), 2),
        nearest=(-1, 0, 2),
        most_bent=(1, 2),
        extent=(2.0, 2.0 + 2**0.5, float("nan")),
    )
    table = pd.DataFrame({"model": ["square"], "IoU": [0.5], "ok": [False], "seconds_fold": [1.5]})
    return lu.Design((solid,), (lu.Folding(path, motion),), (verdict,), table)


def test_design_round_trip_leaves_out_timings(tmp_path):
    design = a_design()
    stored = lu.load(lu.save(design, tmp_path / "obj.json"))
    assert list(stored.table) == ["model", "IoU", "ok"]
    assert same(design.certificates, stored.certificates)
    (tmp_path / "obj.json").unlink()
    round_trip(stored, tmp_path)


def test_designs_of_version_1_are_read(tmp_path):
    """Their certificates do not say where the chain comes near, bends, and how far it reaches."""
    file = lu.save(a_design(), tmp_path / "old.json")
    fields = json.loads(file.read_text()) | {"version": 1}
    for name in ("nearest", "most_bent", "extent"):
        del fields["certificates"][0][name]
    file.write_text(json.dumps(fields))
    (verdict,) = lu.load(file).certificates
    assert (verdict.nearest, verdict.most_bent) == ((-1, -1, -1), (-1, -1))
    assert np.isnan(verdict.extent).all()
    assert (verdict.ok, verdict.where, verdict.bend_deg != verdict.bend_deg) == (False, 3, True)


def test_a_design_says_of_failed_models_why(tmp_path):
    design = a_design()
    table = pd.DataFrame({"model": ["gone", "square"], "failure": ["no such mesh", ""]})
    stored = lu.load(lu.save(dataclasses.replace(design, table=table), tmp_path))
    assert stored.table["failure"].tolist() == ["no such mesh", ""]
    with pytest.raises(ValueError, match="are more than the rows"):
        lu.load(lu.save(dataclasses.replace(design, table=table[:0]), tmp_path))


def test_positions_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match=r"voxels must be from -2147483648 to .*1099511627776"):
        lu.VoxelPath(np.array([(2**40, 0, 0)]))


def test_a_folder_holds_one_design(tmp_path):
    assert lu.save(a_design(), tmp_path) == tmp_path / "design.json"
    assert lu.load(tmp_path).models[0].name == "square"


def test_motion_text_is_the_documented_one(tmp_path):
    moves = [[0, 1, 2, 1], [1, 3, 2, 5], [2, 0, 3, -1], [3, 0, 3, 0]]
    motion = lu.Motion(
        SQUARE, np.array(moves), 1.0, 90.0, True, "straight", np.array([[0, 0, 0]], np.int8)
    )
    fields = json.loads(lu.save(motion, tmp_path / "m.json").read_text())
    assert (fields["format"], fields["version"]) == ("lineup-motion", 2)
    assert (fields["origin"], fields["letters"]) == ([0, 0, 0], "ENW")
    assert fields["moves"] == "p1+N s3-D d0:3- t0"
    assert fields["poses"] == ["EEE"]


UNSAYABLE = [
    (0, 1, 3, 0),
    (0, -1, 0, 0),
    (1, 3, 4, 0),
    (0, 1, 2, 6),
    (2, 0, 3, 0),
    (3, 1, 3, 0),
    (9, 0, 1, 0),
]


@pytest.mark.parametrize("row", UNSAYABLE)
def test_a_move_the_format_cannot_say_is_not_saved(tmp_path, row):
    motion = lu.Motion(SQUARE, np.array([row]), 1.0, 90.0, True, "straight")
    with pytest.raises(ValueError, match=r"^move 0, \("):
        lu.save(motion, tmp_path / "m.json")
    assert not list(tmp_path.iterdir())


def test_a_path_with_a_gap_is_not_saved(tmp_path):
    with pytest.raises(ValueError, match="voxels 0 and 1 .* do not share a face"):
        lu.save(lu.VoxelPath(SQUARE[::2]), tmp_path / "p.json")


def test_only_results_are_saved(tmp_path):
    with pytest.raises(ValueError, match="cannot save a dict"):
        lu.save({}, tmp_path / "x.json")


FAULTS = {
    "not json": (None, None, "Invalid JSON"),
    "unknown format": ("format", "lineup-mesh", "unknown format 'lineup-mesh'"),
    "later version": ("version", 2, "version 2 of lineup-folding; this program reads 1 to 1"),
    "missing field": ("path", None, "path"),
    "extra field": ("colour", "red", "colour: Extra inputs"),
    "unknown letter": ("motion.letters", "ENX", "motion.letters"),
    "another start": ("motion.letters", "ENN", "the motion does not start at the path"),
    "unknown move": ("motion.moves", "p1+N x3", "move 1 reads 'x3'"),
    "joint beyond the end": ("motion.moves", "p3+N", "the joints are 0 to 3"),
    "tilt to no pose": ("motion.moves", "t0", "pose 0 of 0"),
    "short pose": ("motion.poses", ["EE"], "pose 0 has 2 letters, not 3"),
    "text for a number": ("motion.diameter", "1.0", "motion.diameter"),
    "huge origin": ("path.origin", [0, 0, 2**40], "path.origin.2"),
    "float origin": ("path.origin", [0, 0, 0.5], "path.origin.2"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_malformed_file_is_refused_in_one_line(tmp_path, fault):
    where, value, message = FAULTS[fault]
    file = lu.save(a_design().foldings[0], tmp_path / "f.json")
    fields = json.loads(file.read_text())
    if where is None:
        file.write_text(file.read_text()[:-9])
    else:
        *parents, leaf = where.split(".")
        inner = fields
        for parent in parents:
            inner = inner[parent]
        inner[leaf] = value
        file.write_text(json.dumps(fields))
    with pytest.raises(ValueError, match="f.json") as caught:
        lu.load(file)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("shape", "occupancy"),
    [([2**30, 2**30, 2**30], "8A=="), ([4, 4, 2], "8A=="), ([2, 2, 1], "8A=!"), ([0, 2, 2], "")],
)
def test_a_false_shape_is_refused_before_anything_is_allocated(tmp_path, shape, occupancy):
    file = lu.save(a_design().models[0], tmp_path / "s.json")
    fields = json.loads(file.read_text()) | {"shape": shape, "occupancy": occupancy}
    file.write_text(json.dumps(fields))
    with pytest.raises(ValueError, match="s.json: "):
        lu.load(file)


def test_missing_files_and_folders(tmp_path):
    with pytest.raises(FileNotFoundError, match="no file .*gone.json"):
        lu.load(tmp_path / "gone.json")
    with pytest.raises(FileNotFoundError, match="no folder .*gone to write x.json into"):
        lu.save(a_design(), tmp_path / "gone" / "x.json")


def test_plain_values():
    value = {"a": np.float64(0.5), "b": (np.int32(3), np.nan), "c": np.array([True]), "d": np.inf}
    assert plain(value) == {"a": 0.5, "b": [3, None], "c": [True], "d": "inf"}
