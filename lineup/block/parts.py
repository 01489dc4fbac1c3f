"""The parts of a block as closed solids, by constructive geometry, and as triangles.

In the frame of a part x is its axis, and the slots lie in the planes y = 0 and z = 0. A hinge has
its balls at x = 0 and x = pitch. A capsule between two hinges, "middle", has its sockets there,
and they open outwards; an "end" is one voxel, its socket at 0, open towards +x. Where a chain is
printed in pieces, a middle is in two halves that slide into one another along y: "tongue" with the
socket at 0, "groove" with that at the pitch. Where capsules swivel, it is "sleeve" and "pin".
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache, reduce
from operator import add
from types import MappingProxyType
from typing import Any

import numpy as np
from manifold3d import CrossSection, Manifold, Mesh
from numpy.typing import NDArray

from .._record import record
from ..grid import FloatArray, IntArray
from .parameters import WALL_MM, Block, socket_depth_mm, swivel

_AROUND = 1.3  # how far cutters reach beyond the surface, relative to it
_SLOT_STEPS = 6
NECK = np.pi / 4
"""Where slots are narrowest, from the pole: half way between two lattice states of a joint."""
_JOIN_HALF_WIDTH = 0.25  # of the tongue's top, relative to the capsule's diameter
_JOIN_SLOPE = np.tan(np.deg2rad(30))
_FACE_MM = 0.1  # between the faces of tongue and groove


@record
class Part:
    """A part as a closed triangle mesh.

    Attributes
    ----------
    vertices : (V, 3) float64
        In mm, in the frame of the part.
    faces : (F, 3) int32
        Counterclockwise from outside.
    volume_mm3 : float
    """

    vertices: FloatArray
    faces: IntArray
    volume_mm3: float


def block_parts(block: Block) -> dict[str, Part]:
    """Every part of a block as triangles: hinge, middle and end, and the halves of a middle.

    Returns
    -------
    dict of str to Part
        "hinge" and "end", and "middle", or "sleeve" and "pin" if the block swivels; "tongue" and
        "groove" where a middle has room for them and does not swivel.

    Examples
    --------
    >>> parts = block_parts(Block())
    >>> sorted(parts), round(parts["hinge"].volume_mm3)
    (['end', 'groove', 'hinge', 'middle', 'tongue'], 157)
    """
    return {name: part_of(solid) for name, solid in solids(block).items()}


def part_of(solid: Any) -> Part:
    """The triangles of a solid of manifold3d, in an order that depends on nothing but them."""
    mesh = solid.to_mesh64()
    vertices = np.asarray(mesh.vert_properties, np.float64)[:, :3]
    order = np.lexsort(vertices.T[::-1])
    faces = np.argsort(order)[np.asarray(mesh.tri_verts).astype(np.int64)]
    first = faces.argmin(axis=1)[:, None]
    faces = np.take_along_axis(faces, (first + np.arange(3)) % 3, axis=1)
    faces = faces[np.lexsort(faces.T[::-1])]
    return Part(vertices[order], faces.astype(np.int32), float(solid.volume()))


@lru_cache(maxsize=32)
def solids(block: Block) -> Mapping[str, Any]:
    """The parts that `block_parts` names, as solids of manifold3d."""
    a = block.pitch_mm
    last = _socket(block).translate([a, 0, 0])
    first = _socket(block).rotate([0, 0, 180])
    body = _capsule(block, -block.radius_mm, a + block.radius_mm)
    parts = {
        "hinge": _hinge(block),
        "end": _end_body(block) - _socket(block),
    }
    if block.swivel:
        sleeve, pin = _swivel_halves(block, body)
        return MappingProxyType(parts | {"sleeve": sleeve - first, "pin": pin - last})
    parts["middle"] = body - first - last
    if join_height_mm(block) >= WALL_MM:
        tongue, groove = _joined_halves(block, body)
        parts |= {"tongue": tongue - first, "groove": groove - last}
    return MappingProxyType(parts)


def _revolved(profile: FloatArray, segments: int) -> Any:
    """The solid of a counterclockwise profile of points (radius, x), turned about the x axis."""
    return CrossSection([profile]).revolve(segments).rotate([0, 90, 0])


def _arc(
    radius: float, segments: int, start_deg: float, stop_deg: float, centre: float = 0.0
) -> FloatArray:
    """Points (radius, x) on a meridian; degrees from the equator towards +x."""
    steps = round(segments * abs(stop_deg - start_deg) / 360)
    angle = np.deg2rad(np.linspace(start_deg, stop_deg, steps + 1))
    return np.stack([radius * np.cos(angle), centre + radius * np.sin(angle)], axis=1)


def _capsule(block: Block, start: float, stop: float) -> Any:
    """From x = start to stop, round at both ends."""
    r, n = block.radius_mm, block.segments
    below, above = _arc(r, n, -90, 0, start + r), _arc(r, n, 0, 90, stop - r)
    return _revolved(np.concatenate([below, above]), n)


def _end_body(block: Block) -> Any:
    r, n = block.radius_mm, block.segments
    return _revolved(np.concatenate([[(0, -r), (r, -r)], _arc(r, n, 0, 90)]), n)


def _hinge(block: Block) -> Any:
    ball, bar, n = block.ball_mm / 2, block.bar_mm / 2, block.segments
    shoulder = np.rad2deg(np.arccos(bar / ball))
    below = _arc(ball, n, -90, shoulder)
    above = _arc(ball, n, -shoulder, 90, block.pitch_mm)
    return _revolved(np.concatenate([below, above]), n)


def _socket(block: Block) -> Any:
    """What is taken away round a socket at 0 that opens towards +x: cavity, slots and their ends.

    Round cutters are drawn about their circles and not inside them, so that clearances are kept.
    """
    around = 1 / np.cos(np.pi / block.segments)
    reach = _AROUND * block.radius_mm / np.sin(np.deg2rad(block.bend_deg))
    hole = Manifold.cylinder(reach, around * block.hole_mm / 2, circular_segments=block.segments)
    cavity = _about_ball(block.cavity_mm / 2, block.segments)
    hole = hole.rotate([0, 90, 0])
    ends = [hole.rotate([0, 0, deg]) for deg in sorted({90.0, block.bend_deg})]
    slot = reduce(add, ends, _slot(block, reach))
    slots = [slot.rotate([90 * k, 0, 0]) for k in range(4)]
    return reduce(add, slots, cavity + hole)


def _about_ball(radius: float, segments: int) -> Any:
    """A polyhedron that a ball just fits into."""
    sphere = part_of(Manifold.sphere(1.0, segments))
    a, b, c = (sphere.vertices[sphere.faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    inner = ((normal * a).sum(axis=1) / np.linalg.norm(normal, axis=1)).min()
    return Manifold.sphere(radius / inner, segments)


def slot_half_width_mm(block: Block, polar: NDArray[Any]) -> FloatArray:
    """Half the width of a slot at angles from the pole, in radians (Figure 16).

    Each side is an arc of a circle on the outer sphere: it meets the holes in which a bar rests, at
    the pole and at a right angle to it, and comes nearest to the other side half way between, at
    the neck. Beyond a right angle a slot is as wide as at its ends.
    """
    end, neck = block.hole_mm / 2, block.neck_mm / 2
    sag = end - neck
    along = (np.asarray(polar, float) - NECK) * block.radius_mm
    if sag < 1e-9:
        return np.full(along.shape, end)
    chord = NECK * block.radius_mm
    radius = (chord**2 + sag**2) / (2 * sag)
    along = np.minimum(along, chord)
    half: FloatArray = neck + radius - np.sqrt(radius**2 - along**2)
    return half


def _slot(block: Block, reach: float) -> Any:
    """A slot from the pole, +x, towards +y, as far as bends go."""
    polar = np.linspace(0, 2 * NECK, _SLOT_STEPS + 1)
    bend = np.deg2rad(block.bend_deg)
    if bend > 2 * NECK:
        polar = np.append(polar, np.linspace(2 * NECK, bend, _SLOT_STEPS // 2)[1:])
    half = slot_half_width_mm(block, polar)
    inner = block.ball_mm / 4
    corners = [(inner, -1), (reach, -1), (reach, 1), (inner, 1)]
    vertices = [
        (r * np.cos(t), r * np.sin(t), side * h)
        for t, h in zip(polar, half, strict=True)
        for r, side in corners
    ]
    faces = [(0, 2, 1), (0, 3, 2)]
    last = 4 * (len(polar) - 1)
    for a in range(0, last, 4):
        for k in range(4):
            near, far = (a + k, a + (k + 1) % 4), (a + 4 + k, a + 4 + (k + 1) % 4)
            faces += [(near[0], far[1], far[0]), (near[0], near[1], far[1])]
    faces += [(last, last + 1, last + 2), (last, last + 2, last + 3)]
    mesh = Mesh(np.array(vertices, np.float32), np.array(faces, np.uint32)[:, ::-1].copy())
    return Manifold(mesh)


def join_height_mm(block: Block) -> float:
    """Height of the tongue that joins two halves of a middle, as far as there is room for one."""
    room = block.pitch_mm / 2 - socket_depth_mm(block, block.radius_mm / 2)
    return min(room - WALL_MM - join_clearance_mm(block), 0.15 * block.pitch_mm)


def join_clearance_mm(block: Block) -> float:
    """Between tongue and groove, which slide once and are then glued."""
    return min(block.clearance_mm / 2, 0.15)


def _joined_halves(block: Block, body: Any) -> tuple[Any, Any]:
    """A capsule in two halves, the first with a dovetail along y that fits into the second."""
    face = block.pitch_mm / 2
    dovetail = _dovetail(block, 0.0) ^ body
    before = body.trim_by_plane([-1, 0, 0], -(face - _FACE_MM / 2))
    after = body.trim_by_plane([1, 0, 0], face + _FACE_MM / 2)
    return before + dovetail, after - _dovetail(block, join_clearance_mm(block))


def _dovetail(block: Block, clearance: float) -> Any:
    """A rail along y, wider at its top than at the face x = pitch / 2 it stands on."""
    face, height = block.pitch_mm / 2, join_height_mm(block)
    top = 2 * _JOIN_HALF_WIDTH * block.radius_mm
    foot = face - 2 * _FACE_MM
    # Along the flanks the clearance is square to them.
    wider = clearance * np.hypot(1, _JOIN_SLOPE) if clearance else 0.0
    at_top = top + wider + clearance * _JOIN_SLOPE
    at_foot = at_top - _JOIN_SLOPE * (face + height + clearance - foot)
    stop = face + height + clearance
    section = [(foot, -at_foot), (stop, -at_top), (stop, at_top), (foot, at_foot)]
    length = 4 * block.radius_mm
    rail = CrossSection([np.array(section)]).extrude(length)  # along z, the section in x and y
    return rail.translate([0, 0, -length / 2]).rotate([90, 0, 0])


def _swivel_halves(block: Block, body: Any) -> tuple[Any, Any]:
    """A capsule in a sleeve with the first socket and a pin with the last."""
    s, c, n = swivel(block), block.clearance_mm, block.segments
    around = 1 / np.cos(np.pi / n)

    def drum(start: float, stop: float, radius: float) -> Any:
        rod = Manifold.cylinder(stop - start, radius, circular_segments=n)
        return rod.rotate([0, 90, 0]).translate([start, 0, 0])

    head = drum(s.chamber + c, s.lip - c, s.head_radius)
    neck = drum(s.lip - 2 * c, s.pin_face + c, s.neck_radius)
    chamber = drum(s.chamber, s.lip, around * (s.head_radius + c))
    way = drum(s.lip - c, s.face + c, around * (s.neck_radius + c))
    sleeve = body.trim_by_plane([-1, 0, 0], -s.face) - chamber - way
    pin = body.trim_by_plane([1, 0, 0], s.pin_face) + head + neck
    return sleeve, pin
