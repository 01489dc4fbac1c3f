"""Where the MSP begins, passes from layer to layer and ends (Section 4.3.1).

The paper picks these voxels at random, of different colours in every layer. Only the whole path
must be even, since a block has two voxels; and a voxel behind a one-cell neck may cost most of a
layer. So a few candidates for each place are rated by what the layers can cover between them,
and dynamic programming along the MSP adds that up.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np

from .. import grid, planar
from .rating import Plan
from .shape import Layers


class Ends(NamedTuple):
    """Two ends of a planar path; the most that the nodes after it can add, and it with them."""

    first: int
    last: int
    following: float
    total: float


Span = tuple[grid.FloatArray, grid.BoolArray]

N_ALIKE = 3
"""Candidates kept of those in the same blocks and of the same colour."""

N_PLACES = 8
"""Candidates kept for each place and colour."""


@dataclass(frozen=True, eq=False)
class Prospects:
    """Candidates for the ends of the planar paths along the MSP, and what they can lead to.

    Attributes
    ----------
    places : list of list of int
        Cells where the MSP may begin, pass from each node to the next one, and end.
    value : list of arrays
        ``value[k][i, j]`` is the most that node k of the MSP can cover, with all that hangs off
        it, between the i-th of its first and the j-th of its last places.
    to_come : pair of lists of arrays
        ``to_come[c][k][i]`` is the most that nodes k, k + 1, ... can cover if the path enters
        node k at its i-th place and ends in a voxel of colour c; -inf if it cannot.
    colour : list of int
        Voxel colour of each place to begin at.
    """

    places: list[list[int]]
    value: list[grid.FloatArray]
    to_come: tuple[list[grid.FloatArray], list[grid.FloatArray]]
    colour: list[int]

    def best(self) -> float:
        """The most that an even path can cover by these ratings: its ends differ in colour."""
        return max(float(self.to_come[1 - c][0][i]) for i, c in enumerate(self.colour))

    def beginnings(self) -> list[tuple[int, Ends]]:
        """(Colour of the path's last voxel, ends) for the first node, the most promising first."""
        rows = [
            (1 - colour, ends)
            for first, colour in zip(self.places[0], self.colour, strict=True)
            for ends in self.continuations(0, first, 1 - colour)
        ]
        return sorted(rows, key=lambda row: -row[1].total)

    def continuations(self, k: int, first: int, last_colour: int) -> list[Ends]:
        """Ends for node k of the MSP entered at `first`, the most promising first."""
        following = self.to_come[last_colour][k + 1]
        total = self.value[k][self.places[k].index(first)] + following
        return [
            Ends(first, self.places[k + 1][j], float(following[j]), float(total[j]))
            for j in np.argsort(-total, kind="stable")
            if np.isfinite(total[j])
        ]


@dataclass(frozen=True, eq=False)
class Places:
    """The candidate cells of a solid and what lies between them, worked out when first asked.

    Drawn once, so that many plans for one solid are rated by the same cells.
    """

    shape: Layers
    rng: np.random.Generator
    _cells: dict[tuple[int, int], list[int]] = field(default_factory=dict)
    _spans: dict[tuple[int, int, int], Span] = field(default_factory=dict)

    def cells(self, a: int, b: int) -> list[int]:
        """A few cells that both nodes have, in different blocks and of both colours if any."""
        key = min(a, b), max(a, b)
        if key not in self._cells:
            self._cells[key] = _sample(self.shape, *key, self.rng)
        return self._cells[key]

    def span(self, before: int, node: int, after: int) -> Span:
        """What a node's path can cover between the places shared with two other nodes.

        (p, q) weights, and (p, q, B) whether each block is visited.
        """
        key = before, node, after
        if key not in self._spans:
            region = self.shape.regions[node]
            firsts, lasts = self.cells(before, node), self.cells(node, after)
            weight = np.empty((len(firsts), len(lasts)))
            visited = np.zeros((*weight.shape, len(region.head)), bool)
            for (i, first), (j, last) in product(enumerate(firsts), enumerate(lasts)):
                chain = planar.chain(region, first, last)
                weight[i, j] = planar.chain_limit(region, chain, first)[1]
                visited[i, j, [block for block, _, _ in chain]] = True
            self._spans[key] = weight, visited
        return self._spans[key]


def _sample(shape: Layers, a: int, b: int, rng: np.random.Generator) -> list[int]:
    n_alike: dict[tuple[int, int, int], int] = {}
    kept: tuple[list[int], list[int]] = ([], [])
    for cell in rng.permutation(shape.overlap(a, b)).tolist():
        colour = shape.regions[a].colour(cell)
        kind = colour, int(shape.regions[a].home[cell]), int(shape.regions[b].home[cell])
        n_alike[kind] = n_alike.get(kind, 0) + 1
        if n_alike[kind] <= N_ALIKE and len(kept[colour]) < N_PLACES:
            kept[colour].append(cell)
    return kept[0] + kept[1]


def prospects(plan: Plan, places: Places) -> Prospects:
    """Candidates along the MSP and their ratings."""
    msp, shape = plan.msp, places.shape
    ways = [(msp[0], msp[0]), *pairwise(msp), (msp[-1], msp[-1])]
    value = []
    for (before, node), (_, after) in pairwise(ways):
        weight, visited = places.span(before, node, after)
        total = weight.copy()
        for child in plan.hanging[node]:
            total += plan.value(child) * visited[:, :, plan.door_blocks[child]].any(axis=2)
        value.append(total)
    cells = [places.cells(a, b) for a, b in ways]
    last_colour = np.array([shape.voxel_colour(msp[-1], cell) for cell in cells[-1]])
    return Prospects(
        cells,
        value,
        (_to_come(value, last_colour == 0), _to_come(value, last_colour == 1)),
        [shape.voxel_colour(msp[0], cell) for cell in cells[0]],
    )


def _to_come(value: list[grid.FloatArray], may_end: grid.BoolArray) -> list[grid.FloatArray]:
    """`Prospects.to_come` for one colour of the last voxel, from the last node back."""
    to_come = [np.where(may_end, 0.0, -np.inf)]
    for total in reversed(value):
        to_come.append((total + to_come[-1]).max(axis=1))
    return to_come[::-1]
