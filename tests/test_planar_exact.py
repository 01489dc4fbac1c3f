"""The exact planar solver against all paths of small regions, and the search against it."""

import sys
from itertools import combinations

import numpy as np
import pytest
from examples import examples
from hypothesis import given
from hypothesis import strategies as st
from oracles import heaviest_path_between
from regions import cells_of, comb, draw_ends, graph_of, grown, grown_regions

import lineup as lu

pytest.importorskip("ortools")


@examples(240)
@given(grown_regions(14), st.data())
def test_exact_paths_are_the_longest_of_all(mask, data):
    start, end = draw_ends(data, mask)
    found = lu.planar_path(mask, start, end, method="exact")
    longest = heaviest_path_between(graph_of(mask), start, end, dict.fromkeys(cells_of(mask), 1))
    assert len(found) == found.bound == longest
    assert (found.optimal, found.reason) == (True, "optimal")
    check_path(found, mask, start, end)


def check_path(found, mask, start, end):
    cells = list(map(tuple, found.cells.tolist()))
    assert (cells[0], cells[-1]) == (start, end)
    assert len(set(cells)) == len(cells) <= found.bound
    assert mask[tuple(found.cells.T)].all()
    assert (np.abs(np.diff(found.cells, axis=0)).sum(axis=1) == 1).all()


def share_solved(numbers):
    """Share of random problems of up to 40 cells in which `long` equals `exact`."""
    n_equal = 0
    for k in numbers:
        rng = np.random.default_rng(k)
        mask = grown(rng, int(rng.integers(2, 41)))
        cells = cells_of(mask)
        start, end = (cells[i] for i in rng.choice(len(cells), 2, replace=False))
        found = lu.planar_path(mask, start, end)
        exact = lu.planar_path(mask, start, end, method="exact")
        check_path(found, mask, start, end)
        assert exact.optimal
        assert len(found) <= len(exact) <= found.bound
        n_equal += len(found) == len(exact)
    return n_equal / len(numbers)


def test_the_search_equals_the_exact_solver():
    assert share_solved(range(60)) >= 0.97


@pytest.mark.slow
def test_the_search_equals_the_exact_solver_on_thousands():
    assert share_solved(range(10_000, 13_000)) >= 0.97


def test_no_path_of_a_plate_without_corners_is_as_long_as_lemma_4_1_says():
    """Nine interior voxels, connected; 12 voxels of one colour against 9 allow no 19.5."""
    mask = np.ones((5, 5), bool)
    mask[::4, ::4] = False
    inner = [(x, y) for x in (1, 2, 3) for y in (1, 2, 3)]
    found = [
        lu.planar_path(mask, start, end, method="exact") for start, end in combinations(inner, 2)
    ]
    assert all(path.optimal for path in found)
    assert max(map(len, found)) == 19 < 5 * mask.sum() / 6 + 2


def test_no_path_in_the_interior_of_the_comb_is_long_enough():
    """The proof for `test_lemma_4_1_fails_on_a_comb`: a longest path of a tree joins two leaves."""
    mask = comb(6, 12)
    interior = np.zeros_like(mask)
    interior[1:-1, 1] = interior[1::4, 1:-1] = True
    tips = cells_of(interior & (np.arange(mask.shape[1]) == mask.shape[1] - 2))
    assert sorted(tips) == sorted(cell for cell, n in graph_of(interior).degree if n == 1)
    found = [
        lu.planar_path(interior, start, end, method="exact") for start, end in combinations(tips, 2)
    ]
    assert all(path.optimal for path in found)
    n_boundary = int(mask.sum() - interior.sum())
    assert n_boundary + max(map(len, found)) < 5 * mask.sum() / 6 + 2


def test_running_out_of_time_leaves_a_path_and_a_bound():
    mask = np.ones((15, 15), bool)
    mask[4:11:3, 4:11:3] = False
    ends = (0, 0), (0, 1)
    first, again = (lu.planar_path(mask, *ends, method="exact", limit=0.01) for _ in range(2))
    check_path(first, mask, *ends)
    assert first.reason == "time ran out"
    assert not first.optimal
    assert first.bound > len(first)
    assert np.array_equal(first.cells, again.cells)


def test_without_ortools_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "ortools.sat.python", None)
    with pytest.raises(RuntimeError, match=r"lineup-workbench\[exact\]"):
        lu.planar_path(np.ones((2, 2), bool), (0, 0), (0, 1), method="exact")
