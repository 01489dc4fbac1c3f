"""Planar paths of all nodes linked into one layered path along a spanning tree (Algorithm 3).

Each node is visited once, by one planar path. The nodes of the MSP follow each other by vertical
links (Section 4.2, Case 1); a node that hangs off another one is an excursion from one link of
that node's planar path, by two vertical links side by side (Case 2). The work goes from the MSP
outwards: a node's path is asked to have, for each node that hangs off it, a link through which
the best of that node can be entered.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from .. import grid, planar
from ..solid import VoxelPath
from .msp import Ends, Prospects
from .rating import Plan
from .shape import Layers

LARGE = 4000
"""Cells of a region from which on one search is enough."""


@dataclass(frozen=True)
class Effort:
    """How hard the planar searches try.

    Attributes
    ----------
    restarts, sweeps : int
        Of each planar search, see `planar.long_path`.
    tries : int
        Pairs of ends searched for each planar path at most.
    """

    restarts: int = 4
    sweeps: int = 100
    tries: int = 4

    def on(self, n_cells: int) -> Effort:
        """The effort on one region: chance evens out over a large one, and is tried less often."""
        most = max(1, LARGE // n_cells)
        return replace(self, restarts=min(self.restarts, most), tries=min(self.tries, most))


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


def linked(
    shape: Layers, plan: Plan, ahead: Prospects, effort: Effort, rng: np.random.Generator
) -> Linked:
    """Planar paths for the MSP, then for everything that hangs off it and can be linked."""
    out = Linked(plan.msp)
    beginnings = ahead.beginnings()
    last_colour = beginnings[0][0]
    ends = [ends for colour, ends in beginnings if colour == last_colour]
    for k, node in enumerate(plan.msp):
        out.paths[node] = _best_path(shape, plan, node, ends, effort, rng)
        if k + 1 < len(plan.msp):
            ends = ahead.continuations(k + 1, int(out.paths[node][-1]), last_colour)
    queue = list(plan.msp)
    for node in queue:
        queue.extend(_link_hanging(shape, plan, out, node, effort, rng))
    return out


def _best_path(
    shape: Layers,
    plan: Plan,
    node: int,
    ends: list[Ends],
    effort: Effort,
    rng: np.random.Generator,
) -> grid.IntArray:
    """The best planar path of a node over some ends, with what these can lead to."""
    wishes = _wishes(shape, plan, node)
    effort = effort.on(shape.size(node))
    best, best_total = np.empty(0, np.int32), -np.inf
    for first, last, following, _ in ends[: effort.tries]:
        path, score, limit = planar.long_path(
            shape.regions[node], first, last, wishes, effort.restarts, effort.sweeps, rng
        )
        if score + following > best_total:
            best, best_total = path, score + following
        if score >= limit - 1e-9:
            break
    return best


def _wishes(shape: Layers, plan: Plan, node: int) -> planar.Wishes:
    """A door for each node that hangs off this one, for the weight that lies beyond it."""
    layer_of = shape.graph.layer_of
    hanging = [child for child in plan.hanging[node] if len(plan.doors[child])]
    return planar.Wishes(
        [plan.doors[child] for child in hanging],
        [int(layer_of[child] > layer_of[node]) for child in hanging],
        np.array([plan.value(child) for child in hanging]),
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
    order = sorted(plan.hanging[node], key=lambda child: (-plan.value(child), child))
    candidates = {child: _steps(shape, plan, child, path, rng) for child in order}
    step_of = _matching(order, candidates)
    taken = set(step_of.values())
    out.excursions[node] = {}
    for child in (c for c in order if c in step_of):
        free = [k for k in candidates[child] if k == step_of[child] or k not in taken]
        ends = [Ends(int(path[k]), int(path[k + 1]), 0.0, 0.0) for k in free]
        out.paths[child] = _best_path(shape, plan, child, ends, effort, rng)
        step = int(np.flatnonzero(path == out.paths[child][0])[0])
        taken.discard(step_of[child])
        taken.add(step)
        out.excursions[node][step] = child
    return list(out.excursions[node].values())


def _steps(
    shape: Layers, plan: Plan, child: int, path: grid.IntArray, rng: np.random.Generator
) -> list[int]:
    """Steps k of a path from which an excursion to `child` can leave, the most promising first.

    Steps alike come in random order.
    """
    region = shape.regions[child]
    step = np.flatnonzero(region.inside[path[:-1]] & region.inside[path[1:]])
    step = rng.permutation(step)
    block = region.block_of(path[step], path[step + 1])
    worth = np.array([plan.worth[child][b] for b in block.tolist()])
    return [int(k) for k in step[np.argsort(-worth, kind="stable")]]


def _matching(order: list[int], candidates: dict[int, list[int]]) -> dict[int, int]:
    """A step for as many as possible, earlier ones first: augmenting paths in the given order.

    Whoever is matched stays matched, so the greedy order gives the greatest total value.
    """
    owner: dict[int, int] = {}
    for child in order:
        step_of = {c: step for step, c in owner.items()}
        wanting_of: dict[int, int] = {}
        free = _free_step(child, candidates, owner, wanting_of)
        while free is not None:
            wanting = wanting_of[free]
            owner[free] = wanting
            free = step_of.get(wanting)
    return {child: step for step, child in owner.items()}


def _free_step(
    child: int,
    candidates: dict[int, list[int]],
    owner: dict[int, int],
    wanting_of: dict[int, int],
) -> int | None:
    """A step without owner that `child` can get if others move on; `wanting_of` says who moves."""
    queue = [child]
    for wanting in queue:
        for step in candidates[wanting]:
            if step not in wanting_of:
                wanting_of[step] = wanting
                if step not in owner:
                    return step
                queue.append(owner[step])
    return None


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
