"""Pull-through: the chain glides along its own track, led out by one end, until it is straight.

The snake-like motion needs no search, only a way out for one end: after the path the track leads
through free voxels to a lattice ray into the open. What it asks of the blocks is another matter:
bars must be thinner than touching blocks, since they cut corners. `judging._pulls` tells why
bars of diameter .914 and joints of 90 degrees do if the track has no *U*, three edges of a unit
square in a row, and .866 and 120 degrees whatever the track.
"""

import numpy as np
from numpy.typing import NDArray

from ..grid import DIRECTIONS, BoolArray, IntArray, bar_directions
from ..kinematics import Move
from ..solid import Motion, VoxelPath
from ._ways import ways

U_FREE, WITH_US = (0.914, 90.0), (0.866, 120.0)
"""Diameter and largest bend that a track without a U allows, and one with Us."""

MARGIN = 2
"""Free voxels all round a path among which a way out is sought."""


def pull(path: VoxelPath, seed: int) -> Motion:
    """Pull the chain out by the end that leaves without a U, or else with one, in fewer pulls."""
    del seed  # nothing is drawn
    bars = bar_directions(path.voxels)
    kinds = (U_FREE, WITH_US) if not has_u(bars) else (WITH_US,)
    for diameter, max_bend_deg in kinds:
        u_free = (diameter, max_bend_deg) == U_FREE
        found = [_moves(path.voxels, head, u_free=u_free) for head in (len(bars), 0)]
        ways = [moves for moves in found if moves is not None]
        if ways:
            moves = min(ways, key=len)
            return Motion(path.voxels, moves, diameter, max_bend_deg, True, "straight")
    reason = "no way out: the rest of the path shuts in both ends"
    nothing = np.empty((0, 4), np.int32)
    return Motion(path.voxels, nothing, diameter, max_bend_deg, False, reason)


def has_u(bars: NDArray[np.int8]) -> bool:
    """Whether three of these edges in a row are sides of one unit square."""
    return bool(((bars[2:] + 3) % 6 == bars[:-2]).any())


def _moves(voxels: IntArray, head: int, *, u_free: bool) -> IntArray | None:
    """The pulls (M, 4) by end `head` that make the chain straight; None if there is no way out."""
    last = len(voxels) - 1
    track = bar_directions(voxels if head else voxels[::-1]).tolist()
    way = _way_out(voxels, head, track, u_free=u_free)
    if way is None:
        return None
    track += way
    n_pulls = next((k for k in range(len(track) - 1, 0, -1) if track[k] != track[k - 1]), 0)
    values = (track[last:] + track[-1:] * n_pulls)[:n_pulls]
    rows = [(Move.PULL, head, last - head, value) for value in values]
    return np.array(rows, np.int32).reshape(-1, 4)


def _way_out(voxels: IntArray, head: int, track: list[int], *, u_free: bool) -> list[int] | None:
    """The steps of a shortest way from an end to an open ray, the first on the ray included."""
    corner = voxels.min(axis=0) - MARGIN
    taken = np.zeros(voxels.max(axis=0) + MARGIN + 1 - corner, bool)
    taken[tuple((voxels - corner).T)] = True
    opens = np.stack([_open_rays(taken, d).ravel() for d in range(6)])
    shut = np.pad(taken[1:-1, 1:-1, 1:-1], 1, constant_values=True)
    first = int(np.ravel_multi_index(tuple(voxels[head] - corner), taken.shape))
    start = (first, track[-1], track[-2] if u_free and len(track) > 1 else track[-1])
    for cells, steps in ways(shut, start, opens, u_free=u_free):
        if _is_simple(cells, steps[-1], taken.shape):
            return steps
    return None


def _open_rays(taken: BoolArray, direction: int) -> BoolArray:
    """Cells from which none of `taken` lies ahead in a direction."""
    axis = direction % 3
    inwards = np.flip(taken, axis) if direction < 3 else taken
    seen = inwards.cumsum(axis=axis) == inwards
    return np.flip(seen, axis) if direction < 3 else seen


def _is_simple(cells: list[int], direction: int, shape: tuple[int, ...]) -> bool:
    """Whether a way meets neither itself nor the ray on from its last cell."""
    points = np.stack(np.unravel_index(cells, shape), axis=1)
    beyond = points - points[-1]
    ahead = beyond @ DIRECTIONS[direction]
    on_ray = (ahead > 0) & (np.abs(beyond).sum(axis=1) == ahead)
    return len(set(cells)) == len(cells) and not on_ray.any()
