"""How long paths get, how long that takes and how it grows: see README.md beside this file."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pandas as pd
import typer
from matplotlib.figure import Figure
from peers import PEERS

import lineup as lu
from lineup import grid
from lineup.storage import write_whole

app = typer.Typer(add_completion=False, help=__doc__)

SOLIDS = ["ball", "duck", "decocube"]
PEER_SIZES = [150, 400, 1600]
COVERAGE_SIZES = [1600, 6500]
GROWTH_SIZES = [1000, 3000, 10_000, 30_000, 100_000]

Sizes = Annotated[list[int], typer.Option("--voxels", help="Voxels of a solid; repeat for more.")]
Models = Annotated[
    list[str], typer.Option("--solid", help="'ball' or a model of the catalogue; repeat for more.")
]
Methods = Annotated[
    list[str] | None, typer.Option("--method", help="A method or peer; without it, all.")
]
Out = Annotated[Path, typer.Option(help="Folder of the tables.")]

U_FREE = {"ufree", "refined4"}
WARM_UP = 40
"""Voxels of the ball that compiles the kernels before the clock runs."""
QUICK = 0.5
"""A run of fewer seconds is repeated twice and the shortest counts: the rest is noise."""
MEASURABLE = 0.01
"""Runs of fewer seconds tell nothing of how a method grows."""


@app.command()
def peers(
    solid: Models = SOLIDS,
    voxels: Sizes = PEER_SIZES,
    method: Methods = None,
    out: Out = Path("results"),
) -> None:
    """Our methods beside general tools on the same solids: OUT/paths.csv and .md."""
    methods = chosen(method, [*lu.PATH_METHODS, *PEERS])
    rows: list[dict[str, Any]] = []
    for target in voxels:
        for name in solid:
            shape = solid_of(name, target)
            block = [measured(shape, m) for m in methods]
            layered = next((row["seconds"] for row in block if row["method"] == "layered"), np.nan)
            for row in block:
                row["seconds_to_layered"] = row["seconds"] / layered
                typer.echo("{solid} {voxels}, {method}: {path}, {seconds:.2f} s".format(**row))
            rows += block
            write(pd.DataFrame(rows), out, "paths")


@app.command()
def growth(
    solid: Annotated[str, typer.Option(help="'ball' or a model of the catalogue.")] = "ball",
    voxels: Sizes = GROWTH_SIZES,
    method: Methods = None,
    limit: Annotated[float, typer.Option(help="A run of more seconds is a method's last.")] = 20,
    out: Out = Path("results"),
) -> None:
    """Seconds against voxels: OUT/growth.csv, .md and .png, and OUT/exponents.csv and .md."""
    rows: list[dict[str, Any]] = []
    for name in chosen(method, list(lu.PATH_METHODS)):
        for target in sorted(voxels):
            shape = solid_of(solid, target)
            (path, _), seconds = timed(name, shape)
            rows.append(
                {
                    "solid": solid,
                    "method": name,
                    "voxels": shape.size,
                    "visited": len(path),
                    "seconds": seconds,
                }
            )
            typer.echo("{method}, {voxels}: {visited}, {seconds:.2f} s".format(**rows[-1]))
            if seconds > limit:
                break
        table = pd.DataFrame(rows)
        fits = exponents(table)
        write(table, out, "growth")
        write(fits, out, "exponents")
        draw(table, fits, out / "growth.png")


@app.command()
def coverage(
    solid: Annotated[list[str] | None, typer.Option(help="A model; without it, all.")] = None,
    voxels: Sizes = COVERAGE_SIZES,
    method: Methods = None,
    out: Out = Path("results"),
) -> None:
    """Our methods on every model: OUT/coverage.csv and .md, and their medians in OUT/medians.*."""
    rows: list[dict[str, Any]] = []
    for target in voxels:
        for name in solid or models():
            shape = solid_of(name, target)
            for m in chosen(method, list(lu.PATH_METHODS)):
                rows.append({"target": target} | measured(shape, m))
                rows[-1]["gap"] = rows[-1]["bound"] - rows[-1]["coverage"]
                typer.echo("{solid} {voxels}, {method}: {coverage:.4f}".format(**rows[-1]))
            write(pd.DataFrame(rows).drop(columns="seconds_to_layered"), out, "coverage")
            write(medians(pd.DataFrame(rows)), out, "medians")


def models() -> list[str]:
    """The meshes of the folder `LINEUP_MODELS`, without it the catalogue."""
    folder = os.environ.get("LINEUP_MODELS")
    meshes = sorted(file.stem for file in Path(folder).glob("*.ply")) if folder else []
    return meshes or lu.models()["name"].tolist()


def medians(table: pd.DataFrame) -> pd.DataFrame:
    """For each method and target, over all models: coverage, surface, gap to the bound, seconds."""
    return (
        table.groupby(["target", "method"], sort=False)
        .agg(
            models=("coverage", "size"),
            median_coverage=("coverage", "median"),
            least_coverage=("coverage", "min"),
            median_surface=("surface", "median"),
            mean_gap=("gap", "mean"),
            median_seconds=("seconds", "median"),
            most_seconds=("seconds", "max"),
            refused=("note", lambda notes: int((notes != "").sum())),
        )
        .reset_index()
    )


def chosen(methods: list[str] | None, known: list[str]) -> list[str]:
    unknown = sorted(set(methods or ()) - set(known))
    if unknown:
        raise typer.BadParameter(f"unknown method {unknown[0]!r}; known: {known}")
    return [method for method in known if not methods or method in methods]


def solid_of(name: str, voxels: int) -> lu.VoxelSolid:
    """A model, a mesh of `LINEUP_MODELS`, or a ball about a voxel corner, of `voxels` at most."""
    if name in set(lu.models()["name"]):
        return lu.model(name, voxels=voxels)
    if name != "ball":
        return lu.voxelize(Path(os.environ["LINEUP_MODELS"]) / f"{name}.ply", voxels, name=name)
    reach = int(np.cbrt(voxels) * 0.65) + 2
    odd = np.arange(1 - 2 * reach, 2 * reach, 2) ** 2
    squares = odd[:, None, None] + odd[:, None] + odd
    radius = np.sort(squares, axis=None)[voxels]
    return lu.VoxelSolid(squares < radius, name=name, source={"kind": "formula"})


def timed(method: str, solid: lu.VoxelSolid) -> tuple[tuple[lu.VoxelPath, str], float]:
    """A path, a note, and the seconds they took, compilation apart."""
    find(method, solid_of("ball", WARM_UP))
    seconds: list[float] = []
    while not seconds or (seconds[0] < QUICK and len(seconds) < 3):
        start = time.perf_counter()
        found = find(method, solid)
        seconds.append(time.perf_counter() - start)
    return found, min(seconds)


def find(method: str, solid: lu.VoxelSolid) -> tuple[lu.VoxelPath, str]:
    """A path of even length by a method of ours or a peer, and a note."""
    if method in lu.PATH_METHODS:
        return lu.layered_path(solid, method), ""
    voxels, note = PEERS[method][0](solid)
    voxels = voxels[: len(voxels) // 2 * 2]
    left_out = solid.occupancy.copy()
    left_out[tuple(voxels.T)] = False
    return lu.VoxelPath(voxels, dropped=np.argwhere(left_out), method=method), note


def measured(solid: lu.VoxelSolid, method: str) -> dict[str, Any]:
    """One row of the table of peers; its note says why a peer was not run."""
    row: dict[str, Any] = {
        "solid": solid.name,
        "source": solid.source["kind"],
        "voxels": solid.size,
        "method": method,
        "path": pd.NA,
        "coverage": np.nan,
        "surface": np.nan,
        "bound": lu.path_bound(solid, u_free=method == "ufree") / solid.size,
        "seconds": np.nan,
        "seconds_to_layered": np.nan,
        "note": "",
    }
    if method in PEERS and solid.size > PEERS[method][1]:
        return row | {"note": f"not run: more than {PEERS[method][1]} voxels"}
    try:
        (path, note), seconds = timed(method, solid)
    except ModuleNotFoundError as error:
        return row | {"note": f"not run: {error.name} is not installed"}
    verdict = lu.certify_path(path, solid, u_free=method in U_FREE)
    surface = grid.surface(lu.refine(solid, path.refinement).occupancy)
    return row | {
        "path": len(path),
        "coverage": path.coverage(solid),
        "surface": surface[tuple(path.voxels.T)].sum() / surface.sum(),
        "bound": 1.0 if path.refinement > 1 else row["bound"],
        "seconds": seconds,
        "note": note if verdict.ok else f"refused: {verdict.reason}",
    }


def exponents(table: pd.DataFrame) -> pd.DataFrame:
    """The b of seconds = a voxels^b for each method, by least squares of the logarithms."""
    rows = []
    for method, runs in table.groupby("method", sort=False):
        runs = runs[runs["seconds"] >= MEASURABLE]
        slope = np.nan
        if len(runs) > 1:
            slope = np.polyfit(np.log(runs["voxels"]), np.log(runs["seconds"]), 1)[0]
        rows.append({"method": method, "runs": len(runs), "exponent": slope})
    return pd.DataFrame(rows)


def write(table: pd.DataFrame, folder: Path, name: str) -> None:
    """NAME.csv with every digit, NAME.md to read."""
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(folder / f"{name}.csv", table.to_csv(index=False))
    cells = table.map(printed)
    write_whole(folder / f"{name}.md", cells.to_markdown(index=False, disable_numparse=True) + "\n")


def printed(value: object) -> str:
    if pd.isna(value):
        return "–"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def draw(table: pd.DataFrame, fits: pd.DataFrame, file: Path) -> None:
    """Seconds against voxels, both logarithmic, with the slopes of n and of n^2."""
    figure = Figure(figsize=(8, 5), layout="constrained")
    axes = figure.add_subplot(xscale="log", yscale="log", xlabel="voxels n", ylabel="seconds")
    slopes = fits.set_index("method")["exponent"]
    for k, (method, runs) in enumerate(table.groupby("method", sort=False)):
        label = f"{method}: n^{slopes[method]:.2f}"
        marker = "os"[k // 10 % 2]  # there are ten colours
        axes.plot(runs["voxels"], runs["seconds"], marker=marker, label=label)
    n = np.array([table["voxels"].min(), table["voxels"].max()])
    for power, style in ((1, "--"), (2, ":")):
        line = table["seconds"].min() * (n / n[0]) ** power
        axes.plot(n, line, style, color="0.6", label=f"as n^{power}")
    figure.legend(loc="outside right upper")
    axes.grid(alpha=0.3)
    figure.savefig(file, dpi=120)


if __name__ == "__main__":
    app()
