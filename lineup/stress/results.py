"""What is known of a body before it is measured, and after (Section 7, Figure 17)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from .._record import record
from ..grid import FloatArray, IntArray
from .faces import Bonding, bonding_of, direction_of
from .support import upward

DENSITY = 1130.0
"""Of a block, in kg / m^3, as if it filled its two voxels: an assumption. The paper gives none;
liquid resins for stereolithography, such as its UV9400, have about this density."""

YOUNG_PA = 2.6e9
"""Young's modulus of cured resin, an assumption, in the range that makers of such resins give.
Only the sag depends on it: forces depend on ratios of stiffness alone."""

GRAVITY = 9.81

TENSION_PA = 206.7e3
"""What velcro and thermosol bear, as the paper measured on two blocks (Section 7)."""

BUCKLING_N = 2042.0
"""The compressive force at which a hinge of the paper's block gives way (Section 7)."""

RESIN_PA = 38e6
"""The least compressive strength of the paper's resin; taken for its tensile strength, too."""

UNBALANCED = 1e-6
"""The force or moment left over on a voxel, in weights of the body, that is still a balance."""

STANDS = "stands"

COLUMNS = [
    *("kind", "first", "second", "direction", "x", "y", "z", "normal_n", "shear_n", "moment_nmm"),
    *("torsion_nmm", "traction_pa", "tension_pa", "compression_pa", "safety"),
]
"""Columns of `Strength.table`."""


@dataclass(frozen=True)
class Setting:
    """What a body is made of and how it stands; see `strength`.

    Raises
    ------
    ValueError
        If a length, density or modulus is not positive, or a direction or bonding not known.
    """

    pitch_mm: float = 10.0
    density: float = DENSITY
    bonding: Bonding | str = "velcro"
    up: str | tuple[float, float, float] = "+z"
    held: str | None = None
    young_pa: float = YOUNG_PA

    def __post_init__(self) -> None:
        for name in ("pitch_mm", "density", "young_pa"):
            value = getattr(self, name)
            if not 0 < value < np.inf:
                raise ValueError(f"{name} must be positive, got {value}")
        bonding_of(self.bonding)
        upward(self.up)
        if self.held is not None:
            direction_of(self.held)

    @property
    def pascal(self) -> float:
        """The weight of a voxel over the area of a face."""
        return self.density * GRAVITY * self.pitch_mm / 1e3

    @property
    def newton(self) -> float:
        """The weight of a voxel."""
        return self.pascal * (self.pitch_mm / 1e3) ** 2


@record
class Strength:
    """What the faces of a folded chain bear under its own weight.

    Attributes
    ----------
    name : str
    setting : Setting
    voxels : (n, 3) int32
        The body, in the order of the path.
    table : DataFrame
        A row for each face that bears load and each voxel at the support, columns `COLUMNS`:

        - ``kind``: "printed", "hinge", "velcro", "touch", "table" or "held";
        - ``first``, ``second``: joints of the chain on its two sides, -1 for the support;
        - ``direction``: letter from the first to the second, "" at an edge or a corner;
        - ``x``, ``y``, ``z``: its middle, in voxels;
        - ``normal_n``: force across it, tension positive; ``shear_n``: force along it;
        - ``moment_nmm``: what bends it; ``torsion_nmm``: what twists it;
        - ``traction_pa``: normal force over area; ``tension_pa``, ``compression_pa``: the most at
          a corner of the face, traction and bending together; nan at the table and where strands
          only touch, which may let go of a part of the face;
        - ``safety``: the factor by which all may grow until the face gives way.
    force_n, torque_nmm : (F, 3) float64
        Force, and moment about the middle of the face, by the second side on the first.
    stands : bool
        Whether there is a balance. If not, forces are nan.
    reason : str
        "stands", "held at" a side, by how much it tips over, or by how much it sags if that is
        more than a pitch: then the model, which is one of small shifts, tells no more than that.
    margin_mm : float
        How far the centre of mass is inside of what the body rests on, seen from above; negative
        if outside, infinite if the body is held.
    centre : (3,) float64
        The centre of mass, in voxels.
    safety : float
        The least of the table; 0 if the body tips over.
    worst : int
        The row that has it; -1 if the body tips over.
    sag_mm : float
        The largest shift of a voxel.
    residual : float
        The largest force or moment on a voxel that is not balanced, in weights of the body.
    """

    name: str
    setting: Setting
    voxels: IntArray
    table: pd.DataFrame
    force_n: FloatArray
    torque_nmm: FloatArray
    stands: bool
    reason: str
    margin_mm: float
    centre: FloatArray
    safety: float
    worst: int
    sag_mm: float
    residual: float

    @property
    def mass_kg(self) -> float:
        """Of all voxels."""
        return len(self.voxels) * self.setting.newton / GRAVITY

    @property
    def worst_face(self) -> str:
        """The face that gives way first, as "hinge 12-13"; "" if the body tips over."""
        if self.worst < 0:
            return ""
        kind, first, second = self.table.loc[self.worst, ["kind", "first", "second"]]
        return f"{kind} {first}-{second}" if second >= 0 else f"{kind} under {first}"
