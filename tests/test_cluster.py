"""Jobs on a Dask cluster: the same outcomes, whatever happens to its workers."""

import os
import signal
import sys
from concurrent.futures import CancelledError
from contextlib import nullcontext
from pathlib import Path

import fake_tasks
import pytest

from lineup import cluster, sweep
from lineup.experiment import Experiment
from lineup.sweep import run_sweep

dask = pytest.importorskip("dask")
distributed = pytest.importorskip("distributed")

TESTS = Path(__file__).parent
DIED = "its worker died, and died again with it alone"


class KilledWorker(Exception):
    """Stands for that of Dask, which is known by its name."""


class Future:
    """Ends at once, as the job says."""

    def __init__(self, run, cancelled):
        self.run, self.cancelled = run, lambda: cancelled

    def add_done_callback(self, call):
        call(self)

    def result(self):
        return self.run()


class Client:
    """A cluster in this process. Any job with "crash" kills its worker, with all that is on it."""

    def __init__(self, cancelled=False):
        self.hear, self.submitted, self.cancelled = None, [], cancelled

    def subscribe_topic(self, topic, hear):
        self.hear = hear

    def log_event(self, topic, said):
        self.hear((0.0, said))

    def submit(self, away, function, job, topic, k, pure):
        self.submitted.append(k)

        def run():
            if self.cancelled:
                raise CancelledError
            if job["model"] == "crash" or (k == 0 and self.submitted.count(0) == 1):
                raise KilledWorker
            return away(function, job, topic, k)

        return Future(run, self.cancelled)


@pytest.fixture
def client(monkeypatch, tmp_path):
    """The fake cluster, in the place of the real one."""
    monkeypatch.setenv(fake_tasks.CALLS, str(tmp_path / "calls"))
    fake = Client()
    monkeypatch.setattr(cluster, "_client", lambda scheduler: nullcontext(fake))
    monkeypatch.setattr(distributed, "get_worker", lambda: fake)
    return fake


def jobs_of(folder, *models):
    return [
        {"model": model, "blocks": k, "folder": folder / f"{model}-{k}"}
        for k, model in enumerate(models, start=1)
    ]


def test_a_job_is_blamed_for_a_dead_worker_only_if_it_dies_alone(client, tmp_path):
    told = []
    jobs = jobs_of(tmp_path, "a", "crash", "refused", "broken", "b")
    run = cluster.dask(fake_tasks.work, jobs, lambda *said: told.append(said), "anywhere")
    outcomes = dict(run)
    reasons = [outcomes[k].reason for k in range(5)]
    assert reasons == ["", DIED, "blocks must be positive", "RuntimeError: no good", ""]
    assert client.submitted == [0, 1, 2, 3, 4, 0, 1]
    assert (outcomes[0].row, outcomes[4].row["voxels"]) == ({"voxels": 2, "length": 2}, 10)
    assert (tmp_path / "a-1" / "a.txt").read_text() == "saved"
    assert "no good" in outcomes[3].trace


def test_a_lost_scheduler_is_no_outcome(client, tmp_path):
    client.cancelled = True
    with pytest.raises(ConnectionError, match="what was finished is kept"):
        next(cluster.dask(fake_tasks.work, jobs_of(tmp_path, "a"), print, "anywhere"))


@pytest.fixture
def two_workers(tmp_path, monkeypatch):
    """The address of a cluster of two worker processes on this machine, and their numbers."""
    (tmp_path / "calls").touch()
    monkeypatch.setenv(fake_tasks.CALLS, str(tmp_path / "calls"))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(TESTS.parent), str(TESTS)]))
    monkeypatch.setitem(sweep.TASKS, "fake", "fake_tasks:work")
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        distributed.LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            dashboard_address=None,
            local_directory=str(tmp_path / "dask"),
        ) as local,
        distributed.Client(local.scheduler_address, set_as_default=False) as client,
    ):
        yield local.scheduler_address, sorted(client.run(os.getpid).values())


@pytest.mark.slow
def test_a_killed_worker_loses_nothing_and_a_crashing_job_is_an_outcome(two_workers, tmp_path):
    address, workers = two_workers
    told = []

    def kill_once(k, stage):
        told.append((k, stage))
        if len(told) == 1:
            os.kill(workers[0], signal.SIGKILL)

    jobs = jobs_of(tmp_path, "slow", "refused", "a", "crash", "slow", "b")
    outcomes = dict(cluster.dask(fake_tasks.work, jobs, kill_once, address))
    assert sorted(outcomes) == list(range(6))
    reasons = [outcomes[k].reason for k in range(6)]
    assert reasons == ["", "blocks must be positive", "", DIED, "", ""]
    assert [outcomes[k].row["voxels"] for k in (0, 2, 4, 5)] == [2, 6, 10, 12]
    assert (tmp_path / "slow-1" / "slow.txt").read_text() == "saved"
    assert {stage for _, stage in told} == {"folding"}


def experiment(*models):
    return Experiment(title="t", task="fake", grids=[{"model": list(models), "blocks": [1, 2]}])


@pytest.mark.slow
def test_a_sweep_on_a_cluster_has_the_same_table_and_resumes(two_workers, tmp_path):
    address, workers = two_workers
    killed = []

    def kill_once(task, text):
        if text == "folding" and not killed:
            killed.append(task)
            os.kill(workers[0], signal.SIGKILL)

    there = {"engine": "dask", "scheduler": address}
    rows = run_sweep(
        experiment("slow", "refused", "crash", "a"), tmp_path / "out", progress=kill_once, **there
    )
    assert killed
    assert rows.failure[rows.model == "crash"].tolist() == [DIED] * 2
    others = experiment("slow", "refused", "a")
    alone = run_sweep(others, tmp_path / "serial")
    assert rows[rows.model != "crash"].reset_index(drop=True).equals(alone)
    told = []
    again = run_sweep(
        others, tmp_path / "out", progress=lambda task, text: told.append((task, text)), **there
    )
    assert again.equals(alone)
    kept = [task.label for task, text in told if text == "kept"]
    assert kept == ["slow-1", "slow-2", "a-1", "a-2"]


def test_a_worker_that_would_run_something_else_refuses(tmp_path, monkeypatch):
    monkeypatch.setenv(fake_tasks.CALLS, str(tmp_path / "calls"))
    monkeypatch.setitem(sweep.TASKS, "fake", "fake_tasks:work")
    task = sweep.tasks(experiment("a"), tmp_path)[0]

    def run(key):
        return sweep.elsewhere(
            "fake_tasks:work", task.settings, key, folder=tmp_path, progress=lambda stage: None
        )

    assert run(task.key)["voxels"] == 2
    with pytest.raises(ValueError, match="source code, mesh files or LINEUP_MODELS"):
        run("0123456789abcdef")


def test_without_dask_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ValueError, match=r"pip install 'lineup-workbench\[cluster\]'"):
        next(cluster.dask(fake_tasks.work, [{}], print, "tcp://127.0.0.1:1"))


def test_no_scheduler_is_one_line(monkeypatch):
    monkeypatch.setattr(cluster, "PATIENCE", 0.3)
    with pytest.raises(ConnectionError, match="no Dask scheduler answers at tcp://127.0.0.1:1: "):
        next(cluster.dask(fake_tasks.work, [{}], print, "tcp://127.0.0.1:1"))


@pytest.mark.parametrize(
    ("engine", "scheduler", "message"),
    [
        ("dask", None, "needs the address of a scheduler"),
        ("processes", "tcp://127.0.0.1:1", "a scheduler is for the engine 'dask'"),
    ],
)
def test_a_scheduler_goes_with_dask(monkeypatch, tmp_path, engine, scheduler, message):
    monkeypatch.setitem(sweep.TASKS, "fake", "fake_tasks:work")
    with pytest.raises(ValueError, match=message):
        run_sweep(experiment("a"), tmp_path, engine=engine, scheduler=scheduler)
