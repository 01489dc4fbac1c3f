"""Long paths without Us, fit to be pulled out of the solid by one end.

A *U* is three consecutive links that are sides of one unit square. Where no unit square has more
than two path edges there is none. A chain without Us can follow its own path round every corner
without a bend of more than 90 degrees, out along a free ray from one of its ends.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..solid import VoxelPath, VoxelSolid
from ._anneal import Stage, Terms, anneal
from ._solids import board_of, board_with, path_through
from ._strands import Board, lay, path_cells

HIDDEN = 5.0
"""Price of a path neither end of which sees the outside, in voxels."""

COOLING = Stage(Terms(0.45, 1.0, 0.5, HIDDEN), Terms(0.15, 6.0, 5.0, HIDDEN))

FILLING = Stage(Terms(0.2, 1e4, 5.0, HIDDEN), Terms(0.06, 1e4, 20.0, HIDDEN))


def ufree(
    path: VoxelPath, solid: VoxelSolid, sweeps: int, surface_weight: float, seed: int
) -> VoxelPath:
    """A long path without a U, one end of which at least sees the outside, from any path.

    Annealing with a price on Us that rises until none pays; those left are cut short, which
    takes two voxels each and always ends without a U, and the rest of the time fills up what is
    free again without making any.
    """
    rng = np.random.default_rng(seed)
    board, loops = board_with(path, solid, surface_weight)
    n = sweeps * solid.size
    anneal(board, loops, COOLING, n - n // 5, rng)
    cells = cut_short(path_cells(board), board)
    board = board_of(solid, surface_weight)
    lay(board, cells)
    anneal(board, loops, FILLING, n // 5, rng)
    cells = with_exit(cut_short(path_cells(board), board), board)
    return path_through(cells, solid, "ufree")


def cut_short(cells: NDArray[np.int64], board: Board) -> NDArray[np.int64]:
    """The path with every U a, b, c, d replaced by a, d, again and again until there is none."""
    strides = set(board.stride.tolist())
    kept: list[int] = []
    for cell in cells.tolist():
        kept.append(cell)
        while len(kept) > 3 and kept[-1] - kept[-4] in strides:
            del kept[-3:-1]
    return np.array(kept, np.int64)


def with_exit(cells: NDArray[np.int64], board: Board) -> NDArray[np.int64]:
    """The path without what has to go so that it is even and an end can be pulled out.

    What has to go is as little as can be.
    """
    found = []
    for way in (cells, cells[::-1]):
        lost = 0
        while lost < len(way) - 2 and not has_exit(way[lost:], board):
            lost += 1
        odd = (len(way) - lost) % 2
        found.append(way[lost : len(way) - odd])
    return max(found, key=len)


def has_exit(cells: NDArray[np.int64], board: Board) -> bool:
    """Whether the path can be pulled out by its first voxel without a U at the way out."""
    bits = int(board.exits[cells[0]])
    if len(cells) > 2:  # the link from the third voxel to the second, the other way round
        back = int(np.flatnonzero(board.stride == cells[2] - cells[1])[0])
        bits &= ~(1 << back)
    return bits != 0
