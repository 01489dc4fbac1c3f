"""Peel, swing and door: unfold a given path from its two ends (Section 7's pulling, as a search).

Where the ends are shut in, the pose is opened first: limbs turn and glide at random, out of each
other's way, until a search finds how the ends can be let go.
"""

from dataclasses import replace

import numpy as np
from numpy.random import Generator

from ..grid import LETTERS, IntArray
from ..solid import Motion, VoxelPath
from ._chain import Grid, box_grid, cells_of
from ._limbs import arcs, open_pose, open_up
from .plan import left_folded, motion_of, path_grid, peel_plan

BIASES = (0.02, 0.98, 0.5)
ROOM = 48
"""Free cells around the path in which its limbs may come to rest."""

PROPOSALS = 2
"""Limb moves tried in a round, for each joint."""

HEAT = 0.5
HASTE = 20
"""A search between rounds gives up so many times sooner."""


def peel(
    path: VoxelPath, seed: int, *, tries: int = 12, patience: int = 20_000, rounds: int = 40
) -> Motion:
    """The best of several searches for a motion of peels and swings, the pose opened if need be.

    Not every path has one; the motion then ends where the search that came furthest got stuck.

    Parameters
    ----------
    tries : int
        Searches on the path as it is.
    patience : int
        States that a search expands without progress before it gives up.
    rounds : int
        Times that limbs are moved to open the pose, and the search is run again; with 0 the
        motion has no doors, and only straight ends move.
    """
    check_efforts(tries, patience, rounds)
    rng = np.random.default_rng(seed)
    grid, cells = path_grid(path.voxels)
    states = _best_plan(grid, cells, rng, tries, patience)
    plain = motion_of(path.voxels, states)
    if plain.straight or rounds == 0 or len(path) < 4:
        return plain
    opened = _opened(path.voxels, rng, rounds, max(1, patience // HASTE))
    return opened if opened.straight else plain


def check_efforts(tries: int, patience: int, rounds: int) -> None:
    """Raise a ValueError if an option of `peel` is too small."""
    efforts = (("tries", tries, 1), ("patience", patience, 1), ("rounds", rounds, 0))
    for name, value, least in efforts:
        if value < least:
            raise ValueError(f"{name} must be at least {least}, got {value}")


def peel_upward(path: VoxelPath, seed: int) -> Motion:
    """Both ends pulled upward, as the paper does it by hand (Section 7); else what `peel` finds.

    Its `reason` tells how far pulling upward went.
    """
    grid, cells = path_grid(path.voxels)
    up = LETTERS.index("U")
    start = np.array([[0, len(path) - 1, up, up]])
    states = peel_plan(grid, cells, np.random.default_rng(seed), starts=start)
    motion = motion_of(path.voxels, states)
    turns = np.flatnonzero((states[:, 2:] != up).any(axis=1))
    if motion.straight and not len(turns):
        return replace(motion, reason="straight: both ends pulled upward")
    far = states[turns[0] - 1] if len(turns) else states[-1]
    why = f"upward alone lets go of {len(path) - 1 - (far[1] - far[0])} of {len(path) - 1} bars"
    if not motion.straight:
        motion = peel(path, seed)
    return replace(motion, reason=f"{motion.reason}: {why}")


def _best_plan(grid: Grid, cells: IntArray, rng: Generator, tries: int, patience: int) -> IntArray:
    """The plan of several that leaves the fewest joints folded."""
    best = peel_plan(grid, cells, rng, patience=patience, bias=BIASES[0])
    for k in range(1, tries):
        if left_folded(best) <= 1:
            break
        states = peel_plan(grid, cells, rng, patience=patience, bias=BIASES[k % 3])
        best = min(best, states, key=left_folded)
    return best


def _opened(voxels: IntArray, rng: Generator, rounds: int, patience: int) -> Motion:
    """Limb moves, then peels: straight if a search between two rounds found a complete plan."""
    pose = open_pose(voxels, ROOM)
    shape = pose.joint.shape
    grid, rows = box_grid(shape), []
    for _ in range(rounds):
        rows.append(open_up(pose, arcs(), PROPOSALS * len(voxels), HEAT, rng))
        states = _best_plan(grid, cells_of(pose.place, shape), rng, len(BIASES), patience)
        if left_folded(states) <= 1:
            break
    motion = motion_of(pose.place, states)
    reason = f"{motion.reason} after {sum(map(len, rows))} limb moves"
    rows.append(motion.moves)
    return Motion(
        voxels,
        np.concatenate(rows),
        motion.diameter,
        motion.max_bend_deg,
        motion.straight,
        reason,
    )
