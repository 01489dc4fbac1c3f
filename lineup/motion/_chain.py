"""A folded chain on a grid, and what blocks a straight rod that leaves one of its joints.

Written for both ends at once. End 0 lets go of joints from the front and end 1 from the back;
``INWARD[end]`` is the step of the joint index away from that end. A rod counts as infinitely
long, so that what is allowed never depends on how much of the chain is straight already.
"""

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..grid import DIRECTIONS, BoolArray, IntArray

INWARD = (1, -1)
UNKNOWN = -2


class Grid(NamedTuple):
    """Cells 0..C-1 of a box with a margin of one; ``cell + offset[d]`` is the neighbour."""

    xyz: IntArray  # (C, 3)
    offset: IntArray  # (6,)
    outside: BoolArray  # (C,) the margin


class Chain(NamedTuple):
    """Joints 0..n-1 of a lattice path on a grid."""

    cell: IntArray  # (n,) cell of each joint
    joint: IntArray  # (C,) joint at each cell, -1 where there is none
    ray: IntArray  # (2, n, 6) nearest joint further inward on a ray, -1 or n where there is none
    quadrant: IntArray  # (2, n, 6, 6) the same for a closed quadrant, UNKNOWN until asked


def box_grid(shape: tuple[int, ...]) -> Grid:
    """The grid of a box of `shape` voxels."""
    padded = tuple(s + 2 for s in shape)
    xyz = np.stack(np.unravel_index(np.arange(np.prod(padded)), padded), axis=1) - 1
    strides = np.array([padded[1] * padded[2], padded[2], 1])
    outside = np.any((xyz < 0) | (xyz >= np.array(shape)), axis=1)
    return Grid(xyz.astype(np.int32), (DIRECTIONS @ strides).astype(np.int32), outside)


def cells_of(voxels: IntArray, shape: tuple[int, ...]) -> IntArray:
    """Cells, in `box_grid(shape)`, of voxel positions (P, 3)."""
    padded = tuple(s + 2 for s in shape)
    return np.ravel_multi_index(tuple((voxels + 1).T), padded).astype(np.int32)


@kernel
def link(grid: Grid, cell: IntArray) -> Chain:
    """The chain through `cell`, with its rays."""
    n = len(cell)
    index = np.full(len(grid.outside), -1, np.int32)
    for k in range(n):
        index[cell[k]] = k
    ray = np.empty((2, n, 6), np.int32)
    ray[0] = n
    ray[1] = -1
    for k in range(n):
        for d in range(6):
            c = cell[k] + grid.offset[d]
            while not grid.outside[c]:
                _nearer(index[c], k, ray[:, k, d])
                c += grid.offset[d]
    quadrant = np.full((2, n, 6, 6), UNKNOWN, np.int32)
    return Chain(cell, index, ray, quadrant)


@kernel
def _nearer(joint: int, k: int, nearest: IntArray) -> None:
    """Take `joint` into account as a blocker of joint k, from above (0) and from below (1)."""
    if joint > k:
        nearest[0] = min(nearest[0], joint)
    elif 0 <= joint < k:
        nearest[1] = max(nearest[1], joint)


@kernel
def has_rod(state: IntArray, end: int, n: int) -> bool:
    """Whether `end` of a chain of n joints has let go of a joint."""
    return state[end] != (n - 1) * end


@kernel
def ray_blocker(chain: Chain, end: int, k: int, d: int) -> int:
    """The joint nearest to k, on the inward side of `end`, that lies on the ray from k along d."""
    return chain.ray[end, k, d]


@kernel
def quadrant_blocker(grid: Grid, chain: Chain, end: int, k: int, d: int, f: int) -> int:
    """The same for the closed quadrant at k between directions d and f."""
    if chain.quadrant[end, k, d, f] == UNKNOWN:
        nearest = np.array([len(chain.cell), -1], np.int32)
        row = chain.cell[k]
        while not grid.outside[row]:
            c = row
            while not grid.outside[c]:
                _nearer(chain.joint[c], k, nearest)
                c += grid.offset[f]
            row += grid.offset[d]
        for side in range(2):
            chain.quadrant[side, k, d, f] = nearest[side]
            chain.quadrant[side, k, f, d] = nearest[side]
    return chain.quadrant[end, k, d, f]


@kernel
def rays_meet(p: IntArray, d: int, q: IntArray, f: int) -> bool:
    """Whether the lattice rays from p along d and from q along f share a point."""
    sign_d, sign_f = 1 - 2 * (d // 3), 1 - 2 * (f // 3)
    d, f = d % 3, f % 3
    for axis in range(3):
        if axis != d and axis != f and p[axis] != q[axis]:
            return False
    if d == f:
        return sign_d == sign_f or (q[d] - p[d]) * sign_d >= 0
    return (q[d] - p[d]) * sign_d >= 0 and (p[f] - q[f]) * sign_f >= 0


@kernel
def ray_meets_quadrant(p: IntArray, d: int, q: IntArray, f: int, g: int) -> bool:
    """Whether the lattice ray from p along d meets the closed quadrant at q between f and g."""
    u = (p[f % 3] - q[f % 3]) * (1 - 2 * (f // 3))
    v = (p[g % 3] - q[g % 3]) * (1 - 2 * (g // 3))
    normal = 3 - f % 3 - g % 3
    w = p[normal] - q[normal]
    if d % 3 == normal:
        return u >= 0 and v >= 0 and w * (1 - 2 * (d // 3)) <= 0
    if w != 0:
        return False
    if d % 3 == f % 3:
        return v >= 0 and (u >= 0 or d == f)
    return u >= 0 and (v >= 0 or d == g)
