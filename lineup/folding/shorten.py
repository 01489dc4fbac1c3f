"""Shortening a folding by contractions that each keep a valid plan (Section 5)."""

import numpy as np

from ..grid import BoolArray, IntArray
from ..motion._chain import box_grid, cells_of
from ..motion.plan import motion_of, states_of
from ..solid import Motion
from ._fold import new_fold
from ._moves import contract_all


def shorten(motion: Motion, keep: BoolArray, length: int) -> tuple[IntArray, Motion]:
    """The voxels and the motion of a shorter path; `keep` (X, Y, Z) goes only if it must."""
    shape = keep.shape
    cells = cells_of(motion.start, shape)
    grid = box_grid(shape)
    fold = new_fold(len(grid.outside), cells, states_of(motion), len(cells))
    contract_all(grid, fold, np.pad(keep, 1).ravel(), length)
    contract_all(grid, fold, np.zeros(len(grid.outside), bool), length)
    voxels = grid.xyz[fold.path[: fold.size[0]]]
    states = fold.states[: fold.size[1]]
    return voxels[:length], motion_of(voxels[:length], _without_end(states, length))


def _without_end(states: IntArray, length: int) -> IntArray:
    """The plan of a chain cut to its first `length` joints."""
    cut = states.copy()
    cut[:, 1] = np.minimum(cut[:, 1], length - 1)
    done = int(np.argmax(cut[:, 1] - cut[:, 0] <= 1))
    plan: IntArray = cut[: done + 1]
    return plan
