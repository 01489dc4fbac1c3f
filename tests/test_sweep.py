"""Sweeps: what is run, what is kept, and that one bad task costs no other its result."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import fake_tasks
import pytest
from disturbances import members, wait_until

from lineup import experiment as experiments
from lineup import sweep
from lineup._sources import source_files
from lineup.engines import ENGINES
from lineup.experiment import Experiment, read_experiment, tasks
from lineup.sweep import run_sweep

ROOT = Path(__file__).parents[1]
PLACES = os.pathsep.join([str(ROOT), str(ROOT / "tests")])


@pytest.fixture
def calls(tmp_path, monkeypatch):
    """The calls made to the fake task so far."""
    log = tmp_path / "calls.txt"
    log.touch()
    monkeypatch.setenv(fake_tasks.CALLS, str(log))
    monkeypatch.setitem(sweep.TASKS, "fake", "fake_tasks:work")
    return lambda: log.read_text().split()


def experiment(*models, blocks=(3,), **more):
    grids = [{"model": list(models), "blocks": list(blocks)}]
    return Experiment(title="t", task="fake", grids=grids, **more)


def test_tasks_stand_in_file_order_the_last_list_fastest(calls, tmp_path):
    found = tasks(experiment("b", "a", blocks=(2, 1), fixed={"seed": 5}), tmp_path)
    assert [t.label for t in found] == ["b-2", "b-1", "a-2", "a-1"]
    assert found[0].settings == {"seed": 5, "model": "b", "blocks": 2}


@pytest.mark.parametrize("engine", ENGINES)
def test_failures_are_rows_and_the_others_go_on(calls, tmp_path, engine):
    models = ["a", "refused", "slow", "broken", "b"]
    if engine == "processes":
        models[2:2] = ["crash", "gone", "abort"]
    table = run_sweep(experiment(*models), tmp_path / "out", engine=engine, workers=2)
    assert list(table.model) == models
    failure = dict(zip(table.model, table.failure, strict=True))
    assert failure["refused"] == "blocks must be positive"
    assert failure["broken"] == "RuntimeError: no good"
    if engine == "processes":
        assert failure["crash"] == "the process died (SIGSEGV)"
        assert failure["gone"] == "the process died (exit code 3)"
        assert failure["abort"] == "the process died (SIGABRT)"
    fine = table[table.failure == ""]
    assert list(fine.model) == ["a", "slow", "b"]
    assert set(fine.length) == {6}
    assert sorted(calls()) == sorted(f"{m}-3" for m in models)


def test_the_table_does_not_depend_on_engine_or_workers(calls, tmp_path):
    grid = experiment("slow", "a", "refused", "b", blocks=(1, 2))
    runs = [("serial", 1), ("processes", 1), ("processes", 3)]
    tables = [run_sweep(grid, tmp_path / f"{e}{w}", engine=e, workers=w) for e, w in runs]
    assert all(table.equals(tables[0]) for table in tables[1:])


def test_a_second_run_redoes_failures_only(calls, tmp_path):
    grid = experiment("a", "refused", "b")
    told = []
    first = run_sweep(grid, tmp_path, progress=lambda task, text: told.append((task.label, text)))
    assert told[:2] == [("a-3", "folding"), ("a-3", "done")]
    assert told[3] == ("refused-3", "failed: blocks must be positive")
    assert run_sweep(grid, tmp_path).equals(first)
    assert calls() == ["a-3", "refused-3", "b-3", "refused-3"]
    assert (tmp_path / "a-3" / "a.txt").read_text() == "saved"


def rows_said(change):
    """A damage: the row file with its contents changed, otherwise as it was."""

    def damage(folder):
        file = folder / "row.json"
        said = json.loads(file.read_text())
        change(said)
        file.write_text(json.dumps(said))

    return damage


def first_version(said):
    said["version"] = 1
    del said["files"], said["digest"]


DAMAGES = {
    "empty": lambda folder: (folder / "row.json").write_text(""),
    "cut": lambda folder: (folder / "row.json").write_text("{"),
    "a list": lambda folder: (folder / "row.json").write_text("[]"),
    "of something else": lambda folder: (folder / "row.json").write_text('{"key": "other"}'),
    "no row": rows_said(lambda said: said.pop("row")),
    "no reason": rows_said(lambda said: said.pop("reason")),
    "another digit": rows_said(lambda said: said["row"].update(length=7)),
    "another setting": rows_said(lambda said: said["settings"].update(blocks=4)),
    "another time": rows_said(lambda said: said.update(seconds=9.0)),
    "of the first version": rows_said(first_version),
    "spoilt file": lambda folder: (folder / "a.txt").write_text("Saved"),
    "cut file": lambda folder: (folder / "a.txt").write_text(""),
    "lost file": lambda folder: (folder / "a.txt").unlink(),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_result_is_made_anew_and_this_is_told(calls, tmp_path, damage):
    first = run_sweep(experiment("a", "b"), tmp_path)
    DAMAGES[damage](tmp_path / "a-3")
    told = []
    again = run_sweep(
        experiment("a", "b"), tmp_path, progress=lambda task, text: told.append((task.label, text))
    )
    assert again.equals(first)
    assert calls() == ["a-3", "b-3", "a-3"]
    file = "a.txt is not what was stored" if "file" in damage else "row.json is spoilt, or of an"
    assert told[0][1].startswith("made anew: ")
    assert f"a-3{os.sep}{file}" in told[0][1]
    assert told[1:] == [("b-3", "kept"), ("a-3", "folding"), ("a-3", "done")]
    assert (tmp_path / "a-3" / "a.txt").read_text() == "saved"


def test_what_killed_writers_left_is_cleared(calls, tmp_path):
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    first = run_sweep(experiment("a"), tmp_path)
    halves = [f"a-3/{name}.tmp" for name in (f"a.txt.{ended.pid}", f"row.json.{os.getpid()}")]
    others = [f"a-3/{name}" for name in (f"a.txt.{os.getppid()}.tmp", "my.tmp", "my.1.txt")]
    for name in (*halves, *others):
        (tmp_path / name).touch()
    assert run_sweep(experiment("a"), tmp_path).equals(first)
    assert not [name for name in halves if (tmp_path / name).exists()]
    assert all((tmp_path / name).exists() for name in others)
    assert calls() == ["a-3"]


def test_other_settings_input_or_source_are_other_tasks(calls, tmp_path, monkeypatch):
    def key(model="cube", **more):
        return tasks(experiment(model, **more), tmp_path)[0].key

    keys = [key(), key(fixed={"seed": 1}), key(blocks=(4,))]
    mesh = tmp_path / "duck.ply"
    for text in ("v 0 0 0", "v 0 0 1"):
        mesh.write_text(text)
        keys.append(key(str(mesh)))
    keys.append(key("duck"))
    monkeypatch.setenv("LINEUP_MODELS", str(tmp_path))
    keys.append(key("duck"))
    mesh.write_text("v 0 0 2")
    keys.append(key("duck"))
    monkeypatch.setattr(experiments, "source_digest", lambda module: "edited")
    keys.append(key("duck"))
    assert len(set(keys)) == len(keys)
    assert key("duck") == keys[-1]


def test_source_files_follow_imports():
    names = [file.stem for file in source_files("lineup.storage")]
    assert names == ["_files", "_record", "grid", "kinematics", "notation", "solid", "storage"]


def test_an_interrupted_run_resumes(calls, tmp_path):
    grid = experiment("a", "interrupt", "b")
    with pytest.raises(KeyboardInterrupt):
        run_sweep(grid, tmp_path)
    table = run_sweep(experiment("a", "b"), tmp_path)
    assert list(table.failure) == ["", ""]
    assert calls() == ["a-3", "interrupt-3", "b-3"]


SWEEP = """
import sys

if __name__ == "__main__":
    from lineup import experiment, sweep

    experiment.TASKS["fake"] = "fake_tasks:work"
    grids = [{"model": ["slow"], "blocks": list(range(1, 13))}]
    whole = experiment.Experiment(title="t", task="fake", grids=grids)
    tell = lambda task, text: print(text, flush=True)
    sweep.run_sweep(whole, sys.argv[1], engine="processes", workers=2, progress=tell)
"""


def test_a_killed_run_loses_nothing_that_was_done(calls, tmp_path, monkeypatch):
    script = tmp_path / "script.py"
    script.write_text(SWEEP)
    environment = os.environ | {"PYTHONPATH": PLACES}
    run = subprocess.Popen(
        [sys.executable, script, tmp_path / "out"],
        env=environment,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    said = []
    while said.count("done") < 3:
        said.append(run.stdout.readline().strip())
    run.kill()  # as by kill -9
    run.communicate(timeout=20)
    wait_until(lambda: not members(run.pid))
    before = calls()
    monkeypatch.setattr(fake_tasks, "PAUSE", 0)
    whole = experiment("slow", blocks=range(1, 13))
    told = []
    table = run_sweep(whole, tmp_path / "out", progress=lambda *said: told.append(said))
    assert set(table.failure) == {""}
    assert table.length.tolist() == [2 * k for k in range(1, 13)]
    kept = [task.label for task, text in told if text == "kept"]
    assert 3 <= len(kept) < 12
    assert sorted([*kept, *calls()[len(before) :]]) == sorted(f"slow-{k}" for k in range(1, 13))


INTERRUPTED = """
import sys
from pathlib import Path

import fake_tasks
from lineup import engines

if __name__ == "__main__":
    jobs = [dict(model="slow", blocks=k, folder=Path(sys.argv[1])) for k in range(40)]
    for k, outcome in engines.processes(fake_tasks.work, jobs, 2, lambda k, stage: None):
        print(k, outcome.row, flush=True)
"""


def test_an_interrupt_ends_the_worker_processes_too(calls, tmp_path):
    script = tmp_path / "script.py"
    script.write_text(INTERRUPTED)
    run = subprocess.Popen(
        [sys.executable, script, tmp_path],
        env=os.environ | {"PYTHONPATH": PLACES},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert "'voxels'" in run.stdout.readline()
    run.send_signal(signal.SIGINT)
    _, errors = run.communicate(timeout=20)
    assert errors.count("KeyboardInterrupt") == 1
    made = len(calls())
    assert 1 <= made < 40
    time.sleep(0.5)
    assert len(calls()) == made


ENDLESS = """
import sys
from pathlib import Path

from lineup import engines

if __name__ == "__main__":
    import late_task

    jobs = [dict(model="endless", blocks=k, folder=Path(sys.argv[1])) for k in range(2)]
    for _ in engines.processes(late_task.work, jobs, 2, lambda k, stage: print(k, flush=True)):
        pass
"""

LATE = """
import multiprocessing
import time

import fake_tasks

if multiprocessing.current_process().name != "MainProcess":
    time.sleep({seconds})


def work(**job):
    return fake_tasks.work(**job)
"""


@pytest.mark.parametrize(
    ("end", "seconds"), [(signal.SIGKILL, 0), (signal.SIGTERM, 0), (signal.SIGINT, 0), (9, 3600)]
)
def test_no_process_outlives_a_run_that_is_ended(calls, tmp_path, end, seconds):
    """Its workers are amid their jobs, or still import what they run."""
    (tmp_path / "script.py").write_text(ENDLESS)
    (tmp_path / "late_task.py").write_text(LATE.format(seconds=seconds))
    run = subprocess.Popen(
        [sys.executable, tmp_path / "script.py", tmp_path],
        env=os.environ | {"PYTHONPATH": PLACES},
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
    )
    try:
        if seconds:
            wait_until(lambda: len(members(run.pid)) == 4, seconds=20)  # one tracks resources
            time.sleep(1)
        else:
            assert sorted(run.stdout.readline() for _ in range(2)) == ["0\n", "1\n"]
        run.send_signal(end)
        run.wait(timeout=20)
        wait_until(lambda: not members(run.pid), seconds=5)
    finally:
        for pid in members(run.pid):
            os.kill(pid, signal.SIGKILL)


BAD = {
    "missing": (None, "no experiment file"),
    "not yaml": ("a: [1", "not YAML in line"),
    "not a mapping": ("- 1", "valid dictionary"),
    "no grids": ("{title: t, task: fake}", "grids"),
    "empty list": ("{title: t, task: fake, grids: [{model: []}]}", "at least 1 item"),
    "unknown field": ("{title: t, task: fake, grids: [{model: [a]}], colour: red}", "colour"),
    "nested list": ("{title: t, task: fake, grids: [{model: [[a]]}]}", "grids.0.model"),
}


@pytest.mark.parametrize("fault", BAD)
def test_a_bad_experiment_file_is_refused_in_one_line(tmp_path, fault):
    text, message = BAD[fault]
    file = tmp_path / "bad.yaml"
    if text is not None:
        file.write_text(text)
    with pytest.raises((ValueError, FileNotFoundError), match="bad.yaml") as caught:
        read_experiment(file)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"task": "paint"}, "unknown task 'paint'; known: table2, path, .*, fake"),
        ({"grids": [{"model": "a", "blocks": 1, "size": 3}]}, "unknown setting 'size'"),
        ({"grids": [{"model": "a"}]}, "needs the setting 'blocks'"),
        ({"grids": [{"model": ["a", "a"], "blocks": 1}]}, "two tasks .* 'a-1'"),
    ],
)
def test_settings_that_do_not_fit_are_refused_before_anything_runs(
    calls, tmp_path, change, message
):
    whole = {"title": "t", "task": "fake", "grids": [{"model": "a", "blocks": 1}]}
    with pytest.raises(ValueError, match=message):
        run_sweep(Experiment(**whole | change), tmp_path)
    assert not calls()


def test_unknown_engine_workers_and_variant(calls, tmp_path):
    with pytest.raises(ValueError, match="unknown engine 'threads'; known: serial, processes, d"):
        run_sweep(experiment("a"), tmp_path, engine="threads")
    with pytest.raises(ValueError, match="workers must be at least 1, got 0"):
        run_sweep(experiment("a"), tmp_path, workers=0)
    with pytest.raises(ValueError, match="unknown variant 'quick'; this experiment has: none"):
        run_sweep(experiment("a"), tmp_path, variant="quick")


def test_a_variant_replaces_the_grids(calls, tmp_path):
    quick = {"quick": [{"model": "b", "blocks": 1}]}
    table = run_sweep(experiment("a", variants=quick), tmp_path, variant="quick")
    assert list(table.model) == ["b"]
