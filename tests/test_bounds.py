"""The flow bound against exhaustive search and another flow."""

import numpy as np
import pytest
from hypothesis import given, settings
from oracles import longest_path, two_matching, voxel_graph
from polycubes import polycubes

import lineup as lu


@settings(max_examples=60, deadline=None)
@given(polycubes(11))
def test_no_path_is_longer(occupancy):
    assert longest_path(voxel_graph(occupancy)) <= lu.path_bound(lu.VoxelSolid(occupancy))


@settings(max_examples=40, deadline=None)
@given(polycubes(60))
def test_the_flow_is_that_of_networkx(occupancy):
    solid = lu.VoxelSolid(occupancy)
    flow = two_matching(voxel_graph(occupancy), lambda voxel: sum(voxel) % 2)
    assert lu.path_bound(solid) == min(solid.size, flow + 1)


@pytest.mark.parametrize("shape", [(1, 1, 1), (2, 1, 1), (5, 1, 1), (2, 2, 1), (3, 3, 3)])
def test_boxes_can_be_filled(shape):
    assert lu.path_bound(lu.VoxelSolid(np.ones(shape, bool))) == np.prod(shape)


def test_a_star_has_a_path_of_three():
    star = np.zeros((3, 3, 3), bool)
    star[1, 1] = star[1, :, 1] = star[:, 1, 1] = True
    assert lu.path_bound(lu.VoxelSolid(star)) == 3
