"""Best-first search for a peel plan: which end lets go next, and which way its rod points.

A state (a, b, da, db) says that joints a..b are still folded and that straight rods leave
joint a along direction da and joint b along db. A plan is a list of states; from one to the
next an end lets go of one joint (a peel) or a rod turns by 90 degrees (a swing).
"""

from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from .._jit import kernel
from ..grid import IntArray
from ._chain import (
    INWARD,
    Chain,
    Grid,
    has_rod,
    quadrant_blocker,
    ray_blocker,
    ray_meets_quadrant,
    rays_meet,
)
from ._slots import FREE, SPARING, peels_at_once, twisted_by_swing

STEPS = 24


class Frontier(NamedTuple):
    """Open states in buckets by b - a, last in first out; a state is entered once.

    Beside them wait steps that would twist a capsule, as numbers STEPS * state + 6 * end + f for a
    swing to direction f, and 12 more than that with f = 0 for a peel.
    """

    state: IntArray  # (N, 4)
    parent: IntArray  # (N,) -1 for a start
    peeled: IntArray  # (N,) 1 once its peels were tried and only its swings remain
    below: IntArray  # (N,) the state under this one in its bucket
    top: IntArray  # (n,) the state on top of each bucket, -1 where it is empty
    seen: IntArray  # (H,) hash table of states entered, -1 where free
    size: IntArray  # (1,) number of states entered
    held: IntArray  # (n,) for each bucket, the last of its states' steps that wait, -1 for none
    under: IntArray  # (STEPS N,) the one before it


@kernel
def may_peel(grid: Grid, chain: Chain, state: IntArray, end: int) -> bool:
    """Whether `end` may let go of its joint while its rod keeps its direction.

    The bar turns and the rod glides inside a box of one lattice plane between two rays; the
    rod's own ray is clear already, unless the end has no rod yet.
    """
    k, d = state[end], state[2 + end]
    if not has_rod(state, end, len(chain.cell)) and not _clear_ray(grid, chain, state, end, k):
        return False
    inner = k + INWARD[end]
    along_bar = chain.cell[k] == chain.cell[inner] + grid.offset[d]
    return along_bar or _clear_ray(grid, chain, state, end, inner)


@kernel
def may_swing(grid: Grid, chain: Chain, state: IntArray, end: int, f: int) -> bool:
    """Whether the rod of `end` may turn to direction f: the quadrant it sweeps is clear."""
    k, d, other = state[end], state[2 + end], state[1 - end]
    if d % 3 == f % 3 or not has_rod(state, end, len(chain.cell)):
        return False
    blocker = quadrant_blocker(grid, chain, end, k, d, f)
    if (blocker - other) * INWARD[end] <= 0:
        return False
    if not has_rod(state, 1 - end, len(chain.cell)):
        return True
    p, q = grid.xyz[chain.cell[other]], grid.xyz[chain.cell[k]]
    return not ray_meets_quadrant(p, state[3 - end], q, d, f)


@kernel
def _clear_ray(grid: Grid, chain: Chain, state: IntArray, end: int, k: int) -> bool:
    """No folded joint inward of k, and not the other rod, on the ray from joint k along the rod."""
    d, other = state[2 + end], state[1 - end]
    if (ray_blocker(chain, end, k, d) - other) * INWARD[end] <= 0:
        return False
    if not has_rod(state, 1 - end, len(chain.cell)):
        return True
    p, q = grid.xyz[chain.cell[other]], grid.xyz[chain.cell[k]]
    return not rays_meet(p, state[3 - end], q, d)


@kernel
def keeps_rules(grid: Grid, chain: Chain, states: IntArray) -> bool:
    """Whether each state of a plan leads to the next by a peel or a swing that is allowed."""
    for k in range(len(states) - 1):
        old, new = states[k], states[k + 1]
        end = 0 if old[1] == new[1] and old[3] == new[3] else 1
        if old[end] != new[end]:
            allowed = old[2 + end] == new[2 + end] and may_peel(grid, chain, old, end)
        else:
            allowed = may_swing(grid, chain, old, end, new[2 + end])
        if not allowed:
            return False
    return True


@kernel
def search(
    grid: Grid,
    chain: Chain,
    starts: IntArray,
    budget: int,
    patience: int,
    bias: float,
    only: int,
    rng: Generator,
    slots: int = FREE,
) -> IntArray:
    """The plan that leaves the fewest joints folded, (K, 4) states from a start to the best met.

    Parameters
    ----------
    starts : (S, 4) int32
    budget, patience : int
        Most states to enter, and most to expand without progress.
    bias : float
        Probability that end 0 peels before end 1; near 0 or 1 one end does most of the work.
    only : int
        The one end that may peel, -1 for both.
    slots : int
        FREE, SLOTTED or SPARING (`_slots`). When a sparing search has no more patience, it lets
        that step happen which twists a capsule where the fewest joints are folded, and goes on.
    """
    frontier = _open(len(chain.cell), budget)
    for k in rng.permutation(len(starts)):
        _enter(frontier, starts[k], -1)
    best, least = 0, len(chain.cell)
    expanded, progress, gap = 0, 0, 0
    while frontier.size[0] + 24 < budget:
        while gap < len(chain.cell) and frontier.top[gap] < 0:
            gap += 1
        if gap == len(chain.cell) or expanded - progress > patience:
            gap = _let_happen(frontier)
            if gap < 0:
                break
            progress = expanded
        node = frontier.top[gap]
        expanded += 1
        if gap < least:
            best, least, progress = node, gap, expanded
            if gap == 1:
                break
        if frontier.peeled[node]:
            frontier.top[gap] = frontier.below[node]
            _enter_swings(grid, chain, frontier, node, rng, slots)
        else:
            frontier.peeled[node] = 1
            gap = _enter_peels(grid, chain, frontier, node, rng.random() < bias, only, slots)
    return _trail(frontier, best)


@kernel
def _open(n: int, budget: int) -> Frontier:
    size = 64
    while size < 2 * budget:
        size *= 2
    return Frontier(
        np.empty((budget, 4), np.int32),
        np.empty(budget, np.int32),
        np.zeros(budget, np.int32),
        np.empty(budget, np.int32),
        np.full(n, -1, np.int32),
        np.full(size, -1, np.int32),
        np.zeros(1, np.int32),
        np.full(n, -1, np.int32),
        np.empty(STEPS * budget, np.int32),
    )


@kernel
def _enter(frontier: Frontier, state: IntArray, parent: int) -> bool:
    """Put a state on its bucket unless it was entered before."""
    slot = _slot(frontier, state)
    if frontier.seen[slot] >= 0:
        return False
    node = frontier.size[0]
    frontier.size[0] += 1
    frontier.seen[slot] = node
    frontier.state[node] = state
    frontier.parent[node] = parent
    gap = state[1] - state[0]
    frontier.below[node] = frontier.top[gap]
    frontier.top[gap] = node
    return True


@kernel
def _slot(frontier: Frontier, state: IntArray) -> int:
    """Where in the hash table `state` is, or would go (linear probing)."""
    mask = len(frontier.seen) - 1
    key = ((np.int64(state[0]) * 1048573 + state[1]) * 6 + state[2]) * 6 + state[3]
    slot = ((key * 0x9E3779B97F4A7C1) >> 17) & mask
    while frontier.seen[slot] >= 0:
        if (frontier.state[frontier.seen[slot]] == state).all():
            return slot
        slot = (slot + 1) & mask
    return slot


@kernel
def _enter_peels(
    grid: Grid,
    chain: Chain,
    frontier: Frontier,
    node: int,
    front_first: bool,
    only: int,
    slots: int = FREE,
) -> int:
    """Enter the peels of a state, the preferred end on top; the bucket to look at next."""
    gap = frontier.state[node, 1] - frontier.state[node, 0]
    nearest = gap
    for turn in range(2):
        end = 1 - turn if front_first else turn
        state = frontier.state[node].copy()
        if only in (-1, end) and may_peel(grid, chain, state, end):
            n_joints = 1 if slots == FREE else peels_at_once(grid, chain, state, end)
            state[end] += n_joints * INWARD[end]
            if n_joints > 0 and _enter(frontier, state, node):
                nearest = min(nearest, gap - n_joints)
            elif n_joints == 0 and slots == SPARING:
                _hold(frontier, gap, STEPS * node + 12 + 6 * end)
    return nearest


@kernel
def _hold(frontier: Frontier, gap: int, step: int) -> None:
    frontier.under[step] = frontier.held[gap]
    frontier.held[gap] = step


@kernel
def _let_happen(frontier: Frontier) -> int:
    """Enter what one of the steps that wait leads to, and its bucket; -1 if none waits."""
    for gap in range(len(frontier.held)):
        while frontier.held[gap] >= 0:
            step = frontier.held[gap]
            frontier.held[gap] = frontier.under[step]
            node = step // STEPS
            peels, end, f = step % STEPS // 12, step % 12 // 6, step % 6
            state = frontier.state[node].copy()
            if peels:
                state[end] += INWARD[end]
            else:
                state[2 + end] = f
            if _enter(frontier, state, node):
                return gap - peels
    return -1


@kernel
def _enter_swings(
    grid: Grid, chain: Chain, frontier: Frontier, node: int, rng: Generator, slots: int = FREE
) -> None:
    first = int(rng.integers(0, 12))
    for turn in range(12):
        end, f = divmod((turn + first) % 12, 6)
        state = frontier.state[node].copy()
        if may_swing(grid, chain, state, end, f):
            if slots != FREE and twisted_by_swing(grid, chain, state, end, f):
                if slots == SPARING:
                    _hold(frontier, state[1] - state[0], STEPS * node + 6 * end + f)
                continue
            state[2 + end] = f
            _enter(frontier, state, node)


@kernel
def _trail(frontier: Frontier, node: int) -> IntArray:
    """The states from a start to `node`; of two joints let go at once, the first comes first."""
    state, parent = frontier.state, frontier.parent
    length = 1
    k = node
    while parent[k] >= 0:
        length += max(np.abs(state[k, :2] - state[parent[k], :2]).sum(), 1)
        k = parent[k]
    trail = np.empty((length, 4), np.int32)
    row = length - 1
    while row >= 0:
        trail[row] = state[node]
        row -= 1
        node = parent[node]
        if node >= 0 and np.abs(state[node, :2] - trail[row + 1, :2]).sum() == 2:
            trail[row] = (state[node] + trail[row + 1]) // 2
            row -= 1
    return trail
