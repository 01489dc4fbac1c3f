"""The chain glides from shape to shape past obstacles: judge, way, planner, box."""

import dataclasses

import networkx as nx
import numpy as np
import pytest
from examples import examples
from hypothesis import assume, given
from hypothesis import strategies as st
from oracles import n_us
from polycubes import polycubes

import lineup as lu
from lineup.grid import DIRECTIONS, LETTERS, bar_directions
from lineup.kinematics import Move
from lineup.motion._ways import steps_to, ways
from lineup.transformation.gliding import NO_WAY, beside, glide


def walk(word, start=(0, 0, 0)):
    steps = DIRECTIONS[[LETTERS.index(c) for c in word]]
    return np.vstack([start, start + np.cumsum(steps, axis=0)])


def pulls(start, word):
    """The motion that pulls a chain by its last joint in the directions of a word."""
    last = len(start) - 1
    rows = [(Move.PULL, last, 0, LETTERS.index(c)) for c in word]
    return lu.Motion(start, np.array(rows), 0.866, 120.0, True, "straight")


def obstacles(cells):
    cells = np.atleast_2d(cells)
    low = cells.min(axis=0)
    occupancy = np.zeros(np.ptp(cells, axis=0) + 1, bool)
    occupancy[tuple((cells - low).T)] = True
    return lu.Obstacles(occupancy, low)


def box_about(track, margin=2):
    low, high = track.min(axis=0) - margin, track.max(axis=0) + margin
    return np.stack(np.indices(high - low + 1), axis=-1).reshape(-1, 3) + low


def without(cells, others):
    taken = set(map(tuple, np.asarray(others).tolist()))
    return np.array([c for c in cells.tolist() if tuple(c) not in taken])


def crooks(track):
    corner = np.diff(track, n=2, axis=0).any(axis=1)
    return (track[:-2] + track[2:] - track[1:-1])[corner]


def nearest(poses, cells):
    """Least distance of points all along the bars of some poses from some unit cubes."""
    points = np.concatenate(
        [pose[:-1] + s * np.diff(pose, axis=0) for pose in poses for s in np.linspace(0, 1, 9)]
    )
    apart = np.maximum(np.abs(points[:, None] - cells) - 0.5, 0)
    return np.sqrt((apart**2).sum(axis=2)).min()


def wander(seed, n_bars, n_pulls):
    """A crumpled chain, and the letters of pulls on along a simple track that ends straight."""
    rng = np.random.default_rng(seed)
    cells, word = [(0, 0, 0)], []
    while len(word) < n_bars + n_pulls:
        ahead = DIRECTIONS + cells[-1]
        free = [d for d in range(6) if tuple(ahead[d].tolist()) not in cells]
        if not free:
            return wander(seed + 1000, n_bars, n_pulls)
        word.append(int(rng.choice(free)))
        cells.append(tuple(ahead[word[-1]].tolist()))
    return np.array(cells[: n_bars + 1]), "".join(LETTERS[d] for d in word[n_bars:])


@pytest.mark.parametrize("seed", range(4))
def test_a_chain_needs_its_track_and_the_crooks_and_no_more(seed):
    """Walled in on all sides a glide keeps clear; each voxel the judge asks for, it enters."""
    start, word = wander(seed, 7, 5)
    trial = pulls(start, word)
    track = np.vstack([start, walk(word, start[-1])[1:]])
    needed = np.unique(np.vstack([track, crooks(track)]), axis=0)
    wall = without(box_about(track), needed)
    verdict = lu.certify(trial, 0.866, 120, obstacles=obstacles(wall))
    assert "obstacle" not in verdict.reason
    assert verdict.moves_checked == len(trial)
    poses = list(lu.frames(trial, substeps=16))
    assert nearest(poses, wall) >= 0.5 - 1e-9
    for cell in without(needed, start):
        verdict = lu.certify(trial, 0.866, 120, obstacles=obstacles(cell))
        assert "the pull meets an obstacle" in verdict.reason
        before, during = poses[: 16 * verdict.where + 1], poses[16 * verdict.where :][:17]
        assert nearest(before, cell) >= 0.5 - 1e-9
        assert nearest(during, cell) < 0.45


BENT = walk("EENN")
FAULTS = {
    "a blocked crook": (pulls(BENT, "NEEE"), 0.9, (3, 2, 0), 1, "voxel (3, 2, 0) in the crook"),
    "a crook at the start": (pulls(BENT, "NNNN"), 0.9, (1, 1, 0), 0, "voxel (1, 1, 0) in the"),
    "a blocked track": (pulls(BENT, "EEEE"), 0.9, (5, 2, 0), 2, "voxel (5, 2, 0) of the track"),
    "a start inside": (pulls(BENT, "NNNN"), 0.9, (2, 1, 0), -1, "joint 3 is inside an obstacle"),
    "thick bars": (pulls(BENT, "NNNN"), 1.1, (9, 9, 9), -1, "start: bars 0 and 2"),
    "no pull": (
        lu.Motion(BENT, np.array([(Move.SWING, 2, 3, 0)]), 0.9, 90.0, True, "straight"),
        *(0.9, (9, 9, 9), 0, "not judged beside obstacles"),
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_faults_are_found(name):
    trial, diameter, cell, where, reason = FAULTS[name]
    verdict = lu.certify(trial, diameter, 90, obstacles=obstacles(cell))
    assert not verdict.ok
    assert reason in verdict.reason
    assert verdict.where == where


def test_bars_thicker_than_a_voxel_are_not_judged_beside_obstacles():
    verdict = lu.certify(pulls(walk("EE"), "E"), 1.1, obstacles=obstacles((9, 9, 9)))
    assert "thicker than 1" in verdict.reason


def test_obstacles_may_be_anywhere_and_malformed_ones_are_refused():
    held = obstacles([(-3, 0, 5), (-2, 1, 5)]).holds(
        np.array([(-3, 0, 5), (-2, 1, 5), (-2, 0, 5), (0, 0, 0)])
    )
    assert held.tolist() == [True, True, False, False]
    with pytest.raises(ValueError, match="three integers"):
        lu.Obstacles(np.ones((1, 1, 1), bool), np.zeros(2, int))


@pytest.mark.parametrize("seed", range(12))
def test_a_way_is_as_short_as_can_be(seed):
    """Against networkx, with and without the lower bound; a longer one closes no U."""
    rng = np.random.default_rng(seed)
    shut = np.pad(rng.random((5, 5, 5)) < 0.35, 1, constant_values=True)
    free = np.argwhere(~shut)
    first, goal = (tuple(free[k].tolist()) for k in rng.choice(len(free), 2, replace=False))
    cells = [int(np.ravel_multi_index(c, shut.shape)) for c in (first, goal)]
    ends = np.zeros((6, shut.size), bool)
    ends[0, cells[1]] = True
    ahead = steps_to(np.array([cells[1]]), shut)
    graph = nx.grid_graph(shut.shape)
    graph.remove_nodes_from([tuple(c) for c in np.argwhere(shut).tolist()])
    for u_free in (False, True):
        found = [
            next(ways(shut, (cells[0], 0, 0), ends, None, bound, u_free=u_free), None)
            for bound in (None, ahead)
        ]
        assert (found[0] is None) == (found[1] is None)
        if found[0] is None:
            continue
        assert len(found[0][1]) == len(found[1][1])
        for way, steps in found:
            voxels = np.stack(np.unravel_index(way, shut.shape), axis=1)
            assert (bar_directions(voxels) == steps[:-1]).all() if len(way) > 1 else True
            assert not u_free or not n_us(voxels)
            assert len(way) - 1 >= nx.shortest_path_length(graph, first, goal)


def check_glide(motion, a, b, around=None):
    assert np.array_equal(motion.start, a)
    verdict = lu.certify(motion, motion.diameter, motion.max_bend_deg, obstacles=around)
    assert verdict.ok, verdict.reason
    *_, last = lu.frames(motion)
    assert np.array_equal(last, b)
    assert motion.diameter == (0.866 if n_us(a) or n_us(b) else motion.diameter)


@examples(48)
@given(polycubes(30), polycubes(30), st.integers(0, 5), st.integers(0, 5))
def test_it_ends_where_it_should(one, other, up, aside):
    assume(min(one.sum(), other.sum()) > 1)
    a, b = (lu.layered_path(lu.VoxelSolid(o), starts=1).voxels for o in (one, other))
    n = min(len(a), len(b))
    shift = np.array((int(a[:, 0].max()) + 3, aside, up))
    a, b = a[:n], b[:n] + shift
    motion = glide(a, b)
    if len(motion):
        check_glide(motion, a, b)
        assert motion.goal.tolist() == b.tolist()
    else:
        assert motion.reason == NO_WAY


def test_a_straight_tail_may_be_long():
    a = walk("E" * 300)
    b = walk("ENNWWUEE" + "E" * 292, (304, 3, 0))
    motion = glide(a, b)
    check_glide(motion, a, b)
    assert motion.moves[0, 1] == 300


def test_through_a_hole_and_not_through_a_wall():
    wall = np.ones((1, 15, 15), bool)
    corner = walk("UUNNEE")
    a, b = corner - 4 * DIRECTIONS[0], corner + 4 * DIRECTIONS[0]
    around = lu.Obstacles(wall, np.array((0, -7, -7)))
    assert glide(a, b, around).reason == NO_WAY
    wall[0, 7, 9] = False
    around = lu.Obstacles(wall, np.array((0, -7, -7)))
    motion = glide(a, b, around)
    check_glide(motion, a, b, around)
    plugged = dataclasses.replace(around, occupancy=np.ones_like(wall))
    assert not lu.certify(motion, 0.866, 120, obstacles=plugged).ok


@pytest.mark.parametrize(
    ("shift", "cell", "reason"),
    [
        ((1, 0, 0), (9, 9, 9), "overlap"),
        ((0, 0, 4), (0, 0, 0), "inside shape A"),
        ((0, 0, 4), (2, 1, 4), "inside shape B"),
        ((0, 0, 4), (1, 1, 4), "crook of a corner of shape B"),
    ],
)
def test_why_it_cannot_glide(shift, cell, reason):
    motion = glide(BENT, BENT + shift, obstacles(cell))
    assert reason in motion.reason
    assert len(motion) == 0


def test_paths_of_two_lengths_are_refused():
    with pytest.raises(ValueError, match="one length"):
        glide(BENT, BENT[:-1])


def folded(shape):
    return lu.fold(lu.VoxelSolid(np.ones(shape, bool)), "pull", sweeps=300, length=16)


def test_from_shape_to_shape_in_a_small_box():
    a, b = folded((4, 3, 3)), folded((6, 2, 3))
    assert len(a.path) == len(b.path) == 16
    within = (10, 7, 7)
    motion = lu.transform(a, b, within=within)
    assert motion.reason == "glides into its goal"
    verdict = lu.certify(motion, motion.diameter, motion.max_bend_deg, within=within)
    assert verdict.ok, verdict.reason
    assert lu.transform(a, b, within=(40, 40, 40)).diameter == motion.diameter
    refused = lu.transform(a, b, within=(4, 3, 3))
    assert "side by side the shapes take" in refused.reason
    places = list(beside(a.path.voxels, b.path.voxels, (9, 9, 9)))
    volumes = [int(np.prod(box)) for _, box in places]
    assert volumes == sorted(volumes)
    for place, box in places[::50]:
        both = np.vstack([a.path.voxels, place])
        assert np.array_equal(np.ptp(both, axis=0) + 1, box)
        assert len(np.unique(both, axis=0)) == len(both)
