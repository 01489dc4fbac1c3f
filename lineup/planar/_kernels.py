"""Annealing a planar path by toggling unit squares: the compiled part.

The state is one path between two fixed ends plus any number of cycles, kept as four link bits a
cell. One move serves for all: pick a unit square of four cells and swap which of its sides are
links. By the links on its sides this is

====================  ==============================================================
no side               a new cycle of four cells
one side              EXTEND: a detour over two free cells
two adjacent sides    a corner flip: one cell is freed, one is taken
two opposite sides    a reversal within one strand, a split, or a merge with a cycle
three sides           the inverse of EXTEND
four sides            a cycle of four cells is taken away
====================  ==============================================================

and it is allowed whenever each corner that neither had a link on the square nor is free keeps
two links at most. Cycles let cells far from the path be covered early and join it later; their
price rises as the temperature falls, and only states without cycles count as results.

Direction d of a link is a step of ``(1, width, -1, -width)[d]`` between flat cell numbers.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel

OneLink = np.array([-1, 0, 1, -1, 2, -1, -1, -1, 3], dtype=np.int64)
"""Direction of the only bit set in a cell's links."""


class Board(NamedTuple):
    """What a search reads and writes, on N flat cells with a margin round the region.

    ``wanted[s, d, c]`` is the number of the bonus for a link from cell c in direction d (0 or 1),
    or -1; the slots s = 0, 1 allow two bonuses a link. A bonus counts once, however many of its
    links are set: ``n_set`` is their number.
    """

    width: int
    inside: NDArray[np.bool_]
    weight: NDArray[np.float64]
    wanted: NDArray[np.int32]
    bonus: NDArray[np.float64]
    links: NDArray[np.uint8]
    n_set: NDArray[np.int32]


class Schedule(NamedTuple):
    """(First, last) values, geometric in between: heat and price of a cycle, and heat without."""

    heat: tuple[float, float]
    cycle_cost: tuple[float, float]
    cold: tuple[float, float]


NEVER = 1e12
"""A price at which no cycle is made."""


@kernel
def step(width: int, direction: int) -> int:
    """Difference of flat cell numbers along one direction 0..3."""
    if direction == 0:
        return 1
    if direction == 1:
        return width
    if direction == 2:
        return -1
    return -width


@kernel
def direction_of(width: int, difference: int) -> int:
    """Direction 0..3 of a step, the inverse of `step`."""
    if abs(difference) == 1:
        return 0 if difference == 1 else 2
    return 1 if difference == width else 3


@kernel
def flip_link(board: Board, cell: int, direction: int) -> float:
    """Set or clear one link; the change in bonuses."""
    other = cell + step(board.width, direction)
    board.links[cell] ^= np.uint8(1 << direction)
    board.links[other] ^= np.uint8(1 << ((direction + 2) & 3))
    is_set = (board.links[cell] >> direction) & 1
    low = cell if direction < 2 else other
    change = 0.0
    for slot in range(2):
        group = board.wanted[slot, direction & 1, low]
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


@kernel
def corner(width: int, square: int, k: int) -> int:
    """Cell at corner k (mod 4) of a unit square."""
    k &= 3
    if k == 0:
        return square
    if k == 1:
        return square + 1
    if k == 2:
        return square + 1 + width
    return square + width


@kernel
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


@kernel
def follow(board: Board, start: int, taken: int, a: int, b: int, c: int) -> int:
    """First of the cells a, b, c on the strand from `start` not along direction `taken`.

    -1 if the strand ends before it meets one of them.
    """
    cell, back = start, taken
    while True:
        ahead = int(board.links[cell]) & ~(1 << back)
        if ahead == 0:
            return -1
        direction = OneLink[ahead]
        cell += step(board.width, direction)
        if cell in (a, b, c):
            return cell
        back = (direction + 2) & 3


@kernel
def cycle_change(board: Board, square: int, pattern: int) -> int:
    """How many cycles more (+1) or fewer (-1) toggling a square makes."""
    if pattern == 0:
        return 1
    if pattern == 15:
        return -1
    if pattern != 5 and pattern != 10:
        return 0
    k = 0 if pattern == 5 else 1
    p, q = corner(board.width, square, k), corner(board.width, square, k + 1)
    r, s = corner(board.width, square, k + 2), corner(board.width, square, k + 3)
    # Links p-q and r-s give way to q-r and s-p.
    met = follow(board, p, k, q, r, s)
    if met == -1:
        met = follow(board, q, (k + 2) & 3, p, r, s)
        if met == -1:
            return -1
        return 1 if met == r else 0
    if met == q:
        return -1
    return 1 if met == s else 0


@kernel
def toggle(board: Board, square: int, pattern: int) -> float:
    """Toggle the four sides of a square; the change in bonuses. Twice is no change."""
    change = 0.0
    for k in range(4):  # clear before setting, so that no cell ever has three links
        if (pattern >> k) & 1:
            change += flip_link(board, corner(board.width, square, k), k)
    for k in range(4):
        if not (pattern >> k) & 1:
            change += flip_link(board, corner(board.width, square, k), k)
    return change


@kernel
def propose(
    board: Board, square: int, heat: float, cycle_cost: float, rng: np.random.Generator
) -> tuple[float, int]:
    """Toggle a square with Metropolis acceptance: (change in score, change in cycles)."""
    pattern = sides(board, square)
    gain = weight_change(board, square, pattern)
    if gain == -np.inf:
        return 0.0, 0
    threshold = heat * np.log(rng.random())
    cycles = cycle_change(board, square, pattern)
    gain += toggle(board, square, pattern)
    if gain - cycle_cost * cycles < threshold:
        toggle(board, square, pattern ^ 15)
        return 0.0, 0
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
        square = squares[rng.integers(0, squares.size)]
        change, cycles = propose(board, square, warmth, price, rng)
        warmth *= cooling
        price *= rise
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
        flip_link(board, target, direction)
        target += step(board.width, direction)
    return True


@kernel
def clear(board: Board) -> None:
    """Take all links away."""
    board.links[:] = 0
    board.n_set[:] = 0


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
        direction = OneLink[ahead]
        cell += step(width, direction)
        path[n] = cell
        n += 1
        ahead = int(links[cell]) & ~(1 << ((direction + 2) & 3))
    return path[:n].copy()


@kernel
def drop_cycles(board: Board, start: int) -> None:
    """Leave the path that begins at `start` and nothing else."""
    path = unrolled(board.links, board.width, start)
    directions = np.empty(path.size - 1, np.int64)
    for k in range(path.size - 1):
        directions[k] = direction_of(board.width, path[k + 1] - path[k])
    clear(board)
    for k in range(path.size - 1):
        flip_link(board, path[k], directions[k])


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

    `effort` is (restarts, proposals in each); the first restart begins from a shortest path, the
    others go through random cells of `ways`. The score is minus infinity if no path exists.
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
        score = anneal_twice(board, squares, effort[1], schedule, ends, limit, trial, rng)
        if score > best_score:
            best_score = score
            best[:] = trial
        if best_score >= limit:
            break
    return best_score, best
