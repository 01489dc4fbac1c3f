"""A long path between two cells of a planar region, by annealing (Section 4.1's problem).

The paper's Algorithm 2 assumes a connected interior and gives up dangling cells; this search
assumes nothing and covers more. It is a heuristic: `path_limit` says what cannot be exceeded.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..grid import BoolArray, FloatArray, IntArray
from ._kernels import Board, search, unrolled

HEAT = (0.5, 0.1)
CYCLE_COST = (0.5, 4.0)


@dataclass(frozen=True, eq=False)
class Region:
    """A 4-connected set of cells of a layer, on a flat grid with an empty margin.

    Cell (x, y) of the layer has the number ``(x + 1) * width + y + 1``, so that all layers of a
    solid share one numbering.

    Attributes
    ----------
    width : int
    inside : (N,) bool
    weight : (N,) float64
        What covering a cell is worth.
    cells : (n,) int32
        The cells inside, ascending.
    squares : (Q,) int32
        First cells of the 2 x 2 blocks inside.
    worth : pair of arrays
        For each colour, ``worth[colour][k]`` is the weight of its k heaviest cells.
    """

    width: int
    inside: BoolArray
    weight: FloatArray
    cells: IntArray
    squares: IntArray
    worth: tuple[FloatArray, FloatArray]

    def colour(self, cell: int) -> int:
        """Checkerboard colour 0 or 1 of a cell (Figure 10)."""
        return (cell // self.width + cell % self.width) % 2


def region(inside: BoolArray, weight: FloatArray, width: int) -> Region:
    """The region of the cells set in `inside`, (N,) on a flat grid with a margin."""
    cells = np.flatnonzero(inside).astype(np.int32)
    block = inside[cells + 1] & inside[cells + width] & inside[cells + width + 1]
    parity = (cells // width + cells % width) % 2
    heaviest = [np.sort(weight[cells[parity == c]])[::-1] for c in (0, 1)]
    first, second = (np.concatenate([[0.0], np.cumsum(w)]) for w in heaviest)
    return Region(width, inside, weight, cells, cells[block], (first, second))


def path_limit(region: Region, start_colour: int, end_colour: int) -> tuple[int, float]:
    """Cells and weight that no path between ends of these colours exceeds.

    Colours alternate along a path, so the rarer one limits it.
    """
    n = [len(worth) - 1 for worth in region.worth]
    if start_colour != end_colour:
        k = [min(n)] * 2
    else:
        k = [min(n[0], n[1])] * 2
        k[1 - start_colour] = min(n[1 - start_colour], n[start_colour] - 1)
        k[start_colour] = k[1 - start_colour] + 1
    return sum(k), float(sum(worth[m] for worth, m in zip(region.worth, k, strict=True)))


@dataclass(frozen=True, eq=False)
class Wishes:
    """Links that a planar path should have, in groups: each group is worth its bonus once.

    Attributes
    ----------
    group_of : (2, 2, N) int32
        Group of the link from a cell in direction 0 (next cell) or 1 (one width on), -1 for none;
        the first axis allows two groups a link.
    bonus : (G,) float64
    ways : (W,) int32
        Cells of the groups, ascending.
    """

    group_of: IntArray
    bonus: FloatArray
    ways: IntArray


def wishes(
    groups: list[tuple[int, NDArray[np.bool_]]], bonus: list[float], width: int, n_cells: int
) -> Wishes:
    """Wishes for any link within each set of cells: groups are (slot 0 or 1, (N,) bool)."""
    group_of = np.full((2, 2, n_cells), -1, np.int32)
    ways = np.zeros(n_cells, bool)
    for number, (slot, inside) in enumerate(groups):
        for axis, stride in enumerate((1, width)):
            linked = np.flatnonzero(inside[:-stride] & inside[stride:])
            group_of[slot, axis, linked] = number
            ways[linked] = ways[linked + stride] = True
    return Wishes(group_of, np.array(bonus, float), np.flatnonzero(ways).astype(np.int32))


def long_path(
    region: Region,
    start: int,
    end: int,
    wanted: Wishes,
    restarts: int,
    sweeps: int,
    rng: np.random.Generator,
) -> tuple[IntArray, float]:
    """A long path from `start` to `end` and its score: covered weight and bonuses earned.

    Parameters
    ----------
    restarts, sweeps : int
        Annealed starts, and proposals for each 2 x 2 block in each of them.
    """
    if start == end:
        return np.array([start], np.int32), float(region.weight[start])
    board = Board(
        region.width,
        region.inside,
        region.weight,
        wanted.group_of,
        wanted.bonus,
        np.zeros(region.inside.size, np.uint8),
        np.zeros(wanted.bonus.size, np.int32),
    )
    _, limit = path_limit(region, region.colour(start), region.colour(end))
    n_repeats = 1 + len(region.cells) // max(1, len(wanted.ways))
    score, links = search(
        board,
        region.squares,
        np.concatenate([region.cells, np.tile(wanted.ways, n_repeats)]),
        (start, end),
        (restarts, sweeps * len(region.squares)),
        HEAT,
        CYCLE_COST,
        limit + float(wanted.bonus.sum()) - 1e-9,
        rng,
    )
    return unrolled(links, region.width, start), score
