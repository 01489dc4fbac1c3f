"""Estimates of what a block bears and of how hard it snaps, beside the paper's test (Figure 17).

Closed formulas of beams, for materials given by their numbers: the paper names its resin (UV9400,
compressive strength 38 to 56 MPa), but not its modulus or friction, and not the size of its block.
They tell orders of magnitude, for the coupon to correct.
"""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from ..grid import FloatArray
from .parameters import Block
from .parts import NECK, slot_half_width_mm

PAPER_BUCKLING_N = 2042.0
PAPER_TENSION_KPA = 206.7
"""Figure 17: the load at which blocks buckled, and the stress at which velcro let go."""

_SHEAR = 5 / 6
"""Of the area of a rectangle that counts in shear (Timoshenko)."""
_POISSON = 0.35


def slenderness(block: Block) -> float:
    """Length of a hinge between its balls over the radius of gyration of its bar.

    Examples
    --------
    >>> round(slenderness(Block()), 1)
    15.4
    """
    return block.pitch_mm / (block.bar_mm / 4)


def buckling_force_n(block: Block, modulus_mpa: float = 2600.0, fixity: float = 1.0) -> float:
    """Euler's load pi^2 E I / (K a)^2 of a hinge (Timoshenko and Gere, Elastic Stability, 2.1).

    Parameters
    ----------
    modulus_mpa : float
        Young's modulus E; 2600 is usual for stereolithography resins.
    fixity : float
        K: 1 where both balls turn freely, 0.5 where neither does.

    Raises
    ------
    ValueError
        If a number is not positive.

    Examples
    --------
    >>> round(buckling_force_n(Block()))
    576
    """
    _positive(modulus_mpa=modulus_mpa, fixity=fixity)
    second_moment = math.pi * block.bar_mm**4 / 64
    return math.pi**2 * modulus_mpa * second_moment / (fixity * block.pitch_mm) ** 2


def column_force_n(
    block: Block, modulus_mpa: float = 2600.0, strength_mpa: float = 38.0, fixity: float = 1.0
) -> float:
    """The load at which a hinge fails as a column: Euler's, or for a stocky one J. B. Johnson's.

    Below a slenderness of sqrt(2 pi^2 E / s) a column of compressive strength s yields before it
    buckles, at A s (1 - s l^2 / (4 pi^2 E)) (Shigley, Mechanical Engineering Design, 4-13).

    Raises
    ------
    ValueError
        If a number is not positive.

    Examples
    --------
    >>> round(column_force_n(Block()))
    184
    """
    _positive(strength_mpa=strength_mpa)
    euler = buckling_force_n(block, modulus_mpa, fixity)
    ratio = fixity * slenderness(block)
    if ratio >= math.sqrt(2 * math.pi**2 * modulus_mpa / strength_mpa):
        return euler
    area = math.pi * block.bar_mm**2 / 4
    share = strength_mpa * ratio**2 / (4 * math.pi**2 * modulus_mpa)
    return area * strength_mpa * (1 - share)


def snap_force_n(block: Block, modulus_mpa: float = 2600.0, friction: float = 0.3) -> float:
    """The force on a bar, at the outside of the capsule, that drives it through a slot's neck.

    Each side of the slot is taken for a short cantilever from the slot's end to its neck, as wide
    as the shell is thick, that bends and shears aside by the snap (Timoshenko's beam). A side
    pressed with P against a slope t asks for P (m + t) / (1 - m t), with friction m (Bayer,
    Snap-Fit Joints for Plastics, part B); there are two.

    Parameters
    ----------
    friction : float
        Between bar and slot.

    Raises
    ------
    ValueError
        If the modulus is not positive, or the friction not from 0 to 1.

    Examples
    --------
    >>> round(snap_force_n(Block()))
    75
    """
    _positive(modulus_mpa=modulus_mpa)
    if not 0 <= friction <= 1:
        raise ValueError(f"friction must be from 0 to 1, got {friction:g}")
    slope = _steepest(block)
    press = max(block.snap_mm, 0.0) / _side(block, modulus_mpa)[0]
    return 2 * press * (friction + slope) / (1 - friction * slope)


def snap_strain(block: Block) -> float:
    """The largest strain of a slot's side while a bar passes its neck, as `snap_force_n` has it.

    Examples
    --------
    >>> round(snap_strain(Block()), 3)
    0.028
    """
    compliance, strain = _side(block, 1.0)
    return strain * max(block.snap_mm, 0.0) / compliance


def opening_mm(block: Block) -> float:
    """Diameter of the largest ball that slips out of a socket along its axis.

    Examples
    --------
    >>> opening_mm(Block()) < Block().ball_mm
    True
    """
    return 2 * _lip(block)[1]


def insertion_strain(block: Block) -> float:
    """The strain of the shell's four petals if a ball were pressed in at the pole.

    A petal is taken for a cantilever from the slots' ends to its lip: strain 3 t y / (2 l^2) at
    thickness t, length l, and deflection y (Bayer, Snap-Fit Joints for Plastics, part B). It is
    why chains of several plates are not joined by pressing a ball in.

    Examples
    --------
    >>> round(insertion_strain(Block()), 2)
    0.21
    """
    polar, lip = _lip(block)
    thickness = block.radius_mm - block.cavity_mm / 2
    length = _shell_radius(block) * (math.radians(block.bend_deg) - polar)
    deflection = block.ball_mm / 2 - lip
    return 1.5 * thickness * deflection / length**2


def block_strength(
    block: Block,
    modulus_mpa: float = 2600.0,
    strength_mpa: float = 38.0,
    friction: float = 0.3,
    bond_kpa: float = PAPER_TENSION_KPA,
) -> pd.DataFrame:
    """What a block bears, estimated, beside what the paper measured of its own (Figure 17).

    Parameters
    ----------
    modulus_mpa, strength_mpa : float
        Young's modulus and compressive strength of the material.
    friction : float
    bond_kpa : float
        Tensile stress that velcro bears.

    Returns
    -------
    DataFrame
        Columns quantity, value, unit, paper; `paper` is nan where it has no such number.

    Raises
    ------
    ValueError
        If a number is out of its range.

    Examples
    --------
    >>> block_strength(Block())["quantity"].tolist()[:2]
    ['slenderness of the hinge', 'hinge buckles (Euler)']
    """
    _positive(bond_kpa=bond_kpa)
    nan = math.nan
    rows = [
        ("slenderness of the hinge", slenderness(block), "", nan),
        ("hinge buckles (Euler)", buckling_force_n(block, modulus_mpa), "N", PAPER_BUCKLING_N),
        (
            "hinge fails (Euler or Johnson)",
            column_force_n(block, modulus_mpa, strength_mpa),
            "N",
            PAPER_BUCKLING_N,
        ),
        ("hinge snaps through a slot", snap_force_n(block, modulus_mpa, friction), "N", nan),
        ("strain of a slot's side then", 100 * snap_strain(block), "%", nan),
        ("strain if a ball were pressed in", 100 * insertion_strain(block), "%", nan),
        ("velcro bears", bond_kpa, "kPa", PAPER_TENSION_KPA),
        ("velcro on a face of a voxel bears", bond_kpa * block.pitch_mm**2 / 1000, "N", nan),
    ]
    return pd.DataFrame(rows, columns=["quantity", "value", "unit", "paper"])


def _positive(**numbers: float) -> None:
    for name, value in numbers.items():
        if not (math.isfinite(value) and value > 0):
            raise ValueError(f"{name} must be a positive number, got {value:g}")


def _shell_radius(block: Block) -> float:
    """Half way between cavity and surface."""
    return (block.radius_mm + block.cavity_mm / 2) / 2


def _side(block: Block, modulus_mpa: float) -> tuple[float, float]:
    """Deflection, and largest strain, that 1 N at the neck causes in the side of a slot."""
    bend = math.radians(block.bend_deg)
    radius = _shell_radius(block)
    length = radius * (bend - NECK)
    middle = (bend + NECK) / 2
    wide = radius * math.sin(middle) * math.pi / 2
    depth = wide - 2 * float(slot_half_width_mm(block, np.array([middle]))[0])
    width = block.radius_mm - block.cavity_mm / 2
    second_moment = width * depth**3 / 12
    shear_modulus = modulus_mpa / (2 * (1 + _POISSON))
    bending = length**3 / (3 * modulus_mpa * second_moment)
    shearing = length / (_SHEAR * shear_modulus * width * depth)
    return bending + shearing, length * depth / 2 / (modulus_mpa * second_moment)


def _steepest(block: Block) -> float:
    """The steepest slope of a slot's side on the way to its neck."""
    polar = np.linspace(0, NECK, 65)
    half = slot_half_width_mm(block, polar)
    return float(-(np.diff(half) / (np.diff(polar) * block.radius_mm)).min())


def _lip(block: Block) -> tuple[float, float]:
    """Where the petals come nearest to the axis: angle from the pole, and distance.

    A petal's edge is where the sides of two slots cross, at y = z = the half width of a slot there.
    """
    along = np.linspace(0, block.radius_mm, 401)[1:]
    edge: FloatArray = np.full(along.shape, block.hole_mm / 2)
    for _ in range(60):  # the slots narrow slowly, so this converges
        edge = slot_half_width_mm(block, np.arctan2(edge, along))
    distance = math.sqrt(2) * edge
    outside = distance**2 + along**2 > (block.cavity_mm / 2) ** 2
    inside = distance**2 + along**2 < block.radius_mm**2
    distance[~(outside & inside)] = math.inf
    k = int(distance.argmin())
    return math.atan2(distance[k], along[k]), float(distance[k])
