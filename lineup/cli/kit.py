"""From one model to all that it takes to print, fold and show it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated

import typer

from ._common import Blocks, Out, Seed, Source, readable
from .chains import run_models
from .manual import manual
from .playing import play
from .printing import print_chain
from .strength import strength


def kit(
    model: Source,
    blocks: Blocks = 150,
    pitch_mm: Annotated[float, typer.Option(help="Edge of a voxel, in mm.")] = 10.0,
    out: Out = Path("kit"),
    seed: Seed = 0,
) -> None:
    """Fold a model, and write print files, manual, strength report and player of its chain."""
    file = out / f"{Path(readable(model)).stem}.folding.json"
    fell_short = False
    for step in _steps(model, file, blocks, pitch_mm, out, seed):
        try:
            step()
        except typer.Exit:  # what fell short is said, and the rest may still be of use
            fell_short = True
        if not file.is_file():
            break
    if fell_short:
        raise typer.Exit(1)


def _steps(
    model: str, file: Path, blocks: int, pitch_mm: float, out: Path, seed: int
) -> Iterator[Callable[[], None]]:
    yield lambda: run_models([model], blocks=blocks, out=out, seed=seed, joints="slotted")
    yield lambda: print_chain(file, pitch_mm=pitch_mm, out=out / "print")
    yield lambda: manual(file, pitch_mm=pitch_mm, out=out)
    yield lambda: strength(file, pitch_mm=pitch_mm, through=12, out=out)
    yield lambda: play([file], out=out)
