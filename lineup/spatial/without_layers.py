"""The longest path that annealing finds in the voxel graph, without layers."""

from __future__ import annotations

import numpy as np

from ..solid import VoxelPath, VoxelSolid
from ._anneal import Stage, Terms, anneal
from ._solids import board_with, cells_of, even, path_through
from ._strands import drop_cycles, path_cells

COOLING = Stage(Terms(0.6, 0.0, 0.3, 0.0), Terms(0.1, 0.0, 5.0, 0.0))

FILLING = Stage(Terms(0.2, 0.0, 20.0, 0.0), Terms(0.06, 0.0, 20.0, 0.0))


def free3d(
    path: VoxelPath, solid: VoxelSolid, sweeps: int, surface_weight: float, seed: int
) -> VoxelPath:
    """A long path that ignores the layers, annealed from any path of the solid.

    It comes within a percent or so of `path_bound`, and shows what the layers cost; but nothing
    says that it unfolds. Where the solid is a net of thin rods, which rods the path runs along
    is mostly what it was at the start.
    """
    rng = np.random.default_rng(seed)
    board, loops = board_with(path, solid, surface_weight)
    n = sweeps * solid.size
    anneal(board, loops, COOLING, n - n // 5, rng)
    drop_cycles(board)
    anneal(board, loops, FILLING, n // 5, rng)
    annealed = even(path_cells(board), board)
    kept = annealed if len(annealed) > len(path) else cells_of(path.voxels, solid)
    return path_through(kept, solid, "free3d")
