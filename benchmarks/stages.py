"""How the time of each stage grows, from a thousand voxels to a million: see README.md."""

from __future__ import annotations

import resource
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
import typer
from paths import draw, exponents, write

import lineup as lu

app = typer.Typer(add_completion=False, help=__doc__)

SIZES = [1000, 3000, 10_000, 30_000, 100_000, 300_000, 1_000_000]
LARGEST = {"print files": 10_000, "strength": 10_000}
"""Stages that are not given larger solids, whatever the limit."""
WARM_UP = 60


@app.command()
def main(
    model: Annotated[str, typer.Option(help="A model of the catalogue.")] = "bunny",
    voxels: Annotated[list[int], typer.Option(help="Voxels of a solid; repeat for more.")] = SIZES,
    limit: Annotated[
        float, typer.Option(help="A run of more seconds is the last of a stage.")
    ] = 60,
    out: Annotated[Path, typer.Option(help="Folder of the tables.")] = Path("results"),
) -> None:
    """OUT/stages.csv, .md and .png, and OUT/stage_exponents.csv and .md."""
    measured(model, min(WARM_UP, *voxels), 0, set())  # compiles
    rows: list[dict[str, Any]] = []
    over: set[str] = set()
    for target in sorted(voxels):
        rows += measured(model, target, limit, over)
        table = pd.DataFrame(rows)
        fits = exponents(table)
        write(table, out, "stages")
        write(fits, out, "stage_exponents")
        draw(table, fits, out / "stages.png")


def measured(model: str, target: int, limit: float, over: set[str]) -> list[dict[str, Any]]:
    """A row for each stage that is not yet over the limit, and those that are from now on."""
    rows: list[dict[str, Any]] = []

    def timed(stage: str, run: Callable[[], Any]) -> Any:
        if stage in over or target > LARGEST.get(stage, target):
            return None
        start = time.perf_counter()
        found = run()
        seconds = time.perf_counter() - start
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
        rows.append({"method": stage, "voxels": target, "seconds": seconds, "peak_gb": peak})
        typer.echo(f"{stage}, {target}: {seconds:.2f} s")
        if limit and seconds > limit:
            over.add(stage)
        return found

    solid = timed("voxelize", lambda: lu.model(model, target))
    if solid is None:
        return rows
    timed("Reeb graph", lambda: lu.reeb_graph(solid))
    timed("bound", lambda: lu.path_bound(solid))
    timed("paper path", lambda: lu.layered_path(solid, "paper"))
    path = timed("layered path", lambda: lu.layered_path(solid))
    if path is not None:
        timed("certify path", lambda: lu.certify_path(path, solid))
        timed("print files", lambda: lu.export_print(path, tempfile.mkdtemp(), layers=1000))
        timed("strength", lambda: lu.strength(path, solid, bonding="solid", held="-z"))
    folding = timed("fold", lambda: lu.fold(solid))
    if folding is not None:
        timed("certify", lambda: lu.certify(folding.motion))
        timed("trim", lambda: lu.trim([folding], len(folding.path) * 95 // 200 * 2))
    return rows


if __name__ == "__main__":
    app()
