"""A long path between two cells of a planar region, by annealing (Section 4.1's problem).

The paper's Algorithm 2 assumes a connected interior and gives up dangling cells; this search
assumes nothing and covers more. It is a heuristic: `chain_limit` says what cannot be exceeded.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..grid import FloatArray, IntArray
from ._board import new_board, unrolled
from ._search import Schedule, search
from .blocks import Region, chain, chain_limit, reach

SCHEDULE = Schedule(heat=(1.0, 0.3), cycle_cost=(0.2, 4.0), cold=(0.3, 0.1))


@dataclass(frozen=True, eq=False)
class Wishes:
    """Links that a planar path should have, in groups: each group is worth its bonus once.

    Attributes
    ----------
    links : list of (m, 2) int32
        For each group its links (cell, axis), from a cell to the next one (axis 0) or one width
        on (axis 1).
    slot : list of int
        0 or 1 for each group; groups of one slot have no link in common.
    bonus : (G,) float64
    """

    links: list[IntArray]
    slot: list[int]
    bonus: FloatArray


NO_WISHES = Wishes([], [], np.zeros(0))


def long_path(
    region: Region,
    start: int,
    end: int,
    wishes: Wishes,
    restarts: int,
    sweeps: int,
    rng: np.random.Generator,
) -> tuple[IntArray, float, float]:
    """A long path from `start` to `end`, its score, and a score that no path exceeds.

    Parameters
    ----------
    restarts, sweeps : int
        Annealed starts, and proposals for each 2 x 2 block in the last of them; each start has
        half as many as the next.

    Returns
    -------
    path : (P,) int32
        Cells, from `start` to `end`.
    score, limit : float
        Covered weight and the bonuses earned.
    """
    if start == end:
        weight = float(region.weight[start])
        return np.array([start], np.int32), weight, weight
    blocks = chain(region, start, end)
    inside = reach(region, blocks)
    width = region.width
    group_of, in_reach, ways = _groups(wishes, inside, width)
    limit = chain_limit(region, blocks, start)[1] + float(wishes.bonus[in_reach].sum())
    board = new_board(width, inside, region.weight, group_of, wishes.bonus)
    squares = np.flatnonzero(board.is_square).astype(np.int32)
    score, links = search(
        board,
        squares,
        ways,
        (start, end),
        (restarts, sweeps * len(squares)),
        SCHEDULE,
        limit - 1e-9,
        rng,
    )
    return unrolled(links, width, start), score, limit


def _groups(
    wishes: Wishes, inside: np.ndarray[tuple[int], np.dtype[np.bool_]], width: int
) -> tuple[IntArray, list[int], IntArray]:
    """Group of each link in reach, the groups in reach, and cells to go through at restarts.

    Half of those cells are any, half belong to a wanted link.
    """
    group_of = np.full((2, 2, inside.size), -1, np.int32)
    in_reach, wanted = [], []
    for number, (links, slot) in enumerate(zip(wishes.links, wishes.slot, strict=True)):
        cell, axis = links.T
        kept = inside[cell] & inside[cell + np.where(axis == 0, 1, width)]
        if kept.any():
            in_reach.append(number)
            group_of[slot, axis[kept], cell[kept]] = number
            wanted.append(cell[kept])
    cells = np.flatnonzero(inside).astype(np.int32)
    if wanted:
        ways = np.unique(np.concatenate(wanted))
        cells = np.concatenate([cells, np.resize(ways, len(cells))])
    return group_of, in_reach, cells
