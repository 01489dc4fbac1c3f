"""Files that mean harm end in one line that says why, soon and in little memory."""

import json
import os
import re
import subprocess
import sys
import time
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from crafted import FACES, TETRAHEDRON, WRITERS, YAML, claims, read, refused, written
from examples import examples
from hypothesis import given
from hypothesis import strategies as st
from test_storage import a_design

import lineup as lu
from lineup.manual.assembly import assembly_of
from lineup.manual.documents import csv_text, document_of, json_text

BOX = trimesh.creation.box((2, 1, 1))


# Small files, cut short and spoilt


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    """A small good file of every kind, by its name."""
    folder = tmp_path_factory.mktemp("good")
    design = a_design()
    square = design.foldings[0].path
    chain = lu.fold(design.models[0], rounds=20, trial_rounds=5)
    bends = replace(
        chain.motion, moves=np.array([[5, 2, 0, 1]]), angles=np.array([[0, 9, 1], [0, 0, 7]])
    )
    manual = document_of(assembly_of(chain), lu.certify(chain.motion), "square")
    embedded = trimesh.exchange.gltf.export_gltf(BOX.scene(), embed_buffers=True)
    records = {"solid": design.models[0], "path": square, "motion": bends, "design": design}
    files = {
        **{f"a.{kind}": BOX.export(file_type=kind) for kind in ("obj", "ply", "stl", "off", "glb")},
        "text.ply": BOX.export(file_type="ply", encoding="ascii"),
        "text.stl": BOX.export(file_type="stl_ascii"),
        "a.gltf": embedded["model.gltf"],
        **{f"a.{k}.json": lu.save(r, folder / "a.json").read_bytes() for k, r in records.items()},
        "a.manual.json": json_text(manual),
        "a.manual.csv": csv_text(manual.rows),
        "a.yaml": YAML,
    }
    return {name: d if isinstance(d, bytes) else d.encode() for name, d in files.items()}


MESHES = ["a.obj", "a.ply", "a.stl", "a.off", "a.glb", "a.gltf", "text.ply", "text.stl"]
STORED = [f"a.{kind}.json" for kind in ("solid", "path", "motion", "design", "manual")]
KINDS = [*MESHES, *STORED, "a.manual.csv", "a.yaml"]


def survived(file):
    """Read a file, which must go well, or end in one line that names it; nothing is warned of."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            read(file)
        except (ValueError, FileNotFoundError) as error:
            said = str(error)
        else:
            return True
    assert file.name in said
    assert "\n" not in said
    return False


@pytest.mark.parametrize("name", KINDS)
def test_a_file_that_is_cut_short_is_refused(good, tmp_path, name):
    data = good[name]
    assert survived(written(tmp_path, name, data))
    for at in range(0, len(data) - 3, max(1, len(data) // 20)):
        whole = survived(written(tmp_path, name, data[:at]))
        # Lines of these name no number of lines to come.
        assert not whole or name in ("a.obj", "a.yaml")


ODD = [
    *(b"0", b"-1", b"nan", b"inf", b"1e300", b"1e400", b"-1e-320", b"2147483648", b"100000000"),
    *(b"-9223372036854775809", b"1" * 5000, b"", b"null", b"[]", b"{}", b'"x"', b"\xff"),
    b"&a [*a]",
]


@st.composite
def spoilt(draw, data):
    """Bytes with a few of them cut out, copied, turned over, or numbers replaced by odd ones."""
    data = bytearray(data)
    for _ in range(draw(st.integers(1, 4))):
        kind, at = draw(st.integers(0, 4)), draw(st.integers(0, max(0, len(data) - 1)))
        end = at + draw(st.integers(1, 60))
        numbers = list(re.finditer(rb"-?\d+(\.\d+)?", bytes(data))) if kind > 2 else []
        if kind == 0:
            del data[at:end]
        elif kind == 1:
            data[at:at] = data[at:end]
        elif kind == 2 and data:
            data[at] = draw(st.integers(0, 255))
        elif numbers:
            number = numbers[at % len(numbers)]
            data[number.start() : number.end()] = draw(st.sampled_from(ODD))
        else:
            data[at : at + 4] = draw(st.sampled_from([0, 10**8, 2**31, 2**32 - 1])).to_bytes(4)
    return bytes(data)


@pytest.mark.parametrize("name", KINDS)
@examples(60)
@given(data=st.data())
def test_a_spoilt_file_is_read_or_refused(good, tmp_path_factory, name, data):
    folder = tmp_path_factory.getbasetemp()
    survived(written(folder, name, data.draw(spoilt(good[name]))))


# Numbers that are none, or too large, or name what is not there


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e300, 1e80])
@pytest.mark.parametrize("name", WRITERS)
def test_coordinates_that_nothing_can_be_reckoned_with_are_refused(tmp_path, name, value):
    vertices = TETRAHEDRON.copy()
    vertices[2, 1] = value
    refused(written(tmp_path, name, WRITERS[name](vertices)), "not finite|too large")
    with pytest.raises(ValueError, match="not finite|too large"):
        lu.voxelize((vertices, FACES), 60)


@pytest.mark.parametrize("scale", [5e-324, 1e-310, 1e-80, 1e80])
def test_a_mesh_of_any_size_is_reckoned_with_or_refused(scale):
    with pytest.raises(ValueError, match="too large or too close together"):
        lu.voxelize((TETRAHEDRON * scale, FACES), 60)


@pytest.mark.parametrize("scale", [1e-50, 1e50])
def test_the_unit_of_length_does_not_matter(scale):
    solid = lu.voxelize((TETRAHEDRON * scale, FACES), 60)
    assert solid.size == lu.voxelize((TETRAHEDRON, FACES), 60).size


@pytest.mark.parametrize("index", [4, 10**8, 2**40, -5])
@pytest.mark.parametrize("name", WRITERS)
def test_faces_that_name_no_vertex_are_refused(tmp_path, name, index):
    faces = FACES.copy()
    faces[1, 1] = index
    refused(written(tmp_path, name, WRITERS[name](TETRAHEDRON, faces)))


@pytest.mark.parametrize("n_faces", [3, 4])
@pytest.mark.parametrize("extent", [(1e6, 1e6, 1), (1, 1e7, 1e7), (3e7, 1, 1)])
def test_what_is_too_thin_is_refused_soon(extent, n_faces):
    begin = time.process_time()
    with pytest.raises(ValueError, match="too thin to be sampled: its bounding box is [13]"):
        lu.voxelize((TETRAHEDRON * extent, FACES[:n_faces]), 60)
    assert time.process_time() - begin < 5


SLIVER = TETRAHEDRON * 1e-3 + [[0, 0, 0], [0, 0, 0], [0, 0, 0], [1, 1, 1]]


@pytest.mark.parametrize(
    ("vertices", "faces"),
    [
        (TETRAHEDRON, np.tile(FACES, (2000, 1))),
        (TETRAHEDRON, np.tile(FACES[:3], (2000, 1))),
        (
            np.vstack([SLIVER + 1e-6 * k for k in range(30_000)]),
            np.vstack([FACES + 4 * k for k in range(30_000)]),
        ),
    ],
    ids=["closed", "open", "slivers"],
)
def test_a_heap_of_large_faces_is_refused_soon(vertices, faces):
    begin = time.process_time()
    with pytest.raises(ValueError, match="too many large faces, one above the other"):
        lu.voxelize((vertices, faces), 60)
    assert time.process_time() - begin < 5


# Claims that would take all memory or all time


READER = """
import json, resource, sys, time
from pathlib import Path
from crafted import TETRAHEDRON, off, read, written

folder = Path(sys.argv[1])
read(written(folder, "a.off", off(TETRAHEDRON)))
here = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (here + 2**29, here + 2**29))
resource.setrlimit(resource.RLIMIT_CPU, (60, 60))
for file in sorted(folder.glob("claims/*")):
    begin = time.process_time()
    try:
        said = f"taken for {read(file)}"
    except ValueError as error:
        said = str(error)
    print(json.dumps([file.name, said, time.process_time() - begin]), flush=True)
"""


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    """What is said of each claim by a process that has half a gigabyte, and in how many seconds."""
    if sys.platform != "linux":
        pytest.skip("only Linux bounds the memory of a process")
    folder = tmp_path_factory.mktemp("reader")
    (folder / "claims").mkdir()
    for name, content in claims().items():
        written(folder / "claims", name, content)
    with (folder / "claims" / "huge.json").open("wb") as file:
        file.truncate(2**40)  # takes no room on the disk
    paths = os.pathsep.join([str(Path(__file__).parents[1]), str(Path(__file__).parent)])
    done = subprocess.run(
        [sys.executable, "-c", READER, str(folder)],
        env=os.environ | {"PYTHONPATH": paths},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert not done.stderr
    lines = map(json.loads, done.stdout.splitlines())
    return {name: (said, seconds) for name, said, seconds in lines}


@pytest.mark.parametrize("name", [*claims(), "huge.json"])
def test_a_claim_is_refused_soon_and_in_little_memory(answers, name):
    said, seconds = answers[name]
    assert name in said
    # What places one mesh in 2 ** 60 ways places it once.
    assert said.startswith("taken for") == (name == "ways.glb")
    assert "MemoryError" not in said
    assert "nable to allocate" not in said
    assert "\n" not in said
    assert seconds < 5
