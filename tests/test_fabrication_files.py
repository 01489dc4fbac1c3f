"""What slicers read: 3MF and STL of a chain, and the command that writes them."""

import zipfile
from collections import Counter
from pathlib import Path

import lib3mf
import numpy as np
import pytest
import trimesh

import lineup as lu
from lineup import cli
from lineup.block import Block, Part, block_parts, solids
from lineup.fabrication import Placed, pieces_on
from lineup.fabrication.files import Painted, write_3mf
from lineup.fabrication.layout import boustrophedon
from lineup.kinematics import Move

PAPER = Block()
CORNER = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (1, 1, 1), (0, 1, 1), (0, 0, 1)])


def path_of(n):
    return lu.VoxelPath(boustrophedon(n, 39, 39))


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A chain of 6 blocks on two plates, with everything written."""
    folder = tmp_path_factory.mktemp("small")
    made = lu.export_print(path_of(12), folder, bed_mm=(45.0, 25.0), whole_stl=True)
    return folder, made


@pytest.fixture(scope="module")
def full(tmp_path_factory):
    """The paper's 754 blocks on one plate."""
    folder = tmp_path_factory.mktemp("full")
    return folder, lu.export_print(path_of(1508), folder, bed_mm=(400.0, 400.0))


def read_3mf(file):
    model = lib3mf.Wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(file))
    assert reader.GetWarningCount() == 0
    return model


def listed(iterator, get):
    found = []
    while iterator.MoveNext():
        found.append(getattr(iterator, get)())
    return found


def components(model):
    """Every piece of a chain in its place, as lib3mf has it."""
    (chain,) = listed(model.GetComponentsObjects(), "GetCurrentComponentsObject")
    for k in range(chain.GetComponentCount()):
        component = chain.GetComponent(k)
        mesh = model.GetMeshObjectByID(component.GetObjectResourceID())
        vertices = np.array([list(v.Coordinates) for v in mesh.GetVertices()])
        faces = np.array([list(t.Indices) for t in mesh.GetTriangleIndices()])
        rows = np.array([list(row) for row in component.GetTransform().Fields])
        matrix = np.array([list(r) for r in rows]).reshape(4, 3)
        yield trimesh.Trimesh(vertices @ matrix[:3] + matrix[3], faces)


def outline(box):
    low, high = box.MinCoordinate, box.MaxCoordinate
    return np.array([list(low), list(high)])


def test_a_3mf_is_read_without_a_warning_and_every_mesh_is_a_manifold(full, small):
    for folder, made in (full, small):
        for file in folder.glob("*.3mf"):
            model = read_3mf(file)
            assert model.GetUnit() == lib3mf.ModelUnit.MilliMeter
            meshes = listed(model.GetMeshObjects(), "GetCurrentMeshObject")
            assert all(mesh.IsManifoldAndOriented() for mesh in meshes)
            assert model.GetBuildItems().Count() == 1
        assert made.report.ok


def test_a_3mf_has_every_piece_and_six_colours(full):
    folder, _ = full
    model = read_3mf(folder / "chain.3mf")
    (chain,) = listed(model.GetComponentsObjects(), "GetCurrentComponentsObject")
    parts = [chain.GetComponent(k).GetObjectResource() for k in range(chain.GetComponentCount())]
    counts = Counter(part.GetName() for part in parts)
    assert sum(counts.values()) == 754 + 753 + 2
    assert counts["hinge"] == 754
    (materials,) = listed(model.GetBaseMaterialGroups(), "GetCurrentBaseMaterialGroup")
    colour = {}
    for mesh in listed(model.GetMeshObjects(), "GetCurrentMeshObject"):
        group, index, has = mesh.GetObjectLevelProperty()
        assert has or group == materials.GetResourceID()
        shade = materials.GetDisplayColor(index)
        colour[mesh.GetName()] = (shade.Red, shade.Green, shade.Blue)
    assert len({colour[f"middle-{k}"] for k in range(1, 7)}) == 6
    assert colour["end-1"] == colour["middle-1"]
    assert colour["end-6"] == colour["middle-6"]
    assert colour["hinge"] not in {colour[f"middle-{k}"] for k in range(1, 7)}
    shares = [counts[f"middle-{k}"] for k in range(1, 7)]
    assert max(shares) - min(shares) <= 2


def test_a_chain_lies_on_the_middle_of_the_bed(full, small):
    for (folder, _), name, bed in ((full, "chain", (400, 400)), (small, "chain-1", (45, 25))):
        low, high = outline(read_3mf(folder / f"{name}.3mf").GetOutbox())
        assert low[2] == pytest.approx(0, abs=1e-3)
        assert (low >= -1e-3).all()
        assert (low + high)[:2] == pytest.approx(bed, abs=2e-3)


def test_3mf_and_stl_of_a_plate_are_the_same_bodies(small):
    folder, made = small
    for plate, name in zip(made.plates, ("chain-1", "chain-2"), strict=True):
        pieces = pieces_on(plate, PAPER)
        meshes = list(components(read_3mf(folder / f"{name}.3mf")))
        assert all(mesh.is_watertight for mesh in meshes)
        stl = trimesh.load(folder / f"{name}.stl")
        together = trimesh.util.concatenate(meshes)
        assert together.bounds == pytest.approx(stl.bounds, abs=2e-3)
        bodies = stl.split(only_watertight=True)
        assert len(bodies) == len(meshes) == len(pieces)
        centres = [
            sorted(m.center_mass.round(2).tolist() for m in some) for some in (bodies, meshes)
        ]
        assert np.array(centres[0]) == pytest.approx(np.array(centres[1]), abs=0.02)
        expected = sorted(solids(PAPER)[piece.part].volume() for piece in pieces)
        assert sorted(b.volume for b in bodies) == pytest.approx(expected, rel=1e-3)


def test_single_parts_are_watertight_and_of_the_size_they_say(small):
    folder, _ = small
    parts = block_parts(PAPER)
    assert {f.stem for f in (folder / "parts").iterdir()} == set(parts)
    for name, part in parts.items():
        mesh = trimesh.load(folder / "parts" / f"{name}.stl")
        assert mesh.is_watertight
        assert mesh.volume == pytest.approx(part.volume_mm3, rel=1e-4)
        assert mesh.bounds[0] == pytest.approx([0, 0, 0], abs=1e-4)


def test_rounding_does_not_tear_a_mesh(tmp_path):
    """Two vertices nearer than what is written would be one, and the faces between them none."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (2e-6, 0, 1)], float)
    faces = np.array([(0, 2, 1), (0, 1, 4), (0, 4, 3), (1, 2, 4), (2, 3, 4), (0, 3, 2)])
    near = Part(corners, faces, 1 / 6)
    place = Placed("near", np.eye(3, dtype=int), np.zeros(3), 0)
    painted = {"near": Painted(near, "near", "#ff0000")}
    file = write_3mf(tmp_path / "near.3mf", "near", painted, [("near", place)], np.zeros(3))
    (mesh,) = components(read_3mf(file))
    assert mesh.is_watertight
    assert len(mesh.vertices) == 5


def test_754_blocks_are_a_small_file(full):
    folder, made = full
    assert (folder / "chain.3mf").stat().st_size < 200_000
    assert [f.name for f in made.files if f.suffix == ".stl" and f.parent == folder] == []


def test_equal_chains_give_equal_bytes(small, tmp_path):
    folder, made = small
    again = lu.export_print(path_of(12), tmp_path, bed_mm=(45.0, 25.0), whole_stl=True)
    names = [file.relative_to(folder) for file in made.files]
    assert names == [file.relative_to(tmp_path) for file in again.files]
    assert sorted(names) == sorted(f.relative_to(folder) for f in folder.rglob("*") if f.is_file())
    for name in names:
        assert (folder / name).read_bytes() == (tmp_path / name).read_bytes()
    with zipfile.ZipFile(tmp_path / "chain-1.3mf") as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}


# The command.


@pytest.fixture
def lineup(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def run(*args):
        code = cli.run([str(arg) for arg in args])
        said = capsys.readouterr()
        return code, said.out, said.err

    return run


def test_print_writes_what_it_says(lineup):
    lu.save(path_of(12), "bar.path.json")
    code, out, err = lineup("print", "bar.path.json", "--bed", 45, 25, "--out", "there")
    assert (code, err) == (0, "")
    assert "6 blocks on 2 plates, 14 pieces: " in out
    assert "block: printable, least gap 0.250 mm" in out
    assert out.endswith("written: there\n")
    for name in ("chain-1.3mf", "chain-2.3mf", "coupon.3mf", "parts.csv", "parts.md"):
        assert Path("there", name).is_file()


def test_print_says_where_the_block_falls_short(lineup):
    pulled = lu.Motion(CORNER, np.array([(Move.PULL, 5, 0, 2)]), 0.914, 90.0, False, "pulled")
    lu.save(lu.Folding(lu.VoxelPath(CORNER), pulled), "crank.folding.json")
    code, out, err = lineup("print", "crank.folding.json")
    assert code == 1
    assert "3 blocks on 1 plate, 7 pieces" in out
    assert "falls short: pulls bend joints in any plane" in err
    code, _, err = lineup("print", "crank.folding.json", "--block", "pull", "--pose", "folded")
    assert (code, err) == (0, "")
    assert Path("print", "folded.3mf").is_file()


def test_print_takes_what_the_coupon_told(lineup):
    lu.save(path_of(4), "bar.path.json")
    code, out, _ = lineup("print", "bar.path.json", "--clearance-mm", 0.2, "--snap-mm", 0.05)
    assert code == 0
    assert "least gap 0.200 mm" in out
    assert "snaps by 0.05 mm" in Path("print", "parts.md").read_text()
    code, _, err = lineup("print", "bar.path.json", "--clearance-mm", 0.9)
    assert code == 2
    assert "clearance_mm must be from 0.05 to 0.5 mm" in err
    assert lineup("print", "bar.path.json", "--block", "thin")[0] == 2


def test_print_refuses_what_is_no_chain(lineup):
    lu.save(lu.VoxelSolid(np.ones((2, 2, 2), bool)), "cube.solid.json")
    code, _, err = lineup("print", "cube.solid.json")
    assert code == 2
    assert err.startswith("lineup: error: cube.solid.json holds a VoxelSolid, and a path, folding")
    assert err.count("\n") == 1
    assert lineup("print", "missing.path.json")[0] == 2
