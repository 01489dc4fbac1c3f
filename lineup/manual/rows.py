"""The rows of a manual: one for each block, in the order in which blocks are done (Section 7)."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from .. import grid
from ..grid import IntArray
from ..words import bar_frames
from .actions import AT_ONCE, ENDS, MANNERS, Action
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
    manner: Annotated[str, Field(pattern=f"^({'|'.join(MANNERS)})$")]
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
    order = np.lexsort([number.min(axis=1), number.max(axis=1)]).tolist()
    poses, swings = _poses(assembly), _swings(assembly)
    return [
        BlockRow(order=k, block=i + 1, **poses[i], **_work(assembly, i, swings))
        for k, i in enumerate(order, start=1)
    ]


def _poses(assembly: Assembly) -> list[dict[str, Any]]:
    """Of each block, the entries that tell of the folded pose, in the model's frame."""
    frames = bar_frames(assembly.word)
    voxels = assembly.folding.path.voxels.tolist()
    joints = ["", *assembly.word.letters, ""]
    pieces = [*(_letter(frame[:, 0]) for frame in frames[1::2]), ""]
    names = ("x1", "y1", "z1", "x2", "y2", "z2")
    return [
        dict(zip(names, voxels[2 * i] + voxels[2 * i + 1], strict=True))
        | {
            "frame": "".join(_letter(axis) for axis in frames[2 * i].T),
            "hinge": _letter(frames[2 * i][:, 0]),
            "piece": pieces[i],
            "joint1": joints[2 * i],
            "joint2": joints[2 * i + 1],
        }
        for i in range(assembly.n_blocks)
    ]


def _work(assembly: Assembly, i: int, swings: dict[int, list[str]]) -> dict[str, Any]:
    """The entries of block i that tell what is done, on the card."""
    at1, at2 = assembly.number[2 * i : 2 * i + 2].tolist()
    numbers = sorted((at1, at2))
    done = [assembly.actions[n - 1] for n in numbers if n]
    swung = [text for n in numbers for text in swings.get(n, [])]
    numbers += [int(text.split(":")[0]) for text in swung]
    column, row, layer = assembly.places[2 * i if at1 > at2 else 2 * i + 1].tolist()
    return {
        "step": _step(assembly, max(at1, at2)),
        "end": ENDS[done[-1].end] if done else "base",
        "at1": at1,
        "at2": at2,
        "swings": " ".join(swung),
        "bends": "".join(bend(assembly, action) for action in done),
        "loose": "".join(assembly.build.letters[action.loose] for action in done),
        "manner": next((action.manner for action in done if action.manner), AT_ONCE),
        "twists": int(np.isin(numbers, assembly.twists).sum()),
        "column": column,
        "row": row,
        "layer": layer,
    }


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
