"""The paper's Algorithm 3: what always holds, and that nothing is replaced unsaid."""

import os

import numpy as np
import pytest
from contracts import check_path
from examples import examples
from hypothesis import given
from hypothesis import strategies as st
from oracles import outermost_boundary, without_dangling
from polycubes import blob, polycubes
from regions import cells_of

import lineup as lu
from lineup.paper import REASONS

solids = (st.integers(0, 2**32).map(blob) | polycubes(60)).map(lu.VoxelSolid)


def planar_paths(found, graph):
    """The cells (x, y) of each linked node's planar path, in order."""
    node_of = graph.node_of[tuple(found.path.voxels.T)]
    return {
        node: list(map(tuple, found.path.voxels[node_of == node, :2].tolist()))
        for node in found.path.visits[:, 2].tolist()
    }


def hangs_off(traversal):
    """The node before each node of an MSC when the walk first comes to it."""
    walk = traversal.walk
    return {n: walk[walk.index(n) - 1] for n in walk if n not in traversal.msp}


class Layer:
    """Boundary and interior of a node by definition, as sets of cells."""

    def __init__(self, graph, node):
        kept, _ = without_dangling(graph.node_of[:, :, graph.layer_of[node]] == node)
        boundary = outermost_boundary(kept)
        self.kept, self.boundary = set(cells_of(kept)), set(cells_of(boundary))
        self.inner = self.kept - self.boundary


@examples(100)
@given(solids, st.integers(0, 3))
def test_paths_are_certified_and_every_node_is_accounted_for(solid, seed):
    if solid.size < 2:
        return
    found = lu.algorithm3(solid, seed)
    check_path(found.path, solid)
    graph = lu.reeb_graph(solid)
    paths = planar_paths(found, graph)
    traversal = found.traversal
    assert traversal == lu.traverse(graph)
    above = hangs_off(traversal)
    rows = found.nodes
    assert rows["node"].tolist() == list(range(len(graph)))
    for row in rows.itertuples():
        reasons = set(row.reasons.split(", ")) - {""}
        assert reasons <= set(REASONS)
        assert row.covered == len(paths.get(row.node, []))
        assert row.voxels == (graph.node_of == row.node).sum()
        assert (row.part == "MSP") == (row.node not in above)
        assert (row.how == "dropped") == (row.covered == 0)
        assert row.how == "Algorithm 2" or reasons
        if "hangs-off-dropped" in reasons:
            assert rows["how"][above[row.node]] == "dropped"
    written = (rows["how"] == "Algorithm 2") & (rows["reasons"] == "")
    counts = (rows["how"] == "Algorithm 2").sum(), len(rows), written.sum()
    said = "paper (Algorithm 2 in {} of {} nodes, {} as written)"
    assert found.path.method == said.format(*counts)


@examples(60)
@given(st.integers(0, 2**32).map(blob).map(lu.VoxelSolid), st.integers(0, 3))
def test_algorithm_2_keeps_what_the_paper_says_and_ends_where_it_says(solid, seed):
    found = lu.algorithm3(solid, seed)
    graph = lu.reeb_graph(solid)
    paths = planar_paths(found, graph)
    above = hangs_off(found.traversal)
    following = dict(zip(found.traversal.msp, found.traversal.msp[1:], strict=False))
    for row in found.nodes[found.nodes["how"] == "Algorithm 2"].itertuples():
        layer, path = Layer(graph, row.node), paths[row.node]
        assert layer.boundary <= set(path) <= layer.kept
        assert {path[0], path[-1]} <= layer.inner
        if row.reasons:
            continue
        assert sum(path[0]) % 2 != sum(path[-1]) % 2
        if row.node in following:
            assert path[-1] == paths[following[row.node]][0]
            assert path[-1] in Layer(graph, following[row.node]).inner
        if row.node in above:
            base = paths[above[row.node]]
            step = base.index(path[0])
            assert base[step + 1] == path[-1]
            assert {path[0], path[-1]} <= set(base[1:-1])


def test_the_same_seed_gives_the_same_path():
    solid = lu.VoxelSolid(blob(5))
    first, again, other = (lu.algorithm3(solid, seed) for seed in (4, 4, 5))
    assert (first.path.voxels == again.path.voxels).all()
    assert first.nodes.equals(again.nodes)
    assert not np.array_equal(first.path.voxels, other.path.voxels)


def test_it_is_a_path_method():
    solid = lu.VoxelSolid(blob(5))
    path = lu.layered_path(solid, method="paper", seed=4)
    assert (path.voxels == lu.algorithm3(solid, 4).path.voxels).all()
    assert path.method == lu.algorithm3(solid, 4).path.method


def test_what_cannot_be_linked_is_dropped_with_what_hangs_off_it():
    """Three towers one voxel thick on a plate; the path ends in the plate and begins on one."""
    plate = np.zeros((6, 7, 4), bool)
    plate[:, :, 0] = True
    plate[[1, 1, 4], [1, 5, 1]] = True
    found = lu.algorithm3(lu.VoxelSolid(plate))
    rows = found.nodes
    dropped = rows[rows["how"] == "dropped"]
    assert dropped["reasons"].tolist() == ["no-link"] * 2 + ["hangs-off-dropped"] * 4
    assert len(found.path.dropped) >= 6


@pytest.mark.parametrize("length", [2, 3, 4, 7])
def test_a_column_of_odd_height_loses_its_last_voxel(length):
    found = lu.algorithm3(lu.VoxelSolid(np.ones((1, 1, length), bool)))
    check_path(found.path, lu.VoxelSolid(np.ones((1, 1, length), bool)))
    assert len(found.path) == length - length % 2
    assert ("odd" in set(found.nodes["reasons"])) == (length % 2 == 1)


def test_bad_use():
    with pytest.raises(ValueError, match="seed must be at least 0, got -1"):
        lu.algorithm3(lu.VoxelSolid(np.ones((2, 2, 2), bool)), seed=-1)
    with pytest.raises(ValueError, match="at least two voxels"):
        lu.algorithm3(lu.VoxelSolid(np.ones((1, 1, 1), bool)))
    with pytest.raises(ValueError, match="no option 'starts'"):
        lu.layered_path(lu.VoxelSolid(np.ones((2, 2, 2), bool)), method="paper", starts=2)


@pytest.mark.skipif("LINEUP_MODELS" not in os.environ, reason="LINEUP_MODELS names no folder")
@pytest.mark.slow
def test_coverage_of_real_models():
    """As measured: solids of many handles or limbs are badly served by one depth-first tree."""
    models = lu.models()
    coverage = {}
    for name in models["name"][models["source"] == "folder"]:
        solid = lu.model(name, voxels=1600)
        path = lu.layered_path(solid, method="paper")
        check_path(path, solid)
        coverage[name] = path.coverage(solid)
    assert np.median(list(coverage.values())) >= 0.85, coverage
    assert sum(share < 0.7 for share in coverage.values()) <= 2, coverage
