"""Implicit solids: functions of points (..., 3) that are negative inside, zero on the surface.

Values are distances or close to them near the surface, so that `blend` rounds joints evenly.
"""

from collections.abc import Callable, Sequence

import numpy as np

from .grid import FloatArray

Implicit = Callable[[FloatArray], FloatArray]
Point = tuple[float, float, float]


def ball(p: FloatArray, centre: Point, radius: float) -> FloatArray:
    """A ball."""
    return _length(p - centre) - radius


def ellipsoid(p: FloatArray, centre: Point, radii: Point) -> FloatArray:
    """An ellipsoid along the axes; exact to first order at the surface."""
    scaled = (p - centre) / np.array(radii)
    k = _length(scaled)
    return k * (k - 1) / np.maximum(_length(scaled / np.array(radii)), 1e-9)


def box(p: FloatArray, centre: Point, half: Point) -> FloatArray:
    """A box along the axes, given by its half edge lengths."""
    q = np.abs(p - centre) - np.array(half)
    deepest: FloatArray = np.maximum(np.maximum(q[..., 0], q[..., 1]), q[..., 2])
    distance: FloatArray = _length(np.maximum(q, 0)) + np.minimum(deepest, 0)
    return distance


def torus(p: FloatArray, centre: Point, axis: int, ring: float, tube: float) -> FloatArray:
    """A torus around a coordinate axis, with the radii of its ring and of its tube."""
    q = p - centre
    across = _length(np.delete(q, axis, axis=-1))
    return np.hypot(across - ring, q[..., axis]) - tube


def limb(p: FloatArray, points: Sequence[Point], radii: Sequence[float]) -> FloatArray:
    """A round tube through `points`, its radius going from one of `radii` to the next."""
    pieces = []
    for a, b, r_a, r_b in zip(points, points[1:], radii, radii[1:], strict=False):
        start, along = np.array(a), np.subtract(b, a)
        t = np.clip(((p - start) @ along) / (along @ along), 0, 1)
        pieces.append(_length(p - start - t[..., None] * along) - (r_a + (r_b - r_a) * t))
    return blend(0.05, *pieces) if len(pieces) > 1 else pieces[0]


def cylinder(p: FloatArray, a: Point, b: Point, r_a: float, r_b: float | None = None) -> FloatArray:
    """A cylinder, or a frustum where `r_b` differs, with flat ends at `a` and `b`."""
    length = float(np.linalg.norm(np.subtract(b, a)))
    along = np.subtract(b, a) / length
    t = (p - a) @ along
    across = _length(p - a - t[..., None] * along)
    radius = r_a + ((r_a if r_b is None else r_b) - r_a) * np.clip(t / length, 0, 1)
    return np.maximum(np.abs(t - length / 2) - length / 2, across - radius)


def plate(
    p: FloatArray, corners: Sequence[tuple[float, float]], axis: int, at: float, half: float
) -> FloatArray:
    """A convex polygon thickened by `half` to both sides of ``p[axis] == at``.

    Its corners, in the order of the other two axes, go round counterclockwise.
    """
    flat = np.delete(p, axis, axis=-1)
    outside = np.abs(p[..., axis] - at) - half
    for a, b in zip(corners, (*corners[1:], corners[0]), strict=True):
        edge = np.subtract(b, a)
        normal = np.array([edge[1], -edge[0]]) / np.linalg.norm(edge)
        outside = np.maximum(outside, (flat - a) @ normal)
    return outside


def union(*solids: FloatArray) -> FloatArray:
    """Inside any of the solids."""
    result: FloatArray = np.minimum.reduce(solids)
    return result


def cut(solid: FloatArray, *tools: FloatArray) -> FloatArray:
    """Inside the first solid and in none of the others."""
    result: FloatArray = np.maximum.reduce([solid, *(-tool for tool in tools)])
    return result


def blend(width: float, *solids: FloatArray) -> FloatArray:
    """A union whose concave joints are filled smoothly over about `width`."""
    result = solids[0]
    for solid in solids[1:]:
        h = np.clip(0.5 + 0.5 * (solid - result) / width, 0, 1)
        result = solid + (result - solid) * h - width * h * (1 - h)
    return result


def mirrored(p: FloatArray) -> FloatArray:
    """Points folded to y >= 0: what is built there once appears on both sides."""
    folded = p.copy()
    folded[..., 1] = np.abs(folded[..., 1])
    return folded


def _length(vectors: FloatArray) -> FloatArray:
    length: FloatArray = np.sqrt(np.einsum("...i,...i->...", vectors, vectors))
    return length
