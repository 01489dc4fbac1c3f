"""How far angles may turn, evenly in time, before bars of a linkage can come too near.

Let joints be at P + tW + R(t) when angle b turns at rate w_b. Taylor's formula for one joint seen
from another gives |R| <= t^2/2 (|A| + S/3) for t <= 1, where A is the difference of their second
derivatives at 0 and S the sum of |w_b|^3 over the bars between them.
"""

from itertools import pairwise

import numpy as np

from .._jit import kernel
from ..grid import FloatArray, IntArray
from ._linkage import Linkage, clearance, placed, radians

ROUNDS = 40
"""Times that the direction in which a pair is kept apart is chosen anew."""

SAMPLES = 8

TOLERANCE = 5e-4
"""How much less than the bars keep may be claimed that they do, so that bounds can be quick."""


def passes(
    linkage: Linkage, before: IntArray, after: IntArray, diameter: float, *, pieces: int = 64
) -> bool:
    """Whether bars surely keep `diameter` while all angles turn evenly from `before` to `after`.

    A turn that needs more than so many `pieces`, each judged by its own bound, does not pass.
    """
    angles, turn = radians(before), radians(after - before)
    for t in np.arange(1, SAMPLES + 1) / SAMPLES:
        if clearance(linkage, placed(angles + t * turn)) < diameter:
            return False
    t = 0.0
    for _ in range(pieces):
        share = safe_share(linkage, angles + t * turn, (1 - t) * turn, diameter)
        if share in (0.0, 1.0):
            return share == 1.0
        t += (1 - t) * share
    return False


def least_clearance(linkage: Linkage, rows: IntArray, tolerance: float = TOLERANCE) -> float:
    """A distance that bars keep while the angles pass through `rows`, low by about `tolerance`."""
    least = clearance(linkage, placed(radians(rows[0]))) - tolerance
    for before, after in pairwise(rows):
        angles, turn, t = radians(before), radians(after - before), 0.0
        while t < 1.0:
            share = safe_share(linkage, angles + t * turn, (1 - t) * turn, least)
            t = 1.0 if share == 1.0 else t + (1 - t) * share
            reached = clearance(linkage, placed(angles + t * turn))
            if reached < least + tolerance / 2:
                least = reached - tolerance
    return least


@kernel
def safe_share(linkage: Linkage, angles: FloatArray, turn: FloatArray, diameter: float) -> float:
    """A share of `turn`, up to 1, in which no pair comes nearer than `diameter`."""
    turn = turn - turn.mean()  # as seen by who turns along: distances stay the same
    place = placed(angles)
    speed, second, third = _derivatives(angles, turn)
    safe = 1.0
    for k in range(linkage.n_apart):
        p, q, r = linkage.pairs[k, 0], linkage.pairs[k, 1], linkage.pairs[k, 2]
        x, y = place[p, 0] - place[q, 0], place[p, 1] - place[q, 1]
        bound = _bound(second, third, p, q)
        vx, vy = speed[p, 0] - speed[q, 0], speed[p, 1] - speed[q, 1]
        reach = diameter + (r - q) + safe * (np.sqrt(vx * vx + vy * vy) + safe * bound / 2)
        if x * x + y * y < reach * reach:
            bound = max(bound, _bound(second, third, p, r))
            safe = _advance(place, speed, p, q, r, bound, diameter, safe)
            if safe <= 0.0:
                return 0.0
    return safe


@kernel
def _derivatives(angles: FloatArray, turn: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """First and second derivative of each joint (m + 1, 2), and bounds of the third, summed."""
    m = len(angles)
    speed, second, third = np.zeros((m + 1, 2)), np.zeros((m + 1, 2)), np.zeros(m + 1)
    for b in range(m):
        c, s, w = np.cos(angles[b]), np.sin(angles[b]), turn[b]
        speed[b + 1, 0] = speed[b, 0] - s * w
        speed[b + 1, 1] = speed[b, 1] + c * w
        second[b + 1, 0] = second[b, 0] - c * w * w
        second[b + 1, 1] = second[b, 1] - s * w * w
        third[b + 1] = third[b] + abs(w) ** 3
    return speed, second, third


@kernel
def _bound(second: FloatArray, third: FloatArray, p: int, q: int) -> float:
    """The factor of t^2/2 that bounds how far joint p, seen from q, leaves its tangent."""
    x, y = second[p, 0] - second[q, 0], second[p, 1] - second[q, 1]
    return np.sqrt(x * x + y * y) + abs(third[p] - third[q]) / 3


@kernel
def _advance(
    place: FloatArray,
    speed: FloatArray,
    p: int,
    q: int,
    r: int,
    bound: float,
    diameter: float,
    most: float,
) -> float:
    """A time, up to `most`, before which joint p and bar q to r keep `diameter`.

    Seen along a fixed direction n, joint p keeps from both ends of the bar at least what it has
    on the tangents less bound t^2/2. So it is safe up to a root of a quadratic; there, n is
    chosen anew.
    """
    t = 0.0
    for _ in range(ROUNDS):
        ux = place[p, 0] - place[q, 0] + t * (speed[p, 0] - speed[q, 0])
        uy = place[p, 1] - place[q, 1] + t * (speed[p, 1] - speed[q, 1])
        wx = place[p, 0] - place[r, 0] + t * (speed[p, 0] - speed[r, 0])
        wy = place[p, 1] - place[r, 1] + t * (speed[p, 1] - speed[r, 1])
        bx, by = ux - wx, uy - wy
        length = bx * bx + by * by
        along = 0.0 if length == 0.0 else min(max((ux * bx + uy * by) / length, 0.0), 1.0)
        nx, ny = ux - along * bx, uy - along * by
        distance = np.sqrt(nx * nx + ny * ny)
        if distance - bound * t * t / 2 <= diameter:
            return t
        nx /= distance
        ny /= distance
        until = _root(place, speed, p, q, nx, ny, bound, diameter)
        until = min(until, _root(place, speed, p, r, nx, ny, bound, diameter))
        if until >= most:
            return most
        if until - t < 1e-3 * most:
            return max(until, t)
        t = until
    return t


@kernel
def _root(
    place: FloatArray,
    speed: FloatArray,
    p: int,
    q: int,
    nx: float,
    ny: float,
    bound: float,
    diameter: float,
) -> float:
    """The last time at which joint p is `diameter` beyond q along (nx, ny), by the bound."""
    over = nx * (place[p, 0] - place[q, 0]) + ny * (place[p, 1] - place[q, 1]) - diameter
    rate = nx * (speed[p, 0] - speed[q, 0]) + ny * (speed[p, 1] - speed[q, 1])
    root = np.sqrt(max(rate * rate + 2 * bound * over, 0.0))
    if rate < 0.0:
        return 2 * over / (root - rate)
    return (rate + root) / bound if bound > 0.0 else np.inf
