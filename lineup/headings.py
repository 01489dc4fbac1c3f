"""Directions that may become up: along the axes, at rest on a face, spread over the sphere."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from .grid import DIRECTIONS, FloatArray
from .stress.support import level_axes, tip_margin

AXES: FloatArray = DIRECTIONS[[2, 0, 1, 3, 4, 5]].astype(float)
"""The six axis directions, upright first. For layers, the 24 turns of a grid are these six."""


def resting(vertices: FloatArray, centre: FloatArray) -> FloatArray:
    """Directions that are up when the body rests on a face of its convex hull without tipping.

    Parameters
    ----------
    vertices : (V, 3) float64
    centre : (3,) float64
        The centre of mass; it may be that of the body rather than of the hull.

    Returns
    -------
    (R, 3) float64
        Unit vectors, those first whose faces fill the largest solid angle seen from the centre:
        dropped any way round, without rolling on, the body lands on them most often. Empty where
        the vertices span no volume.

    Examples
    --------
    >>> brick = np.array([(x, y, z) for x in (0, 1) for y in (0, 2) for z in (0, 3)], float)
    >>> resting(brick, brick.mean(axis=0))[:2].tolist()
    [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]
    """
    try:
        hull = ConvexHull(vertices)
    except QhullError:
        return np.empty((0, 3))
    rounded = np.round(hull.equations, 6) + 0.0
    _, face = np.unique(rounded, axis=0, return_inverse=True)
    angle = np.bincount(face, weights=_solid_angles(vertices[hull.simplices] - centre))
    found = []
    for k in range(len(angle)):
        mine = np.flatnonzero(face == k)
        down = hull.equations[mine[0], :3]
        across = level_axes(-down)
        corners = vertices[np.unique(hull.simplices[mine])]
        if tip_margin(corners @ across.T, across @ centre) > 0:
            found.append((round(-float(angle[k]), 6), tuple((np.round(-down, 9) + 0.0).tolist())))
    return np.array([up for _, up in sorted(found)]).reshape(-1, 3)


def _solid_angles(corners: FloatArray) -> FloatArray:
    """Solid angle of each of (n, 3, 3) triangles, seen from the origin (Van Oosterom, Strackee)."""
    a, b, c = corners.transpose(1, 0, 2)
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    volume = np.abs(np.einsum("ij,ij->i", a, np.cross(b, c)))
    dots = [np.einsum("ij,ij->i", *pair) for pair in ((a, b), (a, c), (b, c))]
    angle: FloatArray = 2 * np.arctan2(
        volume, la * lb * lc + dots[0] * lc + dots[1] * lb + dots[2] * la
    )
    return angle


def spread(n: int, rng: np.random.Generator) -> FloatArray:
    """(n, 3) directions spread evenly over the sphere, by the golden angle, turned at random.

    Examples
    --------
    >>> ups = spread(50, np.random.default_rng(0))
    >>> bool((np.linalg.norm(ups, axis=1).round(9) == 1).all())
    True
    """
    height = 1 - (2 * np.arange(n) + 1) / max(n, 1)
    angle = np.arange(n) * np.pi * (3 - np.sqrt(5))
    wide = np.sqrt(1 - height**2)
    points = np.stack([wide * np.cos(angle), wide * np.sin(angle), height], axis=1)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turned: FloatArray = points @ turn
    return turned


def tilted(up: FloatArray, angle_deg: float, rng: np.random.Generator) -> FloatArray:
    """A unit vector `angle_deg` away from `up`, to a random side."""
    side = rng.uniform(0, 2 * np.pi)
    across = np.array([np.cos(side), np.sin(side)]) @ level_axes(up)
    angle = np.deg2rad(angle_deg)
    leaning: FloatArray = np.cos(angle) * up + np.sin(angle) * across
    return leaning / np.linalg.norm(leaning)


def apart_deg(up: FloatArray, others: FloatArray) -> FloatArray:
    """Angles between `up` and (n, 3) directions, in degrees."""
    away = np.linalg.norm(np.cross(others, up), axis=1)
    degrees: FloatArray = np.rad2deg(np.arctan2(away, others @ up))
    return degrees
