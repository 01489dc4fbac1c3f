"""Paths that the judge must certify, and the faults that it must find."""

import numpy as np
import pytest
from examples import examples
from hypothesis import assume, given
from hypothesis import strategies as st
from oracles import alternates, enclosing, layer_runs
from polycubes import STEPS, polycubes

import lineup as lu
from lineup import grid
from lineup.visits import visits_of

# Two pillars on a plate of 4 x 2 voxels; the path climbs each pillar and comes back.
PILLARS = np.zeros((4, 2, 3), bool)
PILLARS[:, :, 0] = True
PILLARS[[0, 3], :, 1:] = True


def walk(word, start=(0, 0, 0)):
    steps = [grid.DIRECTIONS[grid.LETTERS.index(c)] for c in word]
    return np.vstack([start, start + np.cumsum(steps, axis=0)])


def rest(occupancy, voxels):
    left = occupancy.copy()
    left[tuple(np.asarray(voxels).T)] = False
    return np.argwhere(left)


def described(voxels, occupancy):
    """Visits by flooding, with each node named 10 times its component plus 3."""
    runs = layer_runs(voxels, occupancy)
    names = [r[2] for r in runs]
    rows = [(a, b, 10 * c + 3, enclosing(names, k)) for k, (a, b, c) in enumerate(runs)]
    return np.array(rows)


NESTED = walk("UUNDDESENEUUSDD")
VISITS = described(NESTED, PILLARS)


def pillars(**change):
    fields = {"voxels": NESTED, "visits": VISITS, "dropped": rest(PILLARS, NESTED)}
    return lu.VoxelPath(**(fields | change))


def changed(rows, k, column, value):
    rows = np.array(rows)
    rows[k, column] = value
    return rows


def test_visits_of_the_pillars_by_hand():
    """Plate, one pillar to its top and back, plate, the other and back, plate."""
    names = ["plate", "left", "top", "left", "plate", "right", "other_top", "right", "plate"]
    ids = VISITS[:, 2].tolist()
    assert [names.index(name) for name in names] == [ids.index(node) for node in ids]
    assert VISITS[:, 3].tolist() == [0, 1, 2, 1, 0, 1, 2, 1, 0]
    assert VISITS[:, 0].tolist() == [0, 1, 2, 4, 5, 11, 12, 14, 15]


GOOD = {
    "pillars": (pillars(), PILLARS),
    "pillars, not layered": (pillars(visits=np.empty((0, 4), int)), PILLARS),
    "end in a pillar": (
        pillars(voxels=NESTED[:-2], visits=VISITS[:0], dropped=rest(PILLARS, NESTED[:-2])),
        PILLARS,
    ),
    "refined": (
        lu.VoxelPath(
            walk("UEN"), refinement=2, dropped=rest(np.ones((2, 2, 2), bool), walk("UEN"))
        ),
        np.ones((1, 1, 1), bool),
    ),
}


@pytest.mark.parametrize("name", GOOD)
def test_good_paths_are_certified(name):
    path, occupancy = GOOD[name]
    verdict = lu.certify_path(path, lu.VoxelSolid(occupancy))
    assert (verdict.ok, verdict.reason, verdict.where) == (True, "certified", -1)


FAULTS = {
    "no voxel": ({"voxels": np.empty((0, 3), int)}, -1, "it has no voxel"),
    "voxel twice": ({"voxels": walk("ENWSUU")[:6]}, 4, "steps 0 and 4 visit one voxel"),
    "gap": ({"voxels": np.delete(NESTED, 9, axis=0)}, 8, "voxels 8 and 9 do not share a face"),
    "odd length": ({"voxels": NESTED[:-1]}, 14, "15 voxels, not an even number"),
    "outside the solid": ({"voxels": walk("EU")[1:]}, 1, "voxel (1, 0, 1) of step 1 is outside"),
    "begins outside": ({"voxels": walk("EU")[:0:-1]}, 0, "voxel (1, 0, 1) of step 0 is outside"),
    "outside the grid": ({"voxels": walk("EEEES")}, 4, "voxel (4, 0, 0) of step 4 is outside"),
    "below the grid": ({"voxels": walk("WWN")}, 1, "voxel (-1, 0, 0) of step 1 is outside"),
    "wrong refinement": ({"refinement": 2}, -1, "the refined solid has "),
    "a grid beyond all memory": ({"refinement": 10**6}, -1, "the refined solid has "),
    "no refinement": ({"refinement": 0}, -1, "refinement 0 is not a positive number"),
    "nothing dropped": ({"voxels": NESTED[:-2]}, -1, "dropped is not the 2 voxels"),
    "dropped what it visits": ({"dropped": NESTED[:1]}, -1, "(it has 1 rows)"),
    "dropped two others": (
        {"voxels": NESTED[:-2], "dropped": NESTED[-4:-2]},
        -1,
        "dropped is not the 2 voxels that the path leaves out, in lexicographic order",
    ),
    "dropped out of order": (
        {"voxels": NESTED[:-2], "dropped": rest(PILLARS, NESTED[:-2])[::-1]},
        -1,
        "dropped is not the 2 voxels",
    ),
    "no visit": ({"visits": VISITS[:-1]}, 15, "no visit 8 of steps 15 to 16"),
    "one visit too many": (
        {"visits": np.vstack([VISITS, [(16, 16, 3, 0)]])},
        15,
        "10 visits, but the path has 9 runs",
    ),
    "cut visit": (
        {"visits": np.vstack([VISITS[:4], [(6, 8, 3, 0), (8, 10, 3, 0)], VISITS[5:]])},
        None,
        "one run in a component",
    ),
    "shifted visit": ({"visits": changed(VISITS, 2, 0, 3)}, 2, "no visit 2 of steps 2 to 4"),
    "piece of two components": (
        {"visits": changed(changed(VISITS, 5, 2, VISITS[1, 2]), 7, 2, VISITS[1, 2])},
        11,
        "lies in two components",
    ),
    "piece cut in two": (
        {"visits": changed(VISITS, 7, 2, 99)},
        12,
        "visit 6 has depth 2, but 1 pieces enclose it",
    ),
    "depth too small": (
        {"visits": changed(VISITS, 2, 3, 1)},
        2,
        "visit 2 has depth 1, but 2 pieces",
    ),
    "depth on the MSP": ({"visits": changed(VISITS, 4, 3, 1)}, None, "visit 4 has depth 1, but 0"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_planted_faults_are_refused(name):
    change, where, words = FAULTS[name]
    verdict = lu.certify_path(pillars(**change), lu.VoxelSolid(PILLARS))
    assert not verdict.ok
    assert words in verdict.reason
    assert where is None or verdict.where == where


def test_a_piece_goes_on_beside_where_it_was_left():
    """Over a gap of one voxel the path comes back, but no link of the plate was ever there."""
    bridge = np.ones((3, 1, 2), bool)
    bridge[1, 0, 0] = False
    plate = np.concatenate([bridge, np.ones((3, 1, 2), bool)], axis=1)
    voxels = walk("UEEDNU")
    there_and_back = np.array([(0, 1, 0, 0), (1, 4, 1, 1), (4, 6, 0, 0)])
    path = lu.VoxelPath(voxels[:6], there_and_back, rest(plate, voxels[:6]))
    verdict = lu.certify_path(path, lu.VoxelSolid(plate))
    assert (verdict.reason, verdict.where) == ("piece 0 goes on 2 voxels from where it was left", 4)


def test_the_msp_comes_to_no_node_twice():
    """Up one column and down the next one, told as two pieces of the MSP instead of one."""
    block = np.ones((4, 1, 2), bool)
    voxels = walk("EUED")[1:]
    rows = np.array([(0, 1, 0, 0), (1, 3, 1, 0), (3, 4, 2, 0)])
    path = lu.VoxelPath(voxels, rows, rest(block, voxels))
    verdict = lu.certify_path(path, lu.VoxelSolid(block))
    assert (verdict.reason, verdict.where) == ("pieces 0 and 2 of the MSP lie in one component", 3)


def test_alternating_pieces_are_refused():
    """Bottom, top, bottom, top: the second bottom leaves a top that is not finished."""
    block = np.ones((4, 1, 2), bool)
    voxels = walk("UEDEUED")
    visits = described(voxels, block)
    path = lu.VoxelPath(voxels, visits, rest(block, voxels))
    verdict = lu.certify_path(path, lu.VoxelSolid(block))
    assert "alternate instead of nesting" in verdict.reason
    assert verdict.where == 3


CUP = np.ones((5, 5, 4), bool)
CUP[2, 2, 2:] = False

U_FAULTS = {
    "a U": (walk("ENWN"), np.ones((2, 3, 1), bool), 0, "steps 0 to 3 form a U"),
    "a U at the end": (walk("EENW")[1:], np.ones((3, 2, 1), bool), 0, "steps 0 to 3 form a U"),
    "both ends inside": (
        walk("E", (1, 1, 1)),
        np.ones((4, 3, 3), bool),
        -1,
        "no end can leave the solid",
    ),
    "a U on the way out": (walk("SUE", (2, 2, 1)), CUP, -1, "no end can leave the solid"),
    "a U on the way out of the other end": (
        walk("SUE", (2, 2, 1))[::-1],
        CUP,
        -1,
        "no end can leave the solid",
    ),
}


@pytest.mark.parametrize("name", U_FAULTS)
def test_us_are_found_where_asked_for(name):
    voxels, occupancy, where, words = U_FAULTS[name]
    voxels = voxels[: len(voxels) // 2 * 2]
    path = lu.VoxelPath(voxels, dropped=rest(occupancy, voxels))
    solid = lu.VoxelSolid(occupancy)
    assert lu.certify_path(path, solid).ok
    verdict = lu.certify_path(path, solid, u_free=True)
    assert not verdict.ok
    assert words in verdict.reason
    assert verdict.where == where


@pytest.mark.parametrize("voxels", [walk("SEU", (2, 2, 1)), walk("SEU", (2, 2, 1))[::-1]])
def test_one_way_out_without_a_u_is_enough(voxels):
    path = lu.VoxelPath(voxels, dropped=rest(CUP, voxels))
    assert lu.certify_path(path, lu.VoxelSolid(CUP), u_free=True).reason == "certified"


def goes_on_beside(voxels, visits):
    """Whether every run begins beside the end of the last run of the same number."""
    left = {}
    beside = []
    for start, stop, piece, _ in visits.tolist():
        if piece in left:
            beside.append(sum(abs(a - b) for a, b in zip(voxels[start], left[piece], strict=True)))
        left[piece] = voxels[stop - 1]
    return all(gap == 1 for gap in beside)


@examples(400)
@given(polycubes(40), st.data())
def test_visits_agree_with_flooding(occupancy, data):
    """Any walk in any solid: certified if components nest and are gone back to by Case 2."""
    voxels = [data.draw(st.sampled_from(list(map(tuple, np.argwhere(occupancy).tolist()))))]
    free = {tuple(v) for v in np.argwhere(occupancy).tolist()} - set(voxels)
    while True:
        x, y, z = voxels[-1]
        onward = [v for v in ((x + a, y + b, z + c) for a, b, c in STEPS) if v in free]
        if not onward:
            break
        voxels.append(data.draw(st.sampled_from(onward)))
        free.remove(voxels[-1])
    voxels = voxels[: len(voxels) // 2 * 2]
    assume(voxels)
    visits = described(voxels, occupancy)
    solid = lu.VoxelSolid(occupancy)
    path = lu.VoxelPath(np.array(voxels), visits, rest(occupancy, voxels))
    verdict = lu.certify_path(path, solid)
    back_beside = goes_on_beside(voxels, visits)
    assert verdict.ok == (back_beside and not alternates(visits[:, 2].tolist()))
    here = np.repeat(visits[:, 2], visits[:, 1] - visits[:, 0])
    if verdict.ok:
        assert visits_of(path.voxels, here).tolist() == visits.tolist()
    apart = visits.copy()
    apart[:, 2:] = np.stack([np.arange(len(visits)), np.zeros(len(visits))], axis=1)
    all_msp = lu.VoxelPath(path.voxels, apart, path.dropped)
    assert lu.certify_path(all_msp, solid).ok == (len(set(visits[:, 2].tolist())) == len(visits))
    row, column = data.draw(st.integers(0, len(visits) - 1)), data.draw(st.integers(0, 3))
    wrong = changed(visits, row, column, visits[row, column] + data.draw(st.sampled_from([-1, 1])))
    renamed = column == 2 and (visits[:, 2] == visits[row, 2]).sum() == 1
    if not renamed:
        bad = lu.VoxelPath(path.voxels, wrong, path.dropped)
        assert not lu.certify_path(bad, solid).ok
