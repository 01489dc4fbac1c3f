"""Worked examples have the graphs and the layers that they are named for."""

from itertools import pairwise

import networkx as nx
import numpy as np
import pytest
from test_reeb import graph_of

import lineup as lu
from lineup import worked
from lineup.assumptions import anatomy

FIGURE_8 = [1, 2, 3, 4, 5, 4, 3, 2, *range(6, 14), 12, 11, 10, *range(14, 19)]
FIGURE_9 = [1, 2, 3, 4, 5, 4, 3, 2, 6, 7, 8, 7, 6, 2, 9, 10]


def as_networkx(graph):
    return nx.Graph(graph.edges.tolist())


@pytest.mark.parametrize(
    ("solid", "walk", "root"),
    [(worked.figure_8(), FIGURE_8, 14), (worked.figure_9(), FIGURE_9, 3)],
    ids=["8", "9"],
)
def test_nodes_come_in_the_order_of_the_figure(solid, walk, root):
    graph = lu.reeb_graph(solid)
    found = lu.traverse(graph, root=root, end=0)
    number = {node: k for k, node in enumerate(dict.fromkeys(found.walk), 1)}
    assert [number[node] for node in found.walk] == walk
    typed = graph_of(pairwise(walk))
    assert nx.is_isomorphic(as_networkx(graph), as_networkx(typed))


def test_the_arch_meets_every_assumption_and_is_covered():
    arch = worked.arch()
    assert lu.audit(arch)["met"].all()
    assert len(lu.algorithm3(arch).path) == arch.size


def test_the_leaf_has_each_kind_of_voxel():
    mask = worked.leaf()
    parts = anatomy(mask)
    assert parts.removed.tolist() == [[0, 4], [1, 4], [2, 4]]
    assert parts.reasons == ()
    assert len(parts.boundary) + parts.interior.sum() + 3 == mask.sum()


@pytest.mark.parametrize("n_teeth", [2, 5])
def test_the_interior_of_the_comb_is_a_tree(n_teeth):
    interior = anatomy(worked.comb(n_teeth, 7)).interior
    cells = set(map(tuple, np.argwhere(interior).tolist()))
    steps = [((x, y), (x + a, y + b)) for x, y in cells for a, b in ((1, 0), (0, 1))]
    assert nx.is_tree(nx.Graph([step for step in steps if step[1] in cells]))
