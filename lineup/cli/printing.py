"""From a chain to files for a printer."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ._common import Out, end

if TYPE_CHECKING:
    from ..solid import Design, Folding, VoxelPath


def print_chain(
    file: Annotated[Path, typer.Argument(help="A stored path, folding or design.")],
    pitch_mm: Annotated[float, typer.Option(help="Edge of a voxel, in mm.")] = 10.0,
    block: Annotated[str, typer.Option(help="standard, pull or pull120.")] = "standard",
    bed: Annotated[tuple[float, float], typer.Option(help="The printer's bed, X Y in mm.")] = (
        250.0,
        250.0,
    ),
    layers: Annotated[int, typer.Option(help="Layers of a flat chain.")] = 1,
    pose: Annotated[str, typer.Option(help="flat, or folded as the path lies.")] = "flat",
    whole_stl: Annotated[
        bool, typer.Option("--whole-stl", help="Write the chain as STL, too; that is large.")
    ] = False,
    out: Out = Path("print"),
) -> None:
    """Write 3MF and STL files of a chain, a coupon, and a bill of materials."""
    from ..fabrication import export_print

    made = export_print(
        _chain_in(file),
        out,
        pitch_mm,
        block=block,
        bed_mm=bed,
        layers=layers,
        pose=pose,
        whole_stl=whole_stl,
    )
    total = made.bill.iloc[-1]
    n = len(made.plates)
    typer.echo(
        f"{made.plates[-1].stop} blocks on {n} plate{'s' * (n > 1)}, {total['count']} pieces: "
        f"{total['grams']:.0f} g, about {total['hours']:.0f} h (see parts.md)"
    )
    typer.echo(f"block: {made.report.reason}, least gap {made.report.gap_mm:.3f} mm")
    typer.echo(f"written: {out}")
    end(list(made.notes))


def _chain_in(file: Path) -> VoxelPath | Folding | Design:
    from ..solid import Design, Folding, VoxelPath
    from ..storage import load

    stored = load(file)
    if not isinstance(stored, (VoxelPath, Folding, Design)):
        raise ValueError(
            f"{file} holds a {type(stored).__name__}, and a path, folding or design is needed"
        )
    return stored
