"""The flow bound against exhaustive search and another flow."""

import numpy as np
import pytest
from hypothesis import given, settings
from oracles import longest_path, simple_paths_from, two_matching, voxel_graph
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


def longest_without_a_u(graph):
    """The same of paths without three sides of a unit square in a row."""

    def has_u(path):
        fours = zip(path, path[1:], path[2:], path[3:], strict=False)
        return any((np.subtract(b, a) == np.subtract(c, d)).all() for a, b, c, d in fours)

    paths = (path for start in graph for path in simple_paths_from(graph, start))
    return max(len(path) for path in paths if not has_u(path))


@settings(max_examples=60, deadline=None)
@given(polycubes(9))
def test_no_path_without_a_u_is_longer(occupancy):
    solid = lu.VoxelSolid(occupancy)
    bound = lu.path_bound(solid, u_free=True)
    assert longest_without_a_u(voxel_graph(occupancy)) <= bound <= lu.path_bound(solid)


@pytest.mark.parametrize(
    ("shape", "voxels"),
    [((1, 1, 1), 1), ((5, 1, 1), 5), ((2, 2, 1), 3), ((3, 2, 1), 5), ((2, 2, 2), 7)],
)
def test_boxes_that_cannot_be_filled_without_a_u(shape, voxels):
    solid = lu.VoxelSolid(np.ones(shape, bool))
    assert lu.path_bound(solid, u_free=True) == voxels
    assert longest_without_a_u(voxel_graph(solid.occupancy)) <= voxels
