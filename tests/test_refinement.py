"""The two refinement theorems: nothing is left out, whatever the solid."""

import itertools
import os
from dataclasses import replace

import numpy as np
import pytest
from contracts import check_path
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import edges_on_squares, simple_paths_from, voxel_graph
from polycubes import polycubes

import lineup as lu
from lineup import grid, refinement
from lineup.refinement import _CUBE, _CUBE_CORNER, _CUBE_EDGE


def solid_of(voxels):
    points = np.array(voxels)
    occupancy = np.zeros(points.max(axis=0) + 1, bool)
    occupancy[tuple(points.T)] = True
    return lu.VoxelSolid(occupancy)


PLUS = [(1, 0, 0), (0, 1, 0), (1, 1, 0), (2, 1, 0), (1, 2, 0)]
SOLIDS = {
    "one voxel": solid_of([(0, 0, 0)]),
    "two side by side": solid_of([(0, 0, 0), (1, 0, 0)]),
    "two in a row": solid_of([(0, 0, 0), (0, 1, 0)]),
    "one on the other": solid_of([(0, 0, 0), (0, 0, 1)]),
    "column": solid_of([(0, 0, z) for z in range(9)]),
    "plane": lu.VoxelSolid(np.ones((7, 6, 1), bool)),
    "plus with a tower": solid_of([*PLUS, (1, 1, 1), (1, 1, 2)]),
    "plus between towers": solid_of(
        [(x, y, 2) for x, y, _ in PLUS] + [(1, 1, z) for z in range(5)]
    ),
    "arch": solid_of([(0, 0, 0), (2, 0, 0), (0, 0, 1), (1, 0, 1), (2, 0, 1)]),
    "ring": lu.VoxelSolid(np.abs(np.mgrid[-2:3, -2:3, :3])[:2].max(axis=0) == 2),
    "in a wide grid": lu.VoxelSolid(np.pad(np.ones((2, 1, 3), bool), 2)),
}


def split(occupancy, k):
    """Every voxel cut in k^3, one by one."""
    fine = np.zeros(np.multiply(occupancy.shape, k), bool)
    for x, y, z in np.argwhere(occupancy) * k:
        fine[x : x + k, y : y + k, z : z + k] = True
    return fine


def path_edges(voxels):
    return {frozenset(pair) for pair in itertools.pairwise(map(tuple, voxels.tolist()))}


def check_all_visited(path, solid, k):
    check_path(path, solid)
    fine = split(solid.occupancy, k)
    assert path.refinement == k
    assert len(path) == fine.sum()
    assert len(path.dropped) == 0
    fine[tuple(path.voxels.T)] = False
    assert not fine.any()
    ends = path.voxels[[0, -1]]
    assert np.abs(ends[1] - ends[0]).sum() == 1
    assert (ends[:, 2] == path.voxels[:, 2].max()).all()


def check_refined(path, solid):
    """Every excursion comes back, so that both ends lie in the first piece."""
    assert path.method == "refined"
    check_all_visited(path, solid, 2)
    assert path.visits[[0, -1], 2:].tolist() == [[0, 0], [0, 0]]
    assert (np.abs(np.diff(path.visits[:, 3])) == 1).all()


def check_refined4(path, solid):
    assert path.method == "refined4"
    check_all_visited(path, solid, 4)
    assert max(edges_on_squares(path_edges(path.voxels)).values()) <= 2


@pytest.mark.parametrize("name", SOLIDS)
def test_small_solids(name):
    solid = SOLIDS[name]
    check_refined(lu.layered_path(solid, "refined"), solid)
    check_refined4(lu.layered_path(solid, "refined4"), solid)


@examples(300)
@given(polycubes(60), st.integers(0, 99))
def test_refined_leaves_out_nothing(occupancy, seed):
    solid = lu.VoxelSolid(occupancy)
    check_refined(lu.layered_path(solid, "refined", seed), solid)


@examples(120)
@given(polycubes(20), st.integers(0, 99))
def test_refined4_leaves_out_nothing_and_has_no_u(occupancy, seed):
    solid = lu.VoxelSolid(occupancy)
    check_refined4(lu.layered_path(solid, "refined4", seed), solid)


@pytest.mark.slow
@settings(max_examples=1000)
@given(polycubes(120), st.integers(0, 99))
def test_a_thousand_polycubes(occupancy, seed):
    solid = lu.VoxelSolid(occupancy)
    check_refined(lu.layered_path(solid, "refined", seed), solid)
    check_refined4(lu.layered_path(solid, "refined4", seed), solid)


def cube_edges(corner):
    steps = np.array([grid.DIRECTIONS[grid.LETTERS.index(letter)] for letter in _CUBE])
    voxels = np.vstack([corner, corner + np.cumsum(steps, axis=0)])
    return path_edges(voxels)


def test_the_cycle_of_the_cube():
    """Through all 64 parts, back to its start, and with no U."""
    edges = cube_edges(np.array([0, 0, 0]))
    assert len(_CUBE) == len(edges) == 64
    assert set().union(*edges) == set(itertools.product(range(4), repeat=3))
    assert max(edges_on_squares(edges).values()) <= 2


def facing(direction, corner=(0, 0, 0)):
    """The edge of a cube that faces a direction, and the two steps to the next cube."""
    start = np.array(corner) + _CUBE_CORNER[direction]
    pair = [tuple(start.tolist()), tuple((start + grid.DIRECTIONS[_CUBE_EDGE[direction]]).tolist())]
    beyond = [tuple((np.array(p) + grid.DIRECTIONS[direction]).tolist()) for p in pair]
    return pair, beyond


@pytest.mark.parametrize("direction", range(3))
def test_edges_of_neighbouring_cubes_face_each_other(direction):
    pair, beyond = facing(direction)
    assert frozenset(pair) in cube_edges(np.array([0, 0, 0]))
    assert frozenset(beyond) in cube_edges(4 * grid.DIRECTIONS[direction])
    others = [set(part) for d in {0, 1, 2} - {direction} for part in facing(d)]
    assert all(set(pair).isdisjoint(other) for other in others)


@pytest.mark.parametrize("axes", [(0, 1), (0, 2), (1, 2)])
def test_no_u_in_any_way_to_join_four_cubes_around_a_line(axes):
    """The finite check in the proof of `refined4_path`."""
    a, b = (4 * grid.DIRECTIONS[axis] for axis in axes)
    cubes = set().union(*(cube_edges(corner) for corner in (0 * a, a, b, a + b)))
    joins = [facing(axes[0]), facing(axes[0], b), facing(axes[1]), facing(axes[1], a)]
    for chosen in itertools.product((False, True), repeat=4):
        edges = set(cubes)
        for pair, beyond in itertools.compress(joins, chosen):
            edges -= {frozenset(pair), frozenset(beyond)}
            edges |= {frozenset(step) for step in zip(pair, beyond, strict=True)}
        assert max(edges_on_squares(edges).values()) <= 2


def test_a_u_is_found():
    path = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 2, 0)])
    assert max(edges_on_squares(path_edges(path)).values()) == 3
    assert max(edges_on_squares(path_edges(path[:3])).values()) == 2
    solid = SOLIDS["plane"]
    refined = lu.layered_path(solid, "refined")
    assert max(edges_on_squares(path_edges(refined.voxels)).values()) == 3


def test_no_cycle_of_a_refined_plus_can_be_linked_to_a_tower():
    """Why `refined` needs several pieces in a node: see its docstring."""
    graph = voxel_graph(split(solid_of(PLUS).occupancy, 2)[:, :, :1], in_layer=True)
    middle = list(itertools.product((2, 3), (2, 3), (0,)))
    through_all = [p for start in middle for p in simple_paths_from(graph, start) if len(p) == 20]
    assert through_all
    assert not [p for p in through_all if p[-1] in middle and graph.has_edge(p[0], p[-1])]


@pytest.mark.parametrize("method", ["refined", "refined4"])
def test_the_seed_chooses_the_tree(method):
    solid = lu.VoxelSolid(np.ones((4, 3, 3), bool))
    first, again, other = (lu.layered_path(solid, method, seed) for seed in (3, 3, 4))
    assert first.voxels.tobytes() == again.voxels.tobytes()
    assert first.visits.tobytes() == again.visits.tobytes()
    assert first.voxels.tobytes() != other.voxels.tobytes()


@pytest.mark.parametrize("lost", range(4))
def test_lost_joins_are_found(monkeypatch, lost):
    """Without one kind of join there are several cycles, and the judge sees that one is left."""
    complete = refinement._square_joins

    def incomplete(net):
        joins = complete(net)
        return [*joins[:lost], *joins[lost + 1 :]]

    monkeypatch.setattr(refinement, "_square_joins", incomplete)
    solid = SOLIDS["plus with a tower"]
    verdict = lu.certify_path(lu.layered_path(solid, "refined"), solid)
    assert not verdict.ok
    assert "visit one voxel" in verdict.reason


def test_false_refinements_are_found():
    solid = SOLIDS["ring"]
    path = lu.layered_path(solid, "refined")
    for change in (
        {"refinement": 4},
        {"voxels": path.voxels[:-2]},
        {"visits": path.visits[:-1]},
        {"visits": np.column_stack([path.visits[:, :3], path.visits[:, 3] + 1])},
        {"visits": np.column_stack([path.visits[:, :2], path.visits[:, 2] * 0, path.visits[:, 3]])},
    ):
        assert not lu.certify_path(replace(path, **change), solid).ok


@given(polycubes(12), st.integers(1, 4))
def test_refine_splits_every_voxel(occupancy, k):
    solid = lu.VoxelSolid(occupancy, pitch=3.0, name="duck", source={"kind": "test"})
    fine = lu.refine(solid, k)
    assert np.array_equal(fine.occupancy, split(occupancy, k))
    assert (fine.pitch, fine.name) == (3.0 / k, "duck")
    assert fine.source == {"kind": "test", "refined": k}
    twice = lu.refine(fine, 2)
    assert np.array_equal(twice.occupancy, split(occupancy, 2 * k))
    assert twice.source["refined"] == 2 * k
    assert solid.source == {"kind": "test"}


@pytest.mark.parametrize("k", [0, -1, 1.5, "2"])
def test_refine_takes_positive_integers(k):
    with pytest.raises(ValueError, match="k must be a positive integer, got"):
        lu.refine(SOLIDS["arch"], k)


@pytest.mark.parametrize("method", ["refined", "refined4"])
def test_bad_use(method):
    with pytest.raises(ValueError, match="seed must be at least 0, got -1"):
        lu.layered_path(SOLIDS["arch"], method, seed=-1)
    with pytest.raises(ValueError, match="no option 'starts'"):
        lu.layered_path(SOLIDS["arch"], method, starts=1)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["refined", "refined4"])
def test_a_million_voxels(method):
    k = {"refined": 2, "refined4": 4}[method]
    n = 1e6 / k**3
    offsets = np.mgrid[-33:34, -33:34, -33:34]
    solid = lu.VoxelSolid((offsets**2).sum(axis=0) <= (n * 0.75 / np.pi) ** (2 / 3))
    path = lu.layered_path(solid, method)
    check_path(path, solid)
    assert len(path) == solid.size * k**3 > 9e5


@pytest.mark.slow
@pytest.mark.skipif(
    "LINEUP_MODELS" not in os.environ, reason="LINEUP_MODELS names no folder of meshes"
)
def test_real_models():
    models = lu.models()
    for name in models["name"][models["source"] == "folder"]:
        solid = lu.model(name, voxels=800)
        check_refined(lu.layered_path(solid, "refined"), solid)
        check_refined4(lu.layered_path(solid, "refined4"), solid)
