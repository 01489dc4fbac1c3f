"""What is known of a body before it is measured, and after (Section 7, Figure 17)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from .._record import record
from ..grid import FloatArray, IntArray
from .faces import Bonding, bonding_of, direction_of, name_of
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
"""The largest `Strength.residual` that is still a balance."""

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
        The largest force or moment on a voxel that is not balanced, as a share of the weight of
        the body, or of the largest force or moment on a face if that is more.
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
        """The face that gives way first, as "hinge 12–13"; "" if the body tips over."""
        if self.worst < 0:
            return ""
        row = self.table.iloc[self.worst]
        kind, first, second = row["kind"], int(row["first"]), int(row["second"])
        return f"{kind} {first}–{second}" if second >= 0 else f"{kind} under {first}"


def summary(result: Strength) -> dict[str, Any]:
    """What a result comes to, as one row of a table.

    Returns
    -------
    dict
        "model", "voxels", "pitch_mm", "up", "bonding", "support", "mass_kg", "on_table" (voxels
        that bear on the support), "stands", "margin_mm", "safety", "worst"; and the largest
        "tension_pa" and "corner_tension_pa" (mean over a face, and at a corner of one),
        "compression_pa" (mean), "compression_n", "sag_mm" and "residual"; "reason".

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> tower = lu.VoxelPath(np.array([(0, 0, z) for z in range(4)]))
    >>> row = summary(lu.strength(tower))
    >>> row["on_table"], round(row["compression_pa"])
    (1, 443)
    """
    setting, table = result.setting, result.table
    at_support = table["kind"].isin(["table", "held"]) & (table["normal_n"] != 0)
    up = setting.up if isinstance(setting.up, str) else " ".join(f"{u:g}" for u in setting.up)
    return {
        "model": result.name,
        "voxels": len(result.voxels),
        "pitch_mm": setting.pitch_mm,
        "up": up,
        "bonding": name_of(setting.bonding),
        "support": "table" if setting.held is None else f"held at {setting.held}",
        "mass_kg": result.mass_kg,
        "on_table": int(at_support.sum()),
        "stands": result.stands,
        "margin_mm": result.margin_mm,
        "safety": result.safety,
        "worst": result.worst_face,
        "tension_pa": max(float(table["traction_pa"].max()), 0.0),
        "corner_tension_pa": float(table["tension_pa"].max()),
        "compression_pa": max(-float(table["traction_pa"].min()), 0.0),
        "compression_n": max(-float(table["normal_n"].min()), 0.0),
        "sag_mm": result.sag_mm,
        "residual": result.residual,
        "reason": result.reason,
    }


def shortfall(result: Strength) -> str:
    """Why a model does not bear its own weight; "" if it does.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> hook = lu.VoxelPath(np.array([(0, 0, 0), (0, 0, 1), (1, 0, 1), (2, 0, 1)]))
    >>> shortfall(lu.strength(hook))
    'tips over: its centre of mass is 2.5 mm outside of what it rests on'
    """
    if result.stands and result.safety < 1:
        return f"{result.worst_face} gives way, at a safety factor of {result.safety:.3g}"
    fine = result.reason in (STANDS, f"held at {result.setting.held}")
    return "" if fine else result.reason


def rounded(table: pd.DataFrame) -> pd.DataFrame:
    """The table with floats to a millionth of the largest in their column, safety to four digits.

    Examples
    --------
    >>> rounded(pd.DataFrame({"normal_n": [2.0, 1e-12]}))["normal_n"].tolist()
    [2.0, 0.0]
    """
    table = table.copy()
    for name in table.select_dtypes("float"):
        column = table[name].to_numpy(float)
        finite = np.abs(column[np.isfinite(column)])
        if name == "safety":
            table[name] = [float(f"{value:.4g}") for value in column]
        elif finite.max(initial=0.0) > 0:
            table[name] = np.round(column, 6 - int(np.ceil(np.log10(finite.max())))) + 0.0
    return table
