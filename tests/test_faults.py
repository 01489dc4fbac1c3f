"""Whatever a run meets, the next one ends with the results of a run that met nothing."""

import os
import random
import signal
import time
from functools import partial
from itertools import count

import pytest
import trimesh
from disturbances import (
    PATIENCE,
    contents,
    disturbed,
    fill_disk,
    forked,
    interrupt,
    kill,
    kill_amid_writing,
    members,
    powerless,
    refuses,
    started,
    wait_until,
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


def check_rest(said, sweep, results, undisturbed):
    """What a run that said this has left is right, and the next takes it and makes the rest."""
    found = {k: v for k, v in contents(results).items() if not k.endswith(".tmp")}
    assert found == {name: undisturbed[name] for name in found}
    n_done = sum(name.endswith("row.json") for name in found)
    assert n_done >= said.count(": done") + said.count(": kept")
    code, said = sweep()
    assert code == 0
    assert said.count(": kept") == n_done
    assert contents(results) == undisturbed


@pytest.mark.parametrize("fault", ENDS, ids=lambda fault: fault.__name__)
@pytest.mark.parametrize("number", [11, 29])  # in the second task, and in the tables
def test_the_next_run_completes_what_was_cut_short(sweep, tmp_path, undisturbed, fault, number):
    results = tmp_path / "results"
    code, said = sweep(before=disturbed(fault, "results", number))
    end, words = ENDS[fault]
    assert code == end
    assert not words or said.splitlines(keepends=True)[-1].startswith(words)
    check_rest(said, sweep, results, undisturbed)


@pytest.mark.slow
@pytest.mark.parametrize("fault", ENDS, ids=lambda fault: fault.__name__)
def test_so_it_does_wherever_it_was_cut_short(sweep, tmp_path, undisturbed, fault):
    for number in count():
        results = tmp_path / f"{number}"
        code, said = sweep("--out", results, before=disturbed(fault, results, number))
        if code == 0:
            break
        assert code == ENDS[fault][0]
        check_rest(said, partial(sweep, "--out", results), results, undisturbed)
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
    check_rest(said, sweep, results, undisturbed)


def test_stored_files_that_are_spoilt_are_made_anew(sweep, tmp_path, undisturbed):
    assert sweep()[0] == 0
    for name in ("12/ball.folding.json", "16/row.json"):
        file = tmp_path / "results" / "ball" / name
        content = bytearray(file.read_bytes())
        content[len(content) // 2] ^= 1
        file.write_bytes(content)
    code, said = sweep()
    assert code == 0
    assert said.count("made anew: ") == said.count(": done") == N_TASKS
    assert contents(tmp_path / "results") == undisturbed


SWEEP = """
title: A path in a few sizes
task: path
fixed: {model: duck, seed: 0}
grids: [{method: [layered, growth], voxels: [100, 200, 300, 400]}]
table: {index: method, columns: voxels, values: coverage}
plot: {x: voxels, y: coverage, by: method}
"""

COMMANDS = {"sweep": ("sweep", "duck.yaml"), "table2": ("table2", "--quick")}


@pytest.fixture(scope="module", params=COMMANDS)
def command(request):
    return COMMANDS[request.param]


@pytest.fixture(scope="module")
def place(tmp_path_factory, command):
    """A folder for the results of a command, with an experiment."""
    place = tmp_path_factory.mktemp(command[0])
    (place / "duck.yaml").write_text(SWEEP)
    return place


@pytest.fixture(scope="module")
def alone(place, command):
    """What the results of a command say if nothing happens and one worker makes all."""
    with started(*command, "--out", "alone", "--workers", 1, place=place) as run:
        assert run.wait(PATIENCE) == 0
    return contents(place / "alone")


def rows(results):
    """How many tasks are done."""
    return len(list(results.glob("*/*/row.json")))


def wait_for_rows(run, results, number):
    """Wait until so many tasks are done, or all."""
    wait_until(lambda: run.poll() is not None or rows(results) >= number)


@pytest.mark.slow
def test_a_command_that_is_ended_again_and_again_completes(place, command, alone):
    results, luck = place / "ended", random.Random(5)
    n_hit = 0
    for end in [signal.SIGKILL, signal.SIGINT] * 3:
        n_rows = rows(results)
        with started(*command, "--out", results, "--workers", 2, place=place) as run:
            wait_for_rows(run, results, n_rows + luck.randrange(2))
            time.sleep(luck.uniform(0, 4))
            n_hit += run.poll() is None
            run.send_signal(end)
        wait_until(lambda group=run.pid: not members(group), seconds=10)
        assert rows(results) >= n_rows
        found = {k: v for k, v in contents(results).items() if not k.endswith(".tmp")}
        assert found == {name: alone[name] for name in found}
    assert n_hit >= 3
    with started(*command, "--out", results, "--workers", 2, place=place) as run:
        assert run.wait(PATIENCE) == 0
    assert contents(results) == alone


@pytest.mark.slow
def test_a_worker_that_crashes_costs_the_others_nothing(place, command, alone):
    results, log = place / "crashed", place / "crashed.log"
    with started(*command, "--out", results, "--workers", 2, place=place, log=log) as run:
        wait_for_rows(run, results, 1)
        worker = next(pid for pid, args in members(run.pid).items() if "spawn_main" in args)
        os.kill(worker, signal.SIGSEGV)
        assert run.wait(PATIENCE) == 1
    assert log.read_text().count(": failed: the process died (SIGSEGV)") == 1
    with started(*command, "--out", results, "--workers", 2, place=place, log=log) as run:
        assert run.wait(PATIENCE) == 0
    assert log.read_text().count(": kept") == rows(results) - 1
    assert contents(results) == alone


@pytest.mark.slow
@pytest.mark.parametrize("workers", [2, 3])
def test_the_number_of_workers_changes_nothing(place, command, alone, workers):
    results = place / f"of{workers}"
    with started(*command, "--out", results, "--workers", workers, place=place) as run:
        assert run.wait(PATIENCE) == 0
    assert contents(results) == alone


@pytest.mark.slow
@pytest.mark.parametrize("command", ["sweep"], indirect=True, scope="module")
def test_a_cluster_changes_nothing(place, command, alone):
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, local_directory=str(place)
    ) as cluster:
        there = ("--engine", "dask", "--scheduler", cluster.scheduler_address)
        with started(*command, "--out", "there", *there, place=place) as run:
            assert run.wait(PATIENCE) == 0
    assert contents(place / "there") == alone
