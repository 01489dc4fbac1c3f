"""Foldings that are pulled out by one end: any path will do, and one without Us asks the least."""

import numpy as np

from ..contraction import (
    END,
    PAIR,
    STAYS,
    Fate,
    adjacent_steps,
    between,
    n_between,
    shortened_path,
    without,
)
from ..grid import DIRECTIONS, BoolArray, IntArray, bar_directions
from ..kinematics import Move
from ..layered import layered_path
from ..motion import unfold
from ..motion.pulling import has_u
from ..solid import Folding, Motion, VoxelSolid

LEAST_INDEX = 4
"""A pair with two voxels between makes a U already, so that a path without Us has none."""

NO_BAR = -1


def pulled(
    solid: VoxelSolid,
    seed: int,
    length: int | None,
    *,
    path: str = "ufree",
    sweeps: int | None = None,
) -> Folding:
    """A path of the method `path`, and the motion that pulls it out."""
    del length  # the caller trims
    options = {} if sweeps is None else {"sweeps": sweeps}
    found = layered_path(solid, path, seed, **options)
    return Folding(found, unfold(found, "pull", seed))


def is_pulled(motion: Motion) -> bool:
    """Whether a motion ends straight and has no other moves than pulls."""
    return motion.straight and bool((motion.moves[:, 0] == Move.PULL).all())


def shortened_pulled(folding: Folding, length: int, keep: BoolArray) -> Folding:
    """A pulled folding cut down to `length` voxels, without a U if it has none.

    What is taken off frees voxels and no more, so the old track still leads out. In a path
    without Us the voxels between contraction pairs go first, where there are none to keep and the
    contraction makes no U, the shortest first; then blocks off both ends, where they cost least.
    """
    path, moves = folding.path, folding.motion.moves
    if has_u(bar_directions(path.voxels)):
        shorter = shortened_path(path, length, keep)
    else:
        track = slice(None, None, 1 if moves[0, 1] else -1)  # the end that leads is the last
        kept = keep[tuple(path.voxels.T)]
        way_out = moves[[0, min(1, len(moves) - 1)], 3]
        fate = _without_a_u(path.voxels[track], way_out, kept[track], length)
        shorter = without(path, fate[track], kept)
    return Folding(shorter, unfold(shorter, "pull"))


def _without_a_u(voxels: IntArray, way_out: IntArray, kept: BoolArray, length: int) -> Fate:
    """How each step of a path without Us goes; `way_out` are the two edges after it."""
    fate = np.full(len(voxels), STAYS, np.int8)
    steps = np.arange(len(voxels))
    while (excess := len(steps) - length) >= LEAST_INDEX:
        pairs = _harmless_pairs(voxels[steps], way_out, kept[steps], excess)
        if not len(pairs):
            break
        inside = between(pairs)
        fate[steps[inside]] = PAIR
        steps = np.delete(steps, inside)
    excess = len(steps) - length
    n_before = np.concatenate([[0], kept[steps].cumsum()])
    first = np.arange(0, excess + 1, 2)
    cost = n_before[first] + n_before[-1] - n_before[first + length]
    a = int(first[cost.argmin()])
    fate[steps[:a]] = fate[steps[a + length :]] = END
    return fate


def _harmless_pairs(voxels: IntArray, way_out: IntArray, kept: BoolArray, excess: int) -> IntArray:
    """Contraction pairs of a track with nothing to keep between, which together make no U.

    They come to `excess` voxels at most, the shortest first.
    """
    pairs = adjacent_steps(voxels, DIRECTIONS)
    index = pairs[:, 1] - pairs[:, 0] - 1
    pairs = pairs[(n_between(kept, pairs) == 0) & (index <= excess)]
    i, j = pairs.T
    bars = np.concatenate([[NO_BAR] * 2, bar_directions(voxels), way_out])  # bar k in place k + 2
    new = _directions(voxels[j] - voxels[i])
    back = (new + 3) % 6
    makes_u = (bars[i] == back) | (bars[j + 3] == back) | (bars[i + 1] == (bars[j + 2] + 3) % 6)
    pairs = pairs[~makes_u]
    return _apart(pairs[np.argsort(pairs[:, 1] - pairs[:, 0], kind="stable")], excess)


def _directions(steps: IntArray) -> IntArray:
    axis = np.abs(steps).argmax(axis=1)
    directions: IntArray = axis + 3 * (steps.sum(axis=1) < 0)
    return directions


def _apart(pairs: IntArray, excess: int) -> IntArray:
    """The pairs that come first with two bars between each two of them, up to `excess` voxels."""
    taken = np.zeros(int(pairs.max(initial=0)) + 3, bool)
    chosen = []
    for i, j in pairs.tolist():
        if j - i - 1 <= excess and not taken[i + 1 : j + 2].any():
            taken[i : j + 3] = True
            excess -= j - i - 1
            chosen.append((i, j))
    return np.array(chosen, np.int32).reshape(-1, 2)
