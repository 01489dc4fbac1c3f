"""The pull-through lemma: what a chain that glides along its own track keeps clear of itself.

While one PULL is made, joint k lies at a phase p on edge k of the track, and the next at phase p
on edge k + 1 past a straight vertex, at g(p) = sqrt(1 - (1 - p)^2) past a corner. Bar k so lies in
the triangle of the vertices k, k + 1 and k + 2, and the window of the P + 1 vertices that the chain
leaves, passes and reaches is simple. A *U* is three edges e, f, -e in a row.

Bars k and k + 1: both lie along their own two edges, so that without a U no bar has a component
against the one before it, and the bend is 90 degrees at most. In a U let sin(a) = g(p) be the
phase on f; the next on -e is sin(c) with cos(c) = 1 - sin(a), the bend is 90 + c - a degrees, and
c - a is largest at a = 30, c = 60: the bend is 120 at most.

Bars k and k + 2 lie beyond the two ends of bar k + 1, of direction u. Without a U neither has a
component against u, so that a slab of width 1 is between them. With a U at k + 1 (two Us in a row
would close a square), the point of bar k nearest to joint k + 2 is the foot of a perpendicular
of length cos(c - a), and bar k + 2 leads no nearer: the distance is cos(30) at least. With a U at
k + 2 the same holds backwards.

Bars three or more apart lie in triangles of three vertices each that share none: up to turns,
mirrors and shifts one of 18,110 pairs. `proofs/pull_table.py` shows by interval arithmetic that
they keep .9142 from each other. If one of the triangles is flat this holds at any two phases; of
two corners that a wave passes, the later is further on, at least by the g of each corner between.
A bar half way round a corner comes as near as sqrt(2) - 1/2 to the vertex in its crook.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

ROUND_CORNERS = 0.9142
"""Clearance of bars three or more apart, and of all if there is no U."""

ROUND_US = sqrt(3) / 2
"""Clearance of bars two apart round a U."""

CORNER_DEG, U_DEG = 90.0, 120.0
"""Largest bends round a corner and round a U."""

AXIS_NUMBERS = np.array([1, 2, 3])
"""Edges along x, y and z count as 1, 2 and 3, and backwards as -1, -2 and -3."""

FINE, BACK, BLOCKED, TOUCH, BEND = range(5)
"""What `carry_out` found: nothing wrong, a malformed pull, or a pull that fails (three ways)."""


class Pulled(NamedTuple):
    """What a run of pulls by one end has come to.

    `made` counts the pulls before the fault. `clearance` and `bend_deg` cover those and the one
    that fails; `joint` is the one whose voxel a `BLOCKED` head meets. `straight` tells whether
    one of the pulls ended on a straight line.
    """

    pose: NDArray[np.int64]
    made: int
    fault: int
    clearance: float
    bend_deg: float
    straight: bool
    joint: int


def carry_out(
    pose: NDArray[np.int64], steps: NDArray[np.int64], diameter: float, max_bend_deg: float
) -> Pulled:
    """Judge pulls by the last joint, of two or more, in the directions `steps` (M, 3)."""
    n, m = len(pose), len(steps)
    track = np.vstack([pose, pose[-1] + steps.cumsum(axis=0)])
    edge = np.diff(track @ AXIS_NUMBERS)
    corner = np.abs(edge[1:]) != np.abs(edge[:-1])
    u = corner[1:] & (edge[2:] == -edge[:-2])
    has_corner, has_u = _within(corner, n - 1, m), _within(u, n - 2, m)
    clearance, bend_deg = np.ones(m), np.zeros(m)
    clearance[has_corner], bend_deg[has_corner] = ROUND_CORNERS, CORNER_DEG
    clearance[has_u], bend_deg[has_u] = ROUND_US, U_DEG
    if n < 4:
        clearance[:] = np.inf
    if n < 3:
        bend_deg[:] = 0
    met = _met(track, n)
    clearance[met >= 0] = 0
    fault = np.full(m, FINE)
    fault[bend_deg > max_bend_deg] = BEND
    fault[clearance < diameter] = TOUCH
    fault[met >= 0] = BLOCKED
    fault[edge[n - 1 :] == -edge[n - 2 : -1]] = BACK
    made = int(np.argmax(fault != FINE)) if fault.any() else m
    judged = slice(made + (made < m and fault[made] != BACK))
    return Pulled(
        pose=track[made : made + n],
        made=made,
        fault=int(fault[made]) if made < m else FINE,
        clearance=float(clearance[judged].min(initial=np.inf)),
        bend_deg=float(bend_deg[judged].max(initial=0.0)),
        straight=not _within(corner[1:], n - 2, m)[:made].all(),
        joint=int(met[made]) if made < m else -1,
    )


def _within(marks: NDArray[np.bool_], width: int, count: int) -> NDArray[np.bool_]:
    """Whether any of marks k to k + width - 1 is set, for k from 0 to count - 1."""
    n_before = np.concatenate([[0], marks.cumsum()])
    found: NDArray[np.bool_] = n_before[width : width + count] > n_before[:count]
    return found


def _met(track: NDArray[np.int64], n_joints: int) -> NDArray[np.int64]:
    """The joint whose voxel the head enters with each pull, -1 where it enters a free one.

    The voxel that the tail leaves with the same pull is not free yet.
    """
    entered = track[n_joints:]
    near = ((track >= entered.min(axis=0)) & (track <= entered.max(axis=0))).all(axis=1)
    order = np.flatnonzero(near)
    order = order[np.lexsort(track[order].T)]
    again = (track[order[1:]] == track[order[:-1]]).all(axis=1)
    before, after = order[:-1][again], order[1:][again]
    inside = after - before <= n_joints
    pull = after[inside] - n_joints
    met = np.full(len(track) - n_joints, -1)
    met[pull] = before[inside] - pull
    return met
