"""The Reeb graph of a solid and its traversing walk (Section 4 and 4.3, Figures 4, 8 and 9).

A node is one 4-connected component of one horizontal layer; two nodes are joined by an edge
where a voxel of one lies directly above a voxel of the other.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from . import grid
from ._record import of_kind, record
from .solid import VoxelSolid


@record
class ReebGraph:
    """The nodes 0..N-1 of a solid, numbered from the lowest layer up, and their adjacency.

    Attributes
    ----------
    node_of : (X, Y, Z) int32
        Node of each voxel, -1 outside the solid.
    layer_of : (N,) int32
        The z of each node.
    edges : (E, 2) int32
        Lower node, upper node; rows in lexicographic order.
    """

    node_of: grid.IntArray
    layer_of: grid.IntArray
    edges: grid.IntArray

    def __len__(self) -> int:
        return len(self.layer_of)


@dataclass(frozen=True)
class Traversal:
    """A traversing walk p(G), split into maximal sub-path and maximal sub-cycles (Section 4.3).

    Attributes
    ----------
    walk : tuple of int
        Every node at least once; consecutive nodes are joined by an edge of the graph.
    msp : tuple of int
        The nodes left when the MSCs are taken out, each once.
    mscs : tuple of tuple of int
        Closed walks in the order of the walk. Each starts and ends at its node o(C) on the MSP
        and meets o(C) nowhere else.
    """

    walk: tuple[int, ...]
    msp: tuple[int, ...]
    mscs: tuple[tuple[int, ...], ...]


def reeb_graph(solid: VoxelSolid) -> ReebGraph:
    """The Reeb graph of `solid` for the height function z (Section 4, Figure 4(b)).

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> arch = np.ones((3, 1, 2), bool)
    >>> arch[1, 0, 0] = False
    >>> graph = lu.reeb_graph(lu.VoxelSolid(arch))
    >>> graph.layer_of.tolist(), graph.edges.tolist()
    ([0, 0, 1], [[0, 2], [1, 2]])
    """
    of_kind(solid, VoxelSolid)
    occupancy = solid.occupancy
    label, n = grid.layer_components(occupancy)
    node_of = _renumbered(label, n)
    layer_of = np.empty(n, np.int32)
    x, y, z = np.nonzero(occupancy)
    layer_of[node_of[x, y, z]] = z
    lower, upper = node_of[:, :, :-1], node_of[:, :, 1:]
    touching = (lower >= 0) & (upper >= 0)
    edges = np.unique(np.stack([lower[touching], upper[touching]], axis=1), axis=0)
    return ReebGraph(node_of, layer_of, edges.astype(np.int32))


def _renumbered(label: grid.IntArray, n: int) -> grid.IntArray:
    """Labels 1..n turned into nodes 0..n-1 by layer, then by their first voxel (x, y)."""
    by_layer = label.transpose(2, 0, 1).ravel()
    found, first = np.unique(by_layer, return_index=True)
    first = first[found > 0]
    number = np.full(n + 1, -1, np.int32)
    number[1 + np.argsort(first)] = np.arange(n)
    return number[label]


def traverse(
    graph: ReebGraph,
    walk: tuple[int, ...] | None = None,
    root: int | None = None,
    end: int | None = None,
) -> Traversal:
    """A traversing walk p(G) with its MSP and MSCs (Section 4.3, Figures 8 and 9).

    Parameters
    ----------
    walk : sequence of int, optional
        A walk to split: it visits every node and runs along a spanning tree, along no edge twice
        in the same direction. Without it a depth-first spanning tree from `root`, neighbours in
        ascending order, is walked: the tree path from `root` to `end` is the MSP, and whatever
        hangs off one of its nodes is walked there and back before the walk moves on.
    root, end : int, optional
        Ends of the walk; by default the highest and the lowest node, ties to the smaller number.

    Raises
    ------
    ValueError
        If `root` or `end` is not a node or comes together with `walk`, if the graph is not
        connected, or if `walk` is not such a walk.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> arch = np.ones((3, 1, 2), bool)
    >>> arch[1, 0, 0] = False
    >>> lu.traverse(lu.reeb_graph(lu.VoxelSolid(arch)), root=2, end=0)
    Traversal(walk=(2, 1, 2, 0), msp=(2, 0), mscs=((2, 1, 2),))
    """
    of_kind(graph, ReebGraph)
    if walk is not None:
        if root is not None or end is not None:
            raise ValueError("give either walk or root and end, not both")
        steps = tuple(int(node) for node in walk)
        _check_walk(graph, steps)
        return _split(steps)
    if root is None:
        root = int(np.argmax(graph.layer_of))
    if end is None:
        end = int(np.argmin(graph.layer_of))
    for name, node in (("root", root), ("end", end)):
        if not 0 <= node < len(graph):
            raise ValueError(f"{name} must be a node 0..{len(graph) - 1}, got {node}")
    return _split(_tree_walk(depth_first_tree(graph, root), end))


def depth_first_tree(
    graph: ReebGraph, root: int, rng: np.random.Generator | None = None
) -> grid.IntArray:
    """Parent of each node in a depth-first spanning tree, -1 at `root`: (N,) int32.

    Neighbours are tried in ascending order, or in random order if `rng` is given.

    Raises
    ------
    ValueError
        If some node cannot be reached from `root`.
    """
    near = neighbours(graph)
    if rng is not None:
        near = [[nodes[k] for k in rng.permutation(len(nodes))] for nodes in near]
    parent = np.full(len(graph), -2, np.int32)
    parent[root] = -1
    stack = [(root, iter(near[root]))]
    while stack:
        node, ahead = stack[-1]
        child = next((c for c in ahead if parent[c] == -2), None)
        if child is None:
            stack.pop()
        else:
            parent[child] = node
            stack.append((child, iter(near[child])))
    if (parent == -2).any():
        missed = int((parent == -2).sum())
        raise ValueError(f"{missed} of {len(graph)} nodes cannot be reached from node {root}")
    return parent


def neighbours(graph: ReebGraph) -> list[list[int]]:
    """The nodes joined to each node, in ascending order."""
    near: list[list[int]] = [[] for _ in range(len(graph))]
    for lower, upper in graph.edges.tolist():
        near[lower].append(upper)
        near[upper].append(lower)
    return [sorted(nodes) for nodes in near]


def children(parent: grid.IntArray) -> list[list[int]]:
    """The children of each node of a rooted tree, in ascending order."""
    below: list[list[int]] = [[] for _ in parent]
    for node, above in enumerate(parent.tolist()):
        if above >= 0:
            below[above].append(node)
    return below


def path_to_root(parent: grid.IntArray, node: int) -> list[int]:
    """The tree path from `node` to the root, both included."""
    path = [node]
    while parent[path[-1]] >= 0:
        path.append(int(parent[path[-1]]))
    return path


def _tree_walk(parent: grid.IntArray, end: int) -> tuple[int, ...]:
    """The walk along a rooted tree that leaves the way to `end` for last at every node."""
    below = children(parent)
    on_msp = set(path_to_root(parent, end))
    root = int(np.flatnonzero(parent < 0)[0])
    walk = [root]
    trail = [(root, iter(sorted(below[root], key=on_msp.__contains__)))]
    while trail:
        _, ahead = trail[-1]
        child = next(ahead, None)
        if child is not None:
            walk.append(child)
            trail.append((child, iter(sorted(below[child], key=on_msp.__contains__))))
        elif walk[-1] == end and trail[-1][0] == end:
            break
        else:
            trail.pop()
            walk.append(trail[-1][0])
    return tuple(walk)


def _split(walk: tuple[int, ...]) -> Traversal:
    """Cut a tree walk at the returns to each node of the MSP: one MSC between two returns."""
    last = {node: k for k, node in enumerate(walk)}
    msp: list[int] = []
    mscs: list[tuple[int, ...]] = []
    k = 0
    while k < len(walk):
        node = walk[k]
        msp.append(node)
        while k < last[node]:
            back = walk.index(node, k + 1)
            mscs.append(walk[k : back + 1])
            k = back
        k += 1
    return Traversal(walk, tuple(msp), tuple(mscs))


def _check_walk(graph: ReebGraph, walk: tuple[int, ...]) -> None:
    missed = sorted(set(range(len(graph))) - set(walk))
    if missed:
        raise ValueError(f"the walk misses {len(missed)} of {len(graph)} nodes: {missed[:5]}")
    joined = {(a, b) for a, b in graph.edges.tolist()}
    steps = list(pairwise(walk))
    for a, b in steps:
        if (a, b) not in joined and (b, a) not in joined:
            raise ValueError(f"the walk steps from node {a} to {b}, which no edge joins")
    if len(set(steps)) < len(steps) or len({frozenset(s) for s in steps}) != len(graph) - 1:
        raise ValueError(
            "the walk must run along a spanning tree, along no edge twice in the same direction"
        )
