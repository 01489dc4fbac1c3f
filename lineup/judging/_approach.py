"""How near bars come while each turns evenly in time about one axis: a proof by halving the time.

Seen along the axis every bar is a unit segment, or a point, at a level that stays what it is, and
levels are whole: only bars that share a level can come nearer than 1. Write plane vectors as
complex numbers. In a frame that turns at rate w, the vector between two joints at a time s from
the middle of an interval is the sum of exp(i (a + u s)) over the bars between them, a their angles
in the middle and u their rates less w. Its Taylor series to the third order needs the sums of
u^m exp(i a), which prefix sums give for any two joints and any w; the rest is at most s^4 / 24
times the sum of u^4. Two bars are no nearer than along any one direction, and along one direction
two of their ends are nearest. So the four vectors between their ends, along the direction from one
bar to the other in the middle of the interval, bound their distance on all of it.

Most pairs are told apart in bulk, by a binary tree over the chain: its nodes know the ranges of
places, speeds and accelerations of their joints along four directions. What is not settled on an
interval is looked at again on its two halves.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel

Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]

FINE, TOUCH, UNDECIDED = range(3)
"""Verdicts on one pair or on all: shown to keep clear, found too near, neither."""

RESOLUTION = 1e-4
"""The clearance shown is never above the smallest distance, and at most this much below it."""

_ROUNDING = 1e-9
_MOST_HALVINGS, _MOST_INTERVALS = 40, 10_000
_MOST_OPEN, _MOST_SEEN = 16, 256  # pairs for each bar; an interval with more is halved at once
_LEAF = 4  # bars
_AXES = np.exp(0.25j * np.pi * np.arange(4))
_ALL = -1
_LOW, _HIGH, _FIRST, _LAST = range(4)  # columns of spans: levels, then joints


class Turn(NamedTuple):
    """Bars that turn evenly in time about one axis, from time 0 to 1.

    Attributes
    ----------
    angles, rates : (N,) float64
        Angle of each bar at time 0 and its growth until time 1, in radians.
    across : (N,) bool
        Whether a bar lies across the axis; the others rest along it.
    levels : (N + 1,) int64
        Where the joints are along the axis.
    sharp : (N + 1,) bool
        Joints that bend by more than 90 degrees at some time. Bars k and k + 2 stay exactly 1
        apart unless joint k + 1 or k + 2 is one.
    """

    angles: Floats
    rates: Floats
    across: Bools
    levels: Ints
    sharp: Bools


class Tally(NamedTuple):
    """What the pairs looked at so far have shown; 1 and more are not told apart."""

    diameter: float
    attained: Floats  # (1,) a distance that two bars came to
    clearance: Floats  # (1,) one that none went below
    bars: Ints  # (2,) the pair that lowered it last


@kernel
def approach(turn: Turn, diameter: float, clearance: float) -> tuple[int, float, float, int, int]:
    """Prove that bars two or more apart keep the diameter from one another at all times.

    Parameters
    ----------
    clearance : float
        At most 1. How far above this the distances are does not matter.

    Returns
    -------
    verdict : int
    clearance : float
        A distance that no two bars go below, or the one given, if that is less; after `TOUCH` and
        `UNDECIDED` a distance met. It ends at most `RESOLUTION` below the smallest distance.
    time, bar_a, bar_b : float, int, int
        After `FINE` the bars are those that lowered the clearance, -1 if none did. Otherwise they
        are at fault at that time. What is `UNDECIDED` is so close to the diameter, or so fast,
        that the intervals given to the proof do not do.
    """
    tally = Tally(diameter, np.ones(1), np.array([clearance]), np.array([-1, -1]))
    n_bars = len(turn.angles)
    powers, spans = _powers(turn), _spans(turn.levels)
    tree = np.empty((len(spans), 3, 4, 2))
    moments = np.empty((n_bars + 1, 4), np.complex128)
    pairs = np.empty((2 * _MOST_OPEN * n_bars, 2), np.int64)
    intervals = [(0, 0, 0, _ALL)]  # halvings, number, and rows first .. last - 1 of pairs
    time, bar_a, bar_b = 0.5, -1, -1
    for _ in range(_MOST_INTERVALS):
        halvings, number, first, last = intervals.pop()
        half = 0.5 / 2.0**halvings
        time = (2 * number + 1) * half
        _set_moments(turn, powers, time, moments)
        if last == _ALL:
            begin = 0
            _set_tree(moments, spans, tree)
            touching, end = _sift_all(turn, tree, spans, moments, powers, half, tally, pairs)
        else:
            begin = last
            if 2 * last - first > len(pairs):
                pairs = np.concatenate((pairs, np.empty_like(pairs)))
            touching, end = _sift(pairs, first, last, moments, powers, half, tally)
        if end != begin:
            bar_a, bar_b = pairs[begin]
            if touching:
                return TOUCH, tally.attained[0], time, bar_a, bar_b
            if halvings == _MOST_HALVINGS:
                break
            intervals.append((halvings + 1, 2 * number + 1, begin, end))
            intervals.append((halvings + 1, 2 * number, begin, end))
        elif not intervals:
            return FINE, tally.clearance[0], time, tally.bars[0], tally.bars[1]
    return UNDECIDED, tally.attained[0], time, bar_a, bar_b


@kernel
def _powers(turn: Turn) -> Floats:
    """Sums of u^0 .. u^4 and |u|^3 over the bars across, up to each joint; u is rate less mean."""
    rates, across = turn.rates, turn.across
    mean = rates[across].mean() if across.any() else 0.0
    sums = np.zeros((len(rates) + 1, 6))
    for bar in range(len(rates)):
        sums[bar + 1] = sums[bar]
        if across[bar]:
            u = rates[bar] - mean
            for m in range(5):
                sums[bar + 1, m] += u**m
            sums[bar + 1, 5] += abs(u) ** 3
    return sums


@kernel
def _set_moments(turn: Turn, powers: Floats, time: float, moments: Complexes) -> None:
    """Sums of u^m exp(i a) over the bars across, up to each joint, for m = 0 .. 3."""
    moments[0] = 0
    for bar in range(len(turn.angles)):
        moments[bar + 1] = moments[bar]
        if turn.across[bar]:
            angle = turn.angles[bar] + time * turn.rates[bar]
            term = complex(np.cos(angle), np.sin(angle))
            u = powers[bar + 1, 1] - powers[bar, 1]
            for m in range(4):
                moments[bar + 1, m] += term
                term *= u


@kernel
def _spans(levels: Ints) -> Ints:
    """Levels and joints, from .. to, of the nodes of a heap over the bars."""
    n_bars = len(levels) - 1
    n_leaves = 1
    while n_leaves * _LEAF < n_bars:
        n_leaves *= 2
    spans = np.empty((2 * n_leaves, 4), np.int64)
    for node in range(2 * n_leaves - 1, 0, -1):
        if node >= n_leaves:
            first = min((node - n_leaves) * _LEAF, n_bars)
            last = min(first + _LEAF, n_bars)
            inside = levels[first : last + 1]
            spans[node] = np.array((inside.min(), inside.max(), first, last))
        else:
            a, b = spans[2 * node], spans[2 * node + 1]
            low, high = min(a[_LOW], b[_LOW]), max(a[_HIGH], b[_HIGH])
            spans[node] = np.array((low, high, a[_FIRST], b[_LAST]))
    return spans


@kernel
def _set_tree(moments: Complexes, spans: Ints, tree: Floats) -> None:
    """Range of place, speed and acceleration of each node's joints along each axis."""
    n_leaves = len(spans) // 2
    for node in range(len(spans) - 1, 0, -1):
        if node < n_leaves:
            for order in range(3):
                for axis in range(4):
                    a, b = tree[2 * node, order, axis], tree[2 * node + 1, order, axis]
                    tree[node, order, axis, 0] = min(a[0], b[0])
                    tree[node, order, axis, 1] = max(a[1], b[1])
            continue
        tree[node, :, :, 0], tree[node, :, :, 1] = np.inf, -np.inf
        for joint in range(spans[node, _FIRST], spans[node, _LAST] + 1):
            for order in range(3):
                vector = 1j**order * moments[joint, order]
                for axis in range(4):
                    along = _along(_AXES[axis], vector)
                    reach = tree[node, order, axis]
                    reach[0], reach[1] = min(reach[0], along), max(reach[1], along)


@kernel
def _along(direction: complex, vector: complex) -> float:
    return direction.real * vector.real + direction.imag * vector.imag


@kernel
def _sift_all(
    turn: Turn,
    tree: Floats,
    spans: Ints,
    moments: Complexes,
    powers: Floats,
    half: float,
    tally: Tally,
    pairs: Ints,
) -> tuple[bool, int]:
    """As `_sift` does, for all pairs of bars; the end is `_ALL` if they are too many."""
    n_bars, n_leaves = len(turn.angles), len(spans) // 2
    end, seen = 0, 0
    stack = [(1, 1)]
    while stack:
        i, j = stack.pop()
        if i != j and _apart(tree, spans, powers, half, i, j):
            continue
        if i < n_leaves:
            stack.append((2 * i, 2 * j))
            stack.append((2 * i, 2 * j + 1))
            stack.append((2 * i + 1, 2 * j + 1))
            if i != j:
                stack.append((2 * i + 1, 2 * j))
            continue
        for a in range(spans[i, _FIRST], spans[i, _LAST]):
            for b in range(max(a + 2, spans[j, _FIRST]), spans[j, _LAST]):
                if _never_near(turn, a, b):
                    continue
                verdict = _verdict(moments, powers, half, tally, a, b)
                if verdict == TOUCH:
                    pairs[0] = a, b
                    return True, 1
                pairs[end] = a, b
                end += verdict == UNDECIDED
                seen += 1
        if end > _MOST_OPEN * n_bars or seen > _MOST_SEEN * n_bars:
            return False, _ALL
    return False, end


@kernel
def _sift(
    pairs: Ints,
    first: int,
    last: int,
    moments: Complexes,
    powers: Floats,
    half: float,
    tally: Tally,
) -> tuple[bool, int]:
    """Copy those of the pairs first .. last - 1 that stay open to rows last .. end - 1.

    Returns
    -------
    touching : bool
        Whether two bars are too near in the middle of the interval; row `last` says which.
    end : int
    """
    end = last
    for row in range(first, last):
        verdict = _verdict(moments, powers, half, tally, pairs[row, 0], pairs[row, 1])
        if verdict == TOUCH:
            pairs[last] = pairs[row]
            return True, last + 1
        if verdict == UNDECIDED:
            pairs[end] = pairs[row]
            end += 1
    return False, end


@kernel
def _never_near(turn: Turn, a: int, b: int) -> bool:
    """Whether bars a < b share no level, or are two apart and never bend sharply."""
    if b == a + 2 and not (turn.sharp[a + 1] or turn.sharp[a + 2]):
        return True
    a0, a1, b0, b1 = turn.levels[a], turn.levels[a + 1], turn.levels[b], turn.levels[b + 1]
    return bool(max(a0, a1) < min(b0, b1) or max(b0, b1) < min(a0, a1))


@kernel
def _apart(tree: Floats, spans: Ints, powers: Floats, half: float, i: int, j: int) -> bool:
    """Whether the bars of nodes i < j keep 1 apart during the interval, by their ranges alone."""
    a, b = spans[i], spans[j]
    if a[_HIGH] < b[_LOW] or b[_HIGH] < a[_LOW]:
        return True
    rest = half**3 / 6 * (powers[b[_LAST], 5] - powers[a[_FIRST], 5])
    for axis in range(4):
        x, y = tree[i, 0, axis], tree[j, 0, axis]
        gap = max(y[0] - x[1], x[0] - y[1]) - rest
        for order in range(1, 3):
            x, y = tree[i, order, axis], tree[j, order, axis]
            gap -= half**order / order * max(y[1] - x[0], x[1] - y[0])
        if gap >= 1:
            return True
    return False


@kernel
def _verdict(moments: Complexes, powers: Floats, half: float, tally: Tally, a: int, b: int) -> int:
    """What an interval shows of bars a and b, noted in the tally."""
    direction, distance = _towards(
        moments[a, 0], moments[a + 1, 0], moments[b, 0], moments[b + 1, 0]
    )
    tally.attained[0] = min(tally.attained[0], distance)
    if distance < tally.diameter - _ROUNDING:
        return TOUCH
    shown = _ROUNDING + _lower_bound(moments, powers, half, direction, a, b)
    if shown < max(tally.diameter, min(tally.clearance[0], tally.attained[0] - RESOLUTION)):
        return UNDECIDED
    if shown < tally.clearance[0]:
        tally.clearance[0] = shown
        tally.bars[:] = a, b
    return FINE


@kernel
def _lower_bound(
    moments: Complexes, powers: Floats, half: float, direction: complex, a: int, b: int
) -> float:
    """A distance that bars a < b keep along a direction that turns as those between, on average."""
    w = (powers[b, 1] - powers[a + 1, 1]) / (powers[b, 0] - powers[a + 1, 0])
    s = powers[b + 1] - powers[a]
    fourth = s[4] - 4 * w * s[3] + 6 * w**2 * s[2] - 4 * w**3 * s[1] + w**4 * s[0]
    least = np.inf
    for i in range(a, a + 2):
        for j in range(b, b + 2):
            e = moments[j] - moments[i]
            speed = e[1] - w * e[0]
            acceleration = e[2] - 2 * w * e[1] + w**2 * e[0]
            jerk = e[3] - 3 * w * e[2] + 3 * w**2 * e[1] - w**3 * e[0]
            ends = (
                _along(direction, e[0])
                - half * abs(_along(direction, 1j * speed))
                - half**2 / 2 * max(0.0, _along(direction, acceleration))
                - half**3 / 6 * abs(_along(direction, 1j * jerk))
            )
            least = min(least, ends)
    return float(least - half**4 / 24 * max(0.0, fourth))


@kernel
def _towards(p: complex, q: complex, r: complex, s: complex) -> tuple[complex, float]:
    """Unit vector from the segment p q to the segment r s where they are nearest, and how near."""
    if _side(p, q, r) * _side(p, q, s) < 0 and _side(r, s, p) * _side(r, s, q) < 0:
        return 1.0 + 0.0j, 0.0
    best = _to_segment(p, r, s)
    for way in (_to_segment(q, r, s), -_to_segment(r, p, q), -_to_segment(s, p, q)):
        if abs(way) < abs(best):
            best = way
    distance = abs(best)
    return (best / distance if distance > 0 else 1.0 + 0.0j), distance


@kernel
def _side(p: complex, q: complex, r: complex) -> float:
    return ((q - p).conjugate() * (r - p)).imag


@kernel
def _to_segment(p: complex, r: complex, s: complex) -> complex:
    """The vector from a point to the nearest point of the segment r s, which may be a point."""
    if r == s:
        return r - p
    share = _along(s - r, p - r) / _along(s - r, s - r)
    return r + min(1.0, max(0.0, share)) * (s - r) - p
