"""The operation manual of a stored folding."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ._common import Out, end, motion_in


def manual(
    file: Annotated[Path, typer.Argument(help="A stored folding, NAME.folding.json.")],
    paper: Annotated[str, typer.Option(help="a4 or letter.")] = "a4",
    pitch_mm: Annotated[
        float, typer.Option(help="Edge of a printed voxel, in millimetres.")
    ] = 10.0,
    out: Out = Path("."),
) -> None:
    """Write how to fold it by hand: NAME.manual.pdf to print, and the same as .json and .csv."""
    import json

    from ..manual import write_manual
    from ..solid import Folding, VoxelPath
    from ..verification import stored_name

    stored = motion_in(file)
    folding = stored if isinstance(stored, Folding) else Folding(VoxelPath(stored.start), stored)
    files = write_manual(folding, out, name=stored_name(file), paper=paper, pitch_mm=pitch_mm)
    written = json.loads(files.json.read_text(encoding="utf-8"))
    verdict, grade = written["verdict"], written["grade"]
    typer.echo(
        f"{written['blocks']} blocks in {len(written['steps'])} steps, difficulty "
        f"{grade['grade']} of 5, about {grade['minutes']} minutes (assumed), {verdict['reason']}"
    )
    for path in files:
        typer.echo(f"written: {path}")
    end([] if verdict["ok"] else [f"not certified: {verdict['reason']}"])
