"""Sections 4 and 4.3, Figures 8 and 9."""

from itertools import pairwise

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import voxel_graph
from polycubes import polycubes

import lineup as lu
from lineup.reeb import ReebGraph


def graph_of(edges):
    """A Reeb graph with nodes numbered as in the paper, from 1; node 0 hangs off node 1."""
    rows = np.array(sorted({tuple(sorted(e)) for e in edges}), np.int32) - 1
    layer_of = np.zeros(rows.max() + 1, np.int32)
    return ReebGraph(np.zeros((1, 1, 1), np.int32), layer_of, rows)


def split(walk):
    """A walk of the paper's node numbers, decomposed; the answer in the paper's numbers."""
    found = lu.traverse(graph_of(pairwise(walk)), walk=[node - 1 for node in walk])
    assert found.walk == tuple(node - 1 for node in walk)
    msp = tuple(node + 1 for node in found.msp)
    return msp, [tuple(node + 1 for node in cycle) for cycle in found.mscs]


def test_figure_8():
    walk = (1, 2, 3, 4, 5, 4, 3, 2, 6, 7, 8, 9, 10, 11, 12, 13, 12, 11, 10, 14, 15, 16, 17, 18)
    msp, mscs = split(walk)
    assert msp == (1, 2, 6, 7, 8, 9, 10, 14, 15, 16, 17, 18)
    assert mscs == [(2, 3, 4, 5, 4, 3, 2), (10, 11, 12, 13, 12, 11, 10)]


def test_figure_9_two_cycles_at_one_node():
    msp, mscs = split((1, 2, 3, 4, 5, 4, 3, 2, 6, 7, 8, 7, 6, 2, 9, 10))
    assert msp == (1, 2, 9, 10)
    assert mscs == [(2, 3, 4, 5, 4, 3, 2), (2, 6, 7, 8, 7, 6, 2)]


def test_a_branching_cycle_stays_one_cycle():
    msp, mscs = split((1, 2, 3, 2, 4, 2, 1, 5))
    assert msp == (1, 5)
    assert mscs == [(1, 2, 3, 2, 4, 2, 1)]


def test_figure_8_is_walked_depth_first():
    walk = (1, 2, 3, 4, 5, 4, 3, 2, 6, 7, 8, 9, 10, 11, 12, 13, 12, 11, 10, 14, 15, 16, 17, 18)
    found = lu.traverse(graph_of(pairwise(walk)), root=0, end=17)
    assert found.walk == tuple(node - 1 for node in walk)


@pytest.mark.parametrize(
    ("walk", "message"),
    [
        ((0, 1), "misses 1 of 3"),
        ((0, 2, 1), "no edge joins"),
        ((0, 1, 0, 1, 2), "no edge twice"),
        ((0, 1, 2, 7), "from node 2 to 7"),
    ],
)
def test_walks_refused(walk, message):
    with pytest.raises(ValueError, match=message):
        lu.traverse(graph_of([(1, 2), (2, 3)]), walk=walk)


def test_a_walk_round_a_handle_is_refused():
    with pytest.raises(ValueError, match="spanning tree"):
        lu.traverse(graph_of([(1, 2), (2, 3), (3, 4), (1, 4)]), walk=(0, 1, 2, 3, 0))


@pytest.mark.parametrize("options", [{"root": 3}, {"end": -1}, {"walk": (0, 1, 2), "root": 0}])
def test_bad_ends_are_refused(options):
    with pytest.raises(ValueError, match=r"must be a node|not both"):
        lu.traverse(graph_of([(1, 2), (2, 3)]), **options)


@settings(max_examples=60, deadline=None)
@given(polycubes(60))
def test_nodes_and_edges_are_those_of_networkx(occupancy):
    graph = lu.reeb_graph(lu.VoxelSolid(occupancy))
    planar = voxel_graph(occupancy, in_layer=True)
    found = {frozenset(part) for part in nx.connected_components(planar)}
    mine = {
        frozenset(map(tuple, np.argwhere(graph.node_of == k).tolist())) for k in range(len(graph))
    }
    assert mine == found
    node = {voxel: int(graph.node_of[voxel]) for voxel in planar}
    vertical = {
        (node[v], node[v[0], v[1], v[2] + 1]) for v in planar if (v[0], v[1], v[2] + 1) in planar
    }
    assert graph.edges.tolist() == sorted(map(list, vertical))
    assert ((graph.node_of >= 0) == occupancy).all()
    assert all(graph.layer_of[k] == z for (_, _, z), k in node.items())
    assert (np.diff(graph.layer_of) >= 0).all()


@settings(max_examples=60, deadline=None)
@given(polycubes(60), st.data())
def test_walks_visit_everything_and_come_apart(occupancy, data):
    graph = lu.reeb_graph(lu.VoxelSolid(occupancy))
    nodes = st.integers(0, len(graph) - 1)
    root, end = data.draw(nodes), data.draw(nodes)
    found = lu.traverse(graph, root=root, end=end)
    joined = {frozenset(edge) for edge in graph.edges.tolist()}
    steps = {frozenset(step) for step in pairwise(found.walk)}
    assert set(found.walk) == set(range(len(graph)))
    assert steps <= joined
    assert len(graph) == 1 or nx.is_tree(nx.Graph(tuple(step) for step in steps))
    assert (found.msp[0], found.msp[-1]) == (root, end)
    for cycle in found.mscs:
        assert cycle[0] == cycle[-1] in found.msp
        assert cycle.count(cycle[0]) == 2
        assert not set(cycle[1:-1]) & set(found.msp)
    rebuilt = []
    for node in found.msp:
        rebuilt.append(node)
        for cycle in found.mscs:
            if cycle[0] == node:
                rebuilt.extend(cycle[1:])
    assert tuple(rebuilt) == found.walk
    assert lu.traverse(graph, walk=found.walk) == found


def test_default_ends_are_the_highest_and_the_lowest_node():
    graph = lu.reeb_graph(lu.VoxelSolid(np.ones((2, 2, 4), bool)))
    assert lu.traverse(graph).walk == (3, 2, 1, 0)
