"""Rigid voxels and springs beside finite elements that know nothing of them (tests/hex8.py).

Face-mean tractions of blocks, beams and arches, one lump of resin each. Without Poisson's ratio,
which springs across faces cannot have, they agree closely but at re-entrant edges, where the
finite elements themselves go on changing as they get finer. With it, the faces next to a wall
that keeps the resin from spreading differ by a quarter of the largest, and the largest by 7 %.
"""

import hex8
import numpy as np
import pytest
from strands import boustrophedon, path

import lineup as lu
from lineup.stress import measured, network

SIDES = {(2, -1): "-z", (0, -1): "-x", (2, 1): "+z"}
UP, TILTED = (0.0, 0.0, 1.0), (1.0, 2.0, 3.0)


def of(occupancy):
    solid = lu.VoxelSolid(occupancy)
    voxels = lu.layered_path(solid).voxels
    assert len(voxels) == solid.size
    return voxels


def arch():
    occupancy = np.ones((7, 3, 6), bool)
    occupancy[2:5, :, :4] = False
    return of(occupancy)


def flag():
    occupancy = np.ones((9, 4, 5), bool)
    occupancy[:6, :, :3] = False
    return of(occupancy)


def both(voxels, held, up, poisson, monkeypatch, split=2):
    """Tractions of the faces between voxels, in weights of a voxel: ours, and by elements."""
    monkeypatch.setattr(network, "POISSON", poisson)
    up = np.array(up) / np.linalg.norm(up)
    result = lu.strength(path(voxels), bonding="solid", held=SIDES[held], up=tuple(up.tolist()))
    table = result.table[result.table["second"] >= 0]
    pairs = table[["first", "second"]].to_numpy(int)
    found = hex8.solved(voxels, split, held, up, poisson)
    normals = voxels[pairs[:, 1]] - voxels[pairs[:, 0]]
    ours = table["traction_pa"].to_numpy() / result.setting.pascal
    return ours, hex8.face_tractions(found, pairs, normals)


def off(ours, theirs):
    return np.linalg.norm(ours - theirs) / np.linalg.norm(theirs)


# The oracle itself


def test_elements_hang_as_they_should():
    column = np.array([(0, 0, z) for z in range(6)])
    found = hex8.solved(column, 1, (2, 1), poisson=0.0)
    pairs = np.array([(k, k + 1) for k in range(5)])
    tractions = hex8.face_tractions(found, pairs, np.tile([0, 0, 1], (5, 1)))
    np.testing.assert_allclose(tractions, np.arange(1, 6), rtol=1e-9)


@pytest.mark.parametrize("split", [1, 2])
def test_elements_bend_with_the_modes_and_lock_without(split):
    beam = np.array([(x, 0, 0) for x in range(16)])
    theory = 16**4 / 8 * 12
    with_modes = hex8.solved(beam, split, (0, -1), poisson=0.0)["sag"] / theory
    without = hex8.solved(beam, split, (0, -1), poisson=0.0, modes=False)["sag"] / theory
    assert with_modes == pytest.approx(1.004, abs=0.003)  # and a little by shear
    assert without == pytest.approx({1: 0.67, 2: 0.89}[split], abs=0.01)


# Beside the springs

CASES = {
    "a block": (boustrophedon(3, 3, 6), (2, -1), UP, 1e-9),
    "a block that hangs": (boustrophedon(3, 3, 6), (2, 1), UP, 1e-9),
    "a block, tilted": (boustrophedon(3, 3, 6), (2, -1), TILTED, 0.03),
    "a beam": (boustrophedon(10, 3, 3), (0, -1), UP, 0.015),
    "an arch": (arch(), (2, -1), UP, 0.06),
    "a flag": (flag(), (2, -1), UP, 0.15),
}


@pytest.mark.parametrize("name", CASES)
def test_face_tractions_agree(name, monkeypatch):
    voxels, held, up, tolerance = CASES[name]
    ours, theirs = both(voxels, held, up, 0.0, monkeypatch)
    assert off(ours, theirs) < tolerance
    assert np.abs(ours).max() == pytest.approx(np.abs(theirs).max(), rel=0.03)


@pytest.mark.parametrize("name", ["a block", "a beam", "an arch", "a flag"])
def test_the_largest_traction_agrees_with_poisson_s_ratio_too(name, monkeypatch):
    voxels, held, up, _ = CASES[name]
    ours, theirs = both(voxels, held, up, 0.35, monkeypatch)
    assert np.abs(ours).max() == pytest.approx(np.abs(theirs).max(), rel=0.08)


def test_elements_catch_springs_of_the_wrong_stiffness(monkeypatch):
    """Planted: faces as stiff against bending as a face of twice the side."""
    own = network.springs

    def wrong(faces):
        stiffness = own(faces).reshape(-1, 6)
        stiffness[:, 3:] *= 16
        return stiffness.ravel()

    voxels, held, up, tolerance = CASES["an arch"]
    monkeypatch.setattr(network, "springs", wrong)
    monkeypatch.setattr(measured, "springs", wrong)
    assert off(*both(voxels, held, up, 0.0, monkeypatch)) > 2 * tolerance
