"""Peel and swing: unfold a given path from its two ends (Section 7's pulling, as a search)."""

import numpy as np

from ..solid import Motion, VoxelPath
from .plan import left_folded, motion_of, path_grid, peel_plan

BIASES = (0.02, 0.98, 0.5)


def peel(path: VoxelPath, seed: int, *, tries: int = 12, patience: int = 20_000) -> Motion:
    """The best of several searches for a motion of peels and swings.

    Not every path has one; the motion then ends where the search that came furthest got stuck.
    """
    for name, value in (("tries", tries), ("patience", patience)):
        if value < 1:
            raise ValueError(f"{name} must be at least 1, got {value}")
    rng = np.random.default_rng(seed)
    grid, cells = path_grid(path.voxels)
    best = None
    for k in range(tries):
        states = peel_plan(grid, cells, rng, patience=patience, bias=BIASES[k % 3])
        if best is None or left_folded(states) < left_folded(best):
            best = states
        if left_folded(best) <= 1:
            break
    assert best is not None  # there is at least one try
    return motion_of(path.voxels, best)
