"""Accordion, peel plans and their search, each beside a plain twin."""

import itertools
import re

import numpy as np
import pytest
from contracts import check_motion
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import lattice_quadrant, lattice_ray, rod_fault, rod_rule
from polycubes import polycubes
from scipy.spatial.distance import pdist

import lineup as lu
from lineup import grid
from lineup.kinematics import Move
from lineup.motion import _chain, _search, plan

# Both ends lie inside the rest, so that neither can let go of a bar.
LOCKED = "DWNEEUESUWWSWDEDENU"
STUCK = [LOCKED, "NEESSWUWNNWDDEESU", "SEDEUNUNWDDWSWUUEED", "USDWNUNEDDEEUSDSUWDNU"]

# Only swings, up to a dozen, get both ends out.
WINDING = [
    "DWUSUNESDDW",
    "SUEDDWNNUES",
    "EENWDESSWNWNUUSWNDDSSUEEEUNNWSSWW",
    "UEESDNWNDWWSSUEUEDDWNEENUUWWDWSUN",
    "WSDNEEUNESDNWWWUEUWSESEDWDEEUUNWNE",
    "DEEUNDWWWSUSUENWNDEEUSSDWDEEUUNN",
]


def walk(word):
    """The voxels of a path spelled in the letters of `grid.LETTERS`."""
    steps = grid.DIRECTIONS[[grid.LETTERS.index(c) for c in word]]
    return np.vstack([np.zeros((1, 3), int), steps.cumsum(axis=0)])


def random_walk(rng, n, side=3, banned=()):
    """At most n voxels of a self-avoiding walk in a box, never stepping in a banned direction."""
    directions = [d for d in range(6) if d not in banned]
    path = [tuple(rng.integers(0, side, 3).tolist())]
    while len(path) < n:
        steps = [tuple((path[-1] + grid.DIRECTIONS[d]).tolist()) for d in directions]
        free = [p for p in steps if p not in path and min(p) >= 0 and max(p) < side]
        if not free:
            break
        path.append(free[rng.integers(len(free))])
    return np.array(path)


seeds = st.integers(0, 2**32 - 1)


@examples(400)
@given(seeds, st.integers(2, 40), st.integers(0, 5))
def test_accordion_only_moves_points_apart(seed, n, against):
    voxels = random_walk(np.random.default_rng(seed), n, side=7, banned=[against])
    motion = lu.unfold(lu.VoxelPath(voxels), method="accordion")
    assert motion.straight
    assert len(motion) <= 1
    check_motion(motion)
    poses = lu.frames(motion, substeps=9)
    quarters = [np.linspace(pose[:-1], pose[1:], 4, endpoint=False) for pose in poses]
    distances = [pdist(points.reshape(-1, 3)) for points in quarters]
    for before, after in itertools.pairwise(distances):
        assert (after >= before - 1e-9).all()


def test_accordion_tilts_as_few_bars_as_it_can():
    motion = lu.unfold(lu.VoxelPath(walk("UUUEUUUNU")), method="accordion")
    assert motion.poses.tolist() == [[grid.LETTERS.index("U")] * 9]


def test_accordion_of_a_straight_path_does_nothing():
    motion = lu.unfold(lu.VoxelPath(walk("WWWWW")), method="accordion")
    assert (motion.straight, len(motion), motion.poses.size) == (True, 0, 0)
    check_motion(motion)


@pytest.mark.parametrize("word", ["ENUWWSSD", "DDEEUUUNWWWSSE"])
def test_accordion_leaves_a_path_that_is_not_monotone(word):
    motion = lu.unfold(lu.VoxelPath(walk(word)), method="accordion")
    assert (motion.straight, len(motion)) == (False, 0)
    assert "not monotone" in motion.reason
    check_motion(motion)


def test_auto_tilts_what_is_monotone_and_peels_the_rest():
    assert set(lu.unfold(lu.VoxelPath(walk("ENUU"))).moves[:, 0]) == {Move.TILT}
    assert set(lu.unfold(lu.VoxelPath(walk("UENWWSSDD"))).moves[:, 0]) <= {Move.PEEL, Move.SWING}


def check_peeled(voxels, motion):
    """A peel motion is certified as far as it goes, and stops with the joints it names."""
    check_motion(motion)
    if motion.straight:
        return
    a, b, n = map(int, re.findall(r"\d+", motion.reason))
    assert n == len(voxels)
    assert 0 <= a < b < n
    *_, last = lu.frames(motion, every=len(motion) + 1)
    assert np.array_equal(last[a : b + 1] - last[a], voxels[a : b + 1] - voxels[a])
    for rod in (last[: a + 1], last[b:]):
        assert len(set(map(tuple, np.diff(rod, axis=0)))) <= 1


@given(polycubes(60), st.integers(0, 9))
@examples(80)
def test_peel_of_layered_paths(occupancy, seed):
    if occupancy.sum() < 2:
        return
    path = lu.layered_path(lu.VoxelSolid(occupancy), seed=seed, starts=1)
    check_peeled(path.voxels, lu.unfold(path, method="peel", seed=seed, tries=3))


@given(seeds, st.integers(2, 27))
@examples(240)
def test_peel_of_walks_packed_in_a_box(seed, n):
    voxels = random_walk(np.random.default_rng(seed), n)
    if len(voxels) < 2:
        return
    check_peeled(voxels, lu.unfold(lu.VoxelPath(voxels), method="peel", tries=1))


def test_peel_says_which_joints_are_stuck():
    motion = lu.unfold(lu.VoxelPath(walk(LOCKED)), method="peel", rounds=0)
    assert (
        motion.reason == f"stuck with joints 0 to {len(LOCKED)} of {len(LOCKED) + 1} still folded"
    )
    assert (motion.straight, len(motion)) == (False, 0)
    check_peeled(walk(LOCKED), motion)


def test_the_same_seed_gives_the_same_motion():
    path = lu.layered_path(lu.VoxelSolid(np.ones((5, 5, 4), bool)))
    first, again, other = (lu.unfold(path, method="peel", seed=s).moves for s in (3, 3, 4))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"method": "pull-out"}, "unknown motion method 'pull-out'; known: .*accordion"),
        ({"method": "peel", "speed": 2}, "'peel' has no option 'speed'; known: .*tries"),
        ({"method": "accordion", "tries": 2}, "'accordion' has no option 'tries'; known: "),
        ({"method": "peel", "tries": 0}, "tries must be at least 1, got 0"),
        ({"method": "peel", "patience": -1}, "patience must be at least 1, got -1"),
        ({"method": "peel", "rounds": -1}, "rounds must be at least 0, got -1"),
    ],
)
def test_bad_arguments_are_refused_in_one_line(options, message):
    with pytest.raises(ValueError, match=message) as error:
        lu.unfold(lu.VoxelPath(walk("ENUWWSSD")), **options)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("method", lu.MOTION_METHODS)
@pytest.mark.parametrize("voxels", [np.empty((0, 3), int), [(0, 0, 0)], [(0, 0, 0), (0, 0, 2)]])
def test_what_is_no_path_of_bars_is_refused(method, voxels):
    with pytest.raises(ValueError, match=r"at least two voxels|do not share a face"):
        lu.unfold(lu.VoxelPath(np.array(voxels)), method=method)


def test_rays_meet_as_point_sets_do():
    offsets = list(itertools.product(range(-2, 3), repeat=3))
    rays = {(p, d): lattice_ray(p, d, 5) for p in offsets for d in range(6)}
    origin = np.zeros(3, np.int32)
    for (q, f), points in rays.items():
        for d in range(6):
            expected = not points.isdisjoint(rays[(0, 0, 0), d])
            assert _chain.rays_meet(origin, d, np.array(q, np.int32), f) == expected


def test_ray_meets_quadrant_as_point_sets_do():
    offsets = list(itertools.product(range(-2, 3), repeat=3))
    corners = [(f, g) for f in range(6) for g in range(6) if f % 3 != g % 3]
    quadrants = {corner: lattice_quadrant((0, 0, 0), *corner, 5) for corner in corners}
    origin = np.zeros(3, np.int32)
    for p, d in itertools.product(offsets, range(6)):
        ray = lattice_ray(p, d, 5)
        for (f, g), points in quadrants.items():
            found = _chain.ray_meets_quadrant(np.array(p, np.int32), d, origin, f, g)
            assert found == (not points.isdisjoint(ray)), (p, d, f, g)


@given(seeds, st.integers(2, 27))
@settings(max_examples=25)
def test_blockers_are_the_nearest_joints_in_a_point_set(seed, n):
    voxels = random_walk(np.random.default_rng(seed), n)
    box, cells = plan.path_grid(voxels)
    chain = _chain.link(box, cells)
    joints = {tuple(v): k for k, v in enumerate(voxels.tolist())}
    for k, d, f in itertools.product(range(len(voxels)), range(6), range(6)):
        if d == f:
            region = lattice_ray(tuple(voxels[k]), d, 4)
            found = [_chain.ray_blocker(chain, end, k, d) for end in range(2)]
        elif d % 3 != f % 3:
            region = lattice_quadrant(tuple(voxels[k]), d, f, 4)
            found = [_chain.quadrant_blocker(box, chain, end, k, d, f) for end in range(2)]
        else:
            continue
        met = [joints[p] for p in region if p in joints]
        above = min((m for m in met if m > k), default=len(voxels))
        below = max((m for m in met if m < k), default=-1)
        assert found == [above, below]


def steps_from(n, state):
    """All peels and swings one might try from a state."""
    for end in range(2):
        peeled = list(state)
        peeled[end] += (1, -1)[end]
        yield peeled
        for f in range(6):
            if f % 3 != state[2 + end] % 3:
                yield [f if k == 2 + end else x for k, x in enumerate(state)]


def starts_of(n):
    return [[0, n - 1, da, db] for da in range(6) for db in range(6)]


def allowed(box, chain, old, new):
    """Whether the kernels allow a step."""
    state = np.array(old, np.int32)
    end = int(old[0] == new[0] and old[2] == new[2])
    if old[end] != new[end]:
        return _search.may_peel(box, chain, state, end)
    return _search.may_swing(box, chain, state, end, new[2 + end])


@given(seeds, st.integers(3, 16))
@examples(100)
def test_the_kernels_allow_exactly_the_steps_that_the_rules_do(seed, n):
    rng = np.random.default_rng(seed)
    voxels = random_walk(rng, n)
    if len(voxels) < 3:
        return
    box, cells = plan.path_grid(voxels)
    chain = _chain.link(box, cells)
    state = list(starts_of(len(voxels))[rng.integers(36)])
    for _ in range(40):
        steps = list(steps_from(len(voxels), state))
        if state[1] - state[0] == 1:
            steps = [step for step in steps if step[:2] == state[:2]]
        rules = [rod_rule(voxels, state, step) == "" for step in steps]
        assert [allowed(box, chain, state, step) for step in steps] == rules
        ways = [step for step, may in zip(steps, rules, strict=True) if may]
        if not ways:
            break
        state = ways[rng.integers(len(ways))]


def test_a_state_is_entered_once_and_all_its_steps_are():
    voxels = walk("EENNWWSU")
    box, cells = plan.path_grid(voxels)
    chain = _chain.link(box, cells)
    for seed, state in itertools.product(range(5), [[3, 6, 5, 2], [2, 5, 5, 5], [1, 8, 4, 0]]):
        frontier = _search._open(len(voxels), 200)
        assert _search._enter(frontier, np.array(state, np.int32), -1)
        _search._enter_peels(box, chain, frontier, 0, bool(seed % 2), -1)
        for _ in range(2):
            _search._enter_swings(box, chain, frontier, 0, np.random.default_rng(seed))
        entered = frontier.state[1 : frontier.size[0]].tolist()
        steps = [step for step in steps_from(len(voxels), state) if 0 <= step[0] < step[1]]
        assert sorted(entered) == sorted(s for s in steps if not rod_rule(voxels, state, s))
        assert len(entered) > 1


def least_folded(voxels):
    """The fewest bars any plan leaves folded, by trying all steps from all starts."""
    todo = starts_of(len(voxels))
    met, least = set(map(tuple, todo)), len(voxels)
    while todo:
        state = todo.pop()
        least = min(least, state[1] - state[0])
        if least == 1:
            break
        for step in steps_from(len(voxels), state):
            if tuple(step) not in met and not rod_rule(voxels, state, step):
                met.add(tuple(step))
                todo.append(step)
    return least


@given(seeds, st.integers(2, 24))
@examples(160)
def test_search_gets_as_far_as_any_plan(seed, n):
    voxels = random_walk(np.random.default_rng(seed), n)
    if len(voxels) < 2:
        return
    box, cells = plan.path_grid(voxels)
    states = plan.peel_plan(box, cells, np.random.default_rng(0))
    assert plan.left_folded(states) == least_folded(voxels)


@pytest.mark.parametrize("word", STUCK)
def test_search_leaves_no_more_folded_than_it_must(word):
    voxels = walk(word)
    states = plan.peel_plan(*plan.path_grid(voxels), np.random.default_rng(0))
    assert plan.left_folded(states) == least_folded(voxels) > 1
    assert rod_fault(voxels, states) == ""
    check_peeled(voxels, plan.motion_of(voxels, states))


@pytest.mark.parametrize("word", WINDING)
@pytest.mark.parametrize("seed", range(5))
def test_search_finds_the_swings_that_a_path_needs(word, seed):
    states = plan.peel_plan(*plan.path_grid(walk(word)), np.random.default_rng(seed))
    assert plan.left_folded(states) == 1
    assert (np.diff(states[:, 2:], axis=0) != 0).any()
    assert rod_fault(walk(word), states) == ""


@given(seeds, st.integers(2, 60), st.sampled_from([0.02, 0.5, 0.98]))
@examples(240)
def test_plans_keep_the_rules_and_come_back_from_their_motions(seed, n, bias):
    rng = np.random.default_rng(seed)
    voxels = random_walk(rng, n, side=4)
    if len(voxels) < 2:
        return
    box, cells = plan.path_grid(voxels)
    states = plan.peel_plan(box, cells, rng, bias=bias)
    assert rod_fault(voxels, states) == ""
    motion = plan.motion_of(voxels, states)
    check_motion(motion)
    if not motion.straight:
        return
    again = plan.states_of(motion)
    assert rod_fault(voxels, again) == ""
    assert plan.left_folded(again) == 1
    assert np.array_equal(plan.motion_of(voxels, again).moves, motion.moves)


def legal_play(rng, voxels, spare):
    """A plan of legal steps taken at random, with up to `spare` swings beside the last bar."""
    states = [starts_of(len(voxels))[rng.integers(36)]]
    for _ in range(4 * len(voxels)):
        gap = states[-1][1] - states[-1][0]
        spare -= gap == 1
        steps = [s for s in steps_from(len(voxels), states[-1]) if s[0] < s[1]]
        ways = [s for s in steps if rod_rule(voxels, states[-1], s) == ""]
        peels = [s for s in ways if s[1] - s[0] < gap]
        if not ways or spare < 0:
            break
        among = peels if peels and rng.random() < 0.8 else ways
        states.append(among[rng.integers(len(among))])
    return np.array(states, np.int32)


@given(seeds, st.integers(2, 12), st.integers(0, 3))
@examples(240)
def test_whatever_is_legal_comes_back_from_its_motion(seed, n, spare):
    rng = np.random.default_rng(seed)
    voxels = random_walk(rng, n, side=4)
    if len(voxels) < 2:
        return
    states = legal_play(rng, voxels, spare)
    motion = plan.motion_of(voxels, states)
    check_motion(motion)
    if motion.straight:
        again = plan.states_of(motion)
        assert rod_fault(voxels, again) == ""
        assert np.array_equal(plan.motion_of(voxels, again).moves, motion.moves)


@pytest.mark.parametrize("spare", [[], [2], [2, 1], [2, 1, 5, 1]])
def test_a_rod_may_swing_for_no_need_when_one_bar_is_left(spare):
    states = [[0, 3, 0, 1], [0, 2, 0, 1], [0, 1, 0, 1], *([0, 1, 0, f] for f in spare)]
    assert rod_fault(walk("EUN"), states) == ""
    motion = plan.motion_of(walk("EUN"), np.array(states, np.int32))
    assert motion.moves[1:, 3].tolist() == [*spare, 0]
    assert lu.certify(motion).ok
    assert plan.states_of(motion)[:, 3].tolist() == [1, 1, 1, *spare]


def test_states_of_refuses_other_motions():
    stuck = lu.unfold(lu.VoxelPath(walk(LOCKED)), method="peel", rounds=0)
    tilted = lu.unfold(lu.VoxelPath(walk("ENUU")), method="accordion")
    for motion in (stuck, tilted):
        with pytest.raises(ValueError, match="has a peel plan"):
            plan.states_of(motion)


def test_the_twin_of_the_rules_finds_planted_faults():
    rng = np.random.default_rng(2)
    voxels = lu.layered_path(lu.VoxelSolid(np.ones((4, 3, 3), bool))).voxels
    states = plan.peel_plan(*plan.path_grid(voxels), rng)
    assert plan.left_folded(states) == 1
    assert rod_fault(voxels, states) == ""
    dropped = [rod_fault(voxels, np.delete(states, k, 0)) for k in range(len(states) - 1)]
    assert all(dropped)
    turned = states.copy()
    turned[len(states) // 2, 3] = (turned[len(states) // 2, 3] + 3) % 6
    assert rod_fault(voxels, turned)
    assert rod_fault(voxels[::-1], states)
