"""Paths through all of a solid, once every voxel is split in k^3 (beyond the paper's Section 4).

Every voxel gets a block of closed cycles that covers its k^3 parts. Two cycles with parallel edges
side by side become one when these two edges give way to two across. Along a spanning tree of the
voxels that joins all cycles to one; cut open anywhere it is a path that leaves out nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import breadth_first_order, minimum_spanning_tree

from . import grid
from ._jit import kernel
from ._record import of_kind
from .solid import VoxelPath, VoxelSolid
from .visits import visits_of

Links = NDArray[np.int8]
"""(X, Y, Z, 2): the two directions in which the cycle leaves each voxel."""

STEPS = grid.DIRECTIONS

UP = 2
SIDES = np.array([0, 1, 3, 4])
"""The directions of the sides of a square: east, north, west, south."""

_SQUARE = "ENWS"
_SQUARE_CORNER = np.array([(1, 0, 0), (0, 1, 0), (0, 0, 0), (0, 0, 0)])
_SQUARE_EDGE = np.array([1, 0, 1, 0])
"""The edge of a square along each of its sides: where it begins, and its direction."""

_CUBE = "EUUUNNDNEEUSSSWDDDNNUUESSDDNNNWWSSUEENNWWSWSSUUNNNEESSDWWNNDDSSS"
_CUBE_CORNER = np.array([(3, 1, 1), (0, 3, 1), (2, 1, 3)])
_CUBE_EDGE = np.array([1, 2, 1])
"""The edge of a cube that faces east, north and up; the next cube has one right across."""


def refine(solid: VoxelSolid, k: int) -> VoxelSolid:
    """`solid` with every voxel split in k^3; ``source["refined"]`` tells the k.

    Raises
    ------
    ValueError
        If `k` is not a positive integer.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> fine = lu.refine(lu.VoxelSolid(np.ones((4, 3, 2), bool), pitch=10.0), 2)
    >>> fine.size, fine.pitch, fine.source
    (192, 5.0, {'refined': 2})
    """
    of_kind(solid, VoxelSolid)
    if not isinstance(k, int | np.integer) or k < 1:
        raise ValueError(f"k must be a positive integer, got {k!r}")
    source = solid.source | {"refined": int(k) * solid.source.get("refined", 1)}
    return VoxelSolid(_split(solid.occupancy, k), solid.pitch / k, solid.name, source)


def _split(occupancy: grid.BoolArray, k: int) -> grid.BoolArray:
    return occupancy.repeat(k, axis=0).repeat(k, axis=1).repeat(k, axis=2)


def refined_path(solid: VoxelSolid, seed: int) -> VoxelPath:
    """All of the solid refined 2 x 2 x 2, in nested layers.

    Every voxel v has two cycles, the squares b(v) of its lower and t(v) of its upper layer. Take
    a spanning tree of each node of the Reeb graph and one of the graph itself. A link from v up
    to v+ joins t(v) to b(v+) along one of the four sides; from the bottom up, choose one that
    leads to the parent neither of v nor of v+ and is not that of the link below v. Then some
    side x of v leads neither to its parent nor has a link. A child at x is joined in both
    layers; if there is none, b(v) and t(v) are joined along x. A child on the side of the link
    below is joined in the upper layer, where this side is free, any other in the lower layer.
    So no edge is used twice, and these are 2n - 1 joins that connect the 2n squares: one cycle.
    The joins form a tree, so every excursion to another layer comes back beside where it left
    (Section 4.2, Case 2). Both ends lie side by side in the top layer. Time is linear but for
    the sorting that draws the trees; memory is linear in the grid.

    A cycle that has each node in one piece need not exist: in the plus of five voxels, refined,
    no path through all cells joins two neighbours in the middle, as a tower there would need.
    """
    net = _network(solid, seed, layers_first=True)
    links = _blocks(solid, 2, [(_SQUARE, (0, 0, 0)), (_SQUARE, (0, 0, 1))])
    for height, squares, directions in _square_joins(net):
        voxel, side = np.nonzero(squares)
        corner = 2 * net.voxels[voxel] + _SQUARE_CORNER[side] + (0, 0, height)
        _join(links, corner, _SQUARE_EDGE[side], directions[side])
    voxels = _opened(links, 8 * solid.size)
    visits = visits_of(voxels, _pieces(voxels))
    return VoxelPath(voxels, visits=visits, refinement=2, method="refined")


def refined4_path(solid: VoxelSolid, seed: int) -> VoxelPath:
    """All of the solid refined 4 x 4 x 4, without a U: three edges of one unit square.

    Such a path unfolds by pulling at an exposed end, as both are here, on top. Every voxel has
    one cycle through its 64 parts, with an edge on each face right across from that of the
    neighbour; the n - 1 joins along any spanning tree make one cycle. Every unit square lies in
    four cubes around a line, and joins of other cubes only take edges from it: so no U comes
    about, because none does in the 16 ways to join four such cubes, for each of the three axes.
    Time and memory are as those of `refined_path`.
    """
    net = _network(solid, seed, layers_first=False)
    links = _blocks(solid, 4, [(_CUBE, (0, 0, 0))])
    voxel, direction = np.nonzero((net.child | net.to_parent)[:, :3])
    corner = 4 * net.voxels[voxel] + _CUBE_CORNER[direction]
    _join(links, corner, _CUBE_EDGE[direction], direction)
    return VoxelPath(_opened(links, 64 * solid.size), refinement=4, method="refined4")


REFINED: dict[str, Callable[..., VoxelPath]] = {
    "refined": refined_path,
    "refined4": refined4_path,
}
"""The path methods that refine the solid; one voxel is enough for them."""


@dataclass(frozen=True, eq=False)
class _Net:
    """The voxels of a solid, (n, 3), and a rooted spanning tree of them.

    `beside` (n, 6) is the number of the voxel in each direction or -1; `to_parent` and `child`
    (n, 6) tell in which directions the tree leads up and down.
    """

    voxels: NDArray[np.int64]
    beside: NDArray[np.int64]
    to_parent: grid.BoolArray
    child: grid.BoolArray


def _network(solid: VoxelSolid, seed: int, layers_first: bool) -> _Net:
    """A random spanning tree; with `layers_first` it spans every node of the Reeb graph."""
    if seed < 0:
        raise ValueError(f"seed must be at least 0, got {seed}")
    voxels = np.argwhere(solid.occupancy)
    n = len(voxels)
    number = np.full(np.array(solid.occupancy.shape) + 2, -1)
    number[1:-1, 1:-1, 1:-1][solid.occupancy] = np.arange(n)
    beside = number[tuple((voxels[:, None] + 1 + grid.DIRECTIONS).transpose(2, 0, 1))]
    voxel, direction = np.nonzero(beside[:, :3] >= 0)
    weight = 1.0 + np.random.default_rng(seed).permutation(len(voxel))
    if layers_first:
        weight += len(voxel) * (direction == UP)
    graph = csr_array((weight, (voxel, beside[voxel, direction])), shape=(n, n))
    _, parent = breadth_first_order(minimum_spanning_tree(graph), 0, directed=False)
    child = (beside >= 0) & (parent[beside] == np.arange(n)[:, None])
    return _Net(voxels, beside, beside == parent[:, None], child)


def _square_joins(net: _Net) -> list[tuple[int, grid.BoolArray, NDArray[np.int64]]]:
    """The joins of `refined_path`: layer 0 or 1, (n, 4) squares and sides, direction by side."""
    link, free = _links_up(net)
    below = np.zeros_like(link)
    linked = link.any(axis=1)
    below[net.beside[linked, UP]] = link[linked]
    child = net.child[:, SIDES]
    both = np.zeros_like(free)
    both[np.arange(len(free)), free.argmax(axis=1)] = True
    up = np.full(4, UP)
    return [
        (0, child & ~below, SIDES),
        (1, child & (both | below), SIDES),
        (0, both & ~child, up),
        (1, link, up),
    ]


def _links_up(net: _Net) -> tuple[grid.BoolArray, grid.BoolArray]:
    """The side of the link up from each voxel, and the sides that lead to no parent or link."""
    link = np.zeros((len(net.voxels), 4), bool)
    free = ~net.to_parent[:, SIDES]
    linked = np.flatnonzero((net.child | net.to_parent)[:, UP])
    height = net.voxels[linked, 2]
    order = np.argsort(height, kind="stable")
    for lower in np.split(linked[order], np.flatnonzero(np.diff(height[order])) + 1):
        upper = net.beside[lower, UP]
        side = (free[lower] & free[upper]).argmax(axis=1)
        link[lower, side] = True
        free[lower, side] = free[upper, side] = False
    return link, free


def _blocks(solid: VoxelSolid, k: int, cycles: list[tuple[str, tuple[int, int, int]]]) -> Links:
    """The cycles, each a word and the voxel it starts at, in every voxel split in k^3."""
    block = np.empty((k, k, k, 2), np.int8)
    for word, start in cycles:
        steps = np.array([grid.LETTERS.index(letter) for letter in word])
        along = start + np.cumsum(grid.DIRECTIONS[steps], axis=0)
        block[tuple(along.T)] = np.stack([(steps + 3) % 6, np.roll(steps, -1)], axis=1)
    links = np.tile(block, (*solid.occupancy.shape, 1))
    links[_split(~solid.occupancy, k)] = -1
    return links


def _join(
    links: Links, corner: NDArray[np.int64], edge: NDArray[np.int64], direction: NDArray[np.int64]
) -> None:
    """Replace each edge from `corner` and the one across from it by the two steps across."""
    along, across = grid.DIRECTIONS[edge], grid.DIRECTIONS[direction]
    edge_back, back = (edge + 3) % 6, (direction + 3) % 6
    for voxel, old, new in (
        (corner, edge, direction),
        (corner + along, edge_back, direction),
        (corner + across, edge, back),
        (corner + along + across, edge_back, back),
    ):
        place = tuple(voxel.T)
        which = (links[place][:, 1] == old).astype(int)
        links[(*place, which)] = new


def _opened(links: Links, n: int) -> grid.IntArray:
    """The cycle of n voxels, cut open at an edge of its top layer."""
    z = np.flatnonzero((links[..., 0] >= 0).any(axis=(0, 1)))[-1]
    top = links[:, :, z]
    x, y, which = np.argwhere((top >= 0) & (top % 3 != UP))[0]
    return _walk(links, (x, y, z), top[x, y, 1 - which], n)


@kernel
def _walk(
    links: NDArray[np.int8], start: tuple[int, int, int], first: int, n: int
) -> NDArray[np.int32]:
    """The n voxels met from `start` along the links, the first step in direction `first`."""
    voxels = np.empty((n, 3), np.int32)
    x, y, z = start
    step = first
    for k in range(n):
        voxels[k] = x, y, z
        if k > 0:
            back = (step + 3) % 6
            step = links[x, y, z, 0]
            if step == back:
                step = links[x, y, z, 1]
        dx, dy, dz = STEPS[step]
        x, y, z = x + dx, y + dy, z + dz
    return voxels


def _pieces(voxels: grid.IntArray) -> grid.IntArray:
    """The piece of each step of `refined_path`: every excursion leaves and comes back on one link.

    A link is two steps side by side between two squares, one above the other.
    """
    climbs = np.flatnonzero(np.diff(voxels[:, 2])) + 1
    x, y = voxels[climbs, 0] // 2, voxels[climbs, 1] // 2
    lower = np.minimum(voxels[climbs - 1, 2], voxels[climbs, 2])
    link = np.ravel_multi_index((x, y, lower), tuple(voxels.max(axis=0) + 1))
    _, first, number = np.unique(link, return_index=True, return_inverse=True)
    left = first[number]
    is_back = left < np.arange(len(climbs))
    runs = np.append(0, np.cumsum(~is_back))
    for k in np.flatnonzero(is_back):
        runs[k + 1] = runs[left[k]]
    return np.repeat(runs, np.diff(climbs, prepend=0, append=len(voxels))).astype(np.int32)
