"""What toggling a lattice polygon does to the strands: the compiled bookkeeping.

The links on a polygon form *runs*, with gaps between. The strands join the ends of runs beyond
the polygon; swapping links and gaps joins them across the gaps instead. What these two matchings
make together are the new strands, found without a walk.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel, part
from ._strands import PATH, Board

MOST_RUNS = 4
"""A polygon of eight sides can have so many runs of links with gaps between."""

OUTSIDE = -1
"""Beyond the last run of the path lies its end."""


class Scratch(NamedTuple):
    """The polygon at hand: its corners, its runs of links, and what the strands join beyond it.

    Run r of links has the ends 2 r and 2 r + 1, at its first and last corner round the polygon.
    ``enter[: n_runs]`` are the ends where strands enter the runs, by strand and along it.
    `stretch` has room for the cells of a path.
    """

    corner: NDArray[np.int64]
    end_corner: NDArray[np.int64]
    enter: NDArray[np.int64]
    beyond: NDArray[np.int64]
    stretch: NDArray[np.int64]


END_SHARE = 0.02
"""Share of end moves among the moves proposed."""

KIND_SHARE = np.array([0.3, 0.4, 0.3 + 1e-9])
"""Shares of polygons of 4, 6 and 8 sides among the loops proposed."""

REACH = 2000
"""Cells of the path that a move without gain may turn round; beyond, it is refused."""

UNSETTLED = -2
"""Strand of a cell whose strand is being made out."""


@kernel
def new_scratch(n_cells: int) -> Scratch:
    """Room for one polygon on a board of so many cells."""
    return Scratch(
        np.empty(8, np.int64),
        np.empty(2 * MOST_RUNS, np.int64),
        np.empty(MOST_RUNS, np.int64),
        np.empty(2 * MOST_RUNS, np.int64),
        np.empty(n_cells, np.int64),
    )


@part
def find_runs(pattern: int, n: int, end_corner: NDArray[np.int64]) -> int:
    """Number of runs of links round a polygon; the corners where each begins and ends."""
    n_runs = 0
    for k in range(n):
        if (pattern >> k) & 1 and not (pattern >> ((k + n - 1) % n)) & 1:
            last = k
            while (pattern >> (last % n)) & 1:
                last += 1
            end_corner[2 * n_runs] = k
            end_corner[2 * n_runs + 1] = last % n
            n_runs += 1
    return n_runs


@part
def join_beyond(board: Board, scratch: Scratch, direction: NDArray[np.int64], n_runs: int) -> int:
    """Which ends of runs the strands join beyond the polygon; the number of cycles among them."""
    corner, end_corner, enter, beyond = (
        scratch.corner,
        scratch.end_corner,
        scratch.enter,
        scratch.beyond,
    )
    for r in range(n_runs):  # runs sorted by strand, and along it
        first = end_corner[2 * r]
        forward = board.ahead[corner[first]] == direction[first]
        end = 2 * r if forward else 2 * r + 1
        k = r
        while k > 0 and comes_before(
            board, corner[end_corner[end]], corner[end_corner[enter[k - 1]]]
        ):
            enter[k] = enter[k - 1]
            k -= 1
        enter[k] = end
    n_cycles, k = 0, 0
    while k < n_runs:
        strand, first = board.strand[corner[end_corner[enter[k]]]], k
        while k + 1 < n_runs and board.strand[corner[end_corner[enter[k + 1]]]] == strand:
            join(beyond, enter[k] ^ 1, enter[k + 1])
            k += 1
        if strand == PATH:
            beyond[enter[first]] = beyond[enter[k] ^ 1] = OUTSIDE
        else:
            join(beyond, enter[k] ^ 1, enter[first])
            n_cycles += 1
        k += 1
    return n_cycles


@part
def comes_before(board: Board, a: int, b: int) -> bool:
    """Whether cell a comes before cell b, by strand and along it."""
    if board.strand[a] != board.strand[b]:
        return board.strand[a] < board.strand[b]
    return board.key[a] < board.key[b]


@part
def join(mate: NDArray[np.int64], a: int, b: int) -> None:
    """Make a and b each other's mates."""
    mate[a] = b
    mate[b] = a


@part
def across_gap(end: int, n_runs: int) -> int:
    """The end of a run that the sides of the polygon without links join to another one."""
    return (end + 1 if end & 1 else end - 1) % (2 * n_runs)


@part
def closed_strands(beyond: NDArray[np.int64], n_runs: int) -> int:
    """Number of cycles once links and gaps of a polygon are swapped."""
    seen, n_cycles = 0, 0
    for start in range(2 * n_runs):  # first what leads outside
        if beyond[start] == OUTSIDE:
            end = start
            while end != OUTSIDE:
                seen |= 1 << end
                end = across_gap(end, n_runs)
                seen |= 1 << end
                end = beyond[end]
    for start in range(2 * n_runs):
        if not (seen >> start) & 1:
            n_cycles += 1
            end = start
            while not (seen >> end) & 1:
                seen |= 1 << end
                end = across_gap(end, n_runs)
                seen |= 1 << end
                end = beyond[end]
    return n_cycles


@part
def path_runs(board: Board, scratch: Scratch, n_runs: int) -> tuple[int, int]:
    """The end where the path first enters a run, and the one where it last leaves one; or -1."""
    n = 0
    while n < n_runs and board.strand[scratch.corner[scratch.end_corner[scratch.enter[n]]]] == PATH:
        n += 1
    return (scratch.enter[0], scratch.enter[n - 1] ^ 1) if n else (OUTSIDE, OUTSIDE)
