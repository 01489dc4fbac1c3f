"""What is in a file is never run, and no name in it leads out of the folder to write into."""

import json
import os
import pickle
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from crafted import BUFFER, TETRAHEDRON, YAML, gltf, read, refused, written
from test_storage import a_design

import lineup as lu
from lineup import cli, draw, meshes
from lineup.draw.page import caption
from lineup.experiment import Experiment, Plot, tasks
from lineup.pipeline import transformations

# What is never run


class Planted:
    """Makes a file when it is unpickled."""

    def __init__(self, file):
        self.file = str(file)

    def __reduce__(self):
        return os.mkdir, (self.file,)


def pickles(folder):
    """A pickle, plain and as arrays of NumPy, each of which would make `planted`."""
    planted = np.array([Planted(folder / "planted")], object)
    np.save(folder / "array.npy", planted, allow_pickle=True)
    np.savez(folder / "arrays.npz", vertices=planted, faces=planted)
    written(folder, "plain.pickle", pickle.dumps(Planted(folder / "planted")))
    with zipfile.ZipFile(folder / "bomb.3mf", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("3D/3dmodel.model", bytes(2**24))
    return ["array.npy", "arrays.npz", "plain.pickle", "bomb.3mf"]


def test_nothing_is_unpickled_or_unzipped(tmp_path):
    names = pickles(tmp_path)
    np.load(tmp_path / "array.npy", allow_pickle=True)
    (tmp_path / "planted").rmdir()  # so it would have been made
    for name in names:
        refused(tmp_path / name, "has an ending that is not read")
        for ending in (*meshes.FORMATS, ".solid.json", ".manual.json", ".manual.csv", ".yaml"):
            refused(written(tmp_path, f"as{ending}", (tmp_path / name).read_bytes()))
    assert not (tmp_path / "planted").exists()


@pytest.mark.parametrize(
    "value",
    [
        "!!python/object/apply:os.mkdir [planted]",
        "!!python/name:os.system",
        "!!python/object/new:os.mkdir [planted]",
        "!!binary aGk=",
        "!!int",
        "!mine x",
        "! x",
    ],
)
def test_no_tag_of_yaml_does_anything(tmp_path, monkeypatch, value):
    monkeypatch.chdir(tmp_path)
    refused(written(tmp_path, "tag.yaml", YAML.replace("60", value)), "line 4: tags and aliases")
    assert os.listdir(tmp_path) == ["tag.yaml"]


def test_aliases_do_not_multiply(tmp_path):
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]" for k in range(1, 12)]
    refused(written(tmp_path, "laughs.yaml", "\n".join(lines)), "line 2: tags and aliases")


def test_an_experiment_is_neither_deep_nor_long_nor_binary(tmp_path):
    refused(written(tmp_path, "binary.yaml", "title: \0"), "special characters are not allowed")
    refused(written(tmp_path, "deep.yaml", "? " * 10**4), "nested too deeply")
    refused(written(tmp_path, "long.yaml", "#" * 2**19), "files of up to 65,536 are read")


def test_an_experiment_of_too_many_tasks_is_refused_at_once(tmp_path):
    grid = {"model": ["duck"], "method": ["layered"], "voxels": list(range(1000)), "up": ["+x"]}
    wide = Experiment(title="t", task="path", grids=[grid | {"seed": list(range(1000))}])
    with pytest.raises(ValueError, match="make 1,000,000 tasks, and up to 10,000 are run"):
        tasks(wide, tmp_path)


# Names that lead elsewhere

ELSEWHERE = ["../x", "../../x", "/x", "a/../../x", "..", ".", "a\\x", "a\nx", "a\0x"]


@pytest.mark.parametrize("uri", [*ELSEWHERE, "/etc/passwd", "http://127.0.0.1:1/x", "/dev/zero"])
def test_gltf_files_name_no_files_elsewhere(tmp_path, uri):
    (tmp_path / "in" / "a").mkdir(parents=True)
    written(tmp_path, "x", BUFFER)  # what `../x` would be
    tree = gltf(buffers=[{"byteLength": 96, "uri": uri}])
    refused(written(tmp_path / "in", "a.gltf", json.dumps(tree)), "cannot be read as a mesh")


def test_gltf_files_name_files_beside_them(tmp_path):
    """Which are part of what the surface came from; a link to an endless one is no file."""
    tree = gltf(buffers=[{"byteLength": 96, "uri": "x.bin"}])
    file = written(tmp_path, "a.gltf", json.dumps(tree))
    keys = set()
    for scale in (1, 2):
        written(tmp_path, "x.bin", (TETRAHEDRON * scale).astype("<f4").tobytes() + BUFFER[48:])
        keys.add(read(file).key)
    assert len(keys) == 2
    (tmp_path / "x.bin").unlink()
    (tmp_path / "x.bin").symlink_to("/dev/zero")
    refused(file, "no file")


@pytest.fixture
def ends_badly(tmp_path, capsys, monkeypatch):
    """Run a command in a folder of a folder: one line, and no file anywhere."""
    inner = tmp_path / "inner" / "most"
    inner.mkdir(parents=True)
    monkeypatch.chdir(inner)

    def run(*args):
        before = sorted(tmp_path.rglob("*"))
        assert cli.run([str(arg) for arg in args]) == 2
        said = capsys.readouterr().err
        assert said.startswith("lineup: error: ")
        assert said.count("\n") == 1
        assert [f for f in sorted(tmp_path.rglob("*")) if f not in before and f.name != "out"] == []
        return said

    return run


@pytest.mark.parametrize("name", ELSEWHERE)
@pytest.mark.parametrize("command", ["voxelize", "path"])
def test_a_solid_that_calls_itself_elsewhere_is_refused(ends_badly, command, name):
    lu.save(replace(a_design().models[0], name=name), "s.json")
    assert "cannot be the name of a file" in ends_badly(command, "s.json", "--out", "out")


@pytest.mark.parametrize("name", ["..", "."])
def test_an_experiment_that_is_called_elsewhere_is_refused(ends_badly, name):
    written(Path(), f"{name}.yaml", YAML)
    assert "cannot be the name" in ends_badly("sweep", f"{name}.yaml", "--out", "out")


def test_a_variant_that_is_called_elsewhere_is_refused(ends_badly):
    written(Path(), "e.yaml", YAML + "variants: {../../x: [{model: duck, voxels: 60}]}\n")
    said = ends_badly("sweep", "e.yaml", "--variant", "../../x", "--out", "out")
    assert "cannot be the name" in said


@pytest.mark.parametrize("value", ["..", "...ply"])
def test_a_setting_that_would_be_a_folder_elsewhere_is_refused(ends_badly, value):
    written(
        Path(),
        "e.yaml",
        YAML.replace("duck], voxels: [60, 90]", f"{value}]").replace(
            "seed: 0", "voxels: 6, method: u"
        ),
    )
    assert "cannot be the name" in ends_badly("sweep", "e.yaml", "--out", "out")


def test_a_film_of_a_kind_that_leads_elsewhere_is_refused(ends_badly):
    lu.save(a_design().foldings[0], "f.json")
    said = ends_badly("animate", "f.json", "--format", "x/../../../x.gif")
    assert "cannot be the name" in said


FOLDING = "..$a..folding.json"
COMMANDS = {
    "unfold": ["..$a..path.json"],
    "transform": [FOLDING, FOLDING],
    "play": [FOLDING],
    "robot": [FOLDING],
    "manual": [FOLDING],
    "strength": [FOLDING],
    "animate": [FOLDING, "--pictures", "3"],
    "print": ["evil.design.json"],
    "verify": ["evil.design.json"],
}
SLOW = ("manual", "strength", "animate", "print")


@pytest.mark.parametrize(
    "command", [pytest.param(c, marks=[pytest.mark.slow] * (c in SLOW)) for c in COMMANDS]
)
def test_a_command_writes_into_its_folder_alone(tmp_path, monkeypatch, command):
    """Whatever the file is called, and the models in it."""
    inner = tmp_path / "inner" / "most"
    inner.mkdir(parents=True)
    monkeypatch.chdir(inner)
    design = a_design()
    chain = lu.fold(design.models[0], rounds=20, trial_rounds=5)
    lu.save(chain.path, "..$a..path.json")
    lu.save(chain, FOLDING)
    solid = replace(design.models[0], name="../../evil")
    lu.save(replace(design, models=(solid,), foldings=(chain,)), "evil.design.json")
    before = sorted(tmp_path.rglob("*"))
    out = [] if command == "verify" else ["--out", "out"]
    assert cli.run([command, *COMMANDS[command], *out]) in (0, 1)
    new = [file for file in sorted(tmp_path.rglob("*")) if file not in before]
    assert [file for file in new if inner / "out" not in (file, *file.parents)] == []
    assert bool(new) == bool(out)


@pytest.mark.parametrize("name", ELSEWHERE)
def test_the_library_refuses_names_that_lead_elsewhere(tmp_path, name):
    design = a_design()
    out = tmp_path / "in" / "out"
    out.mkdir(parents=True)
    solid = replace(design.models[0], name=name)
    table = pd.DataFrame({"model": [name, "b"], "failure": ""})
    for write in (
        lambda: lu.lineup([solid], 2, folder=out),
        lambda: lu.write_manual(design.foldings[0], out, name=name),
        lambda: transformations(replace(design, foldings=design.foldings * 2, table=table), out),
    ):
        with pytest.raises(ValueError, match="cannot be the name of a file"):
            write()
    assert [f for f in tmp_path.rglob("*") if f.is_file()] == []


# Texts that are no formulas, and what a command says at its end


def test_names_are_drawn_as_they_stand():
    name = r"$\no{ $ formula \$"
    rows = pd.DataFrame({"model": [name, "b"], "gap": [0.1, 0.2], "failure": ""})
    figure = draw.experiment(rows, Plot(x="model", y="gap", by="model", x_label=name), name)
    panel = figure.add_subplot()
    caption(panel, f"{name}\n{name}")
    figure.canvas.draw()
    assert panel.title._preprocess_math(panel.get_title()) == (name, False)


@pytest.mark.parametrize(
    ("error", "words"), [(MemoryError, "more memory than there is"), (RecursionError, "nested")]
)
def test_a_command_without_room_ends_in_one_line(ends_badly, monkeypatch, error, words):
    def load(file):
        raise error

    monkeypatch.setattr("lineup.storage.load", load)
    lu.save(a_design(), "d.json")
    assert words in ends_badly("print", "d.json", "--out", "out")
