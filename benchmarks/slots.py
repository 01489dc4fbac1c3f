"""How many moves are against the slots of the printed block: see README.md beside this file."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pandas as pd
import typer
from paths import solid_of, write

import lineup as lu
from lineup.tables import PAPER

app = typer.Typer(add_completion=False, help=__doc__)

DIAMETER, MAX_BEND_DEG = 0.999, 90.0
WARM_UP = 60
"""Voxels of the ball that compiles the kernels before the clock runs."""


@app.command()
def main(
    solid: Annotated[list[str] | None, typer.Option(help="A model; without it, the ten.")] = None,
    voxels: Annotated[int, typer.Option(help="Of each solid.")] = 1600,
    out: Annotated[Path, typer.Option(help="Folder of the tables.")] = Path("results"),
) -> None:
    """Growth with free joints, its path planned anew, slotted growth: OUT/slots.csv and .md."""
    measured(solid_of("ball", WARM_UP))
    rows: list[dict[str, Any]] = []
    for name in solid or PAPER:
        for row in measured(solid_of(name, voxels)):
            rows.append(row)
            typer.echo("{solid}, {plan}: {against} of {moves}, {seconds:.1f} s".format(**row))
        write(pd.DataFrame(rows), out, "slots")


def measured(solid: lu.VoxelSolid) -> list[dict[str, Any]]:
    """A row for each plan; the seconds of the second are those beside growth itself."""
    free, growing = timed(lambda: lu.fold(solid))
    anew, planning = timed(
        lambda: lu.Folding(free.path, lu.unfold(free.path, "peel", joints="sparing", rounds=0))
    )
    slotted, growing_on = timed(lambda: lu.fold(solid, joints="slotted"))
    return [
        row_of(solid, "growth", free, growing),
        row_of(solid, "its path planned anew", anew, planning),
        row_of(solid, "slotted growth", slotted, growing_on),
    ]


def timed(find: Callable[[], lu.Folding]) -> tuple[lu.Folding, float]:
    begun = time.process_time()
    folding = find()
    return folding, time.process_time() - begun


def row_of(solid: lu.VoxelSolid, plan: str, folding: lu.Folding, seconds: float) -> dict[str, Any]:
    verdict = lu.certify(folding.motion, DIAMETER, MAX_BEND_DEG)
    in_slots = lu.certify(folding.motion, DIAMETER, MAX_BEND_DEG, joints="slotted")
    n_moves = len(folding.motion)
    return {
        "solid": solid.name,
        "source": solid.source["kind"],
        "voxels": solid.size,
        "plan": plan,
        "path": len(folding.path),
        "coverage": folding.path.coverage(solid),
        "moves": n_moves,
        "against": in_slots.violations,
        "share": in_slots.violations / n_moves if n_moves else np.nan,
        "certified": verdict.ok,
        "certified_slotted": in_slots.ok,
        "seconds": seconds,
    }


if __name__ == "__main__":
    app()
