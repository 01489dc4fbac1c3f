"""Algorithm 4 and the barrier flow: projection, energies, safe steps, and where each ends."""

import itertools

import numpy as np
import pytest
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import pose_bend_deg, pose_clearance
from polycubes import polycubes

import lineup as lu
from lineup.kinematics import QUARTER, Move
from lineup.motion import _bending, _descent, _linkage, _safety, algorithm4, thick

# Zero energy and zero gradient, but not straight.
FOUR = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]

# The energy of its projection along y has a minimum that is not straight.
TRAPPED = [(1, 2, 1), (1, 2, 0), (1, 2, -1), (0, 2, -1), (0, 2, 0), (0, 2, 1), (0, 1, 1)]
TRAPPED += [(0, 0, 1), (0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 1, -1), (1, 0, -1), (1, 0, 0)]


def spiral(n_bars):
    """A square spiral in the plane y = 0, its windings one apart."""
    runs = [length // 2 for length in range(2, n_bars)]
    sides = np.repeat(np.arange(len(runs)) % 4, runs)[:n_bars]
    steps = np.array([(1, 0, 0), (0, 0, 1), (-1, 0, 0), (0, 0, -1)])[sides]
    return np.vstack([np.zeros((1, 3), int), steps.cumsum(axis=0)])


def walk(rng, n):
    """At most n voxels of a self-avoiding walk in a box, often crumpled."""
    path = [tuple(rng.integers(0, 4, 3).tolist())]
    while len(path) < n:
        steps = [tuple(np.add(path[-1], d).tolist()) for d in lu.grid.DIRECTIONS]
        free = [p for p in steps if p not in path and min(p) >= 0 and max(p) < 4]
        if not free:
            break
        path.append(free[rng.integers(len(free))])
    return np.array(path)


walks = st.builds(
    lambda seed, n: walk(np.random.default_rng(seed), n), st.integers(0, 2**32), st.integers(5, 40)
)
axes = st.sampled_from([0, 1, 2])


def nudged(linkage, seed, size=0.05):
    return _linkage.radians(linkage.start) + np.random.default_rng(seed).normal(
        0, size, len(linkage.start)
    )


def gap(place, p, q, r):
    """Distance of joint p from bar q to r, by the textbook."""
    bar = place[r] - place[q]
    t = np.clip((place[p] - place[q]) @ bar / max(bar @ bar, 1e-300), 0, 1)
    return np.linalg.norm(place[p] - place[q] - t * bar)


def twin_energy(voxels, axis, place):
    """Section 6: over bars vw and joints u not on them, of one depth; lone joints in pairs."""
    bars = np.diff(voxels, axis=0)
    across = bars[:, axis] == 0
    at = np.concatenate([[0], across.cumsum()])
    lone = [k for k in range(len(voxels)) if not across[max(k - 1, 0) : k + 1].any()]
    total = 0.0
    for v in np.flatnonzero(across):
        for u in range(len(voxels)):
            if u not in (v, v + 1) and voxels[u, axis] == voxels[v, axis]:
                a, b = place[at[u]] - place[at[v]], place[at[u]] - place[at[v + 1]]
                total += 1 / (np.hypot(*a) + np.hypot(*b) - 1) ** 2
    for u, v in itertools.combinations(lone, 2):
        if voxels[u, axis] == voxels[v, axis]:
            total += 1 / (2 * np.hypot(*(place[at[u]] - place[at[v]]))) ** 2
    return total


@given(walks, axes)
def test_a_projection_starts_as_the_path_and_keeps_what_is_apart(voxels, axis):
    linkage = _linkage.project(voxels, axis)
    plane = voxels[:, [(axis + 1) % 3, (axis + 2) % 3]]
    place = _linkage.placed(_linkage.radians(linkage.start)) + plane[0]
    distinct = np.vstack([plane[:1], plane[1:][np.diff(voxels[:, axis]) == 0]])
    np.testing.assert_allclose(place, distinct, atol=1e-9)
    assert (np.abs(np.diff(linkage.start)) <= 2 * QUARTER).all()
    assert _linkage.clearance(linkage, place) >= 1 - 1e-9
    np.testing.assert_array_equal(
        linkage.corners, np.flatnonzero(np.diff(np.flatnonzero(np.diff(voxels[:, axis]) == 0)) == 1)
    )


@given(walks, axes, st.integers(0, 99))
@settings(max_examples=30)
def test_the_energy_is_its_definition_and_the_gradient_its_derivative(voxels, axis, seed):
    linkage = _linkage.project(voxels, axis)
    angles = nudged(linkage, seed)
    place = _linkage.placed(angles)
    value, _ = algorithm4.elliptic_energy(linkage, place)
    assert value == pytest.approx(twin_energy(voxels, axis, place), rel=1e-9)
    check_gradient(algorithm4.energy_descent(linkage).objective, angles)


def check_gradient(objective, angles, step=1e-6):
    value, gradient = objective(angles)
    for b in range(len(angles)):
        ahead, behind = angles.copy(), angles.copy()
        ahead[b] += step
        behind[b] -= step
        slope = (objective(ahead)[0] - objective(behind)[0]) / (2 * step)
        assert gradient[b] == pytest.approx(slope, abs=1e-5 * max(1.0, abs(value)), rel=1e-4)


@given(walks, axes, st.integers(0, 99))
@settings(max_examples=30)
def test_the_barrier_has_its_derivative_and_is_infinite_where_bars_touch(voxels, axis, seed):
    linkage = _linkage.project(voxels, axis)
    angles = nudged(linkage, seed, 0.01)
    place = _linkage.placed(angles)
    low = 0.9 * min(1.0, _linkage.clearance(linkage, place))
    assert _linkage.clearance(linkage, place) == pytest.approx(
        min((gap(place, *row) for row in linkage.pairs[: linkage.n_apart]), default=np.inf)
    )
    objective = thick.barrier_descent(linkage, low).objective
    if np.isfinite(objective(angles)[0]) and len(angles):
        check_gradient(objective, angles, 1e-7)
    if linkage.n_apart:
        touching = _linkage.clearance(linkage, place) + 1e-9
        assert thick.contact_barrier(linkage, place, touching)[0] == np.inf


@given(walks, axes, st.integers(0, 99), st.floats(0.001, 2), st.floats(0.05, 0.999))
@settings(max_examples=60)
def test_a_safe_share_is_safe_and_not_timid(voxels, axis, seed, size, diameter):
    linkage = _linkage.project(voxels, axis)
    angles = _linkage.radians(linkage.start)
    if not len(angles):
        return
    turn = np.random.default_rng(seed).normal(0, size, len(angles))
    share = _safety.safe_share(linkage, angles, turn, diameter)
    times = np.linspace(0, 1, 200)
    gaps = [_linkage.clearance(linkage, _linkage.placed(angles + t * share * turn)) for t in times]
    assert min(gaps) >= diameter - 1e-9
    assert share > 0
    total = np.abs(turn).sum()
    assert share >= min(1.0, (1 - diameter) / (2 * total))


def test_a_share_ends_before_bars_cross():
    voxels = np.array([(0, 0, 0), (1, 0, 0), (2, 0, 0), (2, 0, 1), (1, 0, 1), (0, 0, 1)])
    linkage = _linkage.project(voxels, 1)
    shut = np.array([0, 0, 0, 0, -QUARTER], float) * np.pi / 2 / QUARTER
    share = _safety.safe_share(linkage, _linkage.radians(linkage.start), shut, 0.5)
    assert 0.1 < share < 0.5  # the last bar turns onto the first
    row = linkage.start + np.array([0, 0, 0, 0, -QUARTER], np.int32)
    assert not _safety.passes(linkage, linkage.start, row, 0.5)


@given(walks, axes, st.integers(0, 99))
def test_whole_ticks_keep_bends(voxels, axis, seed):
    linkage = _linkage.project(voxels, axis)
    row = _bending.ticks(nudged(linkage, seed), linkage.corners, QUARTER)
    assert (np.abs(row[linkage.corners + 1] - row[linkage.corners]) <= QUARTER).all()
    assert _linkage.largest_bend(linkage, row) <= 90


def check_bending(motion, samples=12):
    """Poses keep what the motion says, also to the judge; its last is a line if it says so."""
    verdict = lu.certify(motion, diameter=motion.diameter, max_bend_deg=motion.max_bend_deg)
    assert verdict.ok == motion.straight, verdict.reason
    assert verdict.moves_checked == len(motion), verdict.reason
    poses = list(lu.frames(motion, substeps=samples))
    assert min(map(pose_clearance, poses)) >= motion.diameter
    assert max(map(pose_bend_deg, poses)) <= motion.max_bend_deg + 1e-6
    assert (pose_bend_deg(poses[-1]) < 1e-9) == motion.straight == (motion.reason == "straight")
    lengths = np.linalg.norm(np.diff(poses, axis=1), axis=2)
    np.testing.assert_allclose(lengths, 1, atol=1e-9)
    assert set(motion.moves[:-1, 0]) <= {Move.BEND}


@given(polycubes(40), st.sampled_from(["energy", "barrier"]))
@examples(40)
def test_motions_of_layered_paths_keep_what_they_say(occupancy, method):
    if occupancy.sum() < 2:
        return
    path = lu.layered_path(lu.VoxelSolid(occupancy))
    check_bending(lu.unfold(path, method, steps=300))


@given(walks, axes, st.sampled_from(["energy", "barrier"]))
@examples(60)
def test_motions_of_walks_keep_what_they_say(voxels, axis, method):
    options = {"axis": axis} if method == "energy" else {"axes": (axis,)}
    check_bending(lu.unfold(lu.VoxelPath(voxels), method, steps=60, **options))


@pytest.mark.parametrize("method", ["energy", "barrier"])
@pytest.mark.parametrize("shape", [(4, 4, 3), (1, 1, 5), (1, 5, 1), (5, 1, 1), (2, 1, 1)])
def test_solids_without_loops_are_straightened(method, shape):
    motion = lu.unfold(lu.layered_path(lu.VoxelSolid(np.ones(shape, bool))), method)
    assert motion.straight
    assert motion.diameter == 0.999
    assert motion.max_bend_deg == 90
    check_bending(motion, samples=40)


@pytest.mark.parametrize("method", ["energy", "barrier"])
def test_the_same_input_gives_the_same_bytes(method):
    path = lu.VoxelPath(spiral(40))
    a, b = (lu.unfold(path, method, steps=40) for _ in range(2))
    assert a.angles.tobytes() == b.angles.tobytes()
    assert a.moves.tobytes() == b.moves.tobytes()


def test_four_voxels_have_neither_energy_nor_gradient():
    linkage = _linkage.project(np.array(FOUR), 1)
    descent = algorithm4.energy_descent(linkage)
    assert descent.value == 0
    assert not descent.gradient.any()
    motion = lu.unfold(lu.VoxelPath(np.array(FOUR)), "energy")
    assert (motion.straight, len(motion)) == (False, 0)
    assert motion.reason == "stationary after 0 steps at straightness 0.00"


def test_a_stationary_point_that_is_not_straight():
    linkage = _linkage.project(np.array(TRAPPED), 1)
    descent = algorithm4.energy_descent(linkage)
    run = descent.run(5_000)
    assert run.reason.startswith("stationary")
    assert _linkage.straightness(_linkage.placed(descent.angles)) < 0.5
    assert np.abs(descent.gradient).max() < 1e-6
    columns = []
    for unit in np.eye(len(descent.angles)):
        ahead, behind = (descent.objective(descent.angles + s * unit)[1] for s in (1e-5, -1e-5))
        columns.append((ahead - behind) / 2e-5)
    curvature = np.linalg.eigvalsh((np.array(columns) + np.transpose(columns)) / 2)
    assert curvature.min() > -1e-4  # turned as a whole, the energy stays


@pytest.mark.parametrize("most_turn", [_descent.MOST_TURN, _descent.MOST_TURN / 10])
def test_bars_of_a_spiral_come_nearer_than_at_first(monkeypatch, most_turn):
    monkeypatch.setattr(_descent, "MOST_TURN", most_turn)
    motion = lu.unfold(lu.VoxelPath(spiral(120)), "energy")
    poses = list(lu.frames(motion, substeps=4))
    assert motion.straight
    assert min(map(pose_clearance, poses)) < 0.95
    assert max(map(pose_bend_deg, poses)) > 90.5
    assert motion.diameter < 0.95
    assert motion.max_bend_deg > 90.5


@pytest.mark.parametrize(
    ("method", "options", "message"),
    [
        ("energy", {"axis": 3}, "axis must be 0, 1 or 2, got 3"),
        ("energy", {"steps": -1}, "steps must be at least 0, got -1"),
        ("barrier", {"steps": -1}, "steps must be at least 0, got -1"),
        ("barrier", {"axes": ()}, "axes must be some of 0, 1 and 2"),
        ("barrier", {"axes": (1, 4)}, "axes must be some of 0, 1 and 2"),
        ("barrier", {"diameter": 1.0}, "diameter must be above 0 and below 1, got 1.0"),
    ],
)
def test_bad_options_are_named(method, options, message):
    with pytest.raises(ValueError, match=message):
        lu.unfold(lu.VoxelPath(np.array(FOUR)), method, **options)
