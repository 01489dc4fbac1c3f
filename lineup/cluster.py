"""An engine that runs jobs on a Dask cluster: `engines` tells what an engine is."""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from queue import SimpleQueue
from tempfile import TemporaryDirectory
from typing import Any, TypeAlias
from uuid import uuid4

from ._files import whole
from .engines import Function, Outcome, Report, Row, outcome_of

PATIENCE = 30.0
"""Seconds to wait for a scheduler to answer, and for its first worker."""

ENDED = ""
"""What is heard of a job when it has ended; else a stage."""

Files: TypeAlias = dict[str, bytes]
Ended: TypeAlias = tuple[int, Outcome | None]
Heard: TypeAlias = SimpleQueue[tuple[int, str]]


def dask(
    function: Function, jobs: Sequence[Row], report: Report, scheduler: str
) -> Iterator[tuple[int, Outcome]]:
    """Run the jobs on the workers of the scheduler at an address.

    No disk is shared: a job saves in a folder of its worker, and what it saved is brought to the
    folder that its `folder` names here. Jobs that were on a worker as it died are run once more,
    one at a time, so that only the job that takes its worker down is blamed for it.

    Raises
    ------
    ValueError
        If Dask is not installed.
    ConnectionError
        If no scheduler answers, it has no workers, or it is lost on the way.
    """
    with _client(scheduler) as client:
        topic, heard = f"lineup-{uuid4()}", Heard()
        client.subscribe_topic(topic, lambda event: heard.put(tuple(event[1])))

        def together(numbers: Sequence[int]) -> Iterator[Ended]:
            futures = {
                k: client.submit(away, function, jobs[k], topic, k, pure=False) for k in numbers
            }
            for k in _ending(futures, heard, report):
                yield k, _outcome(futures.pop(k), jobs[k])

        suspects = []
        for k, outcome in together(range(len(jobs))):
            if outcome is None:
                suspects.append(k)
            else:
                yield k, outcome
        for k in sorted(suspects):
            for _, outcome in together([k]):
                yield k, outcome or Outcome({}, "its worker died, and died again with it alone")


def _ending(futures: Mapping[int, Any], heard: Heard, report: Report) -> Iterator[int]:
    """The number of each job as it ends; what the others say meanwhile is reported."""
    running = set(futures)
    for k, future in futures.items():
        future.add_done_callback(lambda future, k=k: heard.put((k, ENDED)))
    while running:
        k, said = heard.get()
        if k in running and said == ENDED:
            running.remove(k)
            yield k
        elif k in running:
            report(k, said)


def _outcome(future: Any, job: Row) -> Outcome | None:
    """How a job ended, its files in place; None if its worker died."""
    try:  # even where it is finished: its worker may die before the result is fetched
        outcome, files = future.result()
    except Exception as error:
        if type(error).__name__ == "KilledWorker":
            return None
        if future.cancelled():
            raise ConnectionError("the Dask scheduler is lost; what was finished is kept") from None
        return Outcome({}, " ".join(f"{type(error).__name__}: {error}".split()))
    for name, content in files.items():
        _write_bytes(Path(job["folder"]) / name, content)
    return Outcome(**outcome)


def away(function: Function, job: Row, topic: str, k: int) -> tuple[dict[str, Any], Files]:
    """Run a job on a worker; its outcome, and the files it saved."""
    worker = importlib.import_module("distributed").get_worker()
    with TemporaryDirectory() as name:
        folder = Path(name)
        outcome = outcome_of(
            function,
            {**job, "folder": folder},
            lambda stage: worker.log_event(topic, (k, stage)),
        )
        found = sorted(file for file in folder.rglob("*") if file.is_file())
        files = {file.relative_to(folder).as_posix(): file.read_bytes() for file in found}
    return vars(outcome), files


def _write_bytes(file: Path, content: bytes) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    with whole(file) as half:
        half.write_bytes(content)


@contextmanager
def _client(scheduler: str) -> Iterator[Any]:
    """A client of a scheduler that has workers."""
    try:
        distributed = importlib.import_module("distributed")
    except ModuleNotFoundError:
        raise ValueError(
            "the engine 'dask' takes the package distributed "
            "(pip install 'lineup-workbench[cluster]')"
        ) from None
    try:
        client = distributed.Client(scheduler, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        why = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ConnectionError(f"no Dask scheduler answers at {scheduler}: {why}") from None
    with client:
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError:
            raise ConnectionError(
                f"the Dask scheduler at {scheduler} has no workers; "
                f"start some with 'dask worker {scheduler}'"
            ) from None
        yield client
