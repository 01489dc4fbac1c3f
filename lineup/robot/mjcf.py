"""The chain in MuJoCo's format, in metres, kilograms and radians.

MuJoCo reads XML that is nested less than 500 deep, so a long chain takes more than one file, each
attached to the one before.
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from .bodies import BAR, Bodies
from .tree import Body, Placed, base_body, number, outward, row

NESTED = 400
"""Bodies inside one another in one file."""


def mjcf(placed: Placed, bodies: Bodies, limit_deg: float, gravity: float) -> dict[str, str]:
    """Texts by file name: NAME.xml, and the parts that it takes in.

    The base is clamped where it is in the pose, with axis 2 up; the pose is the key ``folded``.
    """
    files: dict[str, str] = {}
    head = _head(bodies, limit_deg)
    sides = outward(placed.n_blocks, placed.base)
    within = [
        _nested(f"{placed.name}-{word}", side, bodies, head, files)
        for word, side in zip(("ahead", "behind"), sides, strict=True)
    ]
    x, y, z, w = Rotation.from_matrix(placed.frame).as_quat()
    where = f'pos="{row(bodies.pitch_m * placed.origin)}" quat="{row((w, x, y, z))}"'
    base = _opened(base_body(placed.n_blocks, placed.base), bodies, where)
    pairs = (f'piece{i}" body2="piece{i + 1}' for i in range(placed.n_blocks))
    world = base + "".join(side.text for side in within) + "</body>"
    order = [joint for side in sides for body in side for joint in body.joints]
    folded = np.radians([placed.angles_deg[joint.block, joint.axis] for joint in order])
    rest = [
        f'<option gravity="0 0 {-gravity:g}"/>',
        "<contact>",
        *(f'<exclude body1="{pair}"/>' for pair in pairs),
        "</contact>",
        f'<keyframe><key name="folded" qpos="{row(folded)}"/></keyframe>',
    ]
    asset = "".join(side.asset for side in within)
    files[f"{placed.name}.xml"] = _document(placed.name, head, asset, world, *rest)
    return files


class _Side(NamedTuple):
    text: str
    asset: str


def _nested(
    name: str, side: list[Body], bodies: Bodies, head: str, files: dict[str, str], part: int = 1
) -> _Side:
    """Bodies inside one another; those too deep go to a file of their own, which is attached."""
    here, beyond = side[:NESTED], side[NESTED:]
    inner = asset = ""
    if beyond:
        model = f"{name}-{part}"
        deeper = _nested(name, beyond, bodies, head, files, part + 1)
        files[f"{model}.xml"] = _document(model, head, deeper.asset, deeper.text)
        inner = f'<attach model="{model}" body="{beyond[0].name}" prefix=""/>\n'
        asset = f'<model name="{model}" file="{model}.xml"/>'
    a = bodies.pitch_m
    opened = (_opened(body, bodies, f'pos="{number(body.at * a)} 0 0"') for body in here)
    return _Side("".join(opened) + inner + "</body>" * len(here) + "\n", asset)


def _document(name: str, head: str, asset: str, world: str, *rest: str) -> str:
    assets = [f"<asset>{asset}</asset>"] if asset else []
    body = f"<worldbody>\n{world}</worldbody>"
    return "\n".join([f'<mujoco model="{name}">', head, *assets, body, *rest, "</mujoco>", ""])


def _head(bodies: Bodies, limit_deg: float) -> str:
    """Units, and what bodies of a kind share; joints towards -x have their axes reversed."""
    limit, bar = number(np.radians(limit_deg)), number(BAR * bodies.pitch_m / 2)
    lines = [
        '<compiler angle="radian"/>',
        "<default>",
        f'<geom type="capsule" size="{number(bodies.radius_m)}" rgba=".3 .5 .8 1"/>',
        f'<default class="bar"><geom size="{bar}" contype="0" conaffinity="0" rgba=".8 .6 .2 1"/>'
        "</default>",
    ]
    for letter, axis in (("x", (1, 0, 0)), ("y", (0, 1, 0)), ("z", (0, 0, 1))):
        limits = "" if letter == "x" else f' range="-{limit} {limit}"'
        for side, sign in (("ahead", 1), ("behind", -1)):
            direction = row(sign * np.array(axis))
            lines.append(
                f'<default class="{letter}-{side}"><joint axis="{direction}"{limits}/></default>'
            )
    return "\n".join([*lines, "</default>"])


def _opened(body: Body, bodies: Bodies, where: str) -> str:
    """The opening tag of a body, with all that is in it but its child."""
    a, side = bodies.pitch_m, body.side
    mass, com, (along, across) = bodies.inertial(body.kind)
    inertia = row((along, across, across))
    way = "ahead" if side > 0 else "behind"
    joints = (f'<joint name="{j.name}" class="{j.letter}-{way}"/>' for j in body.joints)
    bar = ' class="bar"' if body.kind == "hinge" else ""
    shape = f'<geom{bar} fromto="0 0 0 {number(side * a)} 0 0"/>'
    if body.kind == "end":
        tube = f'type="cylinder" fromto="0 0 0 {number(side * a / 2)} 0 0"'
        shape = f'<geom type="sphere" size="{number(bodies.radius_m)}"/><geom {tube}/>'
    return (
        f'<body name="{body.name}" {where}>'
        f'<inertial pos="{number(side * com)} 0 0" mass="{number(mass)}" diaginertia="{inertia}"/>'
        f"{''.join(joints)}{shape}\n"
    )
