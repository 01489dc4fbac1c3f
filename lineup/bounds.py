"""Upper bounds on the length of a simple path, so that every result has a gap."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.sparse import csr_array
from scipy.sparse.csgraph import maximum_flow

from . import grid
from ._record import of_kind
from .grid import IntArray
from .solid import VoxelSolid

UNIT = grid.DIRECTIONS[:3]


def path_bound(solid: VoxelSolid, u_free: bool = False) -> int:
    """A number of voxels that no simple path in the solid exceeds, even or not.

    Parameters
    ----------
    u_free : bool
        Bound the paths without a U, by linear programming: at most two edges at each voxel and
        on each unit square. It takes seconds where the other bound takes milliseconds.

    Notes
    -----
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
    of_kind(solid, VoxelSolid)
    voxels = np.argwhere(solid.occupancy).astype(np.int32)
    n = len(voxels)
    number = np.full(np.array(solid.occupancy.shape) + 2, -1, np.int64)
    number[1:-1, 1:-1, 1:-1][solid.occupancy] = np.arange(n)
    return min(n, (_u_free_edges if u_free else _matched_edges)(voxels, number) + 1)


def _matched_edges(voxels: IntArray, number: NDArray[np.int64]) -> int:
    """Edges of a maximum simple 2-matching of the voxel graph, by maximum flow."""
    n = len(voxels)
    even = np.flatnonzero(grid.colour(voxels) == 0)
    odd = np.flatnonzero(grid.colour(voxels) == 1)
    beside = number[tuple((voxels[even][:, None] + 1 + grid.DIRECTIONS).transpose(2, 0, 1))]
    joined = beside >= 0
    source, sink = n, n + 1
    tail = np.concatenate([np.full(len(even), source), np.repeat(even, joined.sum(axis=1)), odd])
    head = np.concatenate([even, beside[joined], np.full(len(odd), sink)])
    capacity = np.where((tail == source) | (head == sink), 2, 1).astype(np.int32)
    network = csr_array((capacity, (tail, head)), shape=(n + 2, n + 2))
    return int(maximum_flow(network, source, sink).flow_value)


def _u_free_edges(voxels: IntArray, number: NDArray[np.int64]) -> int:
    """Edges of a fractional 2-matching with at most two on each unit square, rounded down."""
    tail, axis = np.nonzero(number[tuple((voxels[:, None] + 1 + UNIT).transpose(2, 0, 1))] >= 0)
    if not len(tail):
        return 0
    head = number[tuple((voxels[tail] + 1 + UNIT[axis]).T)]
    edge = np.full((len(voxels), 3), -1)
    edge[tail, axis] = np.arange(len(tail))
    rows = [np.concatenate([tail, head])]
    columns = [np.tile(np.arange(len(tail)), 2)]
    n_rows = len(voxels)
    for a, b in ((0, 1), (0, 2), (1, 2)):
        beyond = [number[tuple((voxels + 1 + UNIT[d]).T)] for d in (a, b)]
        sides = [edge[:, a], edge[:, b], edge[beyond[0], b], edge[beyond[1], a]]
        whole = np.flatnonzero(np.min([*beyond, *sides], axis=0) >= 0)
        rows.append(np.tile(n_rows + np.arange(len(whole)), 4))
        columns.append(np.concatenate([side[whole] for side in sides]))
        n_rows += len(whole)
    row, column = np.concatenate(rows), np.concatenate(columns)
    most_two: Any = csr_array((np.ones(len(row)), (row, column)), shape=(n_rows, len(tail)))
    found = linprog(
        -np.ones(len(tail)), most_two, np.full(n_rows, 2.0), bounds=(0, 1), method="highs-ipm"
    )
    if found.fun is None:
        raise RuntimeError(f"the linear program was not solved: {found.message}")
    return int(np.floor(1e-4 - found.fun))  # the solver is exact to about 1e-7 of its result
