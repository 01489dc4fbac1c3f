"""Annealing one path and any number of cycles: the compiled moves.

Two kinds of move serve for all. A *loop toggle* swaps which sides of a closed lattice polygon are
links: it covers voxels, frees them, re-routes, splits and joins strands. It is allowed when each
corner that has no link on the polygon, neither before nor to be, is free. An *end move* lets the
path grow by a cell, lose one, or turn about: its end joins a cell of a strand beside it, and
that cell's link on the far side goes.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel, part
from ._loops import Loops
from ._runs import (
    OUTSIDE,
    Scratch,
    closed_strands,
    find_runs,
    join_beyond,
    new_scratch,
    path_runs,
)
from ._strands import (
    FREE,
    LABEL,
    N_CYCLES,
    N_US,
    NO_DIRECTION,
    PATH,
    SPACING,
    UNSETTLED,
    Board,
    flip_link,
    onward,
    order_strand,
)

LOOSE = SPACING // 16
"""Difference of keys below which a stretch is too dense, and its path is walked as a whole.

Then a difference of keys tells about how many cells lie between.
"""

REACH = 1000
"""Cells of the path that a move without gain may always turn round; see `is_spared`."""

END_SHARE = 0.1
"""Share of end moves among the moves proposed."""

KIND_SHARE = np.array([0.3, 0.4, 0.3 + 1e-9])
"""Shares of polygons of 4, 6 and 8 sides among the loops proposed."""

BLOCK = 1024
"""Proposals at the same heat and prices."""


class Terms(NamedTuple):
    """Heat, and the prices of a U, of a cycle, and of a path neither end of which sees out."""

    heat: float
    u_price: float
    cycle_price: float
    hidden: float


class Stage(NamedTuple):
    """First and last `Terms`; heat and price of a cycle are geometric in between."""

    first: Terms
    last: Terms


@part
def pattern_of(board: Board, loops: Loops, loop: int, corner: NDArray[np.int64]) -> int:
    """Bits of the sides of a polygon that are links; its corners are written down."""
    shape, anchor = loops.shape[loop], loops.anchor[loop]
    pattern = 0
    for k in range(loops.n_sides[shape]):
        corner[k] = anchor + loops.offset[shape, k]
        pattern |= ((int(board.links[corner[k]]) >> loops.direction[shape, k]) & 1) << k
    return pattern


@part
def weight_gain(board: Board, corner: NDArray[np.int64], pattern: int, n: int) -> float:
    """Gain in covered weight of toggling a polygon; minus infinity if it is not allowed."""
    gain = 0.0
    before = (pattern >> (n - 1)) & 1
    for k in range(n):
        after = (pattern >> k) & 1
        if before == after:
            if after:
                gain -= board.weight[corner[k]]
            elif board.links[corner[k]]:
                return -np.inf
            else:
                gain += board.weight[corner[k]]
        before = after
    return gain


@part
def flip_sides(
    board: Board, corner: NDArray[np.int64], direction: NDArray[np.int64], pattern: int, n: int
) -> int:
    """Swap links and gaps of a polygon; the change in Us. With the new pattern it undoes itself."""
    change = 0
    for links in range(1, -1, -1):  # clear before setting, so that no cell ever has three links
        for k in range(n):
            if (pattern >> k) & 1 == links:
                change += flip_link(board, corner[k], direction[k])
    return change


@part
def settle_detour(board: Board, scratch: Scratch, direction: NDArray[np.int64], n: int) -> None:
    """Bring the order up to date where one run of links gave way to a detour."""
    corner, end_corner = scratch.corner, scratch.end_corner
    first, last = end_corner[0], end_corner[1]
    forward = board.ahead[corner[first]] == direction[first]
    strand = board.strand[corner[first]]
    k = (first + 1) % n
    while k != last:
        board.strand[corner[k]] = FREE
        k = (k + 1) % n
    # From where the strand comes in, the detour runs the other way round the polygon.
    k, goal, turn = (first, last, n - 1) if forward else (last, first, 1)
    n_new = (k - goal) % n if forward else (goal - k) % n
    low, high = board.key[corner[k]], board.key[corner[goal]]
    gap = (high - low) // n_new if high > low else SPACING
    key = low
    while k != goal:
        cell = corner[k]
        board.strand[cell] = strand
        board.key[cell] = key
        board.ahead[cell] = (direction[(k - 1) % n] + 3) % 6 if forward else direction[k]
        key += gap
        k = (k + turn) % n
    if gap == 0:
        order_strand(board, board.ends[0] if strand == PATH else corner[first], strand)


@part
def order_stretch(
    board: Board, first: int, direction: int, last: int, stretch: NDArray[np.int64]
) -> None:
    """Bring the path up to date from one of its cells, along `direction`, to another."""
    n, cell = 0, first
    while cell != last:
        stretch[n] = cell
        board.ahead[cell] = direction
        cell += board.stride[direction]
        direction = onward(board, cell, (direction + 3) % 6)
        n += 1
    gap = (board.key[last] - board.key[first]) // n
    if gap < LOOSE:
        order_strand(board, board.ends[0], PATH)
        return
    key = board.key[first]
    for k in range(n):
        board.strand[stretch[k]] = PATH
        board.key[stretch[k]] = key
        key += gap


@part
def settle_strands(
    board: Board,
    scratch: Scratch,
    direction: NDArray[np.int64],
    n: int,
    first: int,
    last: int,
) -> None:
    """Bring the order up to date after strands were made, taken away, split, joined or turned.

    `first` and `last` are what `path_runs` found.
    """
    corner = scratch.corner
    for k in range(n):
        board.strand[corner[k]] = UNSETTLED if board.links[corner[k]] else FREE
    if first != OUTSIDE:
        k = scratch.end_corner[first]
        gap = direction[k] if first & 1 else (direction[(k - 1) % n] + 3) % 6
        final = corner[scratch.end_corner[last]]
        order_stretch(board, corner[k], gap, final, scratch.stretch)
        board.strand[final] = PATH
    for k in range(n):
        if board.strand[corner[k]] == UNSETTLED:
            board.tally[LABEL] += 1
            order_strand(board, corner[k], board.tally[LABEL])


@part
def is_spared(board: Board, a: int, b: int, rng: np.random.Generator) -> bool:
    """Whether to leave alone what lies between two cells of the path: the likelier the longer.

    The chance of a move is `REACH` over its length, so that its mean cost has a bound.
    """
    return abs(board.key[b] - board.key[a]) * rng.random() > REACH * SPACING


@part
def swap(
    board: Board,
    scratch: Scratch,
    direction: NDArray[np.int64],
    pattern: int,
    n: int,
    gain: float,
    threshold: float,
    terms: Terms,
    rng: np.random.Generator,
) -> bool:
    """Swap links and gaps of a polygon if that gains enough; whether it did.

    `gain` is what `weight_gain` found.
    """
    corner = scratch.corner
    n_runs = find_runs(pattern, n, scratch.end_corner)
    cycles, first, last = 0, OUTSIDE, OUTSIDE
    if n_runs == 0:
        cycles = -1 if pattern else 1
    elif n_runs > 1:
        cycles = -join_beyond(board, scratch, direction, n_runs)
        cycles += closed_strands(scratch.beyond, n_runs)
        first, last = path_runs(board, scratch, n_runs)
    gain -= terms.cycle_price * cycles
    if gain + terms.u_price * board.tally[N_US] < threshold:  # however many Us it may undo
        return False
    a, b = scratch.end_corner[first], scratch.end_corner[last]
    if first != OUTSIDE and gain <= 0 and is_spared(board, corner[a], corner[b], rng):
        return False
    us = flip_sides(board, corner, direction, pattern, n)
    if gain - terms.u_price * us < threshold:
        flip_sides(board, corner, direction, ~pattern, n)
        return False
    board.tally[N_CYCLES] += cycles
    board.tally[N_US] += us
    if n_runs == 1:
        settle_detour(board, scratch, direction, n)
    else:
        settle_strands(board, scratch, direction, n, first, last)
    return True


@part
def try_loop(
    board: Board,
    loops: Loops,
    loop: int,
    scratch: Scratch,
    threshold: float,
    terms: Terms,
    rng: np.random.Generator,
) -> None:
    """Toggle a polygon if that is allowed and gains enough."""
    shape = loops.shape[loop]
    n = loops.n_sides[shape]
    pattern = pattern_of(board, loops, loop, scratch.corner)
    gain = weight_gain(board, scratch.corner, pattern, n)
    if gain > -np.inf:
        swap(board, scratch, loops.direction[shape], pattern, n, gain, threshold, terms, rng)


@part
def exposure_gain(board: Board, side: int, new_end: int, hidden: float) -> float:
    """Gain of moving one end of the path, where `hidden` is the price of no end seeing out."""
    if board.exits[board.ends[1 - side]]:
        return 0.0
    before, after = board.exits[board.ends[side]] > 0, board.exits[new_end] > 0
    return hidden * (int(after) - int(before))


@part
def order_on(board: Board, cell: int, back: int, side: int) -> None:
    """Bring the path up to date from `cell` to its end on a side; direction `back` is in order."""
    before = cell + board.stride[back]
    key = board.key[before]
    if side == 1:
        board.ahead[before] = (back + 3) % 6
    while True:
        direction = onward(board, cell, back)
        key += SPACING if side == 1 else -SPACING
        board.strand[cell] = PATH
        board.key[cell] = key
        board.ahead[cell] = direction if side == 1 else back
        if direction == NO_DIRECTION:
            board.ends[side] = cell
            return
        cell += board.stride[direction]
        back = (direction + 3) % 6


@part
def try_retreat(board: Board, side: int, threshold: float, terms: Terms) -> None:
    """Free an end of the path."""
    end = board.ends[side]
    direction = onward(board, end, NO_DIRECTION)
    new_end = end + board.stride[direction]
    if new_end == board.ends[1 - side]:
        return
    us = flip_link(board, end, direction)
    gain = exposure_gain(board, side, new_end, terms.hidden) - board.weight[end]
    if gain - terms.u_price * us < threshold:
        flip_link(board, end, direction)
        return
    board.tally[N_US] += us
    board.strand[end] = FREE
    board.ends[side] = new_end
    if side == 1:
        board.ahead[new_end] = NO_DIRECTION


@part
def try_advance(
    board: Board,
    side: int,
    direction: int,
    threshold: float,
    terms: Terms,
    rng: np.random.Generator,
) -> None:
    """Let an end of the path grow into the next cell, or join the strand that is there.

    A path that joins itself turns about; a cycle that it joins is swallowed.
    """
    end = board.ends[side]
    cell = end + board.stride[direction]
    linked = (board.links[end] >> direction) & 1
    if board.weight[cell] == 0 or linked or cell == board.ends[1 - side]:
        return
    strand = board.strand[cell]
    new_end, cut, us = cell, NO_DIRECTION, 0
    gain = board.weight[cell]
    if strand != FREE:
        forward = side == 1 if strand == PATH else rng.random() < 0.5
        cut = board.ahead[cell] if forward else onward(board, cell, board.ahead[cell])
        new_end = cell + board.stride[cut]
        gain = 0.0 if strand == PATH else terms.cycle_price
    gain += exposure_gain(board, side, new_end, terms.hidden)
    if gain + terms.u_price * board.tally[N_US] < threshold:
        return
    if strand == PATH and gain <= 0 and is_spared(board, cell, end, rng):
        return
    if cut != NO_DIRECTION:
        us += flip_link(board, cell, cut)
    us += flip_link(board, end, direction)
    if gain - terms.u_price * us < threshold:
        flip_link(board, end, direction)
        if cut != NO_DIRECTION:
            flip_link(board, cell, cut)
        return
    board.tally[N_US] += us
    board.tally[N_CYCLES] -= strand > PATH
    if strand == PATH:
        order_on(board, end, direction, side)
    else:
        order_on(board, cell, (direction + 3) % 6, side)


@part
def terms_at(stage: Stage, share: float) -> Terms:
    """The terms after a share of a stage."""
    first, last = stage
    return Terms(
        first.heat * (last.heat / first.heat) ** share,
        first.u_price + (last.u_price - first.u_price) * share,
        first.cycle_price * (last.cycle_price / first.cycle_price) ** share,
        first.hidden + (last.hidden - first.hidden) * share,
    )


@kernel
def anneal(
    board: Board, loops: Loops, stage: Stage, n_proposals: int, rng: np.random.Generator
) -> None:
    """Propose so many moves, most of them loops, with Metropolis acceptance."""
    scratch = new_scratch(board.links.size)
    for k in range(n_proposals):
        if k % BLOCK == 0:
            terms = terms_at(stage, k / n_proposals)
        threshold = terms.heat * np.log(rng.random())
        if rng.random() < END_SHARE:
            side, direction = int(rng.integers(0, 2)), int(rng.integers(0, 7))
            if direction == NO_DIRECTION:
                try_retreat(board, side, threshold, terms)
            else:
                try_advance(board, side, direction, threshold, terms, rng)
            continue
        kind, draw = 0, rng.random()
        while draw > KIND_SHARE[kind]:
            draw -= KIND_SHARE[kind]
            kind += 1
        first, last = loops.first[kind], loops.first[kind + 1]
        if first < last:
            try_loop(board, loops, rng.integers(first, last), scratch, threshold, terms, rng)
