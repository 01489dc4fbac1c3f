"""Limb moves: a part of the chain turns or glides as one, wherever nothing is in its way.

A lattice pose is opened by random moves of this kind until its ends can be peeled off. A limb is
a joint and all beyond it (a swing or a peel in the midst of the chain), or the joints between two
that lie on one lattice line (a door).

Why looking at joints is enough. All takes place in planes of two lattice axes, at whole heights,
so only bars that share a height can come nearer than 1, and segments of a plane that do not cross
are nearest at an end of one of them. Let a joint, at rest or moving, come nearer than 1 to the
inside of a bar of the other part, and let the turn go on, or back, the way that brings it towards
the bar's near end. Its distance from the bar's line falls until it passes that end, nearer than 1
to it, unless the turn is over before; but then both are on the lattice, the distance from the line
is a whole number below 1, and the joint is on the line. Either way two *joints* come nearer than 1.
For a quarter turn about a lattice line they do if and only if the joint at rest lies in the
closed quarter plane that the other sweeps and their distances from the axis differ by less than 1;
for a glide along a quarter of the unit circle, if it lies at the end of the arc or opposite its
centre. See `tests/test_limbs.py` for the same by brute force.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from .._jit import kernel
from ..grid import IntArray
from ..kinematics import Move

REACH = 64
"""Joints further than this from an axis are not turned about it."""

FREE, LONGEST_AXIS = -1, 8
TOLL = 1.0
"""Contacts that a move must be worth: without a toll limbs swing to and fro once they can."""

DOORS, SWINGS = 0.3, 0.65
"""Doors are proposed up to the first of these shares, swings up to the second, then glides."""

_PEEL, _SWING, _DOOR = int(Move.PEEL), int(Move.SWING), int(Move.DOOR)


class Pose(NamedTuple):
    """Where the joints are, and which joint is where; no limb comes to rest outside this box."""

    place: IntArray  # (n, 3)
    joint: IntArray  # (X, Y, Z) FREE where there is none


class Arcs(NamedTuple):
    """Cells in the way of quarter turns, counter-clockwise from (u, v), u > 0, v >= 0."""

    start: IntArray  # those for (u, v) begin at entry start[u * (REACH + 1) + v] of `cell`
    cell: IntArray  # (K, 2)


class Limb(NamedTuple):
    """The joints low < k < high, about to move as one by a row of `Motion.moves`."""

    low: int
    high: int
    kind: int
    joint: int
    other: int
    value: int


@cache
def arcs() -> Arcs:
    """The cells in the way of all quarter turns within `REACH`."""
    return _arcs(REACH)


@kernel
def _arcs(reach: int) -> Arcs:
    start = np.zeros((reach + 1) ** 2 + 1, np.int32)
    cell = np.empty((4 * reach**3, 2), np.int32)
    count = 0
    for u in range(reach + 1):
        for v in range(reach + 1):
            radius = int(np.sqrt(u * u + v * v))
            if u > 0 and radius <= reach:
                for x in range(-radius - 1, radius + 2):
                    for y in range(radius + 2):
                        if in_the_way(u, v, x, y):
                            cell[count, 0], cell[count, 1] = x, y
                            count += 1
            start[u * (reach + 1) + v + 1] = count
    return Arcs(start, cell[:count].copy())


@kernel
def in_the_way(u: int, v: int, x: int, y: int) -> bool:
    """Whether (x, y) is nearer than 1 to the quarter arc, counter-clockwise from (u, v)."""
    if u * y - v * x <= 0 or u * x + v * y < 0:
        return False
    a, b = u * u + v * v, x * x + y * y
    return (a + b - 1) ** 2 < 4 * a * b


def open_pose(voxels: IntArray, room: int) -> Pose:
    """The pose of a path in a box with `room` on every side."""
    place = voxels - voxels.min(axis=0) + room
    joint = np.full(place.max(axis=0) + room + 1, FREE, np.int32)
    joint[tuple(place.T)] = np.arange(len(place))
    return Pose(place.astype(np.int32), joint)


@kernel
def open_up(
    pose: Pose, arcs: Arcs, proposals: int, heat: float, rng: Generator, slotted: bool = False
) -> IntArray:
    """Make random limb moves, (K, 4) rows of `Motion.moves`, that leave the pose less dense.

    What is counted are contacts, pairs of joints a step apart. A move that is clear is made if it
    takes some away; if it adds c or none, then with likelihood exp(-(c + TOLL) / heat). With
    `slotted` joints none is made that twists a capsule.
    """
    rows = np.empty((proposals, 4), np.int32)
    moved = np.empty_like(pose.place)
    count = 0
    for _ in range(proposals):
        limb = propose(pose, rng)
        if limb.kind < 0 or (slotted and twists(pose, limb)) or not put(pose, limb, moved):
            continue
        more = _contacts(pose, limb, moved) - _contacts(pose, limb, pose.place)
        wanted = more < 0 or rng.random() < np.exp(-(more + TOLL) / heat)
        if wanted and is_clear(pose, arcs, limb):
            _settle(pose, limb, moved)
            rows[count] = (limb.kind, limb.joint, limb.other, limb.value)
            count += 1
    return rows[:count].copy()


@kernel
def propose(pose: Pose, rng: Generator) -> Limb:
    """A random limb; its kind is -1 if it cannot move that way at all. It takes four joints."""
    n, share = len(pose.place), rng.random()
    if share < DOORS:
        return _door(pose, rng)
    joint, value = int(rng.integers(1, n - 1)), int(rng.integers(0, 6))
    other = joint - 1 if 2 * joint < n else joint + 1  # the shorter side is the limb
    low, high = (-1, joint) if other < joint else (joint, n)
    kind = _SWING if share < SWINGS else _PEEL
    if pose.place[joint, value % 3] != pose.place[other, value % 3]:
        kind = -1
    return Limb(low, high, kind, joint, other, value)


@kernel
def _door(pose: Pose, rng: Generator) -> Limb:
    """A limb between two joints of one lattice line, mostly neighbours."""
    apart = 1 if rng.random() < 0.7 else int(rng.integers(2, LONGEST_AXIS))
    joint, axis = int(rng.integers(0, len(pose.place))), int(rng.integers(0, 3))
    x, y, z = pose.place[joint]
    other = _at(pose, x + apart * (axis == 0), y + apart * (axis == 1), z + apart * (axis == 2))
    low, high = min(joint, other), max(joint, other)
    kind = _DOOR if other != FREE and high - low > apart else -1
    return Limb(low, high, kind, low, high, 2 * int(rng.integers(0, 2)) - 1)


@kernel
def _at(pose: Pose, x: int, y: int, z: int) -> int:
    """The joint at a position, `FREE` if there is none or it lies outside the box."""
    shape = pose.joint.shape
    if 0 <= x < shape[0] and 0 <= y < shape[1] and 0 <= z < shape[2]:
        return int(pose.joint[x, y, z])
    return FREE


@kernel
def _is_free(pose: Pose, limb: Limb, at: IntArray) -> bool:
    """Whether no joint outside the limb is at a position."""
    joint = _at(pose, at[0], at[1], at[2])
    return joint == FREE or limb.low < joint < limb.high


@kernel
def _frame(pose: Pose, limb: Limb) -> tuple[int, int, int, int]:
    """How a limb moves: axes e and d and the signs of the directions along them.

    A turn takes e to d; a glide begins beside its centre along e and ends above it along d.
    """
    step = pose.place[limb.other] - pose.place[limb.joint]
    along = int(np.argmax(np.abs(step)))
    forward = 1 if step[along] > 0 else -1
    if limb.kind == _DOOR:
        return (along + 1) % 3, (along + 2) % 3, 1, forward * limb.value
    return along, limb.value % 3, forward, 1 if limb.value < 3 else -1


@kernel
def twists(pose: Pose, limb: Limb) -> bool:
    """Whether a limb's move twists a capsule between two bent joints, see `lineup.joints`."""
    e, d, _, _ = _frame(pose, limb)
    height, n = pose.place[:, 3 - e - d], len(pose.place)
    for hinge in (limb.joint, limb.other):
        k = hinge - 1 + hinge % 2  # the capsule
        if 0 < hinge < n - 1 and (hinge == limb.joint or limb.kind != _SWING):
            lies_along = height[k] != height[k + 1]
            if lies_along and height[k - 1] == height[k] and height[k + 1] == height[k + 2]:
                return True
    return False


@kernel
def put(pose: Pose, limb: Limb, moved: IntArray) -> bool:
    """Write where a limb's joints come to into `moved`; whether they fit there."""
    e, d, sign_e, sign_d = _frame(pose, limb)
    hinge, sign = pose.place[limb.joint], sign_e * sign_d
    for k in range(limb.low + 1, limb.high):
        moved[k] = pose.place[k]
        if limb.kind == _PEEL:
            moved[k, e] -= sign_e
            moved[k, d] += sign_d
        else:
            moved[k, e] = hinge[e] - sign * (pose.place[k, d] - hinge[d])
            moved[k, d] = hinge[d] + sign * (pose.place[k, e] - hinge[e])
        if not (_inside(pose, moved[k]) and _is_free(pose, limb, moved[k])):
            return False
    return True


@kernel
def _inside(pose: Pose, at: IntArray) -> bool:
    size_x, size_y, size_z = pose.joint.shape
    return bool(0 <= at[0] < size_x and 0 <= at[1] < size_y and 0 <= at[2] < size_z)


@kernel
def is_clear(pose: Pose, arcs: Arcs, limb: Limb) -> bool:
    """Whether nothing is in the way of a limb that fits where it is to go."""
    if limb.kind == _PEEL:
        return _glides(pose, limb)
    k = limb.low + 1
    while k < limb.high and _turns(pose, arcs, limb, k):
        k += 1
    return k == limb.high


@kernel
def _turns(pose: Pose, arcs: Arcs, limb: Limb, k: int) -> bool:
    """Whether joint k may make its part of the limb's turn."""
    e, d, sign_e, sign_d = _frame(pose, limb)
    hinge, at = pose.place[limb.joint], pose.place[k].copy()
    u, v = sign_e * (at[e] - hinge[e]), sign_d * (at[d] - hinge[d])
    if u == 0 and v == 0:
        return True
    cos, sin = 1, 0  # of the turn from the quarter that the arcs begin in
    while u <= 0 or v < 0:
        u, v = v, -u
        cos, sin = -sin, cos
    if u * u + v * v > REACH * REACH:
        return False
    entry = u * (REACH + 1) + v
    for row in range(arcs.start[entry], arcs.start[entry + 1]):
        x, y = arcs.cell[row]
        at[e] = hinge[e] + sign_e * (cos * x - sin * y)
        at[d] = hinge[d] + sign_d * (sin * x + cos * y)
        if not _is_free(pose, limb, at):
            return False
    return True


@kernel
def _glides(pose: Pose, limb: Limb) -> bool:
    """Whether a limb may glide while the bar at its foot turns.

    Seen from the limb, the joint at its foot goes round the same arc, the other way.
    """
    _, d, _, sign_d = _frame(pose, limb)
    for k in range(limb.low + 1, limb.high):
        at = pose.place[k].copy()
        at[d] += sign_d
        if not _is_free(pose, limb, at):
            return False
    for foot in (limb.joint, limb.other):
        at = pose.place[foot].copy()
        at[d] -= sign_d
        if limb.low < _at(pose, at[0], at[1], at[2]) < limb.high:
            return False
    return True


@kernel
def _contacts(pose: Pose, limb: Limb, place: IntArray) -> int:
    """Steps from the limb's joints, put at `place`, to joints outside it."""
    count = 0
    for k in range(limb.low + 1, limb.high):
        x, y, z = place[k]
        for other in (
            _at(pose, x + 1, y, z),
            _at(pose, x - 1, y, z),
            _at(pose, x, y + 1, z),
            _at(pose, x, y - 1, z),
            _at(pose, x, y, z + 1),
            _at(pose, x, y, z - 1),
        ):
            count += other != FREE and not limb.low < other < limb.high
    return count


@kernel
def _settle(pose: Pose, limb: Limb, moved: IntArray) -> None:
    """Put the limb's joints at their new places."""
    for k in range(limb.low + 1, limb.high):
        x, y, z = pose.place[k]
        pose.joint[x, y, z] = FREE
    for k in range(limb.low + 1, limb.high):
        x, y, z = moved[k]
        pose.joint[x, y, z] = k
        pose.place[k] = moved[k]
