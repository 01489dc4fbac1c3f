"""Plans for slotted joints: what twists, swaps and detours, and growth that keeps to the slots."""

import itertools

import numpy as np
import pytest
from contracts import check_folding, check_motion
from examples import examples
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from oracles import lattice_ray, rod_fault, rod_rule
from polycubes import blob
from test_motion import random_walk, seeds, starts_of, steps_from, walk

import lineup as lu
from lineup.grid import DIRECTIONS
from lineup.joints import slot_violations
from lineup.kinematics import Move
from lineup.motion import _limbs, _slots, plan
from lineup.motion._chain import link

EAST, NORTH, UP, WEST, SOUTH, DOWN = range(6)
INWARD = (1, -1)


def even_walk(rng, n, side=4):
    voxels = random_walk(rng, n, side)
    return voxels[: len(voxels) - len(voxels) % 2]


def legal_states(rng, voxels, n_steps):
    """States that random steps of the infinite-rod rules lead through, without regard to slots."""
    states = [starts_of(len(voxels))[rng.integers(36)]]
    for _ in range(n_steps):
        steps = [s for s in steps_from(len(voxels), states[-1]) if s[0] < s[1]]
        ways = [s for s in steps if rod_rule(voxels, states[-1], s) == ""]
        if not ways:
            break
        peels = [s for s in ways if s[:2] != states[-1][:2]]
        among = peels if peels and rng.random() < 0.7 else ways
        states.append(among[rng.integers(len(among))])
    return np.array(states, np.int32)


def chain_of(voxels):
    box, cells = plan.path_grid(voxels)
    return box, link(box, cells)


def judged(motion):
    """Whether a motion is free as far as it goes, and its moves against the slots."""
    verdict = lu.certify(motion, joints="slotted")
    assert verdict.moves_checked == len(motion), verdict.reason
    return verdict.clearance >= 0.999, verdict.violations


@given(seeds, st.integers(4, 30))
@examples(40)
def test_what_twists_is_what_the_judge_says(seed, n):
    rng = np.random.default_rng(seed)
    voxels = even_walk(rng, n)
    assume(len(voxels) > 3)
    box, chain = chain_of(voxels)
    states = legal_states(rng, voxels, 3 * n)
    for k, (old, new) in enumerate(itertools.pairwise(states)):
        end = 0 if old[1] == new[1] and old[3] == new[3] else 1
        made = plan.motion_of(voxels, states[: k + 2])
        before = plan.motion_of(voxels, states[: k + 1])
        if len(made) <= len(before) or new[1] - new[0] == 1:
            continue
        expected = len(before) in slot_violations(made)[:, 0]
        if old[end] == new[end]:
            found = _slots.twisted_by_swing(box, chain, old, end, new[2 + end])
        else:
            found = _slots.twisted_by_peel(box, chain, old, end) >= 0
        assert found == expected


def posed(voxels, state):
    """The pose of a state, as a path with its rods, shifted by its first rod's length."""
    a, b, da, db = (int(x) for x in state)
    first = [voxels[a] + k * DIRECTIONS[da] for k in range(a, 0, -1)]
    last = [voxels[b] + k * DIRECTIONS[db] for k in range(1, len(voxels) - b)]
    return np.array([*first, *voxels[a : b + 1], *last])


def clear_by_sets(voxels, state, end, base, d):
    """Whether the lattice ray from a point meets no folded joint but the end's own, nor a rod."""
    a, b = int(state[0]), int(state[1])
    reach = 2 * len(voxels)
    folded = {tuple(v) for v in voxels[a : b + 1].tolist()} - {tuple(voxels[state[end]].tolist())}
    other = state[1 - end]
    if other != (len(voxels) - 1) * (1 - end):
        folded |= lattice_ray(tuple(voxels[other].tolist()), state[3 - end], reach)
    return lattice_ray(tuple(base.tolist()), d, reach).isdisjoint(folded)


@st.composite
def twisting_peels(draw):
    """Voxels, a state of theirs, an end that may peel but would twist, and the capsule's way."""
    rng = np.random.default_rng(draw(seeds))
    voxels = even_walk(rng, draw(st.integers(6, 40)), side=draw(st.integers(3, 5)))
    assume(len(voxels) > 5)
    box, chain = chain_of(voxels)
    found = []
    for state in legal_states(rng, voxels, 2 * len(voxels)):
        for end in range(2):
            new = state.copy()
            new[end] += INWARD[end]
            capsule = _slots.twisted_by_peel(box, chain, state, end)
            if capsule >= 0 and rod_rule(voxels, state, new) == "":
                found.append((state, end, capsule))
    assume(found)
    return voxels, *draw(st.sampled_from(found))


@given(twisting_peels())
@examples(80)
def test_swaps_and_detours_with_room_are_free_and_keep_to_the_slots(case):
    voxels, state, end, capsule = case
    box, chain = chain_of(voxels)
    k, s, d = int(state[end]), INWARD[end], int(state[2 + end])
    hinge, inner = voxels[k + s], voxels[k + 2 * s]
    to_k, out = voxels[k] - hinge, hinge - inner
    assert np.array_equal(out, DIRECTIONS[capsule])

    swap = int(state[1 - end]) != k + 2 * s and all(
        clear_by_sets(voxels, state, end, base, d)
        for base in (inner + DIRECTIONS[d], inner + to_k + DIRECTIONS[d])
    )
    assert _slots.may_swap(box, chain, state, end) == swap
    detour = all(
        clear_by_sets(voxels, state, end, base, d) for base in (hinge + out, hinge + out + to_k)
    )
    assert _slots.may_detour(box, chain, state, end, capsule) == detour
    expected = 1 if detour else 2 if swap else 0
    assert _slots.peels_at_once(box, chain, state, end) == expected

    pose = posed(voxels, state)
    peel = (Move.PEEL, k + s, k, d)
    rows = {
        "swap": [(Move.PEEL, k + 2 * s, k + s, d), peel] if swap else [],
        "detour": [(Move.PEEL, k + s, k, capsule), peel] if detour else [],
    }
    for moves in rows.values():
        if moves:
            trial = lu.Motion(pose, np.array(moves, int), 0.999, 90.0, False, "two peels")
            assert judged(trial) == (True, 0)
    straightway = lu.Motion(pose, np.array([peel], int), 0.999, 90.0, False, "one peel")
    assert judged(straightway) == (True, 1)


# The last hinge of a hook is to turn up. It stands across the capsule before it, which is bent at
# its other end too. Here is where something may be in the way.
HOOK = {"swap": (0, 1, 1), "detour": (2, 0, 0)}


@pytest.mark.parametrize("way", HOOK)
def test_without_the_room_that_is_asked_for_bars_meet(way):
    """The same two moves with a joint in the way, as a chain that comes round to it."""
    hook = [(0, 0, -1), (0, 0, 0), (1, 0, 0), (1, 1, 0)]  # far hinge, capsule, hinge
    moves = {
        "swap": [(Move.PEEL, -3, -2, UP), (Move.PEEL, -2, -1, UP)],
        "detour": [(Move.PEEL, -2, -1, EAST), (Move.PEEL, -2, -1, UP)],
    }[way]
    for blocked in (False, True):
        to = HOOK[way] if blocked else (-3, 0, 0)
        tail = tail_from(to, (0, 0, -1))
        start = np.array([*tail, *hook[1:]])
        n = len(start)
        rows = [(kind, n + a, n + b, value) for kind, a, b, value in moves]
        trial = lu.Motion(start, np.array(rows, int), 0.999, 90.0, False, "two peels")
        verdict = lu.certify(trial, joints="slotted")
        assert (verdict.clearance >= 0.999) != blocked
        if not blocked:
            assert verdict.violations == 0


def tail_from(start, end):
    """An even lattice way from `start`, below and well round the hook, to `end`."""
    x, y, z = start
    side = 3 if y >= 0 and x >= 0 else -3
    points = [(x, y, z)]

    def go(axis, to):
        while points[-1][axis] != to:
            p = list(points[-1])
            p[axis] += 1 if to > p[axis] else -1
            points.append(tuple(p))

    go(0, side if x else -3)
    go(2, -3)
    go(1, end[1])
    go(0, end[0])
    go(2, end[2])
    return points if len(points) % 2 else [(x, y, z + 1), *points]


@given(seeds, st.integers(2, 60), st.integers(2, 5))
@examples(220)
def test_slotted_plans_are_kept_and_come_back_from_their_motions(seed, n, side):
    rng = np.random.default_rng(seed)
    voxels = even_walk(rng, n, side)
    assume(len(voxels) > 1)
    box, cells = plan.path_grid(voxels)
    states = plan.peel_plan(box, cells, rng, joints="slotted")
    assert rod_fault(voxels, states) == ""
    assert _slots.plan_keeps_slots(box, link(box, cells), states)
    motion = plan.motion_of(voxels, states, "slotted")
    check_motion(motion)
    assert judged(motion) == (True, 0)
    if plan.has_peel_plan(motion):  # a few straight ones are not read back, and are planned anew
        again = plan.states_of(motion)
        assert rod_fault(voxels, again) == ""
        assert np.array_equal(plan.motion_of(voxels, again, "slotted").moves, motion.moves)


def least_in_slots(voxels):
    """Bars that must stay folded under the rules with slots: all states, one by one."""
    box, chain = chain_of(voxels)
    last = len(voxels) - 1
    todo = [tuple(s) for s in starts_of(len(voxels))]
    seen, least = set(todo), last
    while todo and least > 1:
        state = todo.pop()
        least = min(least, state[1] - state[0])
        for step in steps_from(len(voxels), state):
            ways = [tuple(step)] if step[0] < step[1] and not rod_rule(voxels, state, step) else []
            if ways:
                motion = plan.motion_of(voxels, np.array([state, step]))
                trial = lu.Motion(posed(voxels, state), motion.moves[:1], 1.0, 90.0, False, "")
                moved = step[1] - step[0] == 1 or not len(motion.moves)
                if not moved and len(slot_violations(trial)):
                    end = 0 if step[0] != state[0] or step[2] != state[2] else 1
                    ways = two_peels(box, chain, np.array(state, np.int32), step, end)
            todo += [w for w in ways if w not in seen]
            seen |= set(ways)
    return least


def two_peels(box, chain, state, step, end):
    if state[end] == step[end]:
        return []
    capsule = _slots.twisted_by_peel(box, chain, state, end)
    if _slots.may_detour(box, chain, state, end, capsule):
        return [tuple(step)]
    beyond = list(step)
    beyond[end] += INWARD[end]
    return [tuple(beyond)] if _slots.may_swap(box, chain, state, end) else []


@given(seeds, st.integers(4, 18))
@examples(40)
def test_the_search_gets_as_far_as_any_plan_in_slots(seed, n):
    voxels = even_walk(np.random.default_rng(seed), n, side=3)
    assume(len(voxels) > 3)
    box, cells = plan.path_grid(voxels)
    states = plan.peel_plan(box, cells, np.random.default_rng(0), joints="slotted")
    assert plan.left_folded(states) == least_in_slots(voxels)


def test_free_plans_make_twists_and_slotted_ones_do_not():
    folding = lu.fold(lu.VoxelSolid(np.ones((4, 4, 4), bool)), rounds=200, trial_rounds=50)
    free = lu.unfold(folding.path, "peel")
    slotted = lu.unfold(folding.path, "peel", joints="slotted")
    assert judged(free)[1] > 0
    assert (slotted.straight, judged(slotted)) == (True, (True, 0))


# Ends that let go of bars straighten these, but not without a twist.
CROOKED = [
    "NDDNWSUUNDEUESDSDWWSEEEUWUWDWNE",
    "NUSENESSWWSEDWNWNUNDDDEEUWSEDESWSWWNEUE",
    "UNEUSWNNDENDEDWWSSUEDNEUWWNUUESEDENDSSWSWUENUSEDNUNNW",
]


@pytest.mark.parametrize(
    "word", [*CROOKED, "ENNUENWWS", "NDWUNDDEDWSSENENEUUUWSDSUENDSDSUUWWDDNWSUUNDE"]
)
def test_a_sparing_plan_twists_where_nothing_else_helps(word):
    path = lu.VoxelPath(walk(word))
    free, slotted, sparing = (
        lu.unfold(path, "peel", joints=joints, rounds=0) for joints in plan.JOINTS
    )
    for motion in (free, slotted, sparing):
        check_motion(motion)
    n = judged(sparing)[1]
    assert sparing.reason.endswith(f", {n} of {len(sparing)} moves against the slots")
    assert sparing.straight == free.straight
    assert judged(slotted) == (True, 0)
    assert slotted.straight == (free.straight and word not in CROOKED)
    if free.straight:
        assert (n > 0) == (word in CROOKED)
        assert n < judged(free)[1]


@given(seeds, st.integers(6, 40))
@settings(max_examples=30)
def test_limbs_that_open_a_pose_keep_to_the_slots(seed, n):
    rng = np.random.default_rng(seed)
    voxels = even_walk(rng, n)
    assume(len(voxels) >= 4)
    pose = _limbs.open_pose(voxels.astype(np.int32), 10)
    rows = _limbs.open_up(pose, _limbs.arcs(), 20 * len(voxels), 0.5, rng, True)
    assert judged(lu.Motion(voxels, rows, 0.999, 90.0, False, "opened")) == (True, 0)


@given(seeds, st.integers(6, 30))
@settings(max_examples=30)
def test_a_limb_twists_if_the_judge_says_so(seed, n):
    rng = np.random.default_rng(seed)
    voxels = even_walk(rng, n)
    assume(len(voxels) >= 4)
    pose = _limbs.open_pose(voxels.astype(np.int32), 2)
    for _ in range(20):
        limb = _limbs.propose(pose, rng)
        if limb.kind >= 0:
            row = np.array([(limb.kind, limb.joint, limb.other, limb.value)])
            trial = lu.Motion(voxels, row, 0.999, 90.0, False, "one")
            assert _limbs.twists(pose, limb) == bool(len(slot_violations(trial)))


@pytest.mark.parametrize("seed", range(2))
def test_auto_keeps_to_the_slots_where_it_is_asked_to(seed):
    path = lu.layered_path(lu.VoxelSolid(blob(seed, side=7)), seed=seed, starts=1)
    motion = lu.unfold(path, joints="slotted")
    check_motion(motion)
    assert judged(motion) == (True, 0)


def test_auto_tilts_a_flat_zigzag_only_if_nothing_twists():
    stairs = lu.unfold(lu.VoxelPath(walk("ENENENE")), joints="slotted")
    assert (len(stairs), judged(stairs)) == (1, (True, 0))
    crooked = lu.unfold(lu.VoxelPath(walk("ENUENUE")), joints="slotted")
    assert set(crooked.moves[:, 0]) <= {Move.PEEL, Move.SWING}
    assert (crooked.straight, judged(crooked)) == (True, (True, 0))


@pytest.fixture(scope="module")
def solid():
    return lu.VoxelSolid(blob(3, side=8))


@pytest.fixture(scope="module")
def grown(solid):
    return lu.fold(solid, joints="slotted", rounds=400, trial_rounds=40, slot_rounds=15)


@pytest.mark.parametrize("ends", [1, 2])
def test_growth_keeps_to_the_slots(solid, grown, ends):
    folding = grown
    if ends == 1:
        folding = lu.fold(
            solid, joints="slotted", rounds=200, trial_rounds=20, slot_rounds=5, ends=1
        )
        assert (folding.motion.moves[:-1, 2] > folding.motion.moves[:-1, 1]).all()
    check_folding(folding, solid)
    assert judged(folding.motion) == (True, 0)
    free = lu.fold(solid, rounds=400, trial_rounds=40)
    assert judged(free.motion)[1] > 0
    assert len(folding.path) >= 0.9 * len(free.path)


def test_growth_for_slots_is_deterministic_and_tells_how_far_it_is(solid, grown):
    shares = []
    again = lu.fold(
        solid,
        joints="slotted",
        rounds=400,
        trial_rounds=40,
        slot_rounds=15,
        progress=shares.append,
    )
    assert np.array_equal(again.motion.moves, grown.motion.moves)
    assert np.array_equal(again.path.voxels, grown.path.voxels)
    assert shares == sorted(shares)
    assert 0 < shares[0] <= shares[-1] <= 1


@pytest.mark.parametrize("share", [0.5, 0.8, 0.97])
def test_trimming_keeps_to_the_slots(grown, share):
    length = int(share * len(grown.path)) // 2 * 2
    (short,) = lu.trim([grown], length=length)
    assert len(short.path) == length
    assert short.motion.straight
    check_motion(short.motion)
    assert judged(short.motion) == (True, 0)


def test_a_length_asked_for_is_met_in_slots(solid):
    length = solid.size // 2 // 2 * 2
    folding = lu.fold(solid, length=length, joints="slotted", rounds=50, trial_rounds=10)
    assert len(folding.path) == length
    assert judged(folding.motion) == (True, 0)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda p: lu.unfold(p, "peel", joints="ball"), "unknown joints 'ball'; known: free, sl"),
        (lambda p: lu.unfold(p, joints="ball"), "unknown joints 'ball'"),
        (
            lambda p: lu.unfold(lu.VoxelPath(p.voxels[1:]), "peel", joints="slotted"),
            "slotted joints are of blocks of two voxels, got 3 voxels",
        ),
        (
            lambda p: lu.fold(lu.VoxelSolid(np.ones((2, 2, 1), bool)), joints="sparing"),
            "unknown joints 'sparing'; known: free, slotted",
        ),
        (
            lambda p: lu.fold(lu.VoxelSolid(np.ones((2, 2, 1), bool)), slot_rounds=-1),
            "slot_rounds must not be negative, got -1",
        ),
    ],
)
def test_bad_arguments_are_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call(lu.VoxelPath(walk("ENU")))
