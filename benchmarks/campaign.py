"""Random polycubes through path, unfold, trim and certify: see README.md beside this file."""

from __future__ import annotations

import tempfile
import time
from itertools import product
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pandas as pd
import typer
from families import FAMILIES, polycube
from paths import write

import lineup as lu
from lineup.storage import text, write_whole

app = typer.Typer(add_completion=False, help=__doc__)

DIAMETER, MAX_BEND_DEG = 0.999, 90.0
NOT_STRAIGHT = "ends not straight, and is straight nowhere before"
FEWEST, MOST = 2, 200
CLASSES = {"2 to 9": 2, "10 to 49": 10, "50 to 200": 50}
"""Classes of sizes and the least of each."""
BATCH = 100
"""Cases between two times that they are written."""
NOTHING = {"invalid": "", "stuck": ""} | dict.fromkeys(("bound", "path", "folded", "trimmed"), 0)
NOTHING |= dict.fromkeys(("straight_layered", "straight_growth", "straight_trimmed"), False)
"""What a case that crashed has found."""

Seed = Annotated[int, typer.Option(help="Of all random choices.")]
Starts = Annotated[int, typer.Option(help="Layered paths tried for each solid.")]
Out = Annotated[Path, typer.Option(help="Folder of the tables.")]


@app.command()
def run(
    count: Annotated[int, typer.Option(help="Cases 0 to COUNT - 1.")] = 20_000,
    minutes: Annotated[float, typer.Option(help="Begin no case after so many.")] = np.inf,
    seed: Seed = 0,
    starts: Starts = 1,
    out: Out = Path("results"),
) -> None:
    """OUT/campaign.csv and .md, failures.csv; goes on after the cases in OUT/campaign_cases.csv."""
    judged(0, seed, starts)  # compiles
    begun = time.monotonic()
    rows = former(out / "campaign_cases.csv", seed, starts)
    done = {row["case"] for row in rows}
    left = [number for number in range(count) if number not in done]
    while left and time.monotonic() - begun < 60 * minutes:
        batch, left = left[:BATCH], left[BATCH:]
        rows += [judged(number, seed, starts) for number in batch]
        report(pd.DataFrame(rows), out)
        typer.echo(f"{count - len(left)} of {count}, {time.monotonic() - begun:.0f} s")


@app.command()
def again(number: int, seed: Seed = 0, starts: Starts = 1, out: Out = Path("results")) -> None:
    """One case again: its row, and its solid in OUT/case_NUMBER.solid.json."""
    out.mkdir(parents=True, exist_ok=True)
    lu.save(solid_of(number, seed), out / f"case_{number}.solid.json")
    for name, value in judged(number, seed, starts).items():
        typer.echo(f"{name}: {value}")


def former(file: Path, seed: int, starts: int) -> list[dict[str, Any]]:
    """The rows of an earlier run with the same settings."""
    if not file.is_file():
        return []
    table = pd.read_csv(file, keep_default_na=False)
    if not ((table["seed"] == seed) & (table["starts"] == starts)).all():
        raise typer.BadParameter(f"{file} is of another seed or starts; give another --out")
    return table.to_dict("records")


def solid_of(number: int, seed: int) -> lu.VoxelSolid:
    """The solid of a case; families take turns, and sizes are even on a logarithmic scale."""
    rng = np.random.default_rng([seed, number])
    voxels = round(FEWEST * (MOST / FEWEST) ** rng.random())
    return polycube(list(FAMILIES)[number % len(FAMILIES)], voxels, rng)


def judged(number: int, seed: int, starts: int) -> dict[str, Any]:
    """The row of a case; what a planner or the judge raises is in its column `crash`."""
    solid = solid_of(number, seed)
    row = {"seed": seed, "starts": starts, "case": number}
    row |= {"family": solid.name, "voxels": solid.size, "crash": ""} | NOTHING
    begun = time.process_time()
    try:
        row |= measured(solid, number, starts)
    except Exception as error:  # whatever it is, it is a finding
        row["crash"] = f"{type(error).__name__}: {error}"
    return row | {"seconds": round(time.process_time() - begun, 4)}


def measured(solid: lu.VoxelSolid, seed: int, starts: int) -> dict[str, Any]:
    """A layered path peeled and a fold grown from it; both judged, trimmed and judged again."""
    path, bound = lu.layered_path(solid, seed=seed, starts=starts), lu.path_bound(solid)
    peeled = lu.Folding(path, lu.unfold(path, "peel", seed))
    grown = lu.fold(solid, seed=seed, paths=[path])
    half = min(len(path), len(grown.path)) // 2
    length = 2 * int(np.random.default_rng(seed).integers(1, half, endpoint=True))
    cut = [shortened(folding, length, seed) for folding in (peeled, grown)]
    names = ("layered", "growth", "layered, trimmed", "growth, trimmed")
    found = dict(zip(names, (peeled, grown, *cut), strict=True))
    again = stored_and_read([*found.values()])
    faults = [
        f"{name}: {why}"
        for (name, folding), read in zip(found.items(), again, strict=True)
        for why in faults_of(folding, read, solid, bound)
    ]
    faults += [f"{len(f.path)} voxels and not {length}" for f in cut if len(f.path) != length]
    stuck = [f"{name}: {f.motion.reason}" for name, f in found.items() if not f.motion.straight]
    return {
        "invalid": "; ".join(faults),
        "stuck": "; ".join(stuck),
        "bound": bound,
        "path": len(path),
        "folded": len(grown.path),
        "trimmed": length,
        "straight_layered": peeled.motion.straight,
        "straight_growth": grown.motion.straight,
        "straight_trimmed": all(folding.motion.straight for folding in cut),
    }


def shortened(folding: lu.Folding, length: int, seed: int) -> lu.Folding:
    """A folding trimmed; where it is not straight, its path is trimmed and unfolded anew."""
    if folding.motion.straight:
        return lu.trim([folding], length)[0]
    path = lu.trim([folding.path], length)[0]
    return lu.Folding(path, lu.unfold(path, "peel", seed))


def stored_and_read(foldings: list[lu.Folding]) -> list[Any]:
    """What comes back from files."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "again.folding.json"
        return [lu.load(lu.save(folding, file)) for folding in foldings]


def faults_of(
    folding: lu.Folding, again: lu.Folding, solid: lu.VoxelSolid, bound: int
) -> list[str]:
    """What a path and its motion, as read `again`, are not that they claim to be."""
    path, motion = folding.path, folding.motion
    on_path = lu.certify_path(again.path, solid)
    verdict = lu.certify(again.motion, DIAMETER, MAX_BEND_DEG)
    told = "certified" if motion.straight else NOT_STRAIGHT
    checks = {
        f"path: {on_path.reason}": on_path.ok,
        f"{len(path)} voxels, more than the bound of {bound}": len(path) <= bound,
        "it reads back otherwise": text(again) == text(folding),
        f"motion: {verdict.reason}": verdict.reason == told,
        "no reason is given": motion.reason.startswith("straight") == motion.straight,
    }
    return [why for why, kept in checks.items() if not kept]


def report(rows: pd.DataFrame, out: Path) -> None:
    """All tables; those cases that fell short are told one by one."""
    out.mkdir(parents=True, exist_ok=True)
    write_whole(out / "campaign_cases.csv", rows.to_csv(index=False))
    short = rows[(rows[["crash", "invalid", "stuck"]] != "").any(axis=1)]
    write_whole(out / "campaign_failures.csv", short.drop(columns="seconds").to_csv(index=False))
    write(summary(rows), out, "campaign")


def summary(rows: pd.DataFrame) -> pd.DataFrame:
    """A row for each family and class of sizes, then for all families, then for all sizes."""
    sizes = pd.cut(rows["voxels"], [*CLASSES.values(), np.inf], right=False, labels=[*CLASSES])
    lines = []
    for family, size in product([*FAMILIES, "all"], [*CLASSES, "all"]):
        in_family = (family == "all") | (rows["family"] == family)
        in_class = (size == "all") | (sizes == size)
        if (in_family & in_class).any():
            lines.append(line_of(family, size, rows[in_family & in_class]))
    return pd.DataFrame(lines)


def line_of(family: str, size: str, rows: pd.DataFrame) -> dict[str, Any]:
    """Shares are of all cases, medians of those that did not crash."""
    ran = rows[rows["crash"] == ""]
    layered, growth, bound = (ran[name] / ran["voxels"] for name in ("path", "folded", "bound"))
    return {
        "family": family,
        "voxels": size,
        "count": len(rows),
        "crashed": len(rows) - len(ran),
        "invalid": int((rows["invalid"] != "").sum()),
        "straight_layered": rows["straight_layered"].mean(),
        "straight_growth": rows["straight_growth"].mean(),
        "straight_trimmed": rows["straight_trimmed"].mean(),
        "coverage_layered": layered.median(),
        "coverage_growth": growth.median(),
        "gap_layered": (bound - layered).median(),
        "gap_growth": (bound - growth).median(),
        "seconds": rows["seconds"].mean(),
        "most_seconds": rows["seconds"].max(),
    }


if __name__ == "__main__":
    app()
