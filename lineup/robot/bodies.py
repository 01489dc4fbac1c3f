"""Masses and inertias of the pieces of a chain (Figures 2 and 16), in metres and kilograms.

Block i is hinge i between pieces i and i + 1. Pieces 1 to n - 1 are capsules, w2 of one block and
w1 of the next; pieces 0 and n, at the ends, are half a capsule each.
"""

from dataclasses import dataclass

import numpy as np

from ..grid import FloatArray

BALL, BAR = 0.5, 0.26
"""Diameters of a hinge's balls and of its bar, as shares of the pitch."""


@dataclass(frozen=True)
class Bodies:
    """What moves when a chain does; a body's x axis is that of the chain.

    Attributes
    ----------
    pitch_m, radius_m : float
        Distance of neighbouring joints, and radius of a capsule.
    capsule_kg, end_kg, hinge_kg : float
        A block weighs as much as a solid capsule in all: what is hinge is taken off the pieces.
    end_com_m : float
        How far beyond its joint the centre of mass of an end piece is.
    capsule_kgm2, end_kgm2, hinge_kgm2 : (float, float)
        Moments of inertia about the x axis and across it, through the centre of mass.
    """

    pitch_m: float
    radius_m: float
    capsule_kg: float
    end_kg: float
    hinge_kg: float
    end_com_m: float
    capsule_kgm2: tuple[float, float]
    end_kgm2: tuple[float, float]
    hinge_kgm2: tuple[float, float]

    @property
    def block_kg(self) -> float:
        """Mass of a block in the midst of the chain."""
        return self.capsule_kg + self.hinge_kg


def bodies_of(pitch_mm: float, gap_mm: float, density: float) -> Bodies:
    """The pieces of a chain of such a pitch, gap between blocks that touch, and kg a cubic metre.

    Raises
    ------
    ValueError
        If pitch or density are not positive, or the gap is not from 0 to half the pitch.

    Examples
    --------
    >>> from lineup.robot.bodies import bodies_of
    >>> f"{1000 * bodies_of(10.0, 0.3, 1130.0).block_kg:.2f} g"
    '1.37 g'
    """
    for name, value in (("pitch_mm", pitch_mm), ("density", density)):
        if not (np.isfinite(value) and value > 0):
            raise ValueError(f"{name} must be a positive number, got {value}")
    if not 0 <= gap_mm < pitch_mm / 2:
        raise ValueError(f"gap_mm must be from 0 to below half of {pitch_mm}, got {gap_mm}")
    a, r = pitch_mm / 1000, (pitch_mm - gap_mm) / 2000
    tube, cap = np.pi * r**2 * a * density, 4 / 3 * np.pi * r**3 * density
    hinge = _hinge(a, density)
    share = 1 - hinge[0] / (tube + cap)
    com, end = _end(tube / 2, cap / 2, a, r)
    along = tube * r**2 / 2 + cap * r**2 * 2 / 5
    across = tube * (r**2 / 4 + a**2 / 12) + cap * (2 / 5 * r**2 + a**2 / 4 + 3 / 8 * a * r)
    return Bodies(
        pitch_m=a,
        radius_m=r,
        capsule_kg=share * (tube + cap),
        end_kg=share * (tube + cap) / 2,
        hinge_kg=hinge[0],
        end_com_m=com,
        capsule_kgm2=(share * along, share * across),
        end_kgm2=(share * end[0], share * end[1]),
        hinge_kgm2=hinge[1:],
    )


def _hinge(a: float, density: float) -> tuple[float, float, float]:
    """Mass and moments of a bar with a ball at each end; what they share counts as ball."""
    r, ball = BAR * a / 2, BALL * a / 2
    length = a - 2 * ball
    bar = np.pi * r**2 * length * density
    balls = 2 * 4 / 3 * np.pi * ball**3 * density
    along = bar * r**2 / 2 + balls * ball**2 * 2 / 5
    across = bar * (r**2 / 4 + length**2 / 12) + balls * (ball**2 * 2 / 5 + a**2 / 4)
    return bar + balls, along, across


def _end(tube: float, cap: float, a: float, r: float) -> tuple[float, tuple[float, float]]:
    """Centre of mass and moments of half a capsule: half a ball inward, a cylinder outward."""
    mass = tube + cap
    com = (tube * a / 4 - cap * r * 3 / 8) / mass
    along = tube * r**2 / 2 + cap * r**2 * 2 / 5
    about_joint = tube * (r**2 / 4 + a**2 / 12) + cap * r**2 * 2 / 5
    return com, (along, about_joint - mass * com**2)


def masses(n_blocks: int, bodies: Bodies) -> FloatArray:
    """Masses of piece 0, hinge 0, piece 1, ..., hinge n - 1, piece n, (2 n + 1,) in kg."""
    each = np.empty(2 * n_blocks + 1)
    each[0::2], each[1::2] = bodies.capsule_kg, bodies.hinge_kg
    each[[0, -1]] = bodies.end_kg
    return each
