"""How like its mesh a model is in voxels, path and trimmed path: see README.md beside this file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import pandas as pd
import typer
from joining import joined

import lineup as lu
from lineup.storage import write_whole

MODELS = ("bunny", "duck", "cannon", "decocube", "two_holed_torus", "armadillo", "elk", "horse")
TRIMMED = 0.95
"""Share of a folding's voxels that trimming leaves."""
STARTS = 2
"""Layered paths tried for each."""
SHOWN = ["iou", "surface_kept", "distance_mean", "distance_max", "distance_share", "silhouette"]

app = typer.Typer(add_completion=False, help=__doc__)


@app.command()
def main(
    model: Annotated[list[str] | None, typer.Option(help="A model; without it, eight.")] = None,
    voxels: Annotated[list[int] | None, typer.Option(help="The first is folded, too.")] = None,
    out: Annotated[Path, typer.Option(help="Folder of the tables.")] = Path("experiments/results"),
) -> None:
    """OUT/appearance.csv (all), OUT/appearance.md (the first count; medians by count)."""
    counts = voxels or [1600, 400, 6500]
    out.mkdir(parents=True, exist_ok=True)
    for name in model or MODELS:
        parts = [measured(name, target, folded=target == counts[0]) for target in counts]
        typer.echo(f"{name}: {parts[0]['iou'].iloc[0]:.4f}")
        table = joined(pd.concat(parts, ignore_index=True), out / "appearance.csv")
        write_whole(out / "appearance.md", page(table, counts[0]))


def measured(name: str, target: int, folded: bool) -> pd.DataFrame:
    solid = lu.model(name, target)
    shapes: dict[str, lu.VoxelPath | lu.Folding] = {
        "layered": lu.layered_path(solid, starts=STARTS)
    }
    if folded:
        folding = lu.fold(solid)
        left = 2 * int(TRIMMED * len(folding.path) / 2)
        shapes |= {"folded": folding, "trimmed": lu.trim([folding], left)[0]}
    table = lu.appearance(shapes, solid, name)
    table.insert(0, "target", target)
    table.insert(1, "model", name)
    table.insert(2, "source", solid.source["kind"])
    return table


def page(table: pd.DataFrame, first: int) -> str:
    by_model = table[table["target"] == first].drop(columns=["target", "source"])
    medians = table.groupby(["target", "stage"], sort=False)[SHOWN].median().reset_index()
    both = (by_model, medians.sort_values("target", kind="stable"))
    return "\n".join(f"{t.to_markdown(index=False, floatfmt='.4g')}\n" for t in both)


if __name__ == "__main__":
    app()
