"""Contraction pairs, and a path without the voxels between them (Section 5, Figure 11)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from . import grid
from .grid import BoolArray, IntArray
from .solid import VoxelPath
from .subset_sums import MAX_ENTRIES, NEVER, Costs, least_costs, of_index_2, subset
from .visits import visits_of

STAYS, PAIR, EXCURSION, END = range(4)
"""How a step of a path went."""

Fate = NDArray[np.int8]


def contraction_pairs(path: VoxelPath, keep: BoolArray) -> IntArray:
    """Every contraction pair of `path`, by linear scan (Section 5, Figure 11).

    Parameters
    ----------
    keep : (X, Y, Z) bool
        Voxels that must stay; the paper keeps the surface.

    Returns
    -------
    (K, 2) int32
        Steps (i, j), i < j, of each pair; its index is j - i - 1, always even. The two voxels
        are adjacent, and all steps from i to j lie in one layer.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup.contraction import contraction_pairs
    >>> path = lu.layered_path(lu.VoxelSolid(np.ones((2, 2, 1), bool)))
    >>> contraction_pairs(path, keep=np.zeros((2, 2, 1), bool)).tolist()
    [[0, 3]]
    """
    pairs = adjacent_steps(path.voxels, grid.DIRECTIONS[[0, 1, 3, 4]])
    kept = keep[tuple(path.voxels.T)]
    whole = (n_between(kept, pairs) == 0) & ~_leaves_layer(path.voxels, pairs)
    found: IntArray = pairs[whole]
    return found[np.lexsort(found.T[::-1])]


def adjacent_steps(voxels: IntArray, directions: IntArray) -> IntArray:
    """All steps (i, j), j > i + 1, whose voxels are adjacent in one of `directions`; by j."""
    shape = voxels.max(axis=0) + 1
    step = np.full(shape, -1, np.int32)
    step[tuple(voxels.T)] = np.arange(len(voxels))
    pairs = []
    for direction in directions:
        beside = voxels + direction
        i = np.flatnonzero(((beside >= 0) & (beside < shape)).all(axis=1))
        j = step[tuple(beside[i].T)]
        pairs.append(np.stack([i[j > i + 1], j[j > i + 1]], axis=1))
    found = np.concatenate(pairs).astype(np.int32)
    return found[np.lexsort(found.T)]


def n_between(marked: BoolArray, pairs: IntArray) -> NDArray[np.int64]:
    """How many of the steps between the two of each pair are marked."""
    n_before = np.concatenate([[0], marked.cumsum()])
    n: NDArray[np.int64] = n_before[pairs[:, 1]] - n_before[pairs[:, 0] + 1]
    return n


def _leaves_layer(voxels: IntArray, pairs: IntArray) -> BoolArray:
    """Whether the path leaves the layer between the two steps of each pair."""
    n_climbs = np.concatenate([[0], (np.diff(voxels[:, 2]) != 0).cumsum()])
    leaves: BoolArray = n_climbs[pairs[:, 1]] != n_climbs[pairs[:, 0]]
    return leaves


def shortened_path(path: VoxelPath, length: int, keep: BoolArray) -> VoxelPath:
    """`path` with `length` voxels, an even number fewer, at the least loss of voxels to keep.

    Contraction pairs, whole excursions with nothing to keep and blocks at both ends may go. As few
    voxels to keep as possible are lost, then as few blocks off the ends as possible, then as few
    excursions. A path that is not layered has pairs in all directions and no excursions; a
    layered one stays layered unless a cut leads its MSP to one node twice.

    The subset-sum table is that of the whole path, if it has at most `MAX_ENTRIES`; a longer
    path is shortened in instalments, each at the least loss.
    """
    kept = keep[tuple(path.voxels.T)]
    fate = np.zeros(len(path), np.int8)
    while (excess := int((fate == STAYS).sum()) - length) > 0:
        steps = np.flatnonzero(fate == STAYS)
        instalment = min(excess, 2 * max(1, MAX_ENTRIES // len(steps)))
        pieces = pieces_of(path)
        fate[steps] = _least_loss(
            path.voxels[steps], None if pieces is None else pieces[steps], kept[steps], instalment
        )
    return without(path, fate, kept)


def pieces_of(path: VoxelPath) -> IntArray | None:
    """The planar piece of each step, None if the path is not layered."""
    if not len(path.visits):
        return None
    start, stop, piece, _ = path.visits.T
    pieces: IntArray = np.repeat(piece, stop - start)
    return pieces


def _least_loss(voxels: IntArray, pieces: IntArray | None, kept: BoolArray, excess: int) -> Fate:
    """How each step goes if `excess` of them must.

    Nothing is gained by contracting again and again: a pair that shows only after a contraction
    is a pair of higher index before it.
    """
    pairs, leaves = _pairs_and_excursions(voxels, pieces, kept)
    n_kept = n_between(kept, pairs)
    fate = np.zeros(len(voxels), np.int8)
    simple = of_index_2(pairs[~leaves & (n_kept == 0)], excess // 2)
    if 2 * len(simple) == excess:
        fate[between(simple)] = PAIR
        return fate
    short = pairs[:, 1] - pairs[:, 0] - 1 <= excess
    pairs, leaves, n_kept = pairs[short], leaves[short], n_kept[short]
    cost = _cost(n_kept, 0, leaves)
    steps = np.arange(len(voxels))
    head = _cost(np.concatenate([[0], kept.cumsum()[:-1]]), steps, 0)
    tail = _cost(kept.sum() - kept.cumsum(), steps[::-1], 0)
    table = least_costs(pairs, cost, head, excess // 2)
    ends = np.arange(len(voxels) - 1 - excess, len(voxels), 2)
    halves = np.arange(len(ends))
    at_end = table[ends, halves]
    total = np.where(at_end < NEVER, at_end + tail[ends], NEVER)
    best = int(total.argmin())
    taken, first = subset(table, pairs, cost, int(ends[best]), int(halves[best]))
    fate[:first] = fate[ends[best] + 1 :] = END
    fate[between(pairs[taken & ~leaves])] = PAIR
    fate[between(pairs[taken & leaves])] = EXCURSION
    return fate


def _pairs_and_excursions(
    voxels: IntArray, pieces: IntArray | None, kept: BoolArray
) -> tuple[IntArray, BoolArray]:
    """Pairs of adjacent steps, by the second, and whether the path leaves its piece between."""
    if pieces is None:
        pairs = adjacent_steps(voxels, grid.DIRECTIONS)
        return pairs, np.zeros(len(pairs), bool)
    pairs = adjacent_steps(voxels, grid.DIRECTIONS[[0, 1, 3, 4]])
    pairs = pairs[pieces[pairs[:, 0]] == pieces[pairs[:, 1]]]
    order = np.argsort(pieces, kind="stable")
    n_before = np.empty(len(voxels), np.int64)  # steps to keep before each in its own piece
    n_before[order] = kept[order].cumsum() - kept[order]
    i, j = pairs.T
    whole = n_between(kept, pairs) == n_before[j] - n_before[i] - kept[i]
    return pairs[whole], _leaves_layer(voxels, pairs[whole])


def _cost(n_kept: NDArray[np.int64], n_ends: object, n_excursions: object) -> Costs:
    """Three counts as one number that compares like the three in order."""
    cost: Costs = (n_kept << 42) + (np.asarray(n_ends, np.int64) << 21) + n_excursions
    return cost


def between(pairs: IntArray) -> NDArray[np.int64]:
    """The steps between the two of each pair."""
    steps = [np.arange(i + 1, j) for i, j in pairs.tolist()]
    return np.concatenate([np.empty(0, np.int64), *steps])


def contracted(path: VoxelPath, pairs: IntArray, which: str) -> VoxelPath:
    """`path` without the voxels between disjoint pairs; its method says `which` pairs they are."""
    if not len(pairs):
        return path
    stays = np.ones(len(path), bool)
    stays[between(pairs)] = False
    return _left(path, stays, f"{(~stays).sum()} voxels in pairs {which}")


def without(path: VoxelPath, fate: Fate, kept: BoolArray) -> VoxelPath:
    """`path` without the steps that go; its method says how, and how many were to be `kept`."""
    n = [int((fate == went).sum()) for went in (PAIR, EXCURSION, END)]
    lost = int((kept & (fate != STAYS)).sum())
    how = f"{n[0]} voxels in pairs, {n[1]} in excursions and {n[2]} off the ends"
    return _left(path, fate == STAYS, f"{how}, {lost} of them protected")


def _left(path: VoxelPath, stays: BoolArray, how: str) -> VoxelPath:
    dropped = np.concatenate([path.dropped, path.voxels[~stays]])
    return replace(
        path,
        voxels=path.voxels[stays],
        visits=_visits(path, stays),
        dropped=dropped[np.lexsort(dropped.T[::-1])],
        method=f"{path.method}, trimmed by {how}",
    )


def _visits(path: VoxelPath, stays: BoolArray) -> IntArray:
    """The visits of the steps that stay; none if two pieces of the MSP are in one node."""
    pieces = pieces_of(path)
    if pieces is None:
        return path.visits
    visits = visits_of(path.voxels[stays], pieces[stays])
    node, _ = grid.layer_components(occupancy_of(path))
    on_msp = visits[visits[:, 3] == 0]
    nodes = node[tuple(path.voxels[stays][on_msp[:, 0]].T)]
    layered = len(np.unique(nodes)) == len(np.unique(on_msp[:, 2]))
    return visits if layered else visits[:0]


def occupancy_of(path: VoxelPath) -> BoolArray:
    """The solid a path was made for: what it visits and what it leaves out."""
    voxels = np.concatenate([path.voxels, path.dropped])
    occupancy = np.zeros(voxels.max(axis=0) + 1, bool)
    occupancy[tuple(voxels.T)] = True
    return occupancy
