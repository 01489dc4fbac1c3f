"""Certified growth: the plan stays valid and the notes true through every change."""

import itertools

import numpy as np
import pytest
from examples import examples
from hypothesis import given
from hypothesis import strategies as st
from oracles import rod_fault, swept_points
from polycubes import polycubes

import lineup as lu
from lineup import grid
from lineup.folding import _fold, _moves, _piece
from lineup.folding.growing import _exposed_bar, body_of, straightenable
from lineup.layered import layered_paths
from lineup.motion._chain import cells_of
from lineup.motion.plan import left_folded, motion_of, peel_plan


def block(*shape):
    return lu.VoxelSolid(np.ones(shape, bool))


class Grown:
    """A fold under change, with the checks that hold between changes."""

    def __init__(self, solid, start, seed, states=None):
        self.rng = np.random.default_rng(seed)
        self.grid, self.body = body_of(solid)
        cells = cells_of(start, solid.occupancy.shape)
        if states is None:
            cells, states = straightenable(self.grid, cells, self.rng, tries=40)
        self.fold = _fold.new_fold(self.grid, self.body, cells, states)

    @property
    def path(self):
        return _fold.path_of(self.fold).astype(int)

    @property
    def voxels(self):
        return self.grid.xyz[self.path]

    @property
    def states(self):
        return _fold.states_of(self.fold)

    def plan_anew(self):
        """Another plan of the path, in which both ends let go by turns, if one is found."""
        states = peel_plan(self.grid, self.path, self.rng, bias=0.5)
        if left_folded(states) <= 1:
            _fold.load(self.fold, self.path, states)

    def change(self):
        """Some random certified changes of one kind."""
        fold, rng = self.fold, self.rng
        kind = rng.integers(4)
        if kind == 3:
            self.plan_anew()
        elif kind == 0:
            _moves.fill(fold, 40, _fold.NEVER, rng)
        elif kind == 1:
            _moves.anneal(fold, 10, 3.0, 0.1, _fold.NEVER, rng)
        else:
            length = int(rng.integers(2, len(self.path) + 1))
            keep, longest = rng.random(len(self.body.solid)) < 0.3, 2 * int(rng.integers(1, 6))
            _moves.contract_all(fold, keep, length, longest, False)

    def snapshot(self):
        """All that a fold holds; what is noted of numbers not in use is left out."""
        fold = self.fold
        path, plan = ordered(fold, _fold.NEXT), ordered(fold, _fold.AFTER)
        return [
            path,
            plan,
            fold.notes[_fold.RANK, path].tolist(),
            fold.notes[_fold.TIME : _fold.COUNT, plan].tolist(),
            fold.free.tolist(),
            float(fold.worth[0]),
        ]

    def check(self, solid):
        inside = solid.occupancy[tuple(self.voxels.T)]
        assert inside.all()
        assert len(np.unique(self.voxels, axis=0)) == len(self.voxels)
        assert rod_fault(self.voxels, self.states) == ""
        assert self.states[-1, 1] - self.states[-1, 0] == 1
        check_notes(self.fold, self.body)
        anew = _fold.new_fold(self.grid, self.body, self.path, self.states)
        assert events(anew) == events(self.fold)
        assert lu.certify(motion_of(self.voxels, self.states)).reason == "certified"


def ordered(fold, onward):
    """Numbers of joints or events, in order."""
    numbers, root = [], _fold.root_of(fold)
    number = int(fold.notes[onward, root])
    while number != root:
        numbers.append(number)
        number = int(fold.notes[onward, number])
    return numbers


def events(fold):
    """What a fold notes of each event; swings have no numbers of their own."""
    n_cells = len(fold.free)
    return [
        (min(event, n_cells), *fold.notes[_fold.END : _fold.COUNT, event].tolist())
        for event in ordered(fold, _fold.AFTER)
    ]


def check_notes(fold, body):
    """Links, labels, holes and worth of a fold, worked out in plain Python."""
    notes, root = fold.notes, _fold.root_of(fold)
    rows = ((_fold.NEXT, _fold.BACK, _fold.RANK), (_fold.AFTER, _fold.BEFORE, _fold.TIME))
    for onward, back, label in rows:
        circle = [root, *ordered(fold, onward), root]
        for number, following in itertools.pairwise(circle):
            assert notes[back, following] == number
            assert following == root or notes[label, number] < notes[label, following]
    path, plan = ordered(fold, _fold.NEXT), ordered(fold, _fold.AFTER)
    n_cells = len(fold.free)
    assert set(np.flatnonzero(notes[_fold.RANK, :n_cells] >= 0)) == set(path)
    assert set(np.flatnonzero(notes[_fold.TIME] < _fold.NEVER)) == {root, *plan}
    assert set(np.flatnonzero(notes[_fold.ROD] >= 0)) == set(plan)
    assert np.array_equal(fold.free, body.solid & ~np.isin(np.arange(n_cells), path))
    assert (fold.piece == -1).all()
    assert fold.worth[0] == body.weight[path].sum()
    assert _fold.n_joints(fold) == len(path)


@given(polycubes(60), st.integers(0, 2**32 - 1))
@examples(60)
def test_plan_and_notes_stay_true_through_random_changes(occupancy, seed):
    if occupancy.sum() < 2:
        return
    solid = lu.VoxelSolid(occupancy)
    grown = Grown(solid, layered_paths(solid, seed % 100, starts=1)[0].voxels, seed)
    grown.check(solid)
    for _ in range(5):
        grown.change()
        grown.check(solid)


@pytest.mark.parametrize("seed", range(12))
def test_rods_of_two_busy_ends_keep_clear_of_each_other(seed):
    solid = block(*[(4, 4, 3), (3, 3, 5), (5, 4, 2)][seed % 3])
    start = layered_paths(solid, seed, starts=1)[0].voxels[: 12 + seed]
    grown = Grown(solid, start, seed)
    for _ in range(25):
        grown.plan_anew()
        length = int(grown.rng.integers(6, len(grown.path) + 1))
        keep = grown.rng.random(len(grown.body.solid)) < 0.3
        _moves.contract_all(grown.fold, keep, length, 2, False)
        _moves.anneal(grown.fold, 4, 9.0, 9.0, _fold.NEVER, grown.rng)
        assert rod_fault(grown.voxels, grown.states) == ""


@pytest.mark.parametrize("seed", range(20))
def test_a_first_rod_may_only_grow_where_nothing_is_in_its_way(seed):
    solid = block(3, 3, 3)
    bar = np.array([(1, 1, 1), (1, 1, 2)])[:: (-1) ** seed]
    grown = Grown(solid, bar, seed, np.array([[0, 1, seed % 6, seed // 3 % 6]], np.int32))
    for _ in range(4):
        _moves.fill(grown.fold, 20, _fold.NEVER, grown.rng)
        grown.check(solid)


EAST, UP, WEST = 0, 2, 3


@pytest.mark.parametrize(
    ("states", "hole"),
    [
        ([(0, 2, WEST, UP), (1, 2, WEST, UP)], (0, 0, 1)),
        ([(0, 2, UP, EAST), (0, 1, UP, EAST)], (2, 0, 1)),
    ],
    ids=["front", "back"],
)
def test_the_last_bar_is_led_past_by_the_end_that_has_a_rod(states, hole):
    # The idle end's direction means nothing yet: here it points at a hole to be filled.
    occupancy = np.ones((3, 1, 2), bool)
    occupancy[hole] = False
    solid, bars = lu.VoxelSolid(occupancy), np.array([(0, 0, 0), (1, 0, 0), (2, 0, 0)])
    grown = Grown(solid, bars, 0, np.array(states, np.int32))
    _moves.fill(grown.fold, 200, _fold.NEVER, grown.rng)
    grown.check(solid)
    assert len(grown.voxels) == 5


def random_piece(grown):
    """Places i < j in a path, perhaps beyond a tip, and cells that join them or lead off."""
    fold, rng, path = grown.fold, grown.rng, grown.path
    n = len(path)
    i = int(rng.integers(-1, n - 1))
    j = int(min(n - int(i < 0), i + rng.integers(1, 8)))
    free = fold.free.copy()
    free[path[max(i, 0) : j + 1]] = True
    if i >= 0 and j < n:
        way = _moves.random_shortest(grown.grid, free, path[i], path[j], 9.0, rng)
        return i, j, way[1:-1]
    holes = np.flatnonzero(fold.free)
    if not len(holes):
        return i, j, np.empty(0, np.int32)
    joint = path[j] if i < 0 else path[i]
    way = _moves.random_shortest(grown.grid, free, joint, rng.choice(holes), 9.0, rng)[1:]
    return i, j, way[::-1].copy() if i < 0 else way


@given(polycubes(80), st.integers(0, 2**32 - 1))
@examples(48)
def test_a_change_does_what_it_says_and_a_refused_one_or_one_undone_leaves_no_trace(
    occupancy, seed
):
    if occupancy.sum() < 4:
        return
    solid = lu.VoxelSolid(occupancy)
    grown = Grown(solid, layered_paths(solid, 0, starts=1)[0].voxels, seed)
    for _ in range(30):
        i, j, new = random_piece(grown)
        _fold.commit(grown.fold)
        before, voxels = grown.snapshot(), grown.voxels
        root = _fold.root_of(grown.fold)
        joints = [root, *grown.path.tolist(), root]
        changed = _piece.replace(grown.fold, joints[i + 1], joints[j + 1], new)
        if changed:
            expected = [voxels[: i + 1], grown.grid.xyz[new], voxels[j:]]
            assert np.array_equal(grown.voxels, np.concatenate(expected))
            grown.check(solid)
        if not changed or grown.rng.random() < 0.3:
            _fold.undo(grown.fold)
            assert grown.snapshot() == before
            grown.check(solid)


@pytest.mark.parametrize("rod", [0, 3])
@pytest.mark.parametrize("tip", [0, 1])
def test_a_path_grows_and_shrinks_at_its_tips(tip, rod):
    solid = block(6, 1, 1)
    middle = np.argwhere(solid.occupancy)[2:4]
    grown = Grown(solid, middle, 0, np.array([[0, 1, rod, 0]], np.int32))
    root, cells = _fold.root_of(grown.fold), grown.fold.cells.astype(np.int32)
    for begin, stop in [(0, 4), (2, 6)][tip], (2, 4):
        front, back = grown.path[[0, -1]].tolist()
        new = cells[begin : stop - 1] if tip == 0 else cells[begin + 1 : stop]
        u, v = (root, back) if tip == 0 else (front, root)
        assert _piece.replace(grown.fold, u, v, new)
        grown.check(solid)
        assert np.array_equal(grown.path, cells[begin:stop])


def test_where_labels_have_no_gap_a_change_waits_for_new_ones():
    solid = block(2, 2, 1)
    grown = Grown(solid, np.argwhere(solid.occupancy)[:2], 0, np.array([[0, 1, 0, 0]], np.int32))
    front, back = grown.path
    new = np.array([front, back], np.int32) + grown.grid.offset[0]
    grown.fold.notes[_fold.RANK, [front, back]] = 1, 2
    assert not _piece.replace(grown.fold, front, back, new)
    grown.check(solid)
    _fold.commit(grown.fold)
    assert _piece.replace(grown.fold, front, back, new)
    grown.check(solid)


@given(polycubes(60), st.integers(0, 2**32 - 1))
@examples(80)
def test_swept_cells_are_those_of_the_point_sets(occupancy, seed):
    if occupancy.sum() < 2:
        return
    solid = lu.VoxelSolid(occupancy)
    grown = Grown(solid, layered_paths(solid, 0, starts=1)[0].voxels, seed)
    grown.change()
    _moves.contract_all(grown.fold, np.zeros(len(grown.body.solid), bool), 6, 2, False)
    off_path = np.flatnonzero(grown.fold.free)
    tips = grown.path[[0, -1]]
    moves = [e for e in ordered(grown.fold, _fold.AFTER) if e not in tips]
    for k in range(0, len(moves) + 1, max(1, len(moves) // 5)):
        swept = swept_points(grown.voxels, grown.states, k, max(occupancy.shape))
        limit = grown.fold.notes[_fold.TIME, moves[k - 1]] if k else 0
        for cell in off_path:
            expected = tuple(grown.grid.xyz[cell].tolist()) in swept
            assert _piece.swept_before(grown.fold, cell, limit) == expected


def test_contraction_keeps_what_it_must_and_stops_at_the_length():
    solid = block(5, 5, 4)
    grown = Grown(solid, layered_paths(solid, 0, starts=1)[0].voxels, 0)
    keep = np.pad(grid.surface(solid.occupancy), 1).ravel()
    kept = keep & ~grown.fold.free
    n = len(grown.voxels)
    _moves.contract_all(grown.fold, keep, n - 4, 2, False)
    grown.check(solid)
    assert n - 4 <= len(grown.voxels) < n
    assert not grown.fold.free[kept].any()
    _moves.contract_all(grown.fold, np.zeros_like(keep), 2, 2, False)
    grown.check(solid)
    assert len(grown.voxels) < n // 2


def test_filling_stops_at_the_target():
    solid = block(5, 5, 4)
    for target in (2, 3, 10, 51):
        grown = Grown(solid, _exposed_bar(solid), 0)
        _moves.fill(grown.fold, 10**5, target, grown.rng)
        assert len(grown.voxels) == target - target % 2


def test_annealing_ends_with_the_best_it_met():
    solid = lu.model("duck", voxels=150)
    grown = Grown(solid, layered_paths(solid, 0, starts=1)[0].voxels, 0)
    for _ in range(5):
        before = grown.fold.worth[0]
        _moves.anneal(grown.fold, 40, 9.0, 9.0, _fold.NEVER, grown.rng)
        assert grown.fold.worth[0] >= before
        grown.check(solid)
