"""Procedural models: closed formulas and stand-ins for the meshes of the paper (Table 2).

Each model is an implicit solid of about two units, facing +x, standing along z. A decocube and a
two-holed torus are formulas in their own right; the animals, the cannon and the furniture stand
in for scanned or modelled meshes where those are not at hand.
"""

from functools import lru_cache

import numpy as np
import pyvista

from .grid import FloatArray
from .implicit import (
    Implicit,
    ball,
    blend,
    box,
    cut,
    cylinder,
    ellipsoid,
    limb,
    mirrored,
    plate,
    torus,
    union,
)
from .meshes import FaceArray

_REACH = 3.2
_LOOK = 48
_ACROSS = 96


def bunny(p: FloatArray) -> FloatArray:
    """A sitting rabbit with its ears up."""
    p = mirrored(p)
    body = ellipsoid(p, (-0.1, 0, 0.62), (0.78, 0.56, 0.6))
    chest = ellipsoid(p, (0.45, 0, 0.6), (0.42, 0.42, 0.5))
    head = ellipsoid(p, (0.72, 0, 1.28), (0.4, 0.33, 0.34))
    nose = ball(p, (1.05, 0, 1.2), 0.14)
    ear = limb(p, [(0.6, 0.16, 1.5), (0.38, 0.24, 1.95), (0.2, 0.28, 2.3)], [0.13, 0.18, 0.11])
    haunch = ellipsoid(p, (-0.3, 0.42, 0.42), (0.45, 0.22, 0.42))
    foot = limb(p, [(-0.25, 0.44, 0.13), (0.25, 0.44, 0.13)], [0.15, 0.15])
    foreleg = limb(p, [(0.6, 0.25, 0.5), (0.72, 0.25, 0.13)], [0.17, 0.14])
    tail = ball(p, (-0.92, 0, 0.45), 0.22)
    return blend(0.08, body, chest, head, nose, ear, haunch, foot, foreleg, tail)


def decocube(p: FloatArray) -> FloatArray:
    """The decocube: tubes along six circles on the faces of a cube, genus 13."""
    x, y, z = (p * p)[..., 0], (p * p)[..., 1], (p * p)[..., 2]
    pairs = [((a + b - 0.64) ** 2 + (c - 1) ** 2) for a, b, c in ((x, y, z), (y, z, x), (z, x, y))]
    value: FloatArray = pairs[0] * pairs[1] * pairs[2] - 0.02
    return value


def cannon(p: FloatArray) -> FloatArray:
    """A field gun: tapered and bored barrel, two wheels, a trail with its spade."""
    axis = np.array([np.cos(0.35), 0, np.sin(0.35)])

    def along(t: float) -> tuple[float, float, float]:
        return (t * axis[0], 0.0, 1.0 + t * axis[2])

    barrel = union(
        cylinder(p, along(-0.8), along(2.1), 0.32, 0.22),
        cylinder(p, along(1.85), along(2.15), 0.31),
        cylinder(p, along(0.5), along(0.72), 0.34),
        cylinder(p, along(-0.9), along(-0.6), 0.38),
        cylinder(p, along(-1.15), along(-0.85), 0.13),
        ball(p, along(-1.2), 0.19),
    )
    bore = cylinder(p, along(1.3), along(2.6), 0.12)
    side = mirrored(p)
    wheel = cylinder(side, (0, 0.56, 0.85), (0, 0.8, 0.85), 0.85)
    hub = cylinder(side, (0, 0.4, 0.85), (0, 0.98, 0.85), 0.19)
    axle = cylinder(p, (0, -0.6, 0.85), (0, 0.6, 0.85), 0.16)
    trail = limb(p, [(0, 0, 0.8), (-2.0, 0, 0.17)], [0.17, 0.17])
    spade = box(p, (-2.05, 0, 0.17), (0.12, 0.36, 0.17))
    return union(cut(barrel, bore), wheel, hub, axle, trail, spade)


def two_holed_torus(p: FloatArray) -> FloatArray:
    """Two tori grown together into a standing figure eight, genus 2."""
    return blend(
        0.15,
        torus(p, (0, 0, 0.95), 0, 1.0, 0.38),
        torus(p, (0, 0, -0.95), 0, 1.0, 0.38),
    )


def duck(p: FloatArray) -> FloatArray:
    """A bath duck."""
    p = mirrored(p)
    body = ellipsoid(p, (0, 0, 0.55), (0.95, 0.66, 0.55))
    tail = limb(p, [(-0.7, 0, 0.75), (-1.05, 0, 1.0)], [0.3, 0.1])
    neck = ellipsoid(p, (0.5, 0, 1.0), (0.38, 0.36, 0.45))
    head = ball(p, (0.55, 0, 1.5), 0.45)
    bill = ellipsoid(p, (1.05, 0, 1.42), (0.33, 0.24, 0.11))
    cheek = ball(p, (0.85, 0, 1.45), 0.16)
    wing = ellipsoid(p, (-0.15, 0.6, 0.7), (0.55, 0.16, 0.3))
    whole = union(blend(0.12, body, tail, neck, head), blend(0.05, bill, cheek), wing)
    return cut(whole, p[..., 2] - 0.06)


def armadillo(p: FloatArray) -> FloatArray:
    """A beast on two legs with a shell on its back, its arms raised."""
    p = mirrored(p)
    torso = ellipsoid(p, (0, 0, 1.55), (0.42, 0.5, 0.6))
    shell = ellipsoid(p, (-0.22, 0, 1.65), (0.48, 0.56, 0.62))
    head = ellipsoid(p, (0.12, 0, 2.35), (0.3, 0.26, 0.28))
    snout = limb(p, [(0.2, 0, 2.3), (0.6, 0, 2.18)], [0.2, 0.1])
    ear = limb(p, [(0, 0.2, 2.5), (-0.08, 0.38, 2.88)], [0.11, 0.08])
    arm = limb(p, [(0, 0.48, 1.85), (0.1, 0.95, 1.75), (0.35, 1.15, 2.2)], [0.2, 0.16, 0.16])
    hand = ball(p, (0.38, 1.17, 2.28), 0.2)
    leg = limb(p, [(0, 0.26, 1.2), (0.12, 0.38, 0.65), (-0.02, 0.4, 0.2)], [0.28, 0.22, 0.17])
    foot = limb(p, [(-0.05, 0.42, 0.13), (0.35, 0.48, 0.1)], [0.15, 0.12])
    tail = limb(p, [(-0.4, 0, 1.15), (-0.8, 0, 0.6), (-1.05, 0, 0.2)], [0.24, 0.17, 0.1])
    return blend(0.07, torso, shell, head, snout, ear, arm, hand, leg, foot, tail)


def dinosaur(p: FloatArray) -> FloatArray:
    """A sauropod with its neck up and its tail out."""
    side = mirrored(p)
    body = ellipsoid(p, (0, 0, 1.05), (0.85, 0.48, 0.52))
    neck = limb(
        p,
        [(0.6, 0, 1.2), (1.15, 0, 1.65), (1.4, 0, 2.3), (1.55, 0, 2.75)],
        [0.34, 0.24, 0.18, 0.16],
    )
    head = ellipsoid(p, (1.75, 0, 2.85), (0.32, 0.17, 0.16))
    tail = limb(
        p,
        [(-0.6, 0, 1.05), (-1.3, 0, 0.75), (-2.0, 0, 0.5), (-2.6, 0, 0.5)],
        [0.36, 0.24, 0.15, 0.1],
    )
    foreleg = limb(side, [(0.5, 0.3, 0.9), (0.54, 0.34, 0)], [0.22, 0.2])
    hindleg = limb(side, [(-0.45, 0.3, 0.9), (-0.45, 0.34, 0)], [0.27, 0.21])
    return cut(union(blend(0.12, body, neck, tail, foreleg, hindleg), head), p[..., 2])


def aircraft(p: FloatArray) -> FloatArray:
    """An airliner with swept wings and an engine under each."""
    side = mirrored(p)
    fuselage = blend(
        0.05,
        limb(p, [(-1.9, 0, 0.12), (-0.9, 0, 0), (1.3, 0, 0)], [0.1, 0.26, 0.26]),
        ellipsoid(p, (1.3, 0, 0), (0.6, 0.26, 0.26)),
    )
    wing = plate(side, [(-0.35, 0), (0.55, 0), (0.05, 1.9), (-0.25, 1.9)], 2, -0.06, 0.07)
    stabilizer = plate(side, [(-1.95, 0), (-1.45, 0), (-1.78, 0.75), (-1.98, 0.75)], 2, 0.15, 0.06)
    fin = plate(p, [(-1.95, 0.1), (-1.35, 0.1), (-1.72, 0.85), (-2.02, 0.85)], 1, 0, 0.06)
    engine = cylinder(side, (0, 0.65, -0.22), (0.55, 0.65, -0.22), 0.15)
    pylon = box(side, (0.2, 0.65, -0.12), (0.18, 0.05, 0.1))
    return union(fuselage, wing, stabilizer, fin, engine, pylon)


def elephant(p: FloatArray) -> FloatArray:
    """An elephant with its ears out and its trunk down."""
    side = mirrored(p)
    body = ellipsoid(p, (-0.15, 0, 1.15), (0.95, 0.6, 0.62))
    head = ellipsoid(p, (0.95, 0, 1.5), (0.42, 0.38, 0.45))
    trunk = limb(
        p,
        [(1.2, 0, 1.4), (1.5, 0, 1.0), (1.58, 0, 0.55), (1.85, 0, 0.24)],
        [0.22, 0.17, 0.14, 0.12],
    )
    foreleg = cylinder(side, (0.48, 0.34, 0), (0.45, 0.33, 1.0), 0.21, 0.25)
    hindleg = cylinder(side, (-0.68, 0.34, 0), (-0.65, 0.33, 1.0), 0.21, 0.26)
    ear = ellipsoid(side, (0.72, 0.48, 1.45), (0.32, 0.14, 0.46))
    tusk = limb(side, [(1.15, 0.26, 1.2), (1.4, 0.42, 0.98), (1.72, 0.46, 1.02)], [0.1, 0.09, 0.08])
    tail = limb(p, [(-1.05, 0, 1.3), (-1.3, 0, 0.95), (-1.32, 0, 0.6)], [0.1, 0.08, 0.08])
    return union(blend(0.1, body, head, trunk, foreleg, hindleg, ear), tusk, tail)


def elk(p: FloatArray) -> FloatArray:
    """A standing elk with branched antlers."""
    side = mirrored(p)
    stem = limb(
        side,
        [(1.0, 0.1, 2.42), (0.82, 0.36, 2.8), (0.72, 0.66, 3.15), (0.95, 0.78, 3.5)],
        [0.09, 0.095, 0.09, 0.085],
    )
    brow_tine = limb(side, [(0.86, 0.3, 2.75), (1.2, 0.4, 3.05)], [0.08, 0.075])
    back_tine = limb(side, [(0.75, 0.52, 3.02), (0.42, 0.62, 3.35)], [0.08, 0.075])
    return union(_deer_without_antlers(p), stem, brow_tine, back_tine)


def _deer_without_antlers(p: FloatArray) -> FloatArray:
    side = mirrored(p)
    chest = ellipsoid(p, (0.1, 0, 1.35), (0.62, 0.32, 0.36))
    rump = ellipsoid(p, (-0.5, 0, 1.35), (0.42, 0.3, 0.34))
    neck = limb(p, [(0.55, 0, 1.5), (0.85, 0, 1.95), (0.98, 0, 2.2)], [0.28, 0.2, 0.17])
    foreleg = limb(
        side, [(0.5, 0.2, 1.25), (0.5, 0.22, 0.7), (0.55, 0.22, 0.06)], [0.17, 0.11, 0.1]
    )
    hindleg = limb(
        side, [(-0.62, 0.2, 1.25), (-0.78, 0.22, 0.72), (-0.68, 0.22, 0.06)], [0.2, 0.11, 0.1]
    )
    skull = ellipsoid(p, (1.1, 0, 2.3), (0.24, 0.16, 0.17))
    muzzle = limb(p, [(1.15, 0, 2.26), (1.5, 0, 2.1)], [0.14, 0.1])
    ear = limb(side, [(0.95, 0.12, 2.38), (0.82, 0.36, 2.45)], [0.08, 0.06])
    tail = limb(p, [(-0.9, 0, 1.5), (-1.05, 0, 1.3)], [0.1, 0.08])
    return union(
        blend(0.09, chest, rump, neck, foreleg, hindleg), blend(0.05, skull, muzzle), ear, tail
    )


def deer(p: FloatArray) -> FloatArray:
    """A deer with two prongs of antler on each side."""
    side = mirrored(p)
    stem = limb(side, [(1.0, 0.1, 2.42), (0.86, 0.3, 2.75), (0.92, 0.42, 3.05)], [0.1, 0.09, 0.08])
    prong = limb(side, [(0.86, 0.28, 2.7), (1.2, 0.3, 2.85)], [0.08, 0.075])
    return union(_deer_without_antlers(p), stem, prong)


def horse(p: FloatArray) -> FloatArray:
    """A standing horse with mane and tail."""
    side = mirrored(p)
    barrel = ellipsoid(p, (0, 0, 1.35), (0.85, 0.36, 0.4))
    rump = ellipsoid(p, (-0.6, 0, 1.42), (0.42, 0.36, 0.4))
    neck = limb(p, [(0.6, 0, 1.5), (1.0, 0, 2.0), (1.2, 0, 2.3)], [0.34, 0.22, 0.18])
    mane = plate(p, [(0.35, 1.75), (0.6, 1.8), (1.12, 2.45), (0.98, 2.5)], 1, 0, 0.08)
    head = limb(p, [(1.2, 0, 2.3), (1.65, 0, 1.95)], [0.2, 0.13])
    ear = limb(side, [(1.12, 0.1, 2.42), (1.1, 0.14, 2.62)], [0.08, 0.06])
    foreleg = limb(
        side, [(0.6, 0.2, 1.2), (0.62, 0.2, 0.65), (0.62, 0.2, 0.08)], [0.21, 0.13, 0.12]
    )
    hindleg = limb(
        side, [(-0.7, 0.2, 1.3), (-0.85, 0.2, 0.7), (-0.78, 0.2, 0.08)], [0.27, 0.14, 0.12]
    )
    tail = limb(p, [(-0.95, 0, 1.6), (-1.3, 0, 1.35), (-1.4, 0, 0.6)], [0.12, 0.15, 0.11])
    return union(blend(0.1, barrel, rump, neck, foreleg, hindleg, tail), head, mane, ear)


def camel(p: FloatArray) -> FloatArray:
    """A camel with two humps."""
    side = mirrored(p)
    barrel = ellipsoid(p, (0, 0, 1.35), (0.9, 0.38, 0.4))
    front_hump = limb(p, [(0.38, 0, 1.5), (0.36, 0, 2.0)], [0.32, 0.14])
    back_hump = limb(p, [(-0.42, 0, 1.5), (-0.46, 0, 2.0)], [0.32, 0.14])
    neck = limb(
        p,
        [(0.75, 0, 1.4), (1.15, 0, 1.25), (1.4, 0, 1.65), (1.45, 0, 2.15)],
        [0.28, 0.2, 0.16, 0.15],
    )
    head = limb(p, [(1.42, 0, 2.22), (1.85, 0, 2.12)], [0.18, 0.12])
    ear = limb(side, [(1.38, 0.12, 2.35), (1.34, 0.18, 2.5)], [0.07, 0.06])
    foreleg = limb(
        side, [(0.62, 0.2, 1.2), (0.64, 0.2, 0.6), (0.64, 0.2, 0.08)], [0.19, 0.12, 0.13]
    )
    hindleg = limb(
        side, [(-0.7, 0.2, 1.25), (-0.82, 0.2, 0.65), (-0.76, 0.2, 0.08)], [0.22, 0.12, 0.13]
    )
    tail = limb(p, [(-0.9, 0, 1.45), (-1.08, 0, 0.95)], [0.09, 0.08])
    trunk = blend(0.1, barrel, neck, foreleg, hindleg)
    return union(blend(0.06, trunk, front_hump, back_hump), head, ear, tail)


def teddy(p: FloatArray) -> FloatArray:
    """A teddy bear sitting with its arms out."""
    p = mirrored(p)
    belly = ellipsoid(p, (0, 0, 0.85), (0.6, 0.66, 0.75))
    head = ellipsoid(p, (0.05, 0, 1.95), (0.52, 0.58, 0.52))
    ear = ellipsoid(p, (0, 0.5, 2.42), (0.13, 0.24, 0.24))
    muzzle = ellipsoid(p, (0.52, 0, 1.82), (0.24, 0.26, 0.2))
    arm = limb(p, [(0.05, 0.5, 1.3), (0.3, 1.05, 1.15)], [0.24, 0.22])
    leg = limb(p, [(0.2, 0.42, 0.3), (1.0, 0.62, 0.27)], [0.3, 0.27])
    foot = ellipsoid(p, (1.12, 0.64, 0.38), (0.18, 0.28, 0.38))
    return union(blend(0.06, belly, head, arm, leg), ear, muzzle, foot)


def chair(p: FloatArray) -> FloatArray:
    """A chair with a rail across its back."""
    side = mirrored(p)
    return union(
        box(p, (0, 0, 1.0), (0.55, 0.55, 0.09)),
        box(side, (0.46, 0.46, 0.5), (0.09, 0.09, 0.5)),
        box(side, (-0.46, 0.46, 1.0), (0.09, 0.09, 1.0)),
        box(p, (-0.46, 0, 1.75), (0.09, 0.55, 0.25)),
        box(p, (-0.46, 0, 1.3), (0.08, 0.5, 0.07)),
    )


def table(p: FloatArray) -> FloatArray:
    """A table: one plate on four legs."""
    corner = p.copy()
    corner[..., :2] = np.abs(corner[..., :2])
    return union(
        box(p, (0, 0, 1.0), (1.2, 0.75, 0.09)), box(corner, (1.05, 0.6, 0.5), (0.11, 0.11, 0.5))
    )


def mug(p: FloatArray) -> FloatArray:
    """A mug with its handle."""
    wall = cut(cylinder(p, (0, 0, 0), (0, 0, 1.6), 0.7), cylinder(p, (0, 0, 0.22), (0, 0, 2), 0.5))
    handle = cut(torus(p, (0.75, 0, 0.8), 1, 0.42, 0.14), cylinder(p, (0, 0, -1), (0, 0, 3), 0.6))
    return union(wall, handle)


MODELS: dict[str, Implicit] = {
    f.__name__: f
    for f in (
        bunny, decocube, cannon, two_holed_torus, duck, armadillo, dinosaur, aircraft, elephant,
        elk, chair, table, mug, teddy, horse, camel, deer,
    )
}  # fmt: skip
"""The procedural models by name."""


@lru_cache(maxsize=len(MODELS))
def triangulated(name: str) -> tuple[FloatArray, FaceArray]:
    """Vertices (V, 3) and outward triangles (F, 3) of a model, by contouring its formula.

    Raises
    ------
    ValueError
        If there is no procedural model of that name.

    Examples
    --------
    >>> vertices, faces = triangulated("mug")
    >>> bool((vertices[faces].min() > -1) & (vertices[faces].max() < 2))
    True
    """
    if name not in MODELS:
        raise ValueError(f"no procedural model {name!r}; there are {', '.join(sorted(MODELS))}")
    solid = MODELS[name]
    low, high = np.full(3, -_REACH), np.full(3, _REACH + 0.6)
    look = (high - low).max() / _LOOK
    seen = np.argwhere(_values(solid, low, high, look) < look / 2)
    low, high = low + (seen.min(axis=0) - 2) * look, low + (seen.max(axis=0) + 2) * look
    step = (high - low).max() / _ACROSS
    values = _values(solid, low, high, step)
    lattice = pyvista.ImageData(dimensions=values.shape, spacing=(step,) * 3, origin=low)
    lattice.point_data["value"] = -values.ravel(order="F")  # larger inside: faces look outwards
    contour = lattice.contour([0.0], scalars="value", method="flying_edges")
    return np.asarray(contour.points, np.float64), np.asarray(contour.regular_faces, np.int64)


def _values(solid: Implicit, low: FloatArray, high: FloatArray, step: float) -> FloatArray:
    axes = [np.arange(a, b + step, step) for a, b in zip(low, high, strict=True)]
    slabs = [np.stack(np.meshgrid([x], *axes[1:], indexing="ij"), axis=-1) for x in axes[0]]
    return np.concatenate([solid(slab) for slab in slabs])
