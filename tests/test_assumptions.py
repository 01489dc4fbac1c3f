"""The audit of Section 4.4 against the definitions, set by set."""

from itertools import pairwise

import networkx as nx
import numpy as np
import pytest
from examples import examples
from hypothesis import given
from hypothesis import strategies as st
from oracles import outermost_boundary, without_dangling
from polycubes import blob, polycubes
from regions import cells_of, comb, graph_of
from scipy import ndimage

import lineup as lu
from lineup.assumptions import ASSUMPTIONS, REASONS
from lineup.planar import zhang_liu_cycle

BOX = np.ones((3, 3), bool)


class Node:
    """One node as sets of cells, by the paper's definitions."""

    def __init__(self, mask):
        self.mask = mask
        self.kept, removed = without_dangling(mask)
        self.n_removed = len(removed)
        self.boundary = outermost_boundary(self.kept)
        self.inner = set(cells_of(self.kept & ~self.boundary))
        _, n_outside = ndimage.label(~np.pad(mask, 1), structure=BOX)
        self.no_hole = n_outside == 1

    def has_boundary_cycle(self):
        """With its holes filled, a region with a cell that cuts it has no boundary cycle."""
        filled = ndimage.binary_fill_holes(np.pad(self.kept, 1), structure=BOX)
        return filled.sum() >= 4 and nx.is_biconnected(graph_of(filled))

    def is_regular(self):
        if not self.inner or not nx.is_connected(graph_of(self.kept).subgraph(self.inner)):
            return False
        found = zhang_liu_cycle(self.kept & ~self.boundary).reasons
        return not {"interior-not-regular", "no-2-factor"} & set(found)


def linked(nodes, traversal):
    """Whether each node meets its assumption on I_i, for every v_s, or on I~_i."""
    held = dict.fromkeys(range(len(nodes)), True)
    may_start = nodes[traversal.msp[0]].inner
    for node, following in pairwise(traversal.msp):
        common = nodes[node].inner & nodes[following].inner
        held[node] = bool(common) and all(common - {v_s} for v_s in may_start)
        may_start = common
    for cycle in traversal.mscs:
        for k, node in enumerate(cycle[1:-1], 1):
            if node not in cycle[1:k]:
                both = set(cells_of(nodes[cycle[k - 1]].kept)) & nodes[node].inner
                held[node] = any({(x + 1, y), (x, y + 1)} & both for x, y in both)
    return held


@examples(60)
@given(st.integers(0, 2**32).map(blob) | polycubes(60))
def test_every_row_is_what_the_definitions_say(occupancy):
    solid = lu.VoxelSolid(occupancy)
    graph = lu.reeb_graph(solid)
    traversal = lu.traverse(graph)
    nodes = [Node(graph.node_of[:, :, z] == node) for node, z in enumerate(graph.layer_of.tolist())]
    held = linked(nodes, traversal)
    table = lu.audit(solid)
    assert table["node"].tolist() == list(range(len(graph)))
    for row, node in zip(table.itertuples(), nodes, strict=True):
        inner = graph_of(node.kept).subgraph(node.inner)
        assert row.layer == graph.layer_of[row.node]
        assert (row.part == "MSP") == (row.node in traversal.msp)
        assert row.voxels == node.mask.sum()
        assert row.dangling == node.n_removed
        assert row.boundary == node.boundary.sum()
        assert row.interior == len(inner)
        assert row.voxels == row.dangling + row.boundary + row.interior
        assert row.interior_exists == (len(inner) > 0)
        assert row.interior_connected == (len(inner) == 0 or nx.is_connected(inner))
        assert row.boundary_cycle == node.has_boundary_cycle()
        assert row.no_hole == node.no_hole
        assert row.linked == held[row.node]
        assert row.regular == node.is_regular()
        check_reasons(row)


def check_reasons(row):
    """Every assumption that fails is named by a code, and none that holds."""
    reasons = set(row.reasons.split(", ")) - {""}
    assert reasons <= set(REASONS)
    assert row.met == all(getattr(row, name) for name in ASSUMPTIONS) == (not reasons)
    assert row.listed == all(getattr(row, name) for name in ASSUMPTIONS if name != "regular")
    for name, codes in ASSUMPTIONS.items():
        assert getattr(row, name) == (not reasons & set(codes))


FAULTS = {
    "": """
        ######
        ######
        ######
        ######""",
    "dangling-ate-region": """
        .#..
        ####""",
    "no-interior, hole": """
        ###
        #.#
        ###""",
    "hole, no-2-factor": """
        ##########
        ##########
        ##########
        ####..####
        ####..####
        ##########
        ##########
        ##########""",
    "boundary-not-a-cycle, interior-disconnected": """
        ####...####
        ###########
        ####...####
        ####...####""",
    "interior-disconnected": """
        ####...####
        ###########
        ###########
        ####...####""",
    "interior-not-regular": """
        ####...####
        ###########
        ###########
        ###########
        ####...####""",
    "no-2-factor": """
        ######
        ######
        ######
        ######
        ######
        ######""",
}


@pytest.mark.parametrize("fault", FAULTS)
def test_faults_of_one_layer(fault):
    rows = [[c == "#" for c in line.strip()] for line in FAULTS[fault].split()]
    (found,) = lu.audit(lu.VoxelSolid(np.array(rows)[:, :, None]))["reasons"]
    assert found == fault


def test_layers_of_the_msp_whose_interiors_do_not_meet():
    steps = np.zeros((12, 6, 2), bool)
    steps[:7, :, 0] = steps[5:, :, 1] = True
    assert lu.audit(lu.VoxelSolid(steps))["linked"].tolist() == [True, False]
    steps[7, :, 0] = True
    assert lu.audit(lu.VoxelSolid(steps))["linked"].tolist() == [True, True]


def test_a_layer_of_an_msc_without_two_neighbours_over_its_interior():
    """Two plates on one; the second has only the corner of its interior over the lower one."""
    plates = np.zeros((9, 14, 2), bool)
    plates[:5, :10, 0] = plates[:5, :6, 1] = plates[3:, 8:, 1] = True
    rows = lu.audit(lu.VoxelSolid(plates))
    assert rows["part"].tolist() == ["MSP", "MSP", "MSC"]
    assert rows["linked"].tolist() == [True, True, False]
    plates[5, :10, 0] = True
    assert lu.audit(lu.VoxelSolid(plates))["linked"].tolist() == [True, True, True]


def test_a_comb_of_teeth_three_wide_breaks_only_what_the_paper_does_not_list():
    (row,) = lu.audit(lu.VoxelSolid(comb(5, 9)[:, :, None])).itertuples()
    assert row.reasons == "interior-not-regular"


def test_the_summary_adds_up():
    solids = [
        lu.VoxelSolid(np.ones((6, 7, 2), bool), name="block"),
        lu.VoxelSolid(np.ones((1, 1, 3), bool), name="column"),
        lu.VoxelSolid(blob(3), name="blob"),
    ]
    summary = lu.audit_summary(solids)
    assert summary["name"].tolist() == ["block", "column", "blob"]
    assert summary["nodes_met"].tolist()[:2] == [1, 0]
    assert summary["dangling"].tolist()[:2] == [0, 1]
    for solid, row in zip(solids, summary.itertuples(), strict=True):
        nodes = lu.audit(solid)
        assert row.voxels == solid.size == nodes["voxels"].sum()
        assert row.nodes == len(nodes)
        for kind in ("listed", "met"):
            voxels = (nodes[kind] * nodes["voxels"]).sum()
            assert getattr(row, f"nodes_{kind}") == pytest.approx(nodes[kind].sum() / len(nodes))
            assert getattr(row, f"voxels_{kind}") == pytest.approx(voxels / solid.size)
        for name in ASSUMPTIONS:
            assert getattr(row, name) == pytest.approx(nodes[name].sum() / len(nodes))
