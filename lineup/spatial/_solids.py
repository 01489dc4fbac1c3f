"""From a solid to an empty board, and from an annealed board back to a path."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import grid
from ..solid import VoxelPath, VoxelSolid
from ._loops import Loops, loops_of
from ._strands import FREE, NO_DIRECTION, Board, lay

MARGIN = 1


def board_of(solid: VoxelSolid, surface_weight: float) -> Board:
    """An empty board on which a surface voxel is worth `surface_weight` and any other one 1."""
    occupancy = np.pad(solid.occupancy, MARGIN)
    weight = np.where(np.pad(grid.surface(solid.occupancy), MARGIN), surface_weight, 1.0)
    n = occupancy.size
    stride = np.array([occupancy[0].size, occupancy.shape[2], 1], np.int64)
    return Board(
        stride=np.concatenate([stride, -stride]),
        weight=np.where(occupancy, weight, 0.0).ravel(),
        exits=_exits(occupancy).ravel(),
        links=np.zeros(n, np.uint8),
        ahead=np.full(n, NO_DIRECTION, np.int64),
        strand=np.full(n, FREE, np.int64),
        key=np.zeros(n, np.int64),
        edges=np.zeros(3 * n, np.uint8),
        ends=np.zeros(2, np.int64),
        tally=np.zeros(3, np.int64),
    )


def board_with(path: VoxelPath, solid: VoxelSolid, surface_weight: float) -> tuple[Board, Loops]:
    """The board of a solid with a path on it, and the polygons that fit the solid."""
    board = board_of(solid, surface_weight)
    lay(board, cells_of(path.voxels, solid))
    return board, loops_of(board.weight > 0, board.stride)


def _exits(occupancy: grid.BoolArray) -> NDArray[np.uint8]:
    """Bits of the directions in which no voxel lies ahead, (X, Y, Z); 0 off the solid."""
    bits = np.zeros(occupancy.shape, np.uint8)
    for direction in range(6):
        axis = direction % 3
        inwards = np.flip(occupancy, axis) if direction < 3 else occupancy
        outmost = inwards & (inwards.cumsum(axis=axis) == 1)
        bits |= (np.flip(outmost, axis) if direction < 3 else outmost).astype(np.uint8) << direction
    return bits


def cells_of(voxels: grid.IntArray, solid: VoxelSolid) -> NDArray[np.int64]:
    """Flat cells of voxels on the board of a solid."""
    shape = np.array(solid.occupancy.shape) + 2 * MARGIN
    cells: NDArray[np.int64] = np.ravel_multi_index(tuple((voxels + MARGIN).T), tuple(shape))
    return cells


def path_through(cells: NDArray[np.int64], solid: VoxelSolid, method: str) -> VoxelPath:
    """The path through flat cells of the board of a solid."""
    shape = np.array(solid.occupancy.shape) + 2 * MARGIN
    voxels = np.stack(np.unravel_index(cells, tuple(shape)), axis=1) - MARGIN
    left = solid.occupancy.copy()
    left[tuple(voxels.T)] = False
    dropped = np.argwhere(left).astype(np.int32)
    return VoxelPath(voxels.astype(np.int32), dropped=dropped, method=method)


def even(cells: NDArray[np.int64], board: Board) -> NDArray[np.int64]:
    """The path without its less worthy end if it is odd."""
    if len(cells) % 2 == 0:
        return cells
    return cells[:-1] if board.weight[cells[-1]] <= board.weight[cells[0]] else cells[1:]
