"""Closed forms for the judge: how near two bodies of the chain come while one move is made.

Every move but TILT starts from a lattice pose and turns by 90 degrees in the plane of two lattice
axes, from axis e to axis d. In the frame (x, y, h) with x along e, y along d and h along the third
axis, distances along h stay as they are, and h is an integer: only bars that share a height
can come nearer than 1. What is left is plane geometry between axis-parallel boxes with integer
corners (a straight run of bars is a thin box) and quarter arcs about the origin, so the smallest
distance over the whole turn is exact up to rounding. Distances of 1 or more are not told
apart: bars k and k + 2 are never more than 1 apart, so 1 is the largest clearance there is.
"""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel
from ..kinematics import Move

Ints = NDArray[np.int64]
Near = tuple[float, int, int]  # a distance, capped at 1, and the first bars of two runs that near

FINE, KIND, JOINTS, DIRECTION, DOOR, TOUCH, BEND = range(7)
"""What `carry_out` found: nothing wrong, a malformed move (four ways), or a failed move."""

_PEEL, _SWING, _DOOR = int(Move.PEEL), int(Move.SWING), int(Move.DOOR)
_TILT, _BEND = int(Move.TILT), int(Move.BEND)
_XLO, _YLO, _HLO, _XHI, _YHI, _HHI, _FIRST, _LAST = range(8)
_OUTSIDE_CONE = -1e-9


@kernel
def carry_out(
    pose: Ints, moves: Ints, first: int, diameter: float, max_bend_deg: float
) -> tuple[int, int, float, float, bool, int, int]:
    """Judge the moves from row `first` on, moving `pose` along, up to a fault, a TILT or a BEND.

    Returns
    -------
    where, fault : int
        Where it stopped and why; one of those or the end of the list is `FINE`.
    clearance, bend_deg : float
        Smallest distance, capped at 1, and largest bend met, the failing move's included.
    straight : bool
        Whether one of these moves ended on a straight line.
    bar_a, bar_b : int
        First bars of the nearest two runs where the fault is `TOUCH`; the joint, where `BEND`.
    """
    n_joints = len(pose)
    scratch = np.empty((2, n_joints, 8), np.int64)
    local = np.empty((n_joints, 3), np.int64)
    clearance, bend_deg, straight = 1.0, 0.0, False
    corners = 0
    for joint in range(n_joints):
        corners += bend_at(pose, joint) > 0
    for where in range(first, len(moves)):
        kind, joint, other, value = moves[where]
        if kind in (_TILT, _BEND):
            return where, FINE, clearance, bend_deg, straight, -1, -1
        fault = _malformed(pose, kind, joint, other, value)
        if fault != FINE:
            return where, fault, clearance, bend_deg, straight, -1, -1
        e, d = _plane(pose, kind, joint, other, value)
        _to_frame(pose, joint, e, d, local)
        distance, bar_a, bar_b = _swept(local, kind, joint, other, scratch)
        clearance = min(clearance, distance)
        if distance < diameter:
            return where, TOUCH, clearance, bend_deg, straight, bar_a, bar_b
        worst, bent_joint, more = _carry(pose, local, kind, joint, other, e, d)
        corners += more
        bend_deg = max(bend_deg, worst)
        if worst > max_bend_deg:
            return where, BEND, clearance, bend_deg, straight, bent_joint, bent_joint
        straight = straight or corners == 0
    return len(moves), FINE, clearance, bend_deg, straight, -1, -1


@kernel
def bend_at(pose: Ints, joint: int) -> float:
    """Bend of a lattice pose at one joint, 0, 90 or 180 degrees; 0 at the two ends."""
    if joint < 1 or joint > len(pose) - 2:
        return 0.0
    cosine = 0
    for axis in range(3):
        cosine += (pose[joint, axis] - pose[joint - 1, axis]) * (
            pose[joint + 1, axis] - pose[joint, axis]
        )
    return 90.0 * (1 - cosine)


@kernel
def _bends(pose: Ints, joint: int, second: int) -> tuple[float, int]:
    """The larger bend at two joints, and which of them has it.

    A hinge of the move sees one bar turn from e to d and another rest on a lattice axis: its bend
    is constant or runs monotonically, so the poses before and after hold the largest.
    """
    a, b = bend_at(pose, joint), bend_at(pose, second)
    return (b, second) if b > a else (a, joint)


@kernel
def _corners(pose: Ints, joint: int, second: int) -> int:
    count = int(bend_at(pose, joint) > 0)
    if second != joint:
        count += bend_at(pose, second) > 0
    return count


@kernel
def _malformed(pose: Ints, kind: int, joint: int, other: int, value: int) -> int:
    """`FINE`, or what makes this row no move of this pose; a move that moves nothing is none."""
    n_joints = len(pose)
    if kind not in (_PEEL, _SWING, _DOOR):
        return KIND
    if not (0 <= joint < n_joints and 0 <= other < n_joints):
        return JOINTS
    if kind == _DOOR:
        if other - joint < 2:
            return JOINTS
        apart = np.abs(pose[other] - pose[joint])
        on_a_lattice_line = apart.max() == apart.sum()
        if not on_a_lattice_line or apart.sum() == other - joint or value not in (-1, 1):
            return DOOR
        return FINE
    if abs(other - joint) != 1:
        return JOINTS
    if not 0 <= value < 6 or pose[other, value % 3] != pose[joint, value % 3]:
        return DIRECTION
    return FINE


@kernel
def _plane(pose: Ints, kind: int, joint: int, other: int, value: int) -> tuple[int, int]:
    """Directions e and d (0..5, as in `grid.DIRECTIONS`) of a move that turns e into d."""
    step = pose[other] - pose[joint]
    axis = int(np.argmax(np.abs(step)))
    positive = step[axis] > 0
    if kind != _DOOR:
        return (axis if positive else axis + 3), value
    e, d = (axis + 1) % 3, (axis + 2) % 3
    return (e, d) if positive == (value > 0) else (d, e)


@kernel
def _to_frame(pose: Ints, origin: int, e: int, d: int, local: Ints) -> None:
    axis_x, axis_y = e % 3, d % 3
    axis_h = 3 - axis_x - axis_y
    sign_x, sign_y = (1 if e < 3 else -1), (1 if d < 3 else -1)
    x0, y0, h0 = pose[origin, axis_x], pose[origin, axis_y], pose[origin, axis_h]
    for joint in range(len(pose)):
        local[joint, 0] = sign_x * (pose[joint, axis_x] - x0)
        local[joint, 1] = sign_y * (pose[joint, axis_y] - y0)
        local[joint, 2] = pose[joint, axis_h] - h0


@kernel
def _carry(
    pose: Ints, local: Ints, kind: int, joint: int, other: int, e: int, d: int
) -> tuple[float, int, int]:
    """Make the move: the largest bend during it, the joint that has it, and the corners gained."""
    second = joint if kind == _SWING else other
    before, joint_before = _bends(pose, joint, second)
    corners = _corners(pose, joint, second)
    _move(pose, local, kind, joint, other, e, d)
    after, joint_after = _bends(pose, joint, second)
    gained = _corners(pose, joint, second) - corners
    if after > before:
        return after, joint_after, gained
    return before, joint_before, gained


@kernel
def _move(pose: Ints, local: Ints, kind: int, joint: int, other: int, e: int, d: int) -> None:
    """Put the joints that the move carries where they are at its end."""
    axis_x, axis_y = e % 3, d % 3
    sign_x, sign_y = (1 if e < 3 else -1), (1 if d < 3 else -1)
    begin, stop = 0, other + 1
    if kind == _DOOR:
        begin, stop = joint + 1, other
    elif other > joint:
        begin, stop = other, len(pose)
    x0, y0 = pose[joint, axis_x], pose[joint, axis_y]
    for k in range(begin, stop):
        x, y = local[k, 0], local[k, 1]
        new_x, new_y = (x - 1, y + 1) if kind == _PEEL else (-y, x)
        pose[k, axis_x] = x0 + sign_x * new_x
        pose[k, axis_y] = y0 + sign_y * new_y


@kernel
def _swept(local: Ints, kind: int, joint: int, other: int, scratch: NDArray[np.int64]) -> Near:
    """Smallest distance, capped at 1, between bodies during the move, and two bars that near."""
    n_bars = len(local) - 1
    nothing_near = (1.0, -1, -1)
    moving, resting = scratch[0], scratch[1]
    forward = other > joint
    if kind == _DOOR:
        n_moving = _runs(local, joint, other, joint, other, moving, 0)
        n_resting = _runs(local, 0, joint, joint, other, resting, 0)
        n_resting = _runs(local, other, n_bars, joint, other, resting, n_resting)
        return _closest(moving[:n_moving], resting[:n_resting], True, nothing_near)
    if forward:
        n_resting = _runs(local, 0, joint, joint, other, resting, 0)
    else:
        n_resting = _runs(local, joint, n_bars, joint, other, resting, 0)
    at_rest = resting[:n_resting]
    turning = _runs(local, min(joint, other), max(joint, other), joint, other, moving, 0)
    if kind == _SWING:
        n_moving = _beyond(local, joint, other, moving, turning)
        return _closest(moving[:n_moving], at_rest, True, nothing_near)
    bar = moving[:turning].copy()
    best = _closest(bar, at_rest, True, nothing_near)
    carried = moving[: _beyond(local, joint, other, moving, 0)]
    best = _closest(carried, at_rest, False, best)
    # Seen from the carried bars the turning bar swings about `other`, by the same quarter.
    for run in (bar, carried):
        run[:, _XLO] -= 1
        run[:, _XHI] -= 1
    return _closest(bar, carried, True, best)


@kernel
def _beyond(local: Ints, joint: int, other: int, out: Ints, count: int) -> int:
    """Runs of the bars beyond `other`, seen from `joint`."""
    if other > joint:
        return _runs(local, other, len(local) - 1, joint, other, out, count)
    return _runs(local, 0, other, joint, other, out, count)


@kernel
def _runs(
    local: Ints, begin: int, stop: int, hinge: int, second: int, out: Ints, count: int
) -> int:
    """Append the straight runs of bars begin..stop-1 to rows `count`.. of `out`; the new count.

    A run also ends beside a hinge, so that bars one apart across a hinge are runs of their own.
    """
    for bar in range(begin, stop):
        x, y, h = local[bar, 0], local[bar, 1], local[bar, 2]
        x1, y1, h1 = local[bar + 1, 0], local[bar + 1, 1], local[bar + 1, 2]
        goes_on = bar > begin and abs(bar - hinge) > 1 and abs(bar - second) > 1
        if goes_on:
            goes_on = (
                x1 - x == x - local[bar - 1, 0]
                and y1 - y == y - local[bar - 1, 1]
                and h1 - h == h - local[bar - 1, 2]
            )
        if not goes_on:
            out[count, _XLO], out[count, _YLO], out[count, _HLO] = x, y, h
            out[count, _XHI], out[count, _YHI], out[count, _HHI] = x, y, h
            out[count, _FIRST] = bar
            count += 1
        run = out[count - 1]
        run[_XLO], run[_XHI] = min(run[_XLO], x1), max(run[_XHI], x1)
        run[_YLO], run[_YHI] = min(run[_YLO], y1), max(run[_YHI], y1)
        run[_HLO], run[_HHI] = min(run[_HLO], h1), max(run[_HHI], h1)
        run[_LAST] = bar
    return count


@kernel
def _closest(moving: Ints, resting: Ints, turning: bool, best: Near) -> Near:
    """The nearer of `best` and the nearest two runs over a quarter turn, or a slide."""
    for i in range(len(moving)):
        m = moving[i]
        for k in range(len(resting)):
            r = resting[k]
            if m[_HLO] > r[_HHI] or r[_HLO] > m[_HHI]:
                continue
            if m[_FIRST] - r[_LAST] < 2 and r[_FIRST] - m[_LAST] < 2:
                continue
            distance = _turn_distance(m, r) if turning else _slide_distance(m, r)
            if distance < best[0]:
                best = (distance, m[_FIRST], r[_FIRST])
    return best


@kernel
def _slide_distance(m: Ints, r: Ints) -> float:
    """Smallest distance while run m slides along the unit arc from (1, 0) to (0, 1).

    They meet where the arc's point lies in the Minkowski difference of the two boxes.
    """
    xlo, xhi = 1 + r[_XLO] - m[_XHI], 1 + r[_XHI] - m[_XLO]
    ylo, yhi = r[_YLO] - m[_YHI], r[_YHI] - m[_YLO]
    if xlo > 1 or xhi < 0 or ylo > 1 or yhi < 0:
        return 1.0
    return _arc_to_box(1, 0, xlo, ylo, xhi, yhi)


@kernel
def _turn_distance(m: Ints, r: Ints) -> float:
    """Smallest distance while run m turns by a quarter, counter-clockwise about the origin.

    The first contact of two segments in a plane is made by an end of one of them, and so is
    every smallest distance: four arcs tell, the ends of r running backwards.
    """
    if _inner(r) >= _outer(m) + 1 or _inner(m) >= _outer(r) + 1:
        return 1.0
    gap_x = max(0, r[_XLO] - m[_XHI], m[_XLO] - r[_XHI])
    gap_y = max(0, r[_YLO] - m[_YHI], m[_YLO] - r[_YHI])
    best = sqrt(float(gap_x * gap_x + gap_y * gap_y))
    for end in range(2):
        x, y = m[3 * end], m[3 * end + 1]
        best = min(best, _arc_to_box(x, y, r[_XLO], r[_YLO], r[_XHI], r[_YHI]))
        x, y = r[3 * end], r[3 * end + 1]
        best = min(best, _arc_to_box(y, -x, m[_XLO], m[_YLO], m[_XHI], m[_YHI]))
    return best


@kernel
def _inner(run: Ints) -> float:
    """Distance from the origin of the frame's plane to a run."""
    return _to_box(0, 0, run[_XLO], run[_YLO], run[_XHI], run[_YHI])


@kernel
def _outer(run: Ints) -> float:
    """Largest distance from the origin of the frame's plane to a run."""
    x = max(abs(run[_XLO]), abs(run[_XHI]))
    y = max(abs(run[_YLO]), abs(run[_YHI]))
    return sqrt(float(x * x + y * y))


@kernel
def _to_box(x: int, y: int, xlo: int, ylo: int, xhi: int, yhi: int) -> float:
    gap_x, gap_y = max(0, xlo - x, x - xhi), max(0, ylo - y, y - yhi)
    return sqrt(float(gap_x * gap_x + gap_y * gap_y))


@kernel
def _arc_to_box(px: int, py: int, xlo: int, ylo: int, xhi: int, yhi: int) -> float:
    """Distance from the quarter arc, counter-clockwise from (px, py), to an axis-parallel box.

    Unless they meet, the nearest points are an end of the arc, a corner of the box, or the
    box's point nearest to the centre, each seen from the other along a radius.
    """
    best = min(_to_box(px, py, xlo, ylo, xhi, yhi), _to_box(-py, px, xlo, ylo, xhi, yhi))
    radius_2 = px * px + py * py
    radius = sqrt(float(radius_2))
    foot_x, foot_y = min(max(0, xlo), xhi), min(max(0, ylo), yhi)
    for x, y in ((xlo, ylo), (xlo, yhi), (xhi, ylo), (xhi, yhi), (foot_x, foot_y)):
        if px * y - py * x >= 0 and px * x + py * y >= 0:
            best = min(best, abs(sqrt(float(x * x + y * y)) - radius))
    # A quarter turn back brings the edges y = const into the place of x = const.
    if (
        _meets_edge(px, py, xlo, ylo, yhi)
        or _meets_edge(px, py, xhi, ylo, yhi)
        or _meets_edge(py, -px, ylo, -xhi, -xlo)
        or _meets_edge(py, -px, yhi, -xhi, -xlo)
    ):
        return 0.0
    return best


@kernel
def _meets_edge(px: int, py: int, x: int, ylo: int, yhi: int) -> bool:
    """Whether the quarter arc from (px, py) meets the edge at x from ylo to yhi."""
    height_2 = px * px + py * py - x * x
    if height_2 < 0:
        return False
    for sign in (-1.0, 1.0):
        y = sign * sqrt(float(height_2))
        in_cone = px * y - py * x >= _OUTSIDE_CONE and px * x + py * y >= _OUTSIDE_CONE
        if in_cone and ylo <= y <= yhi:
            return True
    return False
