"""The command line: what it says, what it writes, and how it ends."""

import io
import json
import os
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import trimesh
from rich.console import Console

import lineup as lu
from lineup import cli, draw, sweep
from lineup._progress import Reporter
from lineup.experiment import read_experiment
from lineup.kinematics import Move

CORNER = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 2, 0]], np.int32)
SWING = np.array([[Move.SWING, 1, 2, 0]], np.int32)


@pytest.fixture
def fake(monkeypatch):
    monkeypatch.setitem(sweep.TASKS, "table2", "fake_tasks:table2_task")


@pytest.fixture
def lineup(capsys, tmp_path, monkeypatch):
    """Run one command line in an empty folder: (exit code, stdout, stderr)."""
    monkeypatch.chdir(tmp_path)

    def run(*args):
        code = cli.run([str(arg) for arg in args])
        said = capsys.readouterr()
        return code, said.out, said.err

    return run


def a_folding(moves=SWING, straight=True):
    motion = lu.Motion(CORNER, moves, 0.999, 90.0, straight, "straight")
    return lu.Folding(lu.VoxelPath(CORNER), motion)


def one_line(err):
    return err.startswith("lineup: error: ") and err.count("\n") == 1


def test_help_is_quick_and_names_every_command():
    command = [Path(sys.executable).with_name("lineup"), "--help"]
    times = []
    for _ in range(3):
        begin = time.perf_counter()
        said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        times.append(time.perf_counter() - begin)
    for name in ("table2", "run", "verify", "models", "voxelize", "path", "unfold", "sweep"):
        assert f"  {name} " in said
    assert min(times) < 1


def test_help_loads_no_heavy_package():
    code = "import sys, lineup.cli as c; c.run(['--help']); print(sorted(sys.modules))"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout
    assert "'lineup.cli'" in loaded
    for heavy in ("numpy", "pandas", "numba", "pydantic"):
        assert f"'{heavy}'" not in loaded


def test_no_command_is_help(lineup):
    code, out, err = lineup()
    assert code == 0
    assert "table2" in out
    assert not err


def test_table2_quick_runs_the_experiment_file(lineup, fake, tmp_path, monkeypatch):
    monkeypatch.setattr(draw.render, "renderer", lambda: "matplotlib")  # quick for small pictures
    code, out, err = lineup("table2", "--quick", "--workers", 2)
    assert code == 1
    assert err.splitlines() == [
        "falls short: cannon: no such mesh",
        "falls short: duck: length 398 instead of 400",
    ]
    assert "[5/5] " in out
    assert "3 of 5" in out
    table = pd.read_csv(tmp_path / "results" / "table2-quick.csv")
    assert table.model.tolist() == ["bunny", "decocube", "cannon", "two_holed_torus", "duck"]
    assert (tmp_path / "results" / "table2-quick.png").is_file()
    rows = [tmp_path / f"results/table2-quick/{name}-200/row.json" for name in ("bunny", "cannon")]
    fine, failed = (json.loads(row.read_text()) for row in rows)
    assert (fine["format"], fine["version"], fine["reason"]) == ("lineup-row", 2, "")
    assert list(fine["files"]) == ["bunny.folding.json"]
    assert (failed["format"], failed["version"], failed["reason"]) == (
        "lineup-row",
        2,
        "no such mesh",
    )
    again = lineup("sweep", cli.EXPERIMENTS / "table2.yaml", "--variant=quick", "--engine=serial")
    assert again[0] == 1
    assert "bunny-200: kept" in again[1]
    assert "cannon-200: kept" not in again[1]


def test_the_experiment_has_the_two_sets_of_the_paper(tmp_path, fake):
    experiment = read_experiment(cli.EXPERIMENTS / "table2.yaml")
    found = sweep.tasks(experiment, tmp_path)
    from lineup.tables import PAPER

    assert [(t.settings["model"], 2 * t.settings["blocks"]) for t in found] == [
        (name, row.length) for name, row in PAPER.items()
    ]


def test_a_sweep_of_another_task_writes_its_table_and_plot(lineup, tmp_path, monkeypatch):
    monkeypatch.setitem(sweep.TASKS, "fake", "fake_tasks:work")
    monkeypatch.setenv("LINEUP_TEST_CALLS", str(tmp_path / "calls"))
    (tmp_path / "e.yaml").write_text(
        "{title: t, task: fake, grids: [{model: [a, b], blocks: [1, 2]}],"
        " table: {index: model, columns: blocks, values: length}, plot: {x: blocks, y: length}}"
    )
    code, out, _ = lineup("sweep", "e.yaml", "--engine", "serial")
    assert code == 0
    assert "written: results/e.csv" in out
    assert pd.read_csv("results/e.csv").length.tolist() == [2, 4, 2, 4]
    assert "| a       |   2 |   4 |" in (tmp_path / "results" / "e.md").read_text()
    assert all((tmp_path / f"results/e.{kind}").is_file() for kind in ("tex", "html", "png"))
    assert (pd.read_csv("results/e-seconds.csv").seconds >= 0).all()
    before = (tmp_path / "results" / "e.csv").read_bytes()
    assert lineup("sweep", "e.yaml", "--engine", "serial")[0] == 0
    assert (tmp_path / "results" / "e.csv").read_bytes() == before


def test_chains_of_a_file_and_of_one_model_twice_are_each_drawn(lineup, tmp_path, monkeypatch):
    drawn = []
    monkeypatch.setattr(draw, "contact_sheet", lambda chains, _: drawn.extend(chains))
    monkeypatch.setattr(draw, "unfolding", lambda chain: chain)
    monkeypatch.setattr(draw, "save", lambda figure, file: file)
    (tmp_path / "meshes").mkdir()
    trimesh.creation.box((4, 3, 2)).export(tmp_path / "meshes" / "brick.stl")
    (tmp_path / "e.yaml").write_text(
        "{title: t, task: table2, fixed: {seed: 0},"
        " grids: [{model: meshes/brick.stl, blocks: [8, 9]}]}"
    )
    code, _, err = lineup("sweep", "e.yaml", "--engine", "serial")
    assert (code, err) == (0, "")
    assert [len(chain.path) for chain in drawn] == [16, 18]


def test_an_interrupt_says_what_is_kept(lineup, tmp_path, monkeypatch):
    monkeypatch.setitem(sweep.TASKS, "fake", "fake_tasks:work")
    monkeypatch.setenv("LINEUP_TEST_CALLS", str(tmp_path / "calls"))
    (tmp_path / "e.yaml").write_text(
        "{title: t, task: fake, grids: [{model: [a, interrupt], blocks: 1}]}"
    )
    code, _, err = lineup("sweep", "e.yaml", "--engine", "serial")
    assert code == 130
    assert err == "lineup: interrupted; what was finished is kept\n"


def test_verify_believes_no_file(lineup, tmp_path):
    good, bad = tmp_path / "good.folding.json", tmp_path / "bad.folding.json"
    lu.save(a_folding(), good)
    lu.save(a_folding(np.array([[Move.SWING, 1, 2, 3]], np.int32)), bad)
    code, out, err = lineup("verify", good)
    assert (code, err) == (0, "")
    assert "motion: certified (diameter 0.999, bends up to 90°, clearance 1.0000, 1 moves)" in out
    code, out, err = lineup("verify", tmp_path)
    assert code == 1
    assert out.count("FAILS") == 1
    assert err.startswith(f"falls short: {bad} motion: ")
    assert err.endswith("(at 0, diameter 0.999, bends up to 90°)\n")


def test_verify_judges_each_motion_at_what_it_claims(lineup, tmp_path):
    lu.save(lu.VoxelSolid(np.ones((3, 2, 1), bool)), tmp_path / "c.solid.json")
    lineup("path", "c.solid.json")
    lineup("unfold", "c.path.json", "--method", "pull")
    lu.save(a_folding(), tmp_path / "d.folding.json")
    code, out, err = lineup("verify", ".")
    assert (code, err) == (0, "")
    pulled, peeled = [line for line in out.splitlines() if " motion: " in line]
    assert "certified (diameter 0.866, bends up to 120°, clearance 0.8660, " in pulled
    assert "certified (diameter 0.999, bends up to 90°, " in peeled
    for option, value in (("--diameter", 0.999), ("--max-bend", 90)):
        code, out, _ = lineup("verify", "c.folding.json", "d.folding.json", option, value)
        assert code == 1
        failed = [line for line in out.splitlines() if line.startswith("FAILS")]
        assert len(failed) == 1
        assert failed[0].startswith("FAILS c.folding.json motion: ")


@pytest.mark.parametrize(
    "claim", [{"diameter": 0.0}, {"diameter": -1.0}, {"max_bend_deg": 0.0}, {"max_bend_deg": 181.0}]
)
def test_a_claim_that_means_nothing_falls_short(lineup, tmp_path, claim):
    folding = a_folding()
    motion = replace(folding.motion, **claim)
    lu.save(lu.Folding(folding.path, motion), tmp_path / "c.folding.json")
    code, _, err = lineup("verify", "c.folding.json")
    assert code == 1
    (value,) = claim.values()
    assert err.startswith("falls short: c.folding.json motion: its claim cannot be judged: ")
    assert err.endswith(f"got {value}\n")


def test_bars_that_collide_are_refused_whatever_the_motion_claims(lineup, tmp_path):
    bars = a_folding(np.array([[Move.SWING, 1, 2, 3]], np.int32))
    motion = replace(bars.motion, diameter=1e-9, max_bend_deg=180.0)
    lu.save(lu.Folding(bars.path, motion), tmp_path / "c.folding.json")
    code, _, err = lineup("verify", "c.folding.json")
    assert code == 1
    assert "bars 0 and 2 come within 0, " in err
    assert "(at 0, diameter 1e-09, bends up to 180°)" in err


def test_verify_goes_on_after_a_file_that_cannot_be_read(lineup, tmp_path):
    lu.save(a_folding(), tmp_path / "b.folding.json")
    (tmp_path / "a.folding.json").write_text("{}")
    text = (tmp_path / "b.folding.json").read_text()
    (tmp_path / "c.folding.json").write_text(text.replace("s1+E", "s1+Q"))
    lu.save(lu.VoxelPath(np.array([[0, 0, -1], [0, 0, 0]])), tmp_path / "d.path.json")
    code, out, err = lineup("verify", ".")
    assert code == 1
    wrong = [
        "a.folding.json: format: Field required",
        "c.folding.json: move 0 reads 's1+Q', which",
        "d.path.json: a voxel of the path has a negative coordinate: -1",
    ]
    said = out.splitlines()
    for line, expected in zip([said[0], *said[3:]], wrong, strict=True):
        assert line.startswith(f"FAILS {expected}")
    assert said[1].startswith("ok    b.folding.json path: certified")
    assert said[2].startswith("ok    b.folding.json motion: certified")
    assert err == "".join(f"falls short: {said[k][6:]}\n" for k in (0, 3, 4))


def test_verify_judges_a_path_against_the_solid_beside_it(lineup, tmp_path):
    lu.save(a_folding().path, tmp_path / "c.path.json")
    assert lineup("verify", "c.path.json")[0] == 0
    lu.save(lu.VoxelSolid(np.ones((2, 3, 1), bool)), tmp_path / "c.solid.json")
    code, _, err = lineup("verify", "c.path.json")
    assert code == 1
    assert "c.path.json path: " in err


def test_a_pulled_motion_is_judged_for_the_bars_it_needs(lineup, tmp_path):
    lu.save(lu.VoxelSolid(np.ones((3, 2, 1), bool)), tmp_path / "c.solid.json")
    lineup("path", "c.solid.json")
    code, out, _ = lineup("unfold", "c.path.json", "--method", "pull")
    assert code == 0
    assert "certified (diameter 0.866, bends up to 120°, clearance 0.8660" in out


def test_unfold_for_slotted_joints(lineup, tmp_path):
    lu.save(lu.VoxelSolid(np.ones((3, 3, 2), bool)), tmp_path / "c.solid.json")
    lineup("path", "c.solid.json")
    assert lineup("unfold", "c.path.json")[0] == 0
    free = lu.load(tmp_path / "c.folding.json").motion
    assert not lu.certify(free, joints="slotted").ok
    assert lineup("unfold", "c.path.json", "--joints", "slotted")[0] == 0
    slotted = lu.load(tmp_path / "c.folding.json").motion
    assert lu.certify(slotted, joints="slotted").ok
    assert slotted.reason == "straight: peel, since one tilt would twist blocks"


def test_a_name_with_dots_keeps_them(lineup, tmp_path):
    lu.save(lu.VoxelSolid(np.ones((2, 3, 1), bool)), tmp_path / "c.v2.solid.json")
    assert lineup("path", "c.v2.solid.json")[0] == 0
    assert lineup("unfold", "c.v2.path.json")[0] == 0
    assert lineup("verify", "c.v2.folding.json")[0] == 0
    lu.save(lu.VoxelSolid(np.ones((2, 4, 1), bool)), tmp_path / "c.v2.solid.json")
    code, _, err = lineup("verify", "c.v2.folding.json")
    assert code == 1
    assert "c.v2.folding.json path: " in err


def test_verify_a_design_without_models(lineup, tmp_path):
    lu.save(lu.Design((), (), (), pd.DataFrame({"model": ["gone"]})), tmp_path)
    code, _, err = lineup("verify", tmp_path)
    assert code == 1
    assert "no model was folded" in err


def test_verify_a_design(lineup, tmp_path):
    solid = lu.VoxelSolid(np.array([[1, 0, 0], [1, 1, 1]], bool)[:, :, None], name="corner")
    verdict = lu.certify(a_folding().motion)
    table = pd.DataFrame({"model": ["corner"]})
    lu.save(lu.Design((solid,), (a_folding(),), (verdict,), table), tmp_path)
    code, out, _ = lineup("verify", tmp_path)
    assert code == 0
    assert out.count("ok ") == 3


def test_voxelize_path_and_verify_on_a_mesh_file(lineup, tmp_path):
    trimesh.creation.box((4, 3, 2)).export(tmp_path / "brick.stl")
    code, out, err = lineup("voxelize", "brick.stl", "--voxels", 24)
    assert (code, err) == (0, "")
    assert "24 voxels in a grid of 4 x 3 x 2" in out
    code, out, err = lineup("path", "brick.solid.json", "--out", "deep/er")
    assert (code, err) == (0, "")
    assert lu.load("deep/er/brick.path.json").coverage(lu.load("brick.solid.json")) > 0.9
    assert lineup("verify", "deep")[0] == 0


def test_models(lineup):
    code, out, _ = lineup("models")
    assert code == 0
    assert "two_holed_torus" in out
    assert "bunny" not in lineup("models", "duck")[1]


BAD_USE = {
    "unknown command": (["fold"], "No such command"),
    "unknown option": (["table2", "--fast"], "No such option"),
    "no number": (["run", "bunny", "--blocks", "many"], "valid int"),
    "missing argument": (["verify"], "Missing argument"),
    "missing mesh": (["voxelize", "gone.obj"], "no file gone.obj"),
    "missing folder": (["verify", "gone"], "no file or folder gone"),
    "nothing stored": (["verify", "nothing"], "no stored result"),
    "missing experiment": (["sweep", "gone.yaml"], "no experiment file gone.yaml"),
    "not an experiment": (["sweep", "text.txt"], "text.txt: "),
    "unknown engine": (["sweep", "ok.yaml", "--engine", "threads"], "unknown engine 'threads'"),
    "no workers": (["table2", "--workers", "0"], "workers must be at least 1, got 0"),
    "unknown variant": (["sweep", "ok.yaml", "--variant", "x"], "unknown variant 'x'"),
    "unwritable folder": (["table2", "--quick", "--out", "text.txt"], "text.txt"),
    "empty mesh": (["voxelize", "empty.obj"], "empty.obj"),
    "nan in a mesh": (["voxelize", "nan.obj"], "nan.obj"),
    "zero voxels": (["voxelize", "text.obj", "--voxels", "0"], "voxels"),
    "unknown model": (["voxelize", "teapotty"], "no file and no model 'teapotty'"),
    "unknown model to run": (["run", "teapotty"], "no file and no model 'teapotty'"),
    "unknown method": (["path", "cube.solid.json", "--method", "magic"], "'magic'"),
    "malformed result": (["verify", "text.txt"], "text.txt: Invalid JSON"),
    "another kind": (["unfold", "cube.solid.json"], "holds a VoxelSolid, and a path is needed"),
    "empty mesh to run": (["run", "duck", "empty.obj"], "empty.obj"),
    "nan in a mesh to run": (["run", "nan.obj"], "nan.obj"),
    "negative blocks": (["run", "duck", "--blocks", "-3"], "blocks"),
    "one name twice": (["run", "duck", "duck"], "two models would be stored under one name"),
    "no direction": (["voxelize", "duck", "--up", "high"], "high"),
    "voxels turned": (["voxelize", "cube.solid.json", "--up", "+x"], "cannot be turned"),
    "negative seed": (["run", "duck", "--seed", "-1"], "seed must be an integer of at least 0"),
    "negative diameter": (["verify", "c.folding.json", "--diameter", "-1"], "diameter"),
}  # fmt: skip


@pytest.mark.parametrize("fault", BAD_USE)
def test_bad_use_is_one_line_and_exit_code_2(lineup, fake, tmp_path, fault):
    args, message = BAD_USE[fault]
    (tmp_path / "nothing").mkdir()
    (tmp_path / "text.txt").write_text("hello")
    (tmp_path / "text.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (tmp_path / "empty.obj").write_text("")
    (tmp_path / "nan.obj").write_text("v 0 0 nan\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n")
    (tmp_path / "ok.yaml").write_text(
        "{title: t, task: table2, fixed: {seed: 0}, grids: [{model: duck, blocks: 1}]}"
    )
    lu.save(lu.VoxelSolid(np.ones((2, 2, 2), bool)), tmp_path / "cube.solid.json")
    lu.save(a_folding(), tmp_path / "c.folding.json")
    code, _, err = lineup(*args)
    assert code == 2
    assert one_line(err)
    assert message in err


def test_the_installed_command_ends_without_a_traceback(tmp_path):
    command = [Path(sys.executable).with_name("lineup"), "table2", "--quick", "--workers"]
    run = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=os.environ)
    assert run.returncode == 2
    assert run.stderr == "lineup: error: Option '--workers' requires an argument.\n"


@pytest.mark.parametrize("terminal", [False, True])
def test_progress_lines(terminal):
    console = Console(file=io.StringIO(), force_terminal=terminal, width=100)
    now = [0.0]
    with Reporter(8, console, clock=lambda: now[0]) as tell:
        tell("h", "kept")
        tell("a", "made anew: its file is spoilt")
        for name in "abcdefg":
            tell(name, "fold")
        now[0] = 10.0
        tell("a", "done")
        assert tell.left() == "about 60 s left"
        now[0] = 40.0
        assert tell.left() == "about 30 s left"
        tell("b", "failed: [red] mesh")
        assert tell.left() == "about 2 min left"
    said = console.file.getvalue()
    left = [" (about 60 s left)", " (about 2 min left)"] if not terminal else ["", ""]
    assert f"[2/8] a: done{left[0]}\n" in said
    assert f"[3/8] b: failed: [red] mesh{left[1]}\n" in said
    assert "[1/8] a: made anew: its file is spoilt\n" in said
    assert ("[1/8] e: fold\n" in said) != terminal
    assert ("c: fold, d: fold, e: fold" in said) == terminal
    assert ("and 2 more" in said) == terminal
