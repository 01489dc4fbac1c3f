"""The judge's closed forms against dense sampling of the poses that `frames` shows."""

import itertools
import os

import numpy as np
import pytest
from chains import chains, single, turns, walk
from examples import examples
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from oracles import pose_bend_deg, pose_clearance, reversed_motion, sampled_move
from polycubes import blob
from scipy.spatial import cKDTree

import lineup as lu
from lineup import grid, kinematics
from lineup.kinematics import Move

NEAR = 1e-6  # of the local refinement; the closed forms are exact
PARTS = ["PEEL of end 0", "PEEL of end 1", "SWING of end 0", "SWING of end 1", "DOOR"]


def part_of(row):
    kind, joint, other, _ = row
    return "DOOR" if kind == Move.DOOR else f"{Move(kind).name} of end {int(other > joint)}"


def close_pairs(pose, reach=3.0):
    """Bars two or more apart whose middles are at most `reach` apart, as two arrays."""
    tree = cKDTree((pose[1:] + pose[:-1]) / 2)
    pairs = np.sort(tree.query_pairs(reach, output_type="ndarray"), axis=1)
    return tuple(pairs[pairs[:, 1] - pairs[:, 0] >= 2].T)


@pytest.mark.parametrize("part", PARTS)
@examples(48)
@given(chains(), st.data())
def test_one_turn_agrees_with_sampling(part, start, data):
    """Equal clearance and bend, so it certifies nothing that sampling refutes and no less."""
    rows = [row for row in turns(start) if part_of(row) == part]
    assume(rows)
    trial = single(start, data.draw(st.sampled_from(rows)))
    verdict = lu.certify(trial)
    clearance, bend_deg = sampled_move(trial, start.astype(float), trial.moves[0], samples=65)
    assert abs(verdict.clearance - clearance) < NEAR
    assert ("come within" in verdict.reason) == (clearance < 0.999)
    if clearance >= 0.999:
        assert abs(verdict.bend_deg - bend_deg) < NEAR
        assert verdict.reason.startswith("bend of") == (bend_deg > 90 + NEAR)
        assert (verdict.where == 0) == verdict.reason.startswith("bend of")


@examples(80)
@given(chains(max_bars=10), st.data())
def test_tilts_are_never_certified_against_sampling(start, data):
    """Any targets at all, half of them all one direction: the lemma is a lower bound."""
    bars = grid.bar_directions(start).tolist()
    one_way = data.draw(st.sampled_from([None, *range(6)]))
    target = [
        data.draw(st.sampled_from(sorted({d, (d + 1) % 6, (d + 2) % 6, (d + 4) % 6})))
        if one_way is None
        else one_way
        for d in bars
    ]
    assume(all((a + 3) % 6 != b for a, b in zip(bars, target, strict=True)))
    assume(target != bars)
    trial = single(start, (Move.TILT, 0, len(bars), 0), target)
    verdict = lu.certify(trial)
    clearance, bend_deg = sampled_move(trial, start.astype(float), trial.moves[0], samples=65)
    if one_way is not None:
        assert verdict.where == -1
        assert lu.certify(reversed_motion(trial)).ok
    if verdict.where == -1:
        assert verdict.clearance <= clearance + 1e-9
        assert bend_deg <= verdict.bend_deg + NEAR


@examples(48)
@given(st.integers(4, 12), st.data())
def test_whole_motions_keep_what_their_certificate_says_both_ways(n_bars, data):
    """Moves each judged good alone, from a line on: good together, played either way."""
    pose = np.stack([np.arange(n_bars + 1), np.zeros(n_bars + 1), np.zeros(n_bars + 1)], axis=1)
    pose = pose.astype(int)
    line, rows = pose, []
    for row in data.draw(st.lists(st.integers(0, 10**6), min_size=1, max_size=12)):
        moves = turns(pose)
        trial = single(pose, moves[row % len(moves)])
        if lu.certify(trial).where == 0:
            continue
        rows.append(moves[row % len(moves)])
        pose = np.rint(list(lu.frames(trial))[-1]).astype(int)
    assume(rows)
    straight = pose_bend_deg(pose.astype(float)) == 0
    fold = lu.Motion(line, np.array(rows, int), 1.0, 90.0, straight, "folded")
    unfold = reversed_motion(fold)
    there, back = lu.certify(fold), lu.certify(unfold)
    assert there.ok
    assert back.ok
    assert (there.clearance, there.bend_deg) == (back.clearance, back.bend_deg)
    for motion in (fold, unfold):
        for shown in lu.frames(motion, substeps=16):
            assert pose_clearance(shown) >= there.clearance - 1e-9
            assert pose_bend_deg(shown) <= there.bend_deg + NEAR


@pytest.mark.slow
@settings(max_examples=400, deadline=None)
@given(chains(max_bars=40), st.data())
def test_long_chains_agree_with_sampling(start, data):
    trial = single(start, data.draw(st.sampled_from(turns(start))))
    clearance, _ = sampled_move(trial, start.astype(float), trial.moves[0], samples=257)
    assert abs(lu.certify(trial).clearance - clearance) < NEAR


def ccd_finds_contact(poses, pairs_of, distance):
    """Whether ipctk finds bars nearer than that, on the straight steps from pose to pose."""
    detector = pytest.importorskip("ipctk").AdditiveCCD()
    return any(
        detector.edge_edge_ccd(
            *(p[[i, i + 1, j, j + 1]][c] for p in step for c in range(4)), min_distance=distance
        )[0]
        for step in itertools.pairwise(poses)
        for i, j in zip(*pairs_of(*step), strict=True)
    )


@pytest.mark.parametrize("part", PARTS)
def test_a_second_opinion_from_continuous_collision_detection(part):
    """Bars that ipctk lets by at .99 (64 straight steps a move) are those the judge lets by."""
    start = walk("ENWUEESD")
    all_pairs = np.triu_indices(len(start) - 1, 2)
    rows = [row for row in turns(start) if part_of(row) == part]
    verdicts = set()
    for k in np.random.default_rng(2).permutation(len(rows))[:8]:
        trial = single(start, rows[k])
        poses = list(lu.frames(trial, substeps=64))
        hit = ccd_finds_contact(poses, lambda *_: all_pairs, 0.99)
        assert hit == ("come within" in lu.certify(trial, diameter=0.99).reason)
        verdicts.add(hit)
    assert verdicts == {True, False}


def moving_pairs(pose, after):
    """Close pairs of which one bar moves and the other does not."""
    i, j = close_pairs(pose)
    moves = (np.abs(after - pose) > 1e-9).any(axis=1)
    moves = moves[1:] | moves[:-1]
    differ = moves[i] != moves[j]
    return i[differ], j[differ]


def moves_of(motion, share):
    """Poses before some moves of a motion, spread over it, and the moves."""
    pose = motion.start.astype(float)
    for k, move in enumerate(motion.moves):
        if k % max(1, len(motion) // share) == 0:
            yield pose, move
        pose = np.rint(kinematics.moved(pose, move, motion, 1.0))


def check_by_sampling(motion, share):
    """A few of its moves, bars that are close all sampled, and by ipctk where they move."""
    verdict = lu.certify(motion)
    assert verdict.where == -1
    times = np.linspace(0, 1, 65)
    for pose, move in moves_of(motion, share):
        poses = [kinematics.moved(pose, move, motion, t) for t in times]
        assert min(pose_clearance(p, close_pairs(p)) for p in poses) >= verdict.clearance - 1e-9
        assert max(pose_bend_deg(p) for p in poses) <= verdict.bend_deg + NEAR
        assert not ccd_finds_contact(poses, moving_pairs, 0.98)


def test_growth_keeps_its_certificate_by_sampling():
    motion = lu.fold(lu.VoxelSolid(blob(3, side=7))).motion
    check_by_sampling(motion, 4)
    check_by_sampling(reversed_motion(motion), 2)


@pytest.mark.slow
@pytest.mark.skipif("LINEUP_MODELS" not in os.environ, reason="needs meshes in LINEUP_MODELS")
@pytest.mark.parametrize("name", ["bunny", "decocube"])
def test_growth_of_meshes_keeps_its_certificate_by_sampling(name):
    check_by_sampling(lu.fold(lu.model(name, voxels=1600)).motion, 25)
