"""Layered paths: what always holds, and how much they cover."""

import numpy as np
import pytest
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import longest_path, voxel_graph
from polycubes import polycubes

import lineup as lu
from lineup import layered
from lineup.layered import layered_paths
from lineup.linking import Effort
from lineup.linking.build import LARGE

FAST = {"starts": 1, "sweeps": 5}
TOWERS = [[0, 0], [0, 4], [4, 0]]


def check(path, solid):
    """The judge, and beside it the same claims worked out in another way."""
    verdict = lu.certify_path(path, solid)
    assert verdict.ok, verdict
    steps = np.diff(path.voxels, axis=0)
    assert (np.abs(steps).sum(axis=1) == 1).all()
    assert len(path) >= 2
    assert len(path) % 2 == 0
    both = np.concatenate([path.voxels, path.dropped])
    assert sorted(map(tuple, both.tolist())) == sorted(map(tuple, np.argwhere(solid.occupancy)))
    assert path.dropped.tolist() == sorted(path.dropped.tolist())
    check_visits(path, lu.reeb_graph(solid))


def check_visits(path, graph):
    """Every node is one planar path with excursions inserted: left and met again side by side."""
    starts, stops, nodes, depths = path.visits.T
    assert starts[0] == 0
    assert stops[-1] == len(path)
    assert (starts[1:] == stops[:-1]).all()
    node_of = graph.node_of[tuple(path.voxels.T)]
    assert (np.repeat(nodes, stops - starts) == node_of).all()
    trail = []
    for node, depth in zip(nodes.tolist(), depths.tolist(), strict=True):
        if depth == len(trail) - 1 and trail[depth] != node:
            assert depth == 0  # only the MSP moves on
        assert depth <= len(trail)
        trail = [*trail[:depth], node]
    for node in set(nodes.tolist()):
        planar = path.voxels[node_of == node]
        assert (np.abs(np.diff(planar, axis=0)).sum(axis=1) == 1).all()


@examples(160)
@given(polycubes(60), st.booleans(), st.integers(0, 3))
def test_every_polycube_has_a_layered_path(occupancy, both_ends_on_top, seed):
    solid = lu.VoxelSolid(occupancy)
    if solid.size < 2:
        with pytest.raises(ValueError, match="at least two voxels"):
            lu.layered_path(solid)
        return
    check(
        lu.layered_path(solid, seed=seed, both_ends_on_top=both_ends_on_top, **FAST),
        solid,
    )


@pytest.mark.slow
@settings(max_examples=3000, deadline=None)
@given(polycubes(90), st.booleans(), st.integers(0, 3))
def test_thousands_of_polycubes(occupancy, both_ends_on_top, seed):
    solid = lu.VoxelSolid(occupancy)
    if solid.size > 1:
        for path in layered_paths(solid, seed, both_ends_on_top=both_ends_on_top, **FAST):
            check(path, solid)


@examples(80)
@given(polycubes(11))
def test_between_two_voxels_and_the_longest_path(occupancy):
    solid = lu.VoxelSolid(occupancy)
    if solid.size > 1:
        longest = longest_path(voxel_graph(occupancy))
        assert 2 <= len(lu.layered_path(solid, **FAST)) <= longest <= lu.path_bound(solid)


@pytest.mark.parametrize(
    "shape", [(2, 1, 1), (1, 1, 2), (4, 4, 4), (5, 4, 3), (1, 6, 6), (2, 2, 9)]
)
def test_even_boxes_are_filled(shape):
    solid = lu.VoxelSolid(np.ones(shape, bool))
    path = lu.layered_path(solid)
    check(path, solid)
    assert len(path) == solid.size


def test_odd_columns_lose_one_voxel():
    solid = lu.VoxelSolid(np.ones((1, 1, 7), bool))
    path = lu.layered_path(solid)
    check(path, solid)
    assert len(path) == 6


def test_an_excursion_is_inserted_between_two_neighbours():
    """A table: four legs of two by two voxels can only hang off the plate or end the path."""
    table = np.zeros((8, 8, 4), bool)
    table[:, :, 3] = True
    for x in (0, 6):
        for y in (0, 6):
            table[x : x + 2, y : y + 2] = True
    solid = lu.VoxelSolid(table)
    path = lu.layered_path(solid)
    check(path, solid)
    assert len(path) == solid.size
    assert path.visits[:, 3].max() >= 1


def test_both_ends_on_top():
    table = np.ones((6, 6, 3), bool)
    table[2:4, :, 0] = False
    solid = lu.VoxelSolid(table)
    path = lu.layered_path(solid, both_ends_on_top=True)
    check(path, solid)
    assert path.voxels[[0, -1], 2].tolist() == [2, 2]
    assert path.coverage(solid) > 0.9


def test_what_cannot_be_linked_is_dropped_and_said():
    """Three towers one voxel thick on a plate: the path can end in two of them."""
    plate = np.zeros((5, 5, 4), bool)
    plate[:, :, 0] = True
    for x, y in TOWERS:
        plate[x, y] = True
    solid = lu.VoxelSolid(plate)
    path = lu.layered_path(solid)
    check(path, solid)
    towers = [path.dropped[:, :2].tolist().count(tower) for tower in TOWERS]
    assert sorted(towers) == [0, 1, 3]  # one tower, and one voxel for the even length
    assert len(path) == solid.size - 4


def test_same_seed_same_path():
    rng = np.random.default_rng(1)
    occupancy = np.ones((7, 7, 7), bool)
    occupancy[rng.integers(0, 7, 30), rng.integers(0, 7, 30), 6] = False
    occupancy[3, 3] = False
    solid = lu.VoxelSolid(occupancy)
    first, second = (lu.layered_path(solid, seed=5) for _ in range(2))
    assert (first.voxels == second.voxels).all()
    other = lu.layered_path(solid, seed=6)
    assert other.voxels.shape != first.voxels.shape or (other.voxels != first.voxels).any()


def test_starts_differ_and_the_longest_comes_first():
    paths = layered_paths(lu.VoxelSolid(np.ones((5, 5, 5), bool)), starts=5)
    assert len(paths) == 5
    lengths = [len(path) for path in paths]
    assert lengths == sorted(lengths, reverse=True)
    assert len({path.voxels.tobytes() for path in paths}) == 5


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"method": "nowhere"}, "unknown path method 'nowhere'; known: .*'layered'"),
        ({"start": 3}, "no option 'start'; known: .*'starts'"),
        ({"starts": 0}, "starts must be at least 1, got 0"),
        ({"sweeps": -1}, "sweeps must be at least 1, got -1"),
        ({"seed": -1}, "seed must be at least 0, got -1"),
    ],
)
def test_bad_use(options, message):
    with pytest.raises(ValueError, match=message):
        lu.layered_path(lu.VoxelSolid(np.ones((2, 2, 2), bool)), **options)


@pytest.mark.slow
def test_a_ball_of_a_hundred_thousand_voxels():
    axis = np.arange(-29, 30) + 0.31
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    solid = lu.VoxelSolid(x**2 + y**2 + z**2 <= 28.8**2)
    path = lu.layered_path(solid)
    check(path, solid)
    assert path.coverage(solid) >= 0.99


def test_large_solids_get_one_start(monkeypatch):
    solid = lu.VoxelSolid(np.ones((4, 4, 2), bool))
    assert len(layered_paths(solid)) == 4
    monkeypatch.setattr(layered, "ONE_START", 31)
    assert len(layered_paths(solid)) == 1
    assert len(layered_paths(solid, starts=3)) == 3


def test_large_regions_are_searched_less_often():
    effort = Effort(restarts=4, sweeps=70, tries=3)
    assert effort.on(10) == effort
    assert effort.on(LARGE // 2) == Effort(restarts=2, sweeps=70, tries=2)
    assert effort.on(2 * LARGE) == Effort(restarts=1, sweeps=70, tries=1)
