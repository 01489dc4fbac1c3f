"""Lattice paths and moves as short text: `ENUWSD` and `p120+N` (docs/formats.md)."""

import re
from collections.abc import Sequence

import numpy as np

from . import grid
from .kinematics import Move

_TOKEN = re.compile(
    r"(?P<kind>[ps])(?P<joint>\d{1,9})(?P<side>[+-])(?P<letter>[ENUWSD])"
    r"|d(?P<first>\d{1,9}):(?P<last>\d{1,9})(?P<turn>[+-])"
    r"|t(?P<pose>\d{1,9})"
)


def lettered(voxels: grid.IntArray) -> tuple[tuple[int, int, int], str]:
    """Origin and direction letters of a lattice path; a ValueError where it is none."""
    if not len(voxels):
        raise ValueError("a path without voxels cannot be saved")
    x, y, z = (int(c) for c in voxels[0])
    return (x, y, z), "".join(grid.LETTERS[d] for d in grid.bar_directions(voxels))


def directions(letters: str) -> grid.IntArray:
    """Rows of `grid.DIRECTIONS` that the letters name, (len(letters),) int32."""
    codes = np.frombuffer(letters.encode("ascii"), np.uint8)
    table = np.zeros(128, np.int32)
    table[np.frombuffer(grid.LETTERS.encode("ascii"), np.uint8)] = np.arange(6)
    rows: grid.IntArray = table[codes]
    return rows


def positions(origin: Sequence[int], letters: str) -> grid.IntArray:
    """The lattice path from `origin` along the letters, (len(letters) + 1, 3) int32."""
    path: grid.IntArray = np.vstack([origin, grid.DIRECTIONS[directions(letters)]])
    return path.cumsum(axis=0, dtype=np.int32)


def token(k: int, row: Sequence[int], last: int) -> str:
    """Row k of `Motion.moves` as text; `last` is the number of the last joint."""
    kind, joint, other, value = row
    if min(joint, other) >= 0 and max(joint, other) <= last:
        if kind in (Move.PEEL, Move.SWING) and abs(other - joint) == 1 and 0 <= value < 6:
            letter = "p" if kind == Move.PEEL else "s"
            return f"{letter}{joint}{'+' if other > joint else '-'}{grid.LETTERS[value]}"
        if kind == Move.DOOR and value in (1, -1):
            return f"d{joint}:{other}{'+' if value > 0 else '-'}"
        if kind == Move.TILT and (joint, other) == (0, last) and value >= 0:
            return f"t{value}"
    raise ValueError(f"move {k}, {tuple(row)}, is not one the format knows")


def move(k: int, text: str, last: int, n_poses: int) -> tuple[int, int, int, int]:
    """Row k of `Motion.moves` from its text; a ValueError where it names no move of this chain."""
    match = _TOKEN.fullmatch(text)
    if match is None:
        raise ValueError(f"move {k} reads {text[:20]!r}, which is not a move")
    if match["kind"]:
        kind = Move.PEEL if match["kind"] == "p" else Move.SWING
        joint = int(match["joint"])
        other = joint + (1 if match["side"] == "+" else -1)
        value = grid.LETTERS.index(match["letter"])
    elif match["turn"]:
        kind, joint, other = Move.DOOR, int(match["first"]), int(match["last"])
        value = 1 if match["turn"] == "+" else -1
    else:
        kind, joint, other, value = Move.TILT, 0, last, int(match["pose"])
        if value >= n_poses:
            raise ValueError(f"move {k} tilts to pose {value} of {n_poses}")
    if not 0 <= min(joint, other) <= max(joint, other) <= last:
        raise ValueError(f"move {k} reads {text!r}, but the joints are 0 to {last}")
    return int(kind), joint, other, value
