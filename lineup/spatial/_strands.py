"""One path and any number of cycles on the voxels of a solid: the compiled state.

Every covered cell has two links, but for the two ends of the path. The *strands*, the path and
the cycles, are kept with an order along each, so that what a move does to them can be told
without a walk.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel, part

NO_DIRECTION = 6

FREE, PATH, UNSETTLED = -1, 0, -2
"""Strand of a cell without links, of one on the path, and of one whose strand is made out yet."""

SPACING = 1 << 32
"""Difference of the keys of consecutive cells after a walk; insertions halve it."""

N_CYCLES, N_US, LABEL = 0, 1, 2
"""Slots of `Board.tally`: cycles, Us, and the last label given to a cycle."""

Lowest = np.array([NO_DIRECTION, *((b & -b).bit_length() - 1 for b in range(1, 64))], np.int64)
"""Lowest bit set of six: the direction of the first link."""

UsOfSquare = np.array([0, 0, 0, 1, 4], np.int64)
"""What a unit square with so many path edges counts for; four are a cycle of its own."""


class Board(NamedTuple):
    """The state, on N flat cells with a margin round the solid.

    Attributes
    ----------
    stride : (6,) int64
        Difference of cell numbers along each of `grid.DIRECTIONS`.
    weight : (N,) float64
        Worth of covering a cell, 0 outside the solid.
    exits : (N,) uint8
        Bits of the directions in which no cell of the solid lies ahead.
    links : (N,) uint8
        Bits of the directions of a cell's links.
    ahead : (N,) int64
        Direction of the link to the next cell along the strand, `NO_DIRECTION` at its end.
    strand : (N,) int64
        `FREE`, `PATH`, or the label of a cycle, from 1.
    key : (N,) int64
        Rises along a strand; on a cycle, all but once.
    edges : (3 N,) uint8
        Links on the unit square at a cell (its least corner) in the plane of axes a and b:
        ``edges[3 * cell + a + b - 1]``.
    ends : (2,) int64
        First and last cell of the path.
    tally : (3,) int64
    """

    stride: NDArray[np.int64]
    weight: NDArray[np.float64]
    exits: NDArray[np.uint8]
    links: NDArray[np.uint8]
    ahead: NDArray[np.int64]
    strand: NDArray[np.int64]
    key: NDArray[np.int64]
    edges: NDArray[np.uint8]
    ends: NDArray[np.int64]
    tally: NDArray[np.int64]


@part
def flip_link(board: Board, cell: int, direction: int) -> int:
    """Set or clear a link and recount the squares it lies on; the change in Us."""
    other = cell + board.stride[direction]
    opposite = (direction + 3) % 6
    is_set = (board.links[cell] >> direction) & 1
    board.links[cell] ^= np.uint8(1 << direction)
    board.links[other] ^= np.uint8(1 << opposite)
    low, axis = (cell, direction) if direction < 3 else (other, opposite)
    change = 0
    for b in range(3):
        if b == axis:
            continue
        at = 3 * low + axis + b - 1
        for square in (at, at - 3 * board.stride[b]):
            n = board.edges[square]
            change -= UsOfSquare[n]
            n = n - 1 if is_set else n + 1
            board.edges[square] = n
            change += UsOfSquare[n]
    return change


@part
def onward(board: Board, cell: int, back: int) -> int:
    """Direction of a cell's link other than `back`, or `NO_DIRECTION`."""
    rest = int(board.links[cell])
    if back != NO_DIRECTION:
        rest &= ~(1 << back)
    return int(Lowest[rest])


@part
def order_strand(board: Board, start: int, label: int) -> int:
    """Walk the strand through `start`, the first cell of a path, and write its order; its size."""
    cell, back, key, n = start, NO_DIRECTION, np.int64(0), 0
    while True:
        direction = onward(board, cell, back)
        board.strand[cell] = label
        board.key[cell] = key
        board.ahead[cell] = direction
        key += SPACING
        n += 1
        if direction == NO_DIRECTION:
            return n
        cell += board.stride[direction]
        back = (direction + 3) % 6
        if cell == start:
            return n


@kernel
def lay(board: Board, path: NDArray[np.int64]) -> None:
    """Set the links of a path on an empty board."""
    for k in range(path.size - 1):
        step = path[k + 1] - path[k]
        for direction in range(6):
            if board.stride[direction] == step:
                board.tally[N_US] += flip_link(board, path[k], direction)
    board.ends[0], board.ends[1] = path[0], path[-1]
    order_strand(board, path[0], PATH)


@kernel
def path_cells(board: Board) -> NDArray[np.int64]:
    """The cells of the path, from its first to its last."""
    cells = np.empty(board.links.size, np.int64)
    cell, n = board.ends[0], 0
    while True:
        cells[n] = cell
        n += 1
        direction = board.ahead[cell]
        if direction == NO_DIRECTION:
            return cells[:n].copy()
        cell += board.stride[direction]


@kernel
def drop_cycles(board: Board) -> None:
    """Take away all cycles."""
    for cell in range(board.links.size):
        if board.strand[cell] > PATH:
            for direction in range(3):
                if (board.links[cell] >> direction) & 1:
                    board.tally[N_US] += flip_link(board, cell, direction)
    for cell in range(board.links.size):
        if board.strand[cell] > PATH:
            board.strand[cell] = FREE
    board.tally[N_CYCLES] = 0
