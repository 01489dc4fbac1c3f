"""Upper bounds on the length of a simple path, so that every result has a gap."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import maximum_flow

from . import grid
from .solid import VoxelSolid


def path_bound(solid: VoxelSolid) -> int:
    """A number of voxels that no simple path in the solid exceeds, even or not.

    The edges of a path are a simple 2-matching: edges of the voxel graph, at most two at each
    voxel. The graph is bipartite by colour, so the largest 2-matching is a maximum flow: from a
    source to each voxel of colour 0 (capacity 2), from there to its neighbours (1), from each
    voxel of colour 1 to a sink (2). A path of m edges has m + 1 voxels.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> cross = np.zeros((3, 3, 1), bool)
    >>> cross[1] = cross[:, 1] = True
    >>> lu.path_bound(lu.VoxelSolid(cross))
    3
    """
    voxels = np.argwhere(solid.occupancy)
    n = len(voxels)
    number = np.full(np.array(solid.occupancy.shape) + 2, -1, np.int64)
    number[1:-1, 1:-1, 1:-1][solid.occupancy] = np.arange(n)
    even = np.flatnonzero(grid.colour(voxels) == 0)
    odd = np.flatnonzero(grid.colour(voxels) == 1)
    beside = number[tuple((voxels[even][:, None] + 1 + grid.DIRECTIONS).transpose(2, 0, 1))]
    joined = beside >= 0
    source, sink = n, n + 1
    tail = np.concatenate([np.full(len(even), source), np.repeat(even, joined.sum(axis=1)), odd])
    head = np.concatenate([even, beside[joined], np.full(len(odd), sink)])
    capacity = np.where((tail == source) | (head == sink), 2, 1).astype(np.int32)
    network = csr_array((capacity, (tail, head)), shape=(n + 2, n + 2))
    return min(n, int(maximum_flow(network, source, sink).flow_value) + 1)
