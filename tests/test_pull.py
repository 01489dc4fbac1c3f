"""Pull-through: the lemma by sampling, the judge's faults, the planner, and played poses."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from contracts import NOT_STRAIGHT
from examples import examples
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from oracles import n_us, pose_bend_deg, pose_clearance, reversed_motion, sampled_move
from polycubes import polycubes
from scipy import ndimage

import lineup as lu
from lineup import grid, kinematics
from lineup.kinematics import Move
from lineup.motion import pulling

EAST, NORTH, UP, WEST, SOUTH, DOWN = range(6)
U_FREE, WITH_US = (0.914, 90.0), (0.866, 120.0)
ROUND_CORNERS, ROUND_US = 0.9142, np.sqrt(3) / 2


def walk(word, start=(0, 0, 0)):
    """The voxels of a path spelled in the letters of `grid.LETTERS`."""
    steps = grid.DIRECTIONS[[grid.LETTERS.index(c) for c in word]]
    return np.vstack([start, start + np.cumsum(steps, axis=0)])


def pulls(start, word, head=None, straight=True):
    """The motion that pulls a chain by its last joint, or `head`, in the directions of a word."""
    last = len(start) - 1
    head = last if head is None else head
    rows = [(Move.PULL, head, last - head, grid.LETTERS.index(c)) for c in word]
    moves = np.array(rows, int).reshape(-1, 4)
    return lu.Motion(start, moves, 1.0, 120.0, straight, "straight")


@st.composite
def tracks(draw, max_bars=16, max_pulls=8, u_free=False):
    """A crumpled chain and directions for its last joint: any P + 1 voxels in a row differ."""
    n_bars = draw(st.integers(1, max_bars))
    track, steps = [(0, 0, 0)], []
    for _ in range(n_bars + draw(st.integers(1, max_pulls))):
        shut = set(track[-n_bars - 1 :])
        ahead = [
            (d, new)
            for d in range(6)
            if (new := tuple((grid.DIRECTIONS[d] + track[-1]).tolist())) not in shut
            and not (u_free and steps[-2:-1] == [(d + 3) % 6])
        ]
        if not ahead:
            break
        if draw(st.booleans()):  # stay close
            ahead = sorted(ahead, key=lambda a: np.abs(np.subtract(a[1], track[0])).sum())[:2]
        d, new = draw(st.sampled_from(ahead))
        track.append(new)
        steps.append(d)
    n_bars = min(n_bars, len(steps))
    word = "".join(grid.LETTERS[d] for d in steps[n_bars:])
    return np.array(track[: n_bars + 1]), word


@examples(80)
@given(st.booleans().flatmap(lambda u_free: tracks(u_free=u_free)), st.booleans())
def test_the_lemma_holds_on_every_track(track, by_first):
    """All pairs of bars at many phases keep what the judge says, and so do all bends."""
    start, word = track
    assume(word)
    whole = np.vstack([start, walk(word, start[-1])[1:]])
    trial = pulls(start[::-1], word, head=0) if by_first else pulls(start, word)
    verdict = lu.certify(trial, diameter=0.5, max_bend_deg=120)
    assert (verdict.where, verdict.moves_checked) == (-1, len(trial))
    bends = pose_bend_deg(whole.astype(float)) > 0
    proven = (ROUND_US, 120) if n_us(whole) else (ROUND_CORNERS, 90) if bends else (1, 0)
    clearance, bend_deg = proven if len(start) > 3 else (np.inf, proven[1] * (len(start) > 2))
    assert (verdict.clearance, verdict.bend_deg) == (clearance, bend_deg)
    for pose in lu.frames(trial, substeps=15):
        assert_allclose(np.linalg.norm(np.diff(pose, axis=0), axis=1), 1, atol=1e-12)
        assert pose_clearance(pose) >= clearance - 1e-12
        assert pose_bend_deg(pose) <= bend_deg + 1e-6


@settings(max_examples=30, deadline=None)
@given(tracks(max_pulls=1), st.floats(0, 1))
def test_every_joint_stays_on_its_edge_of_the_track(track, t):
    start, word = track
    assume(word)
    trial = pulls(start, word)
    whole = np.vstack([start, walk(word, start[-1])[1:]])
    pose = kinematics.moved(start.astype(float), trial.moves[0], trial, t)
    along = pose - whole[:-1]
    phase = np.abs(along).max(axis=1)
    assert_allclose(along, phase[:, None] * np.diff(whole, axis=0), atol=1e-15)
    assert ((phase >= 0) & (phase <= 1)).all()
    assert (np.diff(phase) >= -1e-12).all()


@settings(max_examples=30, deadline=None)
@given(tracks())
def test_pulled_back_it_shows_the_same_poses(track):
    trial = pulls(*track)
    back = list(lu.frames(reversed_motion(trial), substeps=7))
    for a, b in zip(lu.frames(trial, substeps=7), back[::-1], strict=True):
        assert_allclose(a, b, atol=1e-12)


@settings(max_examples=60, deadline=None)
@given(tracks(), st.integers(0, 2), st.data())
def test_the_first_pull_out_of_a_box_is_the_one_refused(track, axis, data):
    trial = pulls(*track)
    cuts = [replace(trial, moves=trial.moves[:k]) for k in range(len(trial) + 1)]
    reach = [lu.certify(cut, 0.866, 120).extent[axis] for cut in cuts]
    side = data.draw(st.sampled_from(sorted(set(reach)))) - data.draw(st.sampled_from([0, 0.5]))
    within = np.insert([np.inf, np.inf], axis, side)
    verdict = lu.certify(trial, 0.866, 120, within=tuple(within.tolist()))
    out = np.flatnonzero(np.array(reach) > side)
    if len(out):
        assert verdict.reason.endswith(f"along axis {axis}, more than the {side:g} of the box")
        assert verdict.where == out[0] - 1
        assert verdict.moves_checked == out[0]
        assert verdict.extent[axis] == reach[out[0]]
    else:
        assert "box" not in verdict.reason
        assert verdict.moves_checked == len(trial)


def test_what_comes_first_is_refused_first():
    """The third pull meets an obstacle; the box is left before that, by it, or not at all."""
    trial, wall = pulls(LINE, "EEEN"), lu.Obstacles(np.ones((1, 1, 1), bool), np.array([9, 0, 0]))
    for side, where, expected in ((8, 1, "box"), (9, 2, "obstacle"), (10, 2, "obstacle")):
        verdict = lu.certify(trial, 0.866, 120, within=(side, 9, 9), obstacles=wall)
        assert verdict.where == where
        assert expected in verdict.reason


def test_the_constants_are_met():
    """A vertex in the crook of a corner, and a U: the lemma cannot promise much more."""
    crook = pulls(walk("EENNUWSDDD"), "D")
    clearance, _ = sampled_move(crook, crook.start.astype(float), crook.moves[0], samples=301)
    assert ROUND_CORNERS < clearance < ROUND_CORNERS + 2e-5
    u = pulls(walk("EENWW"), "W")
    clearance, bend_deg = sampled_move(u, u.start.astype(float), u.moves[0], samples=301)
    assert clearance == pytest.approx(ROUND_US, abs=1e-6)
    assert bend_deg == pytest.approx(120, abs=1e-3)


def test_a_wave_of_thousands_of_corners_is_one_of_few():
    """Away from the piece that leads nothing is between two voxels."""
    stair = walk("ENU" * 2000)
    trial = pulls(stair, "E")
    for t in np.linspace(0, 1, 11):
        pose = kinematics.moved(stair.astype(float), trial.moves[0], trial, t)
        assert (np.abs(pose - np.rint(pose)) > 1e-9).any(axis=1).sum() <= 12


LINE = walk("EEEEEE")
HOOK = walk("EEENWWW")  # makes a U
STAIR = walk("EENNUUEE")
RING = walk("EENNWWS")  # the head is next to the tail
FAULTS = {
    "a U at the 90-degree limit": (pulls(HOOK, "WWWWWWW"), 0.866, 90, "bend of 120 degrees"),
    "a U at diameter .914": (pulls(HOOK, "WWWWWWW"), 0.914, 120, "keep 0.866025"),
    "diameter .95": (pulls(STAIR, "EEEEEE"), 0.95, 90, "keep 0.9142"),
    "touching blocks": (pulls(STAIR, "EEEEEE"), 0.999, 90, "keep 0.9142"),
    "a U at the way out": (pulls(walk("EEENNN"), "ESSSSSS"), 0.914, 90, "keep 0.866025"),
    "a blocked way out": (pulls(walk("EENNWWWSSSEE"), "NNNN"), 0.866, 120, "joint 1 is in the way"),
    "the tail's voxel": (pulls(RING, "SSSSSSS"), 0.866, 120, "joint 0 is in the way"),
    "straight back": (pulls(STAIR, "EEEEEW"), 0.866, 120, "straight back"),
    "back into itself": (pulls(walk("E"), "W"), 0.866, 120, "straight back"),
    "a skipped pull": (pulls(STAIR, "EEEEE"), 0.914, 90, "not straight"),
    "the wrong joints": (pulls(STAIR, "E", head=3), 0.914, 90, "from one end to the other"),
    "no joints": (pulls(walk("E")[:1], "E"), 0.914, 90, "from one end to the other"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_faults_are_found(name):
    trial, diameter, max_bend_deg, reason = FAULTS[name]
    verdict = lu.certify(trial, diameter=diameter, max_bend_deg=max_bend_deg)
    assert not verdict.ok
    assert reason in verdict.reason


def test_the_first_fault_is_named_and_what_came_before_counts():
    blocked = pulls(walk("EEEEEEEE"), "NWWWSS")
    verdict = lu.certify(blocked, diameter=0.866, max_bend_deg=90)
    assert (verdict.where, verdict.moves_checked) == (1, 2)
    assert (verdict.clearance, verdict.bend_deg) == (ROUND_US, 120)
    verdict = lu.certify(blocked, diameter=0.866, max_bend_deg=120)
    assert (verdict.where, verdict.clearance, verdict.bend_deg) == (4, 0, 120)
    assert verdict.reason == "the pull is blocked: joint 1 is in the way"
    # Led by joint 0, the joints are counted from the other end.
    mirrored = pulls(blocked.start[::-1], "NWWWSS", head=0)
    verdict = lu.certify(mirrored, diameter=0.866, max_bend_deg=120)
    assert (verdict.where, verdict.reason) == (4, "the pull is blocked: joint 7 is in the way")


def test_pulls_go_together_with_moves_of_other_kinds():
    """Out by one end, back by the other, a swing at a lattice pose, and out again."""
    stair = walk("EENNUU")
    rows = [(Move.PULL, 6, 0, UP)] * 4 + [(Move.SWING, 2, 1, WEST)]
    rows += [(Move.PULL, 0, 6, WEST), (Move.PULL, 6, 0, UP), (Move.TILT, 0, 6, 0)]
    mixed = lu.Motion(
        stair, np.array(rows), 0.9, 90.0, True, "straight", np.full((1, 6), EAST, np.int8)
    )
    for motion in (mixed, reversed_motion(mixed)):
        verdict = lu.certify(motion, diameter=0.914)
        assert verdict.ok, verdict.reason
        assert (verdict.clearance, verdict.bend_deg) == (ROUND_CORNERS, 90)
    assert list(lu.frames(mixed))[4].tolist() == walk("UUUUUU", (2, 2, 0)).tolist()


def test_a_second_opinion_from_continuous_collision_detection():
    """Bars of a crumpled chain that ipctk lets by at what the lemma promises, and no further."""
    ipctk = pytest.importorskip("ipctk")
    detector = ipctk.AdditiveCCD()
    for word, way, promised, broken in [
        ("EENNUWSDDD", "D", 0.914, 0.915),
        ("EENWWUEES", "S", 0.866, 0.867),
    ]:
        trial = pulls(walk(word), way)
        poses = list(lu.frames(trial, substeps=256))
        pairs = np.stack(np.triu_indices(len(word), 2), axis=1)
        for least, hits in ((promised - 1e-3, False), (broken, True)):
            found = any(
                detector.edge_edge_ccd(
                    *(p[[i, i + 1, j, j + 1]][c] for p in step for c in range(4)),
                    min_distance=least,
                )[0]
                for step in itertools.pairwise(poses)
                for i, j in pairs
            )
            assert found == hits
            assert lu.certify(trial, diameter=least, max_bend_deg=120).where == (0 if hits else -1)


def check_pulled(motion):
    """Straight, certified at what it says of itself, and a U only where it says so."""
    verdict = lu.certify(motion, motion.diameter, motion.max_bend_deg)
    assert verdict.ok, verdict.reason
    assert (motion.diameter, motion.max_bend_deg) in (U_FREE, WITH_US)
    assert set(motion.moves[:, 0]) <= {Move.PULL}
    assert len({tuple(row) for row in motion.moves[:, 1:3]}) <= 1


@examples(80)
@given(polycubes(60), st.integers(0, 9))
def test_a_chain_is_pulled_out_wherever_a_way_leads_out(occupancy, seed):
    assume(occupancy.sum() > 1)
    path = lu.layered_path(lu.VoxelSolid(occupancy), seed=seed, starts=1)
    motion = lu.unfold(path, "pull")
    taken = np.zeros(np.array(occupancy.shape) + 2, bool)
    taken[tuple((path.voxels + 1).T)] = True
    free, _ = ndimage.label(~taken)
    ends = path.voxels[[0, -1]] + 1
    leads_out = any(free[tuple(end + d)] == free[0, 0, 0] for end in ends for d in grid.DIRECTIONS)
    assert motion.straight == leads_out
    if leads_out:
        check_pulled(motion)
        assert not n_us(path.voxels) or motion.max_bend_deg == 120


def packed(rng, side):
    """A path without a U that fills a box from both ends until they are stuck, deep inside."""
    track = [tuple(rng.integers(0, side, 3).tolist())]
    for _ in range(2):
        while True:
            beside = [tuple((track[-1] + d).tolist()) for d in grid.DIRECTIONS]
            ahead = [
                new
                for new in beside
                if new not in track
                and min(new) >= 0
                and max(new) < side
                and not n_us(np.array([*track[-3:], new]))
            ]
            if not ahead:
                break
            track.append(ahead[rng.integers(len(ahead))])
        track.reverse()
    return np.array(track)


def leads_out_without_a_u(track, n_turns):
    """Whether a way of at most so many steps and then a ray continues a path, by trying all."""
    reach = np.ptp(track, axis=0).max() + n_turns + 1
    taken = set(map(tuple, track.tolist()))
    for step in grid.DIRECTIONS:
        before = track[-2] - track[-3] if len(track) > 2 else 0 * step
        if (step == -before).all() or (step == track[-2] - track[-1]).all():
            continue
        ray = track[-1] + np.arange(1, reach + 1)[:, None] * step
        if taken.isdisjoint(map(tuple, ray.tolist())):
            return True
        free = n_turns and tuple(ray[0].tolist()) not in taken
        if free and leads_out_without_a_u(np.vstack([track, ray[:1]]), n_turns - 1):
            return True
    return False


@settings(max_examples=60, deadline=None)
@example(seed=34, side=3)
@given(st.integers(0, 10**6), st.integers(3, 5))
def test_a_way_out_of_a_packed_box_makes_a_u_only_where_it_must(seed, side):
    voxels = packed(np.random.default_rng(seed), side)
    assume(len(voxels) > 2)
    motion = lu.unfold(lu.VoxelPath(voxels), "pull")
    if motion.straight:
        check_pulled(motion)
    if any(leads_out_without_a_u(track, 3) for track in (voxels, voxels[::-1])):
        assert (motion.diameter, motion.max_bend_deg) == U_FREE


@pytest.mark.parametrize(
    ("last", "carved", "u_free", "way"),
    [
        ("SS", "ENNN", True, None),
        ("SS", "ENNN", False, "EN"),
        ("SS", "EENNN", True, "EEN"),
        ("EE", "ENNWN", True, "ENNWN"),
        ("EE", "ENUNWN", True, "ENUNWN"),
        ("SS", "EEEUUWWDDNNN", True, None),  # round a loop there is, but across itself
        ("SE", "NWNN", True, None),
        ("SE", "NWNN", False, "NWN"),
    ],
)
def test_ways_through_a_solid_wall(last, carved, u_free, way):
    """A tunnel to the north side of a block, from its middle; `last` are the edges that lead in."""
    wall = np.ones((9, 7, 7), bool)
    head = np.array([3, 3, 2])
    wall[tuple(walk(carved, head)[1:].T)] = False
    wall[tuple(head)] = True
    voxels = np.argwhere(wall)
    k = int(np.flatnonzero((voxels == head).all(axis=1))[0])
    track = [grid.LETTERS.index(c) for c in last]
    found = pulling._way_out(voxels, k, track, u_free=u_free)
    assert (found and "".join(grid.LETTERS[d] for d in found)) == way


def test_both_ends_shut_in_is_a_reason():
    shut = walk("EDNUUUSDSUWWNNDDDSSUNUSEDEDWNNUUUSD")  # from one middle of a block to the other
    motion = lu.unfold(lu.VoxelPath(shut), "pull")
    assert (motion.straight, len(motion)) == (False, 0)
    assert motion.reason == "no way out: the rest of the path shuts in both ends"
    assert lu.certify(motion, *WITH_US).reason == NOT_STRAIGHT


@pytest.mark.parametrize(
    ("word", "n_pulls", "bounds"),
    [
        ("EEEE", 0, U_FREE),
        ("EEEN", 1, U_FREE),
        ("ENNN", 1, U_FREE),
        ("EENNWW", 4, U_FREE),
        ("ENWW", 2, WITH_US),
    ],
)
def test_ways_out_by_hand(word, n_pulls, bounds):
    motion = lu.unfold(lu.VoxelPath(walk(word)), "pull")
    check_pulled(motion)
    assert (len(motion), (motion.diameter, motion.max_bend_deg)) == (n_pulls, bounds)
