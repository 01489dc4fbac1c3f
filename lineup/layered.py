"""Layered paths through a solid (Section 4): the best of several spanning trees and MSPs.

The paper takes one depth-first tree. Which cells can be linked depends on the tree and on its
MSP, by tens of percent where the solid has handles, so several of both are tried.
"""

from __future__ import annotations

from collections.abc import Callable
from inspect import Parameter, signature
from typing import Any

import numpy as np

from . import grid
from .linking import Effort, Layers, assembled, layers, linked, plan
from .reeb import depth_first_tree
from .solid import VoxelPath, VoxelSolid


def layered_path(
    solid: VoxelSolid, method: str = "layered", seed: int = 0, **options: Any
) -> VoxelPath:
    """A long simple path that visits the solid layer by layer (Section 4, Algorithm 3).

    Parameters
    ----------
    method : str
        A key of `PATH_METHODS`.
    seed : int
        The same solid, seed and options give the same path.
    options
        Keyword options of the method. Those of ``"layered"``: `starts` (8), spanning trees and
        MSPs tried; `sweeps` (100), length of each planar search, see `planar.long_path`;
        `both_ends_on_top` (False), put both ends in one node, as high up as can be.

    Returns
    -------
    VoxelPath
        Even and of at least two voxels; `dropped` holds the voxels that could not be linked.

    Raises
    ------
    ValueError
        If the method or an option is unknown or out of range, or the solid is one voxel.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> path = lu.layered_path(lu.VoxelSolid(np.ones((4, 3, 2), bool)))
    >>> len(path), path.visits[:, 2:].tolist()
    (24, [[1, 0], [0, 0]])
    """
    if method not in PATH_METHODS:
        raise ValueError(f"unknown path method {method!r}; known: {sorted(PATH_METHODS)}")
    parameters = signature(PATH_METHODS[method]).parameters.values()
    known = sorted(p.name for p in parameters if p.kind is Parameter.KEYWORD_ONLY)
    unknown = sorted(set(options) - set(known))
    if unknown:
        raise ValueError(f"method {method!r} has no option {unknown[0]!r}; known: {known}")
    if solid.size < 2:
        raise ValueError("a path needs at least two voxels, the solid has 1")
    return PATH_METHODS[method](solid, seed, **options)


def layered_paths(
    solid: VoxelSolid,
    seed: int = 0,
    *,
    starts: int = 8,
    sweeps: int = 100,
    both_ends_on_top: bool = False,
) -> list[VoxelPath]:
    """One layered path for each start, the longest first: varied starts for the planners.

    Takes the options of `layered_path` with ``method="layered"`` and raises as it does.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup.layered import layered_paths
    >>> [len(p) for p in layered_paths(lu.VoxelSolid(np.ones((4, 3, 2), bool)), starts=2)]
    [24, 24]
    """
    for name, value in (("starts", starts), ("sweeps", sweeps)):
        if value < 1:
            raise ValueError(f"{name} must be at least 1, got {value}")
    if solid.size < 2:
        raise ValueError("a path needs at least two voxels, the solid has 1")
    shape = layers(solid)
    effort = Effort(sweeps=sweeps)
    paths = []
    for k in range(starts):
        rng = np.random.default_rng([seed, k])
        tree = _spanning_tree(shape, k, rng)
        msp = [_high_node(shape, k)] if both_ends_on_top else []
        if not msp or shape.size(msp[0]) < 2:
            msp = _long_msp(shape, tree, rng)
        parts = linked(shape, plan(shape, tree, msp), effort, rng)
        paths.append(assembled(shape, parts, "layered"))
    return sorted(paths, key=len, reverse=True)


def _layered(
    solid: VoxelSolid,
    seed: int,
    *,
    starts: int = 8,
    sweeps: int = 100,
    both_ends_on_top: bool = False,
) -> VoxelPath:
    return layered_paths(
        solid, seed, starts=starts, sweeps=sweeps, both_ends_on_top=both_ends_on_top
    )[0]


PATH_METHODS: dict[str, Callable[..., VoxelPath]] = {"layered": _layered}
"""The path methods by name: functions of a solid, a seed and keyword-only options."""


def _spanning_tree(shape: Layers, k: int, rng: np.random.Generator) -> list[list[int]]:
    """Tree neighbours of each node in the k-th spanning tree tried.

    In turn a tree of the widest overlaps (the first one strictly, then with random factors) and
    a random depth-first tree: neither kind is always better.
    """
    if k % 2:
        parent = depth_first_tree(shape.graph, int(rng.integers(len(shape.graph))), rng)
        edges = [(node, above) for node, above in enumerate(parent.tolist()) if above >= 0]
    else:
        edges = _widest_tree(shape, 0.0 if k == 0 else 0.5, rng)
    near: list[list[int]] = [[] for _ in range(len(shape.graph))]
    for a, b in edges:
        near[a].append(b)
        near[b].append(a)
    return [sorted(nodes) for nodes in near]


def _widest_tree(shape: Layers, spread: float, rng: np.random.Generator) -> list[tuple[int, int]]:
    """Maximum spanning tree by adjacent overlap cells, times 1 - spread .. 1 + spread (Kruskal)."""
    edges = sorted(shape.n_pairs)
    width = np.array([shape.n_pairs[edge] for edge in edges]) + 0.5
    width = width * rng.uniform(1 - spread, 1 + spread, len(edges))
    top = list(range(len(shape.graph)))
    kept = []
    for k in np.argsort(-width, kind="stable"):
        ends = [_top(top, node) for node in edges[k]]
        if ends[0] != ends[1]:
            top[ends[0]] = ends[1]
            kept.append(edges[k])
    return kept


def _top(top: list[int], node: int) -> int:
    while top[node] != node:
        top[node] = top[top[node]]
        node = top[node]
    return node


def _long_msp(shape: Layers, tree: list[list[int]], rng: np.random.Generator) -> list[int]:
    """A tree path that is worth being the MSP, top end first.

    A node off the MSP must be left where it was entered, which costs the cells in no 2 x 2
    block; and an edge without two adjacent overlap cells can be used on the MSP only, so going
    along it gains all that lies beyond. The heaviest path for these worths, times random factors,
    is found by two sweeps, as for the longest path in a tree.
    """
    cluster = _clusters(shape, tree)
    size = np.array([shape.size(node) for node in range(len(tree))])
    beyond: grid.FloatArray = 10.0 * np.bincount(cluster, size)[cluster]
    narrow = np.array([_n_narrow(shape, node) for node in range(len(tree))])
    factor = rng.uniform(0.3, 1.7, len(tree))
    worth = np.asarray((1 + narrow + 0.05 * size) * factor, np.float64)
    first = _heaviest_way(tree, int(rng.integers(len(tree))), worth, cluster, beyond)[-1]
    msp = _heaviest_way(tree, first, worth, cluster, beyond)
    layer_of = shape.graph.layer_of
    return msp if layer_of[msp[0]] >= layer_of[msp[-1]] else msp[::-1]


def _clusters(shape: Layers, tree: list[list[int]]) -> grid.IntArray:
    """Number nodes alike that tree edges with adjacent overlap cells join."""
    cluster = np.full(len(tree), -1, np.int32)
    for number, first in enumerate(range(len(tree))):
        if cluster[first] >= 0:
            continue
        cluster[first] = number
        queue = [first]
        for node in queue:
            for other in tree[node]:
                joined = shape.n_pairs[min(node, other), max(node, other)] > 0
                if joined and cluster[other] < 0:
                    cluster[other] = number
                    queue.append(other)
    return cluster


def _n_narrow(shape: Layers, node: int) -> int:
    """Number of a node's cells that lie in no 2 x 2 block of the node."""
    region = shape.regions[node]
    wide = np.zeros(region.inside.size, bool)
    for offset in (0, 1, region.width, region.width + 1):
        wide[region.squares + offset] = True
    return len(region.cells) - int(wide.sum())


def _heaviest_way(
    tree: list[list[int]],
    first: int,
    worth: grid.FloatArray,
    cluster: grid.IntArray,
    beyond: grid.FloatArray,
) -> list[int]:
    """The heaviest tree path from `first`, which comes first."""
    total = np.full(len(tree), -1.0)
    total[first] = worth[first]
    back = {first: first}
    queue = [first]
    for node in queue:
        for other in tree[node]:
            if other not in back:
                back[other] = node
                gain = beyond[other] if cluster[other] != cluster[node] else 0.0
                total[other] = total[node] + worth[other] + gain
                queue.append(other)
    way = [int(total.argmax())]
    while way[-1] != first:
        way.append(back[way[-1]])
    return way[::-1]


def _high_node(shape: Layers, k: int) -> int:
    """The k-th node of two voxels or more from the top, the larger first; cyclic."""
    layer_of = shape.graph.layer_of
    order = sorted(
        range(len(layer_of)), key=lambda node: (-layer_of[node], -shape.size(node), node)
    )
    fit = [node for node in order if shape.size(node) > 1] or order[:1]
    return fit[(k // 2) % min(len(fit), 3)]
