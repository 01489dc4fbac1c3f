"""From meshes to chains, and from shape to shape."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from ._common import (
    Blocks,
    Box,
    Joints,
    Out,
    Seed,
    Source,
    Sources,
    Voxels,
    console,
    end,
    motion_in,
    readable,
    shortfalls,
    solid_of,
    told,
)
from .experiments import draw_chains


def run_models(
    models: Sources,
    blocks: Blocks = 754,
    out: Out = Path("out"),
    seed: Seed = 0,
    within: Box = None,
    joints: Joints = "free",
) -> None:
    """Fold one chain into models or meshes of your own, and each of them into each other."""
    from .. import tables
    from .._progress import Reporter
    from ..pipeline import lineup, transformations
    from ..storage import save, write_whole

    names = [Path(readable(source)).stem for source in models]
    screen = console()
    with Reporter(len(models), screen) as reporter:
        design = lineup(
            models,
            blocks=blocks,
            seed=seed,
            ends=2 if within is None else 1,
            joints=joints,
            folder=out,
            progress=reporter,
        )
    save(design, out)
    table = tables.table2(design.table)
    tables.write_table(table, out, "table")
    draw_chains(table, [out / f"{name}.folding.json" for name in names], out, "chains")
    screen.print(tables.terminal_table(table))
    short = shortfalls(table)
    if len(design.foldings) > 1:
        pairs = transformations(design, out / "transformations", within=within, seed=seed)
        write_whole(out / "transformations.csv", pairs.to_csv(index=False))
        typer.echo(f"from shape to shape: {pairs['certified'].sum()} of {len(pairs)} certified")
        bad = pairs[~pairs["certified"]].to_dict("records")
        short += [f"{row['from']} to {row['to']}: {row['reason']}" for row in bad]
    typer.echo(f"written: {out}")
    end(short)


def transform(
    first: Annotated[Path, typer.Argument(metavar="A", help="A stored folding or motion.")],
    second: Annotated[Path, typer.Argument(metavar="B", help="Another one of the same chain.")],
    within: Box = None,
    seed: Seed = 0,
    out: Out = Path("."),
) -> None:
    """Write the motion from one shape to another: A-to-B.motion.json."""
    from .. import transformation
    from ..judging import certify
    from ..storage import save
    from ..verification import stored_name

    found = transformation.transform(motion_in(first), motion_in(second), within=within, seed=seed)
    if found.reason != transformation.DONE:
        end([found.reason])
    verdict = certify(found, found.diameter, found.max_bend_deg, within=within)
    out.mkdir(parents=True, exist_ok=True)
    name = f"{stored_name(first)}-to-{stored_name(second)}"
    written = save(found, out / f"{name}.motion.json")
    box = " x ".join(f"{side:.0f}" for side in verdict.extent)
    typer.echo(f"{len(found)} moves in a box of {box} pitches, {told(verdict)}")
    typer.echo(f"written: {written}")
    end([] if verdict.ok else [told(verdict)])


def verify(
    places: Annotated[list[Path], typer.Argument(metavar="FILE_OR_FOLDER...")],
    diameter: Annotated[
        float | None, typer.Option(help="Bar diameter, in voxels; else what each motion claims.")
    ] = None,
    max_bend: Annotated[
        float | None, typer.Option(help="Largest bend, in degrees; else what each motion claims.")
    ] = None,
) -> None:
    """Judge stored results anew."""
    from ..judging import check_limits
    from ..verification import stored_files

    check_limits(diameter, max_bend)
    failures = []
    for file in [file for place in places for file in stored_files(place)]:
        for ok, line in _verified(file, diameter, max_bend, alone=places == [file]):
            typer.echo(f"{'ok   ' if ok else 'FAILS'} {line}")
            failures += [] if ok else [line]
    end(failures)


def _verified(
    file: Path, diameter: float | None, max_bend: float | None, alone: bool
) -> Iterator[tuple[bool, str]]:
    """What to say of each part of a file; among others, one that cannot be read just fails."""
    from ..verification import verdicts

    parts = verdicts(file, diameter, max_bend)
    try:
        for part, verdict in parts:
            yield verdict.ok, f"{file} {part}: {told(verdict)}"
    except (OSError, ValueError) as error:
        if alone:
            raise
        fault = str(error)
        yield False, fault if fault.startswith(str(file)) else f"{file}: {fault}"


def models(
    names: Annotated[list[str] | None, typer.Argument(help="Models to fetch; all if none.")] = None,
    fetch: Annotated[bool, typer.Option("--fetch", help="Download the original meshes.")] = False,
) -> None:
    """List the models; --fetch downloads their meshes."""
    from .. import catalog

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


def voxelize(
    source: Source,
    voxels: Voxels = 1600,
    up: Annotated[str | None, typer.Option(help="Direction that becomes up: +x ... -z.")] = None,
    shell: Annotated[
        int | None, typer.Option(help="Thickness of a vented shell of so many voxels instead.")
    ] = None,
    out: Out = Path("."),
) -> None:
    """Write a model or mesh as voxels: NAME.solid.json."""
    from ..storage import save

    solid = solid_of(source, voxels, up, shell)
    out.mkdir(parents=True, exist_ok=True)
    file = save(solid, out / f"{solid.name}.solid.json")
    for name, value in solid.source.items():
        typer.echo(f"{name}: {value}")
    typer.echo(f"{solid.size} voxels in a grid of {' x '.join(map(str, solid.occupancy.shape))}")
    typer.echo(f"written: {file}")


def path(
    source: Source,
    voxels: Voxels = 1600,
    method: Annotated[str, typer.Option(help="How to build the path.")] = "layered",
    seed: Seed = 0,
    out: Out = Path("."),
) -> None:
    """Write a long path through a solid: NAME.path.json."""
    from ..judging import certify_path
    from ..layered import layered_path
    from ..storage import save

    solid = solid_of(source, voxels)
    found = layered_path(solid, method=method, seed=seed)
    verdict = certify_path(found, solid)
    out.mkdir(parents=True, exist_ok=True)
    save(solid, out / f"{solid.name}.solid.json")
    file = save(found, out / f"{solid.name}.path.json")
    typer.echo(f"{len(found)} of {solid.size} voxels ({found.coverage(solid):.3f})")
    typer.echo(f"written: {file}")
    end([] if verdict.ok else [told(verdict)])


def unfold(
    file: Annotated[Path, typer.Argument(help="A stored path, NAME.path.json.")],
    method: Annotated[str, typer.Option(help="How to plan the motion.")] = "auto",
    seed: Seed = 0,
    joints: Joints = "free",
    out: Out = Path("."),
) -> None:
    """Write a motion that straightens it: NAME.folding.json."""
    from .. import motion
    from ..judging import certify
    from ..solid import Folding, VoxelPath
    from ..storage import load, save
    from ..verification import stored_name

    stored = load(file)
    if not isinstance(stored, VoxelPath):
        raise ValueError(f"{file} holds a {type(stored).__name__}, and a path is needed")
    options = {} if joints == "free" else {"joints": joints}
    found = motion.unfold(stored, method=method, seed=seed, **options)
    verdict = certify(found, found.diameter, found.max_bend_deg, joints=joints)
    out.mkdir(parents=True, exist_ok=True)
    name = stored_name(file)
    written = save(Folding(stored, found), out / f"{name}.folding.json")
    typer.echo(f"{len(found)} moves, {told(verdict)}")
    typer.echo(f"written: {written}")
    end([] if verdict.ok else [f"{name}: {found.reason}"])
