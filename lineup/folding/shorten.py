"""Shortening a folding by contractions that each keep a valid plan (Section 5)."""

import numpy as np

from ..contraction import cut_down, occupancy_of, shortened_path
from ..grid import IntArray, surface
from ..motion import unfold
from ..motion._chain import box_grid, cells_of
from ..motion.plan import has_peel_plan, motion_of, states_of
from ..solid import Folding
from ._fold import new_fold
from ._moves import contract_all


def shortened_folding(folding: Folding, length: int) -> Folding:
    """A folding cut down to `length` voxels; surface voxels go only if they must.

    A motion of peels and swings keeps a valid plan; any other path is unfolded anew.
    """
    if not has_peel_plan(folding.motion):
        path = shortened_path(folding.path, length)
        return Folding(path, unfold(path))
    occupancy = occupancy_of(folding.path)
    grid, cells = box_grid(occupancy.shape), cells_of(folding.path.voxels, occupancy.shape)
    fold = new_fold(len(grid.outside), cells, states_of(folding.motion), len(cells))
    contract_all(grid, fold, np.pad(surface(occupancy), 1).ravel(), length)
    contract_all(grid, fold, np.zeros(len(grid.outside), bool), length)
    path = cut_down(folding.path, grid.xyz[fold.path[: fold.size[0]]], length)
    plan = _without_end(fold.states[: fold.size[1]], length)
    return Folding(path, motion_of(path.voxels, plan))


def _without_end(states: IntArray, length: int) -> IntArray:
    """The plan of a chain cut to its first `length` joints."""
    cut = states.copy()
    cut[:, 1] = np.minimum(cut[:, 1], length - 1)
    done = int(np.argmax(cut[:, 1] - cut[:, 0] <= 1))
    plan: IntArray = cut[: done + 1]
    return plan
