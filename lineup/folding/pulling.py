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

    What is taken off frees voxels and no more, so the old track still leads out. From a path
    without Us go the voxels between contraction pairs that make no U, the least share of voxels
    to keep first, and then blocks off both ends, as soon as they cost a smaller share.
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
    while len(steps) > length:
        excess = len(steps) - length
        lost = np.concatenate([[0], kept[steps].cumsum()])
        first = np.arange(0, excess + 1, 2)
        off_the_ends = lost[first] + lost[-1] - lost[first + length]
        pairs = _harmless_pairs(voxels[steps], way_out, excess)
        share = n_between(kept[steps], pairs) / (pairs[:, 1] - pairs[:, 0] - 1)
        if share.min(initial=np.inf) > off_the_ends.min() / excess:
            a = int(first[off_the_ends.argmin()])
            fate[steps[:a]] = fate[steps[a + length :]] = END
            break
        inside = between(_apart(pairs[share == share.min()], excess))
        fate[steps[inside]] = PAIR
        steps = np.delete(steps, inside)
    return fate


def _harmless_pairs(voxels: IntArray, way_out: IntArray, most: int) -> IntArray:
    """Contraction pairs of index `most` at most that make no U, the shortest first."""
    pairs = adjacent_steps(voxels, DIRECTIONS)
    pairs = pairs[pairs[:, 1] - pairs[:, 0] - 1 <= most]
    i, j = pairs.T
    bars = np.concatenate([[NO_BAR] * 2, bar_directions(voxels), way_out])  # bar k in place k + 2
    back = (_directions(voxels[j] - voxels[i]) + 3) % 6
    makes_u = (bars[i] == back) | (bars[j + 3] == back) | (bars[i + 1] == (bars[j + 2] + 3) % 6)
    harmless: IntArray = pairs[~makes_u]
    return harmless[np.argsort(harmless[:, 1] - harmless[:, 0], kind="stable")]


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
