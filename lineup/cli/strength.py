"""Does a folded model bear its own weight?"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ._common import Out, end

if TYPE_CHECKING:
    import pandas as pd

    from ..solid import Folding, VoxelPath, VoxelSolid


def strength(
    file: Annotated[Path, typer.Argument(help="A stored folding or path.")],
    pitch_mm: Annotated[float, typer.Option(help="Edge length of a voxel of the path.")] = 10.0,
    up: Annotated[str, typer.Option(help="Direction against gravity, +x ... -z.")] = "+z",
    bonding: Annotated[str, typer.Option(help="velcro, none, chain or solid.")] = "velcro",
    density: Annotated[float, typer.Option(help="Of a full block, kg/m³.")] = 1130.0,
    through: Annotated[int, typer.Option(help="Poses of the motion to look at, too.")] = 0,
    manual: Annotated[
        Path | None, typer.Option(help="NAME.manual.json: the poses after its steps.")
    ] = None,
    out: Out = Path("."),
) -> None:
    """Write what each face bears under the model's own weight: NAME.strength.csv, .md, .png.

    With --through or --manual, whether it stands while it is folded: NAME.standing.csv, .md, .png.
    """
    from .. import draw, stress
    from ..manual import standing_by_step
    from ..solid import Folding
    from ..stress.results import shortfall, summary
    from ..verification import stored_name

    shape, solid = _shape_of(file, through > 0)
    found = stress.strength(shape, solid, pitch_mm, density=density, bonding=bonding, up=up)
    name = stored_name(file)
    result = replace(found, name=name)
    row = summary(result)
    for key, value in row.items():
        typer.echo(f"{key}: {_shown(value)}")
    out.mkdir(parents=True, exist_ok=True)
    written = _written(result.table, out / f"{name}.strength", row)
    if result.stands:
        written.append(draw.save(draw.strength(result), out / f"{name}.strength.png"))
    table = None
    if manual:
        table = standing_by_step(manual, pitch_mm, density=density, bonding=bonding)
    elif isinstance(shape, Folding) and through > 0:
        table = stress.standing(shape, through, pitch_mm, density=density, bonding=bonding, up=up)
    if table is not None:
        written += _stood(table, out / f"{name}.standing")
    for place in written:
        typer.echo(f"written: {place}")
    fault = shortfall(result)
    end([f"{name}: {fault}"] if fault else [])


def _stood(table: pd.DataFrame, stem: Path) -> list[Path]:
    """How it stands while it is folded, said and written as STEM.csv, .md and .png."""
    from .. import draw

    some = table[table["folded"] > 0]
    typer.echo(f"while folded: stands at {int(some['stands'].sum())} of {len(some)} moments")
    written = _written(table, stem)
    return [*written, draw.save(draw.standing(table), stem.with_name(f"{stem.name}.png"))]


def _written(table: pd.DataFrame, stem: Path, row: dict[str, Any] | None = None) -> list[Path]:
    """The table as STEM.csv, and it, or the one row that it comes to, as STEM.md.

    What is a millionth of the largest number in its column is rounded away, so that the last bits
    of a solver are in no file.
    """
    import pandas as pd

    from ..storage import write_whole
    from ..stress.results import rounded

    table = rounded(table)
    page = table
    if row is not None:
        shown = {key: _shown(value) for key, value in row.items() if key != "residual"}
        page = pd.DataFrame({"quantity": list(shown), "value": list(shown.values())})
    texts = {
        "csv": table.to_csv(index=False),
        "md": f"{page.to_markdown(index=False, floatfmt='.4g')}\n",
    }
    return [write_whole(stem.with_name(f"{stem.name}.{kind}"), texts[kind]) for kind in texts]


def _shape_of(file: Path, moves: bool) -> tuple[Folding | VoxelPath, VoxelSolid | None]:
    """The folding or path in a file, and the solid stored beside it, if there is one."""
    from ..solid import Folding, VoxelPath, VoxelSolid
    from ..storage import load
    from ..verification import stored_name

    shape = load(file)
    if not isinstance(shape, (Folding, VoxelPath)):
        raise ValueError(f"{file} holds a {type(shape).__name__}, and a folding or path is needed")
    if moves and not isinstance(shape, Folding):
        raise ValueError(f"{file} holds a path, and --through needs a folding")
    beside = file.with_name(f"{stored_name(file)}.solid.json")
    solid = load(beside) if beside.is_file() else None
    if solid is not None and not isinstance(solid, VoxelSolid):
        raise ValueError(f"{beside} does not hold a solid")
    return shape, solid


def _shown(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
