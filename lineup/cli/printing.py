"""From a chain to files for a printer."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ._common import Out, end

if TYPE_CHECKING:
    from ..solid import Design, Folding, VoxelPath


Pitch = Annotated[float, typer.Option(help="Edge of a voxel, in mm.")]
Block = Annotated[str, typer.Option(help="standard, pull or pull120.")]
Clearance = Annotated[float | None, typer.Option(help="Between what moves; the coupon tells.")]
Snap = Annotated[float | None, typer.Option(help="Of each side of a neck; the coupon tells.")]
Bed = Annotated[tuple[float, float], typer.Option(help="The printer's bed, X Y in mm.")]
Layers = Annotated[int, typer.Option(help="Layers of a flat chain.")]
Pose = Annotated[str, typer.Option(help="flat, or folded as the path lies.")]
WholeStl = Annotated[bool, typer.Option("--whole-stl", help="The chain as STL, too: 170 MB.")]


def print_chain(
    file: Annotated[Path, typer.Argument(help="A stored path, folding or design.")],
    pitch_mm: Pitch = 10.0,
    block: Block = "standard",
    clearance_mm: Clearance = None,
    snap_mm: Snap = None,
    bed: Bed = (250.0, 250.0),
    layers: Layers = 1,
    pose: Pose = "flat",
    whole_stl: WholeStl = False,
    out: Out = Path("print"),
) -> None:
    """Write 3MF and STL files of a chain, a coupon, and a bill of materials."""
    from ..block import named_block
    from ..fabrication import export_print

    told = {"clearance_mm": clearance_mm, "snap_mm": snap_mm}
    measures = {name: value for name, value in told.items() if value is not None}
    made = export_print(
        _chain_in(file),
        out,
        pitch_mm,
        block=named_block(block, pitch_mm, **measures),
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
