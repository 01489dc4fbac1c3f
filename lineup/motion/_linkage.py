"""A lattice path as a planar linkage: its projection along an axis (Section 6, Figures 12 to 14).

Angles are absolute and those of the BEND move: about the axis, right-handed from axis + 1 to
axis + 2, kept in units of `kinematics.TICK` and handed to kernels in radians.
"""

from itertools import combinations
from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..grid import FloatArray, IntArray, bar_directions
from ..kinematics import QUARTER, TICK


class Linkage(NamedTuple):
    """Bars 0..m-1 of a path that lie across `axis`; bar b leads from planar joint b to b + 1.

    Voxels in a row along the axis fall on one planar joint, a composite one. Bars are apart in
    depth, their coordinate along the axis, unless that is the same.
    """

    axis: int
    across: IntArray  # (m,) which bars of the chain they are
    start: IntArray  # (m,) their angles in the path, each less than a full turn from the last
    pairs: IntArray  # (K, 3) joint p and, of its depth, bar q to r without p, or a joint q = r
    n_apart: int  # pairs from here on are a joint and the bar after next, where the bend decides
    corners: IntArray  # (J,) bars b that bar b + 1 follows at the same depth


def project(voxels: IntArray, axis: int) -> Linkage:
    """The linkage of a lattice path (P, 3) seen along `axis`."""
    bars = bar_directions(voxels).astype(np.int32)
    across = np.flatnonzero(bars % 3 != axis).astype(np.int32)
    quarters = (bars[across] % 3 - axis - 1) % 3 + 2 * (bars[across] // 3)
    turns = (np.diff(quarters) + 2) % 4 - 2
    start = QUARTER * np.concatenate([quarters[:1], turns]).cumsum()
    pairs, n_apart = _pairs(voxels[:, axis], across)
    corners = np.flatnonzero(np.diff(across) == 1)
    return Linkage(
        axis,
        across,
        start.astype(np.int32),
        pairs,
        n_apart,
        corners.astype(np.int32),
    )


def _pairs(depth: IntArray, across: IntArray) -> tuple[IntArray, int]:
    """What can meet in the plane: pairs within one depth, those one bar apart in the chain last."""
    planar = np.zeros(len(depth), np.int32)  # planar joint of each joint of the chain
    planar[across + 1] = 1
    planar = planar.cumsum(dtype=np.int32)
    lone = np.ones(len(depth), bool)
    lone[across] = lone[across + 1] = False
    apart, beside = [np.empty((0, 3), np.int32)], [np.empty((0, 3), np.int32)]
    for y in np.unique(depth):
        joints = np.flatnonzero(depth == y)
        bars = across[depth[across] == y]
        joint, bar = (a.ravel() for a in np.meshgrid(joints, bars, indexing="ij"))
        ahead = joint - bar
        rows = np.stack([planar[joint], planar[bar], planar[bar + 1]], axis=1)
        apart.append(rows[(ahead < -1) | (ahead > 2)])
        beside.append(rows[(ahead == -1) | (ahead == 2)])
        two = np.array(list(combinations(planar[joints[lone[joints]]], 2)), np.int32)
        apart.append(two.reshape(-1, 2)[:, [0, 1, 1]])
    n_apart = sum(map(len, apart))
    return np.concatenate(apart + beside), n_apart


def radians(ticks: IntArray) -> FloatArray:
    """Angles as kernels take them."""
    angles: FloatArray = TICK * ticks.astype(np.float64)
    return angles


def straightness(place: FloatArray) -> float:
    """Distance of the ends as a share of the linkage's length; 1 for a line."""
    if len(place) == 1:
        return 1.0
    return float(np.hypot(*(place[-1] - place[0])) / (len(place) - 1))


def largest_bend(linkage: Linkage, ticks: IntArray) -> float:
    """Degrees of the largest bend between bars (..., m) that follow each other at one depth."""
    bends = ticks[..., linkage.corners + 1] - ticks[..., linkage.corners]
    return float(np.abs(bends).max(initial=0) * 90 / QUARTER)


@kernel
def placed(angles: FloatArray) -> FloatArray:
    """Planar joints (m + 1, 2), the first at the origin."""
    place = np.zeros((len(angles) + 1, 2))
    for b in range(len(angles)):
        place[b + 1, 0] = place[b, 0] + np.cos(angles[b])
        place[b + 1, 1] = place[b, 1] + np.sin(angles[b])
    return place


@kernel
def torques(angles: FloatArray, slope: FloatArray) -> FloatArray:
    """Derivative by each angle of what has the derivative `slope` (m + 1, 2) by the joints."""
    gradient = np.empty(len(angles))
    x, y = 0.0, 0.0
    for b in range(len(angles) - 1, -1, -1):
        x += slope[b + 1, 0]
        y += slope[b + 1, 1]
        gradient[b] = np.cos(angles[b]) * y - np.sin(angles[b]) * x
    return gradient


@kernel
def share_along(place: FloatArray, p: int, q: int, r: int) -> float:
    """Where on the bar q to r, 0 to 1, the point nearest to joint p lies."""
    x, y = place[r, 0] - place[q, 0], place[r, 1] - place[q, 1]
    along = (place[p, 0] - place[q, 0]) * x + (place[p, 1] - place[q, 1]) * y
    return min(max(along, 0.0), 1.0)  # bars are of length 1; for q = r, along is 0


@kernel
def clearance(linkage: Linkage, place: FloatArray) -> float:
    """Least distance of the pairs that the bends do not decide."""
    least = np.inf
    for k in range(linkage.n_apart):
        p, q, r = linkage.pairs[k, 0], linkage.pairs[k, 1], linkage.pairs[k, 2]
        t = share_along(place, p, q, r)
        x = place[p, 0] - (1 - t) * place[q, 0] - t * place[r, 0]
        y = place[p, 1] - (1 - t) * place[q, 1] - t * place[r, 1]
        least = min(least, x * x + y * y)
    return np.sqrt(least)
