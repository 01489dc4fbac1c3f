"""The paper's symbols, what each is called here, and its value on one small solid (Table 1)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd

from . import grid
from .assumptions import Anatomy, anatomy, mask_of
from .contraction import contraction_pairs
from .paper import Algorithm3, algorithm3
from .reeb import ReebGraph, Traversal, reeb_graph, traverse
from .solid import VoxelPath, VoxelSolid
from .trimming import trim


@dataclass(frozen=True)
class Example:
    """One solid, and all that Sections 4 and 5 make of it, worked out when first asked for."""

    solid: VoxelSolid

    @cached_property
    def graph(self) -> ReebGraph:
        return reeb_graph(self.solid)

    @cached_property
    def traversal(self) -> Traversal:
        return traverse(self.graph)

    @cached_property
    def found(self) -> Algorithm3:
        return algorithm3(self.solid)

    @property
    def path(self) -> VoxelPath:
        return self.found.path

    @cached_property
    def region(self) -> Anatomy:
        """Boundary and interior of the first node of the MSP."""
        return anatomy(mask_of(self.graph, self.traversal.msp[0]))

    @cached_property
    def trimmed(self) -> VoxelPath:
        return trim([self.path], len(self.path) - 2)[0]

    def ends(self) -> tuple[list[int], list[int]]:
        """First and last voxel of the first run of the path in one layer."""
        start, stop = self.path.visits[0, :2].tolist()
        first, last = self.path.voxels[[start, stop - 1]].tolist()
        return first, last

    def common(self) -> int:
        """Voxels in the interiors of the first two nodes of the MSP."""
        after = anatomy(mask_of(self.graph, self.traversal.msp[1])).interior
        return int((self.region.interior & after).sum())

    def hanging(self) -> int:
        """Links of the path of o(C) that lie in the interior of the first node of an MSC."""
        above, node = self.traversal.mscs[0][:2]
        interior = anatomy(mask_of(self.graph, node)).interior
        height = self.graph.layer_of[above]
        region = mask_of(self.graph, above)
        on = self.path.voxels[:, 2] == height
        x, y = self.path.voxels[:, :2].T
        held = on & region[x, y] & interior[x, y]
        return int((held[1:] & held[:-1]).sum())

    def pair(self) -> list[int]:
        """A contraction pair of the path with the least index."""
        pairs = contraction_pairs(self.path, np.zeros_like(self.solid.occupancy))
        pair: list[int] = pairs[(pairs[:, 1] - pairs[:, 0]).argmin()].tolist()
        return pair


@dataclass(frozen=True)
class Symbol:
    """One symbol of the paper.

    Attributes
    ----------
    paper : str
        As the paper writes it.
    section : str
        Where it first appears.
    meaning : str
    here : str
        What it is called in this library.
    value : function
        What it is on an `Example`, in a few words.
    """

    paper: str
    section: str
    meaning: str
    here: str
    value: Callable[[Example], str]


SYMBOLS = (
    Symbol(
        "S̃",
        "3",
        "void-free solid of voxels",
        "`VoxelSolid`",
        lambda e: f"a grid of {' × '.join(map(str, e.solid.occupancy.shape))}",
    ),
    Symbol(
        "n", "4", "its number of voxels", "`VoxelSolid.size`", lambda e: f"{e.solid.size} voxels"
    ),
    Symbol(
        "𝒢",
        "4",
        "Reeb graph: a node for each connected component of a layer",
        "`reeb_graph(solid)`",
        lambda e: f"{len(e.graph)} nodes, {len(e.graph.edges)} edges",
    ),
    Symbol(
        "o, Ω",
        "4",
        "node, and its voxels",
        "node number; `ReebGraph.node_of`",
        lambda e: f"node {e.traversal.msp[0]}: {_size(e)} voxels",
    ),
    Symbol(
        "p(𝒢)",
        "4",
        "path that traverses all nodes",
        "`Traversal.walk`",
        lambda e: _chain(e.traversal.walk),
    ),
    Symbol(
        "(a, b)",
        "4.2",
        "directed edge from a to b",
        "consecutive nodes of `Traversal.walk`",
        lambda e: str(e.traversal.walk[:2]),
    ),
    Symbol(
        "MSP, C",
        "4.3",
        "maximal sub-path; maximal sub-cycles (MSCs)",
        "`Traversal.msp`, `Traversal.mscs`",
        lambda e: f"{_chain(e.traversal.msp)}; {', '.join(map(_chain, e.traversal.mscs))}",
    ),
    Symbol(
        "o(C)",
        "4.3",
        "node at which an MSC starts and ends",
        "`cycle[0]`",
        lambda e: ", ".join(f"node {cycle[0]}" for cycle in e.traversal.mscs),
    ),
    Symbol(
        "∂Ω, Ω°",
        "4.1",
        "boundary, interior of a region",
        "`assumptions.anatomy`",
        lambda e: f"{len(e.region.boundary)}, {int(e.region.interior.sum())} voxels",
    ),
    Symbol(
        "p(o)",
        "4.1",
        "long planar path of a node",
        "`planar_path`, `planar.paper_path`",
        lambda e: f"{int(e.found.nodes['covered'].iloc[e.traversal.msp[0]])} voxels",
    ),
    Symbol(
        "I_i",
        "4.3.1",
        "common interior of two neighbouring nodes of the MSP",
        "`draw.overlap`",
        lambda e: f"{e.common()} voxels",
    ),
    Symbol(
        "Ĩ_i",
        "4.3.2",
        "where a node of an MSC can hang off the path of another",
        "`draw.shared_links`",
        lambda e: f"{e.hanging()} links",
    ),
    Symbol(
        "P̄, P̃",
        "4.2",
        "layered path (the paper writes both)",
        "`VoxelPath` with `visits`, from `layered_path`",
        lambda e: f"{len(e.path)} voxels in {len(e.path.visits)} visits",
    ),
    Symbol(
        "v_s, v_e",
        "4.1",
        "first and last voxel in a layer",
        "ends of a row of `VoxelPath.visits`",
        lambda e: "{}, {}".format(*map(tuple, e.ends())),
    ),
    Symbol(
        "contraction pair, index",
        "5",
        "two adjacent voxels of a layer, and how many lie between them on the path",
        "`contraction`",
        lambda e: f"steps {e.pair()[0]} and {e.pair()[1]}, {e.pair()[1] - e.pair()[0] - 1} between",
    ),
    Symbol(
        "P", "5", "trimmed path", "`VoxelPath`, from `trim`", lambda e: f"{len(e.trimmed)} voxels"
    ),
    Symbol(
        "S",
        "3",
        "solid that the chain forms",
        "voxels of the trimmed path",
        lambda e: f"{len(np.unique(e.trimmed.voxels, axis=0))} voxels",
    ),
    Symbol(
        "block",
        "1",
        "two neighbouring voxels of the path",
        "voxels 2k and 2k + 1",
        lambda e: f"{len(e.path) // 2} blocks",
    ),
    Symbol(
        "colour",
        "4.3",
        "of a voxel on the checkerboard, 0 or 1",
        "`grid.colour`",
        lambda e: "{} at the first voxel, {} at the last".format(
            *grid.colour(e.path.voxels[[0, -1]]).tolist()
        ),
    ),
    Symbol(
        "Υ",
        "6",
        "motion that straightens the chain",
        "`Motion`",
        lambda _: "from `fold` or `unfold`",
    ),
)
"""In the order of the paper, as far as one needs another."""


def symbols(solid: VoxelSolid) -> pd.DataFrame:
    """Each symbol of the paper with its name here and its value on a solid (Table 1).

    Parameters
    ----------
    solid : VoxelSolid
        With two nodes or more, at least one MSC, and a first node that has an interior.

    Returns
    -------
    DataFrame
        "paper", "section", "meaning", "here", "example".

    Examples
    --------
    >>> from lineup import worked
    >>> from lineup.symbols import symbols
    >>> symbols(worked.arch()).set_index("paper")["example"]["n"]
    '168 voxels'
    """
    example = Example(solid)
    return pd.DataFrame(
        [
            {
                "paper": symbol.paper,
                "section": symbol.section,
                "meaning": symbol.meaning,
                "here": symbol.here,
                "example": symbol.value(example),
            }
            for symbol in SYMBOLS
        ]
    )


def _size(example: Example) -> int:
    return int((example.graph.node_of == example.traversal.msp[0]).sum())


def _chain(nodes: tuple[int, ...]) -> str:
    return "-".join(map(str, nodes))
