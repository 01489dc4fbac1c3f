"""Annealing on the voxel graph: the state against plain twins, and what the paths must keep."""

import networkx as nx
import numpy as np
import pytest
from contracts import check_path
from examples import examples
from hypothesis import assume, given
from hypothesis import strategies as st
from oracles import longest_path, voxel_graph
from polycubes import polycubes

import lineup as lu
from lineup import grid
from lineup.spatial import _anneal, _loops, _nested, _solids, _strands, nesting, without_us
from lineup.spatial._anneal import Stage, Terms

HOT = Stage(Terms(2.0, 0.5, 0.2, 3.0), Terms(0.3, 2.0, 1.0, 3.0))
QUICK = {"starts": 1, "sweeps": 300}
SMALL = {"free3d": QUICK, "ufree": QUICK, "nested": QUICK}


def linked_graph(board):
    """The links of a board, as a graph of cells."""
    graph = nx.Graph()
    for cell in np.flatnonzero(board.links).tolist():
        for d in range(6):
            if board.links[cell] >> d & 1:
                graph.add_edge(cell, cell + int(board.stride[d]))
    return graph


def check_board(board):
    """Strands, keys, ends, and counts of cycles and Us, all against the links alone."""
    graph = linked_graph(board)
    assert all(board.weight[cell] > 0 for cell in graph)
    assert sorted(graph) == np.flatnonzero(board.strand >= 0).tolist()
    ends = sorted(cell for cell in graph if graph.degree[cell] == 1)
    assert ends == sorted(board.ends.tolist())
    assert all(graph.degree[cell] == 2 for cell in set(graph) - set(ends))
    strands = [sorted(cells) for cells in nx.connected_components(graph)]
    assert board.tally[_strands.N_CYCLES] == len(strands) - 1
    for cells in strands:
        assert len({int(board.strand[cell]) for cell in cells}) == 1
        check_order(board, cells)
    us = [4 if n == 4 else int(n == 3) for n in edges_on_squares(board, graph)]
    assert board.tally[_strands.N_US] == sum(us)


def check_order(board, cells):
    """`ahead` runs once along the strand, and the keys rise with it but for one step of a cycle."""
    is_path = board.strand[cells[0]] == _strands.PATH
    start = int(board.ends[0]) if is_path else cells[0]
    way = [start]
    while (d := board.ahead[way[-1]]) != _strands.NO_DIRECTION:
        assert board.links[way[-1]] >> d & 1
        way.append(way[-1] + int(board.stride[d]))
        if way[-1] == start:
            break
    rises = np.diff(board.key[way]) > 0
    assert sorted(set(way)) == cells
    assert (~rises).sum() == (0 if is_path else 1)
    assert way[-1] == (int(board.ends[1]) if is_path else start)


def edges_on_squares(board, graph):
    """Links on each unit square that has any."""
    sides_of = {}
    for p, q in graph.edges:
        low, step = min(p, q), abs(p - q)
        for b in set(board.stride[:3].tolist()) - {step}:
            for least in (low, low - b):
                sides_of.setdefault((least, step + b), []).append((p, q))
    return map(len, sides_of.values())


def lay_first_link(board):
    """A path of two voxels."""
    start = int(np.flatnonzero(board.weight)[0])
    beside = start + board.stride
    _strands.lay(board, np.array([start, beside[board.weight[beside] > 0][0]]))


def annealed(occupancy, seed, rounds=12, proposals=40):
    """A board after each of a few short, hot rounds."""
    solid = lu.VoxelSolid(occupancy)
    board = _solids.board_of(solid, 1.5)
    loops = _loops.loops_of(board.weight > 0, board.stride)
    lay_first_link(board)
    rng = np.random.default_rng(seed)
    for _ in range(rounds):
        _anneal.anneal(board, loops, HOT, proposals, rng)
        yield board


@examples(80)
@given(polycubes(50), st.integers(0, 9))
def test_the_state_is_what_the_links_say(occupancy, seed):
    assume(occupancy.sum() > 1)
    for board in annealed(occupancy, seed):
        check_board(board)


def test_the_state_holds_where_strands_are_long():
    for board in annealed(np.ones((6, 5, 4), bool), 0, rounds=60, proposals=300):
        check_board(board)


def test_keys_that_run_out_are_given_anew(monkeypatch):
    """Detours into one gap halve it 32 times at most; then the strand is walked."""
    board = next(annealed(np.ones((4, 4, 1), bool), 0, rounds=1, proposals=0))
    cells = _strands.path_cells(board)
    board.key[cells] = np.arange(len(cells))
    loops = _loops.loops_of(board.weight > 0, board.stride)
    _anneal.anneal(board, loops, HOT, 500, np.random.default_rng(1))
    check_board(board)


def test_the_lattice_polygons_are_as_many_as_known():
    """3, 22 and 207 polygons a site of the simple cubic lattice; all simple and different."""
    for n_sides, count in zip(_loops.LENGTHS, (3, 22, 207), strict=True):
        shapes = _loops.polygons(n_sides)
        assert len(shapes) == count
        assert len({frozenset(map(frozenset, sides(shape))) for shape in shapes}) == count
        for shape in shapes:
            assert len(set(shape)) == n_sides
            assert all(
                sum(abs(a - b) for a, b in zip(p, q, strict=True)) == 1 for p, q in sides(shape)
            )


def sides(corners):
    return list(zip(corners, [*corners[1:], corners[0]], strict=True))


@examples(120)
@given(polycubes(14))
def test_the_loops_of_a_solid_are_its_short_cycles(occupancy):
    board = _solids.board_of(lu.VoxelSolid(occupancy), 1.0)
    loops = _loops.loops_of(board.weight > 0, board.stride)
    graph = voxel_graph(occupancy)
    cycles = nx.simple_cycles(graph, length_bound=8)
    by_length = np.bincount([len(c) for c in cycles], minlength=9)[[4, 6, 8]]
    assert np.diff(loops.first).tolist() == by_length.tolist()


@examples(60)
@given(polycubes(40))
def test_exits_see_no_voxel_ahead(occupancy):
    board = _solids.board_of(lu.VoxelSolid(occupancy), 1.0)
    voxels = np.argwhere(occupancy)
    for voxel, cell in zip(voxels, _solids.cells_of(voxels, lu.VoxelSolid(occupancy)), strict=True):
        for d, direction in enumerate(grid.DIRECTIONS):
            ahead = [tuple(voxel + k * direction) for k in range(1, 50)]
            blocked = bool(set(ahead) & set(map(tuple, voxels.tolist())))
            assert (board.exits[cell] >> d & 1) == (not blocked)


@pytest.mark.parametrize("method", SMALL)
@examples(60)
@given(polycubes(50), st.integers(0, 3))
def test_every_polycube_has_a_path(method, occupancy, seed):
    assume(occupancy.sum() > 1)
    solid = lu.VoxelSolid(occupancy)
    path = lu.layered_path(solid, method, seed, **SMALL[method])
    check_path(path, solid)
    u_free = method == "ufree"
    assert lu.certify_path(path, solid, u_free=u_free).ok
    assert len(path) <= lu.path_bound(solid, u_free=u_free)
    assert len(path.visits) == 0 or method == "nested"


@pytest.mark.parametrize("method", SMALL)
def test_equal_seeds_give_equal_paths(method):
    solid = lu.VoxelSolid(np.ones((5, 4, 3), bool))
    first, again = (lu.layered_path(solid, method, 3, **SMALL[method]) for _ in range(2))
    assert np.array_equal(first.voxels, again.voxels)
    other = lu.layered_path(solid, method, 4, **SMALL[method])
    assert not np.array_equal(first.voxels, other.voxels)


def random_polycube(rng, n):
    voxels = {(0, 0, 0)}
    while len(voxels) < n:
        grown = (
            np.array(sorted(voxels))[rng.integers(len(voxels))] + grid.DIRECTIONS[rng.integers(6)]
        )
        voxels.add(tuple(grown.tolist()))
    points = np.array(sorted(voxels))
    points -= points.min(axis=0)
    occupancy = np.zeros(points.max(axis=0) + 1, bool)
    occupancy[tuple(points.T)] = True
    return occupancy & ~grid.voids(occupancy)


def test_free_paths_of_small_solids_are_longest():
    """On 30 random polycubes: never longer than exhaustive search, and seldom shorter."""
    rng = np.random.default_rng(0)
    lost = []
    for _ in range(30):
        solid = lu.VoxelSolid(random_polycube(rng, int(rng.integers(2, 12))))
        longest = longest_path(voxel_graph(solid.occupancy))
        path = lu.layered_path(solid, "free3d", starts=1, surface_weight=1.0)
        lost.append(longest - longest % 2 - len(path))
    assert min(lost) == 0
    assert np.mean(np.array(lost) == 0) >= 0.95


def test_cutting_us_short_leaves_none():
    """A comb of teeth, all Us: what stays is its back."""
    word = "NESE" * 4 + "E"
    steps = np.array([grid.DIRECTIONS[grid.LETTERS.index(c)] for c in word])
    voxels = np.vstack([[0, 0, 0], steps.cumsum(axis=0)])
    solid = lu.VoxelSolid(np.ones((10, 2, 1), bool))
    board = _solids.board_of(solid, 1.0)
    cells = without_us.cut_short(_solids.cells_of(voxels, solid), board)
    kept = _solids.path_through(cells, solid, "")
    assert kept.voxels.tolist() == [[x, 0, 0] for x in range(10)]


def test_the_way_out_closes_no_u():
    """From the bottom of a pit the one way out is up: not for a path that has just come down."""
    cup = np.ones((5, 5, 4), bool)
    cup[2, 2, 2:] = False
    solid = lu.VoxelSolid(cup)
    board = _solids.board_of(solid, 1.0)
    down_and_in = np.array([(2, 2, 1), (2, 1, 1), (2, 1, 2), (3, 1, 2)])
    along_and_in = np.array([(2, 2, 1), (2, 1, 1), (3, 1, 1), (3, 1, 2)])
    for voxels, out in ((down_and_in, False), (along_and_in, True)):
        assert without_us.has_exit(_solids.cells_of(voxels, solid), board) == out


def nest_of(occupancy, seed):
    solid = lu.VoxelSolid(occupancy)
    path = lu.layered_path(solid, seed=seed, starts=1, sweeps=20)
    board = _solids.board_of(solid, 1.5)
    _strands.lay(board, _solids.cells_of(path.voxels, solid))
    return solid, board, nesting._nest_of(path, solid, board)


@examples(60)
@given(polycubes(50), st.integers(0, 9))
def test_every_state_on_the_way_is_nested(occupancy, seed):
    """The judge on the path and a plain twin on everything else, cycles included."""
    assume(occupancy.sum() > 1)
    solid, board, nest = nest_of(occupancy, seed)
    loops = _loops.loops_of(board.weight > 0, board.stride)
    rng = np.random.default_rng(seed)
    for _ in range(12):
        _nested.anneal_nested(board, nest, loops, HOT, 40, rng)
        check_board(board)
        check_pieces(board, nest)
        cells = _strands.path_cells(board)
        path = nesting.path_in_pieces(cells, nest, solid)
        assert lu.certify_path(path, solid).reason == "certified"


def check_pieces(board, nest):
    """Labels are the components of the links in layers and of the bridges' two halves."""
    graph = nx.Graph()
    graph.add_nodes_from(np.flatnonzero(board.links).tolist())
    for cell in list(graph):
        for d in (0, 1):
            if board.links[cell] >> d & 1:
                graph.add_edge(cell, cell + int(board.stride[d]))
        if board.links[cell] >> 2 & 1 and nest.mate[cell] != _nested.SINGLE:
            beside = cell + int(board.stride[nest.mate[cell]])
            above = int(board.stride[2])
            assert (
                cell + int(board.stride[nest.mate[beside]] + board.stride[nest.mate[cell]]) == cell
            )
            assert board.links[beside] >> 2 & 1
            graph.add_edge(cell, beside)
            graph.add_edge(cell + above, beside + above)
    pieces = list(nx.connected_components(graph))
    labels = [{int(nest.piece[cell]) for cell in piece} for piece in pieces]
    assert all(len(label) == 1 for label in labels)
    assert len(set.union(*labels)) == len(pieces)
