"""The paper's layered path as written (Section 4, Algorithm 3), and where it cannot be.

Ends of the planar paths are drawn as Section 4.3 says, and Algorithm 2 is run in every node. The
paper needs assumptions (Section 4.4) that few nodes of a solid of some thousand voxels meet, see
`assumptions.audit`. Where one fails, this node alone gets other ends or our planar search, and a
reason code; nothing is replaced without one.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pandas as pd

from . import planar
from ._record import of_kind
from .assumptions import HOLE, NO_COMMON_INTERIOR, NO_LINK_INSIDE, anatomy, hanging_from
from .assumptions import REASONS as ASSUMED
from .grid import BoolArray, IntArray
from .linking import Effort, Layers, assembled, layers
from .linking.build import Linked
from .linking.rating import plan
from .reeb import Traversal, traverse
from .solid import VoxelPath, VoxelSolid

ALGORITHM_2, FALLBACK, DROPPED = "Algorithm 2", "fallback", "dropped"

ONE_COLOUR = "one-colour"
ENDS_ALIKE = "ends-alike"
NO_LINK = "no-link"
HANGS_OFF_DROPPED = "hangs-off-dropped"
ODD = "odd"

REASONS: dict[str, str] = {
    **ASSUMED,
    ONE_COLOUR: "I_i minus v_s has no voxel of the colour wanted (Section 4.3.1)",
    ENDS_ALIKE: "both ends have one colour, so the planar path is odd",
    NO_LINK: "no free link of the path that it hangs off lies in the node at all",
    HANGS_OFF_DROPPED: "the node that it hangs off is dropped",
    ODD: "its only voxel would make the path odd",
}
"""What each reason code says: what Section 4 takes for granted and the node has not."""


@dataclass(frozen=True, eq=False)
class Algorithm3:
    """A layered path of the paper, and how each node came to its planar path.

    Attributes
    ----------
    path : VoxelPath
    traversal : Traversal
    nodes : DataFrame
        One row for each node, in order: "node"; "layer", its z; "part", "MSP" or "MSC"; "how",
        "Algorithm 2", "fallback" or "dropped"; "reasons", keys of `REASONS` with commas between,
        none where the node ran as written; "voxels"; "covered", those on the path.
    """

    path: VoxelPath
    traversal: Traversal
    nodes: pd.DataFrame


def algorithm3(solid: VoxelSolid, seed: int = 0) -> Algorithm3:
    """A layered path by the paper's Algorithm 3, each node recorded (Section 4).

    The depth-first tree is that of `traverse`, from the highest node to the lowest. All choices
    that the paper calls random are drawn from `seed`; so is the last v_e of the MSP, which it
    leaves open, from the interior.

    Raises
    ------
    ValueError
        If `seed` is negative or the solid is one voxel.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> found = lu.algorithm3(lu.VoxelSolid(np.ones((6, 7, 2), bool)))
    >>> found.path.method
    'paper (Algorithm 2 in 2 of 2 nodes, 2 as written)'
    >>> found.nodes[["how", "reasons", "voxels"]].values.tolist()
    [['Algorithm 2', '', 42], ['Algorithm 2', '', 42]]
    """
    of_kind(solid, VoxelSolid)
    if seed < 0:
        raise ValueError(f"seed must be at least 0, got {seed}")
    if solid.size < 2:
        raise ValueError("a path needs at least two voxels, the solid has 1")
    shape = layers(solid)
    traversal = traverse(shape.graph)
    work = _Work(shape, traversal, np.random.default_rng(seed))
    work.link_msp()
    for node in work.above:
        work.link_hanging(node)
    nodes = work.table()
    ran = nodes["how"] == ALGORITHM_2
    written = ran & (nodes["reasons"] == "")
    method = f"paper (Algorithm 2 in {ran.sum()} of {len(nodes)} nodes, {written.sum()} as written)"
    return Algorithm3(assembled(shape, work.out, method), traversal, nodes)


class _Work:
    """The planar paths found so far, and how they were found."""

    def __init__(self, shape: Layers, traversal: Traversal, rng: np.random.Generator) -> None:
        self.shape, self.rng = shape, rng
        self.out = Linked(list(traversal.msp))
        self.how: dict[int, tuple[str, list[str]]] = {}
        self.above = hanging_from(traversal)
        self.plan = plan(shape, _tree(traversal, len(shape.graph)), list(traversal.msp))
        self.masks = [region.inside.reshape(-1, shape.width) for region in shape.regions]
        self.parts = [anatomy(mask) for mask in self.masks]
        self.interior = [part.interior.ravel() for part in self.parts]
        self.sound = [not set(part.reasons) - {HOLE} for part in self.parts]

    def link_msp(self) -> None:
        """Planar paths along the MSP, each from where the one before it ended (4.3.1)."""
        msp, shape = self.out.msp, self.shape
        start = self._first()
        # Colours alternate along the path, so it is even if its ends differ in colour.
        last_colour = 1 - shape.voxel_colour(msp[0], start)
        if not len(self._of_colour(msp[-1], last_colour)):
            self.how[msp.pop()] = DROPPED, [ODD]
        for k, node in enumerate(msp):
            region = shape.regions[node]
            if k + 1 < len(msp):
                colour = 1 - region.colour(start)
                overlap, inside = shape.overlap(node, msp[k + 1]), self.interior[msp[k + 1]]
            else:
                overlap, inside = self._of_colour(node, last_colour), region.inside
                colour = region.colour(int(overlap[0]))
            end, reasons = self._end(node, start, overlap, inside, colour)
            self._solve(node, start, end, reasons)
            start = end

    def _of_colour(self, node: int, colour: int) -> IntArray:
        """The cells of a node whose voxels have a colour."""
        region = self.shape.regions[node]
        layer = int(self.shape.graph.layer_of[node])
        cells: IntArray = region.cells[_colour(region, region.cells) == (colour + layer) % 2]
        return cells

    def _first(self) -> int:
        """A random voxel of the first interior.

        If the last node has one voxel, then of the other colour than that one, if there is any.
        """
        msp, shape = self.out.msp, self.shape
        cells = shape.regions[msp[0]].cells
        if shape.size(msp[-1]) == 1:
            last = int(shape.regions[msp[-1]].cells[0])
            fit = self._of_colour(msp[0], 1 - shape.voxel_colour(msp[-1], last))
            cells = fit if len(fit) else cells
        inside = cells[self.interior[msp[0]][cells]]
        if len(inside):
            return int(self.rng.choice(inside))
        end = int(self.rng.choice(shape.overlap(*msp[:2]) if len(msp) > 1 else cells))
        return self._widest(msp[0], [(int(cell), end) for cell in cells])[0]

    def _end(
        self, node: int, start: int, overlap: IntArray, inside: BoolArray, colour: int
    ) -> tuple[int, list[str]]:
        """A random voxel of I_i minus v_s of a colour.

        Without one, or if Algorithm 2 cannot be run here whatever the ends, the one of the
        overlap that most can be reached with; in the interiors that Algorithm 2 needs, if any.
        """
        region, sound = self.shape.regions[node], self.sound[node]
        ahead = overlap[overlap != start]
        fit = ahead[_colour(region, ahead) == colour]
        own = fit[(self.interior[node] if sound else region.inside)[fit]]
        both = own[inside[own]]
        common = ahead[self.interior[node][ahead] & inside[ahead]]
        if sound and len(both):
            end = int(self.rng.choice(both))
        else:
            cells = next(c for c in (both, own, fit, ahead, overlap) if len(c))
            _, end = self._widest(node, [(start, int(cell)) for cell in cells])
        reasons = []
        if not len(common):
            reasons.append(NO_COMMON_INTERIOR)
        elif not (_colour(region, common) == colour).any():
            reasons.append(ONE_COLOUR)
        if region.colour(start) == region.colour(end):
            reasons.append(ENDS_ALIKE)
        return end, reasons

    def link_hanging(self, node: int) -> None:
        """The planar path of a node off the MSP, from a link of the one it hangs off (4.3.2)."""
        if self.above[node] not in self.out.paths:
            self.how[node] = DROPPED, [HANGS_OFF_DROPPED]
            return
        path = self.out.paths[self.above[node]]
        taken = self.out.excursions.setdefault(self.above[node], {})
        region, interior = self.shape.regions[node], self.interior[node]
        links = np.flatnonzero(region.inside[path[:-1]] & region.inside[path[1:]])
        steps = [k for k in links.tolist() if k not in taken]
        inner = [
            k
            for k in steps
            if 0 < k < len(path) - 2 and interior[path[k]] and interior[path[k + 1]]
        ]
        if not steps:
            self.how[node] = DROPPED, [NO_LINK]
            return
        if inner and self.sound[node]:
            start, end = _ends(path, int(self.rng.choice(inner)))
        else:
            start, end = self._widest(node, [_ends(path, k) for k in steps])
        taken[int(np.flatnonzero(path == start)[0])] = node
        self._solve(node, start, end, [] if inner else [NO_LINK_INSIDE])

    def _widest(self, node: int, ends: list[tuple[int, int]]) -> tuple[int, int]:
        """The pair of ends between which most can be reached; alike ones at random."""
        limit = np.array([self._limit(node, *pair) for pair in ends])
        return ends[int(self.rng.choice(np.flatnonzero(limit == limit.max())))]

    def _limit(self, node: int, start: int, end: int) -> float:
        """What no planar path between two cells exceeds, with what hangs off its blocks."""
        region, plan = self.shape.regions[node], self.plan
        blocks = planar.chain(region, start, end)
        reached = {block for block, _, _ in blocks}
        return planar.chain_limit(region, blocks, start)[1] + sum(
            plan.value(child)
            for child in plan.hanging[node]
            if reached.intersection(plan.door_blocks[child])
        )

    def _solve(self, node: int, start: int, end: int, reasons: list[str]) -> None:
        """Algorithm 2 between two cells of a node, or our search where an assumption fails."""
        how, cells = FALLBACK, np.empty(0, np.int32)
        reasons = [*reasons, *self.parts[node].reasons]
        if self.sound[node] and start != end:
            width = self.shape.width
            found = planar.paper_path(
                self.masks[node],
                divmod(start, width),
                divmod(end, width),
                int(self.rng.integers(2**31)),
            )
            reasons += found.reasons
            cells = (found.cells @ [width, 1]).astype(np.int32)
        if len(cells):
            how = ALGORITHM_2
        else:
            region, effort = self.shape.regions[node], Effort()
            cells, _, _ = planar.long_path(
                region, start, end, self._wishes(node), effort.restarts, effort.sweeps, self.rng
            )
        self.out.paths[node], self.how[node] = cells, (how, reasons)

    def _wishes(self, node: int) -> planar.Wishes:
        """A link for each node that hangs off this one, in its interior if there is one."""
        links, slots, bonus = [], [], []
        graph, width = self.shape.graph, self.shape.width
        for child in self.plan.hanging[node]:
            doors, interior = self.plan.doors[child], self.interior[child]
            cell, axis = doors.T
            inner = doors[interior[cell] & interior[cell + np.where(axis == 0, 1, width)]]
            if len(doors):
                links.append(inner if len(inner) else doors)
                slots.append(int(graph.layer_of[child] > graph.layer_of[node]))
                bonus.append(self.plan.value(child))
        return planar.Wishes(links, slots, np.array(bonus))

    def table(self) -> pd.DataFrame:
        """`Algorithm3.nodes`."""
        rows = []
        for node, layer in enumerate(self.shape.graph.layer_of.tolist()):
            how, reasons = self.how[node]
            rows.append(
                {
                    "node": node,
                    "layer": layer,
                    "part": "MSC" if node in self.above else "MSP",
                    "how": how,
                    "reasons": ", ".join(reasons),
                    "voxels": self.shape.size(node),
                    "covered": len(self.out.paths.get(node, ())),
                }
            )
        return pd.DataFrame(rows)


def _tree(traversal: Traversal, n: int) -> list[list[int]]:
    """The tree neighbours of each node."""
    near: list[set[int]] = [set() for _ in range(n)]
    for a, b in pairwise(traversal.walk):
        near[a].add(b)
        near[b].add(a)
    return [sorted(nodes) for nodes in near]


def _colour(region: planar.Region, cells: IntArray) -> IntArray:
    """`Region.colour` of many cells."""
    colour: IntArray = (cells // region.width + cells % region.width) % 2
    return colour


def _ends(path: IntArray, step: int) -> tuple[int, int]:
    return int(path[step]), int(path[step + 1])
