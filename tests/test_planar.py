"""The planar search against exhaustive search, its parts against networkx."""

import itertools

import networkx as nx
import numpy as np
import pytest
from examples import examples
from hypothesis import given
from hypothesis import strategies as st
from oracles import heaviest_path_between
from regions import draw_ends, grown_regions

import lineup as lu
from lineup import planar
from lineup.planar import _board, _search, paper


@st.composite
def regions(draw, max_cells=14):
    """A random region with weights 1 and 2, and its graph of cells."""
    cells, rim = set(), {(0, 0)}
    for _ in range(draw(st.integers(2, max_cells))):
        x, y = draw(st.sampled_from(sorted(rim)))
        cells.add((x, y))
        rim |= {(x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)}
        rim -= cells
    points = np.array(sorted(cells))
    points += 1 - points.min(axis=0)
    inside = np.zeros(points.max(axis=0) + 2, bool)
    inside[tuple(points.T)] = True
    heavy = draw(st.lists(st.booleans(), min_size=inside.size, max_size=inside.size))
    weight = 1.0 + np.array(heavy, float)
    return planar.region(inside.ravel(), weight, inside.shape[1])


def graph_of(region):
    graph = nx.Graph()
    for cell in region.cells.tolist():
        graph.add_node(cell)
        for other in (cell + 1, cell + region.width):
            if region.inside[other]:
                graph.add_edge(cell, other)
    return graph


def ends_of(data, region):
    cell = st.sampled_from(region.cells.tolist())
    return data.draw(cell), data.draw(cell)


def check_path(region, path, start, end):
    assert (path[0], path[-1]) == (start, end)
    assert len(set(path.tolist())) == len(path)
    assert region.inside[path].all()
    assert set(np.abs(np.diff(path)).tolist()) <= {1, region.width}


@examples(440)
@given(regions(), st.data())
def test_small_regions_are_solved_to_the_optimum(region, data):
    start, end = ends_of(data, region)
    rng = np.random.default_rng(0)
    path, score, limit = planar.long_path(region, start, end, planar.NO_WISHES, 8, 100, rng)
    check_path(region, path, start, end)
    assert score == region.weight[path].sum()
    best = heaviest_path_between(graph_of(region), start, end, region.weight)
    assert score == best <= limit


@examples(160)
@given(regions(40), st.data())
def test_blocks_are_those_of_networkx(region, data):
    graph = graph_of(region)
    found = sorted(map(sorted, nx.biconnected_components(graph)))
    mine = []
    for block, head in enumerate(region.head.tolist()):
        mine.append(sorted([head, *np.flatnonzero(region.home == block).tolist()]))
    assert sorted(mine) == found
    start, end = ends_of(data, region)
    chain = planar.chain(region, start, end)
    if start == end:
        assert chain == []
        return
    # With its ends joined, exactly the blocks between them grow together.
    graph.add_edge(start, end)
    ring = next(b for b in nx.biconnected_components(graph) if {start, end} <= b)
    assert {cell for block, _, _ in chain for cell in mine[block]} == ring
    assert (chain[0][1], chain[-1][2]) == (start, end)
    assert all(a[2] == b[1] for a, b in itertools.pairwise(chain))


@examples(120)
@given(regions(30), st.integers(0, 9))
def test_toggles_keep_one_path_and_cycles(region, seed):
    """The change in cycles and weight that each toggle reports, against a recount."""
    rng = np.random.default_rng(seed)
    start, end = region.cells[[0, -1]].tolist()
    board = laid_board(region, start, end, rng)
    score, n_cycles = _board.score_of(board), 0
    squares = np.flatnonzero(board.is_square)
    assert squares.tolist() == squares_of(region)
    for _ in range(60 if len(squares) else 0):
        square = int(rng.choice(squares))
        change, cycles = _search.propose(board, square, 2.0, 0.5, rng)
        score += change
        n_cycles += cycles
        links = linked_graph(board, region)
        assert n_cycles == nx.number_connected_components(links) - 1
        assert score == sum(region.weight[cell] for cell in links)
        assert {cell: 1 if cell in (start, end) else 2 for cell in links} == dict(links.degree)
        check_holes(board, region, links)
    _board.drop_cycles(board, start)
    links = linked_graph(board, region)
    assert nx.has_path(links, start, end)
    assert nx.is_connected(links)
    check_holes(board, region, links)


@pytest.mark.parametrize("seed", range(4))
def test_strands_are_followed_as_far_as_asked(seed):
    """In every state: the change in cycles if within reach, else that it is not known."""
    rng = np.random.default_rng(seed)
    region = plate(8, 9)
    board = laid_board(region, *region.cells[[0, -1]].tolist(), rng)
    squares = np.flatnonzero(board.is_square)
    n_known, n_unknown = 0, 0
    for square in rng.choice(squares, 1000).tolist():
        _search.propose(board, square, 1.0, 0.2, rng)
        pattern = _board.sides(board, square)
        if pattern in (5, 10):
            n_cycles = nx.number_connected_components(linked_graph(board, region))
            _board.toggle(board, square)
            change = nx.number_connected_components(linked_graph(board, region)) - n_cycles
            _board.toggle(board, square)
            assert _board.cycle_change(board, square, pattern, 10_000) == change
            short = _board.cycle_change(board, square, pattern, _board.FIRST_LOOK)
            assert short in (change, _board.UNKNOWN)
            n_known += short == change
            n_unknown += short == _board.UNKNOWN
    assert n_known > 10
    assert n_unknown > 10


def plate(n_x, n_y):
    inside = np.pad(np.ones((n_x, n_y), bool), 1)
    return planar.region(inside.ravel(), np.ones(inside.size), inside.shape[1])


def laid_board(region, start, end, rng):
    wanted = np.full((2, 2, region.inside.size), -1, np.int32)
    board = _board.new_board(region.width, region.inside, region.weight, wanted, np.zeros(0))
    assert _search.lay(board, start, end, -1, rng)
    return board


def squares_of(region):
    cells = set(region.cells.tolist())
    steps = (0, 1, region.width, region.width + 1)
    return [cell for cell in sorted(cells) if {cell + step for step in steps} <= cells]


def check_holes(board, region, links):
    holes = board.holes[: board.n_holes[0]].tolist()
    assert sorted(holes) == sorted(set(region.cells.tolist()) - set(links))
    where = np.full(region.inside.size, -1)
    where[holes] = np.arange(len(holes))
    assert (board.hole_at == where).all()


def linked_graph(board, region):
    links = nx.Graph()
    for cell in region.cells.tolist():
        for direction, other in enumerate((cell + 1, cell + region.width)):
            if board.links[cell] >> direction & 1:
                assert board.links[other] >> (direction + 2) & 1
                links.add_edge(cell, other)
    return links


def test_a_wish_is_worth_a_detour():
    """A plate of 3 x 3 with a wish for the far side, which the heaviest path leaves out."""
    region = plate(3, 3)
    start, end = 6, 7
    rng = np.random.default_rng(0)
    for cell, axis in ((12, 0), (12, 1), (11, 1), (17, 0)):
        wishes = planar.Wishes([np.array([(cell, axis)], np.int32)], [1], np.array([50.0]))
        path, score, _ = planar.long_path(region, start, end, wishes, 8, 100, rng)
        check_path(region, path, start, end)
        other = cell + (1, 5)[axis]
        steps = {frozenset(step) for step in zip(path.tolist(), path[1:].tolist(), strict=False)}
        assert frozenset((cell, other)) in steps
        assert score == len(path) + 50.0


def test_both_ways_round_a_hole_are_found():
    """On a ring the long way round is the better one, and no square leads there."""
    inside = np.pad(np.ones((5, 5), bool), 1)
    inside[2:5, 2:5] = False
    region = planar.region(inside.ravel(), np.ones(49), 7)
    path, _, limit = planar.long_path(
        region, 8, 10, planar.NO_WISHES, 8, 100, np.random.default_rng(0)
    )
    assert len(path) == 15
    assert limit >= 15


def test_one_cell():
    inside = np.pad(np.ones((1, 1), bool), 1)
    region = planar.region(inside.ravel(), np.full(9, 2.0), 3)
    path, score, limit = planar.long_path(
        region, 4, 4, planar.NO_WISHES, 1, 1, np.random.default_rng(0)
    )
    assert (path.tolist(), score, limit) == ([4], 2.0, 2.0)


@pytest.mark.parametrize("n", [4, 9, 16])
def test_even_squares_are_filled(n):
    region = plate(n, n + n % 2)
    start = region.width + 1
    path, _, limit = planar.long_path(
        region, start, start + 1, planar.NO_WISHES, 4, 100, np.random.default_rng(0)
    )
    assert len(path) == limit == len(region.cells)


ONE_CELL_APART = np.array([[True, False, True]])


@pytest.mark.parametrize("method", ["long", "paper"])
@examples(240)
@given(grown_regions(40), st.data())
def test_planar_paths_keep_their_bound(method, mask, data):
    start, end = draw_ends(data, mask)
    found = lu.planar_path(mask, start, end, method=method)
    assert found.method == method
    assert len(found) <= found.bound <= mask.sum()
    assert found.optimal == (len(found) == found.bound)
    # Cells of a path alternate in colour.
    assert not len(found) or (len(found) + sum(start) + sum(end)) % 2
    if method == "long":
        assert found.reason == ("optimal" if found.optimal else "searched")
        assert tuple(found.cells[0]) == start
        assert tuple(found.cells[-1]) == end
    if not len(found):
        assert set(found.reason.split(", ")) <= set(paper.REASONS)


@pytest.mark.parametrize("method", lu.PLANAR_METHODS)
def test_no_path_is_a_result(method):
    found = lu.planar_path(ONE_CELL_APART, (0, 0), (0, 2), method=method)
    assert (len(found), found.bound, found.optimal) == (0, 0, True)
    assert found.reason == "ends not connected"


def test_cells_of_other_parts_do_not_matter():
    mask = np.ones((4, 9), bool)
    mask[:, 4] = False
    for method in ("long", "paper"):
        both = lu.planar_path(mask, (1, 1), (1, 2), method=method)
        alone = lu.planar_path(mask[:, :4], (1, 1), (1, 2), method=method)
        assert np.array_equal(both.cells, alone.cells)
        assert both.bound == alone.bound == 16


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"mask": np.ones((2, 2, 1), bool)}, r"mask must be \(X, Y\) bool, got bool of shape"),
        ({"mask": np.ones((2, 2))}, r"mask must be \(X, Y\) bool, got float64"),
        ({"start": (0, 3)}, r"start must be a cell \(x, y\) of the region, got \(0, 3\)"),
        ({"end": (-1, 0)}, r"end must be a cell .* got \(-1, 0\)"),
        ({"end": (0, 0, 0)}, r"end must be a cell .* got \(0, 0, 0\)"),
        ({"end": (0, 1)}, r"end must be a cell .* got \(0, 1\)"),
        ({"end": (0, 0)}, r"start and end must differ, both are \(0, 0\)"),
        ({"method": "fast"}, r"unknown planar method 'fast'; known: "),
        ({"effort": 3}, r"planar method 'long' has no option 'effort'"),
        ({"sweeps": 0}, r"sweeps must be positive, got 0"),
        ({"seed": -1}, r"seed must be at least 0, got -1"),
    ],
)
def test_planar_faults_are_named(change, message):
    problem = {"mask": ONE_CELL_APART, "start": (0, 0), "end": (0, 2)}
    with pytest.raises(ValueError, match=message):
        lu.planar_path(**(problem | change))
