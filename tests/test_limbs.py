"""Limb moves that open a pose for peeling, and the methods made of both."""

import itertools

import numpy as np
import pytest
from contracts import check_folding, check_motion
from examples import examples
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from oracles import rod_fault, sampled_move
from polycubes import blob, polycubes
from test_motion import STUCK, random_walk, walk

import lineup as lu
from lineup import folding as foldings
from lineup import grid
from lineup import motion as motions
from lineup.kinematics import Move, moved
from lineup.motion import _limbs, peeling, plan

seeds = st.integers(0, 2**32 - 1)
UP = grid.LETTERS.index("U")


def one_move(pose, limb):
    """The motion that is just this limb's move."""
    row = np.array([(limb.kind, limb.joint, limb.other, limb.value)])
    return lu.Motion(pose.place, row, 0.999, 90.0, False, "one move")


def random_limbs(seed, n, count):
    """Limbs that the search may propose for a random walk, and the pose."""
    rng = np.random.default_rng(seed)
    voxels = random_walk(rng, n, side=int(rng.integers(2, 5)))
    assume(len(voxels) >= 4)
    pose = _limbs.open_pose(voxels.astype(np.int32), 20)
    limbs = [_limbs.propose(pose, rng) for _ in range(count)]
    return pose, [limb for limb in limbs if limb.kind >= 0]


def is_clear(pose, limb, places):
    return _limbs.put(pose, limb, places) and _limbs.is_clear(pose, _limbs.arcs(), limb)


@given(seeds, st.integers(4, 60))
@examples(180)
def test_a_limb_is_clear_exactly_if_the_judge_says_so(seed, n):
    pose, limbs = random_limbs(seed, n, 30)
    places = np.empty_like(pose.place)
    for limb in limbs:
        clear = is_clear(pose, limb, places)
        motion = one_move(pose, limb)
        verdict = lu.certify(motion)
        assert clear == (verdict.clearance == 1 and "bend" not in verdict.reason)
        if clear:
            after = moved(pose.place.astype(float), motion.moves[0], motion, 1.0)
            inside = slice(limb.low + 1, limb.high)
            assert np.array_equal(places[inside], np.rint(after)[inside])


@given(seeds, st.integers(4, 14))
@examples(40)
def test_a_limb_is_clear_exactly_if_samples_say_so(seed, n):
    pose, limbs = random_limbs(seed, n, 3)
    for limb in limbs:
        motion = one_move(pose, limb)
        start = pose.place.astype(float)
        clearance, bend_deg = sampled_move(motion, start, motion.moves[0], samples=33)
        clear = clearance > 1 - 1e-6 and bend_deg < 90 + 1e-6
        assert is_clear(pose, limb, np.empty_like(pose.place)) == clear


def test_what_is_in_the_way_of_an_arc_is_what_is_near_it():
    angles = np.linspace(0, np.pi / 2, 2001)
    cells = np.array(list(itertools.product(range(-7, 8), repeat=2)))
    for u, v in itertools.product(range(1, 5), range(5)):
        start = np.arctan2(v, u) + angles
        arc = np.hypot(u, v) * np.stack([np.cos(start), np.sin(start)], axis=1)
        distance = np.linalg.norm(cells[:, None] - arc, axis=2).min(axis=1)
        near = {tuple(c) for c, far in zip(cells.tolist(), distance, strict=True) if far < 1 - 1e-6}
        entry = u * (_limbs.REACH + 1) + v
        table = _limbs.arcs()
        listed = table.cell[table.start[entry] : table.start[entry + 1]]
        assert set(map(tuple, listed.tolist())) == near - {(u, v)}


def test_a_joint_out_of_reach_of_the_table_is_not_turned():
    voxels = walk("E" * (_limbs.REACH + 2) + "NE")
    pose = _limbs.open_pose(voxels.astype(np.int32), 80)
    for joint, may in ((1, False), (2, False), (3, True)):
        limb = _limbs.Limb(joint, len(voxels), int(Move.SWING), joint, joint + 1, UP)
        assert is_clear(pose, limb, np.empty_like(pose.place)) == may


@given(seeds, st.integers(6, 50))
@settings(max_examples=20)
def test_opening_makes_clear_moves_that_take_contacts_away(seed, n):
    rng = np.random.default_rng(seed)
    voxels = random_walk(rng, n, side=4)
    assume(len(voxels) >= 4)
    pose = _limbs.open_pose(voxels.astype(np.int32), 10)
    rows = _limbs.open_up(pose, _limbs.arcs(), 20 * len(voxels), 1e-3, rng)
    motion = lu.Motion(voxels, rows, 0.999, 90.0, False, "opened")
    verdict = lu.certify(motion)
    assert (verdict.moves_checked, verdict.clearance) == (len(rows), 1)
    poses = [np.rint(p).astype(int) for p in lu.frames(motion)]
    assert np.array_equal(np.diff(poses[-1], axis=0), np.diff(pose.place, axis=0))
    assert np.array_equal(pose.joint[tuple(pose.place.T)], np.arange(len(voxels)))
    assert (pose.joint >= 0).sum() == len(voxels)
    counts = [contacts(p) for p in poses]
    assert all(after < before for before, after in itertools.pairwise(counts))


def contacts(voxels):
    """Pairs of voxels that share a face."""
    apart = np.abs(voxels[:, None] - voxels).sum(axis=2)
    return int((apart == 1).sum()) // 2


@pytest.mark.parametrize("word", STUCK)
def test_limbs_make_way_where_both_ends_are_shut_in(word):
    path = lu.VoxelPath(walk(word))
    assert not lu.unfold(path, "peel", rounds=0).straight
    motion = lu.unfold(path, "peel")
    check_motion(motion)
    assert motion.straight
    assert "limb moves" in motion.reason
    assert not plan.has_peel_plan(motion)


@given(polycubes(60), seeds)
@examples(40)
def test_every_layered_path_of_a_small_solid_is_straightened(occupancy, seed):
    assume(occupancy.sum() > 1)
    path = lu.layered_path(lu.VoxelSolid(occupancy), seed=seed, starts=1)
    motion = lu.unfold(path, "peel", seed)
    check_motion(motion)
    assert motion.straight


@pytest.mark.parametrize("seed", range(3))
def test_layered_paths_of_larger_solids_are_straightened(seed):
    path = lu.layered_path(lu.VoxelSolid(blob(seed, side=8)), seed=seed, starts=1)
    motion = lu.unfold(path, "peel", seed)
    assert motion.straight
    check_motion(motion)
    assert np.array_equal(motion.moves, lu.unfold(path, "peel", seed).moves)


def test_a_path_that_stays_locked_says_so():
    path = lu.VoxelPath(walk(STUCK[0]))
    motion = lu.unfold(path, "peel", rounds=1)
    check_motion(motion)
    assert motion.straight or motion.reason.startswith("stuck with joints 0 to")


def rods(da, db, la, lb):
    """A bar from (0, 0, 0) to (1, 0, 0) with rods of la and lb bars on it; None where they meet."""
    first, second = np.zeros(3, int), grid.DIRECTIONS[0].astype(int)
    tail = [first + k * grid.DIRECTIONS[da] for k in range(la, 0, -1)]
    head = [second + k * grid.DIRECTIONS[db] for k in range(1, lb + 1)]
    voxels = np.array([*tail, first, second, *head])
    return voxels if len(np.unique(voxels, axis=0)) == len(voxels) else None


def test_the_end_game_two_free_swings_line_up_the_last_bar():
    cases = itertools.product(range(6), range(6), range(4), range(4))
    for da, db, la, lb in cases:
        voxels = rods(da, db, la, lb)
        endless = rods(da, db, la and 9, lb and 9)
        if voxels is None or endless is None:
            continue
        motion = plan.motion_of(voxels, np.array([[la, la + 1, da, db]]))
        assert set(motion.moves[:, 0]) <= {Move.SWING}
        assert len(motion) <= 2
        assert lu.certify(motion).ok


@given(seeds, st.integers(2, 40))
@settings(max_examples=20)
def test_no_plan_needs_more_than_two_swings_at_its_end(seed, n):
    rng = np.random.default_rng(seed)
    voxels = random_walk(rng, n, side=4)
    assume(len(voxels) > 1)
    states = plan.peel_plan(*plan.path_grid(voxels), rng)
    assume(plan.left_folded(states) == 1)
    turns = (np.diff(states[:, 2:], axis=0) != 0).sum()
    swings = int((plan.motion_of(voxels, states).moves[:, 0] == Move.SWING).sum())
    assert turns <= swings <= turns + 2


def test_a_motion_with_limb_moves_has_no_peel_plan():
    voxels = walk("NEESSWUWNN")
    states = plan.peel_plan(*plan.path_grid(voxels), np.random.default_rng(0))
    plain = plan.motion_of(voxels, states)
    assert plan.has_peel_plan(plain)
    assert rod_fault(voxels, plan.states_of(plain)) == ""
    unseen = {"straight": False}, {"moves": plain.moves[1:]}, {"moves": plain.moves[::-1]}
    fields = {k: getattr(plain, k) for k in plain.__dataclass_fields__}
    for change in unseen:
        assert not plan.has_peel_plan(lu.Motion(**{**fields, **change}))


def test_a_folding_with_limb_moves_can_be_trimmed():
    voxels = walk(STUCK[0])
    path = lu.VoxelPath(voxels - voxels.min(axis=0))
    trimmed = lu.trim([lu.Folding(path, lu.unfold(path, "peel"))], len(path) - 4)[0]
    assert len(trimmed.path) == len(path) - 4
    check_motion(trimmed.motion)
    assert trimmed.motion.straight


@pytest.mark.parametrize(
    ("word", "reason"),
    [
        ("ENUU", "straight: accordion, since the path is monotone"),
        ("UENWWSSDD", "straight: peel, since the path is not monotone"),
    ],
)
def test_auto_says_which_method_and_why(word, reason):
    motion = lu.unfold(lu.VoxelPath(walk(word)))
    assert motion.reason == reason
    check_motion(motion)


def test_auto_says_that_limbs_moved():
    motion = lu.unfold(lu.VoxelPath(walk(STUCK[0])))
    assert motion.reason.startswith("straight after ")
    assert motion.reason.endswith(" limb moves: peel, since the path is not monotone")


def test_auto_pulls_last_and_only_thinner_bars():
    path = lu.VoxelPath(walk(STUCK[0]))
    thick = lu.unfold(path, rounds=0)
    assert not thick.straight
    assert "not monotone; peel is stuck with joints" in thick.reason
    thin = lu.unfold(path, rounds=0, thin=True)
    assert thin.reason.startswith("straight: pull, since peel is stuck") or (
        "; pull: no way out" in thin.reason
    )
    assert thin.straight == (thin.diameter < 0.999)


@pytest.mark.parametrize("name", ["tries", "patience", "rounds"])
def test_auto_checks_its_options_even_if_the_accordion_needs_none(name):
    with pytest.raises(ValueError, match=f"{name} must be at least"):
        lu.unfold(lu.VoxelPath(walk("ENUU")), **{name: -1})


@given(polycubes(60), st.integers(0, 9))
@examples(40)
def test_both_ends_on_top_are_pulled_upward_or_it_says_how_far(occupancy, seed):
    assume(occupancy.sum() > 1)
    solid = lu.VoxelSolid(occupancy)
    folding = lu.fold(solid, "top_ends", seed=seed)
    check_folding(folding, solid)
    motion = folding.motion
    if motion.reason == "straight: both ends pulled upward":
        assert {UP} >= set(motion.moves[motion.moves[:, 0] == Move.PEEL, 3])
        assert (motion.moves[:, 0] == Move.SWING).sum() <= 2
    else:
        assert f"of {len(folding.path) - 1} bars" in motion.reason


@given(seeds, st.integers(2, 40))
@settings(max_examples=20)
def test_pulling_upward_goes_as_far_as_any_order_of_it(seed, n):
    rng = np.random.default_rng(seed)
    voxels = random_walk(rng, n, side=4)
    assume(len(voxels) > 1)
    box, cells = plan.path_grid(voxels)
    states = peeling._upward_plan(box, cells)
    assert (states[:, 2:] == UP).all()
    assert rod_fault(voxels, states) == ""
    chain = peeling.link(box, cells)
    start = np.array([0, len(voxels) - 1, UP, UP], np.int32)
    far, todo = len(voxels) - 1, [start]
    met = {tuple(start)}
    while todo:
        state = todo.pop()
        far = min(far, int(state[1] - state[0]))
        for end in range(2):
            after = state.copy()
            after[end] += (1, -1)[end]
            allowed = state[1] - state[0] > 1 and peeling.may_peel(box, chain, state, end)
            if allowed and tuple(after) not in met:
                met.add(tuple(after))
                todo.append(after)
    assert plan.left_folded(states) == far


@pytest.mark.parametrize("length", [None, 40])
def test_paper_hands_its_trimmed_path_to_algorithm_4(length, monkeypatch):
    asked = []

    def energy(path, seed, *, steps=1):
        asked.append((len(path), seed))
        none = np.empty((0, 4), int)
        return lu.Motion(path.voxels, none, 0.999, 90.0, False, "stationary")

    monkeypatch.setitem(motions.MOTION_METHODS, "energy", energy)
    solid = lu.VoxelSolid(np.ones((6, 7, 2), bool))
    folding = foldings.fold(solid, "paper", seed=3, length=length)
    assert folding.motion.reason == "stationary"
    assert folding.path.method.startswith("paper") or length
    assert len(folding.path) == (length or len(lu.layered_path(solid, "paper", 3)))
    assert asked == [(len(folding.path), 3)]
