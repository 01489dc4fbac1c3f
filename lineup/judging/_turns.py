"""The judge of PEEL, SWING and DOOR, move by move: near-linear in the length of the chain.

A peel costs as much as the body is wide, a swing as much as the cells of the body that it sweeps
over; joints enter and leave the body a few times at most in a motion that unfolds or folds.
"""

from typing import NamedTuple

import numpy as np

from .._jit import kernel, part
from ..kinematics import TURNS
from ._chain import (
    ENTRY_COST,
    FAR_X,
    NEAR,
    NEAR_X,
    Chain,
    Point,
    enter,
    insert,
    lay_out,
    mend,
    new_chain,
    position,
    release,
    settle,
    split,
    start,
)
from ._meeting import (
    IN_BODY,
    Court,
    Frame,
    Moving,
    meet_rest,
    see_moving,
    see_rest,
    to_frame,
)
from ._sweeps import XHI, XLO, Floats, Ints, Nearest, compare, nearest_bars

FINE, JOINTS, DIRECTION, DOOR, TOUCH, BEND, OUTGROWN = range(7)
"""What `carry_out` found: nothing wrong, a malformed move (three ways), or a failed move."""

_PEEL, _SWING, _DOOR = (int(kind) for kind in TURNS)


class Limits(NamedTuple):
    """What a motion has to keep."""

    diameter: float
    max_bend_deg: float
    reach: Floats  # (3,) largest difference of the highest and the lowest positions met


class Found(NamedTuple):
    """What was met, the failing move's included."""

    where: int  # the move that fails, or the first not looked at
    fault: int
    straight: bool  # whether one of the moves ended on a straight line
    clearance: float  # capped at 1
    near: tuple[int, int, int]  # the move and the two bars that came so near, -1 if none did
    bend_deg: float
    bent: tuple[int, int]  # the move and the joint that bent so far, -1 if none did


def carry_out(pose: Ints, moves: Ints, first: int, limits: Limits, extent: Floats) -> Found:
    """Judge the moves from row `first` on, up to a fault or a move that is none of `TURNS`.

    `pose` is moved along, and `extent`, (2, 3) the lowest and highest positions met, widened.
    """
    n = len(pose)
    court = Court(
        new_chain(pose),
        Nearest(np.ones(1), np.empty((2, 9), np.int64), np.zeros(1, np.int64)),
        extent,
        np.empty((n, 9), np.int64),
        np.empty((n, 9), np.int64),
        np.empty((2, 9), np.int64),
        np.empty(3, np.int64),
    )
    return _carry_out(court, moves, first, limits)


@kernel
def _carry_out(court: Court, moves: Ints, first: int, limits: Limits) -> Found:
    chain = court.chain
    start(chain)
    corners = max(0, chain.n_runs[1] - 1)
    where, fault, straight = first, FINE, False
    near, bend_deg, bent = (-1, -1, -1), 0.0, (-1, -1)
    while fault == FINE and where < len(moves) and moves[where, 0] in (_PEEL, _SWING, _DOOR):
        clearance = court.nearest.distance[0]
        fault, worst, joint, gained = _judge(court, limits, moves[where])
        if court.nearest.distance[0] < clearance:
            bar_a, bar_b = nearest_bars(court.nearest, court.bars)
            near = (where, bar_a, bar_b)
        if worst > bend_deg:
            bend_deg, bent = worst, (where, joint)
        corners += gained
        if fault == FINE:
            straight = straight or corners == 0
            where += 1
    lay_out(chain)
    return Found(where, fault, straight, court.nearest.distance[0], near, bend_deg, bent)


@part
def _judge(court: Court, limits: Limits, move: Ints) -> tuple[int, float, int, int]:
    """Make one move: the fault, its largest bend, the joint that has it, and the corners gained."""
    chain = court.chain
    kind, joint, other, value = move
    n = len(chain.pose)
    if not (0 <= joint < n and 0 <= other < n):
        return JOINTS, 0.0, -1, 0
    p, q = position(chain, joint), position(chain, other)
    fault = _malformed(p, q, kind, joint, other, value)
    if fault != FINE:
        return fault, 0.0, -1, 0
    frame = _frame(p, q, kind, value)
    moving = _part(chain, kind, joint, other)
    _sweep(court, move, moving, frame)
    if court.nearest.distance[0] < limits.diameter:
        return TOUCH, 0.0, -1, 0
    second = joint if kind == _SWING else other
    before, joint_before = _bends(chain, joint, second)
    corners = _corners(chain, joint, second)
    _carry(chain, move, moving, frame)
    after, joint_after = _bends(chain, joint, second)
    gained = _corners(chain, joint, second) - corners
    if before >= after:
        after, joint_after = before, joint_before
    if after > limits.max_bend_deg:
        return BEND, after, joint_after, gained
    for axis in range(3):
        if court.extent[1, axis] - court.extent[0, axis] > limits.reach[axis]:
            return OUTGROWN, after, joint_after, gained
    return FINE, after, joint_after, gained


@part
def _bend_at(chain: Chain, joint: int) -> float:
    """Bend of a lattice pose at one joint, 0, 90 or 180 degrees; 0 at the two ends."""
    if joint < 1 or joint > len(chain.pose) - 2:
        return 0.0
    o, p, q = position(chain, joint - 1), position(chain, joint), position(chain, joint + 1)
    cosine = 0
    for axis in range(3):
        cosine += (p[axis] - o[axis]) * (q[axis] - p[axis])
    return 90.0 * (1 - cosine)


@part
def _bends(chain: Chain, joint: int, second: int) -> tuple[float, int]:
    """The larger bend at two joints, and which of them has it.

    A hinge of the move sees one bar turn from e to d and another rest on a lattice axis: its bend
    is constant or runs monotonically, so the poses before and after hold the largest.
    """
    a, b = _bend_at(chain, joint), _bend_at(chain, second)
    return (b, second) if b > a else (a, joint)


@part
def _corners(chain: Chain, joint: int, second: int) -> int:
    count = int(_bend_at(chain, joint) > 0)
    if second != joint:
        count += _bend_at(chain, second) > 0
    return count


@part
def _malformed(p: Point, q: Point, kind: int, joint: int, other: int, value: int) -> int:
    """`FINE`, or what makes this no move of joints at p and q; one that moves nothing is none."""
    if kind == _DOOR:
        if other - joint < 2:
            return JOINTS
        apart = (abs(q[0] - p[0]), abs(q[1] - p[1]), abs(q[2] - p[2]))
        on_a_lattice_line = max(apart) == sum(apart)
        if not on_a_lattice_line or sum(apart) == other - joint or value not in (-1, 1):
            return DOOR
        return FINE
    if abs(other - joint) != 1:
        return JOINTS
    if not 0 <= value < 6 or p[value % 3] != q[value % 3]:
        return DIRECTION
    return FINE


@part
def _frame(p: Point, q: Point, kind: int, value: int) -> Frame:
    """The frame of a move by joints at p and q, with its origin at p."""
    axis = 0
    for other in range(1, 3):
        if abs(q[other] - p[other]) > abs(q[axis] - p[axis]):
            axis = other
    positive = q[axis] > p[axis]
    e, d = (axis if positive else axis + 3), value
    if kind == _DOOR:
        e, d = (axis + 1) % 3, (axis + 2) % 3
        if positive != (value > 0):
            e, d = d, e
    x, y = e % 3, d % 3
    h = 3 - x - y
    return Frame(p[x], p[y], p[h], x, y, h, (1 if e < 3 else -1), (1 if d < 3 else -1))


@part
def _part(chain: Chain, kind: int, joint: int, other: int) -> Moving:
    """Part what moves from what rests: afterwards no moving run is in the body."""
    first, last = chain.body[0], chain.body[1]
    if kind == _DOOR and first <= joint and other <= last:
        return Moving(IN_BODY, 0, 0)
    side, near, far = int(other > joint), joint, other
    if kind == _DOOR and joint < first and other <= last:
        side, near, far = 0, other, joint
    outward = 2 * side - 1
    if outward * (near - chain.body[1 - side]) < 0:
        settle(chain, 1 - side, near)
    elif outward * (near - chain.body[side]) < 0:
        release(chain, side, near)
    else:
        _enter_between(chain, side, near)
    _enter_opposite(chain, 1 - side)
    begin = split(chain, side, far) if kind != _SWING else 0
    end = split(chain, side, near)
    return Moving(side, begin if kind == _DOOR else 0, end)


@part
def _enter_between(chain: Chain, side: int, near: int) -> None:
    """Let what rests between the body and joint `near` enter the body, once that is worth it.

    Where that is longer than the body, the body starts anew at `near`: a long rod that rests
    far from where the chain moves then never enters.
    """
    between = abs(near - chain.body[side])
    if chain.debt[side] > ENTRY_COST * between:
        if between > chain.body[1] - chain.body[0]:
            settle(chain, side, near)
            chain.debt[side] = 0
        else:
            enter(chain, side, split(chain, side, near))


@part
def _enter_opposite(chain: Chain, side: int) -> None:
    """Let all runs of a side that rests, but the last, enter the body, once that is worth it."""
    if chain.n_runs[side] > 1:
        n_bars = abs(chain.runs[side, 0, NEAR] - chain.body[side])
        if chain.debt[side] > ENTRY_COST * n_bars:
            enter(chain, side, 1)


@part
def _sweep(court: Court, move: Ints, moving: Moving, frame: Frame) -> None:
    """Take note of how near the chain comes to itself during a move, and of how far it reaches."""
    kind, joint, other, _ = move
    hinges = (joint, joint if kind == _SWING else other)
    n_resting, n = see_rest(court, moving, frame, hinges), see_moving(court, moving, frame, hinges)
    limb = (joint, other if moving.side == IN_BODY else joint)  # of the body; empty if none moves
    n_turning = 1 if kind == _PEEL else n
    turning, carried = court.moving[:n_turning], court.moving[n_turning:n]
    for slides in range(2):
        meet_rest(court, carried if slides else turning, n_resting, slides == 0, limb, frame)
    # Seen from the carried bars the turning bar swings about `other`, by the same quarter.
    for k in range(n):
        court.moving[k, XLO] -= 1
        court.moving[k, XHI] -= 1
    compare(turning, carried, True, court.nearest)
    _charge(court.chain, moving, n)


@part
def _charge(chain: Chain, moving: Moving, n_moving: int) -> None:
    """Count the comparisons with resting runs that would be none, were these in the body."""
    for side in range(2):
        n = chain.n_runs[side]
        chain.debt[side] += n_moving * (n - moving.end if side == moving.side else n)


@part
def _carry(chain: Chain, move: Ints, moving: Moving, frame: Frame) -> None:
    """Bring what a move carries to where it is at its end."""
    kind, joint, other, _ = move
    side, begin, end = moving
    if side == IN_BODY:
        for k in range(joint + 1, other):
            _turn(chain.pose[k], frame)
            insert(chain, k)
        return
    if kind == _PEEL:
        bar = chain.runs[side, end - 1]
        _turn(bar[FAR_X:], frame)
        for k in range(end - 1):
            _slide(chain.runs[side, k, NEAR_X:FAR_X], frame)
            _slide(chain.runs[side, k, FAR_X:], frame)
        mend(chain, side, end)
        mend(chain, side, end - 1)
        return
    for k in range(begin, end):
        _turn(chain.runs[side, k, NEAR_X:FAR_X], frame)
        _turn(chain.runs[side, k, FAR_X:], frame)
    mend(chain, side, end)
    mend(chain, side, begin)


@part
def _turn(p: Ints, frame: Frame) -> None:
    """Turn a position by a quarter about the origin of a frame."""
    x, y, _ = to_frame(p, frame)
    p[frame.axis_x] = frame.x0 - frame.sign_x * y
    p[frame.axis_y] = frame.y0 + frame.sign_y * x


@part
def _slide(p: Ints, frame: Frame) -> None:
    """Carry a position along with the end of a bar that turns by a quarter."""
    p[frame.axis_x] -= frame.sign_x
    p[frame.axis_y] += frame.sign_y
