"""Lattice paths and moves as short text: `ENUWSD` and `p120+N` (docs/formats.md)."""

import base64
import re
import zlib
from collections.abc import Sequence

import numpy as np

from . import grid
from .kinematics import Move

MOST_ANGLES = 2**27
"""That a motion is read with: they may be packed a thousand to a letter."""

_TOKEN = re.compile(
    r"(?P<kind>[ps])(?P<joint>\d{1,9})(?P<side>[+-])(?P<letter>[ENUWSD])"
    r"|d(?P<first>\d{1,9}):(?P<last>\d{1,9})(?P<turn>[+-])"
    r"|t(?P<pose>\d{1,9})"
    r"|g(?P<head>[+-])(?P<step>[ENUWSD])"
    r"|b(?P<axis>[xyz])(?P<before>\d{1,9}):(?P<after>\d{1,9})"
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


def packed(angles: grid.IntArray) -> str:
    """Rows of angles as base64 of the compressed differences from row to row, "" for none."""
    if not angles.size:
        return ""
    steps = np.diff(angles.astype(np.int32), axis=0, prepend=np.int32(0)).astype("<i4")
    return base64.b64encode(zlib.compress(steps.tobytes(), 9)).decode()


def unpacked(text: str, n_rows: int, n_bars: int) -> grid.IntArray:
    """The (n_rows, n_bars) angles that `packed` wrote; a ValueError where it did not."""
    if n_rows * n_bars > MOST_ANGLES:
        raise ValueError(f"{n_rows * n_bars:,} angles, and up to {MOST_ANGLES:,} are read")
    n_bytes = 4 * n_rows * n_bars
    decoder = zlib.decompressobj()
    try:
        data = decoder.decompress(base64.b64decode(text, validate=True), max(n_bytes, 1))
    except zlib.error as error:
        raise ValueError(f"angles do not decompress: {error}") from None
    whole = (decoder.eof and not decoder.unused_data) or not text
    if len(data) != n_bytes or not whole:
        raise ValueError(f"angles are not those of {n_rows} rows of {n_bars} bars")
    steps = np.frombuffer(data, "<i4").reshape(n_rows, n_bars if n_rows else 0)
    return steps.cumsum(axis=0, dtype=np.int32)


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
        if kind == Move.PULL and {joint, other} == {0, last} and 0 <= value < 6:
            return f"g{'+' if joint == last else '-'}{grid.LETTERS[value]}"
    if kind == Move.BEND and joint in (0, 1, 2) and min(other, value) >= 0:
        return f"b{'xyz'[joint]}{other}:{value}"
    raise ValueError(f"move {k}, {tuple(row)}, is not one the format knows")


def move(k: int, text: str, last: int, n_poses: int, n_angles: int) -> tuple[int, int, int, int]:
    """Row k of `Motion.moves` from its text; a ValueError where it names no move of this chain."""
    match = _TOKEN.fullmatch(text)
    if match is None:
        raise ValueError(f"move {k} reads {text[:20]!r}, which is not a move")
    if match["axis"]:
        before, after = int(match["before"]), int(match["after"])
        if max(before, after) >= n_angles:
            raise ValueError(f"move {k} reads {text!r}, but there are {n_angles} rows of angles")
        return int(Move.BEND), "xyz".index(match["axis"]), before, after
    if match["head"]:
        head, tail = (last, 0) if match["head"] == "+" else (0, last)
        return int(Move.PULL), head, tail, grid.LETTERS.index(match["step"])
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
