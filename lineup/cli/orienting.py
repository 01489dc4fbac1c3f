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

    weights = {}
    for given in weight or []:
        name, _, value = given.partition("=")
        try:
            weights[name] = float(value)
        except ValueError:
            raise ValueError(f"a weight is given as NAME=VALUE, got {given!r}") from None
    with Reporter(evaluations + finalists, console()) as reporter:
        table = rank_orientations(
            readable(model),
            voxels,
            evaluations=evaluations,
            finalists=finalists,
            weights=weights,
            seed=seed,
            progress=reporter,
        )
    stem = out / Path(model).stem
    out.mkdir(parents=True, exist_ok=True)
    csv = stem.with_name(f"{stem.name}.orientations.csv")
    write_whole(csv, table.to_csv(index=False))
    written = [csv]
    if (table["reason"] == "ok").any():
        picture = stem.with_name(f"{stem.name}.orientations.png")
        written.append(draw.save(draw.orientations(table), picture))
        best = table.iloc[0]
        up = ", ".join(f"{best[f'up_{axis}']:.3f}" for axis in "xyz")
        typer.echo(f"best: up ({up}), {best['kind']}, score {best['score']:.3f}")
    for file in written:
        typer.echo(f"written: {file}")
    failed = table[table["reason"] != "ok"]
    end([f"no orientation has a solid: {failed['reason'].iloc[0]}"] if len(written) == 1 else [])
