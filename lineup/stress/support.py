"""Which way is up, and whether a body tips over."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..grid import FloatArray


def upward(up: str | tuple[float, float, float] | FloatArray) -> FloatArray:
    """A unit vector for "+x" ... "-z" or any three numbers that are not all 0."""
    sides = {f"{sign}{'xyz'[k]}": k for sign in "+-" for k in range(3)}
    if isinstance(up, str):
        if up not in sides:
            raise ValueError(f"up must be one of {sorted(sides)} or three numbers, got {up!r}")
        vector = np.zeros(3)
        vector[sides[up]] = 1.0 if up[0] == "+" else -1.0
        return vector
    vector = np.asarray(up, np.float64)
    length = np.linalg.norm(vector)
    if vector.shape != (3,) or not 0 < length < np.inf:
        raise ValueError(f"up must be one of {sorted(sides)} or three numbers, got {up!r}")
    unit: FloatArray = vector / length
    return unit


def level_axes(up: FloatArray) -> FloatArray:
    """(2, 3) unit vectors square to `up` and to each other; with it they are right-handed.

    Examples
    --------
    >>> level_axes(upward("+z")).tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    """
    across = np.eye(3)[int(np.abs(up).argmin())]
    first = across - (across @ up) * up
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(up, first)]) + 0.0  # no -0


def tip_margin(points: FloatArray, centre: FloatArray) -> float:
    """How far `centre` lies inside the convex hull of (m, 2) points; negative outside of it.

    Examples
    --------
    >>> import numpy as np
    >>> square = np.array([(0.0, 0), (4, 0), (4, 4), (0, 4)])
    >>> tip_margin(square, np.array([1.0, 2.0])), tip_margin(square, np.array([7.0, 8.0]))
    (1.0, -5.0)
    """
    corners = _hull(points)
    start = corners
    way = np.roll(corners, -1, axis=0) - start
    length = (way**2).sum(axis=1)
    t = ((centre - start) * way).sum(axis=1) / np.where(length > 0, length, 1.0)
    nearest = start + np.clip(t, 0, 1)[:, None] * way
    apart = float(np.linalg.norm(centre - nearest, axis=1).min())
    left = way[:, 0] * (centre - start)[:, 1] - way[:, 1] * (centre - start)[:, 0]
    return apart if len(corners) > 2 and (left > 0).all() else -apart


def _hull(points: FloatArray) -> FloatArray:
    """Corners of the convex hull, counterclockwise (Andrew's monotone chain)."""
    ordered = np.unique(np.round(points, 9), axis=0)
    if len(ordered) < 3:
        return ordered
    lower, upper = _half(ordered), _half(ordered[::-1])
    return np.array(lower[:-1] + upper[:-1])


def _half(ordered: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    kept: list[NDArray[np.float64]] = []
    for point in ordered:
        while len(kept) > 1:
            a, b = kept[-1] - kept[-2], point - kept[-2]
            if a[0] * b[1] - a[1] * b[0] > 1e-9:
                break
            kept.pop()
        kept.append(point)
    return kept
