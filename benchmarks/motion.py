"""Unfolding by each method on the same solids in one run: see README.md beside this file."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pandas as pd
import typer
from matplotlib.figure import Figure
from paths import solid_of, write

import lineup as lu
from lineup.motion.algorithm4 import energy_run
from lineup.motion.plan import DIAMETER
from lineup.motion.thick import barrier_run
from lineup.tables import PAPER

app = typer.Typer(add_completion=False, help=__doc__)

SMALL = ["bunny", "decocube", "cannon", "two_holed_torus", "duck"]
LARGE = ["armadillo", "dinosaur", "aircraft", "elephant", "elk"]
SIZES = {**dict.fromkeys(SMALL, 1600), **dict.fromkeys(LARGE, 6500)}
"""The paper's ten models and about the voxels that they have there."""

STEPS = {1600: 10_000, 6500: 1_000}
"""Most steps of energy, and of barrier along each axis, by the size aimed at; else the least."""

WARM_UP = 20
"""Voxels of the ball that compiles the kernels before the clock runs."""

Found = tuple[lu.Motion, int]


@app.command()
def methods(
    solid: Annotated[list[str] | None, typer.Option(help="A model; without it, the ten.")] = None,
    voxels: Annotated[int | None, typer.Option(help="Of each solid; without it, SIZES.")] = None,
    steps: Annotated[
        int | None, typer.Option(help="Most steps of energy, of barrier per axis.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder of the tables.")] = Path("results"),
) -> None:
    """Every method on every solid: OUT/motion.csv, .md and .png."""
    rows: list[dict[str, Any]] = []
    measured("ball", WARM_UP, 2)  # compiles
    for name in solid or SIZES:
        size = voxels or SIZES.get(name, 1600)
        most = STEPS.get(size, min(STEPS.values())) if steps is None else steps
        for row in measured(name, size, most):
            rows.append(row)
            typer.echo("{solid} {path}, {method}: {end}, {seconds:.2f} s".format(**row))
        write(pd.DataFrame(rows), out, "motion")
    draw(pd.DataFrame(rows), out / "motion.png")


def measured(name: str, voxels: int, steps: int) -> list[dict[str, Any]]:
    """A row for each method: all but growth unfold one layered path."""
    shape = solid_of(name, voxels)
    path = lu.layered_path(shape)
    ways: dict[str, Callable[[], Found]] = {
        "energy": lambda: energy_run(path, 1, steps),
        "barrier": lambda: barrier_run(path, DIAMETER, (1, 0), steps),
        "peel": lambda: moves_of(lu.unfold(path, "peel")),
        "growth": lambda: moves_of(lu.fold(shape, "growth").motion),
    }
    return [row_of(shape, method, find) for method, find in ways.items()]


def moves_of(motion: lu.Motion) -> Found:
    return motion, len(motion)


def row_of(shape: lu.VoxelSolid, method: str, find: Callable[[], Found]) -> dict[str, Any]:
    start = time.process_time()
    motion, steps = find()
    seconds = time.process_time() - start
    least = motion.diameter if method == "energy" else DIAMETER
    verdict = lu.certify(motion, diameter=least, max_bend_deg=motion.max_bend_deg)
    paper = PAPER.get(shape.name)
    return {
        "solid": shape.name,
        "voxels": shape.size,
        "path": len(motion.start),
        "method": method,
        "steps": steps,
        "seconds_per_step": seconds / max(steps, 1),
        "seconds": seconds,
        "clearance": verdict.clearance,
        "bend_deg": verdict.bend_deg,
        "moves": len(motion),
        "end": motion.reason,
        "certified": verdict.ok,
        "paper_seconds_per_step": paper.seconds_per_step if paper else np.nan,
        "paper_steps": paper.steps if paper else pd.NA,
        "paper_hours": paper.hours if paper else np.nan,
    }


def draw(table: pd.DataFrame, file: Path) -> None:
    """Seconds of each method and of the paper; hollow where the judge did not certify the line."""
    figure = Figure(figsize=(9, 5.5), layout="constrained")
    axes = figure.add_subplot(yscale="log", ylabel="seconds")
    names = list(dict.fromkeys(table["solid"]))
    for method, runs in table.groupby("method", sort=False):
        x = [names.index(name) for name in runs["solid"]]
        marks = axes.scatter(x, runs["seconds"], s=60, label=method)
        colour = marks.get_facecolor()[0]
        marks.set_facecolor([colour if done else "none" for done in runs["certified"]])
        marks.set_edgecolor(colour)
    hours = table.drop_duplicates("solid").set_index("solid")["paper_hours"]
    axes.scatter(range(len(names)), 3600 * hours[names], marker="_", s=300, label="paper, stated")
    axes.set_xticks(range(len(names)), names, rotation=30, ha="right")
    axes.grid(alpha=0.3)
    axes.set_title("Unfolding a solid: filled where the judge certified it, hollow where not")
    figure.legend(loc="outside lower center", ncols=5, frameon=False)
    figure.savefig(file, dpi=120)


if __name__ == "__main__":
    app()
