"""Foldings that are pulled out, whole and trimmed, and the proof of the lemma's table."""

import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from contracts import check_path
from examples import examples
from hypothesis import assume, given
from hypothesis import strategies as st
from oracles import n_us
from polycubes import polycubes

import lineup as lu
from lineup import grid
from lineup.judging import _pulls
from lineup.kinematics import Move

sys.path.append(str(Path(__file__).parents[1] / "proofs"))

import pull_table
from pull_table import Interval

RESULTS = Path(__file__).parents[1] / "experiments" / "results"


def check_pulled(folding, solid):
    """Certified at what the motion says of itself, which is the best for a path without Us."""
    check_path(folding.path, solid)
    motion = folding.motion
    verdict = lu.certify(motion, motion.diameter, motion.max_bend_deg)
    assert verdict.ok, verdict.reason
    assert set(motion.moves[:, 0]) <= {Move.PULL}
    if len(motion):
        expected = (0.866, 120.0) if n_us(folding.path.voxels) else (0.914, 90.0)
        assert (motion.diameter, motion.max_bend_deg) == expected


@given(polycubes(80), st.integers(0, 9), st.data())
@examples(40)
def test_a_path_without_us_is_pulled_out_whole_and_trimmed(occupancy, seed, data):
    assume(occupancy.sum() > 1)
    solid = lu.VoxelSolid(occupancy)
    folding = lu.fold(solid, method="pull", seed=seed, sweeps=10)
    assert n_us(folding.path.voxels) == 0
    check_pulled(folding, solid)
    length = 2 * data.draw(st.integers(1, len(folding.path) // 2))
    (shorter,) = lu.trim([folding], length)
    assert (len(shorter.path), n_us(shorter.path.voxels)) == (length, 0)
    check_pulled(shorter, solid)


@given(polycubes(80), st.integers(0, 9), st.data())
@examples(40)
def test_any_path_that_has_a_way_out_is_pulled_out_and_trimmed(occupancy, seed, data):
    assume(occupancy.sum() > 1)
    solid = lu.VoxelSolid(occupancy)
    folding = lu.fold(solid, method="pull", seed=seed, path="layered")
    assume(folding.motion.straight)
    length = 2 * data.draw(st.integers(1, len(folding.path) // 2))
    (shorter,) = lu.trim([folding], length)
    assert len(shorter.path) == length
    check_path(shorter.path, solid)
    bounds = shorter.motion.diameter, shorter.motion.max_bend_deg
    assert lu.certify(shorter.motion, *bounds).ok


def test_trimming_keeps_the_surface_while_it_can():
    """Inside a block there is enough to contract, without a U."""
    solid = lu.VoxelSolid(np.ones((7, 7, 6), bool))
    folding = lu.fold(solid, method="pull", sweeps=300)
    kept = grid.surface(solid.occupancy)
    before = kept[tuple(folding.path.voxels.T)].sum()
    (shorter,) = lu.trim([folding], len(folding.path) - 12)
    assert kept[tuple(shorter.path.voxels.T)].sum() == before
    assert "12 voxels in pairs, 0 in excursions and 0 off the ends" in shorter.path.method
    for length in range(len(folding.path) - 12, 20, -52):
        (shorter,) = lu.trim([folding], length)
        assert (len(shorter.path), n_us(shorter.path.voxels)) == (length, 0)
        check_pulled(shorter, solid)


def test_all_of_a_refined_solid_is_pulled_out_without_a_u():
    solid = lu.VoxelSolid(np.ones((2, 1, 1), bool))
    folding = lu.fold(solid, method="pull", path="refined4")
    assert len(folding.path) == 128
    assert folding.motion.diameter == 0.914
    assert lu.certify(folding.motion, 0.914).ok


NUMBERS = st.floats(-4, 4, width=32).map(lambda x: np.array([x]))


@given(NUMBERS, NUMBERS, NUMBERS, NUMBERS)
def test_intervals_hold_every_result(a, b, c, d):
    one = Interval(np.minimum(a, b), np.maximum(a, b))
    other = Interval(np.minimum(c, d), np.maximum(c, d))
    for x in (one.low, one.high):
        for y in (other.low, other.high):
            p, q = Fraction(float(x[0])), Fraction(float(y[0]))
            cases = [(one + other, p + q), (one - other, p - q), (one * other, p * q)]
            if other.low > 1e-3:
                cases.append((one / other, p / q))
            for found, exact in cases:
                assert found.low[0] < exact < found.high[0]


@given(st.floats(0, 1), st.floats(0, 1))
def test_corner_functions_hold_what_they_stand_for(s, t):
    over = Interval(np.array([min(s, t)]), np.array([max(s, t)]))
    for x in (s, (s + t) / 2, t):
        for function, value in [
            (pull_table.sine, 2 * x / (1 + x * x)),
            (pull_table.versine, 2 * x * x / (1 + x * x)),
            (pull_table.past_a_corner, np.sqrt(x * (2 - x))),
        ]:
            found = function(over)
            assert found.low[0] <= value + 1e-15
            assert found.high[0] >= value - 1e-15
            assert found.high[0] - found.low[0] < 2 or s != t


@pytest.mark.parametrize("with_us", [False, True])
def test_the_table_of_bars_two_apart_is_proven(with_us):
    found = pull_table.two_apart(with_us=with_us)
    assert found.n_cases == (32 if with_us else 89)
    assert found.least == pytest.approx(np.sqrt(3) / 2 if with_us else 1, abs=1e-6)
    bends = pull_table.one_apart(with_us=with_us)
    assert bends.n_cases == (4 if with_us else 21)


@pytest.mark.slow
def test_the_whole_table_is_proven():
    assert pull_table.beside_a_straight().n_cases == 10_060
    assert pull_table.corner_beside_corner().n_cases == 8_050


def test_nothing_false_is_proven(monkeypatch):
    monkeypatch.setattr(pull_table, "MOST_BISECTIONS", 12)
    monkeypatch.setattr(pull_table, "ROUND_US", 0.867)
    with pytest.raises(ArithmeticError, match="boxes are left unproven"):
        pull_table.two_apart(with_us=True)
    monkeypatch.setattr(pull_table, "ROUND_CORNERS", 0.92)
    for table in (pull_table.beside_a_straight, pull_table.corner_beside_corner):
        with pytest.raises(ArithmeticError, match="boxes are left unproven"):
            table()


def test_corners_are_counted_as_a_walk_along_the_track_does():
    """Random simple tracks: no later corner has passed fewer than the table allows."""
    rng = np.random.default_rng(0)
    x, y = pull_table.DIRECTIONS[:2]
    for _ in range(300):
        edges, voxels = [x, y], [-x, 0 * x, y]
        while len(edges) < 12:
            step = pull_table.DIRECTIONS[rng.integers(6)]
            new = voxels[-1] + step
            if any((new == v).all() for v in voxels):
                break
            edges.append(step)
            voxels.append(new)
        n_corners = 1
        for k in range(2, len(edges)):
            later = np.array([[voxels[k], edges[k - 1], edges[k]]])
            if k > 3 and (edges[k - 1] != edges[k]).any():
                assert pull_table.corners_passed(later)[0] <= n_corners
            n_corners += (edges[k - 1] != edges[k]).any()


def test_the_judge_uses_what_the_committed_table_proves():
    page = (RESULTS / "pull_table.md").read_text()
    assert page.count(f"distance >= {_pulls.ROUND_CORNERS} ") == 3
    assert _pulls.ROUND_CORNERS == pull_table.ROUND_CORNERS
    assert _pulls.ROUND_US - 1e-4 < pull_table.ROUND_US < _pulls.ROUND_US
