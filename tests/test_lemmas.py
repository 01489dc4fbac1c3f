"""The lemmas of docs/motion.md on single moves, by sampling all pairs of bars on random paths.

Each is run with its hypothesis, and broken without it.
"""

import itertools

import numpy as np
import pytest
from examples import examples
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from oracles import pose_bend_deg, pose_clearance, sampled_move, segment_distances
from polycubes import STEPS
from walks import beside, closes_a_u, paths, walks, way

import lineup as lu
from lineup import grid, kinematics
from lineup.kinematics import Move

CORNER, U = np.sqrt(2) - 0.5, np.sqrt(3) / 2
EXACT, DEG = 1e-9, 1e-6
EAST, NORTH, UP, WEST, SOUTH, DOWN = range(6)


def word(letters, origin=(0, 0, 0)):
    steps = [grid.DIRECTIONS[grid.LETTERS.index(c)] for c in letters]
    return np.vstack([origin, *steps]).cumsum(axis=0)


def single(start, row, poses=((),)):
    return lu.Motion(
        start, np.array([row], int), 1.0, 90.0, False, "one move", np.array(poses, np.int8)
    )


def sampled(start, row, samples=33):
    """Least distance of bars two or more apart, and largest bend, at moments of one move."""
    trial = single(start, row)
    moments = np.linspace(0, 1, samples)
    poses = [kinematics.moved(start.astype(float), trial.moves[0], trial, t) for t in moments]
    k, m = np.triu_indices(len(start) - 1, 2)
    ends = [np.concatenate([pose[joint] for pose in poses]) for joint in (k, k + 1, m, m + 1)]
    return segment_distances(*ends).min(initial=np.inf), max(map(pose_bend_deg, poses))


def sampled_finely(start, row):
    """The same, the lowest samples refined."""
    trial = single(start, row)
    return sampled_move(trial, start.astype(float), trial.moves[0], samples=257)


def taken(voxels):
    return {tuple(v) for v in voxels.tolist()}


# Lemma 1: lattice poses, and bars two apart -------------------------------------------------------


@given(paths())
@examples(140)
def test_a_lattice_pose_has_clearance_one(pose):
    assert pose_clearance(pose.astype(float)) == 1


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=40)
def test_bars_beside_a_bar_keep_its_length_apart_where_no_bend_exceeds_90(seed):
    u, v, w = np.random.default_rng(seed).normal(size=(3, 200, 3))
    u, v, w = (x / np.linalg.norm(x, axis=1)[:, None] for x in (u, v, w))
    at_most_90 = ((u * v).sum(axis=1) >= 0) & ((v * w).sum(axis=1) >= 0)
    zero = np.zeros_like(u)
    apart = segment_distances(-u, zero, v, v + w)
    assert (apart[at_most_90] >= 1 - EXACT).all()
    assert apart[~at_most_90].min() < 1  # two bends of 120 degrees would let them meet


# Lemma 2: pull-through ----------------------------------------------------------------------------


def pulls(pose, without_us=False):
    """Every pull by the last joint into a free voxel; the tail's voxel does not count as free."""
    last, voxels = len(pose) - 1, [tuple(v) for v in pose.tolist()]
    free = [v for v in beside(voxels[-1]) if v not in voxels]
    free = [v for v in free if not (without_us and closes_a_u(voxels, v))]
    return [(Move.PULL, last, 0, STEPS.index(tuple(np.subtract(v, voxels[-1])))) for v in free]


@given(walks(without_us=True), st.data())
@settings(max_examples=40, deadline=None)
def test_a_pull_without_a_u_keeps_its_clearance_and_bend(start, data):
    rows = pulls(start, without_us=True)
    assume(rows)
    clearance, bend_deg = sampled(start, data.draw(st.sampled_from(rows)))
    assert clearance >= CORNER - EXACT
    assert bend_deg <= 90 + DEG


@given(paths(), st.data())
@examples(80)
def test_a_pull_of_any_simple_path_keeps_its_clearance_and_bend(start, data):
    rows = pulls(start)
    assume(rows)
    clearance, bend_deg = sampled(start, data.draw(st.sampled_from(rows)))
    assert clearance >= U - EXACT
    assert bend_deg <= 120 + DEG


def test_both_bounds_of_the_pull_are_met():
    """The head turns a corner with a voxel in its crook; a chain glides round a U."""
    clearance, bend_deg = sampled_finely(word("DSWUNN"), (Move.PULL, 6, 0, EAST))
    assert clearance == pytest.approx(CORNER, abs=EXACT)
    assert bend_deg == pytest.approx(90, abs=DEG)
    clearance, bend_deg = sampled_finely(word("EESWW"), (Move.PULL, 5, 0, WEST))
    assert clearance == pytest.approx(U, abs=EXACT)
    assert bend_deg == pytest.approx(120, abs=0.01)


def test_a_pull_onto_the_chain_goes_through_it():
    """The hypothesis that the track is simple: neither a joint's voxel nor yet the tail's."""
    onto_a_joint = sampled(word("EEENNWWS"), (Move.PULL, 8, 0, SOUTH))
    assert onto_a_joint[0] < EXACT
    onto_the_tail = sampled(word("EENNWWS")[:8], (Move.PULL, 7, 0, SOUTH))
    assert onto_the_tail[0] < CORNER - 0.1


@given(walks(max_bars=10), st.sampled_from(STEPS))
@examples(80)
def test_pulls_along_a_free_ray_end_in_a_straight_line(start, exit_step):
    ray = start[-1] + np.outer(np.arange(1, len(start)), exit_step)
    assume(not taken(ray) & taken(start))
    last, d = len(start) - 1, STEPS.index(exit_step)
    rows = np.array([(Move.PULL, last, 0, d)] * last)
    poses = list(lu.frames(lu.Motion(start, rows, U, 120.0, True, "straight"), substeps=7))
    assert pose_bend_deg(poses[-1]) == 0
    assert min(pose_clearance(p) for p in poses) >= U - EXACT
    for pose in poses:
        assert np.allclose(np.linalg.norm(np.diff(pose, axis=0), axis=1), 1, atol=1e-12)


# Lemma 3: the accordion ---------------------------------------------------------------------------


def tilted(bars, towards):
    return np.full((1, len(bars)), towards, np.int8)


@given(walks(max_bars=20), st.integers(0, 5))
@examples(140)
def test_a_tilt_of_a_monotone_path_brings_no_two_points_nearer(start, against):
    # What is left of a walk without its steps against one direction is monotone, hence simple.
    bars = grid.bar_directions(start)
    bars = bars[bars != against]
    towards = (against + 3) % 6
    assume(len(bars) > 2 and (bars != towards).any())
    start = np.vstack([np.zeros(3, int), grid.DIRECTIONS[bars]]).cumsum(axis=0)
    assume(len(taken(start)) == len(start))
    trial = single(start, (Move.TILT, 0, len(bars), 0), tilted(bars, towards))
    poses = [
        kinematics.moved(start.astype(float), trial.moves[0], trial, t)
        for t in np.linspace(0, 1, 12)
    ]
    for before, after in itertools.pairwise(poses):
        assert (points_apart(after) >= points_apart(before) - EXACT).all()
        assert (cosines(after) >= cosines(before) - EXACT).all()
        assert pose_clearance(after) >= pose_clearance(before) - EXACT
    assert pose_bend_deg(poses[-1]) < DEG


def points_apart(pose):
    """Distances of all pairs of points, five on each bar."""
    bars = np.diff(pose, axis=0)
    points = np.concatenate([pose[:-1] + s * bars for s in np.linspace(0, 1, 5)])
    return np.linalg.norm(points[:, None] - points[None], axis=2)


def cosines(pose):
    """Of the bends."""
    bars = np.diff(pose, axis=0)
    return (bars[1:] * bars[:-1]).sum(axis=1)


@given(walks(max_bars=12), st.integers(0, 5))
@settings(max_examples=40, deadline=None)
def test_a_tilt_of_a_path_that_is_not_monotone_ends_bent_back(start, towards):
    bars = grid.bar_directions(start)
    against = bars == (towards + 3) % 6
    assume(against.any() and not (against | (bars == towards)).all())
    target = np.where(against, bars, towards).astype(np.int8)[None]
    trial = single(start, (Move.TILT, 0, len(bars), 0), target)
    poses = list(lu.frames(trial, substeps=12))
    assert pose_bend_deg(poses[-1]) == 180
    assert min((points_apart(p) - points_apart(poses[0])).min() for p in poses) < -0.5


# Lemma 4: peels and swings ------------------------------------------------------------------------


def peel_is_free(pose, b, d):
    """The rule of a peel of joint b: its box holds no joint at rest but the pivot."""
    n_rod = len(pose) - 1 - b
    up = np.outer(np.arange(1, n_rod + 2), grid.DIRECTIONS[d])
    box = taken(pose[b - 1] + up) | taken(pose[b] + up[-1:])
    return box.isdisjoint(taken(pose[:b]))


def swing_is_free(pose, b, f):
    """The rule of a swing about joint b: its sector holds no joint at rest but the pivot."""
    n_rod = len(pose) - 1 - b
    d = pose[b + 1] - pose[b]
    sector = {
        tuple(pose[b] + u * d + v * grid.DIRECTIONS[f])
        for u, v in np.ndindex(n_rod + 1, n_rod + 1)
        if u * u + v * v < (n_rod + 1) ** 2
    }
    return sector.isdisjoint(taken(pose[:b]))


def led(draw, start, goal, past):
    """A way from a joint to a voxel past others, from the far end on."""
    found = way(start, goal, past, draw(st.permutations(range(6))))
    assume(found)
    return np.array(found[::-1])


@st.composite
def rods(draw, sideways):
    """A path that ends at joint b in a rod, and a direction across it.

    What rests begins somewhere near what the rod sweeps in that direction, or sideways of it.
    Joint b - 1 lies in that direction, to be the pivot of a peel, or anywhere, for a swing.
    """
    n_rod = draw(st.integers(int(not sideways), 4))
    d, f = draw(st.sampled_from([(d, f) for d in range(6) for f in range(6) if d % 3 != f % 3]))
    up, across = grid.DIRECTIONS[[d, f]]
    back = f if sideways else draw(st.sampled_from([k for k in range(6) if k != d]))
    q = grid.DIRECTIONS[back]
    rod = np.outer(np.arange(n_rod + 1), up)
    far = draw(st.sampled_from([n_rod + 1, *range(-1, n_rod + 3)])) * up
    far = far + draw(st.integers(-1, 2 if sideways else n_rod + 2)) * across
    far = far + draw(st.sampled_from([0, 0, 0, 1])) * np.cross(up, across)
    past = taken(rod)
    if draw(st.booleans()):  # so that it comes no nearer than the rim
        inner = [q + k * up for k in range(1, n_rod + 2)]
        if not sideways:
            shares = np.ndindex(n_rod + 1, n_rod + 1)
            inner = [u * up + v * across for u, v in shares if u * u + v * v <= n_rod**2]
        past |= {tuple(v) for v in inner if (v != q).any()}
    assume(tuple(far) not in past)
    rest = led(draw, tuple(q.tolist()), tuple(far.tolist()), past)
    return np.vstack([rest, rod]), len(rest), d, f


def at_either_end(pose, row, data):
    """The same move of the same shape, by the first joint's end if the draw says so."""
    kind, joint, other, value = row
    if data.draw(st.booleans()):
        return pose, row
    last = len(pose) - 1
    return pose[::-1].copy(), (kind, last - joint, last - other, value)


def is_free(clearance, bend_deg):
    return clearance >= 1 - EXACT and bend_deg <= 90 + DEG


@given(rods(sideways=True), st.data())
@examples(220)
def test_a_peel_is_free_of_collisions_exactly_where_its_box_is(rod, data):
    start, b, d, _ = rod
    pose, row = at_either_end(start, (Move.PEEL, b - 1, b, d), data)
    assert is_free(*sampled(pose, row)) == peel_is_free(start, b, d)


@given(rods(sideways=False), st.data())
@examples(160)
def test_a_swing_is_free_of_collisions_exactly_where_its_sector_is(rod, data):
    start, b, _, f = rod
    pose, row = at_either_end(start, (Move.SWING, b, b + 1, f), data)
    assert is_free(*sampled(pose, row)) == swing_is_free(start, b, f)


def test_the_tip_of_a_rod_rises_past_a_voxel_that_a_single_bar_would_not_meet():
    """Were only the voxel beside joint b asked for, whatever the rod, bars would come to .414."""
    pose, b = word("EDDDWWUEU", origin=(1, 0, 2)), 8
    q_ray = taken(pose[b - 1] + np.outer([1, 2], grid.DIRECTIONS[UP]))
    beside_b = tuple(pose[b] + grid.DIRECTIONS[UP])
    assert (q_ray | {beside_b}).isdisjoint(taken(pose[:b]))
    assert not peel_is_free(pose, b, UP)
    clearance, bend_deg = sampled_finely(pose, (Move.PEEL, b - 1, b, UP))
    assert clearance == pytest.approx(np.sqrt(2) - 1, abs=EXACT)
    assert bend_deg <= 90 + DEG


def test_two_rods_cross_where_a_ray_is_free_of_folded_joints_only():
    """Joints 3 to 7 are folded; the rod of joint 8 would go through the rod of joint 3."""
    pose, b = word("DDDEEUUNWW", origin=(0, 0, 3)), 8
    ray = taken(pose[b - 1] + np.outer(np.arange(1, 4), grid.DIRECTIONS[WEST]))
    assert ray.isdisjoint(taken(pose[3:b]))
    assert not peel_is_free(pose, b, WEST)
    assert sampled(pose, (Move.PEEL, b - 1, b, WEST))[0] < EXACT


# Lemma 5: doors, and what holds for every quarter turn --------------------------------------------


def doors(pose):
    """Every door about a lattice line that does not hold all its joints."""
    for i, j in itertools.combinations(range(len(pose)), 2):
        apart = np.abs(pose[j] - pose[i])
        if apart.max() == apart.sum() < j - i:
            yield from ((Move.DOOR, i, j, value) for value in (1, -1))


def turned(pose, row):
    """The lattice pose after a move."""
    trial = single(pose, row)
    return np.rint(kinematics.moved(pose.astype(float), trial.moves[0], trial, 1.0)).astype(int)


def rings_are_free(pose, i, j):
    """Whether no joint at rest lies within one voxel of a circle on which a joint of the limb runs.

    Only joints of one height along the axis count.
    """
    axis = int(np.abs(pose[j] - pose[i]).argmax())
    off = np.delete(pose - pose[i], axis, axis=1)
    radius, height = np.hypot(*off.T), pose[:, axis]
    limb, rest = np.arange(i + 1, j), np.r_[: i + 1, j : len(pose)]
    limb = limb[radius[limb] > 0]
    near = np.abs(radius[limb, None] - radius[None, rest]) < 1 - EXACT
    return not (near & (height[limb, None] == height[None, rest])).any()


@st.composite
def limbs(draw):
    """A path that leaves a line and comes back to it, and the door of that limb.

    What rests begins somewhere near a ring on which the limb runs.
    """
    deep, wide = draw(st.integers(1, 3)), draw(st.integers(1, 3))
    limb = word("N" * deep + "E" * wide + "S" * deep)
    rest = word("E" * draw(st.integers(0, 2)), origin=(wide + 1, 0, 0))
    reach = st.integers(-deep - 1, deep + 1)
    far = (draw(st.integers(0, wide)), draw(reach), draw(reach))
    before = (-1, 0, 0)
    past = taken(limb) | taken(rest)
    assume(far not in past)
    start = np.vstack([led(draw, before, far, past), limb, rest])
    joint = len(start) - len(rest) - len(limb)
    return start, (Move.DOOR, joint, joint + len(limb) - 1, draw(st.sampled_from([1, -1])))


@given(limbs())
@examples(120)
def test_a_door_whose_rings_are_free_keeps_clear(limb):
    start, row = limb
    assert row in list(doors(start))
    assume(rings_are_free(start, *row[1:3]))
    after = turned(start, row)
    assert len(taken(after)) == len(after)
    clearance, bend_deg = sampled(start, row)
    assert clearance >= 1 - EXACT
    assert bend_deg <= 90 + DEG


def test_a_door_that_shares_a_ring_may_touch():
    pose = word("DDESENUWU")
    row = (Move.DOOR, 3, 6, -1)
    assert row in list(doors(pose))
    assert not rings_are_free(pose, 3, 6)
    assert sampled(pose, row)[0] < EXACT


def quarter_turns(pose):
    """Every peel, swing and door of a pose."""
    for joint, other in itertools.chain(
        zip(range(len(pose) - 1), range(1, len(pose)), strict=True),
        zip(range(1, len(pose)), range(len(pose) - 1), strict=True),
    ):
        along = int(np.abs(pose[other] - pose[joint]).argmax())
        for kind, d in itertools.product((Move.PEEL, Move.SWING), range(6)):
            if d % 3 != along:
                yield kind, joint, other, d
    yield from doors(pose)


@given(paths(), st.data())
@examples(80)
def test_a_quarter_turn_bends_most_at_its_two_ends(start, data):
    row = data.draw(st.sampled_from(list(quarter_turns(start))))
    before, after = pose_bend_deg(start), pose_bend_deg(turned(start, row))
    assert sampled(start, row, samples=17)[1] == pytest.approx(max(before, after), abs=DEG)


@given(paths(), st.data())
@settings(max_examples=40, deadline=None)
def test_in_a_quarter_turn_only_bars_that_share_a_height_come_nearer_than_one(start, data):
    row = data.draw(st.sampled_from(list(quarter_turns(start))))
    trial = single(start, row)
    kind, joint, other, value = row
    bar = (start[other] - start[joint]).astype(float)
    axis = bar if kind == Move.DOOR else np.cross(bar, grid.DIRECTIONS[value])
    height = start @ np.rint(axis / np.linalg.norm(axis))
    k, m = np.triu_indices(len(start) - 1, 2)
    low, high = np.minimum(height[:-1], height[1:]), np.maximum(height[:-1], height[1:])
    apart = (low[k] > high[m]) | (low[m] > high[k])
    for t in np.linspace(0, 1, 17):
        pose = kinematics.moved(start.astype(float), trial.moves[0], trial, t)
        distances = segment_distances(pose[k], pose[k + 1], pose[m], pose[m + 1])
        assert (distances[apart] >= 1 - EXACT).all()
