"""Section 5: contraction pairs, and trimming of paths and foldings to one length."""

import re

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from polycubes import polycubes

import lineup as lu
from lineup.contraction import contraction_pairs
from lineup.grid import surface

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


@settings(max_examples=60, deadline=None)
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


@settings(max_examples=60, deadline=None)
@given(polycubes(60), st.data())
def test_a_path_of_any_solid_is_trimmed_to_any_even_length(occupancy, data):
    solid = lu.VoxelSolid(occupancy)
    if solid.size < 2:
        return
    path = lu.layered_path(solid, starts=1)
    length = 2 * data.draw(st.integers(1, len(path) // 2))
    check_trimmed(lu.trim([path], length)[0], path, solid, length)


@settings(max_examples=25, deadline=None, phases=NO_SHRINKING)
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


def test_the_surface_stays_while_the_inside_suffices():
    for item in (lu.layered_path(CUBE), lu.fold(CUBE, rounds=200, trial_rounds=50)):
        path = item.path if isinstance(item, lu.Folding) else item
        trimmed = lu.trim([item], len(path) - 8)[0]
        after = trimmed.path if isinstance(trimmed, lu.Folding) else trimmed
        assert kept(after, CUBE) == kept(path, CUBE)
        assert after.method.endswith(
            "trimmed by 8 voxels inside, 0 on the surface and 0 off the end"
        )


def test_the_fallback_is_stated():
    path = lu.layered_path(CUBE)
    trimmed = lu.trim([path], 60)[0]
    inside, on_surface, off_end = map(int, re.findall(r"\d+", trimmed.method))
    assert on_surface > 0
    assert off_end > 0
    assert inside + on_surface + off_end == len(path) - 60
    lost = kept(path, CUBE) - kept(trimmed, CUBE)
    assert on_surface <= lost <= on_surface + off_end


def test_a_stick_has_no_pairs_and_loses_its_end():
    stick = lu.VoxelSolid(np.ones((1, 1, 10), bool))
    path = lu.layered_path(stick)
    folding = lu.fold(stick, rounds=10, trial_rounds=10)
    for item in (path, folding):
        trimmed = lu.trim([item], 4)[0]
        check_trimmed(trimmed, path if item is path else folding.path, stick, 4)
        after = trimmed.path if isinstance(trimmed, lu.Folding) else trimmed
        assert after.method.endswith("0 on the surface and 6 off the end")


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
