"""Where every part of a chain lies when the chain is in a lattice pose."""

from __future__ import annotations

import numpy as np

from .._record import record
from ..block import Block
from ..grid import DIRECTIONS, FloatArray, IntArray, bar_directions


@record
class Placed:
    """One part in its place: ``x @ rotation.T + offset_mm`` for x in the frame of the part.

    Attributes
    ----------
    part : str
    rotation : (3, 3) int32
    offset_mm : (3,) float64
    bar : int
        The bar of the path that the part is; an end, or a half of a middle, has the next one.
    """

    part: str
    rotation: IntArray
    offset_mm: FloatArray
    bar: int


def placed(
    voxels: IntArray, block: Block, first: str = "end", last: str = "end"
) -> tuple[Placed, ...]:
    """The parts of a chain on a lattice path, in order.

    Parameters
    ----------
    voxels : (P, 3) int32
        A simple lattice path of an even number of voxels; a voxel is the centre of a cube, and
        voxel (0, 0, 0) lies about the origin.
    first, last : str
        What the chain begins and ends with: "end", or where it goes on, on another plate, "groove"
        and "tongue".

    Raises
    ------
    ValueError
        If the number of voxels is odd, two neighbours do not share a face, or a voxel comes twice.

    Examples
    --------
    >>> path = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (2, 1, 0)])
    >>> [piece.part for piece in placed(path, Block())]
    ['end', 'hinge', 'middle', 'hinge', 'end']
    """
    directions = bar_directions(voxels).tolist()
    if len(voxels) % 2 or not len(voxels):
        raise ValueError(
            f"a chain of blocks has an even number of voxels, got {len(voxels)}; "
            "lineup.trim makes it one less"
        )
    if len(np.unique(voxels, axis=0)) < len(voxels):
        raise ValueError("the path meets itself: a voxel comes twice in it")
    between = ("sleeve", "pin") if block.swivel else ("middle",)
    pieces = [_first(first, voxels, directions, block)]
    for bar, direction in enumerate(directions):
        for part in ("hinge",) if bar % 2 == 0 else between:
            pieces.append(_piece(part, direction, voxels[bar], block, bar))
    turned = directions[-1] if last == "tongue" else (directions[-1] + 3) % 6
    pieces.append(_piece(last, turned, voxels[-1], block, len(directions)))
    return tuple(pieces)


def _first(part: str, voxels: IntArray, directions: list[int], block: Block) -> Placed:
    # The socket of a groove is at the far end of its frame.
    at = voxels[0] - DIRECTIONS[directions[0]] if part == "groove" else voxels[0]
    return _piece(part, directions[0], at, block, -1)


def _piece(part: str, direction: int, at: IntArray, block: Block, bar: int) -> Placed:
    return Placed(part, _FRAMES[direction], block.pitch_mm * np.asarray(at, float), bar)


def _frame(direction: int) -> IntArray:
    """A rotation of the lattice that turns +x into a direction; slots stay in lattice planes."""
    x = DIRECTIONS[direction]
    y = DIRECTIONS[(direction + 1) % 3]
    return np.stack([x, y, np.cross(x, y)], axis=1).astype(np.int32)


_FRAMES = [_frame(direction) for direction in range(6)]
