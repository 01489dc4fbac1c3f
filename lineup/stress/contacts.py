"""Where bodies only push each other: points on a level table and between strands."""

from __future__ import annotations

import numpy as np

from .._record import record
from ..grid import FloatArray, IntArray
from .faces import AT_SUPPORT, Faces

_LEVEL = 1e-9  # an axis along which heights differ by less is level
_SIMPSON = ((-0.5, 1 / 6), (0.0, 4 / 6), (0.5, 1 / 6))
"""Points along a side of a face and their shares of it: with them a pressure that changes evenly
over the face has the right sum and moment, and they reach its corners."""


@record
class Points:
    """Points at which two sides may push each other, smoothly, and no more than push.

    Attributes
    ----------
    first, second : (m,) int32
        The voxels on the two sides, `second` -1 for the table.
    normal : (m, 3) float64
        Unit vectors from the first to the second.
    arm : (m, 3) float64
        From the centre of the first to the point.
    share : (m,) float64
        Of the stiffness of a face of solid resin.
    """

    first: IntArray
    second: IntArray
    normal: FloatArray
    arm: FloatArray
    share: FloatArray

    def __len__(self) -> int:
        return len(self.first)

    @property
    def far_arm(self) -> FloatArray:
        """(m, 3) from the centre of the second, which is one pitch away, to the point."""
        return self.arm - self.normal


def no_points() -> Points:
    """Nothing touches."""
    none, nowhere = np.empty(0, np.int32), np.empty((0, 3))
    return Points(none, none, nowhere, nowhere, np.empty(0))


def all_points(*parts: Points) -> Points:
    """Several sets of points as one, in the order given."""
    names = ("first", "second", "normal", "arm", "share")
    return Points(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def table_points(voxels: IntArray, up: FloatArray) -> Points:
    """Where a level table touches a body: its lowest faces, edges or corners.

    A face has nine points, by Simpson's rule along both its sides; where `up` is no axis, the
    lowest edge of a voxel has three and a lowest corner is one.
    """
    height = voxels @ up - np.abs(up).sum() / 2
    lowest = np.flatnonzero(height <= height.min() + _LEVEL * max(1.0, float(np.ptp(height))))
    sides = [_SIMPSON if abs(u) < _LEVEL else ((-0.5 * float(np.sign(u)), 1.0),) for u in up]
    arms = np.array([(x, y, z) for x, _ in sides[0] for y, _ in sides[1] for z, _ in sides[2]])
    weight = np.array([a * b * c for _, a in sides[0] for _, b in sides[1] for _, c in sides[2]])
    m = len(lowest) * len(arms)
    return Points(
        first=np.repeat(lowest, len(arms)).astype(np.int32),
        second=np.full(m, -1, np.int32),
        normal=np.tile(-up, (m, 1)),
        arm=np.tile(arms, (len(lowest), 1)),
        share=np.tile(AT_SUPPORT * weight, len(lowest)),
    )


def touch_points(faces: Faces) -> Points:
    """Nine points of each face, by Simpson's rule along both its sides."""
    across = [np.roll(faces.normal, k, axis=1) for k in (1, 2)]
    grid = [(a, b, v * w) for a, v in _SIMPSON for b, w in _SIMPSON]
    arms = [faces.normal / 2 + a * across[0] + b * across[1] for a, b, _ in grid]
    return Points(
        first=np.tile(faces.first, len(grid)),
        second=np.tile(faces.second, len(grid)),
        normal=np.tile(faces.normal, (len(grid), 1)),
        arm=np.concatenate(arms),
        share=np.concatenate([weight * faces.share for _, _, weight in grid]),
    )
