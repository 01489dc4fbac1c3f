"""Certified growth: the plan stays valid and the bookkeeping true through every change."""

import itertools
from dataclasses import replace as with_changes

import numpy as np
import pytest
from contracts import check_folding
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import rod_fault, swept_points
from polycubes import polycubes

import lineup as lu
from lineup import grid
from lineup.folding import _fold, _moves
from lineup.folding.growth import _exposed_bar, body_of, straightenable
from lineup.kinematics import Move
from lineup.layered import layered_paths
from lineup.motion._chain import cells_of
from lineup.motion.plan import motion_of

QUICK = {"trial_rounds": 20, "rounds": 60}


def block(*shape):
    return lu.VoxelSolid(np.ones(shape, bool))


def solid_of(points):
    occupancy = np.zeros(np.max(points, axis=0) + 1, bool)
    occupancy[tuple(np.array(points).T)] = True
    return lu.VoxelSolid(occupancy)


def plus(arm, thick=1):
    """Six arms along the axes."""
    occupancy = np.zeros((2 * arm + thick,) * 3, bool)
    middle = slice(arm, arm + thick)
    occupancy[:, middle, middle] = occupancy[middle, :, middle] = occupancy[middle, middle] = True
    return lu.VoxelSolid(occupancy)


def comb(teeth, length, axis=2):
    points = [(2 * t, 0, h) for t in range(teeth) for h in range(length)]
    points += [(x, 0, 0) for x in range(2 * teeth - 1)]
    return solid_of(np.roll(points, axis - 2, axis=1))


def ring(side, thick=1, axis=2):
    """A square frame, one voxel high."""
    occupancy = np.ones((side, side, 1), bool)
    occupancy[thick:-thick, thick:-thick] = False
    return lu.VoxelSolid(np.moveaxis(occupancy, 2, axis))


def random_tree(seed, n):
    """Branches one voxel wide: each new voxel touches one other."""
    rng = np.random.default_rng(seed)
    points = [(0, 0, 0)]
    while len(points) < n:
        root = points[rng.integers(len(points))]
        new = tuple((root + grid.DIRECTIONS[rng.integers(6)]).tolist())
        beside = [tuple((new + d).tolist()) in points for d in grid.DIRECTIONS]
        if new not in points and sum(beside) == 1:
            points.append(new)
    return lu.mend(solid_of(np.array(points) - np.min(points, axis=0)).occupancy)


SOLIDS = {
    "two voxels, lying": block(2, 1, 1),
    "two voxels, standing": block(1, 1, 2),
    "three voxels": block(1, 3, 1),
    "stick": block(1, 1, 41),
    "lying stick": block(41, 1, 1),
    "plate": block(7, 6, 1),
    "standing plate": block(1, 6, 7),
    "odd plate": block(5, 5, 1),
    "cube": block(4, 4, 4),
    "odd cube": block(3, 3, 3),
    "plus": plus(5),
    "thick plus": plus(3, 2),
    "comb": comb(6, 7),
    "lying comb": comb(6, 7, axis=0),
    "ring": ring(8),
    "standing ring": ring(8, axis=0),
    "wide ring": ring(7, thick=2, axis=1),
    "tree": random_tree(1, 60),
    "tall tree": random_tree(2, 60),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_every_kind_of_solid_is_folded(name):
    solid = SOLIDS[name]
    folding = lu.fold(solid, **QUICK)
    check_folding(folding, solid)
    if name in {"stick", "lying stick", "plate", "standing plate", "cube", "ring", "wide ring"}:
        assert len(folding.path) == solid.size - solid.size % 2


@given(polycubes(200), st.integers(0, 99))
@settings(max_examples=20)
def test_every_polycube_is_folded(occupancy, seed):
    if occupancy.sum() > 1:
        solid = lu.VoxelSolid(occupancy)
        check_folding(lu.fold(solid, seed=seed, trial_rounds=5, rounds=20), solid)


def test_growth_needs_no_path_to_start_from():
    solid = block(5, 4, 4)
    folding = lu.fold(solid, paths=[], **QUICK)
    check_folding(folding, solid)
    assert folding.path.coverage(solid) > 0.8


def test_layered_folding_unfolds_a_layered_path():
    solid = block(4, 4, 3)
    folding = lu.fold(solid, method="layered", starts=2)
    check_folding(folding, solid)
    assert np.array_equal(folding.path.voxels, lu.layered_path(solid, starts=2).voxels)


def test_the_seed_alone_decides(tmp_path):
    solid = lu.model("duck", voxels=120)
    for k, seed in enumerate((1, 1, 2)):
        lu.save(lu.fold(solid, seed=seed, **QUICK), tmp_path / f"{k}.json")
    first, again, other = ((tmp_path / f"{k}.json").read_bytes() for k in range(3))
    assert first == again
    assert first != other


@pytest.mark.parametrize("length", [2, 4, 30, 46, 48])
def test_a_length_is_kept_to(length):
    solid = block(4, 4, 3)
    folding = lu.fold(solid, length=length, **QUICK)
    check_folding(folding, solid)
    assert len(folding.path) == length


def test_a_path_shorter_than_the_length_is_returned_as_it_is():
    folding = lu.fold(plus(5), length=30, **QUICK)
    check_folding(folding, plus(5))
    assert len(folding.path) < 30


def test_progress_runs_from_0_to_1():
    told = []
    lu.fold(block(4, 3, 3), progress=told.append, trial_rounds=10, rounds=1000)
    assert told == sorted(told)
    assert told[0] >= 0
    assert told[-1] == 1


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"method": "magic"}, r"unknown fold method 'magic'; known: \['growth', 'layered'\]"),
        ({"speed": 3}, "fold method 'growth' has no option 'speed'; known: .*rounds"),
        ({"method": "layered", "rounds": 3}, "fold method 'layered' has no option 'rounds'"),
        ({"length": 7}, "an even number from 2 to the solid's 8 voxels, got 7"),
        ({"length": 0}, "an even number from 2 to the solid's 8 voxels, got 0"),
        ({"length": -2}, "an even number from 2 to the solid's 8 voxels, got -2"),
        ({"length": 10}, "an even number from 2 to the solid's 8 voxels, got 10"),
        ({"rounds": -1}, "rounds must not be negative, got -1"),
        ({"trial_rounds": -5}, "trial_rounds must not be negative, got -5"),
        ({"seed": -1}, "non-negative"),
    ],
)
def test_bad_arguments_are_refused_in_one_line(options, message):
    with pytest.raises(ValueError, match=message) as error:
        lu.fold(block(2, 2, 2), **options)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("method", lu.FOLD_METHODS)
def test_one_voxel_is_refused(method):
    with pytest.raises(ValueError, match="at least two voxels, the solid has 1"):
        lu.fold(block(1, 1, 1), method=method)


# ---------------------------------------------------------------- the fold itself


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
        kind = rng.integers(3)
        if kind == 0:
            _moves.fill(self.grid, self.body, fold, 40, _fold.NEVER, rng)
        elif kind == 1:
            _moves.anneal(self.grid, self.body, fold, 10, 3.0, 0.1, _fold.NEVER, rng)
        else:
            length = int(rng.integers(2, fold.size[0] + 1))
            _moves.contract_all(self.grid, fold, rng.random(len(self.body.solid)) < 0.3, length)

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


@pytest.mark.parametrize("seed", range(20))
def test_a_first_rod_may_only_grow_where_nothing_is_in_its_way(seed):
    solid = block(3, 3, 3)
    bar = np.array([(1, 1, 1), (1, 1, 2)])[:: (-1) ** seed]
    grown = Grown(solid, bar, seed, np.array([[0, 1, seed % 6, seed // 3 % 6]], np.int32))
    for _ in range(4):
        _moves.fill(grown.grid, grown.body, grown.fold, 20, _fold.NEVER, grown.rng)
        grown.check(solid)


@pytest.mark.parametrize("end", [0, 1])
def test_the_last_bar_gives_way_where_one_end_did_all_the_work(end):
    solid = block(3, 1, 2)
    voxels = np.array([(0, 0, 0), (1, 0, 0), (2, 0, 0)])
    down, up = 5, 2
    plans = [
        [(0, 2, 3, 4), (1, 2, 3, 4)],
        [(0, 2, 4, 0), (0, 1, 4, 0)],
    ]
    plan = np.array(plans[end], np.int32)
    plan[:, 3 - end] = (up, down)[end]  # the idle end's direction means nothing yet
    grown = Grown(solid, voxels, 0, plan)
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
    _moves.contract_all(grown.grid, grown.fold, np.zeros(len(grown.body.solid), bool), 6)
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
    _moves.contract_all(grown.grid, grown.fold, keep, n - 4)
    grown.check(solid)
    assert n - 4 <= len(grown.voxels) < n
    assert (grown.fold.joint[kept] >= 0).all()
    _moves.contract_all(grown.grid, grown.fold, np.zeros_like(keep), 2)
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


# ---------------------------------------------------------------- planted faults


@pytest.fixture(scope="module")
def folded():
    solid = block(4, 4, 3)
    folding = lu.fold(solid, **QUICK)
    check_folding(folding, solid)
    return solid, folding


def with_moves(folding, moves):
    return lu.Folding(folding.path, with_changes(folding.motion, moves=moves))


def with_voxels(folding, voxels):
    path = with_changes(folding.path, voxels=voxels)
    return lu.Folding(path, with_changes(folding.motion, start=voxels))


def test_a_dropped_move_is_caught(folded):
    solid, folding = folded
    for k in range(len(folding.motion)):
        with pytest.raises(AssertionError):
            check_folding(with_moves(folding, np.delete(folding.motion.moves, k, 0)), solid)


def test_a_rod_turned_the_other_way_is_caught(folded):
    solid, folding = folded
    for k in range(len(folding.motion)):
        moves = folding.motion.moves.copy()
        moves[k, 3] = (moves[k, 3] + 3) % 6
        with pytest.raises(AssertionError):
            check_folding(with_moves(folding, moves), solid)


def test_two_swapped_voxels_are_caught(folded):
    solid, folding = folded
    for k in range(len(folding.path) - 1):
        voxels = folding.path.voxels.copy()
        voxels[[k, k + 1]] = voxels[[k + 1, k]]
        with pytest.raises(AssertionError):
            check_folding(with_voxels(folding, voxels), solid)


def test_a_lost_last_voxel_is_caught(folded):
    solid, folding = folded
    with pytest.raises(AssertionError):
        check_folding(with_voxels(folding, folding.path.voxels[:-1]), solid)


def test_a_motion_that_stops_early_is_caught(folded):
    solid, folding = folded
    kinds = folding.motion.moves[:, 0]
    assert set(kinds) <= {Move.PEEL, Move.SWING}
    stopped = with_moves(folding, folding.motion.moves[:-3])
    unsaid = lu.Folding(stopped.path, with_changes(stopped.motion, straight=False))
    for wrong in (stopped, unsaid):
        with pytest.raises(AssertionError):
            check_folding(wrong, solid)


def test_a_forgotten_voxel_is_caught(folded):
    solid, folding = folded
    rest = lu.Folding(with_changes(folding.path, dropped=np.array([(0, 0, 0)])), folding.motion)
    with pytest.raises(AssertionError):
        check_folding(rest, solid)
