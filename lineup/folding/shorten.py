"""Shortening a folding by contractions that each keep a valid plan (Section 5)."""

import numpy as np

from ..contraction import END, PAIR, occupancy_of, shortened_path, without
from ..grid import BoolArray, IntArray, surface
from ..joints import slot_violations
from ..motion import unfold
from ..motion._chain import box_grid, cells_of
from ..motion.plan import has_peel_plan, motion_of, states_of
from ..solid import Folding, VoxelPath
from ._fold import Body, Fold, load, new_fold, path_of
from ._fold import states_of as plan_of
from ._moves import contract_all
from .pulling import is_pulled, shortened_pulled


def shortened_folding(folding: Folding, length: int, keep: BoolArray | None = None) -> Folding:
    """A folding cut down to `length` voxels; those to keep, or the surface, go if they must.

    A motion of peels and swings keeps a valid plan, and a chain that is pulled out still can be;
    any other path is unfolded anew. A motion that keeps to the slots of the printed block still
    does. The order in which voxels go is that of `trimming.trim`.
    """
    slotted = len(folding.path) % 2 == 0 and not len(slot_violations(folding.motion))
    joints = "slotted" if slotted else "free"
    occupancy = occupancy_of(folding.path)
    keep = surface(occupancy) if keep is None else keep
    if not has_peel_plan(folding.motion):
        if is_pulled(folding.motion):
            return shortened_pulled(folding, length, keep)
        path = shortened_path(folding.path, length, keep)
        return Folding(path, unfold(path, joints=joints))
    grid, cells = box_grid(occupancy.shape), cells_of(folding.path.voxels, occupancy.shape)
    inside = np.isin(np.arange(len(grid.outside)), cells)
    fold = new_fold(grid, Body(inside, np.ones(len(inside))), cells, states_of(folding.motion))
    kept = np.pad(keep, 1).ravel()
    nothing = np.zeros_like(kept)
    in_layer = len(folding.path.visits) > 0
    contract_all(fold, kept, length, 2, in_layer, slotted)
    contract_all(fold, kept, length, len(cells), in_layer, slotted)
    _cut_ends(fold, kept, length, free=True)
    contract_all(fold, nothing, length, 2, in_layer, slotted)
    _cut_ends(fold, kept, length, free=False)
    path = _told(folding.path, np.isin(cells, path_of(fold)), keep)
    return Folding(path, motion_of(path.voxels, plan_of(fold), joints))


def _cut_ends(fold: Fold, kept: BoolArray, length: int, *, free: bool) -> None:
    """Cut blocks off both ends where the fewest voxels to keep go; none of them if `free`."""
    path, states = path_of(fold), plan_of(fold)
    n_before = np.concatenate([[0], kept[path].cumsum()])
    for excess in range(len(path) - length, 0, -2):
        first = np.arange(0, excess + 1, 2)
        cost = n_before[first] + n_before[-1] - n_before[len(path) - excess + first]
        a = int(first[cost.argmin()])
        if not free or cost.min() == 0:
            b = a + len(path) - excess
            load(fold, path[a:b], _without_ends(states, a, b))
            return


def _without_ends(states: IntArray, first: int, stop: int) -> IntArray:
    """The plan of a chain cut to its joints from `first` to `stop` - 1."""
    cut = states.copy()
    cut[:, 0] = np.maximum(cut[:, 0], first) - first
    cut[:, 1] = np.minimum(cut[:, 1], stop - 1) - first
    done = int(np.argmax(cut[:, 1] - cut[:, 0] <= 1))
    plan: IntArray = cut[: done + 1]
    return plan


def _told(path: VoxelPath, stays: BoolArray, keep: BoolArray) -> VoxelPath:
    """The steps of `path` that stay."""
    fate = np.where(stays, 0, PAIR).astype(np.int8)
    first, last = np.flatnonzero(stays)[[0, -1]]
    fate[:first] = fate[last + 1 :] = END
    return without(path, fate, keep[tuple(path.voxels.T)])
