"""What the commands share: options, the things they are given, and how they speak and end."""

from __future__ import annotations

import math
import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    import pandas as pd

    from ..solid import Certificate, Folding, Motion, VoxelSolid

Sources = Annotated[
    list[str], typer.Argument(metavar="MODEL_OR_FILE...", help="Names of models or mesh files.")
]
Source = Annotated[
    str, typer.Argument(metavar="MODEL_OR_FILE", help="A model, a mesh or a stored solid.")
]
Out = Annotated[Path, typer.Option(help="Folder to write into; made if it does not exist.")]
Seed = Annotated[int, typer.Option(help="Equal seeds give equal results.")]
Blocks = Annotated[int, typer.Option(help="Blocks of the chain; each is two voxels.")]
Box = Annotated[
    tuple[int, int, int] | None,
    typer.Option(help="Box that a motion from shape to shape stays in, X Y Z in pitches."),
]
Joints = Annotated[str, typer.Option(help="free, or slotted: no printed capsule has to twist.")]
Voxels = Annotated[int, typer.Option(help="Voxels to aim at; a stored solid keeps its own.")]
Workers = Annotated[
    int | None, typer.Option(help="Processes at a time; as many as there are cores if not given.")
]


def motion_in(file: Path) -> Folding | Motion:
    from ..solid import Folding, Motion
    from ..storage import load

    stored = load(file)
    if not isinstance(stored, (Folding, Motion)):
        raise ValueError(f"{file} holds a {type(stored).__name__}, and a folding is needed")
    return stored


def known(source: str) -> str:
    """A source as given, once it is clear that it names a file or a model."""
    from ..catalog import models

    if not Path(source).is_file():
        if Path(source).suffix or len(Path(source).parts) > 1:
            raise FileNotFoundError(f"no file {source}")
        if source not in set(models()["name"]):
            raise ValueError(f"no file and no model {source!r}; 'lineup models' lists the models")
    return source


def readable(source: str) -> str:
    """A source as given, once it is clear that it is a model or a file with a good mesh."""
    from ..meshes import read_surface

    if Path(known(source)).is_file():
        read_surface(Path(source))
    return source


def solid_of(
    source: str, voxels: int, up: str | None = None, shell: int | None = None
) -> VoxelSolid:
    """The solid stored in a file, or that of a mesh file or a model; files can have its name."""
    from .. import catalog, voxelization
    from .._files import plain_name
    from ..shells import shell as hollowed
    from ..solid import VoxelSolid
    from ..storage import load
    from ..verification import stored_name

    if not Path(known(source)).is_file():
        return catalog.model(source, voxels, up, shell)
    if not source.endswith(".json"):
        return voxelization.voxelize(source, voxels, up or "+z", shell=shell)
    stored = load(source)
    if not isinstance(stored, VoxelSolid):
        raise ValueError(f"{source} holds a {type(stored).__name__}, and a solid is needed")
    if up is not None:
        raise ValueError(f"{source} is made of voxels already, and cannot be turned by --up {up}")
    if shell is not None:
        stored = hollowed(stored, shell)
    return replace(stored, name=plain_name(stored.name or stored_name(Path(source))))


def told(verdict: Certificate) -> str:
    """A verdict in words; that on a motion with the diameter and the bend it was judged at."""
    notes = [f"at {verdict.where}"] if verdict.where >= 0 else []
    if not math.isnan(verdict.diameter):
        notes += [f"diameter {verdict.diameter:g}", f"bends up to {verdict.max_bend_deg:g}°"]
        if verdict.ok:
            notes += [f"clearance {verdict.clearance:.4f}", f"{verdict.moves_checked} moves"]
    return verdict.reason + (f" ({', '.join(notes)})" if notes else "")


def shortfalls(table: pd.DataFrame) -> list[str]:
    rows = table[table["failure"] != ""].to_dict("records")
    return [f"{row.get('model', 'a task')}: {row['failure']}" for row in rows]


def end(lines: list[str]) -> None:
    """Say what fell short and end with exit code 1, if anything did."""
    for line in lines:
        typer.echo(f"falls short: {line}", err=True)
    if lines:
        raise typer.Exit(1)


def console() -> Any:
    from rich.console import Console

    console = Console()
    # A log has no width of its own, and the table must not be folded to 80 columns there.
    return console if console.is_terminal else Console(width=120)


def n_cores() -> int:
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1
