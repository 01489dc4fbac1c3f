"""Subset sums of contraction pairs that can be carried out together (Section 5).

A pair (i, j) takes the steps between i and j off a path. Two pairs can be carried out together
if one ends before the other begins, or where it begins; such pairs are *disjoint*.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ._jit import kernel
from .grid import BoolArray, IntArray

NEVER = 1 << 62
MAX_ENTRIES = 1 << 25  # of a table, 256 MB

Costs = NDArray[np.int64]


def of_index_2(pairs: IntArray, n_wanted: int) -> IntArray:
    """The first `n_wanted` disjoint pairs of index 2, fewer if there are not as many.

    Taking always the pair that ends first gives as many as there can be.
    """
    short = pairs[pairs[:, 1] - pairs[:, 0] == 3]
    taken: list[int] = []
    free = 0
    for k in np.argsort(short[:, 1], kind="stable").tolist():
        if len(taken) == n_wanted:
            break
        if short[k, 0] >= free:
            taken.append(k)
            free = short[k, 1]
    chosen: IntArray = short[taken]
    return chosen


def smallest_subsets(
    scans: Sequence[IntArray], lengths: Sequence[int], length: int | None = None
) -> list[IntArray] | str:
    """The fewest disjoint pairs of several paths that bring them all to one length.

    Parameters
    ----------
    scans : sequence of (K, 2) int32
        The pairs of each path.
    lengths : sequence of int
        Of the paths, all even or all odd.
    length : int, optional
        To come to; by default whichever takes the fewest pairs, of equals the largest.

    Returns
    -------
    list of (L, 2) int32, or str
        The pairs of each path to contract; or why there are none.
    """
    n_free = [_n_covered(pairs) for pairs in scans]
    lowest = max(2, *(n - free // 2 * 2 for n, free in zip(lengths, n_free, strict=True)))
    goals = np.arange(min(lengths), lowest - 1, -2)
    if length is not None:
        goals = goals[goals == length]
    told = f"paths of {', '.join(map(str, lengths))} voxels"
    to = "one length" if length is None else f"{length} voxels"
    if not len(goals):
        return f"no disjoint contraction pairs bring {told} to {to}"
    if max(lengths) * ((max(lengths) - goals[-1]) // 2 + 1) > MAX_ENTRIES:
        return f"the subset sums that bring {told} to {to} do not fit {MAX_ENTRIES} entries"
    n_pairs = np.zeros(len(goals))
    for pairs, n in zip(scans, lengths, strict=True):
        fewest = _fewest(pairs, n, (n - int(goals[-1])) // 2)[0][-1][(n - goals) // 2]
        n_pairs += np.where(fewest < NEVER, fewest, np.inf)
    if not np.isfinite(n_pairs).any():
        return f"no disjoint contraction pairs bring {told} to {to}"
    goal = int(goals[n_pairs.argmin()])
    return [_smallest(pairs, n, (n - goal) // 2) for pairs, n in zip(scans, lengths, strict=True)]


def _n_covered(pairs: IntArray) -> int:
    """How many steps lie between the two of some pair."""
    change = np.zeros(int(pairs.max(initial=0)) + 1, np.int64)
    np.add.at(change, pairs[:, 0] + 1, 1)
    np.add.at(change, pairs[:, 1], -1)
    return int((change.cumsum() > 0).sum())


def _fewest(pairs: IntArray, n_steps: int, n_halves: int) -> tuple[Costs, IntArray, Costs]:
    """`least_costs` where each pair costs one, with the pairs in its order and their costs."""
    ordered = pairs[np.lexsort(pairs.T)]
    cost = np.ones(len(pairs), np.int64)
    head = np.full(n_steps, NEVER, np.int64)
    head[0] = 0
    return least_costs(ordered, cost, head, n_halves), ordered, cost


def _smallest(pairs: IntArray, n_steps: int, half: int) -> IntArray:
    table, ordered, cost = _fewest(pairs, n_steps, half)
    taken, _ = subset(table, ordered, cost, n_steps - 1, half)
    chosen: IntArray = ordered[taken]
    return chosen


@kernel
def least_costs(pairs: IntArray, cost: Costs, head: Costs, n_halves: int) -> Costs:
    """The least cost of every subset sum at every step of a path, by dynamic programming.

    Parameters
    ----------
    pairs : (K, 2) int32
        Sorted by their second step.
    cost : (K,) int64
        Of each pair.
    head : (P,) int64
        Cost of a path that begins at each even step only; `NEVER` forbids it.
    n_halves : int
        Half of the largest sum asked for.

    Returns
    -------
    (P, n_halves + 1) int64
        Entry (k, h): least cost of disjoint pairs up to step k, which stays, that take 2h steps
        off together with those before the begin; `NEVER` where there are none.
    """
    table = np.full((len(head), n_halves + 1), NEVER, np.int64)
    p = 0
    for k in range(len(head)):
        if k > 0:
            table[k] = table[k - 1]
        if k % 2 == 0 and k // 2 <= n_halves:
            table[k, k // 2] = min(table[k, k // 2], head[k])
        while p < len(pairs) and pairs[p, 1] == k:
            i = pairs[p, 0]
            half = (k - i - 1) // 2
            for h in range(half, n_halves + 1):
                if table[i, h - half] < NEVER:
                    table[k, h] = min(table[k, h], table[i, h - half] + cost[p])
            p += 1
    return table


@kernel
def subset(table: Costs, pairs: IntArray, cost: Costs, k: int, h: int) -> tuple[BoolArray, int]:
    """Which pairs (K,) the entry (k, h) of `least_costs` stands for, and its first step."""
    taken = np.zeros(len(pairs), np.bool_)
    p = len(pairs) - 1
    while True:
        if k > 0 and table[k - 1, h] == table[k, h]:
            k -= 1
            continue
        while p >= 0 and pairs[p, 1] > k:
            p -= 1
        while p >= 0 and pairs[p, 1] == k:
            half = (k - pairs[p, 0] - 1) // 2
            if half <= h and table[pairs[p, 0], h - half] + cost[p] == table[k, h]:
                break
            p -= 1
        if p < 0 or pairs[p, 1] < k:
            return taken, k
        taken[p] = True
        h -= (k - pairs[p, 0] - 1) // 2
        k = pairs[p, 0]
