"""What faces bear, row by row (Figure 17)."""

from __future__ import annotations

import numpy as np
import pandas as pd

from .._record import record
from ..grid import DIRECTIONS, LETTERS, BoolArray, FloatArray, IntArray
from .contacts import Points
from .faces import HELD, KINDS, PRINTED, TABLE, TOUCH, Faces
from .results import BUCKLING_N, COLUMNS, RESIN_PA, TENSION_PA, Setting

_MODULUS = 1 / 6  # section modulus of a square of side 1, about an axis along a side


@record
class Borne:
    """Forces on faces, in voxel weights and voxels.

    Attributes
    ----------
    kind, first, second : (F,) int32
    normal, middle : (F, 3) float64
        From the first side to the second, and the middle of the face.
    force, moment : (F, 3) float64
        By the second side on the first, the moment about the middle.
    """

    kind: IntArray
    first: IntArray
    second: IntArray
    normal: FloatArray
    middle: FloatArray
    force: FloatArray
    moment: FloatArray

    def __len__(self) -> int:
        return len(self.kind)


def borne_by_faces(voxels: IntArray, faces: Faces, force: FloatArray, moment: FloatArray) -> Borne:
    """What the faces between voxels, and those that are held, bear."""
    middle = voxels[faces.first] + faces.normal / 2
    return Borne(faces.kind, faces.first, faces.second, faces.normal, middle, force, moment)


def borne_by_points(voxels: IntArray, points: Points, pushed: FloatArray) -> Borne:
    """What the faces bear that only push, the pushes at the points of each taken together."""
    pairs, at, of = np.unique(
        np.stack([points.first, points.second], axis=1),
        axis=0,
        return_index=True,
        return_inverse=True,
    )
    arm, force, moment = (np.zeros((len(pairs), 3)) for _ in range(3))
    np.add.at(arm, of, points.arm * points.share[:, None])
    arm /= np.bincount(of, points.share)[:, None]
    by_point = -pushed[:, None] * points.normal
    np.add.at(force, of, by_point)
    np.add.at(moment, of, np.cross(points.arm - arm[of], by_point))
    kind = np.where(pairs[:, 1] < 0, TABLE, TOUCH).astype(np.int32)
    first, second = pairs.T
    return Borne(kind, first, second, points.normal[at], voxels[first] + arm, force, moment)


def together(a: Borne, b: Borne) -> Borne:
    """The rows of both."""
    names = ("kind", "first", "second", "normal", "middle", "force", "moment")
    return Borne(*(np.concatenate([getattr(a, name), getattr(b, name)]) for name in names))


def table_of(borne: Borne, setting: Setting, start: int) -> pd.DataFrame:
    """The columns `COLUMNS`, the joints numbered from `start` on."""
    newton, pascal = setting.newton, setting.pascal
    along = (borne.force * borne.normal).sum(axis=1)
    twist = (borne.moment * borne.normal).sum(axis=1)
    bend = borne.moment - twist[:, None] * borne.normal
    edge = np.abs(bend).sum(axis=1) / _MODULUS
    tension, compression = (edge + along) * pascal, (edge - along) * pascal
    pushing = np.isin(borne.kind, (TOUCH, TABLE))
    tension[pushing] = compression[pushing] = np.nan
    whole: BoolArray = np.abs(borne.normal).max(axis=1) > 1 - 1e-9
    kept = np.where(borne.second >= 0, borne.second + start, -1)
    rows = {
        "kind": [KINDS[k] for k in borne.kind.tolist()],
        "first": borne.first + start,
        "second": kept,
        "direction": _letters(borne.normal, whole),
        **dict(zip("xyz", borne.middle.T, strict=True)),
        "normal_n": along * newton,
        "shear_n": np.linalg.norm(borne.force - along[:, None] * borne.normal, axis=1) * newton,
        "moment_nmm": np.linalg.norm(bend, axis=1) * newton * setting.pitch_mm,
        "torsion_nmm": np.abs(twist) * newton * setting.pitch_mm,
        "traction_pa": np.where(whole, along * pascal, np.nan),
        "tension_pa": tension,
        "compression_pa": compression,
        "safety": _safety(borne.kind, along * newton, tension, compression),
    }
    return pd.DataFrame(rows, columns=COLUMNS)


def _letters(normal: FloatArray, whole: BoolArray) -> list[str]:
    found = (normal @ DIRECTIONS.T).argmax(axis=1)
    return [LETTERS[d] if w else "" for d, w in zip(found.tolist(), whole.tolist(), strict=True)]


def _safety(
    kind: IntArray, normal_n: FloatArray, tension: FloatArray, compression: FloatArray
) -> FloatArray:
    """The least of limit over load; infinite where nothing is borne, nan where it is not known."""
    strong = np.isin(kind, (PRINTED, HELD))
    pushing = np.isin(kind, (TOUCH, TABLE))
    shares = [
        np.where(pushing, 0, tension / np.where(strong, RESIN_PA, TENSION_PA)),
        np.where(pushing, 0, compression / RESIN_PA),
        -normal_n / BUCKLING_N,
    ]
    used = np.maximum(np.max(shares, axis=0), 0)
    safety: FloatArray = np.divide(1.0, used, out=np.full(len(used), np.inf), where=used > 0)
    safety[np.isnan(used)] = np.nan
    return safety
