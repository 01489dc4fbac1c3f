"""Section 5: contraction pairs, and trimming of paths and foldings to one length."""

import itertools
import re

import numpy as np
import pytest
from examples import examples
from hypothesis import Phase, assume, given
from hypothesis import strategies as st
from oracles import contraction_outcomes, disjoint_subsets, least_losses
from polycubes import STEPS, polycubes

import lineup as lu
from lineup import contraction
from lineup.contraction import contraction_pairs
from lineup.folding.shorten import _without_ends
from lineup.grid import surface, voids
from lineup.motion.plan import has_peel_plan, motion_of, states_of
from lineup.visits import visits_of

CUBE = lu.VoxelSolid(np.ones((6, 6, 6), bool))
NO_SHRINKING = (Phase.explicit, Phase.reuse, Phase.generate)


def flat_path(steps):
    """A path in the layer z = 0 from its (x, y) positions."""
    return lu.VoxelPath(np.array([(x, y, 0) for x, y in steps], np.int32))


def pairs_by_definition(path, keep):
    """Figure 11 word by word: all pairs of steps, looked at one by one."""
    v = path.voxels
    found = []
    for i in range(len(v)):
        for j in range(i + 2, len(v)):
            in_layer = (v[i : j + 1, 2] == v[i, 2]).all()
            adjacent = np.abs(v[i] - v[j]).sum() == 1
            if in_layer and adjacent and not keep[tuple(v[i + 1 : j].T)].any():
                found.append([i, j])
    return found


def kept(path, solid):
    return int(surface(solid.occupancy)[tuple(path.voxels.T)].sum())


def pieces_by_return(voxels):
    """Pieces of a path as a layered one: what comes back beside where it left a piece goes on."""
    pieces, left = [0], []
    for old, new in itertools.pairwise(np.asarray(voxels).tolist()):
        if old[2] == new[2]:
            pieces.append(pieces[-1])
        elif left and np.abs(np.subtract(left[-1][0], new)).sum() == 1:
            pieces.append(left.pop()[1])
        else:
            left.append((old, pieces[-1]))
            pieces.append(max(pieces) + 1)
    return np.array(pieces)


@st.composite
def walks(draw, layered, max_voxels=12):
    """An even path in a box of 3 x 3 x 3, with its solid and voxels to keep."""
    voxels = [(1, 1, 1)]
    for _ in range(draw(st.integers(1, max_voxels - 1))):
        ways = [tuple(np.add(voxels[-1], d).tolist()) for d in STEPS]
        free = [v for v in ways if max(v) < 3 and min(v) >= 0 and v not in voxels]
        if not free:
            break
        voxels.append(draw(st.sampled_from(free)))
    path = np.array(voxels[: len(voxels) // 2 * 2], np.int32)
    occupancy = np.zeros((3, 3, 3), bool)
    occupancy[tuple(path.T)] = True
    assume(not voids(occupancy).any())
    keep = np.array(draw(st.lists(st.booleans(), min_size=27, max_size=27))).reshape(3, 3, 3)
    walk, solid = lu.VoxelPath(path), lu.VoxelSolid(occupancy)
    if layered:
        walk = lu.VoxelPath(path, visits_of(path, pieces_by_return(path)))
        assume(lu.certify_path(walk, solid).ok)
    return walk, solid, keep


def piece_of(path):
    """The piece of each voxel of a path, None if it is not layered."""
    if not len(path.visits):
        return None
    return {tuple(v): n for a, b, n, _ in path.visits for v in path.voxels[a:b].tolist()}


def told(item):
    """What `method` says went: in pairs, in excursions, off the ends, protected."""
    path = item.path if isinstance(item, lu.Folding) else item
    found = re.search(
        r"trimmed by (\d+) voxels in pairs, (\d+) in excursions and (\d+) off the ends, "
        r"(\d+) of them protected$",
        path.method,
    )
    return tuple(map(int, found.groups()))


def check_trimmed(item, before, solid, length):
    path = item.path if isinstance(item, lu.Folding) else item
    assert len(path) == length
    verdict = lu.certify_path(path, solid)
    assert verdict.ok, verdict.reason
    old = {tuple(v) for v in before.voxels.tolist()}
    assert {tuple(v) for v in path.voxels.tolist()} <= old


def test_figure_11_a_pair_of_index_2_is_found_and_contracted():
    path = flat_path([(0, 0), (1, 0), (1, 1), (2, 1), (2, 0), (3, 0)])
    assert contraction_pairs(path, np.zeros((4, 2, 1), bool)).tolist() == [[1, 4]]
    assert lu.trim([path], 4)[0].voxels[:, 0].tolist() == [0, 1, 2, 3]


def test_a_pair_around_a_voxel_that_must_stay_is_none():
    path = flat_path([(0, 0), (1, 0), (1, 1), (2, 1), (2, 0), (3, 0)])
    keep = np.zeros((4, 2, 1), bool)
    keep[2, 1, 0] = True
    assert len(contraction_pairs(path, keep)) == 0


@examples(80)
@given(polycubes(40), st.integers(0, 3), st.randoms(use_true_random=False))
def test_pairs_are_those_of_the_definition(occupancy, seed, random):
    solid = lu.VoxelSolid(occupancy)
    if solid.size < 2:
        return
    path = lu.layered_path(solid, seed=seed, starts=1)
    keep = occupancy & (np.array(random.choices([True, False], k=occupancy.size)) > 0).reshape(
        occupancy.shape
    )
    for mask in (keep, np.zeros_like(keep)):
        assert contraction_pairs(path, mask).tolist() == pairs_by_definition(path, mask)


@examples(80)
@given(polycubes(60), st.data())
def test_a_path_of_any_solid_is_trimmed_to_any_even_length(occupancy, data):
    solid = lu.VoxelSolid(occupancy)
    if solid.size < 2:
        return
    path = lu.layered_path(solid, starts=1)
    length = 2 * data.draw(st.integers(1, len(path) // 2))
    check_trimmed(lu.trim([path], length)[0], path, solid, length)


@examples(48, phases=NO_SHRINKING)
@given(polycubes(60), st.data())
def test_a_folding_of_any_solid_is_trimmed_and_stays_certified(occupancy, data):
    solid = lu.VoxelSolid(occupancy)
    if solid.size < 2:
        return
    folding = lu.fold(solid, rounds=50, trial_rounds=10)
    length = 2 * data.draw(st.integers(1, len(folding.path) // 2))
    trimmed = lu.trim([folding], length)[0]
    check_trimmed(trimmed, folding.path, solid, length)
    assert lu.certify(trimmed.motion).ok


@pytest.mark.parametrize("layered", [False, True])
@examples(160)
@given(data=st.data())
def test_no_voxel_to_keep_is_lost_that_some_way_of_trimming_keeps(layered, data):
    path, solid, keep = data.draw(walks(layered))
    losses = least_losses(path.voxels, keep, piece_of(path))
    for length in range(2, len(path), 2):
        trimmed = lu.trim([path], length, keep=[keep])[0]
        check_trimmed(trimmed, path, solid, length)
        n_pairs, n_excursions, n_ends, n_lost = told(trimmed)
        lost, ends, excursions = losses[length]
        assert (n_lost, n_ends, n_excursions > 0) == (lost, ends, excursions > 0)
        assert n_pairs + n_excursions + n_ends == len(path) - length
        gone = {tuple(v) for v in path.voxels.tolist()} - {
            tuple(v) for v in trimmed.voxels.tolist()
        }
        assert n_lost == sum(keep[v] for v in gone)


@examples(220)
@given(walks(layered=True))
def test_one_scan_reaches_all_that_contracting_again_and_again_does(case):
    path, _, keep = case
    paths = contraction_outcomes(path.voxels, keep, piece_of(path))
    reached = {len(p) for p, cost in paths.items() if cost == (0, 0)}
    sums = {sum(j - i - 1 for i, j in s) for s in disjoint_subsets(contraction_pairs(path, keep))}
    assert reached == {len(path) - n for n in sums}


def test_the_surface_stays_while_the_inside_suffices():
    for item in (lu.layered_path(CUBE), lu.fold(CUBE, rounds=200, trial_rounds=50)):
        path = item.path if isinstance(item, lu.Folding) else item
        trimmed = lu.trim([item], len(path) - 8)[0]
        after = trimmed.path if isinstance(trimmed, lu.Folding) else trimmed
        assert kept(after, CUBE) == kept(path, CUBE)
        assert told(trimmed) == (8, 0, 0, 0)


def test_what_is_lost_of_the_surface_is_stated():
    for item in (lu.layered_path(CUBE), lu.fold(CUBE, rounds=200, trial_rounds=50)):
        path = item.path if isinstance(item, lu.Folding) else item
        trimmed = lu.trim([item], 60)[0]
        after = trimmed.path if isinstance(trimmed, lu.Folding) else trimmed
        n_pairs, n_excursions, n_ends, n_lost = told(trimmed)
        assert n_pairs + n_excursions + n_ends == len(path) - 60
        assert n_lost == kept(path, CUBE) - kept(after, CUBE) > 0


ARCH = [(0, 0, 0), (1, 0, 0), (1, 0, 1), (2, 0, 1), (2, 0, 0), (3, 0, 0), (3, 1, 0), (2, 1, 0)]


def arch(end):
    """A layered path with one excursion of two voxels; it may end in a pair of index 2."""
    voxels = np.array(ARCH[:end], np.int32)
    return lu.VoxelPath(voxels, visits_of(voxels, pieces_by_return(voxels)))


@pytest.mark.parametrize(
    ("end", "kept_voxels", "length", "expected"),
    [
        (6, [], 4, (0, 2, 0, 0)),  # nothing but the excursion: it goes whole
        (8, [], 6, (2, 0, 0, 0)),  # a pair goes before it
        (8, [], 4, (2, 2, 0, 0)),  # both
        (8, [(3, 1, 0)], 6, (0, 2, 0, 0)),  # the pair is protected, the excursion is not
        (6, [(1, 0, 1)], 4, (0, 0, 2, 0)),  # the excursion is protected, the ends are not
        (8, [(1, 0, 1), (3, 0, 0), (0, 0, 0), (2, 1, 0)], 6, (2, 0, 0, 1)),  # fewest to keep
        (6, ARCH[:6], 4, (0, 0, 2, 2)),  # an excursion to keep never goes
    ],
)
def test_each_fallback_in_its_order(end, kept_voxels, length, expected):
    keep = np.zeros((4, 2, 2), bool)
    for voxel in kept_voxels:
        keep[voxel] = True
    trimmed = lu.trim([arch(end)], length, keep=[keep])[0]
    assert told(trimmed) == expected
    occupancy = np.zeros((4, 2, 2), bool)
    occupancy[tuple(arch(end).voxels.T)] = True
    check_trimmed(trimmed, arch(end), lu.VoxelSolid(occupancy), length)


def test_a_pair_of_high_index_goes_before_an_excursion():
    steps = [*ARCH[:6], (3, 1, 0), (3, 2, 0), (4, 2, 0), (4, 1, 0), (4, 0, 0), (5, 0, 0)]
    voxels = np.array(steps, np.int32)
    path = lu.VoxelPath(voxels, visits_of(voxels, pieces_by_return(voxels)))
    assert told(lu.trim([path], 8, keep="none")[0]) == (4, 0, 0, 0)


def test_two_pieces_of_one_node_are_not_joined():
    """Two excursions down from one piece, side by side; only what is between them may go."""
    steps = [(0, 1), (0, 0), (1, 0), (1, 1), (2, 1), (2, 0), (3, 0), (3, 1)]
    voxels = np.array([(x, 0, z) for x, z in steps], np.int32)
    path = lu.VoxelPath(voxels, visits_of(voxels, pieces_by_return(voxels)))
    assert path.visits[:, 2].tolist() == [0, 1, 0, 2, 0]
    keep = np.ones((4, 1, 2), bool)
    keep[1:3, 0, 1] = False
    trimmed = lu.trim([path], 6, keep=[keep])[0]
    check_trimmed(trimmed, path, lu.VoxelSolid(np.ones((4, 1, 2), bool)), 6)
    assert told(trimmed) == (0, 0, 2, 2)


def test_a_path_cut_so_that_its_msp_comes_to_a_node_twice_is_no_longer_layered():
    climb = [*ARCH[:6], (3, 0, 1), (4, 0, 1)]
    occupancy = np.zeros((5, 1, 2), bool)
    occupancy[tuple(np.array(climb).T)] = True
    path = lu.VoxelPath(
        np.array(climb), visits_of(np.array(climb), np.array([0, 0, 1, 1, 0, 0, 2, 2]))
    )
    assert lu.certify_path(path, lu.VoxelSolid(occupancy)).ok
    at_start, at_end = np.zeros((2, 5, 1, 2), bool)
    at_start[tuple(path.voxels[:6].T)] = at_end[tuple(path.voxels[2:].T)] = True
    for keep, n_visits in ((at_start, 3), (at_end, 0)):
        trimmed = lu.trim([path], 6, keep=[keep])[0]
        check_trimmed(trimmed, path, lu.VoxelSolid(occupancy), 6)
        assert told(trimmed) == (0, 0, 2, 0)
        assert len(trimmed.visits) == n_visits


@pytest.mark.parametrize("at_start", [False, True])
def test_the_end_with_less_to_keep_is_cut(at_start):
    stick = lu.VoxelSolid(np.ones((1, 1, 10), bool))
    path, folding = lu.layered_path(stick), lu.fold(stick, rounds=10, trial_rounds=10)
    for item, whole in ((path, path), (folding, folding.path)):
        worthy = whole.voxels[:4] if at_start else whole.voxels[-4:]
        keep = np.zeros((1, 1, 10), bool)
        keep[tuple(worthy.T)] = True
        trimmed = lu.trim([item], 4, keep=[keep])[0]
        after = trimmed.path if isinstance(trimmed, lu.Folding) else trimmed
        assert np.array_equal(after.voxels, worthy)
        assert told(trimmed) == (0, 0, 6, 0)
        check_trimmed(trimmed, whole, stick, 4)


def test_a_stick_has_no_pairs_and_loses_its_ends():
    stick = lu.VoxelSolid(np.ones((1, 1, 10), bool))
    path, folding = lu.layered_path(stick), lu.fold(stick, rounds=10, trial_rounds=10)
    for item, whole in ((path, path), (folding, folding.path)):
        for keep, lost in (("surface", 6), ("none", 0)):
            trimmed = lu.trim([item], 4, keep=keep)[0]
            check_trimmed(trimmed, whole, stick, 4)
            assert told(trimmed) == (0, 0, 6, lost)


@examples(48, phases=NO_SHRINKING)
@given(polycubes(40), st.data())
def test_a_plan_stays_valid_whichever_ends_are_cut(occupancy, data):
    assume(occupancy.sum() > 1)
    folding = lu.fold(lu.VoxelSolid(occupancy), rounds=20, trial_rounds=5)
    n = len(folding.path)
    first = data.draw(st.integers(0, n - 2))
    stop = data.draw(st.integers(first + 2, n))
    plan = _without_ends(states_of(folding.motion), first, stop)
    verdict = lu.certify(motion_of(folding.path.voxels[first:stop], plan))
    assert verdict.ok, verdict.reason


def test_a_folding_loses_nothing_to_keep_while_pairs_and_ends_without_are_left():
    folding = lu.fold(CUBE, rounds=200, trial_rounds=50)
    voxels = folding.path.voxels
    keep = np.zeros(CUBE.occupancy.shape, bool)
    keep[tuple(voxels[10:40].T)] = True
    trimmed = lu.trim([folding], 60, keep=[keep])[0]
    check_trimmed(trimmed, folding.path, CUBE, 60)
    assert lu.certify(trimmed.motion).ok
    assert keep[tuple(trimmed.path.voxels.T)].sum() == 30
    assert told(trimmed)[2] > 0
    assert told(trimmed)[3] == 0


def test_a_path_too_long_for_one_table_is_shortened_in_instalments(monkeypatch):
    path = lu.layered_path(CUBE)
    whole = lu.trim([path], 60)[0]
    monkeypatch.setattr(contraction, "MAX_ENTRIES", 1000)
    parts = lu.trim([path], 60)[0]
    check_trimmed(parts, path, CUBE, 60)
    assert told(parts)[3] >= told(whole)[3]


def test_a_folding_has_pairs_of_high_index():
    ring = [(1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1), (0, 0)]
    path = flat_path([(x + 2, y) for x, y in [*ring, (-1, 0), (-2, 0)]])
    folding = lu.Folding(path, lu.unfold(path, "peel"))
    assert has_peel_plan(folding.motion)
    keep = np.zeros((6, 5, 2), bool)  # a grid may be larger than what the path was made for
    keep[:4, 0] = True
    trimmed = lu.trim([folding], 4, keep=[keep])[0]
    assert trimmed.path.voxels[:, 0].tolist() == [3, 2, 1, 0]
    assert told(trimmed) == (6, 0, 0, 0)
    assert lu.certify(trimmed.motion).ok


def test_a_layered_folding_stays_layered():
    folding = lu.fold(CUBE, method="layered")
    assert len(folding.path.visits)
    assert has_peel_plan(folding.motion)
    for length in (180, 120, 60):
        trimmed = lu.trim([folding], length)[0]
        check_trimmed(trimmed, folding.path, CUBE, length)
        assert len(trimmed.path.visits)
        assert lu.certify(trimmed.motion).ok


def test_an_accordion_is_unfolded_anew():
    path = lu.layered_path(lu.VoxelSolid(np.ones((6, 6, 1), bool)))
    motion = lu.unfold(path, "accordion")
    assert motion.straight
    trimmed = lu.trim([lu.Folding(path, motion)], 20)[0]
    assert lu.certify(trimmed.motion).ok
    assert len(trimmed.path) == 20


def test_all_items_come_to_the_length_of_the_shortest():
    paths = [lu.layered_path(lu.VoxelSolid(np.ones((n, 4, 4), bool))) for n in (4, 6, 5)]
    trimmed = lu.trim(paths)
    assert [len(path) for path in trimmed] == [64, 64, 64]
    assert trimmed[0] is paths[0]


@pytest.mark.parametrize("length", [63, 0, -2, 66])
def test_lengths_that_cannot_be_had_are_refused(length):
    path = lu.layered_path(lu.VoxelSolid(np.ones((4, 4, 4), bool)))
    with pytest.raises(ValueError, match=f"even number from 2 to the 64 voxels .* got {length}"):
        lu.trim([path], length)


def test_nothing_to_trim_is_refused():
    with pytest.raises(ValueError, match="nothing to trim"):
        lu.trim([])


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"method": "magic"}, "unknown trimming method 'magic'; known: "),
        ({"speed": 1}, "trimming method 'exact' has no option 'speed'"),
        ({"keep": "inside"}, "keep must be 'surface', 'none' or a mask for each item, got 'ins"),
        ({"keep": []}, "keep has 0 masks for 1 items"),
        ({"keep": [np.ones((4, 4, 3), bool)]}, r"of shape \(4, 4, 4\) or more, got bool of shape"),
        ({"keep": [np.ones((4, 4, 4))]}, "must be bool .* got float64"),
    ],
)
def test_bad_settings_are_refused(settings, message):
    path = lu.layered_path(lu.VoxelSolid(np.ones((4, 4, 4), bool)))
    with pytest.raises(ValueError, match=message):
        lu.trim([path], 4, **settings)


def test_an_odd_path_is_refused():
    with pytest.raises(ValueError, match="two voxels each, but an item has 3 voxels"):
        lu.trim([flat_path([(0, 0), (1, 0), (2, 0)])])
