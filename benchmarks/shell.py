"""What a shell saves and what it costs (Section 9): see README.md beside this file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
import typer
from joining import joined

import lineup as lu
from lineup.storage import write_whole

MODELS = ("bunny", "duck", "cannon", "decocube")

app = typer.Typer(add_completion=False, help=__doc__)


def variants(
    name: str, solid: lu.VoxelSolid, voxels: int
) -> dict[str, Callable[[], lu.VoxelSolid]]:
    """What is measured: the solid, shells of it, and a shell of as many voxels as the solid."""
    low = solid.occupancy.shape[2] // 4
    return {
        "solid": lambda: solid,
        "shell of 1": lambda: lu.shell(solid, 1),
        "shell of 2": lambda: lu.shell(solid, 2),
        "1, at the bottom 3": lambda: lu.shell(solid, lambda z: 3 if z < low else 1),
        "shell of 1, finer": lambda: lu.model(name, voxels, shell=1),
        "shell of 2, finer": lambda: lu.model(name, voxels, shell=2),
    }


@app.command()
def main(
    model: Annotated[list[str] | None, typer.Option(help="A model; without it, four.")] = None,
    voxels: Annotated[int, typer.Option(help="Voxels of the solid, and of finer shells.")] = 1600,
    out: Annotated[Path, typer.Option(help="Folder of the tables.")] = Path("experiments/results"),
) -> None:
    """OUT/shell.csv and .md."""
    out.mkdir(parents=True, exist_ok=True)
    for name in model or MODELS:
        rows: list[dict[str, Any]] = []
        solid = lu.model(name, voxels)
        for kind, made in variants(name, solid, voxels).items():
            row = {"model": name, "source": solid.source["kind"], "what": kind}
            try:
                rows.append(row | measured(made()))
            except ValueError as error:
                rows.append(row | {"reason": str(error)})
            typer.echo(f"{name}, {kind}: {rows[-1]['reason']}")
        table = joined(pd.DataFrame(rows), out / "shell.csv")
        page = table.drop(columns=["source"]).to_markdown(index=False, floatfmt=".4g")
        write_whole(out / "shell.md", f"{page}\n")


def measured(solid: lu.VoxelSolid) -> dict[str, Any]:
    """Voxels, likeness, paths and strength of one solid or shell."""
    folding = lu.fold(solid)
    bears = lu.strength(folding, solid)
    taken: dict[str, Any] = solid.source.get("shell", {"saved": 0, "vents": [], "filled": 0})
    return {
        "voxels": solid.size,
        "saved": taken["saved"] / (solid.size + taken["saved"]),
        "vents": len(taken["vents"]),
        "iou": solid.source["iou"],
        "edge": solid.pitch,
        "layered": lu.layered_path(solid, starts=2).coverage(solid),
        "folded": folding.path.coverage(solid),
        "certified": lu.certify(folding.motion).ok,
        "safety": float(f"{bears.safety:.4g}"),
        "margin_mm": round(bears.margin_mm, 3),
        "reason": bears.reason,
    }


if __name__ == "__main__":
    app()
