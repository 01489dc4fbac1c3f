"""BEND moves: bars that turn evenly in angle about one axis, from the lattice and between."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import grid
from ..kinematics import QUARTER, TICK
from ..solid import Motion
from ._approach import Turn
from ._reach import reach

_HALF_TURN, _TURN = 2 * QUARTER, 4 * QUARTER
_DEGREES = 360.0 / _TURN


class Lying(NamedTuple):
    """A pose whose bars lie along one axis or across it, at any angle about it.

    Attributes
    ----------
    axis : int
    along : (P - 1,) int64
        Step along the axis, 1 or -1; 0 for a bar across.
    angles : (P - 1,) int64
        Of the bars across, in ticks, from axis + 1 to axis + 2; 0 for a bar along.
    """

    axis: int
    along: NDArray[np.int64]
    angles: NDArray[np.int64]

    def at(self, angles: grid.IntArray) -> "Lying":
        return Lying(self.axis, self.along, angles.astype(np.int64))

    def levels(self) -> NDArray[np.int64]:
        """Where the joints are along the axis, from joint 0 on."""
        return np.concatenate([[0], self.along.cumsum()])

    def bars(self) -> NDArray[np.int64] | None:
        """Lattice steps of the bars; None off the lattice."""
        quarters, off = np.divmod(self.angles, QUARTER)
        if off.any():
            return None
        quarters, across = quarters % 4, self.along == 0
        bars = np.zeros((len(quarters), 3), np.int64)
        bars[:, self.axis] = self.along
        bars[across, (self.axis + 1) % 3] = np.array([1, 0, -1, 0])[quarters[across]]
        bars[across, (self.axis + 2) % 3] = np.array([0, 1, 0, -1])[quarters[across]]
        return bars


def lying(pose: NDArray[np.int64], axis: int) -> Lying:
    """A lattice pose, its bars seen along and across an axis."""
    bars = np.diff(pose, axis=0)
    along, x, y = (bars[:, (axis + k) % 3] for k in range(3))
    quarters = np.where(x == 0, 2 - y, 1 - x)  # x = 1, y = 1, x = -1, y = -1 are 0, 1, 2, 3
    return Lying(axis, along, np.where(along == 0, quarters * QUARTER, 0))


def malformed_bend(motion: Motion, move: grid.IntArray, now: Lying) -> str:
    """Why this row names no BEND of the pose; "" if it does."""
    _, axis, first, last = (int(x) for x in move)
    n_bars, angles = len(now.along), motion.angles
    if axis not in (0, 1, 2):
        return "must be about axis 0, 1 or 2"
    if now.axis != axis:
        return f"must be about axis {now.axis}, from a pose off the lattice"
    if angles.ndim != 2 or angles.shape[1] != n_bars:
        return f"needs angles of shape (K, {n_bars}), got {angles.shape}"
    if not (0 <= first < len(angles) and 0 <= last < len(angles)):
        return f"must name rows 0..{len(angles) - 1} of angles"
    if (angles[first] == angles[last]).all():
        return "must turn some bars"
    turned = (now.along != 0) & (angles[[first, last]] != 0).any(axis=0)
    if turned.any():
        return f"gives an angle to bar {int(np.argmax(turned))}, which lies along its axis"
    elsewhere = (now.along == 0) & ((now.angles - angles[first]) % _TURN != 0)
    if elsewhere.any():
        bar = int(np.argmax(elsewhere))
        there, here = angles[first, bar] % _TURN, now.angles[bar] % _TURN
        return f"starts with bar {bar} at {there} ticks, but it is at {here}"
    return ""


def sharpest_bends(before: Lying, after: Lying) -> NDArray[np.float64]:
    """Largest bend at each joint during a BEND, (P,) degrees; 0 at the two ends.

    Where both bars turn, the bend is the difference of their angles and grows evenly; a bar along
    the axis is at 90 degrees to one across it.
    """
    across = before.along == 0
    starts, stops = np.diff(before.angles), np.diff(after.angles)
    low, high = np.minimum(starts, stops), np.maximum(starts, stops)
    folds_back = (high - _HALF_TURN) // _TURN > (low - _HALF_TURN - 1) // _TURN
    ends = [np.abs((d + _HALF_TURN) % _TURN - _HALF_TURN) for d in (starts, stops)]
    turned = np.where(folds_back, _HALF_TURN, np.maximum(*ends))
    both, either = across[1:] & across[:-1], across[1:] | across[:-1]
    ticks = np.where(both, turned, np.where(either, QUARTER, 0))
    return np.pad(_DEGREES * ticks, 1)


def turning(before: Lying, after: Lying, bends_deg: NDArray[np.float64]) -> Turn:
    """A BEND whose sharpest bends are known, as the kernels take it."""
    return Turn(
        TICK * before.angles.astype(np.float64),
        TICK * (after.angles - before.angles).astype(np.float64),
        before.along == 0,
        before.levels(),
        bends_deg > 90,
    )


def box(first: NDArray[np.int64], axis: int, turn: Turn) -> NDArray[np.float64]:
    """Lowest and highest positions, (2, 3), of the joints, or up to 1e-3 more; joint 0 rests."""
    sides = np.empty((2, 3))
    sides[:, axis] = turn.levels.min(), turn.levels.max()
    sides[:, [(axis + 1) % 3, (axis + 2) % 3]] = reach(turn)
    moved_on: NDArray[np.float64] = first + sides
    return moved_on
