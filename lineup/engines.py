"""Ways to run many independent jobs: one after another, or several processes at a time.

An engine is a plain function ``engine(function, jobs, workers, report)`` that yields the number
and the outcome of each job as it ends, in any order. A job that raises, or takes its process
down with it, ends in an outcome with a reason; the others go on.
"""

import multiprocessing
import os
import signal
import time
import traceback
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from threading import Thread
from typing import Any, TypeAlias

Row: TypeAlias = dict[str, Any]
Function: TypeAlias = Callable[..., Row]
Report: TypeAlias = Callable[[int, str], None]


@dataclass(frozen=True)
class Outcome:
    """How a job ended: with a row, or with the reason why there is none."""

    row: Row
    reason: str = ""
    seconds: float = 0.0
    trace: str = ""


def serial(
    function: Function, jobs: Sequence[Row], workers: int, report: Report
) -> Iterator[tuple[int, Outcome]]:
    """Run the jobs one after another in this process."""
    for k, job in enumerate(jobs):
        yield k, outcome_of(function, job, partial(report, k))


def processes(
    function: Function, jobs: Sequence[Row], workers: int, report: Report
) -> Iterator[tuple[int, Outcome]]:
    """Run the jobs in up to `workers` processes; one that dies is replaced."""
    waiting = deque(enumerate(jobs))
    pool: list[_Worker] = []
    try:
        while waiting or any(worker.busy for worker in pool):
            pool = [worker for worker in pool if worker.busy or worker.process.is_alive()]
            while waiting and len(pool) < workers:
                pool.append(_Worker.start(function))
            for worker in pool:
                if waiting and not worker.busy:
                    worker.give(*waiting.popleft())
            busy: dict[object, _Worker] = {w.connection: w for w in pool if w.busy}
            for connection in wait([w.connection for w in busy.values()]):
                worker = busy[connection]
                message = worker.heard()
                if isinstance(message, str):
                    report(worker.job, message)
                else:
                    yield worker.job, message
    finally:
        for worker in pool:
            worker.process.kill()
        for worker in pool:
            worker.process.join()


ENGINES = {"serial": serial, "processes": processes}


def outcome_of(function: Function, job: Row, progress: Callable[[str], None]) -> Outcome:
    """Run one job here; whatever it raises is the reason of its outcome."""
    begin = time.perf_counter()
    try:
        row = function(**job, progress=progress)
    except ValueError as error:
        return Outcome({}, _line(str(error)), time.perf_counter() - begin)
    except Exception as error:
        # Whatever else goes wrong with one model must not cost the results of the others.
        reason = _line(f"{type(error).__name__}: {error}")
        return Outcome({}, reason, time.perf_counter() - begin, traceback.format_exc())
    return Outcome(row, "", time.perf_counter() - begin)


def _line(text: str) -> str:
    return " ".join(text.split())


@dataclass
class _Worker:
    """A process that runs one job at a time, and the number of the job it last had."""

    process: SpawnProcess
    connection: Connection
    job: int = -1
    busy: bool = False
    begin: float = 0.0

    @classmethod
    def start(cls, function: Function) -> "_Worker":
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=_serve, args=(theirs,), daemon=True)
        process.start()
        theirs.close()  # so that the death of the process ends what we read
        worker = cls(process, ours)
        worker._send(function)
        return worker

    def give(self, number: int, job: Row) -> None:
        self.job, self.busy, self.begin = number, True, time.perf_counter()
        self._send(job)

    def _send(self, message: Function | Row) -> None:
        with suppress(BrokenPipeError):  # it died just now, as `heard` will tell
            self.connection.send(message)

    def heard(self) -> str | Outcome:
        """The next stage the job reports, or its outcome; a dead process is an outcome too."""
        try:
            message: str | Outcome = self.connection.recv()
        except (EOFError, OSError):
            self.process.join()
            message = Outcome({}, self._death(), time.perf_counter() - self.begin)
        self.busy = isinstance(message, str)
        return message

    def _death(self) -> str:
        code = self.process.exitcode or 0
        how = signal.Signals(-code).name if code < 0 else f"exit code {code}"
        return f"the process died ({how})"


def _serve(connection: Connection) -> None:
    """Run the jobs that are sent, by the function sent first: to receive it takes its imports."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides what an interrupt ends
    Thread(target=_end_with_parent, daemon=True).start()
    with suppress(EOFError, BrokenPipeError):  # the parent ends just now
        function = connection.recv()
        while True:
            job = connection.recv()
            connection.send(outcome_of(function, job, connection.send))


def _end_with_parent() -> None:
    """Wait for the end of the parent, however it ends, and end this process amid its job."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
