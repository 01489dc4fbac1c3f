"""Whatever a run meets, the next one ends with the results of a run that met nothing."""

import os
import random
import signal
from functools import partial
from itertools import count

import pytest
import trimesh
from disturbances import (
    contents,
    disturbed,
    fill_disk,
    forked,
    interrupt,
    kill,
    kill_amid_writing,
    powerless,
    refuses,
)

from lineup import cli, experiment

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="takes the signals of POSIX")

N_TASKS = 2
CONFIG = """
title: A ball in two sizes
task: table2
fixed: {model: ball.stl, seed: 0}
grids: [{blocks: [12, 16]}]
"""

ENDS = {
    kill: (-signal.SIGKILL, ""),
    kill_amid_writing: (-signal.SIGXFSZ, ""),
    interrupt: (130, "lineup: interrupted; what was finished is kept\n"),
    fill_disk: (2, "lineup: error: File too large: results/"),
}
"""How a run with each fault ends: its exit code, and how its last line begins."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with an experiment and its mesh."""
    folder = tmp_path_factory.mktemp("faults")
    trimesh.creation.icosphere(1).export(folder / "ball.stl")
    (folder / "ball.yaml").write_text(CONFIG)
    return folder


@pytest.fixture(scope="module")
def undisturbed(folder):
    """What the results say if nothing happens. Here all is loaded, for the copies of this process;
    what takes them long, and is not about faults, is left out."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setattr(cli.experiments, "draw_chains", lambda *_: [])
        patch.setattr(experiment, "source_digest", lambda module: "0123456789abcdef")
        assert cli.run(["sweep", "ball.yaml", "--engine", "serial", "--out", "undisturbed"]) == 0
        yield contents(folder / "undisturbed")


@pytest.fixture
def sweep(folder, undisturbed, tmp_path, monkeypatch):
    """Runs the experiment in an empty folder: exit code, and what was said."""
    for name in ("ball.stl", "ball.yaml"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    monkeypatch.chdir(tmp_path)
    return partial(forked, "sweep", "ball.yaml", "--engine", "serial")


def stored(folder):
    """The files that a reader finds, and how many tasks are done according to them."""
    found = {k: v for k, v in contents(folder).items() if not k.endswith(".tmp")}
    return found, sum(name.endswith("row.json") for name in found)


def check_rest(sweep, results, undisturbed):
    """What there is so far is right, and the next run takes it and makes the rest."""
    found, n_done = stored(results)
    assert found == {name: undisturbed[name] for name in found}
    code, said = sweep()
    assert code == 0
    assert said.count(": kept") == n_done
    assert contents(results) == undisturbed


@pytest.mark.parametrize("fault", ENDS, ids=lambda fault: fault.__name__)
@pytest.mark.parametrize("number", random.Random(7).sample(range(2, 45), 2))
def test_the_next_run_completes_what_was_cut_short(sweep, tmp_path, undisturbed, fault, number):
    results = tmp_path / "results"
    code, said = sweep(before=disturbed(fault, "results", number))
    end, words = ENDS[fault]
    assert code == end
    assert not words or said.splitlines(keepends=True)[-1].startswith(words)
    check_rest(sweep, results, undisturbed)


@pytest.mark.slow
@pytest.mark.parametrize("fault", ENDS, ids=lambda fault: fault.__name__)
def test_so_it_does_wherever_it_was_cut_short(sweep, tmp_path, undisturbed, fault):
    for number in count():
        results = tmp_path / f"{number}"
        code, _ = sweep("--out", results, before=disturbed(fault, results, number))
        if code == 0:
            break
        assert code == ENDS[fault][0]
        check_rest(partial(sweep, "--out", results), results, undisturbed)
    assert number > 30


def test_a_folder_that_cannot_be_written_into_is_named_and_loses_nothing(
    sweep, tmp_path, undisturbed
):
    results = tmp_path / "results"
    sweep(before=disturbed(kill, "results", 25))
    before = contents(results)
    folders = [results, *(folder for folder in results.rglob("*") if folder.is_dir())]
    for folder in folders:
        folder.chmod(0o555)
    try:
        if not refuses(results):
            pytest.skip("no folder is read-only to this user")
        code, said = sweep(before=powerless)
    finally:
        for folder in folders:
            folder.chmod(0o755)
    assert code == 2
    assert said.splitlines()[-1].startswith("lineup: error: Permission denied: results/")
    assert contents(results) == before
    check_rest(sweep, results, undisturbed)
