"""Each stage beside what one would otherwise take for it: see README.md beside this file."""

from __future__ import annotations

import os
import platform
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.metadata import version
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pandas as pd
import typer
from matplotlib.figure import Figure
from others import (
    by_elements,
    ccd_finds_contact,
    flow_bound,
    sampled_clearance,
    scene_of_chain,
)
from paths import printed, write
from peers import PEERS

import lineup as lu
from lineup import catalog, kinematics
from lineup.motion.algorithm4 import energy_run
from lineup.motion.plan import DIAMETER
from lineup.motion.thick import barrier_run
from lineup.storage import write_whole

app = typer.Typer(add_completion=False, help=__doc__)

PITCH_MM = 10.0
MOVES = 6
"""Moves that a peer of the judge looks at, spread over the motion; its time is scaled to all."""
ENOUGH = 8.0
"""Seconds of both sides after which nothing is repeated."""


@dataclass(frozen=True)
class Side:
    """Something to time: it says what it came to, and does a share of the whole job."""

    run: Callable[[], str]
    share: float = 1.0


Sides = Callable[[str, int], tuple[Side, Side]]
"""Of ours and of a peer, on a model of so many voxels."""


@dataclass(frozen=True)
class Contest:
    """A stage of ours and a peer, on a model of so many voxels; `small` compiles and loads."""

    stage: str
    peer: str
    voxels: int
    sides: Sides
    small: int = 60
    model: str = "bunny"


@app.command()
def main(
    stage: Annotated[list[str] | None, typer.Option(help="A stage; without it, all.")] = None,
    scale: Annotated[float, typer.Option(help="Multiplies the voxels of every contest.")] = 1.0,
    repeats: Annotated[int, typer.Option(help="Runs of each side, at most.")] = 5,
    out: Annotated[Path, typer.Option(help="Folder of the tables.")] = Path("results"),
) -> None:
    """OUT/benchmarks.csv, OUT/benchmarks.md and OUT/benchmarks.png."""
    known = list(dict.fromkeys(contest.stage for contest in CONTESTS))
    unknown = sorted(set(stage or ()) - set(known))
    if unknown:
        raise typer.BadParameter(f"unknown stage {unknown[0]!r}; known: {known}")
    rows: list[dict[str, Any]] = []
    for contest in CONTESTS:
        if stage and contest.stage not in stage:
            continue
        rows.append(row_of(contest, max(round(scale * contest.voxels), 8), repeats))
        typer.echo("{stage}, {peer}: {ratio:.3g} {note}".format(**rows[-1]))
        table = pd.DataFrame(rows)
        write(table, out, "benchmarks")
        write_whole(out / "benchmarks.md", page(table))
    draw(table, out / "benchmarks.png")


def row_of(contest: Contest, voxels: int, repeats: int) -> dict[str, Any]:
    """Both sides in turn, several times; the ratio is of medians, its spread of pairs."""
    row: dict[str, Any] = {
        "stage": contest.stage,
        "peer": contest.peer,
        "model": contest.model,
        "voxels": voxels,
        "ratio": np.nan,
        "least": np.nan,
        "most": np.nan,
        "runs": 0,
        "seconds": np.nan,
        "peer_seconds": np.nan,
        "ours": "",
        "theirs": "",
        "note": "",
    }
    try:
        for side in contest.sides(contest.model, min(contest.small, voxels)):
            side.run()
    except ModuleNotFoundError as error:
        return row | {"note": f"not run: {error.name} is not installed"}
    ours, theirs = contest.sides(contest.model, voxels)
    taken: list[tuple[float, float]] = []
    began = time.perf_counter()
    while len(taken) < repeats and (not taken or time.perf_counter() - began < ENOUGH):
        told, seconds = zip(timed(ours), timed(theirs), strict=True)
        taken.append(seconds)
    mine, other = np.array(taken).T
    ratios = other / mine
    return row | {
        "ratio": np.median(other) / np.median(mine),
        "least": ratios.min(),
        "most": ratios.max(),
        "runs": len(taken),
        "seconds": np.median(mine),
        "peer_seconds": np.median(other),
        "ours": told[0],
        "theirs": told[1],
    }


def timed(side: Side) -> tuple[str, float]:
    start = time.perf_counter()
    told = side.run()
    return told, (time.perf_counter() - start) / side.share


def voxelizing(fill: Callable[[Any, float], int]) -> Sides:
    """The search for a grid of the wanted count, beside one fill of a grid of the pitch found."""

    def sides(model: str, voxels: int) -> tuple[Side, Side]:
        surface, _ = catalog.surface_for(model)
        mesh = (surface.vertices, surface.faces)
        pitch = lu.voxelize(mesh, voxels).pitch

        def ours() -> str:
            solid = lu.voxelize(mesh, voxels)
            return f"{solid.size} voxels, IoU {solid.source['iou']:.3f}"

        return Side(ours), Side(lambda: f"{fill(mesh, pitch)} voxels")

    return sides


def filled_by_trimesh(mesh: Any, pitch: float) -> int:
    import trimesh

    return int(trimesh.Trimesh(*mesh).voxelized(pitch).fill().filled_count)


def filled_by_vtk(mesh: Any, pitch: float) -> int:
    import pyvista

    surface = pyvista.PolyData.from_regular_faces(*mesh)
    image = surface.voxelize_binary_mask(spacing=(pitch,) * 3)
    return int((image["mask"] > 0).sum())


def linking(peer: str) -> Sides:
    def sides(model: str, voxels: int) -> tuple[Side, Side]:
        solid = lu.model(model, voxels)

        def theirs() -> str:
            found, note = PEERS[peer][0](solid)
            return share_of(len(found), solid) + (f", {note}" if note else "")

        return Side(lambda: share_of(len(lu.layered_path(solid)), solid)), Side(theirs)

    return sides


def share_of(length: int, solid: lu.VoxelSolid) -> str:
    return f"{length / solid.size:.1%} of the voxels"


def bounding(model: str, voxels: int) -> tuple[Side, Side]:
    solid = lu.model(model, voxels)
    return Side(lambda: str(lu.path_bound(solid))), Side(lambda: str(flow_bound(solid)))


def unfolding(planner: Callable[[lu.VoxelPath], lu.Motion]) -> Sides:
    """From a solid to the straight line: growth, and a flow on a layered path."""

    def sides(model: str, voxels: int) -> tuple[Side, Side]:
        solid = lu.model(model, voxels)

        def ours() -> str:
            return judged(lu.fold(solid).motion)

        return Side(ours), Side(lambda: judged(planner(lu.layered_path(solid))))

    return sides


def by_energy(path: lu.VoxelPath) -> lu.Motion:
    return energy_run(path, 1, 10_000)[0]


def by_barrier(path: lu.VoxelPath) -> lu.Motion:
    return barrier_run(path, DIAMETER, (1, 0), 1_000)[0]


def judged(motion: lu.Motion) -> str:
    verdict = lu.certify(motion, diameter=motion.diameter, max_bend_deg=motion.max_bend_deg)
    return f"{'straight' if motion.straight else 'not straight'}, {verdict.clearance:.3f} apart"


def judging(find: Callable[[list[Any]], str]) -> Sides:
    """The judge on a whole motion, and a peer on some moves of it, in 16 straight steps each."""

    def sides(model: str, voxels: int) -> tuple[Side, Side]:
        motion = lu.fold(lu.model(model, voxels)).motion
        poses = list(some_moves(motion))

        def theirs() -> str:
            return find(poses)

        def ours() -> str:
            return f"{lu.certify(motion).clearance:.4f} apart, proved"

        return Side(ours), Side(theirs, len(poses) / len(motion))

    return sides


def some_moves(motion: lu.Motion, steps: int = 16) -> Iterator[list[Any]]:
    """The poses within some moves."""
    wanted = set(np.linspace(0, len(motion) - 1, min(MOVES, len(motion))).astype(int).tolist())
    pose = motion.start.astype(float)
    for k, move in enumerate(motion.moves):
        if k in wanted:
            times = np.linspace(0, 1, steps + 1)
            yield [kinematics.moved(pose, move, motion, t) for t in times]
        pose = np.rint(kinematics.moved(pose, move, motion, 1.0))


def least_by_sampling(moves: list[Any]) -> str:
    return f"{min(sampled_clearance(pose) for poses in moves for pose in poses):.4f} apart, sampled"


def contact_by_ccd(moves: list[Any]) -> str:
    found = any(ccd_finds_contact(*step, 0.98) for poses in moves for step in pairwise(poses))
    return "contact" if found else "none within .98"


def exporting(model: str, voxels: int) -> tuple[Side, Side]:
    """All files of a print, and the chain alone as a 3MF of placed meshes."""
    solid = lu.model(model, voxels)
    path = lu.layered_path(solid)
    folder = Path(tempfile.mkdtemp())

    def ours() -> str:
        made = lu.export_print(path, folder, PITCH_MM, pose="folded")
        return f"{len(made.files)} files, the chain {kilobytes(folder / 'folded.3mf')}"

    def theirs() -> str:
        scene_of_chain(path, PITCH_MM).export(folder / "peer.3mf")
        return f"the chain {kilobytes(folder / 'peer.3mf')}"

    return Side(ours), Side(theirs)


def kilobytes(file: Path) -> str:
    return f"{file.stat().st_size / 1e3:.0f} kB"


def bearing(model: str, voxels: int) -> tuple[Side, Side]:
    """One lump held at its lowest faces: rigid voxels and springs, and trilinear elements."""
    solid = lu.model(model, voxels)
    path = lu.layered_path(solid)

    def ours() -> str:
        result = lu.strength(path, solid, PITCH_MM, bonding="solid", held="-z")
        return f"sags by {1e3 * result.sag_mm:.3g} um"

    def theirs() -> str:
        return f"sags by {1e3 * by_elements(path.voxels, PITCH_MM):.3g} um"

    return Side(ours), Side(theirs)


CONTESTS = [
    Contest("voxelization", "trimesh", 6500, voxelizing(filled_by_trimesh)),
    Contest("voxelization", "VTK (pyvista)", 6500, voxelizing(filled_by_vtk)),
    Contest("path", "networkx depth-first", 6500, linking("networkx depth-first")),
    Contest("path", "networkx tour", 400, linking("networkx tour"), 20),
    Contest("path", "LKH", 1600, linking("LKH"), 20),
    Contest("path", "CP-SAT", 400, linking("CP-SAT"), 20),
    Contest("bound", "networkx flow", 1600, bounding),
    Contest("unfolding", "Algorithm 4", 1600, unfolding(by_energy), 12),
    Contest("unfolding", "Algorithm 4", 1600, unfolding(by_energy), 12, "decocube"),
    Contest("unfolding", "barrier", 1600, unfolding(by_barrier), 12),
    Contest("certification", "dense sampling", 1600, judging(least_by_sampling)),
    Contest("certification", "ipctk", 1600, judging(contact_by_ccd)),
    Contest("3MF export", "trimesh", 754, exporting),
    Contest("strength", "scikit-fem", 1600, bearing),
]


def page(table: pd.DataFrame) -> str:
    """The ratios, and the machine that they are of."""
    shown = table.drop(columns=["least", "most"])
    spread = [
        f"{printed(low)} to {printed(high)}" if runs > 1 else ""
        for low, high, runs in table[["least", "most", "runs"]].itertuples(index=False)
    ]
    shown.insert(5, "spread", spread)
    cells = shown.map(printed).to_markdown(index=False, disable_numparse=True)
    tools = ("numpy", "scipy", "numba", "trimesh", "pyvista", "networkx", "ortools", "ipctk")
    versions = ", ".join(f"{tool} {version(tool)}" for tool in tools)
    machine = (
        f"{platform.system()} on {platform.machine()}, {os.cpu_count()} cores, "
        f"Python {platform.python_version()}, {versions}"
    )
    return (
        f"{cells}\n\n`ratio`: how many times longer the peer takes, medians of `runs` runs in turn;"
        f" more than 1 where ours is faster. Compilation is not in it.\n\n"
        f"{machine}.\n"
    )


def draw(table: pd.DataFrame, file: Path) -> None:
    """A bar for each contest, from equal times to the ratio."""
    ran = table[table["runs"] > 0].iloc[::-1]
    figure = Figure(figsize=(8, 0.4 * len(ran) + 1.2), layout="constrained")
    axes = figure.add_subplot(xscale="log", xlabel="time of the peer / ours")
    colours = np.where(ran["ratio"] >= 1, "#2a78b5", "#c44e52")
    labels = ran["stage"] + ": " + ran["peer"] + ", " + ran["model"]
    axes.barh(labels, ran["ratio"] - 1, left=1, color=colours)
    axes.axvline(1, color="black", linewidth=0.8)
    for y, ratio in enumerate(ran["ratio"]):
        axes.annotate(
            f"{ratio:.3g}", (ratio, y), (4 if ratio >= 1 else -4, 0), textcoords="offset points",
            va="center", ha="left" if ratio >= 1 else "right", fontsize=8,
        )  # fmt: skip
    axes.margins(x=0.15)
    axes.set_title("Blue: ours is faster; red: the peer is")
    figure.savefig(file, dpi=120)


if __name__ == "__main__":
    app()
