"""Experiments: Table 2, and sweeps of one's own."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ._common import Out, Workers, console, end, n_cores, shortfalls

if TYPE_CHECKING:
    import pandas as pd

EXPERIMENTS = Path(__file__).parents[2] / "experiments"


def table2(
    quick: Annotated[bool, typer.Option("--quick", help="First set, 200 blocks.")] = False,
    out: Out = Path("results"),
    workers: Workers = None,
) -> None:
    """Reproduce Table 2 of the paper, beside its figures."""
    variant = "quick" if quick else None
    _run_experiment(EXPERIMENTS / "table2.yaml", out, variant, "processes", workers)


def sweep(
    config: Annotated[Path, typer.Argument(help="An experiment file (experiments/FORMAT.md).")],
    out: Out = Path("results"),
    variant: Annotated[str | None, typer.Option(help="A variant that the file defines.")] = None,
    engine: Annotated[str, typer.Option(help="serial or processes.")] = "processes",
    workers: Workers = None,
) -> None:
    """Run an experiment file, or what is left of it."""
    _run_experiment(config, out, variant, engine, workers)


def _run_experiment(
    file: Path, out: Path, variant: str | None, engine: str, workers: int | None
) -> None:
    from .. import tables
    from .._progress import Reporter
    from ..storage import write_whole
    from ..sweep import read_experiment, run_sweep, tasks

    experiment = read_experiment(file)
    name = file.stem if variant is None else f"{file.stem}-{variant}"
    screen = console()
    todo = tasks(experiment, out / name, variant)
    with Reporter(len(todo), screen) as reporter:
        rows = run_sweep(
            experiment,
            out / name,
            variant=variant,
            engine=engine,
            workers=n_cores() if workers is None else workers,
            progress=lambda task, stage: reporter(task.label, stage),
        )
    if experiment.task == "table2":
        table = tables.table2(rows)
        names = [Path(str(task.settings["model"])).stem for task in todo]
        files = [t.folder / f"{n}.folding.json" for t, n in zip(todo, names, strict=True)]
        written = tables.write_table(table, out, name) + draw_chains(table, files, out, name)
        screen.print(tables.terminal_table(table))
    else:
        table = rows
        written = [write_whole(out / f"{name}.csv", rows.to_csv(index=False))]
    typer.echo(f"written: {', '.join(str(f) for f in written)}")
    end(shortfalls(table))


def draw_chains(table: pd.DataFrame, files: list[Path], out: Path, name: str) -> list[Path]:
    """A sheet of all chains that are certified, and a page with the unfolding of the first.

    `files` has the folding of each row.
    """
    from .. import draw
    from ..solid import Folding
    from ..storage import load

    good = (table["failure"] == "").tolist()
    rows = table[good].to_dict("records")
    if not rows:
        return []
    stored = [load(file) for file, is_good in zip(files, good, strict=True) if is_good]
    chains = [folding for folding in stored if isinstance(folding, Folding)]
    captions = [
        f"{row['model'].replace('_', ' ')}\n{row['length']:,.0f} of {row['voxels']:,.0f} voxels"
        for row in rows
    ]
    return [
        draw.save(draw.contact_sheet(chains, captions), out / f"{name}.png"),
        draw.save(draw.unfolding(chains[0]), out / f"{name}-unfolding.png"),
    ]
