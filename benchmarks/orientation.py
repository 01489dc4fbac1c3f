"""What the choice of an upright orientation is worth: see README.md beside this file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import pandas as pd
import typer
from joining import joined

import lineup as lu
from lineup.storage import write_whole

MODELS = ("bunny", "elk", "decocube", "armadillo", "two_holed_torus", "horse")
CHOSEN_ON = 0
"""The seed that orientations are ranked with; what is reported comes from others."""
REPORTED_ON = (101, 102, 103)
FOLDED_ON = (101, 102)
STARTS = 2

app = typer.Typer(add_completion=False, help=__doc__)


@app.command()
def main(
    model: Annotated[list[str] | None, typer.Option(help="A model; without it, six.")] = None,
    voxels: Annotated[int, typer.Option(help="Voxels of each solid.")] = 500,
    evaluations: Annotated[int, typer.Option(help="Orientations tried.")] = 24,
    finalists: Annotated[int, typer.Option(help="Orientations folded.")] = 3,
    out: Annotated[Path, typer.Option(help="Folder of the tables.")] = Path("experiments/results"),
) -> None:
    """OUT/orientations.csv (all rankings), OUT/orientations_gain.csv and .md."""
    out.mkdir(parents=True, exist_ok=True)
    for name in model or MODELS:
        table = lu.rank_orientations(
            name,
            voxels,
            evaluations=evaluations,
            finalists=finalists,
            seed=CHOSEN_ON,
            starts=STARTS,
        )
        table.insert(0, "model", name)
        row = gain(name, voxels, table)
        typer.echo(f"{name}: {row['gain_folded']:+.4f} folded")
        joined(table, out / "orientations.csv")
        summary = joined(pd.DataFrame([row]), out / "orientations_gain.csv")
        page = summary.to_markdown(index=False, floatfmt=".4g")
        write_whole(out / "orientations_gain.md", f"{page}\n")


def gain(name: str, voxels: int, table: pd.DataFrame) -> dict[str, Any]:
    """The first row of a ranking beside upright, on seeds that had no part in the choice."""
    best = table.iloc[0]
    up = (float(best["up_x"]), float(best["up_y"]), float(best["up_z"]))
    before, after = lu.model(name, voxels), lu.model(name, voxels, up)
    effort = STARTS * len(table)
    ok = table[table["reason"] == "ok"]
    row: dict[str, Any] = {
        "model": name,
        "source": before.source["kind"],
        "voxels": voxels,
        "evaluations": len(table),
        "kind": best["kind"],
        "tilt_deg": best["tilt_deg"],
        "mscs_upright": len(lu.traverse(lu.reeb_graph(before)).mscs),
        "mscs_chosen": int(best["mscs"]),
        "iou_upright": before.source["iou"],
        "iou_chosen": after.source["iou"],
        "layered_upright": layered(before),
        "layered_upright_effort": lu.layered_path(
            before, seed=REPORTED_ON[0], starts=effort
        ).coverage(before),
        "layered_chosen": layered(after),
        "folded_upright": folded(before),
        "folded_chosen": folded(after),
        "folded_in_search": best["folded"],
        "stands": bool(best["stands"]),
        "mscs_to_layered": rank_correlation(ok["mscs"], ok["layered"]),
    }
    row["gain_layered"] = row["layered_chosen"] - row["layered_upright"]
    row["gain_folded"] = row["folded_chosen"] - row["folded_upright"]
    return row


def layered(solid: lu.VoxelSolid) -> float:
    """Mean coverage of layered paths over the seeds reported on."""
    paths = [lu.layered_path(solid, seed=seed) for seed in REPORTED_ON]
    return sum(path.coverage(solid) for path in paths) / len(paths)


def folded(solid: lu.VoxelSolid) -> float:
    """Mean coverage of certified foldings over two of them; 0 for one that is not certified."""
    foldings = [lu.fold(solid, seed=seed) for seed in FOLDED_ON]
    return sum(f.path.coverage(solid) * lu.certify(f.motion).ok for f in foldings) / len(foldings)


def rank_correlation(first: pd.Series, second: pd.Series) -> float:
    """Spearman's; nan where one of them never changes."""
    if first.nunique() < 2 or second.nunique() < 2:
        return float("nan")
    from scipy.stats import spearmanr  # slow to import

    return float(spearmanr(first, second).statistic)


if __name__ == "__main__":
    app()
