"""Annealing a nested path: the moves that keep every excursion between two adjacent voxels.

A nested path is a tree of planar *pieces*. A piece hangs off another by a *bridge*: two vertical
links side by side that stand for one link of each piece (Section 4.2, Case 2). The pieces of the
MSP are strung on single vertical links (Case 1). So a move in a layer may join any two strands,
but within one strand only what lies in one piece; and a vertical unit square may

- hang a new piece of two voxels under or over a link, or take it away,
- bridge two strands, or take a bridge away,
- move a vertical link of the MSP to the next column.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel, part
from ._anneal import BLOCK, Stage, Terms, pattern_of, swap, terms_at, weight_gain
from ._loops import Loops
from ._runs import Scratch, new_scratch
from ._strands import LABEL, NO_DIRECTION, UNSETTLED, Board, Lowest

UP, DOWN = 2, 5

SINGLE = 6
"""Mate of a vertical link that is not half of a bridge."""

LEAF_ABOVE, LEAF_BELOW = (0b1000, 0b0111), (0b0010, 0b1101)
"""Sides of a vertical square that are links before and after a leaf is hung there."""

LEVELS, COLUMNS = 0b1010, 0b0101
"""The sides of a vertical square that lie in a layer, and those that do not."""

ROUND_FIRST, ROUND_SECOND = (0b0011, 0b1001), (0b0110, 0b1100)
"""One vertical side of such a square, at its first or second column, and a level one beside it."""


class Nest(NamedTuple):
    """What a board does not say of its pieces, on N flat cells.

    Attributes
    ----------
    mate : (N,) int64
        For a cell with a link upwards, the direction of the other half of its bridge, or `SINGLE`.
    piece : (N,) int64
        Label of the piece of a covered cell.
    """

    mate: NDArray[np.int64]
    piece: NDArray[np.int64]


@part
def step_in_piece(board: Board, nest: Nest, cell: int, slot: int) -> tuple[int, int]:
    """The next cell of a piece and the slot of it that leads back; -1 where the piece ends.

    A slot is the direction of a link; a vertical link leads to where its bridge comes back.
    """
    if slot != UP and slot != DOWN:
        return cell + board.stride[slot], (slot + 3) % 6
    mate = nest.mate[cell if slot == UP else cell + board.stride[DOWN]]
    if mate == SINGLE:
        return -1, slot
    return cell + board.stride[mate], slot


@kernel
def label_piece(board: Board, nest: Nest, start: int, label: int) -> None:
    """Give the piece through `start` a label."""
    nest.piece[start] = label
    slots = int(board.links[start])
    while slots:
        slot = int(Lowest[slots])
        slots &= slots - 1
        cell, back = step_in_piece(board, nest, start, slot)
        while cell >= 0 and cell != start:
            nest.piece[cell] = label
            onward = Lowest[int(board.links[cell]) & ~(1 << back)]
            if onward == NO_DIRECTION:
                break
            cell, back = step_in_piece(board, nest, cell, onward)
        if cell == start:
            return


@part
def label_corners(board: Board, nest: Nest, corner: NDArray[np.int64], n: int) -> None:
    """Label the pieces through the corners of a square anew."""
    for k in range(n):
        nest.piece[corner[k]] = UNSETTLED
    for k in range(n):
        if board.links[corner[k]] and nest.piece[corner[k]] == UNSETTLED:
            board.tally[LABEL] += 1
            label_piece(board, nest, corner[k], board.tally[LABEL])


@part
def is_bridge(nest: Nest, corner: NDArray[np.int64], direction: NDArray[np.int64]) -> bool:
    """Whether the two vertical links of a vertical square are halves of one bridge."""
    return nest.mate[corner[0]] == direction[1]


@part
def keeps_nesting(
    board: Board,
    nest: Nest,
    corner: NDArray[np.int64],
    direction: NDArray[np.int64],
    pattern: int,
) -> bool:
    """Whether toggling a unit square leaves a nested path and nested cycles."""
    opposite = pattern in (LEVELS, COLUMNS)
    same_strand = board.strand[corner[0]] == board.strand[corner[2]]
    if direction[0] != UP:
        same_piece = nest.piece[corner[0]] == nest.piece[corner[2]]
        return not opposite or not same_strand or same_piece
    if pattern in (LEAF_ABOVE[0], LEAF_BELOW[0]):
        return True
    if pattern in (LEAF_ABOVE[1], LEAF_BELOW[1], COLUMNS):
        return is_bridge(nest, corner, direction)
    if pattern == LEVELS:
        return not same_strand
    if pattern in ROUND_FIRST:
        return nest.mate[corner[0]] == SINGLE
    if pattern in ROUND_SECOND:
        return nest.mate[corner[3]] == SINGLE
    return False


@part
def settle_pieces(
    board: Board,
    nest: Nest,
    corner: NDArray[np.int64],
    direction: NDArray[np.int64],
    pattern: int,
) -> None:
    """Bring mates and pieces up to date after a unit square was toggled from `pattern`."""
    opposite = pattern in (LEVELS, COLUMNS)
    if direction[0] == UP:
        low, high = corner[0], corner[3]
        if pattern in (LEAF_ABOVE[0], LEAF_BELOW[0], LEVELS):
            nest.mate[low], nest.mate[high] = direction[1], direction[3]
        elif pattern not in (LEAF_ABOVE[1], LEAF_BELOW[1], COLUMNS):
            nest.mate[low] = nest.mate[high] = SINGLE
        if opposite:
            return
    label_corners(board, nest, corner, 4)


@part
def try_square(
    board: Board,
    nest: Nest,
    loops: Loops,
    loop: int,
    scratch: Scratch,
    threshold: float,
    terms: Terms,
    rng: np.random.Generator,
) -> None:
    """Toggle a unit square if that keeps the nesting and gains enough."""
    corner, direction = scratch.corner, loops.direction[loops.shape[loop]]
    pattern = pattern_of(board, loops, loop, corner)
    gain = weight_gain(board, corner, pattern, 4)
    if (
        gain > -np.inf
        and keeps_nesting(board, nest, corner, direction, pattern)
        and swap(board, scratch, direction, pattern, 4, gain, threshold, terms, rng)
    ):
        settle_pieces(board, nest, corner, direction, pattern)


@kernel
def anneal_nested(
    board: Board,
    nest: Nest,
    loops: Loops,
    stage: Stage,
    n_proposals: int,
    rng: np.random.Generator,
) -> None:
    """Propose so many toggles of unit squares, with Metropolis acceptance."""
    scratch = new_scratch(board.links.size)
    n_squares = loops.first[1]
    for k in range(n_proposals if n_squares else 0):
        if k % BLOCK == 0:
            terms = terms_at(stage, k / n_proposals)
        threshold = terms.heat * np.log(rng.random())
        try_square(board, nest, loops, rng.integers(0, n_squares), scratch, threshold, terms, rng)
