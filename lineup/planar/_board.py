"""One path and any number of cycles on a planar grid, changed by toggling unit squares.

The state is kept as four link bits a cell. One move serves for all: pick a unit square of four
cells and swap which of its sides are links. By the links on its sides this is

====================  ==============================================================
no side               a new cycle of four cells
one side              EXTEND: a detour over two free cells
two adjacent sides    a corner flip: one cell is freed, one is taken
two opposite sides    a reversal within one strand, a split, or a merge with a cycle
three sides           the inverse of EXTEND
four sides            a cycle of four cells is taken away
====================  ==============================================================

and it is allowed whenever each corner that neither had a link on the square nor is free keeps
two links at most.

Direction d of a link is a step of ``(1, width, -1, -width)[d]`` between flat cell numbers.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel, part

ONE_LINK = np.array([-1, 0, 1, -1, 2, -1, -1, -1, 3], dtype=np.int64)
"""Direction of the only bit set in a cell's links."""

BOTH_SIDES = np.array([0b0011, 0b0110, 0b1100, 0b1001], dtype=np.uint8)
"""The links of each corner of a unit square along its two sides."""

CYCLES_MADE = np.array([0, -1, 0, 1], dtype=np.int64)
"""By ``i ^ j`` where a strand joins corners i and j, the first link that goes being from 0 to 1."""

END, UNKNOWN = 4, 5
"""In place of the number of a corner or a change in cycles: no corner, not found within reach."""

FIRST_LOOK = 16
"""Steps that a strand is followed at first."""


class Board(NamedTuple):
    """What a search reads and writes, on N flat cells with a margin round the region.

    ``wanted[s, d, c]`` is the number of the bonus for a link from cell c in direction d (0 or 1),
    or -1; the slots s = 0, 1 allow two bonuses a link. A bonus counts once, however many of its
    links are set: ``n_set`` is their number. ``is_square`` says which cells are the first of a
    unit square inside. ``holes[:n_holes[0]]`` are the cells inside without a link, and cell c
    stands there at ``hole_at[c]`` (-1 if it does not).
    """

    width: int
    inside: NDArray[np.bool_]
    weight: NDArray[np.float64]
    wanted: NDArray[np.int32]
    bonus: NDArray[np.float64]
    is_square: NDArray[np.bool_]
    links: NDArray[np.uint8]
    n_set: NDArray[np.int32]
    holes: NDArray[np.int32]
    hole_at: NDArray[np.int32]
    n_holes: NDArray[np.int32]


def new_board(
    width: int,
    inside: NDArray[np.bool_],
    weight: NDArray[np.float64],
    wanted: NDArray[np.int32],
    bonus: NDArray[np.float64],
) -> Board:
    """A board without links."""
    n = inside.size
    is_square = inside.copy()
    is_square[: -width - 1] &= inside[1:-width] & inside[width:-1] & inside[width + 1 :]
    board = Board(
        width,
        inside,
        weight,
        wanted,
        bonus,
        is_square,
        np.zeros(n, np.uint8),
        np.zeros(bonus.size, np.int32),
        np.zeros(n, np.int32),
        np.zeros(n, np.int32),
        np.zeros(1, np.int32),
    )
    clear(board)
    return board


@kernel
def clear(board: Board) -> None:
    """Take all links away."""
    board.links[:] = 0
    board.n_set[:] = 0
    board.hole_at[:] = -1
    board.n_holes[0] = 0
    for cell in range(board.inside.size):
        if board.inside[cell]:
            recount(board, cell)


@part
def recount(board: Board, cell: int) -> None:
    """Make the list of holes right about one cell."""
    at, n = board.hole_at[cell], board.n_holes[0]
    if board.links[cell] == 0 and at < 0:
        board.holes[n] = cell
        board.hole_at[cell] = n
        board.n_holes[0] = n + 1
    elif board.links[cell] and at >= 0:
        last = board.holes[n - 1]
        board.holes[at] = last
        board.hole_at[last] = at
        board.hole_at[cell] = -1
        board.n_holes[0] = n - 1


@part
def step(width: int, direction: int) -> int:
    """Difference of flat cell numbers along one direction 0..3."""
    return (1, width, -1, -width)[direction]


@part
def direction_of(width: int, difference: int) -> int:
    """Direction 0..3 of a step, the inverse of `step`."""
    if abs(difference) == 1:
        return 0 if difference == 1 else 2
    return 1 if difference == width else 3


@part
def earned(board: Board, cell: int, axis: int) -> float:
    """Take note of a changed link, from a cell along axis 0 or 1; the change in bonuses."""
    is_set = (board.links[cell] >> axis) & 1
    change = 0.0
    for slot in range(2):
        group = board.wanted[slot, axis, cell]
        if group >= 0:
            if is_set:
                board.n_set[group] += 1
                if board.n_set[group] == 1:
                    change += board.bonus[group]
            else:
                board.n_set[group] -= 1
                if board.n_set[group] == 0:
                    change -= board.bonus[group]
    return change


@part
def set_link(board: Board, cell: int, direction: int) -> None:
    """Set a link that is not set."""
    other = cell + step(board.width, direction)
    board.links[cell] |= np.uint8(1 << direction)
    board.links[other] |= np.uint8(1 << ((direction + 2) & 3))
    earned(board, cell if direction < 2 else other, direction & 1)
    recount(board, cell)
    recount(board, other)


@kernel
def sides(board: Board, square: int) -> int:
    """Bits of the links on the sides of a unit square, side k from corner k to corner k + 1.

    Corner 0 is the cell `square`; the corners go round so that side k has direction k.
    """
    width = board.width
    return int(
        (board.links[square] & 1)
        | (board.links[square + 1] & 2)
        | (board.links[square + 1 + width] & 4)
        | (board.links[square + width] & 8)
    )


@part
def corner(width: int, square: int, k: int) -> int:
    """Cell at corner k (mod 4) of a unit square."""
    return square + (0, 1, width + 1, width)[k & 3]


@part
def weight_change(board: Board, square: int, pattern: int) -> float:
    """Gain in covered weight of toggling a square; minus infinity if that is not allowed."""
    gain = 0.0
    for k in range(4):
        before, after = (pattern >> ((k + 3) & 3)) & 1, (pattern >> k) & 1
        if before != after:
            continue
        cell = corner(board.width, square, k)
        if before:
            gain -= board.weight[cell]
        elif board.links[cell]:
            return -np.inf
        else:
            gain += board.weight[cell]
    return gain


@part
def follow(
    links: NDArray[np.uint8],
    width: int,
    start: int,
    taken: int,
    corners: tuple[int, int, int, int],
    reach: int,
) -> int:
    """Where the strand from `start`, not along direction `taken`, leads in `reach` steps at most.

    The number of the corner met, END if the path ends first, UNKNOWN if the steps do not suffice.
    """
    p, q, r, s = corners
    cell, back = start, taken
    for _ in range(reach):
        ahead = int(links[cell]) & ~(1 << back)
        if ahead == 0:
            return END
        direction = ONE_LINK[ahead]
        cell += step(width, direction)
        back = (direction + 2) & 3
        if cell == p:
            return 0
        if cell == q:
            return 1
        if cell == r:
            return 2
        if cell == s:
            return 3
    return UNKNOWN


@kernel
def cycle_change(board: Board, square: int, pattern: int, reach: int) -> int:
    """How many cycles more (+1) or fewer (-1) toggling a square makes.

    Only two opposite sides leave it open. Without them four strands hang loose at the corners;
    each is followed a little and then four times as far, up to `reach` steps, so the shorter
    ones decide. Two that meet are one strand; so are two if the others end with the path.
    """
    if pattern == 0:
        return 1
    if pattern == 15:
        return -1
    if pattern != 5 and pattern != 10:
        return 0
    turn = 0 if pattern == 5 else 1
    # Links 0-1 and 2-3 of these corners give way to 1-2 and 3-0.
    corners = (
        corner(board.width, square, turn),
        corner(board.width, square, turn + 1),
        corner(board.width, square, turn + 2),
        corner(board.width, square, turn + 3),
    )
    span = FIRST_LOOK
    while span <= reach:
        ended = -1
        for k in range(4):
            taken = turn if k in (0, 3) else turn + 2
            met = follow(board.links, board.width, corners[k], taken & 3, corners, span)
            if met == END and ended < 0:
                ended = k
            elif met == END:
                return int(CYCLES_MADE[k ^ ended])
            elif met != UNKNOWN:
                return int(CYCLES_MADE[k ^ met])
        span *= 4
    return UNKNOWN


@kernel
def toggle(board: Board, square: int) -> float:
    """Toggle the four sides of a square; the change in bonuses. Twice is no change.

    The holes are left as they were: see `recount`.
    """
    width = board.width
    for k in range(4):
        board.links[corner(width, square, k)] ^= BOTH_SIDES[k]
    if board.bonus.size == 0:
        return 0.0
    return (
        earned(board, square, 0)
        + earned(board, square + 1, 1)
        + earned(board, square + width, 0)
        + earned(board, square, 1)
    )


@kernel
def score_of(board: Board) -> float:
    """Weight of the covered cells and the bonuses earned."""
    score = 0.0
    for cell in range(board.links.size):
        if board.links[cell]:
            score += board.weight[cell]
    for group in range(board.bonus.size):
        if board.n_set[group] > 0:
            score += board.bonus[group]
    return score


@kernel
def unrolled(links: NDArray[np.uint8], width: int, start: int) -> NDArray[np.int32]:
    """The cells of the path that begins at `start`, in order."""
    path = np.empty(links.size, np.int32)
    path[0] = start
    n, cell, ahead = 1, start, int(links[start])
    while ahead:
        direction = ONE_LINK[ahead]
        cell += step(width, direction)
        path[n] = cell
        n += 1
        ahead = int(links[cell]) & ~(1 << ((direction + 2) & 3))
    return path[:n].copy()


@kernel
def drop_cycles(board: Board, start: int) -> None:
    """Leave the path that begins at `start` and nothing else."""
    path = unrolled(board.links, board.width, start)
    clear(board)
    for k in range(path.size - 1):
        set_link(board, path[k], direction_of(board.width, path[k + 1] - path[k]))
