"""Closed forms for the judge: how near two straight runs come while a move turns one of them.

Every PEEL, SWING and DOOR starts from a lattice pose and turns by 90 degrees in the plane of two
lattice axes, from axis e to axis d. In the frame (x, y, h) with x along e, y along d and h along
the third axis, distances along h stay as they are, and h is an integer: only runs that share a
height can come nearer than 1. What is left is plane geometry between axis-parallel boxes with
integer corners (a straight run of bars is a thin box) and quarter arcs about the origin, so the
smallest distance over the whole turn is exact up to rounding. Distances of 1 or more are not
told apart: bars k and k + 2 are never more than 1 apart, so 1 is the largest clearance there is.

A run is a row of nine integers: the lowest and the highest x, y and h of its centre line, its
first and its last bar, and 1 or -1 as its coordinates grow or fall with the number of the bar.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel, part

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Box = tuple[float, float, float, float]  # xlo, ylo, xhi, yhi

XLO, YLO, HLO, XHI, YHI, HHI, FIRST, LAST, GROWS = range(9)
_OUTSIDE_CONE = -1e-9
_ROUNDING = 1e-12


class Nearest(NamedTuple):
    """The nearest that two runs have come so far."""

    distance: Floats  # (1,) capped at 1
    runs: Ints  # (2, 9) the run that moved and the one that it came near
    turning: Ints  # (1,) whether it turned (1) or slid (0)


@part
def write(out: Ints, numbers: Ints) -> None:
    """Write numbers one by one, which compiles in no time, as an assignment to a slice does not."""
    for k in range(len(out)):
        out[k] = numbers[k]


@part
def compare(moving: Ints, resting: Ints, turning: bool, nearest: Nearest) -> None:
    """Take note of how near any of the runs `moving` comes to any of the runs `resting`."""
    for i in range(len(moving)):
        for k in range(len(resting)):
            meet(moving[i], resting[k], turning, nearest)


@part
def meet(m: Ints, r: Ints, turning: bool, nearest: Nearest) -> None:
    """Take note of how near run m comes to run r while it turns by a quarter, or slides."""
    if not _share_a_height(m, r):
        return
    if m[FIRST] - r[LAST] < 2 and r[FIRST] - m[LAST] < 2:
        return
    distance = _distance(m, r, turning)
    if distance < nearest.distance[0]:
        nearest.distance[0] = distance
        write(nearest.runs[0], m)
        write(nearest.runs[1], r)
        nearest.turning[0] = turning


@part
def _share_a_height(m: Ints, r: Ints) -> bool:
    return bool(m[HLO] <= r[HHI] and r[HLO] <= m[HHI])


@part
def nearest_bars(nearest: Nearest, bars: Ints) -> tuple[int, int]:
    """The two bars, in the nearest two runs, that come as near as that; the lower one first.

    `bars` is room for two runs.
    """
    m, r, one, other = nearest.runs[0], nearest.runs[1], bars[0], bars[1]
    turning, enough = bool(nearest.turning[0]), nearest.distance[0] + _ROUNDING
    for bar in range(m[FIRST], m[LAST] + 1):
        _narrow(m, bar, one)
        if _share_a_height(one, r) and _distance(one, r, turning) <= enough:
            break
    for bar in range(r[FIRST], r[LAST] + 1):
        _narrow(r, bar, other)
        if _share_a_height(one, other) and _distance(one, other, turning) <= enough:
            break
    return min(one[FIRST], other[FIRST]), max(one[FIRST], other[FIRST])


@part
def _narrow(run: Ints, bar: int, out: Ints) -> None:
    """One bar of a run, as a run."""
    write(out, run)
    out[FIRST] = out[LAST] = bar
    k = bar - run[FIRST] if run[GROWS] > 0 else run[LAST] - bar
    for axis in range(3):
        if run[axis] < run[axis + 3]:
            out[axis] = run[axis] + k
            out[axis + 3] = run[axis] + k + 1


@part
def swept_box(run: Ints, turning: bool) -> Box:
    """What a run sweeps in the plane lies in this box and touches each of its sides."""
    if not turning:
        return run[XLO] - 1.0, float(run[YLO]), float(run[XHI]), run[YHI] + 1.0
    a, b = _arc_box(run[XLO], run[YLO]), _arc_box(run[XHI], run[YHI])
    return min(a[0], b[0]), min(a[1], b[1]), max(a[2], b[2]), max(a[3], b[3])


@part
def _arc_box(x: int, y: int) -> Box:
    """The box of the quarter arc, counter-clockwise from (x, y) to (-y, x)."""
    radius = sqrt(float(x * x + y * y))
    return (
        -radius if x < 0 < y else float(min(x, -y)),
        -radius if x < 0 and y < 0 else float(min(y, x)),
        radius if y < 0 < x else float(max(x, -y)),
        radius if x > 0 and y > 0 else float(max(y, x)),
    )


@part
def _distance(m: Ints, r: Ints, turning: bool) -> float:
    return turn_distance(m, r) if turning else slide_distance(m, r)


@kernel
def slide_distance(m: Ints, r: Ints) -> float:
    """Smallest distance while run m slides along the unit arc from (1, 0) to (0, 1).

    They meet where the arc's point lies in the Minkowski difference of the two boxes.
    """
    xlo, xhi = 1 + r[XLO] - m[XHI], 1 + r[XHI] - m[XLO]
    ylo, yhi = r[YLO] - m[YHI], r[YHI] - m[YLO]
    if xlo > 1 or xhi < 0 or ylo > 1 or yhi < 0:
        return 1.0
    return _arc_to_box(1, 0, xlo, ylo, xhi, yhi)


@kernel
def turn_distance(m: Ints, r: Ints) -> float:
    """Smallest distance while run m turns by a quarter, counter-clockwise about the origin.

    The first contact of two segments in a plane is made by an end of one of them, and so is
    every smallest distance: four arcs tell, the ends of r running backwards.
    """
    if inner(r) >= outer(m) + 1 or inner(m) >= outer(r) + 1:
        return 1.0
    gap_x = max(0, r[XLO] - m[XHI], m[XLO] - r[XHI])
    gap_y = max(0, r[YLO] - m[YHI], m[YLO] - r[YHI])
    best = sqrt(float(gap_x * gap_x + gap_y * gap_y))
    for end in range(2):
        x, y = m[3 * end], m[3 * end + 1]
        best = min(best, _arc_to_box(x, y, r[XLO], r[YLO], r[XHI], r[YHI]))
        x, y = r[3 * end], r[3 * end + 1]
        best = min(best, _arc_to_box(y, -x, m[XLO], m[YLO], m[XHI], m[YHI]))
    return best


@part
def inner(run: Ints) -> float:
    """Distance from the origin of the frame's plane to a run."""
    return _to_box(0, 0, run[XLO], run[YLO], run[XHI], run[YHI])


@part
def outer(run: Ints) -> float:
    """Largest distance from the origin of the frame's plane to a run."""
    x = max(abs(run[XLO]), abs(run[XHI]))
    y = max(abs(run[YLO]), abs(run[YHI]))
    return sqrt(float(x * x + y * y))


@part
def _to_box(x: int, y: int, xlo: int, ylo: int, xhi: int, yhi: int) -> float:
    gap_x, gap_y = max(0, xlo - x, x - xhi), max(0, ylo - y, y - yhi)
    return sqrt(float(gap_x * gap_x + gap_y * gap_y))


@part
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


@part
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
