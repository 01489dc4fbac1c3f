"""Contraction pairs, and a path without the voxels between them (Section 5, Figure 11)."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from . import grid
from .grid import BoolArray, IntArray
from .solid import VoxelPath


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
    voxels = path.voxels
    step = np.full(keep.shape, -1, np.int32)
    step[tuple(voxels.T)] = np.arange(len(voxels))
    n_kept = np.concatenate([[0], keep[tuple(voxels.T)].cumsum()])
    n_climbs = np.concatenate([[0], (np.diff(voxels[:, 2]) != 0).cumsum()])
    pairs = []
    for direction in grid.DIRECTIONS[[0, 1, 3, 4]]:
        beside = voxels + direction
        inside = ((beside >= 0) & (beside < keep.shape)).all(axis=1)
        i = np.flatnonzero(inside)
        j = step[tuple(beside[i].T)]
        i, j = i[j > i + 1], j[j > i + 1]
        whole = (n_kept[j] == n_kept[i + 1]) & (n_climbs[j] == n_climbs[i])
        pairs.append(np.stack([i[whole], j[whole]], axis=1))
    found = np.concatenate(pairs)
    return found[np.lexsort(found.T[::-1])].astype(np.int32)


def shortened_path(path: VoxelPath, length: int) -> VoxelPath:
    """`path` with `length` voxels: pairs inside the solid go first, then others, then its end."""
    keep = grid.surface(occupancy_of(path))
    voxels = path.voxels
    for kept in (keep, np.zeros_like(keep)):
        while len(voxels) > length:
            pairs = contraction_pairs(replace(path, voxels=voxels), kept)
            chosen = _disjoint(pairs, len(voxels) - length)
            if not len(chosen):
                break
            voxels = np.delete(voxels, np.concatenate([np.arange(i + 1, j) for i, j in chosen]), 0)
    return cut_down(path, voxels, length)


def cut_down(path: VoxelPath, voxels: IntArray, length: int) -> VoxelPath:
    """`path` through the first `length` of `voxels`, some of its own; its method says what went."""
    occupancy = occupancy_of(path)
    surface = grid.surface(occupancy)
    contracted = np.zeros_like(occupancy)
    contracted[tuple(path.voxels.T)] = True
    contracted[tuple(voxels.T)] = False
    kept = np.zeros_like(occupancy)
    kept[tuple(voxels[:length].T)] = True
    n_surface = int((contracted & surface).sum())
    went = (
        f"{int(contracted.sum()) - n_surface} voxels inside, {n_surface} on the surface "
        f"and {max(len(voxels) - length, 0)} off the end"
    )
    return replace(
        path,
        voxels=voxels[:length],
        visits=_visits(path, kept[tuple(path.voxels.T)]),
        dropped=np.argwhere(occupancy & ~kept).astype(np.int32),
        method=f"{path.method}, trimmed by {went}",
    )


def occupancy_of(path: VoxelPath) -> BoolArray:
    """The solid a path was made for: what it visits and what it leaves out."""
    voxels = np.concatenate([path.voxels, path.dropped])
    occupancy = np.zeros(voxels.max(axis=0) + 1, bool)
    occupancy[tuple(voxels.T)] = True
    return occupancy


def _disjoint(pairs: IntArray, excess: int) -> list[tuple[int, int]]:
    """Pairs of least index first, sharing ends at most, whose indices sum to at most `excess`."""
    index = pairs[:, 1] - pairs[:, 0] - 1
    taken: list[tuple[int, int]] = []
    used = np.zeros(int(pairs.max(initial=0)) + 1, bool)  # bars
    for k in np.lexsort((pairs[:, 0], index)):
        i, j = int(pairs[k, 0]), int(pairs[k, 1])
        if index[k] <= excess and not used[i:j].any():
            used[i:j] = True
            excess -= int(index[k])
            taken.append((i, j))
    return taken


def _visits(path: VoxelPath, stays: BoolArray) -> IntArray:
    """The visits of `path` when only some of its steps stay."""
    if not len(path.visits):
        return path.visits
    node = np.repeat(path.visits[:, 2], path.visits[:, 1] - path.visits[:, 0])[stays]
    first = {int(n): k for k, n in reversed(list(enumerate(node)))}
    last = {int(n): k for k, n in enumerate(node)}
    edges = np.flatnonzero(np.diff(node, prepend=-1, append=-1))
    rows = []
    for start, stop in pairwise(edges.tolist()):
        at = int(node[start])
        around = [n for n in first if first[n] < first[at] and last[n] > last[at]]
        rows.append((start, stop, at, len(around)))
    return np.array(rows, np.int32)
