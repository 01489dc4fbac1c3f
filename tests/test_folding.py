"""Folding: every kind of solid is folded, and what is not a folding is found out."""

from dataclasses import replace as with_changes

import numpy as np
import pytest
from contracts import check_folding
from examples import examples
from hostile import KINDS, hostile
from hypothesis import example, given
from hypothesis import strategies as st
from oracles import rod_fault
from polycubes import polycubes

import lineup as lu
from lineup import grid
from lineup.joints import slot_violations
from lineup.kinematics import Move
from lineup.motion.plan import has_peel_plan, motion_of, states_of

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
@examples(40)
def test_every_polycube_is_folded(occupancy, seed):
    if occupancy.sum() > 1:
        solid = lu.VoxelSolid(occupancy)
        check_folding(lu.fold(solid, seed=seed, trial_rounds=5, rounds=20), solid)


@pytest.mark.parametrize("kind", KINDS)
def test_hostile_solids_are_folded(kind):
    for seed in range(3):
        solid = hostile(kind, seed, 60)
        check_folding(lu.fold(solid, seed=seed, **QUICK), solid)


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


@given(polycubes(80), st.integers(0, 2**32 - 1))
@example(np.ones((5, 2, 2), bool), 1)  # a rod swings for no need when one bar is left
@examples(40)
def test_any_even_length_is_kept_to(occupancy, seed):
    if occupancy.sum() < 2:
        return
    solid = lu.VoxelSolid(occupancy)
    folding = lu.fold(solid, seed=seed, trial_rounds=5, rounds=20)
    for length in range(len(folding.path), 0, -2 * (1 + seed % 4)):
        (trimmed,) = lu.trim([folding], length)
        check_folding(trimmed, solid)
        assert len(trimmed.path) == length
        if not has_peel_plan(trimmed.motion):  # one for slots that is not read back
            assert not len(slot_violations(trimmed.motion))
            continue
        states = states_of(trimmed.motion)
        assert rod_fault(trimmed.path.voxels, states) == ""
        # A motion that happens to keep to the slots is trimmed to one that does, made in their way.
        made = [motion_of(trimmed.path.voxels, states, joints) for joints in ("free", "slotted")]
        assert any(np.array_equal(one.moves, trimmed.motion.moves) for one in made)


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
        ({"method": "magic"}, r"unknown fold method 'magic'; known: \['growth', 'layered'"),
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


@pytest.mark.parametrize(
    "voxels",
    [
        [(0, 0, 0), (1, 0, 0), (2, 0, 0)],
        [(0, 0, 0), (0, 0, 0)],
        [(0, 0, 0), (0, 1, 0), (0, 2, 0), (0, 3, 0)],
        [(0, 0, 7), (0, 0, 8)],
    ],
    ids=["odd", "not simple", "outside", "far outside"],
)
def test_start_paths_must_be_paths_of_the_solid(voxels):
    with pytest.raises(ValueError, match="start path 0"):
        lu.fold(block(3, 3, 1), paths=[lu.VoxelPath(np.array(voxels))], **QUICK)


@pytest.mark.parametrize("method", lu.FOLD_METHODS)
def test_one_voxel_is_refused(method):
    with pytest.raises(ValueError, match="at least two voxels, the solid has 1"):
        lu.fold(block(1, 1, 1), method=method)


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
