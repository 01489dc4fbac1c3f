"""Planar paths of all nodes linked into one layered path along a spanning tree (Algorithm 3).

Each node is visited once, by one planar path. The nodes of the MSP follow each other by vertical
links (Section 4.2, Case 1); a node that hangs off another one is an excursion from one link of
that node's planar path, by two vertical links side by side (Case 2). The work goes from the MSP
outwards: a node's path is asked to have, for each node that hangs off it, a link above or below
that node's cells.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from . import grid, planar
from .reeb import ReebGraph, reeb_graph
from .solid import VoxelPath, VoxelSolid

SURFACE_WEIGHT = 2.0
"""Worth of a surface voxel, an interior one being 1: the surface carries the appearance."""


@dataclass(frozen=True, eq=False)
class Layers:
    """A solid as planar regions, one for each node, on one flat numbering of cells.

    Attributes
    ----------
    solid : VoxelSolid
    graph : ReebGraph
    width : int
        Cell of voxel (x, y, z): ``(x + 1) * width + y + 1``.
    regions : list of Region
    n_pairs : dict
        For each edge (a, b), a < b: pairs of adjacent cells that both nodes have. Without one
        the nodes can be linked on the MSP only.
    """

    solid: VoxelSolid
    graph: ReebGraph
    width: int
    regions: list[planar.Region]
    n_pairs: dict[tuple[int, int], int]

    def size(self, node: int) -> int:
        """Number of voxels of a node."""
        return len(self.regions[node].cells)

    def overlap(self, a: int, b: int) -> grid.BoolArray:
        """The cells that both nodes have, (N,) bool."""
        return self.regions[a].inside & self.regions[b].inside


def layers(solid: VoxelSolid) -> Layers:
    """Cut a solid into the planar regions of its nodes."""
    graph = reeb_graph(solid)
    node_of = np.pad(graph.node_of, ((1, 1), (1, 1), (0, 0)), constant_values=-1)
    worth = 1.0 + (SURFACE_WEIGHT - 1.0) * np.pad(
        grid.surface(solid.occupancy), ((1, 1), (1, 1), (0, 0))
    )
    planes = [np.ascontiguousarray(node_of[:, :, z]).ravel() for z in range(node_of.shape[2])]
    weights = [np.ascontiguousarray(worth[:, :, z]).ravel() for z in range(node_of.shape[2])]
    width = node_of.shape[1]
    regions = [
        planar.region(planes[z] == node, weights[z], width)
        for node, z in enumerate(graph.layer_of.tolist())
    ]
    n_pairs = {}
    for a, b in graph.edges.tolist():
        both = regions[a].inside & regions[b].inside
        n_pairs[a, b] = sum(int((both[:-s] & both[s:]).sum()) for s in (1, width))
    return Layers(solid, graph, width, regions, n_pairs)


@dataclass(frozen=True)
class Effort:
    """How hard the planar searches try.

    Attributes
    ----------
    restarts, sweeps : int
        Of each planar search, see `planar.long_path`.
    tries : int
        Ends tried for each planar path.
    """

    restarts: int = 2
    sweeps: int = 100
    tries: int = 4


@dataclass(frozen=True, eq=False)
class Plan:
    """A spanning tree with its MSP.

    Attributes
    ----------
    msp : list of int
    hanging : list of list of int
        For each node, the nodes that hang off it: its tree neighbours off the MSP and away
        from it.
    weight : (N,) float64
        Weight of the cells of each node and of everything that hangs off it.
    """

    msp: list[int]
    hanging: list[list[int]]
    weight: grid.FloatArray


def plan(shape: Layers, tree: list[list[int]], msp: list[int]) -> Plan:
    """Hang everything off the MSP: `tree` lists the tree neighbours of each node."""
    hanging: list[list[int]] = [[] for _ in tree]
    order, reached = list(msp), set(msp)
    for node in order:
        hanging[node] = [other for other in tree[node] if other not in reached]
        reached.update(hanging[node])
        order.extend(hanging[node])
    weight = np.array([r.weight[r.cells].sum() for r in shape.regions])
    for node in reversed(order):
        weight[node] += sum(weight[child] for child in hanging[node])
    return Plan(msp, hanging, weight)


@dataclass(eq=False)
class Linked:
    """Planar paths and how they are linked, while they are being built.

    Attributes
    ----------
    msp : list of int
    paths : dict
        The cells of each linked node's planar path, in order.
    excursions : dict
        For each linked node, the nodes that leave from its path: step k -> node, from the link
        between cells k and k + 1.
    """

    msp: list[int]
    paths: dict[int, grid.IntArray] = field(default_factory=dict)
    excursions: dict[int, dict[int, int]] = field(default_factory=dict)


def linked(shape: Layers, plan: Plan, effort: Effort, rng: np.random.Generator) -> Linked:
    """Planar paths for the MSP, then for everything that hangs off it and can be linked."""
    colours = None
    msp = list(plan.msp)
    while colours is None:
        # Only the total must be even (a block has two voxels), not every layer as in Theorem 4.2.
        colours = _link_colours(shape, msp)
        if colours is None:
            msp.pop()
    out = Linked(msp)
    start = -1
    for k, node in enumerate(msp):
        following = msp[k + 1] if k + 1 < len(msp) else node
        starts = _coloured(shape, node, node, colours[k]) if k == 0 else np.array([start])
        ends = _coloured(shape, node, following, colours[k + 1])
        pairs = _end_pairs(starts, ends, effort.tries, rng)
        out.paths[node] = _best_path(shape, plan, node, pairs, effort, rng)
        start = int(out.paths[node][-1])
    queue = list(msp)
    for node in queue:
        queue.extend(_link_hanging(shape, plan, out, node, effort, rng))
    return out


def _link_colours(shape: Layers, msp: list[int]) -> list[int] | None:
    """Colours of the first voxel, of each vertical link and of the last voxel of the MSP.

    Dynamic programming over (colour, parity of the voxels so far) for the greatest sum of the
    planar limits with an even total. None if the total cannot be even: both ends are in nodes
    of one voxel.
    """
    best: dict[tuple[int, int], tuple[int, list[int]]] = {
        (c, 0): (0, [c]) for c in (0, 1) if len(_coloured(shape, msp[0], msp[0], c))
    }
    for node, following in zip(msp, [*msp[1:], msp[-1]], strict=True):
        extended: dict[tuple[int, int], tuple[int, list[int]]] = {}
        for (c, parity), (total, chosen) in best.items():
            for d in (0, 1):
                if not len(_coloured(shape, node, following, d)):
                    continue
                length, _ = planar.path_limit(shape.regions[node], c, d)
                state = d, (parity + length) % 2
                if state not in extended or extended[state][0] < total + length:
                    extended[state] = total + length, [*chosen, d]
        best = extended
    even = [value for (_, parity), value in sorted(best.items()) if parity == 0]
    return max(even, key=lambda value: value[0])[1] if even else None


def _coloured(shape: Layers, node: int, other: int, colour: int) -> grid.IntArray:
    """The cells of one colour that both nodes have."""
    cells = np.flatnonzero(shape.overlap(node, other)).astype(np.int32)
    kept: grid.IntArray = cells[(cells // shape.width + cells % shape.width) % 2 == colour]
    return kept


def _end_pairs(
    starts: grid.IntArray, ends: grid.IntArray, n: int, rng: np.random.Generator
) -> list[tuple[int, int]]:
    """Up to n random pairs of different cells; a pair of one cell if there is no other."""
    pairs = {
        (int(s), int(e))
        for s, e in zip(rng.choice(starts, 4 * n), rng.choice(ends, 4 * n), strict=True)
        if s != e
    }
    if not pairs:
        others = [(int(s), int(e)) for s in starts for e in ends if s != e]
        pairs = set(others) or {(int(starts[0]), int(starts[0]))}
    found = sorted(pairs)
    return [found[k] for k in rng.permutation(len(found))[:n]]


def _best_path(
    shape: Layers,
    plan: Plan,
    node: int,
    pairs: list[tuple[int, int]],
    effort: Effort,
    rng: np.random.Generator,
) -> grid.IntArray:
    """The best planar path of a node over the given pairs of ends."""
    region = shape.regions[node]
    wanted = _wishes(shape, plan, node)
    best, best_score = np.empty(0, np.int32), -np.inf
    for start, end in pairs:
        path, score = planar.long_path(
            region, start, end, wanted, effort.restarts, effort.sweeps, rng
        )
        if score > best_score:
            best, best_score = path, score
        _, limit = planar.path_limit(region, region.colour(start), region.colour(end))
        if score >= limit + wanted.bonus.sum() - 1e-9:
            break
    return best


def _wishes(shape: Layers, plan: Plan, node: int) -> planar.Wishes:
    """A link for each node that hangs off this one, worth more than that node could lose."""
    layer_of = shape.graph.layer_of
    hanging = plan.hanging[node]
    return planar.wishes(
        [(int(layer_of[child] > layer_of[node]), shape.overlap(node, child)) for child in hanging],
        [float(plan.weight[child]) + 10.0 for child in hanging],
        shape.width,
        shape.regions[node].inside.size,
    )


def _link_hanging(
    shape: Layers,
    plan: Plan,
    out: Linked,
    node: int,
    effort: Effort,
    rng: np.random.Generator,
) -> list[int]:
    """Link what hangs off a node to links of its path; the nodes that found one."""
    path = out.paths[node]
    order = sorted(plan.hanging[node], key=lambda child: (-plan.weight[child], child))
    candidates = {}
    for child in order:
        inside = shape.regions[child].inside[path]
        candidates[child] = np.flatnonzero(inside[:-1] & inside[1:]).tolist()
    step_of = _matching(order, candidates)
    taken = set(step_of.values())
    out.excursions[node] = {}
    for child in (c for c in order if c in step_of):
        others = [k for k in candidates[child] if k not in taken]
        shuffled = [others[k] for k in rng.permutation(len(others))[: effort.tries - 1]]
        steps = [step_of[child], *shuffled]
        pairs = [(int(path[k]), int(path[k + 1])) for k in steps]
        out.paths[child] = _best_path(shape, plan, child, pairs, effort, rng)
        step = steps[pairs.index((int(out.paths[child][0]), int(out.paths[child][-1])))]
        taken.add(step)
        if step != step_of[child]:
            taken.discard(step_of[child])
        out.excursions[node][step] = child
    return list(out.excursions[node].values())


def _matching(order: list[int], candidates: dict[int, list[int]]) -> dict[int, int]:
    """A link for as many as possible, earlier ones first: augmenting paths in the given order.

    What is once matched stays matched, so the greedy order gives the greatest total weight.
    """
    owner: dict[int, int] = {}
    for child in order:
        came_from: dict[int, int] = {}
        queue, free = [child], None
        for wanting in queue:
            for step in candidates[wanting]:
                if step in came_from:
                    continue
                came_from[step] = wanting
                if step not in owner:
                    free = step
                    break
                queue.append(owner[step])
            if free is not None:
                break
        step_of = {c: s for s, c in owner.items()}
        while free is not None:
            wanting = came_from[free]
            owner[free] = wanting
            free = step_of.get(wanting)
    return {child: step for step, child in owner.items()}


def assembled(shape: Layers, parts: Linked, method: str) -> VoxelPath:
    """The path that runs through the linked planar paths, excursions inserted."""
    pieces, visits, n = [], [], 0
    for node, first, last, depth in _runs(parts):
        cells = parts.paths[node][first:last]
        z = np.full(len(cells), shape.graph.layer_of[node])
        pieces.append(
            np.stack([cells // shape.width - 1, cells % shape.width - 1, z], axis=1).astype(
                np.int32
            )
        )
        visits.append((n, n + len(cells), node, depth))
        n += len(cells)
    voxels = np.concatenate(pieces)
    left = shape.solid.occupancy.copy()
    left[tuple(voxels.T)] = False
    return VoxelPath(
        voxels, np.array(visits, np.int32), np.argwhere(left).astype(np.int32), method=method
    )


def _runs(parts: Linked) -> Iterator[tuple[int, int, int, int]]:
    """(node, first, last + 1, depth) of each run of planar steps, in the order of the path."""
    stack = [(node, 0, 0) for node in reversed(parts.msp)]
    while stack:
        node, first, depth = stack.pop()
        leaving = [k for k in parts.excursions.get(node, {}) if k >= first]
        if not leaving:
            yield node, first, len(parts.paths[node]), depth
            continue
        step = min(leaving)
        yield node, first, step + 1, depth
        stack.append((node, step + 1, depth))
        stack.append((parts.excursions[node][step], 0, depth + 1))
