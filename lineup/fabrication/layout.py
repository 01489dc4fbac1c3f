"""A chain laid out on the plates of a printer, to and fro, row after row."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np

from .._record import record
from ..block import WALL_MM, Block
from ..block.parts import join_height_mm
from ..grid import IntArray
from .placing import Placed, placed


@record
class Plate:
    """What is printed at a time: a run of the chain's blocks.

    Attributes
    ----------
    start, stop : int
        Blocks start..stop-1, counted from 0.
    voxels : (P, 3) int32
        Their pose.
    first, last : str
        The parts it begins and ends with: "end", or "groove" and "tongue" where the chain goes on.
    """

    start: int
    stop: int
    voxels: IntArray
    first: str = "end"
    last: str = "end"


def pieces_on(plate: Plate, block: Block) -> tuple[Placed, ...]:
    """The parts on a plate in their places, their bars counted along the whole chain.

    Examples
    --------
    >>> (plate,) = plates(1, Block(), (30.0, 30.0))
    >>> [piece.part for piece in pieces_on(plate, Block())]
    ['end', 'hinge', 'end']
    """
    pieces = placed(plate.voxels, block, plate.first, plate.last)
    return tuple(replace(piece, bar=piece.bar + 2 * plate.start) for piece in pieces)


def boustrophedon(n: int, columns: int, rows: int) -> IntArray:
    """The first n voxels of a path to and fro along x, row after row, layer upon layer.

    Examples
    --------
    >>> boustrophedon(5, 2, 3).tolist()
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 2, 0]]
    """
    k = np.arange(n)
    layer, within = np.divmod(k, columns * rows)
    within = np.where(layer % 2, columns * rows - 1 - within, within)
    row, column = np.divmod(within, columns)
    column = np.where(row % 2, columns - 1 - column, column)
    return np.stack([column, row, layer], axis=1).astype(np.int32)


def plates(
    n_blocks: int, block: Block, bed_mm: tuple[float, float], layers: int = 1
) -> tuple[Plate, ...]:
    """The fewest plates that a chain of blocks is printed on, evenly filled.

    Each holds a run of the chain, folded to and fro. Where the chain goes on, on the next plate,
    a capsule is in two halves: a tongue at the end of one plate, a groove at the start of the next.

    Parameters
    ----------
    bed_mm : (float, float)
        What can be printed on, in x and y.
    layers : int
        Layers of voxels on top of each other; more than one where supports can be taken out from
        inside, or are not needed.

    Raises
    ------
    ValueError
        If not one block fits on the bed, the chain has no block, or it needs several plates but
        its capsules have no room for tongue and groove.

    Examples
    --------
    >>> [(p.start, p.stop, p.last) for p in plates(754, Block(), (250.0, 250.0))]
    [(0, 252, 'tongue'), (252, 503, 'tongue'), (503, 754, 'end')]
    """
    if n_blocks < 1 or layers < 1:
        raise ValueError(f"a chain has at least 1 block, and 1 layer, got {n_blocks} and {layers}")
    if len(bed_mm) != 2 or not all(math.isfinite(side) and side > 0 for side in bed_mm):
        raise ValueError(f"bed_mm must be two positive numbers, got {bed_mm}")
    columns, rows = _cells(bed_mm, block, 0.0)
    if columns * rows * layers >= 2 * n_blocks:
        return (_plate(0, n_blocks, n_blocks, columns, rows, layers),)
    if block.swivel or join_height_mm(block) < WALL_MM:
        why = "swivel" if block.swivel else "have no room for tongue and groove"
        raise ValueError(
            f"capsules that {why} cannot be joined from plate to plate, and the bed "
            f"{_bed(bed_mm)} holds {columns * rows * layers} of {2 * n_blocks} voxels; "
            "a larger bed_mm, a smaller pitch_mm or more layers would do"
        )
    # A tongue may point off the plate.
    columns, rows = _cells(bed_mm, block, 2 * join_height_mm(block))
    room = columns * rows * layers // 2
    if not room:
        raise ValueError(
            f"not one block of pitch {block.pitch_mm:g} mm fits on the bed {_bed(bed_mm)}; "
            "a larger bed_mm or a smaller pitch_mm would do"
        )
    n = -(-n_blocks // room)
    bounds = [-(-n_blocks * k // n) for k in range(n + 1)]
    return tuple(
        _plate(start, stop, n_blocks, columns, rows, layers) for start, stop in pairwise(bounds)
    )


def _cells(bed_mm: tuple[float, float], block: Block, margin_mm: float) -> tuple[int, int]:
    columns, rows = (int((side - margin_mm) / block.pitch_mm + 1e-9) for side in bed_mm)
    return columns, rows


def _bed(bed_mm: tuple[float, float]) -> str:
    return f"{bed_mm[0]:g} x {bed_mm[1]:g} mm"


def _plate(start: int, stop: int, n_blocks: int, columns: int, rows: int, layers: int) -> Plate:
    n = 2 * (stop - start)
    columns = min(columns, n)
    rows = min(rows, -(-n // (columns * layers)))
    return Plate(
        start,
        stop,
        boustrophedon(n, columns, rows),
        "groove" if start else "end",
        "tongue" if stop < n_blocks else "end",
    )
