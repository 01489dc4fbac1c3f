"""The command line: thin doors to the functions of the library.

Exit codes: 0 done, 1 a result fell short (which, and how, is said), 2 bad use. Heavy packages are
imported inside the commands, so that ``lineup --help`` answers at once.
"""

from __future__ import annotations

import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

if TYPE_CHECKING:
    import pandas as pd

    from .solid import Certificate, Folding, Motion, VoxelSolid

app = typer.Typer(
    help="LineUp: fold one chain of blocks into many shapes, and prove that it unfolds.",
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

Sources = Annotated[
    list[str], typer.Argument(metavar="MODEL_OR_FILE...", help="Names of models or mesh files.")
]
Source = Annotated[
    str, typer.Argument(metavar="MODEL_OR_FILE", help="A model, a mesh or a stored solid.")
]
Out = Annotated[Path, typer.Option(help="Folder to write into; made if it does not exist.")]
Seed = Annotated[int, typer.Option(help="Equal seeds give equal results.")]
Blocks = Annotated[int, typer.Option(help="Blocks of the chain; each is two voxels.")]
Box = Annotated[
    tuple[int, int, int] | None,
    typer.Option(help="Box that a motion from shape to shape stays in, X Y Z in pitches."),
]
Voxels = Annotated[int, typer.Option(help="Voxels to aim at; a stored solid keeps its own.")]
Workers = Annotated[
    int | None, typer.Option(help="Processes at a time; as many as there are cores if not given.")
]

# Typer has a public name for the common base of its usage errors in late versions only.
_UsageError: type[typer.BadParameter] = typer.BadParameter.__bases__[0]

EXPERIMENTS = Path(__file__).parent.parent / "experiments"


def main() -> NoReturn:
    """Entry point of the ``lineup`` command."""
    sys.exit(run(sys.argv[1:]))


def run(args: list[str]) -> int:
    """Run one command line and return its exit code; bad use is one line on stderr."""
    try:
        code: int | None = app(args, prog_name="lineup", standalone_mode=False)
    except _UsageError as error:
        return _bad_use(error.format_message())
    except OSError as error:
        where = f": {error.filename}" if error.filename else ""
        return _bad_use(f"{error.strerror}{where}" if error.strerror else str(error))
    except ValueError as error:
        return _bad_use(str(error))
    if code == 130:
        typer.echo("lineup: interrupted; what was finished is kept", err=True)
    return code or 0


def _bad_use(message: str) -> int:
    typer.echo(f"lineup: error: {' '.join(message.split())}", err=True)
    return 2


@app.callback(invoke_without_command=True)
def _help(context: typer.Context) -> None:
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


@app.command()
def table2(
    quick: Annotated[bool, typer.Option("--quick", help="First set, 200 blocks.")] = False,
    out: Out = Path("results"),
    workers: Workers = None,
) -> None:
    """Reproduce Table 2 of the paper, beside its figures."""
    variant = "quick" if quick else None
    _run_experiment(EXPERIMENTS / "table2.yaml", out, variant, "processes", workers)


@app.command()
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
    from . import tables
    from ._progress import Reporter
    from .storage import write_whole
    from .sweep import read_experiment, run_sweep, tasks

    experiment = read_experiment(file)
    name = file.stem if variant is None else f"{file.stem}-{variant}"
    console = _console()
    todo = tasks(experiment, out / name, variant)
    with Reporter(len(todo), console) as reporter:
        rows = run_sweep(
            experiment,
            out / name,
            variant=variant,
            engine=engine,
            workers=_n_cores() if workers is None else workers,
            progress=lambda task, stage: reporter(task.label, stage),
        )
    if experiment.task == "table2":
        table = tables.table2(rows)
        names = [Path(str(task.settings["model"])).stem for task in todo]
        files = [t.folder / f"{n}.folding.json" for t, n in zip(todo, names, strict=True)]
        written = tables.write_table(table, out, name) + _draw_chains(table, files, out, name)
        console.print(tables.terminal_table(table))
    else:
        table = rows
        written = [write_whole(out / f"{name}.csv", rows.to_csv(index=False))]
    typer.echo(f"written: {', '.join(str(f) for f in written)}")
    _end(_shortfalls(table))


def _draw_chains(table: pd.DataFrame, files: list[Path], out: Path, name: str) -> list[Path]:
    """A sheet of all chains that are certified, and a page with the unfolding of the first.

    `files` has the folding of each row.
    """
    from . import draw
    from .solid import Folding
    from .storage import load

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


@app.command("run")
def run_models(
    models: Sources,
    blocks: Blocks = 754,
    out: Out = Path("out"),
    seed: Seed = 0,
    within: Box = None,
) -> None:
    """Fold one chain into models or meshes of your own, and each of them into each other."""
    from . import tables
    from ._progress import Reporter
    from .pipeline import lineup, transformations
    from .storage import save, write_whole

    names = [Path(_readable(source)).stem for source in models]
    console = _console()
    with Reporter(len(models), console) as reporter:
        design = lineup(
            models,
            blocks=blocks,
            seed=seed,
            ends=2 if within is None else 1,
            folder=out,
            progress=reporter,
        )
    save(design, out)
    table = tables.table2(design.table)
    tables.write_table(table, out, "table")
    _draw_chains(table, [out / f"{name}.folding.json" for name in names], out, "chains")
    console.print(tables.terminal_table(table))
    shortfalls = _shortfalls(table)
    if len(design.foldings) > 1:
        pairs = transformations(design, out / "transformations", within=within, seed=seed)
        write_whole(out / "transformations.csv", pairs.to_csv(index=False))
        typer.echo(f"from shape to shape: {pairs['certified'].sum()} of {len(pairs)} certified")
        bad = pairs[~pairs["certified"]].to_dict("records")
        shortfalls += [f"{row['from']} to {row['to']}: {row['reason']}" for row in bad]
    typer.echo(f"written: {out}")
    _end(shortfalls)


@app.command()
def transform(
    first: Annotated[Path, typer.Argument(metavar="A", help="A stored folding or motion.")],
    second: Annotated[Path, typer.Argument(metavar="B", help="Another one of the same chain.")],
    within: Box = None,
    seed: Seed = 0,
    out: Out = Path("."),
) -> None:
    """Write the motion from one shape to another: A-to-B.motion.json."""
    from . import transformation
    from .judging import certify
    from .storage import save
    from .verification import stored_name

    found = transformation.transform(_moving(first), _moving(second), within=within, seed=seed)
    if found.reason != transformation.DONE:
        _end([found.reason])
    verdict = certify(found, found.diameter, found.max_bend_deg, within=within)
    out.mkdir(parents=True, exist_ok=True)
    name = f"{stored_name(first)}-to-{stored_name(second)}"
    written = save(found, out / f"{name}.motion.json")
    box = " x ".join(f"{side:.0f}" for side in verdict.extent)
    typer.echo(f"{len(found)} moves in a box of {box} pitches, {_told(verdict)}")
    typer.echo(f"written: {written}")
    _end([] if verdict.ok else [_told(verdict)])


@app.command()
def verify(
    places: Annotated[list[Path], typer.Argument(metavar="FILE_OR_FOLDER...")],
    diameter: Annotated[float, typer.Option(help="Bar diameter, in voxels.")] = 0.999,
    max_bend: Annotated[float, typer.Option(help="Largest bend, in degrees.")] = 90.0,
) -> None:
    """Judge stored results anew."""
    from .verification import stored_files, verdicts

    failures = []
    for file in [file for place in places for file in stored_files(place)]:
        for part, verdict in verdicts(file, diameter, max_bend):
            line = f"{file} {part}: {_told(verdict)}"
            typer.echo(f"{'ok   ' if verdict.ok else 'FAILS'} {line}")
            failures += [] if verdict.ok else [line]
    _end(failures)


@app.command()
def models(
    names: Annotated[list[str] | None, typer.Argument(help="Models to fetch; all if none.")] = None,
    fetch: Annotated[bool, typer.Option("--fetch", help="Download the original meshes.")] = False,
) -> None:
    """List the models; --fetch downloads their meshes."""
    from . import catalog

    if fetch:
        for name, file in catalog.fetch(names or None).items():
            typer.echo(f"{name}: {file}")
        return
    table = catalog.models()
    unknown = [name for name in names or [] if name not in set(table["name"])]
    if unknown:
        raise ValueError(f"unknown model {unknown[0]!r}; 'lineup models' lists them all")
    chosen = table[table["name"].isin(names)] if names else table
    typer.echo(chosen.to_string(index=False, justify="left"))


@app.command()
def voxelize(
    source: Source,
    voxels: Voxels = 1600,
    up: Annotated[str | None, typer.Option(help="Direction that becomes up: +x ... -z.")] = None,
    out: Out = Path("."),
) -> None:
    """Write a model or mesh as voxels: NAME.solid.json."""
    from .storage import save

    solid = _solid(source, voxels, up)
    out.mkdir(parents=True, exist_ok=True)
    file = save(solid, out / f"{solid.name}.solid.json")
    for name, value in solid.source.items():
        typer.echo(f"{name}: {value}")
    typer.echo(f"{solid.size} voxels in a grid of {' x '.join(map(str, solid.occupancy.shape))}")
    typer.echo(f"written: {file}")


@app.command()
def path(
    source: Source,
    voxels: Voxels = 1600,
    method: Annotated[str, typer.Option(help="How to build the path.")] = "layered",
    seed: Seed = 0,
    out: Out = Path("."),
) -> None:
    """Write a long path through a solid: NAME.path.json."""
    from .judging import certify_path
    from .layered import layered_path
    from .storage import save

    solid = _solid(source, voxels)
    found = layered_path(solid, method=method, seed=seed)
    verdict = certify_path(found, solid)
    out.mkdir(parents=True, exist_ok=True)
    save(solid, out / f"{solid.name}.solid.json")
    file = save(found, out / f"{solid.name}.path.json")
    typer.echo(f"{len(found)} of {solid.size} voxels ({found.coverage(solid):.3f})")
    typer.echo(f"written: {file}")
    _end([] if verdict.ok else [_told(verdict)])


@app.command()
def unfold(
    file: Annotated[Path, typer.Argument(help="A stored path, NAME.path.json.")],
    method: Annotated[str, typer.Option(help="How to plan the motion.")] = "auto",
    seed: Seed = 0,
    out: Out = Path("."),
) -> None:
    """Write a motion that straightens it: NAME.folding.json."""
    from . import motion
    from .judging import certify
    from .solid import Folding, VoxelPath
    from .storage import load, save
    from .verification import stored_name

    stored = load(file)
    if not isinstance(stored, VoxelPath):
        raise ValueError(f"{file} holds a {type(stored).__name__}, and a path is needed")
    found = motion.unfold(stored, method=method, seed=seed)
    verdict = certify(found, found.diameter, found.max_bend_deg)
    out.mkdir(parents=True, exist_ok=True)
    name = stored_name(file)
    written = save(Folding(stored, found), out / f"{name}.folding.json")
    typer.echo(f"{len(found)} moves, {_told(verdict)}")
    typer.echo(f"written: {written}")
    _end([] if verdict.ok else [f"{name}: {found.reason}"])


def _moving(file: Path) -> Folding | Motion:
    from .solid import Folding, Motion
    from .storage import load

    stored = load(file)
    if not isinstance(stored, (Folding, Motion)):
        raise ValueError(f"{file} holds a {type(stored).__name__}, and a folding is needed")
    return stored


def _known(source: str) -> str:
    """A source as given, once it is clear that it names a file or a model."""
    from .catalog import models

    if not Path(source).is_file():
        if Path(source).suffix or len(Path(source).parts) > 1:
            raise FileNotFoundError(f"no file {source}")
        if source not in set(models()["name"]):
            raise ValueError(f"no file and no model {source!r}; 'lineup models' lists the models")
    return source


def _readable(source: str) -> str:
    """A source as given, once it is clear that it is a model or a file with a good mesh."""
    from .meshes import read_surface

    if Path(_known(source)).is_file():
        read_surface(Path(source))
    return source


def _solid(source: str, voxels: int, up: str | None = None) -> VoxelSolid:
    """The solid stored in a file, or that of a mesh file or a model of the catalogue."""
    from . import catalog, voxelization
    from .solid import VoxelSolid
    from .storage import load
    from .verification import stored_name

    if not Path(_known(source)).is_file():
        return catalog.model(source, voxels, up)
    if not source.endswith(".json"):
        return voxelization.voxelize(source, voxels, up or "+z")
    stored = load(source)
    if not isinstance(stored, VoxelSolid):
        raise ValueError(f"{source} holds a {type(stored).__name__}, and a solid is needed")
    if up is not None:
        raise ValueError(f"{source} is made of voxels already, and cannot be turned by --up {up}")
    return stored if stored.name else replace(stored, name=stored_name(Path(source)))


def _told(verdict: Certificate) -> str:
    """A verdict in words."""
    if not verdict.ok:
        return verdict.reason + (f" (at {verdict.where})" if verdict.where >= 0 else "")
    if not verdict.moves_checked:
        return verdict.reason
    return (
        f"{verdict.reason} (diameter {verdict.diameter:g}, bends up to {verdict.bend_deg:.0f}°, "
        f"clearance {verdict.clearance:.4f}, {verdict.moves_checked} moves)"
    )


def _shortfalls(table: pd.DataFrame) -> list[str]:
    rows = table[table["failure"] != ""].to_dict("records")
    return [f"{row.get('model', 'a task')}: {row['failure']}" for row in rows]


def _end(lines: list[str]) -> None:
    """Say what fell short and end with exit code 1, if anything did."""
    for line in lines:
        typer.echo(f"falls short: {line}", err=True)
    if lines:
        raise typer.Exit(1)


def _console() -> Any:
    from rich.console import Console

    console = Console()
    # A log has no width of its own, and the table must not be folded to 80 columns there.
    return console if console.is_terminal else Console(width=120)


def _n_cores() -> int:
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1
