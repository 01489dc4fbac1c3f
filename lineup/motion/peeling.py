"""Peel, swing and door: unfold a given path from its two ends (Section 7's pulling, as a search).

Where the ends are shut in, the pose is opened first: limbs turn and glide at random, out of each
other's way, until a search finds how the ends can be let go.
"""

from dataclasses import replace

import numpy as np
from numpy.random import Generator

from ..grid import LETTERS, IntArray
from ..joints import slot_violations
from ..solid import Motion, VoxelPath
from ._chain import INWARD, Grid, box_grid, cells_of, link
from ._limbs import arcs, open_pose, open_up
from ._search import may_peel
from .plan import JOINTS, left_folded, motion_of, path_grid, peel_plan

BIASES = (0.02, 0.98, 0.5)
ROOM = 48
"""Free cells around the path in which its limbs may come to rest."""

PROPOSALS = 2
"""Limb moves tried in a round, for each joint."""

HEAT = 0.5
RESTART = 20
"""Rounds after which limbs are moved anew from the path as it is."""

HASTE = 5
"""A search between rounds gives up so many times sooner."""


def peel(
    path: VoxelPath,
    seed: int,
    *,
    tries: int = 4,
    patience: int = 5_000,
    rounds: int = 100,
    joints: str = "free",
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
    joints : str
        ``"slotted"`` leaves out moves that the slots of the printed block do not let the chain
        make (`lineup.joints`); ``"sparing"`` makes as few of them as it finds, and says how many.
    """
    check_efforts(tries, patience, rounds, joints)
    if joints != "free" and len(path) % 2:
        raise ValueError(f"{joints} joints are of blocks of two voxels, got {len(path)} voxels")
    rng = np.random.default_rng(seed)
    grid, cells = path_grid(path.voxels)
    found: list[tuple[int, int, IntArray]] = []
    for k in range(tries):
        bias = BIASES[k % len(BIASES)]
        states = peel_plan(grid, cells, rng, patience=patience, bias=bias, joints=joints)
        faults = _faults(motion_of(path.voxels, states, joints)) if joints == "sparing" else 0
        found.append((left_folded(states), faults, states))
        if found[-1][:2] <= (1, 0):
            break
    best = motion_of(path.voxels, min(found, key=lambda plan: plan[:2])[2], joints)
    if not (best.straight or rounds == 0 or len(path) < 4):
        opened = _opened(path.voxels, rng, rounds, max(1, patience // HASTE), joints)
        best = opened if opened.straight else best
    if joints != "sparing":
        return best
    told = f"{best.reason}, {_faults(best)} of {len(best)} moves against the slots"
    return replace(best, reason=told)


def _faults(motion: Motion) -> int:
    """Moves against the slots."""
    return len(np.unique(slot_violations(motion)[:, 0]))


def check_efforts(tries: int, patience: int, rounds: int, joints: str = "free") -> None:
    """Raise a ValueError if an option of `peel` is too small, or the joints are unknown."""
    if joints not in JOINTS:
        raise ValueError(f"unknown joints {joints!r}; known: {', '.join(JOINTS)}")
    efforts = (("tries", tries, 1), ("patience", patience, 1), ("rounds", rounds, 0))
    for name, value, least in efforts:
        if value < least:
            raise ValueError(f"{name} must be at least {least}, got {value}")


def peel_upward(path: VoxelPath, seed: int) -> Motion:
    """Both ends pulled upward, as the paper does it by hand (Section 7); else what `peel` finds.

    Its `reason` tells how far pulling upward goes by itself.
    """
    states = _upward_plan(*path_grid(path.voxels))
    motion = motion_of(path.voxels, states)
    if motion.straight:
        return replace(motion, reason="straight: both ends pulled upward")
    n_bars = len(path) - 1
    far = f"upward alone lets go of {n_bars - left_folded(states)} of {n_bars} bars"
    motion = peel(path, seed)
    return replace(motion, reason=f"{motion.reason}: {far}")


def _upward_plan(grid: Grid, cells: IntArray) -> IntArray:
    """Peels of rods that point up, as far as they go; in which order makes no difference."""
    up = LETTERS.index("U")
    chain, state = link(grid, cells), np.array([0, len(cells) - 1, up, up], np.int32)
    states = [state.copy()]
    while state[1] - state[0] > 1:
        ends = [end for end in range(2) if may_peel(grid, chain, state, end)]
        if not ends:
            break
        state[ends[0]] += INWARD[ends[0]]
        states.append(state.copy())
    return np.array(states)


def _opened(voxels: IntArray, rng: Generator, rounds: int, patience: int, joints: str) -> Motion:
    """Limb moves, then peels: straight if a search between two rounds found a complete plan."""
    for k in range(rounds):
        if k % RESTART == 0:
            pose, rows = open_pose(voxels, ROOM), []
        proposals, slotted = PROPOSALS * len(voxels), joints != "free"
        rows.append(open_up(pose, arcs(), proposals, HEAT, rng, slotted))
        grid, cells = box_grid(pose.joint.shape), cells_of(pose.place, pose.joint.shape)
        bias = BIASES[k % len(BIASES)]
        states = peel_plan(grid, cells, rng, patience=patience, bias=bias, joints=joints)
        if left_folded(states) <= 1:
            break
    motion = motion_of(pose.place, states, joints)
    reason = f"{motion.reason} after {sum(map(len, rows))} limb moves"
    moves = np.concatenate([*rows, motion.moves])
    return replace(motion, start=voxels, moves=moves, reason=reason)
