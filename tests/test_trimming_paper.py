"""Section 5 as written: pairs of index 2, subset sums, and where they fail."""

import numpy as np
import pytest
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import disjoint_subsets
from polycubes import polycubes

import lineup as lu
from lineup.contraction import contracted, contraction_pairs
from lineup.grid import surface
from lineup.subset_sums import NEVER, least_costs, of_index_2, smallest_subsets, subset

LINE = [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (5, 0)]
FIGURE_11 = [(0, 0), (1, 0), (1, 1), (2, 1), (2, 0), (3, 0)]
TWO_TEETH = [(0, 0), (0, 1), (1, 1), (1, 0), (2, 0), (2, 1), (3, 1), (3, 0)]
DEEP_TOOTH = [(0, 0), (1, 0), (1, 1), (1, 2), (2, 2), (2, 1), (2, 0), (3, 0)]
RING = [(1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1), (0, 0)]


def flat_path(steps):
    """A path in the layer z = 0 from its (x, y) positions."""
    return lu.VoxelPath(np.array([(x, y, 0) for x, y in steps], np.int32), method="typed")


def trimmed(*paths, length=None):
    return lu.trim([flat_path(p) for p in paths], length, method="paper", keep="none")


@st.composite
def pair_lists(draw, n_steps=14, max_pairs=9):
    """Pairs of even index in no particular geometry."""
    pairs = [(i, j) for i in range(n_steps) for j in range(i + 3, n_steps, 2)]
    chosen = draw(st.lists(st.sampled_from(pairs), max_size=max_pairs, unique=True))
    return np.array(sorted(chosen), np.int32).reshape(-1, 2)


def fewest(pairs):
    """{sum of indices: fewest disjoint pairs}, by looking at all subsets."""
    best = {}
    for chosen in disjoint_subsets(pairs.tolist()):
        total = sum(j - i - 1 for i, j in chosen)
        best[total] = min(best.get(total, NEVER), len(chosen))
    return best


def test_figure_11():
    result = trimmed(FIGURE_11, LINE[:4])
    assert result.reason == "trimmed"
    assert result[0].voxels[:, :2].tolist() == [[0, 0], [1, 0], [2, 0], [3, 0]]
    assert result[0].method == "typed, trimmed by 2 voxels in pairs of index 2"
    assert result[1].method == "typed"


def test_overlapping_pairs_cannot_be_carried_out_together():
    path = flat_path(TWO_TEETH)
    pairs = contraction_pairs(path, np.zeros((4, 2, 1), bool))
    assert pairs.tolist() == [[0, 3], [2, 5], [4, 7]]
    solid = lu.VoxelSolid(np.ones((4, 2, 1), bool))
    apart = contracted(path, np.array([(0, 3), (4, 7)], np.int32), "disjoint pairs")
    assert lu.certify_path(apart, solid).ok
    across = contracted(path, np.array([(0, 3), (2, 5)], np.int32), "overlapping pairs")
    assert not lu.certify_path(across, solid).ok


def test_pairs_of_index_2_are_preferred_to_fewer_of_higher_index():
    tooth_then_teeth = [*DEEP_TOOTH, (4, 0), (4, 1), (5, 1), (5, 0)]
    (short,) = trimmed(tooth_then_teeth, length=8)
    assert short.method == "typed, trimmed by 4 voxels in pairs of index 2"


def test_a_smallest_subset_where_pairs_of_index_2_are_too_few():
    (short,) = trimmed(DEEP_TOOTH, length=4)
    assert short.voxels[:, :2].tolist() == [[0, 0], [1, 0], [2, 0], [3, 0]]
    assert short.method == "typed, trimmed by 4 voxels in pairs of a smallest subset"


def test_the_shorter_path_is_shortened_too_where_only_differences_can_be_had():
    ring = [*RING, (-1, 0), (-2, 0)]
    ring = [(x + 2, y) for x, y in ring]
    result = trimmed(ring, TWO_TEETH)
    assert [len(path) for path in result] == [4, 4]
    assert "6 voxels in pairs of a smallest subset" in result[0].method
    assert "4 voxels in pairs of a smallest subset" in result[1].method


@pytest.mark.parametrize(
    ("paths", "length", "goal"),
    [((LINE, LINE[:4]), None, "one length"), ((LINE,), 4, "4 voxels"), ((RING,), 4, "4 voxels")],
)
def test_no_way_is_a_result_with_a_reason(paths, length, goal):
    given_paths = [flat_path(p) for p in paths]
    result = lu.trim(given_paths, length, method="paper", keep="none")
    told = ", ".join(str(len(p)) for p in paths)
    assert result.reason == (
        f"no disjoint contraction pairs bring paths of {told} voxels to {goal}"
    )
    assert list(result) == given_paths


def test_a_table_that_would_be_too_large_is_a_result_with_a_reason(monkeypatch):
    monkeypatch.setattr("lineup.subset_sums.MAX_ENTRIES", 10)
    assert trimmed(DEEP_TOOTH, length=4).reason == (
        "the subset sums that bring paths of 8 voxels to 4 voxels do not fit 10 entries"
    )


def test_foldings_are_refused():
    folding = lu.fold(lu.VoxelSolid(np.ones((2, 2, 2), bool)), rounds=5, trial_rounds=5)
    with pytest.raises(ValueError, match="'paper' trims paths, before their motion is planned"):
        lu.trim([folding], 4, method="paper")


@settings(max_examples=60)
@given(pair_lists())
def test_least_costs_are_those_of_all_subsets(pairs):
    ordered = pairs[np.lexsort(pairs.T)]
    cost, head = np.ones(len(pairs), np.int64), np.full(14, NEVER, np.int64)
    head[0] = 0
    table = least_costs(ordered, cost, head, 7)
    expected = fewest(pairs)
    for half in range(8):
        assert table[-1, half] == expected.get(2 * half, NEVER)
        if table[-1, half] < NEVER:
            taken, first = subset(table, ordered, cost, 13, half)
            chosen = ordered[taken]
            assert first == 0
            assert (chosen[1:, 0] >= chosen[:-1, 1]).all()
            assert (chosen[:, 1] - chosen[:, 0] - 1).sum() == 2 * half
            assert len(chosen) == expected[2 * half]


@settings(max_examples=60)
@given(pair_lists(), pair_lists(12), st.none() | st.sampled_from([2, 4, 6, 8, 10, 12]))
def test_smallest_subsets_are_those_of_all_pairs_of_subsets(one, other, length):
    ways = {}
    for a, n in fewest(one).items():
        for b, m in fewest(other).items():
            if 14 - a == 12 - b and length in (None, 14 - a):
                ways[14 - a] = n + m
    found = smallest_subsets([one, other], [14, 12], length)
    if not ways:
        assert isinstance(found, str)
        return
    sums = [int((pairs[:, 1] - pairs[:, 0] - 1).sum()) for pairs in found]
    assert 14 - sums[0] == 12 - sums[1] == max(g for g in ways if ways[g] == min(ways.values()))
    assert sum(map(len, found)) == min(ways.values())


@settings(max_examples=60)
@given(pair_lists(max_pairs=12), st.integers(0, 5))
def test_as_many_disjoint_pairs_of_index_2_as_there_can_be(pairs, n_wanted):
    short = [p for p in pairs.tolist() if p[1] - p[0] == 3]
    most = max(map(len, disjoint_subsets(short)))
    chosen = of_index_2(pairs, n_wanted)
    assert len(chosen) == min(n_wanted, most)
    assert (chosen[1:, 0] >= chosen[:-1, 1]).all()
    assert all(p in short for p in chosen.tolist())


@examples(60)
@given(polycubes(60), polycubes(60))
def test_paths_come_out_certified_of_one_length_and_with_their_surface(one, other):
    solids = [lu.VoxelSolid(s) for s in (one, other) if s.sum() > 1]
    if len(solids) < 2:
        return
    paths = [lu.layered_path(s, starts=1) for s in solids]
    result = lu.trim(paths, method="paper")
    if result.reason != "trimmed":
        assert list(result) == paths
        return
    assert len({len(path) for path in result}) == 1
    for path, before, solid in zip(result, paths, solids, strict=True):
        assert lu.certify_path(path, solid).ok
        assert surface(solid.occupancy)[tuple(path.voxels.T)].sum() == (
            surface(solid.occupancy)[tuple(before.voxels.T)].sum()
        )
