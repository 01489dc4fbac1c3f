"""What a chain that glides along its own track needs free of obstacles, which are unit voxels.

While one PULL is made, bar k lies in the triangle of the track's vertices k, k + 1 and k + 2, see
`_pulls`. In a straight line the triangle is a segment between two opposite points of the three
voxels, and a ball of diameter 1 about a point of it stays in them. At a corner, with the middle
vertex at (0, 0, 0) and the others at (1, 0, 0) and (0, 1, 0), a point of the triangle has
coordinates x and y from 0 to 1 and z = 0, so that a ball of diameter 1 about it lies where x and y
are from -1/2 to 3/2 and z from -1/2 to 1/2: in the three voxels and the one in the *crook* of the
corner, (1, 1, 0). So a chain of diameter 1 or less meets no obstacle if all voxels of its track are
free and all crooks. The crook is needed: half way round, a bar is .207 from its nearest edge.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..solid import Obstacles

THICKEST = 1.0
"""Largest diameter of bars for which this holds."""


class Hit(NamedTuple):
    """The first obstacle met: the vertex of the track that has been reached then, and what."""

    vertex: int
    what: str


def first_hit(track: NDArray[np.int64], obstacles: Obstacles) -> Hit | None:
    """The first voxel of a track, or crook of one of its corners, that is an obstacle."""
    corner = (np.diff(track[:-1], axis=0) * np.diff(track[1:], axis=0)).sum(axis=1) == 0
    crooks = track[:-2] + track[2:] - track[1:-1]
    in_crook = obstacles.holds(crooks) & corner
    on_track = obstacles.holds(track)
    at = np.flatnonzero(on_track | np.concatenate([[False] * (len(track) - len(crooks)), in_crook]))
    if not len(at):
        return None
    vertex = int(at[0])
    if on_track[vertex]:
        return Hit(vertex, f"voxel {_named(track[vertex])} of the track")
    return Hit(vertex, f"voxel {_named(crooks[vertex - 2])} in the crook of a corner")


def _named(voxel: NDArray[np.int64]) -> str:
    return f"({', '.join(str(x) for x in voxel.tolist())})"
