"""The rows of a manual: one for each block, in the order in which blocks are done (Section 7)."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from .. import grid
from ..grid import IntArray
from ..words import bar_frames
from .actions import ENDS, Action
from .assembly import Assembly

Whole = Annotated[int, Field(ge=-(2**30), le=2**30)]
Count = Annotated[int, Field(ge=0, le=2**30)]
_SWING = r"\d{1,9}:(head|tail):[ENUWSD]{2}"


class BlockRow(BaseModel):
    """One block; docs/formats.md says what the fields mean."""

    model_config = ConfigDict(extra="forbid", strict=True, hide_input_in_errors=True, frozen=True)

    order: Count
    step: Count
    block: Count
    end: Annotated[str, Field(pattern="^(base|head|tail)$")]
    x1: Whole
    y1: Whole
    z1: Whole
    x2: Whole
    y2: Whole
    z2: Whole
    frame: Annotated[str, Field(pattern="^[ENUWSD]{3}$")]
    hinge: Annotated[str, Field(pattern="^[ENUWSD]$")]
    piece: Annotated[str, Field(pattern="^[ENUWSD]?$")]
    joint1: Annotated[str, Field(pattern="^[SyYzZ]?$")]
    joint2: Annotated[str, Field(pattern="^[SyYzZ]?$")]
    at1: Count
    at2: Count
    swings: Annotated[str, Field(pattern=f"^({_SWING}( {_SWING})*)?$")]
    bends: Annotated[str, Field(pattern="^[ENUWSD]{0,2}$")]
    loose: Annotated[str, Field(pattern="^[ENUWSD]{0,2}$")]
    twists: Count
    column: Count
    row: Count
    layer: Count

    @property
    def voxels(self) -> tuple[tuple[int, int, int], tuple[int, int, int]]:
        """Of its joints, the first and the second."""
        return (self.x1, self.y1, self.z1), (self.x2, self.y2, self.z2)


def rows_of(assembly: Assembly) -> list[BlockRow]:
    """The rows, in order.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup.manual.assembly import assembly_of
    >>> from lineup.manual.rows import rows_of
    >>> folding = lu.fold(lu.VoxelSolid(np.ones((2, 2, 1), bool)), rounds=20, trial_rounds=5)
    >>> [row.order for row in rows_of(assembly_of(folding))]
    [1, 2]
    """
    number = assembly.number.reshape(-1, 2)
    swings = _swings(assembly)
    order = np.lexsort([number.min(axis=1), number.max(axis=1)])
    frames = bar_frames(assembly.word)
    letters = f".{assembly.word.letters}."
    return [
        _row(assembly, int(i), k, frames, letters, swings) for k, i in enumerate(order, start=1)
    ]


def _row(
    assembly: Assembly,
    i: int,
    order: int,
    frames: IntArray,
    letters: str,
    swings: dict[int, list[str]],
) -> BlockRow:
    first, second = 2 * i, 2 * i + 1
    at = [int(assembly.number[joint]) for joint in (first, second)]
    late = first if at[0] > at[1] else second
    done = [assembly.actions[n - 1] for n in sorted(at) if n]
    (x1, y1, z1), (x2, y2, z2) = assembly.folding.path.voxels[[first, second]].tolist()
    swung = [text for n in sorted(at) for text in swings.get(n, [])]
    column, row, layer = assembly.places[late].tolist()
    last = second + 1 == len(letters)
    return BlockRow(
        order=order,
        step=_step(assembly, max(at)),
        block=i + 1,
        end=ENDS[done[-1].end] if done else "base",
        x1=x1,
        y1=y1,
        z1=z1,
        x2=x2,
        y2=y2,
        z2=z2,
        frame="".join(_letter(axis) for axis in frames[first].T),
        hinge=_letter(frames[first][:, 0]),
        piece="" if last else _letter(frames[second][:, 0]),
        joint1=letters[first].strip("."),
        joint2=letters[second].strip("."),
        at1=at[0],
        at2=at[1],
        swings=" ".join(swung),
        bends="".join(bend(assembly, action) for action in done),
        loose="".join(assembly.build.letters[action.loose] for action in done),
        twists=int(np.isin([*at, *(int(s.split(":")[0]) for s in swung)], assembly.twists).sum()),
        column=column,
        row=row,
        layer=layer,
    )


def bend(assembly: Assembly, action: Action) -> str:
    """Where, on the card, the voxel that is put in place lies from the one before it at its end."""
    return _letter(assembly.places[action.joint] - assembly.places[action.before])


def _step(assembly: Assembly, number: int) -> int:
    """The step of an action; the base is of the first."""
    steps = assembly.steps
    return next((k for k, step in enumerate(steps, start=1) if number - 1 in step), 1)


def _swings(assembly: Assembly) -> dict[int, list[str]]:
    """Swings as text, by the number of the action after them that puts a voxel in place."""
    found: dict[int, list[str]] = {}
    waiting: list[str] = []
    for number, action in enumerate(assembly.actions, start=1):
        if action.swings:
            ways = "".join(assembly.build.letters[d] for d in (action.was, action.loose))
            waiting.append(f"{number}:{ENDS[action.end]}:{ways}")
        elif waiting:
            found[number], waiting = waiting, []
    return found


def _letter(step: IntArray) -> str:
    return grid.LETTERS[int(np.flatnonzero((step == grid.DIRECTIONS).all(axis=1))[0])]
