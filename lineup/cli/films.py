"""Films of motions."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ._common import Out, motion_in


def animate(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A stored folding or motion.")],
    kind: Annotated[
        str, typer.Option("--format", help="gif, or mp4 (takes the extra 'video').")
    ] = "gif",
    seconds: Annotated[float, typer.Option(help="How long the film runs.")] = 10.0,
    pictures: Annotated[
        int | None, typer.Option(help="How many; 6 a second for gif, 24 for mp4 if not given.")
    ] = None,
    out: Out = Path("."),
) -> None:
    """Write a film of an unfolding, or of the way from shape to shape: NAME.gif."""
    from .. import draw
    from .._files import plain_name
    from ..verification import stored_name

    name = plain_name(f"{stored_name(file)}.{kind}")
    written = draw.animation(motion_in(file), out / name, pictures, seconds)
    typer.echo(f"written: {written}")
