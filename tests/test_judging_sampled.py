"""The judge's closed forms against dense sampling of the poses that `frames` shows."""

import itertools

import numpy as np
import pytest
from chains import chains, single, turns
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from oracles import pose_bend_deg, pose_clearance, reversed_motion, sampled_move

import lineup as lu
from lineup import grid
from lineup.kinematics import Move

NEAR = 1e-6  # of the local refinement; the closed forms are exact


@settings(max_examples=120, deadline=None)
@given(chains(), st.data())
def test_one_turn_agrees_with_sampling(start, data):
    """Equal clearance and bend, so it certifies nothing that sampling refutes and no less."""
    kind = data.draw(st.sampled_from([Move.PEEL, Move.SWING, Move.DOOR]))
    rows = [row for row in turns(start) if row[0] == kind]
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


@settings(max_examples=60, deadline=None)
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


@settings(max_examples=25, deadline=None)
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


def test_a_second_opinion_from_continuous_collision_detection():
    """Bars that ipctk lets by at .99 (64 straight steps a move) are those the judge lets by."""
    ipctk = pytest.importorskip("ipctk")
    detector = ipctk.AdditiveCCD()
    rng = np.random.default_rng(2)
    start = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 1, 1), (1, 1, 1), (2, 1, 1)])
    rows = turns(start)
    verdicts = set()
    for k in rng.permutation(len(rows))[:24]:
        trial = single(start, rows[k])
        poses = list(lu.frames(trial, substeps=64))
        pairs = np.stack(np.triu_indices(len(start) - 1, 2), axis=1)
        hit = any(
            detector.edge_edge_ccd(
                *(p[[i, i + 1, j, j + 1]][c] for p in step for c in range(4)), min_distance=0.99
            )[0]
            for step in itertools.pairwise(poses)
            for i, j in pairs
        )
        assert hit == ("come within" in lu.certify(trial, diameter=0.99).reason)
        verdicts.add(hit)
    assert verdicts == {True, False}
