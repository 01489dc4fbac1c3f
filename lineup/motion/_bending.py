"""From angles of a linkage to a motion: the last straight way, thinning, BEND and TILT moves."""

from dataclasses import dataclass

import numpy as np

from .._jit import kernel
from ..grid import FloatArray, IntArray
from ..kinematics import QUARTER, TICK, Move
from ..solid import Motion
from ._linkage import Linkage, placed, radians, straightness
from ._safety import passes

BATCH = 256
"""Rows that are kept before they are thinned."""

NEARLY_STRAIGHT = 0.3
"""From this straightness on, the direct way to the line is tried."""


@dataclass(frozen=True)
class Run:
    """What a flow of the angles of a linkage came to.

    Attributes
    ----------
    rows : (K, m) int32
        The angles it passes through, evenly in time from row to row.
    reason : str
    steps : int
    objective : float
        What the flow lowers, at its end.
    """

    rows: IntArray
    reason: str
    steps: int
    objective: float


class Keyframes:
    """The rows of a flow as it goes, thinned while they come."""

    def __init__(self, linkage: Linkage) -> None:
        self.linkage = linkage
        self.kept: list[IntArray] = []
        self.waiting = [linkage.start]

    def add(self, row: IntArray, diameter: float) -> None:
        """Note a row; bars have kept `diameter` up to it."""
        if (row != self.waiting[-1]).any():
            self.waiting.append(row)
        if len(self.waiting) > BATCH:
            self._thin(diameter)

    def rows(self, diameter: float) -> IntArray:
        self._thin(diameter)
        return np.array([*self.kept, *self.waiting], np.int32)

    def _thin(self, diameter: float) -> None:
        """Keep rows that are as far apart as bars keep `diameter` on the direct way."""
        rows, first = self.waiting, 0
        while first < len(rows) - 1:
            self.kept.append(rows[first])
            good, bad = first + 1, len(rows)
            stride = 2
            while bad - good > 1:
                trial = min(good + stride, bad - 1) if bad == len(rows) else (good + bad) // 2
                if passes(self.linkage, rows[first], rows[trial], diameter, pieces=16):
                    good, stride = trial, 2 * stride
                else:
                    bad = trial
            first = good
        self.waiting = rows[first:]


def line_ahead(linkage: Linkage, row: IntArray, diameter: float) -> IntArray | None:
    """The angles of the line along a lattice axis that turning evenly leads to; None if unsafe.

    Every bar takes the nearest copy of the line's angle; bars that follow each other must then
    take the same one, so that their bends shrink all the way.
    """
    place = placed(radians(row))
    if straightness(place) < NEARLY_STRAIGHT:
        return None
    ahead = np.arctan2(*(place[-1] - place[0])[::-1]) / TICK
    turns = np.rint((row - ahead) / (4 * QUARTER))
    if (turns[linkage.corners] != turns[linkage.corners + 1]).any():
        return None
    target = (QUARTER * (4 * turns + np.rint(ahead / QUARTER))).astype(np.int32)
    there = (row == target).all()
    return target if there or passes(linkage, row, target, diameter) else None


def ticks(angles: FloatArray, corners: IntArray, max_bend: int) -> IntArray:
    """Angles to whole ticks, so that no bend at a corner grows beyond `max_bend` by rounding."""
    row = np.floor(angles / TICK + 0.5).astype(np.int32)
    _limit_bends(row, corners, max_bend)
    return row


@kernel
def _limit_bends(row: IntArray, corners: IntArray, max_bend: int) -> None:
    for b in corners:
        row[b + 1] = row[b] + min(max(row[b + 1] - row[b], -max_bend), max_bend)


def bend_motion(
    voxels: IntArray, linkage: Linkage, run: Run, diameter: float, max_bend_deg: float
) -> Motion:
    """The motion of a run and, where it ends in a line, the tilt that lines up the other bars.

    The tilt stands for the second stage of Algorithm 4. See PAPER.md, deviation 6.
    """
    n_bars, n_rows = len(voxels) - 1, len(run.rows)
    angles = np.zeros((n_rows, n_bars), np.int32)
    angles[:, linkage.across] = run.rows
    moves = [(Move.BEND, linkage.axis, k, k + 1) for k in range(n_rows - 1)]
    poses = np.empty((0, n_bars), np.int8)
    straight = run.reason == "straight"
    if straight and 0 < len(linkage.across) < n_bars:
        quarter = int(run.rows[-1, 0]) // QUARTER % 4
        line = (linkage.axis + 1 + quarter % 2) % 3 + 3 * (quarter // 2)
        moves.append((Move.TILT, 0, n_bars, 0))
        poses = np.full((1, n_bars), line, np.int8)
    return Motion(
        voxels,
        np.array(moves, np.int32).reshape(-1, 4),
        diameter,
        max_bend_deg,
        straight,
        run.reason,
        poses,
        angles if len(moves) > len(poses) else angles[:0],
    )
