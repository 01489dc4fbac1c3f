"""Layered paths with more excursions: a layered path annealed as a whole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .. import grid
from ..solid import VoxelPath, VoxelSolid
from ..visits import visits_of
from ._anneal import Stage, Terms
from ._nested import SINGLE, Nest, anneal_nested, label_piece
from ._solids import board_with, cells_of, path_through
from ._strands import FREE, LABEL, Board, drop_cycles, path_cells

COOLING = Stage(Terms(0.2, 0.0, 0.3, 0.0), Terms(0.15, 0.0, 3.0, 0.0))

FILLING = Stage(Terms(0.15, 0.0, 50.0, 0.0), Terms(0.05, 0.0, 50.0, 0.0))


def nested(
    path: VoxelPath, solid: VoxelSolid, sweeps: int, surface_weight: float, seed: int
) -> VoxelPath:
    """A layered path with excursions added, moved and taken away so that it covers more.

    Each still leaves a piece for the layer above or below at one voxel and comes back beside it,
    but a node may hold many pieces, down to two voxels. Where that gains nothing the path stays.
    """
    rng = np.random.default_rng(seed)
    board, loops = board_with(path, solid, surface_weight)
    nest = _nest_of(path, solid, board)
    n = sweeps * solid.size
    anneal_nested(board, nest, loops, COOLING, n - n // 5, rng)
    drop_cycles(board)
    anneal_nested(board, nest, loops, FILLING, n // 5, rng)
    drop_cycles(board)
    annealed = path_in_pieces(path_cells(board), nest, solid)
    return annealed if len(annealed) > len(path) else replace(path, method="nested")


def path_in_pieces(cells: NDArray[np.int64], nest: Nest, solid: VoxelSolid) -> VoxelPath:
    """The path through flat cells, its pieces numbered by label."""
    _, pieces = np.unique(nest.piece[cells], return_inverse=True)
    path = path_through(cells, solid, "nested")
    return replace(path, visits=visits_of(path.voxels, pieces.astype(np.int32)))


def _nest_of(path: VoxelPath, solid: VoxelSolid, board: Board) -> Nest:
    """Bridges and pieces of a layered path."""
    nest = Nest(np.full(board.links.size, SINGLE), np.full(board.links.size, FREE))
    for left, back in _returns(path.visits):
        out, home = path.voxels[left], path.voxels[back]
        low = min(home[2], path.voxels[back - 1][2])
        a, b = cells_of(np.array([(*out[:2], low), (*home[:2], low)]), solid)
        nest.mate[a] = grid.bar_directions(np.stack([out, home]))[0]
        nest.mate[b] = (nest.mate[a] + 3) % 6
    for cell in path_cells(board):
        if nest.piece[cell] == FREE:
            board.tally[LABEL] += 1
            label_piece(board, nest, int(cell), board.tally[LABEL])
    return nest


def _returns(visits: grid.IntArray) -> list[tuple[int, int]]:
    """Steps of a path at which a piece is left for an excursion, and gone on with."""
    last_step: dict[int, int] = {}
    found = []
    for start, stop, piece, _ in visits.tolist():
        if piece in last_step:
            found.append((last_step[piece], start))
        last_step[piece] = stop - 1
    return found
