"""Which way up?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ._common import Out, Seed, Source, Voxels, console, end, readable


def orient(
    model: Source,
    voxels: Voxels = 1600,
    evaluations: Annotated[int, typer.Option(help="Orientations to try.")] = 40,
    finalists: Annotated[int, typer.Option(help="Of these, to fold and judge.")] = 5,
    weight: Annotated[
        list[str] | None, typer.Option(help="NAME=VALUE in the objective, as iou=2.")
    ] = None,
    seed: Seed = 0,
    out: Out = Path("."),
) -> None:
    """Rank the orientations of a model: NAME.orientations.csv and .png."""
    from .. import draw
    from .._progress import Reporter
    from ..orientation import rank_orientations
    from ..storage import write_whole

    with Reporter(evaluations + finalists, console()) as reporter:
        table = rank_orientations(
            readable(model),
            voxels,
            evaluations=evaluations,
            finalists=finalists,
            weights=_weights(weight or []),
            seed=seed,
            progress=reporter,
        )
    stem = out / f"{Path(model).stem}.orientations"
    out.mkdir(parents=True, exist_ok=True)
    written = [write_whole(stem.with_name(f"{stem.name}.csv"), table.to_csv(index=False))]
    best = table.iloc[0]
    if best["reason"] == "ok":
        picture = stem.with_name(f"{stem.name}.png")
        written.append(draw.save(draw.orientations(table), picture))
        up = ", ".join(f"{best[f'up_{axis}']:.3f}" for axis in "xyz")
        typer.echo(f"best: up ({up}), {best['kind']}, score {best['score']:.3f}")
    for file in written:
        typer.echo(f"written: {file}")
    end([] if best["reason"] == "ok" else [f"no orientation has a solid: {best['reason']}"])


def _weights(given: list[str]) -> dict[str, float]:
    """Weights given as NAME=VALUE."""
    weights = {}
    for text in given:
        name, _, value = text.partition("=")
        try:
            weights[name] = float(value)
        except ValueError:
            raise ValueError(f"a weight is given as NAME=VALUE, got {text!r}") from None
    return weights
