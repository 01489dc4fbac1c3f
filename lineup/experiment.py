"""Experiment files: which task to run, on which settings, and what to make of the rows.

What stands in an experiment file is told in experiments/FORMAT.md.
"""

from __future__ import annotations

import itertools
import json
import math
import os
import re
from dataclasses import dataclass
from importlib import import_module
from inspect import signature
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

import yaml
from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from . import catalog
from ._files import content, plain_name
from ._sources import digest, source_digest
from .engines import Function
from .storage import first_error

TASKS = {
    "table2": "lineup.pipeline:table2_task",
    "path": "lineup.tasks.paths:path",
    "orientation": "lineup.tasks.orientations:orientation",
    "trimming": "lineup.tasks.trimming:trimming",
    "motion": "lineup.tasks.motions:motion",
    "bonding": "lineup.tasks.bonding:bonding",
}
"""What an experiment can run: plain functions of keyword settings that return a row.

Besides its settings a task is given `folder`, a Path to save what it makes in, and `progress`, to
be called with the name of each stage it begins. `COLUMNS` of its module, if there, names what is
in the row.
"""
MOST_BYTES = 2**16
"""Of an experiment file."""
MOST_TASKS = 10_000
"""That one experiment may run."""


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
Names = Annotated[list[str], BeforeValidator(_listed)]


class _Checked(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, hide_input_in_errors=True)


class Layout(_Checked):
    """How the rows become a table to read, see experiments/FORMAT.md."""

    index: Annotated[Names, Field(min_length=1)]
    values: Annotated[Names, Field(min_length=1)]
    columns: str | None = None
    aggregate: Literal["median", "mean", "min", "max"] = "median"

    @property
    def names(self) -> list[str]:
        """The columns of the rows that it is made of."""
        return [*self.index, *([self.columns] if self.columns else []), *self.values]


class Plot(_Checked):
    """Which columns are drawn against each other, see experiments/FORMAT.md."""

    x: str
    y: str
    by: Names = []
    log: Annotated[list[Literal["x", "y"]], BeforeValidator(_listed)] = []
    title: str | None = None
    x_label: str | None = None
    y_label: str | None = None

    @property
    def names(self) -> list[str]:
        """The columns of the rows that it is made of."""
        return [self.x, self.y, *self.by]


class Experiment(_Checked):
    """An experiment file, see experiments/FORMAT.md."""

    title: str
    task: str
    about: str = ""
    fixed: dict[str, Setting] = {}
    grids: Grids
    variants: dict[str, Grids] = {}
    table: Layout | None = None
    plot: Plot | None = None


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


class _Loader(yaml.SafeLoader):
    """YAML without tags, and without aliases, which unfold into more than any memory holds."""

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        event = self.peek_event()  # type: ignore[no-untyped-call]
        if isinstance(event, yaml.AliasEvent) or getattr(event, "tag", None) is not None:
            raise yaml.MarkedYAMLError(
                problem="tags and aliases are not read", problem_mark=event.start_mark
            )
        return super().compose_node(parent, index)


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
        text = content(path, MOST_BYTES).decode()
        return Experiment.model_validate(yaml.load(text, _Loader))
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f" in line {mark.line + 1}" if mark is not None else ""
        why = getattr(error, "problem", None) or getattr(error, "reason", "")
        raise ValueError(f"{path}: not YAML{where}: {why}") from None
    except ValidationError as error:
        raise ValueError(f"{path}: {first_error(error)}") from None
    except RecursionError:
        raise ValueError(f"{path}: its lists are nested too deeply") from None
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def tasks(experiment: Experiment, folder: Path, variant: str | None = None) -> list[Task]:
    """Every combination of the settings, in the order of the file, the last list fastest.

    Raises
    ------
    ValueError
        If the task, the variant, a setting or a column is unknown, a combination stands twice, or
        there are more than `MOST_TASKS`.
    """
    if experiment.task not in TASKS:
        raise ValueError(f"unknown task {experiment.task!r}; known: {', '.join(TASKS)}")
    function = function_of(TASKS[experiment.task])
    if variant is not None and variant not in experiment.variants:
        known = ", ".join(experiment.variants) or "none"
        raise ValueError(f"unknown variant {variant!r}; this experiment has: {known}")
    grids = experiment.grids if variant is None else experiment.variants[variant]
    _check_columns(experiment, function)
    n_tasks = sum(math.prod(map(len, axes.values())) for axes in grids)
    if n_tasks > MOST_TASKS:
        raise ValueError(f"the grids make {n_tasks:,} tasks, and up to {MOST_TASKS:,} are run")
    code = source_digest(function.__module__)
    found: dict[str, Task] = {}
    for axes in grids:
        for values in itertools.product(*axes.values()):
            settings = experiment.fixed | dict(zip(axes, values, strict=True))
            _check_settings(function, experiment.task, settings)
            label = plain_name(_label(values))
            if label in found:
                raise ValueError(f"two tasks would both be called {label!r}")
            key = key_of(settings, code)
            found[label] = Task(len(found), label, settings, key, folder / label)
    return list(found.values())


def function_of(place: str) -> Function:
    """The function at a place "module:name", as in `TASKS`."""
    module, _, name = place.partition(":")
    found: Function = getattr(import_module(module), name)
    return found


def key_of(settings: dict[str, Scalar], code: str) -> str:
    """Hash of settings, of the input files they name, and of the `source_digest` of a task."""
    written = json.dumps(settings, sort_keys=True)
    return digest([written.encode(), code.encode(), *_inputs(settings)])


def _settings_of(function: Function) -> list[str]:
    return [name for name in signature(function).parameters if name not in ("folder", "progress")]


def _check_columns(experiment: Experiment, function: Function) -> None:
    """Refuse a column that is not in the rows, as far as the module of the task says what is."""
    in_row = getattr(import_module(function.__module__), "COLUMNS", None)
    if in_row is None:
        return
    known = list(dict.fromkeys([*_settings_of(function), *in_row]))
    for part, used in (("table", experiment.table), ("plot", experiment.plot)):
        for name in used.names if used else []:
            if name not in known:
                raise ValueError(
                    f"{part}: unknown column {name!r}; task {experiment.task!r} has: "
                    f"{', '.join(known)}"
                )


def _check_settings(function: Function, task: str, settings: dict[str, Scalar]) -> None:
    asked, known = signature(function).parameters, _settings_of(function)
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
        if isinstance(value, str) and os.path.isfile(value):
            found.append(content(Path(value)))
        elif value in sources:
            found.append(sources[value].encode())
            if meshes and sources[value] == "folder":
                found.append((Path(meshes) / f"{value}.ply").read_bytes())
    return found
