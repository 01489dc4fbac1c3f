"""Does the body stand while it is folded, and how much room does it need? (Section 7)"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd

from ..grid import IntArray
from ..kinematics import frames
from ..solid import Folding, Motion
from .faces import Bonding
from .measured import measured
from .results import DENSITY, Setting
from .support import upward

RODS = ("carried", "free")
"""Whether hands carry the loose ends, or nobody does and they weigh on the body."""

NOTHING_FOLDED = "nothing is folded"

COLUMNS = [
    *("move", "folded", "first", "last", "stands", "margin_mm", "safety", "worst", "sag_mm"),
    *("box_x_mm", "box_y_mm", "box_z_mm", "below_mm", "reason"),
]
"""Columns of `standing`."""

_CORNER = 0.5  # how much a bar's direction changes at a corner, at the least, in one coordinate


def standing(
    shape: Folding | Motion,
    moves: Sequence[int] | int = 9,
    pitch_mm: float = 10.0,
    *,
    density: float = DENSITY,
    bonding: Bonding | str = "velcro",
    up: str | tuple[float, float, float] = "+z",
    rods: str = "carried",
) -> pd.DataFrame:
    """Whether a partly folded body stands, how safely, and the room it needs (Section 7).

    A pose has a body and, at both ends of the chain, a loose straight rod. A rod is what lies
    beyond the outermost corner of the chain, but for joints that are still in their places in the
    folded pose. The body rests on a table as high as its lowest voxels.

    Parameters
    ----------
    shape : Folding or Motion
    moves : sequence of int, or int
        Poses to look at: after so many moves from the folded pose. One number is that of the
        poses, at equal numbers of moves from the first to the last.
    pitch_mm, density, bonding, up
        As `strength`.
    rods : str
        "carried": hands carry the rods, and the body stands alone. "free": nobody does; they
        weigh on the body, and the lowest voxels of all are what rests on the table.

    Returns
    -------
    DataFrame
        A row for each pose, in the order given:

        - ``move``; ``folded``: voxels of the body; ``first``, ``last``: its joints, -1 if none;
        - ``stands``, ``margin_mm``, ``safety``, ``sag_mm``, ``reason``: as `Strength`, of the
          body with or without the rods; nan, and "nothing is folded", for a straight line;
        - ``worst``: the face that gives way first;
        - ``box_x_mm``, ``box_y_mm``, ``box_z_mm``: sides of the box that holds the whole chain;
        - ``below_mm``: how far the whole chain reaches below what the body rests on.

    Raises
    ------
    ValueError
        If a move is not from 0 to the number of moves, the pose after it is between lattice
        poses or not simple, or an option is unknown or out of range.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> folding = lu.fold(lu.VoxelSolid(np.ones((4, 3, 2), bool)), rounds=20, trial_rounds=5)
    >>> rows = lu.standing(folding, moves=[0, len(folding.motion)])
    >>> rows[["folded", "stands", "box_x_mm"]].values.tolist()[0]
    [24, True, 40.0]
    >>> rows["reason"].tolist()
    ['stands', 'nothing is folded']
    """
    if rods not in RODS:
        raise ValueError(f"rods must be one of {list(RODS)}, got {rods!r}")
    motion = shape.motion if isinstance(shape, Folding) else shape
    if isinstance(moves, int):
        moves = _moments(len(motion), moves)
    wrong = [k for k in moves if not 0 <= k <= len(motion)]
    if wrong:
        raise ValueError(f"moves must be from 0 to {len(motion)}, got {wrong[0]}")
    setting = Setting(pitch_mm, density, bonding, up)
    rows = {k: _row(k, pose, motion, setting, rods) for k, pose in _poses(motion, set(moves))}
    return pd.DataFrame([rows[int(k)] for k in moves], columns=COLUMNS)


def body_of(pose: IntArray, folded: IntArray) -> tuple[int, int]:
    """First and last joint of the body of a lattice pose; (-1, -1) if it is a straight line.

    It has two joints at the least.

    Examples
    --------
    >>> import numpy as np
    >>> hook = np.array([(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0), (3, 1, 0), (2, 1, 0)])
    >>> body_of(hook, hook[::-1])
    (3, 4)
    """
    bars = np.diff(pose, axis=0)
    corners = np.flatnonzero((np.abs(np.diff(bars, axis=0)) > _CORNER).any(axis=1)) + 1
    if not len(corners):
        return -1, -1
    first, last = int(corners[0]), int(corners[-1])
    in_place = (pose == folded).all(axis=1)
    while first > 0 and in_place[first] and in_place[first - 1]:
        first -= 1
    while last < len(pose) - 1 and in_place[last] and in_place[last + 1]:
        last += 1
    return first, max(last, first + 1)


def _poses(motion: Motion, wanted: set[int]) -> Iterator[tuple[int, IntArray]]:
    left = len(wanted)
    for k, pose in enumerate(frames(motion)):
        if k in wanted:
            lattice = np.rint(pose)
            if np.abs(pose - lattice).max() > 1e-6:
                raise ValueError(f"the pose after move {k} lies between lattice poses")
            yield k, lattice.astype(np.int32)
            left -= 1
        if not left:
            return


def _row(k: int, pose: IntArray, motion: Motion, setting: Setting, rods: str) -> dict[str, Any]:
    pitch = setting.pitch_mm
    first, last = body_of(pose, motion.start)
    box = (np.ptp(pose, axis=0) + 1) * pitch
    row: dict[str, Any] = dict.fromkeys(COLUMNS, float("nan")) | {
        "move": k,
        "folded": last - first + 1 if first >= 0 else 0,
        "first": first,
        "last": last,
        "stands": False,
        "worst": "",
        **dict(zip(("box_x_mm", "box_y_mm", "box_z_mm"), box.tolist(), strict=True)),
        "below_mm": 0.0,
        "reason": NOTHING_FOLDED,
    }
    if first < 0:
        return row
    counted = (first, last) if rods == "carried" else (0, len(pose) - 1)
    body = pose[counted[0] : counted[1] + 1]
    result = measured(body, setting, start=counted[0])
    height = pose @ upward(setting.up)
    below = height[counted[0] : counted[1] + 1].min() - height.min()
    return row | {
        "stands": result.stands,
        "margin_mm": result.margin_mm,
        "safety": result.safety,
        "worst": result.worst_face,
        "sag_mm": result.sag_mm,
        "below_mm": float(below) * pitch,
        "reason": result.reason,
    }


def _moments(n_moves: int, count: int) -> list[int]:
    """So many numbers of moves at equal steps, from none to all."""
    if count < 2:
        raise ValueError(f"at least 2 poses, the first and the last, can be looked at, got {count}")
    return sorted({int(k) for k in np.rint(np.linspace(0, n_moves, count))})
