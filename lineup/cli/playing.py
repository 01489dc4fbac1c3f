"""Motions to be looked at."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ._common import Out, end, motion_in, told


def play(
    files: Annotated[
        list[Path], typer.Argument(metavar="FILE...", help="Stored foldings or motions.")
    ],
    out: Out = Path("."),
) -> None:
    """Judge motions and write their player: NAME.html, for any browser, offline."""
    from ..judging import certify
    from ..solid import Folding
    from ..verification import stored_name
    from ..viewer import write_player

    short = []
    for file in files:
        stored = motion_in(file)
        motion = stored.motion if isinstance(stored, Folding) else stored
        verdict = certify(motion, motion.diameter, motion.max_bend_deg)
        out.mkdir(parents=True, exist_ok=True)
        name = stored_name(file)
        called = name.replace("-to-", " to ")
        written = write_player(stored, out / f"{name}.html", certificate=verdict, name=called)
        typer.echo(f"{len(motion)} moves, {told(verdict)}")
        typer.echo(f"written: {written}")
        short += [] if verdict.ok else [f"{name}: {told(verdict)}"]
    end(short)
