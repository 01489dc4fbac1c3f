"""Certified growth: the plan stays valid and the notes true through every change."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import rod_fault, swept_points
from polycubes import polycubes

import lineup as lu
from lineup import grid
from lineup.folding import _fold, _moves
from lineup.folding.growth import _exposed_bar, body_of, straightenable
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
        self.fold = _fold.new_fold(len(self.body.solid), cells, states, solid.size + 16)

    @property
    def voxels(self):
        return self.grid.xyz[self.fold.path[: self.fold.size[0]]]

    @property
    def states(self):
        return self.fold.states[: self.fold.size[1]]

    def change(self):
        """Some random certified changes of one kind."""
        fold, rng = self.fold, self.rng
        kind = rng.integers(4)
        if kind == 3:  # a plan in which both ends let go by turns
            path = fold.path[: fold.size[0]].copy()
            states = peel_plan(self.grid, path, rng, bias=0.5)
            if left_folded(states) <= 1:
                _fold.load(fold, path, states)
        elif kind == 0:
            _moves.fill(self.grid, self.body, fold, 40, _fold.NEVER, rng)
        elif kind == 1:
            _moves.anneal(self.grid, self.body, fold, 10, 3.0, 0.1, _fold.NEVER, rng)
        else:
            length = int(rng.integers(2, fold.size[0] + 1))
            keep, longest = rng.random(len(self.body.solid)) < 0.3, 2 * int(rng.integers(1, 6))
            _moves.contract_all(self.grid, fold, keep, length, longest, False)

    def snapshot(self):
        fold = self.fold
        counts = dict(zip(("path", "states", "swings"), fold.size.tolist(), strict=True))
        return {name: a[: counts.get(name)].copy() for name, a in fold._asdict().items()}

    def check(self, solid):
        inside = solid.occupancy[tuple(self.voxels.T)]
        assert inside.all()
        assert len(np.unique(self.voxels, axis=0)) == len(self.voxels)
        assert rod_fault(self.voxels, self.states) == ""
        assert self.states[-1, 1] - self.states[-1, 0] == 1
        assert (self.fold.piece == -1).all()
        check_notes(self.fold)
        before = self.snapshot()
        _fold.refresh(self.fold)
        assert_same(before, self.snapshot())
        assert lu.certify(motion_of(self.voxels, self.states)).reason == "certified"


def assert_same(before, after):
    for name, array in before.items():
        assert np.array_equal(array, after[name]), name


def check_notes(fold):
    """What a fold notes of its plan, worked out in plain Python."""
    n, n_states, n_swings = fold.size.tolist()
    path, states = fold.path[:n].tolist(), fold.states[:n_states].tolist()
    joint = {cell: k for k, cell in enumerate(path)}
    arrival, swings = {}, []
    for end in range(2):
        if states[-1][end] != (n - 1) * end:
            arrival[path[(n - 1) * end]] = (-1, states[0][2 + end])
    for k, (old, new) in enumerate(itertools.pairwise(states)):
        for end in range(2):
            if old[end] != new[end]:
                arrival[path[new[end]]] = (k, new[2 + end])
            elif old[2 + end] != new[2 + end]:
                swings.append([path[new[end]], old[2 + end], new[2 + end], k])
    assert fold.swings[:n_swings].tolist() == swings
    for cell in range(len(fold.joint)):
        assert fold.joint[cell] == joint.get(cell, -1)
        assert (fold.when[cell], fold.rod[cell]) == arrival.get(cell, (_fold.NEVER, -1))


@given(polycubes(60), st.integers(0, 2**32 - 1))
@settings(max_examples=40)
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
        path = grown.fold.path[: grown.fold.size[0]].copy()
        states = peel_plan(grown.grid, path, grown.rng, bias=0.5)
        if left_folded(states) <= 1:
            _fold.load(grown.fold, path, states)
        length = int(grown.rng.integers(6, len(path) + 1))
        _moves.contract_all(
            grown.grid,
            grown.fold,
            grown.rng.random(len(grown.body.solid)) < 0.3,
            length,
            2,
            False,
        )
        _moves.anneal(grown.grid, grown.body, grown.fold, 4, 9.0, 9.0, _fold.NEVER, grown.rng)
        assert rod_fault(grown.voxels, grown.states) == ""


@pytest.mark.parametrize("seed", range(20))
def test_a_first_rod_may_only_grow_where_nothing_is_in_its_way(seed):
    solid = block(3, 3, 3)
    bar = np.array([(1, 1, 1), (1, 1, 2)])[:: (-1) ** seed]
    grown = Grown(solid, bar, seed, np.array([[0, 1, seed % 6, seed // 3 % 6]], np.int32))
    for _ in range(4):
        _moves.fill(grown.grid, grown.body, grown.fold, 20, _fold.NEVER, grown.rng)
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
    _moves.fill(grown.grid, grown.body, grown.fold, 200, _fold.NEVER, grown.rng)
    grown.check(solid)
    assert len(grown.voxels) == 5


def random_piece(grown):
    """Joints i < j of a fold and cells that join them through holes and what lies between."""
    fold, rng, n = grown.fold, grown.rng, int(grown.fold.size[0])
    i = int(rng.integers(0, n - 1))
    j = int(min(n - 1, i + rng.integers(1, 8)))
    free = grown.body.solid & (fold.joint < 0)
    free[fold.path[i : j + 1]] = True
    way = _moves.random_shortest(grown.grid, free, fold.path[i], fold.path[j], 9.0, rng)
    return i, j, way[1:-1]


@given(polycubes(80), st.integers(0, 2**32 - 1))
@settings(max_examples=25)
def test_a_refused_change_leaves_no_trace(occupancy, seed):
    if occupancy.sum() < 4:
        return
    solid = lu.VoxelSolid(occupancy)
    grown = Grown(solid, layered_paths(solid, 0, starts=1)[0].voxels, seed)
    for _ in range(30):
        i, j, new = random_piece(grown)
        before = grown.snapshot()
        voxels = grown.voxels.copy()
        if _fold.replace(grown.grid, grown.fold, i, j, new):
            expected = [voxels[: i + 1], grown.grid.xyz[new], voxels[j:]]
            assert np.array_equal(grown.voxels, np.concatenate(expected))
            grown.check(solid)
        else:
            assert_same(before, grown.snapshot())


@given(polycubes(60), st.integers(0, 2**32 - 1))
@settings(max_examples=20)
def test_swept_cells_are_those_of_the_point_sets(occupancy, seed):
    if occupancy.sum() < 2:
        return
    solid = lu.VoxelSolid(occupancy)
    grown = Grown(solid, layered_paths(solid, 0, starts=1)[0].voxels, seed)
    grown.change()
    _moves.contract_all(grown.grid, grown.fold, np.zeros(len(grown.body.solid), bool), 6, 2, False)
    off_path = np.flatnonzero(grown.body.solid & (grown.fold.joint < 0))
    reach = max(occupancy.shape)
    for k in range(0, len(grown.states), max(1, len(grown.states) // 5)):
        swept = swept_points(grown.voxels, grown.states, k, reach)
        for cell in off_path:
            expected = tuple(grown.grid.xyz[cell].tolist()) in swept
            assert _fold.swept_before(grown.grid, grown.fold, cell, k) == expected


def test_contraction_keeps_what_it_must_and_stops_at_the_length():
    solid = block(5, 5, 4)
    grown = Grown(solid, layered_paths(solid, 0, starts=1)[0].voxels, 0)
    keep = np.pad(grid.surface(solid.occupancy), 1).ravel()
    kept = keep & (grown.fold.joint >= 0)
    n = len(grown.voxels)
    _moves.contract_all(grown.grid, grown.fold, keep, n - 4, 2, False)
    grown.check(solid)
    assert n - 4 <= len(grown.voxels) < n
    assert (grown.fold.joint[kept] >= 0).all()
    _moves.contract_all(grown.grid, grown.fold, np.zeros_like(keep), 2, 2, False)
    grown.check(solid)
    assert len(grown.voxels) < n // 2


def test_filling_stops_at_the_target():
    solid = block(5, 5, 4)
    for target in (2, 3, 10, 51):
        grown = Grown(solid, _exposed_bar(solid), 0)
        _moves.fill(grown.grid, grown.body, grown.fold, 10**5, target, grown.rng)
        assert len(grown.voxels) == target - target % 2


def test_annealing_ends_with_the_best_it_met():
    solid = lu.model("duck", voxels=150)
    grown = Grown(solid, layered_paths(solid, 0, starts=1)[0].voxels, 0)
    for _ in range(5):
        before = _moves.worth(grown.body, grown.fold)
        _moves.anneal(grown.grid, grown.body, grown.fold, 40, 9.0, 9.0, _fold.NEVER, grown.rng)
        assert _moves.worth(grown.body, grown.fold) >= before
        grown.check(solid)
