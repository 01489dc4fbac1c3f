"""A spanning tree with its MSP, and what can be had from everything that hangs off it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import grid, planar
from .shape import Layers

NO_LINKS = np.empty((0, 2), np.int32)


@dataclass(frozen=True, eq=False)
class Plan:
    """A spanning tree with its MSP, and what can be had from everything that hangs off it.

    Attributes
    ----------
    msp : list of int
    hanging : list of list of int
        For each node, the nodes that hang off it: its tree neighbours off the MSP and away
        from it.
    worth : dict
        For each hanging node and each of its blocks that can be entered: the weight that an
        excursion there cannot exceed, with all that hangs off that block.
    doors : dict
        For each hanging node, the links through which the best of those blocks is entered.
    door_blocks : dict
        The blocks that these links lie in, in the node that it hangs off.
    """

    msp: list[int]
    hanging: list[list[int]]
    worth: dict[int, dict[int, float]]
    doors: dict[int, grid.IntArray]
    door_blocks: dict[int, list[int]]

    def value(self, node: int) -> float:
        """The greatest weight that an excursion to `node` may bring."""
        return max(self.worth[node].values(), default=0.0)


def plan(shape: Layers, tree: list[list[int]], msp: list[int]) -> Plan:
    """Hang everything off the MSP: `tree` lists the tree neighbours of each node."""
    hanging: list[list[int]] = [[] for _ in tree]
    order, reached, above = list(msp), set(msp), {}
    for node in order:
        hanging[node] = [other for other in tree[node] if other not in reached]
        reached.update(hanging[node])
        order.extend(hanging[node])
        above.update(dict.fromkeys(hanging[node], node))
    out = Plan(msp, hanging, {}, {}, {})
    for node in order[:0:-1]:
        if node in above:
            _rate(shape, out, node, above[node])
    return out


def _rate(shape: Layers, plan: Plan, node: int, above: int) -> None:
    """Fill in what a node is worth, once that is known of the nodes that hang off it."""
    entries = shape.entries[node, above]
    worth = {b: shape.regions[node].limit[b][planar.DIFFERENT][1] for b in entries}
    for child in plan.hanging[node]:
        for b in plan.door_blocks[child]:
            if b in worth:
                worth[b] += plan.value(child)
    best = max(worth.values(), default=0.0)
    doors = [entries[b] for b in entries if worth[b] == best]
    plan.worth[node] = worth
    plan.doors[node] = np.concatenate([NO_LINKS, *(links for links, _ in doors)])
    plan.door_blocks[node] = sorted({b for _, behind in doors for b in behind})
