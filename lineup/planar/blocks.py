"""Planar regions cut at their one-cell necks, and what a path between two cells can cover.

A simple path that leaves a part of the region through a single cell cannot come back. So it
visits only the *blocks* (maximal parts without a cut cell) on the way between its ends, each from
one cut cell to the next, and in each block its cells alternate in colour. That bounds it from
above, often tightly, and says which cells are in reach at all.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel
from ..grid import BoolArray, FloatArray, IntArray

Limit = tuple[int, float]
"""A number of cells and a weight that a path cannot exceed."""

DIFFERENT = 2
"""Index of the limit between ends of different colours."""


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
    head : (B,) int32
        For each block, its cell nearest to the first cell of the region: where it hangs.
    home : (N,) int32
        The block in which a cell is not the head; -1 for the first cell and outside.
    limit : list of triples of (int, float)
        For each block, cells and weight that no path in it exceeds: between two ends of colour
        0, of colour 1, of different colours. Colours alternate along a path, so the rarer one
        limits it.
    """

    width: int
    inside: BoolArray
    weight: FloatArray
    cells: IntArray
    head: IntArray
    home: IntArray
    limit: list[tuple[Limit, Limit, Limit]]

    def colour(self, cell: int) -> int:
        """Checkerboard colour 0 or 1 of a cell (Figure 10)."""
        return (cell // self.width + cell % self.width) % 2

    def block_of(self, cells: IntArray, others: IntArray) -> IntArray:
        """The block of each link between a cell and another one beside it."""
        home, beside = self.home[cells], self.home[others]
        hangs = (home >= 0) & (self.head[home] == others)
        block: IntArray = np.where(hangs, home, beside).astype(np.int32)
        return block


def region(inside: BoolArray, weight: FloatArray, width: int) -> Region:
    """The region of the cells set in `inside`, (N,) on a flat grid with a margin."""
    cells = np.flatnonzero(inside).astype(np.int32)
    head, home = _cut(inside, width, int(cells[0]), len(cells))
    limit = []
    order = cells[np.argsort(home[cells], kind="stable")]
    bounds = np.searchsorted(home[order], np.arange(len(head) + 1))
    for block, (first, last) in enumerate(pairwise(bounds)):
        members = np.append(order[first:last], head[block])
        colour = (members // width + members % width) % 2
        limit.append(_limits(weight[members[colour == 0]], weight[members[colour == 1]]))
    return Region(width, inside, weight, cells, head, home, limit)


def _limits(even: FloatArray, odd: FloatArray) -> tuple[Limit, Limit, Limit]:
    """Limits of a block with cells of these weights of colours 0 and 1."""

    def heaviest(n_even: int, n_odd: int) -> Limit:
        weight = np.sort(even)[::-1][:n_even].sum() + np.sort(odd)[::-1][:n_odd].sum()
        return n_even + n_odd, float(weight)

    inner_odd, inner_even = min(len(even) - 1, len(odd)), min(len(odd) - 1, len(even))
    n = min(len(even), len(odd))
    return (
        heaviest(inner_odd + 1, inner_odd),
        heaviest(inner_even, inner_even + 1),
        heaviest(n, n),
    )


Chain = list[tuple[int, int, int]]


def chain(region: Region, start: int, end: int) -> Chain:
    """The blocks between two cells: rows (block, cell entered, cell left); none if start is end."""
    up, down = _way_up(region, start), _way_up(region, end)
    while up and down and up[-1] == down[-1]:
        up.pop()
        down.pop()
    middle = []
    if up and down and up[-1][0] == down[-1][0]:
        block, entered, _ = up.pop()
        middle.append((block, entered, down.pop()[1]))
    return [*up, *middle, *((block, head, cell) for block, cell, head in reversed(down))]


def _way_up(region: Region, cell: int) -> Chain:
    """The blocks from a cell to the first cell of the region: (block, cell entered, head)."""
    way = []
    while (block := int(region.home[cell])) >= 0:
        head = int(region.head[block])
        way.append((block, cell, head))
        cell = head
    return way


def chain_limit(region: Region, blocks: Chain, start: int) -> Limit:
    """Cells and weight that no path along a chain of blocks from `start` exceeds."""
    n, weight = 1, float(region.weight[start])
    for block, entered, left in blocks:
        colour = region.colour(entered)
        which = colour if colour == region.colour(left) else DIFFERENT
        n_more, more = region.limit[block][which]
        n += n_more - 1
        weight += more - float(region.weight[entered])
    return n, weight


def reach(region: Region, blocks: Chain) -> BoolArray:
    """The cells of the blocks of a chain, (N,) bool."""
    visited = np.zeros(len(region.head) + 1, bool)
    visited[[block for block, _, _ in blocks]] = True
    reached: BoolArray = visited[region.home]
    for block, _, _ in blocks:
        reached[region.head[block]] = True
    return reached


@kernel
def _cut(
    inside: NDArray[np.bool_], width: int, first: int, n: int
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Head of each block and home of each cell, by depth-first search (Hopcroft and Tarjan)."""
    home = np.full(inside.size, -1, np.int32)
    head = np.empty(n, np.int32)
    found = np.zeros(inside.size, np.int32)  # 1 + number in the order of discovery
    low = np.zeros(inside.size, np.int32)
    turn = np.zeros(inside.size, np.int8)
    trail, pending = np.empty(n, np.int32), np.empty(n, np.int32)
    steps = (1, width, -1, -width)
    trail[0] = first
    found[first] = low[first] = 1
    depth, n_pending, n_found, n_blocks = 1, 0, 1, 0
    while depth:
        cell = trail[depth - 1]
        if turn[cell] < 4:
            other = cell + steps[turn[cell]]
            turn[cell] += 1
            if inside[other] and found[other] == 0:
                n_found += 1
                found[other] = low[other] = n_found
                trail[depth] = pending[n_pending] = other
                depth += 1
                n_pending += 1
            elif inside[other]:
                low[cell] = min(low[cell], found[other])
            continue
        depth -= 1
        if depth == 0:
            break
        above = trail[depth - 1]
        low[above] = min(low[above], low[cell])
        if low[cell] >= found[above]:
            head[n_blocks] = above
            n_pending = _settle(home, pending, n_pending, cell, n_blocks)
            n_blocks += 1
    return head[:n_blocks].copy(), home


@kernel
def _settle(
    home: NDArray[np.int32], pending: NDArray[np.int32], n_pending: int, last: int, block: int
) -> int:
    """Give the pending cells down to `last` their home; how many stay pending."""
    while True:
        n_pending -= 1
        home[pending[n_pending]] = block
        if pending[n_pending] == last:
            return n_pending
