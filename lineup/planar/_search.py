"""Annealing a planar path on a board: the compiled part.

Cycles let cells far from the path be covered early and join it later; their price rises as the
temperature falls, and only states without cycles count as results. Most proposals are made beside
a hole: a board nearly covered has little else to win.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel, part
from ._board import (
    UNKNOWN,
    Board,
    clear,
    cycle_change,
    drop_cycles,
    recount,
    score_of,
    set_link,
    sides,
    step,
    toggle,
    weight_change,
)


class Schedule(NamedTuple):
    """(First, last) values, geometric in between: heat and price of a cycle, and heat without."""

    heat: tuple[float, float]
    cycle_cost: tuple[float, float]
    cold: tuple[float, float]


NEVER = 1e12
"""A price at which no cycle is made."""

BESIDE_HOLES = 0.8
"""Share of the proposals made within two cells of a hole."""

STRAND = 16.0
"""Steps for which strands are followed at least; with chance 1/k, for k times as many.

In a large region most strands are long and what joins them matters little, but now and then it
has to be known.
"""


@part
def drawn(board: Board, squares: NDArray[np.int32], rng: np.random.Generator) -> int:
    """A random unit square, most often near a random hole; -1 if there is none at that place."""
    n_holes = board.n_holes[0]
    if n_holes == 0 or rng.random() >= BESIDE_HOLES:
        return int(squares[int(rng.random() * squares.size)])
    hole = board.holes[int(rng.random() * n_holes)]
    place = int(rng.random() * 16)
    square = hole + (place // 4 - 2) * board.width + place % 4 - 2
    return square if square >= 0 and board.is_square[square] else -1


@kernel
def propose(
    board: Board, square: int, heat: float, cycle_cost: float, rng: np.random.Generator
) -> tuple[float, int]:
    """Toggle a square with Metropolis acceptance: (change in score, change in cycles)."""
    pattern = sides(board, square)
    gain = weight_change(board, square, pattern)
    if gain == -np.inf:
        return 0.0, 0
    # How far to look is drawn blindly, so that a move and its inverse stay as likely.
    reach = int(STRAND / (rng.random() + 1e-6)) if pattern in (5, 10) else 0
    cycles = cycle_change(board, square, pattern, reach)
    if cycles == UNKNOWN:
        return 0.0, 0
    gain += toggle(board, square)
    worth = gain - cycle_cost * cycles
    if worth < 0 and rng.random() >= np.exp(worth / heat):
        toggle(board, square)
        return 0.0, 0
    if pattern not in (5, 10):
        for cell in (square, square + 1, square + board.width, square + board.width + 1):
            recount(board, cell)
    return gain, cycles


@kernel
def anneal(
    board: Board,
    squares: NDArray[np.int32],
    n_proposals: int,
    heat: tuple[float, float],
    cycle_cost: tuple[float, float],
    score: float,
    limit: float,
    best: NDArray[np.uint8],
    rng: np.random.Generator,
) -> float:
    """Anneal from the path in `board`; its best cycle-free links go to `best`, their score back.

    `heat` and `cycle_cost` are (first, last) values, geometric in between; `score` is the
    score of the path given, and the search stops once it has reached `limit`.
    """
    best[:] = board.links
    if n_proposals == 0:
        return score
    best_score, n_cycles = score, 0
    warmth, price = heat[0], cycle_cost[0]
    cooling = (heat[1] / heat[0]) ** (1 / n_proposals)
    rise = (cycle_cost[1] / cycle_cost[0]) ** (1 / n_proposals)
    for _ in range(n_proposals):
        if best_score >= limit:
            break
        warmth *= cooling
        price *= rise
        square = drawn(board, squares, rng)
        if square < 0:
            continue
        change, cycles = propose(board, square, warmth, price, rng)
        score += change
        n_cycles += cycles
        if n_cycles == 0 and score > best_score + 1e-9:
            best_score = score
            best[:] = board.links
    return best_score


@kernel
def lay(board: Board, source: int, target: int, avoid: int, rng: np.random.Generator) -> bool:
    """Link `source` to `target` along a random shortest way through free cells but `avoid`."""
    back = np.full(board.links.size, -1, np.int8)
    queue = np.empty(board.links.size, np.int32)
    queue[0] = source
    back[source] = 4
    head, tail = 0, 1
    while head < tail and back[target] < 0:
        cell = queue[head]
        head += 1
        turn = int(rng.integers(0, 4))
        for k in range(4):
            direction = (k + turn) & 3
            other = cell + step(board.width, direction)
            free = board.inside[other] and board.links[other] == 0 and other != avoid
            if free and back[other] < 0:
                back[other] = (direction + 2) & 3
                queue[tail] = other
                tail += 1
    if back[target] < 0:
        return False
    while target != source:
        direction = back[target]
        set_link(board, target, direction)
        target += step(board.width, direction)
    return True


@kernel
def lay_through(board: Board, start: int, end: int, way: int, rng: np.random.Generator) -> bool:
    """Lay a simple path from `start` to `end` through the cell `way`, if two shortest ways do."""
    for turn in range(2):
        first, second = (start, end) if turn == 0 else (end, start)
        clear(board)
        if lay(board, way, first, second, rng) and lay(board, way, second, -1, rng):
            return True
    return False


@kernel
def anneal_twice(
    board: Board,
    squares: NDArray[np.int32],
    n_proposals: int,
    schedule: Schedule,
    ends: tuple[int, int],
    limit: float,
    best: NDArray[np.uint8],
    rng: np.random.Generator,
) -> float:
    """Anneal with cycles, drop those that found no way to join, and fill up without cycles."""
    trial = np.empty_like(best)
    score = anneal(
        board,
        squares,
        n_proposals,
        schedule.heat,
        schedule.cycle_cost,
        score_of(board),
        limit,
        best,
        rng,
    )
    drop_cycles(board, ends[0])
    second = anneal(
        board,
        squares,
        n_proposals // 4,
        schedule.cold,
        (NEVER, NEVER),
        score_of(board),
        limit,
        trial,
        rng,
    )
    if second > score:
        best[:] = trial
    return max(score, second)


@kernel
def search(
    board: Board,
    squares: NDArray[np.int32],
    ways: NDArray[np.int32],
    ends: tuple[int, int],
    effort: tuple[int, int],
    schedule: Schedule,
    limit: float,
    rng: np.random.Generator,
) -> tuple[float, NDArray[np.uint8]]:
    """The best links of several annealed starts, and their score.

    `effort` is (restarts, proposals in the last one), and each makes twice as many as the one
    before: many boards are solved by a quick look. The first restart begins from a shortest path,
    the others go through random cells of `ways`. The score is minus infinity if no path exists.
    """
    start, end = ends
    best_score = -np.inf
    best = np.zeros_like(board.links)
    trial = np.zeros_like(board.links)
    for k in range(effort[0]):
        way = ways[rng.integers(0, ways.size)] if k else start
        through = way not in (start, end) and lay_through(board, start, end, way, rng)
        if not through:
            clear(board)
            if not lay(board, start, end, -1, rng):
                break
        n_proposals = effort[1] >> (effort[0] - 1 - k)
        score = anneal_twice(board, squares, n_proposals, schedule, ends, limit, trial, rng)
        if score > best_score:
            best_score = score
            best[:] = trial
        if best_score >= limit:
            break
    return best_score, best
