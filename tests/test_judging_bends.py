"""Bends: bars turning evenly in angle, between lattice poses and poses that are none."""

import itertools

import numpy as np
import pytest
from examples import examples
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from oracles import pose_bend_deg, pose_clearance, sampled_move, segment_distances
from polycubes import blob
from test_judging import boustrophedon, walk
from test_judging_sampled import chains

import lineup as lu
from lineup.judging._approach import RESOLUTION
from lineup.judging._bends import lying
from lineup.kinematics import QUARTER, Move, moved

NEAR = 1e-6  # of the local refinement of samples
X, Y, Z = range(3)
THIRD = 2 * QUARTER // 3  # 60 degrees


def bent(start, axis, rows, straight=True, moves=None):
    """A motion through rows of angles, or by the given moves."""
    if moves is None:
        moves = [(Move.BEND, axis, k, k + 1) for k in range(len(rows) - 1)]
    rows = np.array(rows, np.int32)
    return lu.Motion(start, np.array(moves), 1.0, 90.0, straight, "bent", angles=rows)


def quarters(start, axis):
    return lying(np.array(start, np.int64), axis).angles


def opening(start, axis, target, steps):
    """Every bar across an axis turns from where it is to one angle, in equal steps."""
    before = quarters(start, axis)
    after = np.where(lying(np.array(start, np.int64), axis).along == 0, target, 0)
    return bent(start, axis, [before + (after - before) * k // steps for k in range(steps + 1)])


def reversed_bends(motion, straight):
    there = list(lu.frames(motion))[-1]
    moves = motion.moves[::-1, [0, 1, 3, 2]]
    return bent(np.rint(there).astype(int), 0, motion.angles, straight, moves)


STAIR = walk("ENEUENEUE")  # bars along z rest when it opens about z
GOOD = {
    "a U": opening(walk("ENW"), Z, 0, 1),
    "a U in steps": opening(walk("ENW"), Z, 0, 7),
    "a snake": opening(boustrophedon(6, 6, 1), Z, QUARTER, 1),
    "a snake in steps": opening(boustrophedon(6, 6, 1), Z, QUARTER, 5),
    "about x": opening(walk("NUSUN"), X, QUARTER, 2),
    "about y": opening(walk("EUEUEU"), Y, 0, 2),
}


@pytest.mark.parametrize("name", GOOD)
def test_good_bends_are_certified_both_ways(name):
    good = GOOD[name]
    there, back = lu.certify(good), lu.certify(reversed_bends(good, straight=False))
    for verdict in (there, back):
        assert (verdict.ok, verdict.reason) == (True, "certified")
        assert verdict.moves_checked == len(good)
        assert 1 - RESOLUTION <= verdict.clearance <= 1
        assert verdict.bend_deg == 90


def test_touching_blocks_open_without_a_tolerance():
    assert lu.certify(GOOD["a snake"], diameter=1.0).clearance == 1


@pytest.mark.parametrize("turn", [QUARTER // 3, -QUARTER, 4 * QUARTER, 2**31 - 4 * QUARTER])
def test_a_chain_that_turns_as_a_whole_keeps_its_distances(turn):
    start = boustrophedon(4, 3, 2)
    before = quarters(start, Y)
    after = np.where(lying(start.astype(np.int64), Y).along == 0, before + turn, 0)
    verdict = lu.certify(bent(start, Y, [before, after], straight=False), diameter=1.0)
    off = turn % QUARTER != 0
    wanted = "the last pose is off" if off else "ends not straight, and is straight nowhere"
    assert verdict.reason.startswith(wanted)
    assert (verdict.clearance, verdict.bend_deg, verdict.where) == (1, 90, -1)


def test_angles_count_modulo_a_full_turn():
    rows = GOOD["a U in steps"].angles + 4 * QUARTER * np.array([3, 0, -1])
    assert lu.certify(bent(walk("ENW"), Z, rows)).ok


def test_other_moves_may_follow_a_bend_that_ends_on_the_lattice():
    """A corner opens to a line seen from its last bar, which then swings up."""
    rows = [quarters(walk("ENN"), Z), np.array([0, QUARTER // 2, QUARTER // 2]), np.zeros(3, int)]
    moves = [(Move.BEND, Z, 0, 1), (Move.BEND, Z, 1, 2), (Move.SWING, 2, 3, 2)]
    assert lu.certify(bent(walk("ENN"), Z, rows, False, moves)).ok


def test_three_bars_have_distances_and_two_have_none():
    assert lu.certify(opening(walk("EN"), Z, 0, 1)).clearance == np.inf
    assert lu.certify(opening(walk("ENE"), Z, 0, 1)).clearance == 1


# Planted faults: the move that fails (-1: start or end), the judge's words.
U = walk("ENW")
ROWS = opening(U, Z, 0, 3).angles
HELIX = [
    (np.array([1, 1, 2, 2, 2, 3, 4, 4]) * QUARTER).tolist(),
    (np.array([0, 1, 2, 2, 3, 3, 4, 4]) * QUARTER).tolist(),
]
PASSES_THROUGH = bent(walk("NNWWWSEE"), Z, HELIX, straight=False)
# Bars 1 and 5 turn together, so that joints 0 and 9 circle each other at distance 1.
CIRCLING = bent(
    walk("UWUEUEDDD"),
    Z,
    [[0, 2 * QUARTER, 0, 0, 0, 0, 0, 0, 0], [0, 2 * QUARTER + THIRD, 0, 0, 0, THIRD, 0, 0, 0]],
    straight=False,
)


def altered(**fields):
    rows = fields.pop("rows", ROWS)
    return bent(fields.pop("start", U), Z, rows, moves=fields.pop("moves", None), **fields)


def with_row(k, row):
    rows = ROWS.copy()
    rows[k] = row
    return rows


STEP = [(Move.BEND, Z, 0, 1)]
FAULTS = {
    "wrong start row": (
        altered(rows=with_row(0, [0, QUARTER, 3 * QUARTER])),
        0,
        "malformed: (BEND, 2, 0, 1) starts with bar 2 at 786432 ticks, but it is at 524288",
    ),
    "start row off by a tick": (
        altered(rows=with_row(0, [0, QUARTER + 1, 2 * QUARTER])),
        0,
        "malformed: (BEND, 2, 0, 1) starts with bar 1 at 262145 ticks, but it is at 262144",
    ),
    "skipped keyframe": (
        altered(moves=[*STEP, (Move.BEND, Z, 2, 3)]),
        1,
        "malformed: (BEND, 2, 2, 3) starts with bar 1 at 87381 ticks, but it is at 174762",
    ),
    "no such row": (altered(moves=[(Move.BEND, Z, 0, 4)]), 0, "must name rows 0..3 of angles"),
    "negative row": (altered(moves=[(Move.BEND, Z, -1, 1)]), 0, "must name rows 0..3 of angles"),
    "no such axis": (altered(moves=[(Move.BEND, 3, 0, 1)]), 0, "must be about axis 0, 1 or 2"),
    "too few angles": (altered(rows=ROWS[:, :2]), 0, "needs angles of shape (K, 3), got (4, 2)"),
    "no angles": (
        altered(rows=np.empty((0, 0)), moves=STEP),
        0,
        "needs angles of shape (K, 3), got (0, 0)",
    ),
    "nothing turns": (altered(moves=[(Move.BEND, Z, 0, 0)]), 0, "must turn some bars"),
    "a bar along the axis turns": (
        altered(start=walk("ENU"), rows=[[0, QUARTER, 0], [0, 0, 7]], moves=STEP),
        0,
        "gives an angle to bar 2, which lies along its axis",
    ),
    "peel from between": (
        altered(moves=[*STEP, (Move.PEEL, 1, 2, 0)]),
        1,
        "malformed: (PEEL, 1, 2, 0) starts off the lattice",
    ),
    "tilt from between": (
        altered(moves=[*STEP, (Move.TILT, 0, 3, 0)]),
        1,
        "malformed: (TILT, 0, 3, 0) starts off the lattice",
    ),
    "another axis from between": (
        altered(moves=[*STEP, (Move.BEND, X, 1, 2)]),
        1,
        "malformed: (BEND, 0, 1, 2) must be about axis 2, from a pose off the lattice",
    ),
    "one keyframe early": (altered(rows=ROWS[:3]), -1, "the last pose is off the lattice"),
    "not quite straight": (
        altered(rows=with_row(3, [0, 0, 1])),
        -1,
        "the last pose is off the lattice",
    ),
    "bars pass through one another between good poses": (
        PASSES_THROUGH,
        0,
        "less than the diameter 0.999, at 0.5 of (BEND, 2, 0, 1)",
    ),
    "bend over the limit between good poses": (
        altered(rows=[[0, QUARTER, 2 * QUARTER], [0, -3 * QUARTER, -2 * QUARTER]]),
        0,
        "bend of 180 degrees at joint 1",
    ),
    "bend over the limit at the end": (
        altered(rows=with_row(1, [0, QUARTER + 2**12, 2 * QUARTER])),
        0,
        "bend of 91.4062 degrees at joint 1",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_planted_faults_are_found(name):
    faulty, where, words = FAULTS[name]
    verdict = lu.certify(faulty)
    assert not verdict.ok
    assert words in verdict.reason
    assert verdict.where == where


def test_the_poses_between_which_bars_pass_through_one_another_are_good():
    poses = list(lu.frames(PASSES_THROUGH))
    assert [pose_clearance(p) for p in poses] == pytest.approx([1, 1])
    assert [pose_bend_deg(p) for p in poses] == pytest.approx([90, 90])


def test_what_stays_all_but_at_the_diameter_is_undecided_and_not_for_long():
    verdict = lu.certify(CIRCLING, diameter=1.0)
    assert verdict.reason.startswith("undecided: bars 0 and 8 may come within the diameter 1,")
    assert (verdict.where, verdict.moves_checked) == (0, 1)
    assert lu.certify(CIRCLING).reason == "the last pose is off the lattice"


@st.composite
def turnings(draw, max_bars=12):
    """One BEND of a crumpled chain: some bars turn much, some little, some not at all."""
    start, axis = draw(chains(max_bars)), draw(st.integers(0, 2))
    before = quarters(start, axis)
    most = draw(st.sampled_from([5_000, QUARTER // 3, QUARTER, 4 * QUARTER]))
    steps = draw(st.lists(st.integers(-most, most), min_size=len(before), max_size=len(before)))
    rests = draw(st.integers(0, 2**12 - 1))
    turns = lying(start.astype(np.int64), axis).along == 0
    after = [
        a + step if turns[k] and not rests >> (k % 12) & 1 else a
        for k, (a, step) in enumerate(zip(before.tolist(), steps, strict=True))
    ]
    assume(after != before.tolist())
    return bent(start, axis, [before, after], straight=False)


def judged_as_sampled(trial, diameter, samples):
    """The verdict and samples agree: on who touches, and on the clearance within RESOLUTION."""
    verdict = lu.certify(trial, diameter=diameter, max_bend_deg=180)
    pose, move = trial.start.astype(float), trial.moves[0]
    clearance, bend_deg = sampled_move(trial, pose, move, samples)
    assert "undecided" not in verdict.reason
    assert bend_deg <= verdict.bend_deg + NEAR
    if "come within" not in verdict.reason:
        assert clearance - RESOLUTION - NEAR <= verdict.clearance <= clearance + 1e-8
        return verdict
    time = float(verdict.reason.split(" at ")[1].split()[0])
    assert pose_clearance(moved(pose, move, trial, time)) <= verdict.clearance + 1e-4
    assert clearance < diameter + NEAR
    return verdict


HALF_TURN = bent(walk("EEE"), Z, [[0] * 3, [2 * QUARTER] * 3])


def test_the_box_holds_what_bulges_between_the_poses():
    assert lu.certify(HALF_TURN).extent == pytest.approx((7, 4, 1), abs=2e-3)
    assert lu.certify(HALF_TURN, within=(7.01, 4.01, 1)).ok
    verdict = lu.certify(HALF_TURN, within=(7.01, 3.9, 1))
    assert verdict.reason.startswith("the blocks reach over 4.00")
    assert (verdict.ok, verdict.where) == (False, 0)


@examples(80)
@given(turnings())
def test_the_box_agrees_with_sampling(trial):
    verdict = lu.certify(trial, diameter=1e-6, max_bend_deg=180)
    poses = np.concatenate(list(lu.frames(trial, substeps=257)))
    extent, shown = np.ptp(poses, axis=0) + 1, np.array(verdict.extent)
    assert (extent <= shown + 1e-9).all()
    assert (shown <= extent + 3e-3).all()  # 2e-3 of the bound, the rest of the samples


def test_the_nearest_bars_and_the_most_bent_joint_are_named():
    verdict = lu.certify(PASSES_THROUGH, diameter=1e-3, max_bend_deg=90)
    near, a, b = verdict.nearest
    pose = moved(PASSES_THROUGH.start.astype(float), PASSES_THROUGH.moves[0], PASSES_THROUGH, 0.5)
    ends = (pose[[k]] for k in (a, a + 1, b, b + 1))
    assert (near, segment_distances(*ends)[0]) == (0, pytest.approx(0, abs=1e-9))
    sharp = lu.certify(FAULTS["bend over the limit at the end"][0])
    assert sharp.most_bent == (0, 1)


@examples(80)
@given(turnings())
def test_one_bend_agrees_with_sampling(trial):
    judged_as_sampled(trial, diameter=0.2, samples=129)


@examples(60)
@given(turnings(), st.sampled_from([0.8, 0.97, 0.999]))
def test_thick_bars_agree_with_sampling(trial, diameter):
    judged_as_sampled(trial, diameter, samples=129)


@pytest.mark.slow
@settings(max_examples=400, deadline=None)
@given(turnings(max_bars=40))
def test_bends_of_long_chains_agree_with_sampling(trial):
    judged_as_sampled(trial, diameter=0.2, samples=513)


@examples(60)
@given(turnings(max_bars=8))
def test_the_largest_bend_is_that_of_the_angles(trial):
    """By a walk in steps of 1/512 of the bend, at most which the angle between bars can miss."""
    verdict = lu.certify(trial, diameter=1e-3, max_bend_deg=180)
    pose, move = trial.start.astype(float), trial.moves[0]
    shown = max(pose_bend_deg(moved(pose, move, trial, t)) for t in np.linspace(0, 1, 513))
    steps = np.diff(np.diff(trial.angles, axis=0)) * 360 / (4 * QUARTER)
    assert shown - NEAR <= verdict.bend_deg <= shown + np.abs(steps).max() / 512 + NEAR


@pytest.mark.parametrize("seed", range(4))
def test_no_pair_of_a_long_chain_is_overlooked(seed):
    """Several hundred bars: what the tree tells apart in bulk is checked pair by pair."""
    rng = np.random.default_rng(seed)
    path = lu.layered_path(lu.VoxelSolid(blob(seed))).voxels
    axis = seed % 3
    before, turns = quarters(path, axis), lying(path.astype(np.int64), axis).along == 0
    drift = np.cumsum(rng.normal(0, 1, len(before))) if seed < 2 else rng.normal(0, 9, len(before))
    after = np.where(turns, before + (1500 * drift).astype(int), 0)
    trial = bent(path, axis, [before, after], straight=False)
    verdict = lu.certify(trial, diameter=1e-3, max_bend_deg=180)
    poses = lu.frames(trial, substeps=32)
    assert len(path) > 200
    assert "come within" in verdict.reason or verdict.clearance <= 1e-8 + min(
        map(pose_clearance, poses)
    )


def test_a_second_opinion_from_continuous_collision_detection():
    """Bars that ipctk lets by at .8 (64 straight steps a bend) are those the judge lets by."""
    ipctk = pytest.importorskip("ipctk")
    detector = ipctk.AdditiveCCD()
    rng = np.random.default_rng(5)
    start = walk("ENWNENUN")
    before, turns = quarters(start, Z), lying(start.astype(np.int64), Z).along == 0
    verdicts = []
    for _ in range(24):
        after = np.where(turns, before + rng.integers(-QUARTER // 2, QUARTER // 2, len(before)), 0)
        trial = bent(start, Z, [before, after], straight=False)
        hit = any(
            detector.edge_edge_ccd(
                *(p[[i, i + 1, j, j + 1]][c] for p in step for c in range(4)), min_distance=0.8
            )[0]
            for step in itertools.pairwise(lu.frames(trial, substeps=64))
            for i, j in zip(*np.triu_indices(len(start) - 1, 2), strict=True)
        )
        judged = lu.certify(trial, diameter=0.8, max_bend_deg=180)
        assert hit == ("come within" in judged.reason)
        verdicts.append(hit)
    assert 4 <= sum(verdicts) <= 20
