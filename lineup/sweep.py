"""Run an experiment file: one task for each combination of its settings, one row for each task.

What stands in an experiment file and in a results folder is told in experiments/FORMAT.md.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import os
import re
from collections.abc import Callable
from dataclasses import asdict, dataclass
from importlib import import_module
from inspect import signature
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import pandas as pd
import yaml
from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from . import catalog
from ._sources import source_files
from .engines import ENGINES, Function, Outcome
from .storage import first_error, plain, write_whole

TASKS = {"table2": "lineup.pipeline:table2_task"}
"""What a sweep can run: plain functions of keyword settings that return a row.

Besides its settings a task is given `folder`, a Path to save what it makes in, and `progress`, to
be called with the name of each stage it begins.
"""


def _scalar(value: object) -> object:
    if value is not None and not isinstance(value, (bool, int, float, str)):
        raise ValueError("must be a number, a text, true, false or null")
    return value


def _listed(value: object) -> object:
    return value if isinstance(value, list) else [value]


Scalar: TypeAlias = bool | int | float | str | None
Setting = Annotated[Any, AfterValidator(_scalar)]
Axis = Annotated[list[Setting], BeforeValidator(_listed), Field(min_length=1)]
Grids = Annotated[list[dict[str, Axis]], Field(min_length=1)]
Progress: TypeAlias = Callable[["Task", str], None]


class Experiment(BaseModel):
    """An experiment file, see experiments/FORMAT.md."""

    model_config = ConfigDict(extra="forbid", strict=True, hide_input_in_errors=True)

    title: str
    task: str
    fixed: dict[str, Setting] = {}
    grids: Grids
    variants: dict[str, Grids] = {}


@dataclass(frozen=True)
class Task:
    """One combination of settings, and where its result goes."""

    number: int
    label: str
    settings: dict[str, Scalar]
    key: str
    folder: Path

    @property
    def file(self) -> Path:
        """The result file of this task."""
        return self.folder / "row.json"


def read_experiment(file: str | os.PathLike[str]) -> Experiment:
    """Read and check an experiment file.

    Raises
    ------
    FileNotFoundError, ValueError
        If there is no such file, or it is not an experiment; one line that says where.
    """
    path = Path(file)
    if not path.is_file():
        raise FileNotFoundError(f"no experiment file {path}")
    try:
        return Experiment.model_validate(yaml.safe_load(path.read_text(encoding="utf-8")))
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f" in line {mark.line + 1}" if mark is not None else ""
        raise ValueError(f"{path}: not YAML{where}: {getattr(error, 'problem', '')}") from None
    except ValidationError as error:
        raise ValueError(f"{path}: {first_error(error)}") from None


def tasks(experiment: Experiment, folder: Path, variant: str | None = None) -> list[Task]:
    """Every combination of the settings, in the order of the file, the last list fastest.

    Raises
    ------
    ValueError
        If the task, the variant or a setting is unknown, or a combination stands twice.
    """
    function = _function(experiment.task)
    if variant is not None and variant not in experiment.variants:
        known = ", ".join(experiment.variants) or "none"
        raise ValueError(f"unknown variant {variant!r}; this experiment has: {known}")
    grids = experiment.grids if variant is None else experiment.variants[variant]
    code = _digest(file.read_bytes() for file in source_files(function.__module__))
    found: dict[str, Task] = {}
    for axes in grids:
        for values in itertools.product(*axes.values()):
            settings = experiment.fixed | dict(zip(axes, values, strict=True))
            _check_settings(function, experiment.task, settings)
            label = _label(values)
            if label in found:
                raise ValueError(f"two tasks would both be called {label!r}")
            key = _digest(
                [json.dumps(settings, sort_keys=True).encode(), code.encode(), *_inputs(settings)]
            )
            found[label] = Task(len(found), label, settings, key, folder / label)
    return list(found.values())


def run_sweep(
    experiment: Experiment,
    folder: str | os.PathLike[str],
    *,
    variant: str | None = None,
    engine: str = "serial",
    workers: int = 1,
    progress: Progress | None = None,
) -> pd.DataFrame:
    """Run the tasks of an experiment that have no result yet; return one row for each task.

    Parameters
    ----------
    folder : path
        Each task has a folder of its own in it, with its result file and what it saved. A result
        is kept as long as the settings, the input files and the source code it came from are the
        same; a failure is tried again by the next run. Interrupting loses only what is running.
    variant : str
        Name of the variant of the experiment to run in place of its main grids.
    engine : str
        One of `ENGINES`; the result does not depend on it.
    workers : int
        Processes to use, where the engine uses any.
    progress : callable
        Called with a task and what happens to it: a stage, "done", "kept" or "failed: why".

    Returns
    -------
    DataFrame
        Settings, then the row of the task, then ``failure``: why there is none, or "".

    Raises
    ------
    ValueError
        If the experiment does not fit its task, or `engine` or `workers` is no possible value.
    """
    if engine not in ENGINES:
        raise ValueError(f"unknown engine {engine!r}; known: {', '.join(ENGINES)}")
    if workers < 1:
        raise ValueError(f"workers must be at least 1, got {workers}")
    tell = progress or (lambda task, text: None)
    todo: list[Task] = []
    results: dict[int, dict[str, Any]] = {}
    for task in tasks(experiment, Path(folder), variant):
        task.folder.mkdir(parents=True, exist_ok=True)
        kept = _stored(task)
        if kept is None:
            todo.append(task)
        else:
            results[task.number] = kept
            tell(task, "kept")

    def report(k: int, stage: str) -> None:
        tell(todo[k], stage)

    jobs = [{**task.settings, "folder": task.folder} for task in todo]
    for k, outcome in ENGINES[engine](_function(experiment.task), jobs, workers, report):
        results[todo[k].number] = _store(todo[k], outcome)
        tell(todo[k], f"failed: {outcome.reason}" if outcome.reason else "done")
    return _table([results[number] for number in sorted(results)])


def _function(name: str) -> Function:
    if name not in TASKS:
        raise ValueError(f"unknown task {name!r}; known: {', '.join(TASKS)}")
    module, _, function = TASKS[name].partition(":")
    found: Function = getattr(import_module(module), function)
    return found


def _check_settings(function: Function, task: str, settings: dict[str, Scalar]) -> None:
    asked = signature(function).parameters
    known = [name for name in asked if name not in ("folder", "progress")]
    for name in settings:
        if name not in known:
            raise ValueError(f"unknown setting {name!r}; task {task!r} has: {', '.join(known)}")
    for name in known:
        if name not in settings and asked[name].default is asked[name].empty:
            raise ValueError(f"task {task!r} needs the setting {name!r}")


def _label(values: tuple[Scalar, ...]) -> str:
    words = [Path(v).stem if isinstance(v, str) else str(v) for v in values]
    return re.sub(r"[^A-Za-z0-9._-]+", "_", "-".join(words)) or "only"


def _inputs(settings: dict[str, Scalar]) -> list[bytes]:
    """What settings name: the contents of files, and where a model of the catalogue comes from."""
    models = catalog.models()
    sources = dict(zip(models["name"], models["source"], strict=True))
    meshes = os.environ.get(catalog.FOLDER_VARIABLE)
    found: list[bytes] = []
    for value in settings.values():
        if isinstance(value, str) and Path(value).is_file():
            found.append(Path(value).read_bytes())
        elif value in sources:
            found.append(sources[value].encode())
            if meshes and sources[value] == "folder":
                found.append((Path(meshes) / f"{value}.ply").read_bytes())
    return found


def _digest(parts: Any) -> str:
    whole = hashlib.sha256()
    for part in parts:
        whole.update(hashlib.sha256(part).digest())
    return whole.hexdigest()[:16]


def _stored(task: Task) -> dict[str, Any] | None:
    """The result of an earlier run, if it is still good."""
    try:
        result: dict[str, Any] = json.loads(task.file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    good = isinstance(result, dict) and result.get("key") == task.key and not result["reason"]
    return result if good else None


def _store(task: Task, outcome: Outcome) -> dict[str, Any]:
    result = {"format": "lineup-row", "version": 1, "key": task.key, "settings": task.settings}
    result |= plain(asdict(outcome))
    write_whole(task.file, json.dumps(result, indent=1) + "\n")
    return result


def _table(results: list[dict[str, Any]]) -> pd.DataFrame:
    rows = [{**r["settings"], **r["row"], "failure": r["reason"]} for r in results]
    table = pd.DataFrame(rows)
    return table[[*(c for c in table if c != "failure"), "failure"]]
