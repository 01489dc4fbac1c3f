"""The JSON form of a manual: what stands at its head, its steps, and its rows (docs/formats.md)."""

from __future__ import annotations

import csv
import io
import json
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, FiniteFloat
from pydantic_core import PydanticCustomError

from .. import grid
from ..solid import Certificate
from ..storage import List, plain
from .actions import ENDS
from .assembly import Assembly
from .grade import grade_of
from .rows import BlockRow, Count, Whole, rows_of
from .stretches import stretches

Place = tuple[Count, Count, Count]

VERSION = 2
READS = f"this program reads version {VERSION} of lineup-manual; write the manual anew"


def _of_this_version(version: int) -> int:
    if version != VERSION:
        raise PydanticCustomError("version", f"{version}, and {READS}")
    return version


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, hide_input_in_errors=True)


class StretchRow(_Part):
    """Blocks that one end lays without a break, after the loose ends have swung."""

    swings: List[str]
    end: Annotated[str, Field(pattern="^(head|tail)$")]
    first_block: Count
    last_block: Count
    loose: Annotated[str, Field(pattern="^[ENUWSD]$")]
    voxels: Count


class StepRow(_Part):
    """One step: a page of the booklet."""

    step: Count
    stretches: List[StretchRow]
    layers: List[Count]
    voxels: Count
    last_block: Count
    last_place: Place
    voxels_in_place: Count
    size: Place
    moves: Count


class VerdictRow(_Part):
    """What the judge says of the motion."""

    ok: bool
    joints: Annotated[str, Field(pattern="^(free|slotted)$")]
    reason: str
    where: Whole
    clearance: FiniteFloat | Literal["inf"] | None
    bend_deg: FiniteFloat | None
    moves_checked: Count


class BuildRow(_Part):
    """How the model lies while it is folded: which side is down, and where its origin is."""

    down: Annotated[str, Field(pattern="^[DUNSEW]$")]
    shift: tuple[Whole, Whole, Whole]


class Document(_Part):
    """The whole of a manual."""

    format: Literal["lineup-manual"] = "lineup-manual"
    version: Annotated[int, AfterValidator(_of_this_version)] = VERSION
    model: str
    voxels: Count
    blocks: Count
    origin: tuple[Whole, Whole, Whole]
    frame: Annotated[str, Field(pattern="^[ENUWSD]{3}$")]
    word: str
    diameter: FiniteFloat
    max_bend_deg: FiniteFloat
    verdict: VerdictRow
    build: BuildRow
    base: tuple[Place, Place]
    grade: dict[str, Count]
    steps: List[StepRow]
    rows: List[BlockRow]


def document_of(assembly: Assembly, verdict: Certificate, model: str) -> Document:
    """The document of an assembly; the verdict is for the joints that its motion asks for."""
    motion, word = assembly.folding.motion, assembly.word
    names = [name for name in VerdictRow.model_fields if name != "joints"]
    fields = plain({name: getattr(verdict, name) for name in names})
    a, b = assembly.base
    return Document(
        model=model,
        voxels=len(assembly.places),
        blocks=assembly.n_blocks,
        origin=_three(word.origin),
        frame="".join(
            grid.LETTERS[int(np.flatnonzero((axis == grid.DIRECTIONS).all(axis=1))[0])]
            for axis in word.frame.T
        ),
        word=word.letters,
        diameter=float(motion.diameter),
        max_bend_deg=float(motion.max_bend_deg),
        verdict=VerdictRow(joints=assembly.joints, **fields),
        build=BuildRow(down=assembly.build.down, shift=_three(assembly.build.shift)),
        base=(_three(assembly.places[a]), _three(assembly.places[b])),
        grade=grade_of(assembly).counts,
        steps=[step_row(assembly, k) for k in range(len(assembly.steps))],
        rows=rows_of(assembly),
    )


def step_row(assembly: Assembly, k: int) -> StepRow:
    """What the document says of step k, from 0."""
    actions = [assembly.actions[n] for n in assembly.steps[k]]
    laid = [action.joint for action in actions if not action.swings]
    there = [*assembly.base, *_laid_before(assembly, k), *laid]
    places = assembly.places[there]
    return StepRow(
        step=k + 1,
        stretches=[
            StretchRow(
                swings=[
                    swing_text(assembly, swing.end, swing.was, swing.loose) for swing in s.swings
                ],
                end=ENDS[s.end],
                first_block=s.blocks[0],
                last_block=s.blocks[1],
                loose=assembly.build.letters[s.laid[-1].loose],
                voxels=len(s.laid),
            )
            for s in stretches(actions)
        ],
        layers=sorted({int(z) for z in assembly.places[laid, 2]}),
        voxels=len(laid),
        last_block=laid[-1] // 2 + 1,
        last_place=_three(assembly.places[laid[-1]]),
        voxels_in_place=len(there),
        size=_three(np.ptp(places, axis=0) + 1),
        moves=actions[-1].moves,
    )


def swing_text(assembly: Assembly, end: int, was: int, loose: int) -> str:
    """A swing in letters: ``tail:NU``."""
    ways = "".join(assembly.build.letters[direction] for direction in (was, loose))
    return f"{ENDS[end]}:{ways}"


def json_text(document: Document) -> str:
    """A field a line, and of the steps and rows one a line."""
    lines = []
    for name, value in document.model_dump().items():
        if name in ("steps", "rows"):
            inner = ",\n  ".join(json.dumps(row, allow_nan=False) for row in value)
            lines.append(f"{json.dumps(name)}: [\n  {inner}\n]")
        else:
            lines.append(f"{json.dumps(name)}: {json.dumps(value, allow_nan=False)}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def csv_text(rows: list[BlockRow]) -> str:
    """The rows with their names above."""
    text = io.StringIO()
    writer = csv.DictWriter(text, list(BlockRow.model_fields), lineterminator="\n")
    writer.writeheader()
    writer.writerows(row.model_dump() for row in rows)
    return text.getvalue()


def _laid_before(assembly: Assembly, k: int) -> list[int]:
    first = assembly.steps[k].start
    return [action.joint for action in assembly.actions[:first] if not action.swings]


def _three(values: Any) -> tuple[int, int, int]:
    x, y, z = (int(value) for value in values)
    return x, y, z
