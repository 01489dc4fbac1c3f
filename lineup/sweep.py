"""Run an experiment: one row for each task, and what was finished is never run again.

What stands in a results folder is told in experiments/FORMAT.md.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, TypeAlias

import pandas as pd

from . import engines
from ._files import clear
from ._sources import digest, source_digest
from .cluster import dask
from .engines import Outcome, Report, Row
from .experiment import TASKS, Experiment, Scalar, Task, function_of, key_of, tasks
from .storage import plain, write_whole

ENGINES = (*engines.ENGINES, "dask")
"""The ways to run the tasks: in this process, in several, or on a Dask cluster."""

Progress: TypeAlias = Callable[[Task, str], None]


def run_sweep(
    experiment: Experiment,
    folder: str | os.PathLike[str],
    *,
    variant: str | None = None,
    engine: str = "serial",
    workers: int = 1,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> pd.DataFrame:
    """Run the tasks of an experiment that have no result yet; return one row for each task.

    Parameters
    ----------
    folder : path
        Each task has a folder of its own in it, with its result file and what it saved. A result
        is kept as long as the settings, the input files and the source code it came from are the
        same, and its files are as they were stored; a failure is tried again by the next run.
        Interrupting loses only what is running.
    variant : str
        Name of the variant of the experiment to run in place of its main grids.
    engine : str
        One of `ENGINES`; the result does not depend on it.
    workers : int
        Processes that the engine "processes" uses.
    scheduler : str
        Address of the Dask scheduler, for the engine "dask" alone. Its workers need this very
        version of the package, and where a setting names a mesh file, that file at that path.
    progress : callable
        Called with a task and what happens to it: a stage, "done", "kept" or "failed: why"; and
        before it begins "made anew: why", if what was stored is spoilt.

    Returns
    -------
    DataFrame
        Settings, then the row of the task, then ``failure``: why there is none, or "".

    Raises
    ------
    ValueError
        If the experiment does not fit its task, or `engine`, `workers` or `scheduler` is no
        possible value, or Dask is not installed.
    ConnectionError
        If the scheduler does not answer, has no workers or is lost.
    OSError
        If a result cannot be stored, as on a full disk; it names the file. What was stored before
        is kept.
    """
    _check_engine(engine, workers, scheduler)
    tell = progress or (lambda task, text: None)
    todo: list[Task] = []
    results: dict[int, dict[str, Any]] = {}
    for task in tasks(experiment, Path(folder), variant):
        task.folder.mkdir(parents=True, exist_ok=True)
        clear(task.folder)
        kept, fault = _stored(task)
        if fault:
            tell(task, f"made anew: {fault}")
        if kept is None:
            todo.append(task)
        else:
            results[task.number] = kept
            tell(task, "kept")

    def report(k: int, stage: str) -> None:
        tell(todo[k], stage)

    for k, outcome in _outcomes(TASKS[experiment.task], todo, engine, workers, scheduler, report):
        results[todo[k].number] = _store(todo[k], outcome)
        tell(todo[k], f"failed: {outcome.reason}" if outcome.reason else "done")
    return _table([results[number] for number in sorted(results)])


def seconds(done: Sequence[Task]) -> pd.DataFrame:
    """How long each task took, failed or not: its settings, then ``seconds``."""
    results = [json.loads(task.file.read_text(encoding="utf-8")) for task in done]
    return pd.DataFrame([{**r["settings"], "seconds": round(r["seconds"], 3)} for r in results])


def elsewhere(
    place: str,
    settings: dict[str, Scalar],
    key: str,
    *,
    folder: Path,
    progress: Callable[[str], None],
) -> Row:
    """Run a task on another machine, if it is the same task there as here.

    Raises
    ------
    ValueError
        If the source code, the mesh files or LINEUP_MODELS differ, so that it would be another.
    """
    function = function_of(place)
    if key_of(settings, _code(function.__module__)) != key:
        raise ValueError(
            "the worker would run something else: its source code, mesh files or LINEUP_MODELS "
            "are not those of this machine"
        )
    return function(**settings, folder=folder, progress=progress)


_code = lru_cache(source_digest)  # once for each module in the life of a worker


def _check_engine(engine: str, workers: int, scheduler: str | None) -> None:
    if engine not in ENGINES:
        raise ValueError(f"unknown engine {engine!r}; known: {', '.join(ENGINES)}")
    if workers < 1:
        raise ValueError(f"workers must be at least 1, got {workers}")
    if (engine == "dask") != (scheduler is not None):
        raise ValueError(
            f"a scheduler is for the engine 'dask', got it for {engine!r}"
            if scheduler is not None
            else "the engine 'dask' needs the address of a scheduler, like tcp://127.0.0.1:8786"
        )


def _outcomes(
    place: str,
    todo: list[Task],
    engine: str,
    workers: int,
    scheduler: str | None,
    report: Report,
) -> Iterator[tuple[int, Outcome]]:
    """The number and the outcome of each task, as they end."""
    if scheduler is None:
        jobs: list[Row] = [{**task.settings, "folder": task.folder} for task in todo]
        return engines.ENGINES[engine](function_of(place), jobs, workers, report)
    function = partial(elsewhere, place)
    jobs = [{"settings": t.settings, "key": t.key, "folder": t.folder} for t in todo]
    return dask(function, jobs, report, scheduler)


def _stored(task: Task) -> tuple[dict[str, Any] | None, str]:
    """The result of an earlier run, if it is still good; and what is wrong where it is spoilt."""
    if not task.file.exists():
        return None, ""
    try:
        result = json.loads(task.file.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        result = None
    if not isinstance(result, dict) or result.get("digest") != _digest(result):
        return None, f"{task.file} is spoilt, or of an earlier version"
    if result["key"] != task.key or result["reason"]:
        return None, ""
    for name, stored in result["files"].items():
        try:
            same = digest([(task.folder / name).read_bytes()]) == stored
        except OSError:
            same = False
        if not same:
            return None, f"{task.folder / name} is not what was stored"
    return result, ""


def _store(task: Task, outcome: Outcome) -> dict[str, Any]:
    clear(task.folder)
    result = {"format": "lineup-row", "version": 2, "key": task.key, "settings": task.settings}
    result |= plain(asdict(outcome)) | {"files": _files(task)}
    result["digest"] = _digest(result)
    write_whole(task.file, json.dumps(result, indent=1) + "\n")
    return result


def _files(task: Task) -> dict[str, str]:
    """What the task saved: a digest of each file by its name, slashed, in the task's folder."""
    found = sorted(f for f in task.folder.rglob("*") if f.is_file() and f != task.file)
    return {f.relative_to(task.folder).as_posix(): digest([f.read_bytes()]) for f in found}


def _digest(result: dict[str, Any]) -> str:
    """Of all else that a result file says."""
    said = {name: value for name, value in result.items() if name != "digest"}
    return digest([json.dumps(said, sort_keys=True).encode()])


def _table(results: list[dict[str, Any]]) -> pd.DataFrame:
    rows = [{**r["settings"], **r["row"], "failure": r["reason"]} for r in results]
    table = pd.DataFrame(rows)
    return table[[*(c for c in table if c != "failure"), "failure"]]
