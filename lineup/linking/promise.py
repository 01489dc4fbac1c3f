"""Which spanning tree and which MSP: a search over plans by what they can lead to.

A node off the MSP is left beside where it was entered, so all but one of its blocks are lost; and
nodes that share no two adjacent cells can be linked on the MSP only. `Prospects.best` knows this,
and is cheap next to carrying a plan out: so plans are changed a little at a time as long as they
get no worse.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..reeb import depth_first_tree
from .msp import Places, Prospects, prospects
from .rating import Plan, plan
from .shape import Layers

N_DRAWN = 30
"""Plans drawn at random for each start."""

N_CHANGES = 90
"""Changes tried to each plan."""

Tree = list[list[int]]
"""The tree neighbours of each node, ascending."""


def promising_plan(
    shape: Layers, k: int, both_ends_on_top: bool, rng: np.random.Generator
) -> tuple[Plan, Prospects]:
    """The k-th plan tried and its prospects."""
    places = Places(shape, rng)
    top = _high_node(shape, k)
    fixed = both_ends_on_top and shape.size(top) > 1
    drafts = _Drafts(shape, places)
    drawn = []
    for j in range(N_DRAWN):
        tree = _spanning_tree(shape, k + j, rng)
        ends = (top, top) if fixed else _random_ends(shape, rng)
        drawn.append(drafts.of(tree, ends))
    best = max(drawn, key=lambda draft: draft.best)
    for _ in range(N_CHANGES):
        if fixed or rng.random() < 0.5:
            changed = drafts.of(_exchanged(shape, best.tree, rng), best.ends)
        else:
            changed = drafts.of(best.tree, _moved(shape, best.tree, best.ends, rng))
        if changed.best >= best.best:
            best = changed
    return best.plan, best.prospects


@dataclass(frozen=True, eq=False)
class _Draft:
    tree: Tree
    ends: tuple[int, int]
    plan: Plan
    prospects: Prospects
    best: float


@dataclass(frozen=True, eq=False)
class _Drafts:
    """Each draft is worked out once: few are possible where nodes are few, and they come again."""

    shape: Layers
    places: Places
    _made: dict[tuple[tuple[tuple[int, ...], ...], tuple[int, int]], _Draft] = field(
        default_factory=dict
    )

    def of(self, tree: Tree, ends: tuple[int, int]) -> _Draft:
        key = tuple(map(tuple, tree)), ends
        if key not in self._made:
            rooted = plan(self.shape, tree, _even(self.shape, _way(tree, *ends)))
            ahead = prospects(rooted, self.places)
            self._made[key] = _Draft(tree, ends, rooted, ahead, ahead.best())
        return self._made[key]


def _random_ends(shape: Layers, rng: np.random.Generator) -> tuple[int, int]:
    """Two nodes, different if there are two, so that the path has two voxels at least."""
    n = len(shape.graph)
    first = int(rng.integers(n))
    return first, (first + int(rng.integers(1, n))) % n if n > 1 else first


def _moved(
    shape: Layers, tree: Tree, ends: tuple[int, int], rng: np.random.Generator
) -> tuple[int, int]:
    """The ends with one of them at another node, every other time a neighbour."""
    kept, moved = ends if rng.random() < 0.5 else ends[::-1]
    if rng.random() < 0.5 and tree[moved]:
        new = tree[moved][int(rng.integers(len(tree[moved])))]
    else:
        new = int(rng.integers(len(tree)))
    if new == kept and shape.size(new) == 1:
        return ends
    return kept, new


def _exchanged(shape: Layers, tree: Tree, rng: np.random.Generator) -> Tree:
    """The tree with one of its edges exchanged for another edge of the graph."""
    others = [(a, b) for a, b in shape.graph.edges.tolist() if b not in tree[a]]
    if not others:
        return tree
    a, b = others[int(rng.integers(len(others)))]
    cycle = _way(tree, a, b)
    k = int(rng.integers(len(cycle) - 1))
    edges = {(n, m) for n, near in enumerate(tree) for m in near if n < m}
    edges.remove((min(cycle[k : k + 2]), max(cycle[k : k + 2])))
    edges.add((a, b))
    return _near(len(tree), sorted(edges))


def _near(n: int, edges: list[tuple[int, int]]) -> Tree:
    near: Tree = [[] for _ in range(n)]
    for a, b in edges:
        near[a].append(b)
        near[b].append(a)
    return [sorted(nodes) for nodes in near]


def _way(tree: Tree, first: int, last: int) -> list[int]:
    """The nodes of the tree path between two nodes."""
    back = {first: first}
    queue = [first]
    for node in queue:
        if node == last:
            break
        for other in tree[node]:
            if other not in back:
                back[other] = node
                queue.append(other)
    way = [last]
    while way[-1] != first:
        way.append(back[way[-1]])
    return way[::-1]


def _even(shape: Layers, msp: list[int]) -> list[int]:
    """The MSP without its last node if both ends are one voxel, of the same colour."""
    first, last = (int(shape.regions[node].cells[0]) for node in (msp[0], msp[-1]))
    stuck = shape.size(msp[0]) == shape.size(msp[-1]) == 1 and shape.voxel_colour(
        msp[0], first
    ) == shape.voxel_colour(msp[-1], last)
    return _even(shape, msp[:-1]) if stuck else msp


def _spanning_tree(shape: Layers, k: int, rng: np.random.Generator) -> Tree:
    """Tree neighbours of each node in the k-th spanning tree tried.

    In turn a tree of the widest overlaps (the first one strictly, then with random factors) and
    a random depth-first tree: neither kind is always better.
    """
    if k % 2:
        parent = depth_first_tree(shape.graph, int(rng.integers(len(shape.graph))), rng)
        edges = [(node, above) for node, above in enumerate(parent.tolist()) if above >= 0]
    else:
        edges = _widest_tree(shape, 0.0 if k == 0 else 0.5, rng)
    return _near(len(shape.graph), edges)


def _widest_tree(shape: Layers, spread: float, rng: np.random.Generator) -> list[tuple[int, int]]:
    """Maximum spanning tree by adjacent overlap cells, times 1 - spread .. 1 + spread (Kruskal)."""
    edges = [(a, b) for a, b in shape.graph.edges.tolist()]
    width = np.array([len(shape.shared[edge]) for edge in edges]) + 0.5
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


def _high_node(shape: Layers, k: int) -> int:
    """The k-th node of two voxels or more from the top, the larger first; cyclic."""
    layer_of = shape.graph.layer_of
    order = sorted(
        range(len(layer_of)), key=lambda node: (-layer_of[node], -shape.size(node), node)
    )
    fit = [node for node in order if shape.size(node) > 1] or order[:1]
    return fit[(k // 2) % min(len(fit), 3)]
