"""A solid as planar regions, and a spanning tree of its nodes with what hangs off the MSP."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import grid, planar
from ..reeb import ReebGraph, reeb_graph
from ..solid import VoxelSolid

SURFACE_WEIGHT = 2.0
"""Worth of a surface voxel, an interior one being 1: the surface carries the appearance."""


Entry = tuple[grid.IntArray, list[int]]
"""Links shared with another node, and the blocks of that node that they lie in."""


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
    shared : dict
        For each edge (a, b) of the graph, both ways round: the links that lie in both nodes,
        (m, 2) int32 rows (cell, axis). Without one, the nodes can be linked on the MSP only.
    entries : dict
        For each edge (a, b), both ways round: for each block of a in which such links lie, in
        ascending order, these links and the blocks of b that they lie in.
    """

    solid: VoxelSolid
    graph: ReebGraph
    width: int
    regions: list[planar.Region]
    shared: dict[tuple[int, int], grid.IntArray]
    entries: dict[tuple[int, int], dict[int, Entry]]

    def size(self, node: int) -> int:
        """Number of voxels of a node."""
        return len(self.regions[node].cells)

    def voxel_colour(self, node: int, cell: int) -> int:
        """Checkerboard colour of the voxel of a node at a cell."""
        return (self.regions[node].colour(cell) + int(self.graph.layer_of[node])) % 2

    def overlap(self, a: int, b: int) -> grid.IntArray:
        """The cells that both nodes have, ascending."""
        cells = self.regions[a].cells
        both: grid.IntArray = cells[self.regions[b].inside[cells]]
        return both


def layers(solid: VoxelSolid) -> Layers:
    """Cut a solid into the planar regions of its nodes."""
    graph = reeb_graph(solid)
    margin = ((1, 1), (1, 1), (0, 0))
    node_of = np.pad(graph.node_of, margin, constant_values=-1)
    weight = 1.0 + (SURFACE_WEIGHT - 1.0) * np.pad(grid.surface(solid.occupancy), margin)
    planes = [np.ascontiguousarray(node_of[:, :, z]).ravel() for z in range(node_of.shape[2])]
    weights = [np.ascontiguousarray(weight[:, :, z]).ravel() for z in range(node_of.shape[2])]
    width = node_of.shape[1]
    regions = [
        planar.region(planes[z] == node, weights[z], width)
        for node, z in enumerate(graph.layer_of.tolist())
    ]
    shared, entries = {}, {}
    for a, b in graph.edges.tolist():
        links = _links(regions[a].inside & regions[b].inside, width)
        cell, axis = links.T
        other = cell + np.where(axis, width, 1)
        block = [regions[node].block_of(cell, other) for node in (a, b)]
        shared[a, b] = shared[b, a] = links
        entries[a, b] = _entries(links, block[0], block[1])
        entries[b, a] = _entries(links, block[1], block[0])
    return Layers(solid, graph, width, regions, shared, entries)


def _entries(links: grid.IntArray, block: grid.IntArray, behind: grid.IntArray) -> dict[int, Entry]:
    """Links by the block they lie in, and with them the blocks they lie in behind it."""
    fit = {b: block == b for b in np.unique(block).tolist()}
    return {b: (links[fit[b]], np.unique(behind[fit[b]]).tolist()) for b in fit}


def _links(inside: grid.BoolArray, width: int) -> grid.IntArray:
    """The pairs of adjacent cells in a set, as rows (cell, axis)."""
    rows = []
    for axis, stride in enumerate((1, width)):
        cells = np.flatnonzero(inside[:-stride] & inside[stride:])
        rows.append(np.stack([cells, np.full(len(cells), axis)], axis=1))
    return np.concatenate(rows).astype(np.int32)
