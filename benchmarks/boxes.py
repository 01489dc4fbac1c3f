"""Shapes folded into boxes at the sizes of Boxelization: `python -m benchmarks.boxes`."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pandas as pd
import typer

import lineup as lu
from lineup.storage import write_whole
from lineup.tables import PAPER

BOXES = ((4, 4, 3), (4, 4, 4), (5, 4, 4), (5, 5, 4), (5, 5, 5))
"""48, 64, 80, 100 and 125 voxels: the paper tells of solids of 48 to 125 (Section 7)."""

app = typer.Typer(add_completion=False, help=__doc__)


@app.command()
def boxes(
    solid: Annotated[list[str] | None, typer.Option(help="A model; without it, the ten.")] = None,
    out: Annotated[Path, typer.Option(help="Folder of the table.")] = Path("results"),
) -> None:
    """Each model folded into each box, on the way through the straight line: OUT/boxes.csv, .md."""
    measured("mug", BOXES[0])  # compiles
    rows = []
    for name in solid or PAPER:
        for sides in BOXES:
            rows.append(measured(name, sides))
            typer.echo("{solid} to {box}: {reason}, {seconds:.2f} s".format(**rows[-1]))
    table = pd.DataFrame(rows)
    out.mkdir(parents=True, exist_ok=True)
    write_whole(out / "boxes.csv", table.to_csv(index=False))
    write_whole(out / "boxes.md", table.to_markdown(index=False, floatfmt=".3g") + "\n")


def measured(name: str, sides: tuple[int, int, int]) -> dict[str, Any]:
    """One row: a model of so many voxels that its chain is as long as the box's, into that box."""
    box = lu.VoxelSolid(np.ones(sides, bool))
    begun = time.process_time()
    design = lu.lineup([name, box], blocks=box.size // 2)
    row = {"solid": name, "box": " x ".join(map(str, sides)), "voxels": box.size}
    reason = "; ".join(filter(None, design.table["failure"]))
    if not reason:
        motion = lu.transform(*design.foldings)
        verdict = lu.certify(motion)
        reason = verdict.reason
        row |= {
            "solid_voxels": design.models[0].size,
            "blocks": box.size // 2,
            "moves": len(motion),
            "clearance": verdict.clearance,
            "bend_deg": verdict.bend_deg,
        }
    return row | {
        "certified": reason == "certified",
        "reason": reason,
        "seconds": time.process_time() - begun,
    }


if __name__ == "__main__":
    app()
