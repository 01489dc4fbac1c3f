"""Trimming to a common length (Section 5, Figure 11)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TypeVar, cast

import numpy as np

from . import grid
from .folding.shorten import shorten
from .grid import BoolArray, IntArray
from .motion import unfold
from .motion.plan import has_peel_plan
from .solid import Folding, VoxelPath

Item = TypeVar("Item", VoxelPath, Folding)


def trim(items: Sequence[Item], length: int | None = None) -> list[Item]:
    """Paths or foldings, all of one even length (Section 5).

    Contraction pairs inside the solid go first. Where they are too few, pairs with surface
    voxels go, and last whole blocks off the end of the path; ``path.method`` says how many of
    each. A folding of peels and swings keeps a valid plan through every contraction; any other
    is unfolded anew.

    Parameters
    ----------
    items : sequence of VoxelPath or of Folding
    length : int, optional
        Number of voxels to keep; the length of the shortest item by default.

    Returns
    -------
    list
        In the order given; an item of the right length is handed back as it is.

    Raises
    ------
    ValueError
        If there are no items, or `length` is odd, less than 2 or more than the shortest item.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> big, small = (lu.VoxelSolid(np.ones((n, 4, 4), bool)) for n in (5, 4))
    >>> paths = [lu.layered_path(big), lu.layered_path(small)]
    >>> [len(path) for path in lu.trim(paths)]
    [64, 64]
    """
    if not items:
        raise ValueError("there is nothing to trim; give at least one path or folding")
    shortest = min(len(_path_of(item)) for item in items)
    if length is None:
        length = shortest - shortest % 2
    if length % 2 or not 2 <= length <= shortest:
        raise ValueError(
            f"length must be an even number from 2 to the {shortest} voxels of the shortest item, "
            f"got {length}"
        )
    return [cast(Item, _trimmed(item, length)) for item in items]


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
    >>> from lineup.trimming import contraction_pairs
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


def _path_of(item: VoxelPath | Folding) -> VoxelPath:
    return item.path if isinstance(item, Folding) else item


def _trimmed(item: VoxelPath | Folding, length: int) -> VoxelPath | Folding:
    if len(_path_of(item)) == length:
        return item
    if isinstance(item, Folding):
        return _trimmed_folding(item, length)
    return _trimmed_path(item, length)


def _trimmed_folding(folding: Folding, length: int) -> Folding:
    if has_peel_plan(folding.motion):
        keep = grid.surface(_occupancy(folding.path))
        voxels, motion = shorten(folding.motion, keep, length)
        return Folding(_with_voxels(folding.path, voxels), motion)
    path = _trimmed_path(folding.path, length)
    return Folding(path, unfold(path))


def _occupancy(path: VoxelPath) -> BoolArray:
    """The solid a path was made for: what it visits and what it leaves out."""
    voxels = np.concatenate([path.voxels, path.dropped])
    occupancy = np.zeros(voxels.max(axis=0) + 1, bool)
    occupancy[tuple(voxels.T)] = True
    return occupancy


def _trimmed_path(path: VoxelPath, length: int) -> VoxelPath:
    keep = grid.surface(_occupancy(path))
    voxels = path.voxels
    for kept in (keep, np.zeros_like(keep)):
        while len(voxels) > length:
            pairs = contraction_pairs(replace(path, voxels=voxels), kept)
            chosen = _disjoint(pairs, len(voxels) - length)
            if not len(chosen):
                break
            voxels = np.delete(voxels, np.concatenate([np.arange(i + 1, j) for i, j in chosen]), 0)
    return _with_voxels(path, voxels[:length])


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


def _with_voxels(path: VoxelPath, voxels: IntArray) -> VoxelPath:
    """`path` with some of its steps left out."""
    occupancy = _occupancy(path)
    surface = grid.surface(occupancy)
    removed = np.zeros_like(occupancy)
    removed[tuple(path.voxels.T)] = True
    removed[tuple(voxels.T)] = False
    occupancy[tuple(voxels.T)] = False
    n_surface = int((removed & surface).sum())
    n_inside = int(removed.sum()) - n_surface
    return replace(
        path,
        voxels=voxels,
        visits=_visits(path, ~removed[tuple(path.voxels.T)]),
        dropped=np.argwhere(occupancy).astype(np.int32),
        method=f"{path.method}, trimmed by {n_inside} voxels inside and {n_surface} on the surface",
    )


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
