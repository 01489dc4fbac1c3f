"""Stresses of folded models beside the paper's Figure 17: `python -m benchmarks.strength`."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
import typer

import lineup as lu
from lineup import draw
from lineup.storage import write_whole
from lineup.stress.results import rounded, summary

PAPER_KPA = {
    "bunny": 4.333,
    "cannon": 9.888,
    "decocube": 1.219,
    "duck": 3.314,
    "two_holed_torus": 0.247,
}
"""The largest stress that Figure 17 gives for each model."""

HOW = {"solid, held": ("solid", True), "velcro": ("velcro", False), "none": ("none", False)}
"""What is computed of each: bonding, and whether its lowest layer is held fast."""

LYING = {"two_holed_torus": "+y"}
"""Models that are set on another side, too."""

UNKNOWN = """
Stresses are in kPa, the largest of the model: `face` is the mean tension over one voxel face,
`corner` the most at a corner of one, traction and bending together, `compression` a mean again.
`to_paper` is `face` over the paper's figure. `safety` is the factor by which all loads may grow
before a hinge or velcro face comes to 206.7 kPa at a corner, or a face bears 2,042 N of
compression. Paths are layered ones; strength.csv has those of certified growth, too.

`solid, held`: one lump of resin that is fixed to the ground, as in a plain finite element run.
`velcro`: on a smooth table that only pushes; hinges with .05, velcro with .01 of the stiffness of
resin. `none`: the same without velcro, where strands only push each other.

What the paper does not give, and what keeps these columns from being a comparison: which stress
its figures are (principal, normal or von Mises; of an element or a node), the size of a block and
its density (here {pitch:g} mm and 1,130 kg/m³; stresses are in proportion to both), how the models
are held, which way is up, how the faces of blocks are joined in its model, how fine its elements
are (the peak at a re-entrant edge grows with fineness), and its meshes, in whose place are like
ones. That some of this differs is plain from its two-holed torus: .247 kPa is what a column of
2.2 voxels of 10 mm weighs on its lowest face.
"""

app = typer.Typer(add_completion=False, help=__doc__)


@app.command()
def strength(
    model: Annotated[list[str] | None, typer.Option(help="A model; without it, all five.")] = None,
    voxels: Annotated[int, typer.Option(help="Voxels of each.")] = 1600,
    pitch_mm: Annotated[float, typer.Option(help="Edge length of a voxel.")] = 10.0,
    moments: Annotated[int, typer.Option(help="Poses of each motion to look at.")] = 25,
    out: Annotated[Path, typer.Option(help="Folder of the tables.")] = Path("experiments/results"),
    pictures: Annotated[Path, typer.Option(help="Folder of the pictures.")] = Path("docs"),
) -> None:
    """OUT/strength.csv and .md, OUT/standing.csv and .md, PICTURES/strength.png, standing.png."""
    rows: list[dict[str, Any]] = []
    through: list[pd.DataFrame] = []
    out.mkdir(parents=True, exist_ok=True)
    for k, name in enumerate(model or PAPER_KPA):
        solid = lu.model(name, voxels=voxels)
        folding = lu.fold(solid)
        layered = lu.layered_path(solid)
        for method, path in (("layered", layered), ("growth", folding.path)):
            rows += measured(path, solid, pitch_mm, method)
        typer.echo(f"{name}: {rows[-1]['seconds']:.1f} s for the last")
        through.append(lu.standing(folding, moments, pitch_mm))
        through[-1].insert(0, "model", name)
        if k == 0:
            result = lu.strength(folding, solid, pitch_mm)
            draw.save(draw.strength(result), pictures / "strength.png")
            draw.save(draw.standing(through[-1]), pictures / "standing.png")
    table = rounded(pd.DataFrame(rows))
    write_whole(out / "strength.csv", table.to_csv(index=False))
    page = f"{markdown(brief(table))}{UNKNOWN.format(pitch=pitch_mm)}"
    write_whole(out / "strength.md", page)
    poses = rounded(pd.concat(through, ignore_index=True))
    write_whole(out / "standing.csv", poses.to_csv(index=False))
    write_whole(out / "standing.md", markdown(standings(poses)))


def measured(
    path: lu.VoxelPath, solid: lu.VoxelSolid, pitch_mm: float, method: str
) -> list[dict[str, Any]]:
    """A row for each bonding, and each way up, of one path."""
    rows = []
    for up in ["+z", *([LYING[solid.name]] if solid.name in LYING else [])]:
        for name, (bonding, held) in HOW.items():
            started = time.process_time()
            side = up.translate(str.maketrans("+-", "-+")) if held else None
            result = lu.strength(path, solid, pitch_mm, bonding=bonding, up=up, held=side)
            row = {
                "model": solid.name,
                "source": solid.source["kind"],
                "path": method,
                "up": up,
                "how": name,
                "paper_kpa": PAPER_KPA.get(solid.name),
            }
            seconds = round(time.process_time() - started, 1)
            known = {*row, "residual"}
            rows.append(row | {k: v for k, v in summary(result).items() if k not in known})
            rows[-1]["seconds"] = seconds
    return rows


def brief(table: pd.DataFrame) -> pd.DataFrame:
    """The layered paths, and the columns that stand beside the paper's."""
    table = table[table["path"] == "layered"]
    kept = table[["model", "source", "up", "how", "voxels", "paper_kpa"]].copy()
    kept["face"] = (table["tension_pa"] / 1e3).round(3)
    kept["corner"] = (table["corner_tension_pa"] / 1e3).round(3)
    kept["compression"] = (table["compression_pa"] / 1e3).round(3)
    kept["to_paper"] = (kept["face"] / table["paper_kpa"]).round(2)
    kept["safety"] = table["safety"]
    kept["worst"] = table["worst"]
    kept["stands"] = table["reason"]
    return kept


def standings(poses: pd.DataFrame) -> pd.DataFrame:
    """What comes of each motion, over the poses in which something is folded."""
    some = poses[poses["folded"] > 0]
    rows = []
    for name, of in some.groupby("model", sort=False):
        held = of[of["stands"]]
        rows.append(
            {
                "model": name,
                "poses": len(of),
                "standing": len(held),
                "least_margin_mm": of["margin_mm"].min(),
                "least_safety_standing": held["safety"].min(),
                "most_below_mm": of["below_mm"].max(),
                "longest_side_mm": of[["box_x_mm", "box_y_mm", "box_z_mm"]].to_numpy().max(),
            }
        )
    return pd.DataFrame(rows)


def markdown(table: pd.DataFrame) -> str:
    return table.to_markdown(index=False, floatfmt=".4g") + "\n"


if __name__ == "__main__":
    app()
