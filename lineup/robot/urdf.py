"""The chain in the Unified Robot Description Format, in metres, kilograms and radians.

Its joints have one axis each, so between the bodies of a block there are links without a shape.
They have a share of a body's mass, since some readers take no link without any.
"""

import numpy as np

from ..grid import FloatArray
from .bodies import BAR, Bodies
from .tree import Body, Placed, base_body, number, outward, row

SLIVER = 1e-6
"""Mass of a link without a shape, as a share of a hinge's."""

UNIT = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}


def urdf(
    placed: Placed, bodies: Bodies, limit_deg: float, effort_nm: float, speed_deg: float
) -> str:
    """The text of the file; the base is clamped to the link ``world``, with z up.

    Joints have one limit of torque, and one of speed, in degrees a second. Angles are 0 where the
    chain is straight: the format has no poses.
    """
    limits = (np.radians(limit_deg), effort_nm, np.radians(speed_deg))
    base = base_body(placed.n_blocks, placed.base)
    turn = row(_roll_pitch_yaw(placed.frame))
    where = f'xyz="{row(bodies.pitch_m * placed.origin)}" rpy="{turn}"'
    parts = [
        '<?xml version="1.0"?>',
        f'<robot name="{placed.name}">',
        '<link name="world"/>',
        f'<joint name="clamp" type="fixed"><parent link="world"/><child link="{base.name}"/>'
        f"<origin {where}/></joint>",
        _link(base.name, _solid(base, bodies)),
    ]
    for side in outward(placed.n_blocks, placed.base):
        parent = base.name
        for body in side:
            parts += _limb(parent, body, bodies, limits)
            parent = body.name
    return "\n".join([*parts, "</robot>", ""])


def _roll_pitch_yaw(frame: FloatArray) -> tuple[float, float, float]:
    """Angles about the fixed axes x, y and z, in this order."""
    pitch = float(np.arctan2(-frame[2, 0], np.hypot(frame[0, 0], frame[1, 0])))
    if abs(np.cos(pitch)) < 1e-9:  # roll and yaw do the same
        return 0.0, pitch, float(np.arctan2(-frame[0, 1], frame[1, 1]))
    roll, yaw = np.arctan2(frame[2, 1], frame[2, 2]), np.arctan2(frame[1, 0], frame[0, 0])
    return float(roll), pitch, float(yaw)


def _limb(parent: str, body: Body, bodies: Bodies, limits: tuple[float, float, float]) -> list[str]:
    """The joints of a body from its parent on, and the links after them."""
    parts, at = [], body.at * bodies.pitch_m
    sliver = _inertial(SLIVER * bodies.hinge_kg, 0.0, *(SLIVER * x for x in bodies.hinge_kgm2))
    for joint in body.joints:
        last = joint == body.joints[-1]
        link = body.name if last else f"{body.name}_{joint.letter}"
        axis = row(joint.sign * x for x in UNIT[joint.letter])
        kind, reach = ("continuous", "") if joint.letter == "x" else ("revolute", _reach(limits[0]))
        parts += [
            f'<joint name="{joint.name}" type="{kind}"><parent link="{parent}"/>'
            f'<child link="{link}"/><origin xyz="{number(at)} 0 0"/><axis xyz="{axis}"/>'
            f'<limit {reach}effort="{number(limits[1])}" velocity="{number(limits[2])}"/></joint>',
            _link(link, _solid(body, bodies) if last else sliver),
        ]
        parent, at = link, 0.0
    return parts


def _reach(limit: float) -> str:
    return f'lower="{number(-limit)}" upper="{number(limit)}" '


def _link(name: str, inside: str) -> str:
    return f'<link name="{name}">{inside}</link>'


def _solid(body: Body, bodies: Bodies) -> str:
    """Mass and shape of a body; only pieces take part in collisions."""
    mass, com, moments = bodies.inertial(body.kind)
    a, r, side = bodies.pitch_m, bodies.radius_m, body.side
    inertial = _inertial(mass, side * com, *moments)
    if body.kind == "hinge":
        return inertial + _shape("visual", _tube(side * a / 2, a, BAR * a / 2))
    length = a if body.kind == "capsule" else a / 2
    shapes = [_tube(side * length / 2, length, r), _ball(0.0, r)]
    shapes += [_ball(side * a, r)] if body.kind == "capsule" else []
    return inertial + "".join(_shape(use, s) for s in shapes for use in ("visual", "collision"))


def _inertial(mass: float, x: float, along: float, across: float) -> str:
    return (
        f'<inertial><origin xyz="{number(x)} 0 0"/><mass value="{number(mass)}"/>'
        f'<inertia ixx="{number(along)}" iyy="{number(across)}" izz="{number(across)}" '
        'ixy="0" ixz="0" iyz="0"/></inertial>'
    )


def _shape(use: str, shape: str) -> str:
    return f"<{use}>{shape}</{use}>"


def _tube(x: float, length: float, radius: float) -> str:
    """A cylinder along x."""
    return (
        f'<origin xyz="{number(x)} 0 0" rpy="0 1.57079633 0"/><geometry>'
        f'<cylinder length="{number(abs(length))}" radius="{number(radius)}"/></geometry>'
    )


def _ball(x: float, radius: float) -> str:
    return (
        f'<origin xyz="{number(x)} 0 0"/><geometry><sphere radius="{number(radius)}"/></geometry>'
    )
