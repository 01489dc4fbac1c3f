"""Long paths by general tools: networkx, LKH (through elkai) and CP-SAT, on the whole voxel graph.

A peer takes a solid and returns the voxels of a path in order, (P, 3), and a note.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import networkx as nx
import numpy as np
from numpy.typing import NDArray

import lineup as lu

Found = tuple[NDArray[Any], str]

ROOTS = 8
EFFORT = 30.0
"""CP-SAT's deterministic time: about as many seconds, but the same on every machine."""


def depth_first(solid: lu.VoxelSolid) -> Found:
    """networkx: the longest way down a depth-first tree, from several roots."""
    voxels = np.argwhere(solid.occupancy)
    graph = voxel_graph(voxels)
    roots = np.linspace(0, len(voxels) - 1, ROOTS).astype(int).tolist()
    ways = [nx.dag_longest_path(nx.dfs_tree(graph, root)) for root in roots]
    return voxels[max(ways, key=len)], ""


def tour_search(solid: lu.VoxelSolid) -> Found:
    """networkx: a travelling salesman's tour by threshold accepting, its longest unbroken part."""
    voxels = np.argwhere(solid.occupancy)
    distance = np.abs(voxels[:, None] - voxels).sum(axis=2)
    graph = nx.from_numpy_array(distance)
    tour = nx.approximation.threshold_accepting_tsp(graph, "greedy", seed=0)
    return unbroken(voxels[tour[:-1]])


def lkh(solid: lu.VoxelSolid) -> Found:
    """LKH: a tour with as few steps between voxels apart as can be, its longest unbroken part."""
    import elkai

    voxels = np.argwhere(solid.occupancy)
    apart = np.abs(voxels[:, None] - voxels).sum(axis=2) > 1
    tour = elkai.DistanceMatrix(apart.astype(int).tolist()).solve_tsp(runs=1)
    return unbroken(voxels[tour[:-1]])


def cp_sat(solid: lu.VoxelSolid) -> Found:
    """CP-SAT: the longest path as a circuit through a voxel more, to proof or to a fixed effort."""
    from ortools.sat.python import cp_model

    voxels = np.argwhere(solid.occupancy)
    n, model = len(voxels), cp_model.CpModel()
    pairs = sorted(voxel_graph(voxels).edges)
    arcs = [*pairs, *((b, a) for a, b in pairs)]
    arcs += [arc for k in range(n) for arc in ((n, k), (k, n), (k, k))]
    taken = {arc: model.new_bool_var("") for arc in arcs}
    model.add_circuit([(a, b, literal) for (a, b), literal in taken.items()])
    model.minimize(sum(taken[k, k] for k in range(n)))
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.max_deterministic_time = EFFORT
    status = solver.solve(model)
    if status not in (cp_model.OPTIMAL, cp_model.FEASIBLE):
        return voxels[:0], "found nothing"
    ahead = {a: b for (a, b), literal in taken.items() if a != b and solver.value(literal)}
    way = [ahead[n]]
    while ahead[way[-1]] != n:
        way.append(ahead[way[-1]])
    most = n - int(np.ceil(solver.best_objective_bound - 1e-6))
    return voxels[way], "proved longest" if most == len(way) else f"stopped: at most {most}"


PEERS: dict[str, tuple[Callable[[lu.VoxelSolid], Found], int]] = {
    "networkx depth-first": (depth_first, 20_000),
    "networkx tour": (tour_search, 500),
    "LKH": (lkh, 2_000),
    "CP-SAT": (cp_sat, 450),
}
"""Each peer and the size of the largest solid that it is given: beyond, it takes minutes."""


def voxel_graph(voxels: NDArray[Any]) -> nx.Graph:
    """The rows of `voxels`, by number, joined where they share a face."""
    number = {tuple(voxel): k for k, voxel in enumerate(voxels.tolist())}
    graph = nx.Graph()
    graph.add_nodes_from(range(len(voxels)))
    for (x, y, z), k in number.items():
        for near in ((x + 1, y, z), (x, y + 1, z), (x, y, z + 1)):
            if near in number:
                graph.add_edge(k, number[near])
    return graph


def unbroken(tour: NDArray[Any]) -> Found:
    """The longest part of a closed tour without a step between voxels apart."""
    apart = np.abs(np.roll(tour, -1, axis=0) - tour).sum(axis=1) > 1
    jumps = np.flatnonzero(apart)
    if not len(jumps):
        return tour, "jumps: 0"
    tour = np.roll(tour, -jumps[-1] - 1, axis=0)
    ends = [0, *(np.sort((jumps - jumps[-1] - 1) % len(tour)) + 1).tolist()]
    first, stop = max(pairwise(ends), key=lambda part: part[1] - part[0])
    return tour[first:stop], f"jumps: {len(jumps)}"
