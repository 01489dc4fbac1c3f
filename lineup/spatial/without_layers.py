"""The longest path that annealing finds in the voxel graph, without layers."""

from __future__ import annotations

import numpy as np

from ..solid import VoxelPath, VoxelSolid
from ._anneal import Stage, Terms, anneal
from ._loops import loops_of
from ._solids import board_of, even, lay_first_link, path_through
from ._strands import drop_cycles, path_cells

COOLING = Stage(Terms(0.6, 0.0, 0.3, 0.0), Terms(0.1, 0.0, 5.0, 0.0))

FILLING = Stage(Terms(0.2, 0.0, 20.0, 0.0), Terms(0.06, 0.0, 20.0, 0.0))


def free3d(
    solid: VoxelSolid, seed: int, *, sweeps: int = 3000, surface_weight: float = 1.5
) -> VoxelPath:
    """A long path that ignores the layers: what the layers cost shows beside it.

    It comes within a percent or two of `path_bound`, but nothing says that it unfolds.

    Parameters
    ----------
    sweeps : int
        Proposals for each voxel.
    surface_weight : float
        Worth of a surface voxel, an interior one being 1.
    """
    rng = np.random.default_rng(seed)
    board = board_of(solid, surface_weight)
    loops = loops_of(board.weight > 0, board.stride)
    lay_first_link(board)
    n = sweeps * solid.size
    anneal(board, loops, COOLING, n - n // 5, rng)
    drop_cycles(board)
    anneal(board, loops, FILLING, n // 5, rng)
    return path_through(even(path_cells(board), board), solid, "free3d")
