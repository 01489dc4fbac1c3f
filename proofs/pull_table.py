"""The finite table behind the pull-through lemma, proven by interval arithmetic.

    python proofs/pull_table.py

Numbers are enclosed between two floating-point numbers, each operation rounded outwards to the
next one beyond; addition, subtraction, multiplication, division and square root are the only
ones used, which IEEE 754 rounds correctly. Two bars keep a distance if some direction separates
their four ends by it: whichever direction is tried, the proof stands. Boxes of phases in which it
is not found are bisected until it is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

ROUND_CORNERS, ROUND_US = 0.9142, 0.866
LEAST_COSINE_ROUND_US = -0.500001
ROUNDING = 1e-12
"""Cosines are proven to be above their bound less this."""

REACH = 3
"""Triples with the middle vertices this far apart along an axis have a slab of width 1 between."""

DIRECTIONS = np.vstack([np.eye(3), -np.eye(3)])
MOST_BISECTIONS = 60
CHUNK = 200_000


@dataclass
class Interval:
    """Real numbers known to lie from `low` to `high`, arrays of one shape."""

    low: Floats
    high: Floats

    def __add__(self, other: Interval) -> Interval:
        return _outwards(self.low + other.low, self.high + other.high)

    def __sub__(self, other: Interval) -> Interval:
        return _outwards(self.low - other.high, self.high - other.low)

    def __mul__(self, other: Interval) -> Interval:
        products = [a * b for a in (self.low, self.high) for b in (other.low, other.high)]
        return _outwards(np.minimum.reduce(products), np.maximum.reduce(products))

    def __truediv__(self, positive: Interval) -> Interval:
        ratios = [a / b for a in (self.low, self.high) for b in (positive.low, positive.high)]
        return _outwards(np.minimum.reduce(ratios), np.maximum.reduce(ratios))

    def __getitem__(self, key: Any) -> Interval:
        return Interval(self.low[key], self.high[key])

    def total(self) -> Interval:
        """Sum of the three coordinates, the last axis."""
        return self[..., 0] + self[..., 1] + self[..., 2]

    def middle(self) -> Floats:
        return (self.low + self.high) / 2


Bar = tuple[Interval, Interval]  # its two ends, (N, 3) each


class Outcome(NamedTuple):
    """Of N boxes of phases: which are proven, how loose each phase is, and the value seen."""

    proven: NDArray[np.bool_]
    looseness: Floats
    seen: Floats


class Proof(NamedTuple):
    """How a claim about many cases was proven; `least` is the least value seen on the way."""

    claim: str
    n_cases: int
    n_boxes: int
    least: float


def _outwards(low: Floats, high: Floats) -> Interval:
    return Interval(np.nextafter(low, -np.inf), np.nextafter(high, np.inf))


def exactly(numbers: Floats) -> Interval:
    return Interval(numbers, numbers)


def rising(function: Callable[[Interval], Interval], over: Interval) -> Interval:
    """The values of a function that never falls."""
    return Interval(function(exactly(over.low)).low, function(exactly(over.high)).high)


def sine(half_tangent: Interval) -> Interval:
    """2t / (1 + t^2), which rises from 0 to 1 with t."""
    one = exactly(np.ones_like(half_tangent.low))
    return rising(lambda t: (t + t) / (one + t * t), half_tangent)


def versine(half_tangent: Interval) -> Interval:
    """1 - (1 - t^2) / (1 + t^2) = 2t^2 / (1 + t^2), which rises from 0 to 1 with t."""
    one = exactly(np.ones_like(half_tangent.low))
    return rising(lambda t: (t * t + t * t) / (one + t * t), half_tangent)


def past_a_corner(phase: Interval) -> Interval:
    """g(p) = sqrt(p (2 - p)), which rises from 0 to 1 with p."""
    two = exactly(np.full_like(phase.low, 2.0))

    def g(p: Interval) -> Interval:
        square = p * (two - p)
        return _outwards(np.sqrt(np.maximum(square.low, 0)), np.sqrt(np.maximum(square.high, 0)))

    return rising(g, phase)


def chosen(which: NDArray[np.bool_], one: Interval, other: Interval) -> Interval:
    return Interval(np.where(which, one.low, other.low), np.where(which, one.high, other.high))


def times(steps: Floats, share: Interval) -> Interval:
    """Lattice steps (N, 3), each times its share."""
    return exactly(steps) * share[:, None]


def along(direction: Floats, bar: Bar) -> Interval:
    """Where the two ends of each bar lie along its direction, (N, 2)."""
    ends = [(exactly(direction) * end).total() for end in bar]
    return Interval(
        np.stack([end.low for end in ends], axis=1), np.stack([end.high for end in ends], axis=1)
    )


def judged(one: Bar, other: Bar, least: float) -> Outcome:
    """Whether each pair of bars is proven to keep the distance `least`."""
    direction = _across(one, other)
    behind, ahead = along(direction, one), along(direction, other)
    gap = exactly(ahead.low.min(axis=1)) - exactly(behind.high.max(axis=1))
    norm = (exactly(direction) * exactly(direction)).total()
    wanted = exactly(np.full(len(direction), least))
    proven = (gap.low > 0) & ((gap * gap).low >= (wanted * wanted * norm).high)
    looseness = np.stack([(i.high - i.low).max(axis=1) for i in (behind, ahead)], axis=1)
    return Outcome(proven, looseness, np.linalg.norm(direction, axis=1))


def _across(one: Bar, other: Bar) -> Floats:
    """From the nearest point of one bar to that of the other, all phases in the middle."""
    p, q = (end.middle() for end in one)
    r, s = (end.middle() for end in other)
    best = np.full(len(p), np.inf)
    across = np.ones_like(p)

    def consider(a: Floats, b: Floats, valid: NDArray[np.bool_]) -> None:
        length = np.where(valid, np.linalg.norm(b - a, axis=1), np.inf)
        nearer = length < best
        best[nearer], across[nearer] = length[nearer], (b - a)[nearer]

    every = np.ones(len(p), bool)
    for end in (p, q):
        consider(end, _nearest(end, r, s), every)
    for end in (r, s):
        consider(_nearest(end, p, q), end, every)
    u, v, w = q - p, s - r, p - r
    uu, uv, vv = ((a * b).sum(axis=1) for a, b in ((u, u), (u, v), (v, v)))
    uw, vw = (u * w).sum(axis=1), (v * w).sum(axis=1)
    area = uu * vv - uv * uv
    skew = area > 1e-9
    area = np.where(skew, area, 1)
    x, y = (uv * vw - vv * uw) / area, (uu * vw - uv * uw) / area
    inside = skew & (x > 0) & (x < 1) & (y > 0) & (y < 1)
    consider(p + x[:, None] * u, r + y[:, None] * v, inside)
    return across


def _nearest(point: Floats, a: Floats, b: Floats) -> Floats:
    """The point of segment ab nearest to a point."""
    along = b - a
    share = ((point - a) * along).sum(axis=1) / (along * along).sum(axis=1)
    nearest: Floats = a + np.clip(share, 0, 1)[:, None] * along
    return nearest


def proof(claim: str, n_cases: int, n_phases: int, judge: Callable[..., Outcome]) -> Proof:
    """Bisect the phases of every case, half tangents from 0 to 1, until all boxes are proven."""
    case = np.arange(n_cases)
    low, high = np.zeros((n_cases, n_phases)), np.ones((n_cases, n_phases))
    n_boxes, least = 0, np.inf
    for _ in range(MOST_BISECTIONS):
        left = []
        for first in range(0, len(case), CHUNK):
            part = slice(first, first + CHUNK)
            outcome = judge(case[part], Interval(low[part], high[part]))
            inside = judge(case[part], exactly((low[part] + high[part]) / 2))
            n_boxes += len(outcome.proven)
            least = min(least, float(inside.seen.min()))
            open_ = first + np.flatnonzero(~outcome.proven)
            left.append(np.stack([open_, outcome.looseness[open_ - first].argmax(axis=1)]))
        box, phase = np.concatenate(left, axis=1)
        if not len(box):
            return Proof(claim, n_cases, n_boxes, least)
        case = np.repeat(case[box], 2)
        low, high = np.repeat(low[box], 2, axis=0), np.repeat(high[box], 2, axis=0)
        middle = (low[::2] + high[::2]) / 2
        row = np.arange(len(box))
        high[2 * row, phase] = low[2 * row + 1, phase] = middle[row, phase]
    raise ArithmeticError(f"{claim}: {len(case)} boxes are left unproven")


def disjoint_triples(f: Floats) -> Floats:
    """Rows (middle, e, f): triples that share no vertex with that of edges x and `f`.

    A triple runs from middle - e by middle to middle + f.
    """
    x = DIRECTIONS[0]
    base = {tuple(v) for v in (-x, 0 * x, f)}
    rows = []
    for a, b in product(range(6), repeat=2):
        for middle in product(range(-REACH, REACH + 1), repeat=3):
            v = np.array(middle, float)
            triple = map(tuple, (v - DIRECTIONS[a], v, v + DIRECTIONS[b]))
            if b != (a + 3) % 6 and base.isdisjoint(triple):
                rows.append((v, DIRECTIONS[a], DIRECTIONS[b]))
    return np.array(rows)


def bar_of(triple: Floats, half_tangent: Interval) -> Bar:
    """The bar on each triple (N, 3, 3): from phase p before its middle to g(p), or p, past it."""
    middle, e, f = (triple[:, k] for k in range(3))
    before, past = versine(half_tangent), sine(half_tangent)
    past = chosen((e == f).all(axis=1), before, past)
    return exactly(middle - e) + times(e, before), exactly(middle) + times(f, past)


def beside_a_straight() -> Proof:
    """A bar on a straight triple and any other, each at any phase of its own."""
    x = DIRECTIONS[0]
    others = disjoint_triples(x)
    base = np.array([0 * x, x, x])

    def judge(case: Indices, half_tangents: Interval) -> Outcome:
        one = bar_of(np.broadcast_to(base, (len(case), 3, 3)), half_tangents[:, 0])
        other = bar_of(others[case], half_tangents[:, 1])
        return judged(one, other, ROUND_CORNERS)

    claim = f"bars three or more apart, one straight: distance >= {ROUND_CORNERS}"
    return proof(claim, len(others), 2, judge)


def corners_passed(later: Floats) -> Indices:
    """How many corners at least lie between the phases on two corners x, y and `later`.

    With k of them the later phase is g(g(..g(p))), k times, of the earlier one. It is 1 if the
    track runs straight from one corner to the other, 2 if it can turn once between, else 3 or
    more.
    """
    y = DIRECTIONS[1]
    middle, e = later[:, 0], later[:, 1]
    on_y, on_e = middle @ y, (middle * e).sum(axis=1)
    straight = (e == y).all(axis=1) & (middle == on_y[:, None] * y).all(axis=1) & (on_y > 0)
    turned = (e @ y == 0) & (on_y > 0) & (on_e > 0)
    turned &= (middle == on_y[:, None] * y + on_e[:, None] * e).all(axis=1)
    return np.where(straight, 1, np.where(turned, 2, 3))


def corner_beside_corner() -> Proof:
    """A bar on a corner and a later one on a corner, at phases that one track can have."""
    x, y = DIRECTIONS[:2]
    later = disjoint_triples(y)
    later = later[(later[:, 1] != later[:, 2]).any(axis=1)]
    base, n_passed = np.array([0 * x, x, y]), corners_passed(later)

    def judge(case: Indices, half_tangents: Interval) -> Outcome:
        one = bar_of(np.broadcast_to(base, (len(case), 3, 3)), half_tangents[:, 0])
        other = bar_of(later[case], half_tangents[:, 1])
        least = sine(half_tangents[:, 0])
        for k in (2, 3):
            least = chosen(n_passed[case] >= k, past_a_corner(least), least)
        impossible = versine(half_tangents[:, 1]).high < least.low
        outcome = judged(one, other, ROUND_CORNERS)
        return outcome._replace(
            proven=outcome.proven | impossible, seen=np.where(impossible, np.inf, outcome.seen)
        )

    claim = f"bars three or more apart, both on corners: distance >= {ROUND_CORNERS}"
    return proof(claim, len(later), 2, judge)


def tracks(n_edges: int, *, with_us: bool) -> Floats:
    """All simple lattice tracks (K, n_edges, 3) that begin along x, with a U or without."""
    found = []
    for word in product(range(6), repeat=n_edges - 1):
        edges = DIRECTIONS[[0, *word]]
        vertices = np.vstack([np.zeros(3), edges.cumsum(axis=0)])
        has_u = any((edges[k] == -edges[k + 2]).all() for k in range(n_edges - 2))
        if len(np.unique(vertices, axis=0)) == n_edges + 1 and has_u == with_us:
            found.append(edges)
    return np.array(found)


def joints_on(edges: Floats, half_tangent: Interval) -> list[Interval]:
    """The joints on edge after edge of each track (N, K, 3), the first at the phase given."""
    starts = np.cumsum(edges, axis=1) - edges
    phase = versine(half_tangent)
    joints = [exactly(starts[:, 0]) + times(edges[:, 0], phase)]
    for k in range(1, edges.shape[1]):
        straight = (edges[:, k] == edges[:, k - 1]).all(axis=1)
        phase = chosen(straight, phase, past_a_corner(phase))
        joints.append(exactly(starts[:, k]) + times(edges[:, k], phase))
    return joints


def two_apart(*, with_us: bool) -> Proof:
    edges = tracks(4, with_us=with_us)
    least = ROUND_US if with_us else ROUND_CORNERS

    def judge(case: Indices, half_tangent: Interval) -> Outcome:
        a, b, c, d = joints_on(edges[case], half_tangent[:, 0])
        outcome = judged((a, b), (c, d), least)
        return outcome._replace(looseness=outcome.looseness[:, :1])

    which = "some" if with_us else "no"
    return proof(f"bars two apart, {which} U: distance >= {least}", len(edges), 1, judge)


def one_apart(*, with_us: bool) -> Proof:
    edges = tracks(3, with_us=with_us)
    least = LEAST_COSINE_ROUND_US if with_us else -ROUNDING

    def judge(case: Indices, half_tangent: Interval) -> Outcome:
        a, b, c = joints_on(edges[case], half_tangent[:, 0])
        cosine = ((b - a) * (c - b)).total()
        return Outcome(cosine.low >= least, half_tangent.high, cosine.middle())

    which = "some" if with_us else "no"
    return proof(f"joints, {which} U: cosine of the bend >= {least}", len(edges), 1, judge)


def report(proofs: list[Proof]) -> str:
    lines = [
        "# The table behind the pull-through lemma",
        "",
        "`python proofs/pull_table.py` wrote this. Every line is proven by interval arithmetic for",
        "all phases; the last column is the least value at the middles of the boxes.",
        "",
        "| claim | cases | boxes of phases | least seen |",
        "|---|---|---|---|",
        *(f"| {p.claim} | {p.n_cases:,} | {p.n_boxes:,} | {p.least:.6f} |" for p in proofs),
    ]
    return "\n".join(lines) + "\n"


def main() -> None:
    proofs = [beside_a_straight(), corner_beside_corner()]
    proofs += [two_apart(with_us=with_us) for with_us in (False, True)]
    proofs += [one_apart(with_us=with_us) for with_us in (False, True)]
    page = report(proofs)
    out = Path(__file__).parents[1] / "experiments" / "results" / "pull_table.md"
    out.write_text(page)
    print(page)


if __name__ == "__main__":
    main()
