"""How much of a solid is folded, how surely and how fast: see README.md beside this file."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
import typer
from paths import COVERAGE_SIZES, Out, Sizes, models, solid_of, write

import lineup as lu
from lineup import grid

app = typer.Typer(add_completion=False, help=__doc__)

DIAMETER, MAX_BEND_DEG = 0.999, 90.0
WARM_UP = 60
"""Voxels of the ball that compiles the kernels before the clock runs."""


@app.command()
def coverage(
    solid: Annotated[list[str] | None, typer.Option(help="A model; without it, all.")] = None,
    voxels: Sizes = COVERAGE_SIZES,
    out: Out = Path("results"),
) -> None:
    """Certified growth on every model: OUT/folding.csv and .md, and OUT/folding_medians.*."""
    lu.certify(lu.fold(solid_of("ball", WARM_UP), rounds=50, trial_rounds=50).motion)
    rows: list[dict[str, Any]] = []
    for target in voxels:
        for name in solid or models():
            rows.append({"target": target} | measured(solid_of(name, target)))
            typer.echo("{solid} {voxels}: {coverage:.4f}, {seconds:.1f} s".format(**rows[-1]))
            table = pd.DataFrame(rows)
            write(table, out, "folding")
            write(medians(table), out, "folding_medians")


@app.command()
def layered(
    solid: Annotated[list[str] | None, typer.Option(help="A model; without it, all.")] = None,
    voxels: Sizes = (1600,),
    out: Out = Path("results"),
) -> None:
    """How far peels straighten the layered path of every model: OUT/layered.csv and .md."""
    lu.unfold(lu.layered_path(solid_of("ball", WARM_UP)), "peel", rounds=1)
    rows: list[dict[str, Any]] = []
    for target in voxels:
        for name in solid or models():
            shape = solid_of(name, target)
            rows += [
                {"solid": name, "source": shape.source["kind"], "voxels": shape.size} | found
                for found in peeled(lu.layered_path(shape))
            ]
            typer.echo("{solid} {path}: {straight} with limbs".format(**rows[-1]))
            write(pd.DataFrame(rows), out, "layered")


def peeled(path: lu.VoxelPath) -> list[dict[str, Any]]:
    """A row without limb moves, and one with them."""
    rows = []
    for limbs, rounds in ((False, 0), (True, 100)):
        begun = time.process_time()
        motion = lu.unfold(path, "peel", rounds=rounds)
        seconds = time.process_time() - begun
        verdict = lu.certify(motion, DIAMETER, MAX_BEND_DEG)
        row = {"path": len(path), "limbs": limbs, "straight": motion.straight}
        certified = verdict.ok and motion.straight
        rows.append(row | {"certified": certified, "moves": len(motion), "seconds": seconds})
    return rows


def measured(solid: lu.VoxelSolid) -> dict[str, Any]:
    """One row: a solid folded by certified growth, and what the judge says."""
    begun = time.process_time()
    folding = lu.fold(solid)
    seconds = time.process_time() - begun
    verdict = lu.certify(folding.motion, DIAMETER, MAX_BEND_DEG)
    surface = grid.surface(solid.occupancy)
    covered, bound = folding.path.coverage(solid), lu.path_bound(solid) / solid.size
    return {
        "solid": solid.name,
        "source": solid.source["kind"],
        "voxels": solid.size,
        "layered": lu.layered_path(solid).coverage(solid),
        "coverage": covered,
        "bound": bound,
        "gap": bound - covered,
        "surface": surface[tuple(folding.path.voxels.T)].sum() / surface.sum(),
        "moves": len(folding.motion),
        "seconds": seconds,
        "certified": verdict.ok and folding.motion.straight,
        "clearance": verdict.clearance,
        "bend_deg": verdict.bend_deg,
    }


def medians(table: pd.DataFrame) -> pd.DataFrame:
    """For each target, over all models."""
    return (
        table.groupby("target", sort=False)
        .agg(
            models=("coverage", "size"),
            certified=("certified", "sum"),
            median_layered=("layered", "median"),
            median_coverage=("coverage", "median"),
            least_coverage=("coverage", "min"),
            median_gap=("gap", "median"),
            median_surface=("surface", "median"),
            median_seconds=("seconds", "median"),
            most_seconds=("seconds", "max"),
        )
        .reset_index()
    )


if __name__ == "__main__":
    app()
