"""Experiments: Table 2, and sweeps of one's own."""

from __future__ import annotations

from glob import escape
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ._common import Out, Workers, console, end, n_cores, shortfalls

if TYPE_CHECKING:
    import pandas as pd

    from ..experiment import Experiment, Task

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
    engine: Annotated[str, typer.Option(help="serial, processes or dask.")] = "processes",
    workers: Workers = None,
    scheduler: Annotated[
        str | None, typer.Option(help="Address of the scheduler of a Dask cluster.")
    ] = None,
) -> None:
    """Run an experiment file, or what is left of it."""
    _run_experiment(config, out, variant, engine, workers, scheduler)


def _run_experiment(
    file: Path,
    out: Path,
    variant: str | None,
    engine: str,
    workers: int | None,
    scheduler: str | None = None,
) -> None:
    from .._files import clear, plain_name
    from .._progress import Reporter
    from ..experiment import read_experiment, tasks
    from ..sweep import run_sweep

    experiment = read_experiment(file)
    name = plain_name(file.stem if variant is None else f"{file.stem}-{variant}")
    screen = console()
    todo = tasks(experiment, out / name, variant)
    with Reporter(len(todo), screen) as reporter:
        rows = run_sweep(
            experiment,
            out / name,
            variant=variant,
            engine=engine,
            workers=n_cores() if workers is None else workers,
            scheduler=scheduler,
            progress=lambda task, stage: reporter(task.label, stage),
        )
    clear(out, f"{escape(name)}*")
    write = _write_table2 if experiment.task == "table2" else _write_rows
    table, view, written = write(rows, todo, experiment, out, name)
    screen.print(view)
    typer.echo(f"written: {', '.join(str(f) for f in written)}")
    end(shortfalls(table))


def _write_table2(
    rows: pd.DataFrame, done: list[Task], experiment: Experiment, out: Path, name: str
) -> tuple[pd.DataFrame, Any, list[Path]]:
    """The table beside the paper's, for the screen too, and the files written."""
    from .. import tables

    table = tables.table2(rows)
    names = [Path(str(task.settings["model"])).stem for task in done]
    files = [t.folder / f"{n}.folding.json" for t, n in zip(done, names, strict=True)]
    written = tables.write_table(table, out, name) + draw_chains(table, files, out, name)
    return table, tables.terminal_table(table), written


def _write_rows(
    rows: pd.DataFrame, done: list[Task], experiment: Experiment, out: Path, name: str
) -> tuple[pd.DataFrame, Any, list[Path]]:
    """The rows, the table for the screen, and the files written."""
    from .. import draw, styled
    from ..storage import write_whole
    from ..sweep import seconds

    written = styled.write_rows(rows, out, name, experiment)
    if experiment.plot:
        figure = draw.experiment(rows, experiment.plot, experiment.title)
        written.append(draw.save(figure, out / f"{name}.png"))
    times = seconds(done).to_csv(index=False, lineterminator="\n")
    written.append(write_whole(out / f"{name}-seconds.csv", times))
    return rows, styled.terminal(rows, experiment), written


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
