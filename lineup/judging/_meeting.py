"""How near moving runs come to all that rests: to the body by its cells, to the runs one by one."""

from math import ceil, floor
from typing import NamedTuple

import numpy as np

from .._jit import part
from ._chain import FAR, FAR_X, NEAR, NEAR_X, Chain, Point, find
from ._sweeps import (
    FIRST,
    GROWS,
    HHI,
    HLO,
    LAST,
    Box,
    Floats,
    Ints,
    Nearest,
    compare,
    inner,
    meet,
    outer,
    swept_box,
)

IN_BODY = -1
_BAR_REACH = 1.5  # a bar nearer than 1 has an end nearer than that


class Court(NamedTuple):
    """The chain under judgement, what has been met so far, and room for the runs of one move."""

    chain: Chain
    nearest: Nearest
    extent: Floats  # (2, 3) lowest and highest positions met
    moving: Ints  # (P, 9)
    resting: Ints  # (P, 9)
    bars: Ints  # (2, 9)
    place: Ints  # (3,)


class Frame(NamedTuple):
    """A lattice frame in which a move turns the axis x to the axis y, about the origin."""

    x0: int
    y0: int
    h0: int
    axis_x: int
    axis_y: int
    axis_h: int
    sign_x: int
    sign_y: int


class Moving(NamedTuple):
    """What a move carries: runs begin..end-1 of a side, or a limb of the body."""

    side: int  # `IN_BODY` for a limb between two joints of the body
    begin: int
    end: int


@part
def see_rest(court: Court, moving: Moving, frame: Frame, hinges: tuple[int, int]) -> int:
    """List the runs outside the body that rest; their number."""
    chain, count = court.chain, 0
    for side in range(2):
        for k in range(chain.n_runs[side]):
            if side != moving.side or not moving.begin <= k < moving.end:
                count = _see(chain.runs[side, k], frame, hinges, court.resting, count)
    return count


@part
def see_moving(court: Court, moving: Moving, frame: Frame, hinges: tuple[int, int]) -> int:
    """List the runs that move, the one at the hinge first; their number."""
    if moving.side == IN_BODY:
        return _see_limb(court, frame, hinges)
    count = 0
    for k in range(moving.end - 1, moving.begin - 1, -1):
        count = _see(court.chain.runs[moving.side, k], frame, hinges, court.moving, count)
    return count


@part
def _see(run: Ints, frame: Frame, hinges: tuple[int, int], out: Ints, count: int) -> int:
    """Write a run outside the body, as seen in a frame, from row `count` on; the new count."""
    near, far = run[NEAR_X:FAR_X], run[FAR_X:]
    return _place(run[NEAR], run[FAR], near, far, frame, hinges, out, count)


@part
def _see_limb(court: Court, frame: Frame, hinges: tuple[int, int]) -> int:
    """List the straight runs of the body between two of its joints; their number."""
    pose, count = court.chain.pose, 0
    start, other = hinges
    while start < other:
        stop = start + 1
        while stop < other and _goes_straight(pose, stop):
            stop += 1
        count = _place(start, stop, pose[start], pose[stop], frame, hinges, court.moving, count)
        start = stop
    return count


@part
def _goes_straight(pose: Ints, joint: int) -> bool:
    for axis in range(3):
        if pose[joint + 1, axis] + pose[joint - 1, axis] != 2 * pose[joint, axis]:
            return False
    return True


@part
def _place(
    joint: int,
    other: int,
    p: Ints,
    q: Ints,
    frame: Frame,
    hinges: tuple[int, int],
    out: Ints,
    count: int,
) -> int:
    """Write the run from a joint at p to another at q as seen in a frame; the new count.

    A bar beside a hinge is a run of its own, so that bars one apart are not compared.
    """
    n_bars, begin = abs(other - joint), 0
    if joint in hinges and n_bars > 1:
        _place_bars(joint, other, p, q, 0, 1, frame, out[count])
        count, begin = count + 1, 1
    end = n_bars
    if other in hinges and n_bars - begin > 1:
        end = n_bars - 1
        _place_bars(joint, other, p, q, end, n_bars, frame, out[count])
        count += 1
    _place_bars(joint, other, p, q, begin, end, frame, out[count])
    return count + 1


@part
def _place_bars(
    joint: int, other: int, p: Ints, q: Ints, begin: int, end: int, frame: Frame, out: Ints
) -> None:
    """Write bars begin..end-1 of the straight run from a joint at p to another at q."""
    n_bars, step = abs(other - joint), 1 if other > joint else -1
    out[FIRST] = min(joint + step * begin, joint + step * end)
    out[LAST] = out[FIRST] + end - begin - 1
    axes = (frame.axis_x, frame.axis_y, frame.axis_h)
    origin, signs = (frame.x0, frame.y0, frame.h0), (frame.sign_x, frame.sign_y, 1)
    for k in range(3):
        axis = axes[k]
        slope = (q[axis] - p[axis]) // n_bars
        u = signs[k] * (p[axis] + slope * begin - origin[k])
        v = signs[k] * (p[axis] + slope * end - origin[k])
        out[k], out[k + 3] = min(u, v), max(u, v)
        if u != v:
            out[GROWS] = step if v > u else -step


@part
def meet_rest(
    court: Court, runs: Ints, n_resting: int, turning: bool, limb: tuple[int, int], frame: Frame
) -> None:
    """Compare moving runs with all that rests: all of the body but a limb, and runs outside it."""
    compare(runs, court.resting[:n_resting], turning, court.nearest)
    n_bars = court.chain.body[1] - court.chain.body[0]
    for k in range(len(runs)):
        run = runs[k]
        box = swept_box(run, turning)
        _widen(court.extent, box, frame)
        if n_bars == 0:
            continue
        lo, hi = _cells(court.chain, run, box, frame)
        n_cells = 1
        for axis in range(3):
            n_cells *= max(0, hi[axis] - lo[axis] + 1)
        if n_cells < n_bars:
            _look_up(court, run, turning, limb, frame, lo, hi)
        else:
            for bar in range(court.chain.body[0], court.chain.body[1]):
                _meet_bar(court, run, bar, turning, limb, frame)


@part
def _meet_bar(
    court: Court, run: Ints, bar: int, turning: bool, limb: tuple[int, int], frame: Frame
) -> None:
    """Compare a moving run with one bar, if that is a bar of the body that rests."""
    pose, body = court.chain.pose, court.chain.body
    if body[0] <= bar < body[1] and not limb[0] <= bar < limb[1]:
        _place_bars(bar, bar + 1, pose[bar], pose[bar + 1], 0, 1, frame, court.bars[0])
        meet(run, court.bars[0], turning, court.nearest)


@part
def _cells(chain: Chain, run: Ints, box: Box, frame: Frame) -> tuple[Point, Point]:
    """Lowest and highest (x, y, h) at which a joint of the body may be near a run."""
    a = to_frame(chain.box[0], frame)
    b = to_frame(chain.box[1], frame)
    lo = (
        max(ceil(box[0] - _BAR_REACH), min(a[0], b[0])),
        max(ceil(box[1] - _BAR_REACH), min(a[1], b[1])),
        max(run[HLO], a[2]),
    )
    hi = (
        min(floor(box[2] + _BAR_REACH), max(a[0], b[0])),
        min(floor(box[3] + _BAR_REACH), max(a[1], b[1])),
        min(run[HHI], b[2]),
    )
    return lo, hi


@part
def to_frame(p: Ints, frame: Frame) -> Point:
    return (
        frame.sign_x * (p[frame.axis_x] - frame.x0),
        frame.sign_y * (p[frame.axis_y] - frame.y0),
        p[frame.axis_h] - frame.h0,
    )


@part
def _look_up(
    court: Court,
    run: Ints,
    turning: bool,
    limb: tuple[int, int],
    frame: Frame,
    lo: Point,
    hi: Point,
) -> None:
    """Compare a moving run with the bars of the body that have a joint in these cells."""
    nearest, farthest = 0.0, np.inf
    if turning:
        nearest, farthest = max(0.0, inner(run) - _BAR_REACH), outer(run) + _BAR_REACH
    nearest, farthest = nearest * nearest, farthest * farthest
    at = court.place
    for x in range(lo[0], hi[0] + 1):
        at[frame.axis_x] = frame.x0 + frame.sign_x * x
        for y in range(lo[1], hi[1] + 1):
            if not nearest <= x * x + y * y <= farthest:
                continue
            at[frame.axis_y] = frame.y0 + frame.sign_y * y
            for h in range(lo[2], hi[2] + 1):
                at[frame.axis_h] = frame.h0 + h
                joint = find(court.chain, at[0], at[1], at[2])
                if joint >= 0:
                    _meet_bar(court, run, joint - 1, turning, limb, frame)
                    _meet_bar(court, run, joint, turning, limb, frame)


@part
def _widen(extent: Floats, box: Box, frame: Frame) -> None:
    """Widen the extent of a motion by a box of a frame."""
    u, v = frame.x0 + frame.sign_x * box[0], frame.x0 + frame.sign_x * box[2]
    extent[0, frame.axis_x] = min(extent[0, frame.axis_x], u, v)
    extent[1, frame.axis_x] = max(extent[1, frame.axis_x], u, v)
    u, v = frame.y0 + frame.sign_y * box[1], frame.y0 + frame.sign_y * box[3]
    extent[0, frame.axis_y] = min(extent[0, frame.axis_y], u, v)
    extent[1, frame.axis_y] = max(extent[1, frame.axis_y], u, v)
