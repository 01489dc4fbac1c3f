"""What a block is estimated to bear: closed formulas against beams cut into pieces."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh_tridiagonal

from lineup.block import BLOCKS, Block, block_strength, buckling_force_n, column_force_n
from lineup.block import strength as estimates
from lineup.block.parts import slot_half_width_mm
from lineup.block.strength import (
    insertion_strain,
    opening_mm,
    slenderness,
    snap_force_n,
    snap_strain,
)

PAPER = Block()


def grown(block, share):
    """Every length times a share, the clearance included."""
    names = ("pitch_mm", "gap_mm", "ball_mm", "bar_mm", "clearance_mm", "snap_mm")
    return replace(block, **{name: share * getattr(block, name) for name in names})


def test_euler_is_the_first_eigenvalue_of_a_column_between_pins():
    """-E I w'' = F w, w = 0 at both balls, by finite differences."""
    n, modulus = 400, 1800.0
    step = PAPER.pitch_mm / n
    stiffness = modulus * np.pi * PAPER.bar_mm**4 / 64 / step**2
    lowest = eigh_tridiagonal(
        np.full(n - 1, 2 * stiffness),
        np.full(n - 2, -stiffness),
        eigvals_only=True,
        select="i",
        select_range=(0, 0),
    )
    assert buckling_force_n(PAPER, modulus) == pytest.approx(lowest[0], rel=1e-4)


def test_fixed_ends_bear_four_times_as_much():
    assert buckling_force_n(PAPER, fixity=0.5) == pytest.approx(4 * buckling_force_n(PAPER))


def test_johnsons_parabola_meets_eulers_curve_where_half_the_strength_is_left():
    strength = 2 * np.pi**2 * 2600 / slenderness(PAPER) ** 2
    area = np.pi * PAPER.bar_mm**2 / 4
    just_below = column_force_n(PAPER, strength_mpa=strength * (1 - 1e-9))
    assert column_force_n(PAPER, strength_mpa=strength * (1 + 1e-9)) == pytest.approx(just_below)
    assert just_below == pytest.approx(area * strength / 2, rel=1e-6)
    assert just_below == pytest.approx(buckling_force_n(PAPER), rel=1e-6)


def test_a_stocky_hinge_is_crushed_before_it_buckles():
    area = np.pi * PAPER.bar_mm**2 / 4
    for strength in (38.0, 56.0):
        bears = column_force_n(PAPER, strength_mpa=strength)
        assert 0.8 * area * strength < bears < area * strength < buckling_force_n(PAPER)


@pytest.mark.parametrize("force", [buckling_force_n, column_force_n, snap_force_n])
def test_forces_grow_with_the_square_of_the_size(force):
    assert force(grown(PAPER, 2.0)) == pytest.approx(4 * force(PAPER))


@pytest.mark.parametrize("share", [insertion_strain, snap_strain, slenderness])
def test_strains_and_slenderness_do_not_grow(share):
    assert share(grown(PAPER, 2.0)) == pytest.approx(share(PAPER))


def test_a_side_of_a_slot_bends_and_shears_as_its_pieces_do():
    """A unit load on a cantilever: the work of moments and shear forces, summed up."""
    radius = (PAPER.radius_mm + PAPER.cavity_mm / 2) / 2
    length = radius * np.pi / 4
    middle = 3 * np.pi / 8
    depth = radius * np.sin(middle) * np.pi / 2
    depth -= 2 * slot_half_width_mm(PAPER, np.array(middle))
    width = PAPER.radius_mm - PAPER.cavity_mm / 2
    modulus, n = 2000.0, 20_000
    x = (np.arange(n) + 0.5) * length / n
    bending = (x**2 / (modulus * width * depth**3 / 12)).sum() * length / n
    shearing = length / (5 / 6 * modulus / 2.7 * width * depth)
    compliance, strain = estimates._side(PAPER, modulus)
    assert compliance == pytest.approx(bending + shearing, rel=1e-6)
    assert strain == pytest.approx(length * (depth / 2) / (modulus * width * depth**3 / 12))


def test_without_friction_a_snap_gives_back_what_it_takes():
    """Then the force times the slope's run is the springs' energy, for a slope that is even."""
    slope = estimates._steepest(PAPER)
    stiffness = 1 / estimates._side(PAPER, 2600.0)[0]
    exact = 2 * stiffness * PAPER.snap_mm * slope
    assert snap_force_n(PAPER, friction=0.0) == pytest.approx(exact)
    assert snap_force_n(PAPER, friction=0.5) > 2 * snap_force_n(PAPER, friction=0.0)


def test_nothing_snaps_where_slots_leave_room():
    assert snap_force_n(BLOCKS["pull"]) == snap_strain(BLOCKS["pull"]) == 0
    assert snap_force_n(replace(PAPER, snap_mm=0.2)) > 2 * snap_force_n(PAPER)


def test_no_ball_is_pressed_in_without_breaking_the_paper_block():
    """Resins break at some percent; why plates are joined by tongue and groove."""
    assert insertion_strain(PAPER) > 0.15
    assert opening_mm(PAPER) < 0.75 * PAPER.ball_mm


def test_the_table_has_the_papers_figures():
    table = block_strength(PAPER)
    paper = table.set_index("quantity")["paper"]
    assert paper["hinge buckles (Euler)"] == 2042
    assert paper["velcro bears"] == 206.7
    assert math.isnan(paper["hinge snaps through a slot"])
    bond = block_strength(PAPER, bond_kpa=100.0).set_index("quantity")["value"]
    assert bond["velcro on a face of a voxel bears"] == pytest.approx(10.0)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"modulus_mpa": 0.0}, "modulus_mpa must be a positive number, got 0"),
        ({"strength_mpa": -1.0}, "strength_mpa must be a positive number, got -1"),
        ({"bond_kpa": math.nan}, "bond_kpa must be a positive number, got nan"),
        ({"friction": 2.0}, "friction must be from 0 to 1, got 2"),
    ],
)
def test_materials_that_are_none_are_refused(options, says):
    with pytest.raises(ValueError, match=says):
        block_strength(PAPER, **options)
