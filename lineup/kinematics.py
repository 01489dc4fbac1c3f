"""The chain as a mechanism: kinds of move and the poses they pass through (Section 6, Figure 2).

A pose is the (P, 3) positions of the joints (voxel centres); bar k joins joints k and k + 1.
"""

from collections.abc import Iterator
from enum import IntEnum

import numpy as np

from .grid import DIRECTIONS, FloatArray, IntArray
from .solid import Motion


class Move(IntEnum):
    """What a row (kind, joint, other, value) of `Motion.moves` does; each turns by 90 degrees.

    PEEL
        ``other`` is joint ± 1. The bar (joint, other) turns about `joint` to direction `value`;
        everything beyond `other` keeps its directions and is carried along.
    SWING
        ``other`` is joint ± 1. The bar (joint, other) and everything beyond it turn rigidly
        about `joint` until that bar has direction `value`.
    DOOR
        The joints strictly between joint < other turn rigidly about the line through those two,
        by +90 degrees (value 1) or -90 degrees (value -1), right-handed from `joint` to `other`.
    TILT
        Every bar turns at once, by the same angle, to its direction in ``poses[value]`` (bars
        that have it already stay); joint 0 rests. `joint` and `other` are 0 and P - 1.

    A reversed move is a move of the same kind, so a motion can be played backwards.
    """

    PEEL = 0
    SWING = 1
    DOOR = 2
    TILT = 3


def frames(motion: Motion, every: int = 1, substeps: int = 1) -> Iterator[FloatArray]:
    """Poses of a motion, (P, 3) float64 each, from the folded pose to the last.

    Parameters
    ----------
    every : int
        Show every so many moves; the first and the last pose always come.
    substeps : int
        Poses inside each move shown, at equal steps of its angle, the last at its end.

    Raises
    ------
    ValueError
        If `every` or `substeps` is not positive, or a move cannot be carried out.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> path = lu.layered_path(lu.VoxelSolid(np.ones((2, 2, 1), bool)))
    >>> poses = list(lu.frames(lu.unfold(path)))
    >>> len(poses), int(np.ptp(poses[-1], axis=0).max())
    (2, 3)
    """
    if every < 1 or substeps < 1:
        raise ValueError(f"every and substeps must be at least 1, got {every} and {substeps}")
    return _frames(motion, every, substeps)


def _frames(motion: Motion, every: int, substeps: int) -> Iterator[FloatArray]:
    pose = motion.start.astype(np.float64)
    yield pose.copy()
    for k, move in enumerate(motion.moves, start=1):
        if k % every == 0 or k == len(motion):
            for s in range(1, substeps):
                yield moved(pose, move, motion, s / substeps)
        pose = np.rint(moved(pose, move, motion, 1.0))
        if k % every == 0 or k == len(motion):
            yield pose.copy()


def moved(pose: FloatArray, move: IntArray, motion: Motion, t: float) -> FloatArray:
    """The pose after the share t (0 to 1) of one move's angle.

    Raises
    ------
    ValueError
        If the move is of no known kind, or would not turn its bar by 90 degrees.
    """
    kind, joint, other, value = (int(x) for x in move)
    angle = t * np.pi / 2
    if kind == Move.TILT:
        bars = np.diff(pose, axis=0)
        bars = _turned(bars, DIRECTIONS[motion.poses[value]], angle)
        tilted: FloatArray = pose[0] + np.vstack([np.zeros(3), bars.cumsum(axis=0)])
        return tilted
    out = pose.copy()
    if kind == Move.DOOR:
        axis = pose[other] - pose[joint]
        axis /= np.linalg.norm(axis)
        out[joint + 1 : other] = _rotated(pose[joint + 1 : other], pose[joint], axis, value * angle)
        return out
    beyond = slice(other, None) if other > joint else slice(None, other + 1)
    bar, target = pose[other] - pose[joint], DIRECTIONS[value].astype(np.float64)
    if abs(other - joint) != 1 or abs(bar @ target) > 1e-6:
        raise ValueError(f"move {move.tolist()} does not turn a bar by 90 degrees")
    if kind == Move.PEEL:
        out[beyond] += _turned(bar[None], target[None], angle)[0] - bar
    elif kind == Move.SWING:
        out[beyond] = _rotated(pose[beyond], pose[joint], np.cross(bar, target), angle)
    else:
        raise ValueError(f"unknown kind of move {kind}; known: {[m.name for m in Move]}")
    return out


def _turned(bars: FloatArray, targets: IntArray | FloatArray, angle: float) -> FloatArray:
    """Unit bars (n, 3), each turned by `angle` towards a perpendicular target or left alone."""
    rest = (np.rint(bars) == targets).all(axis=1)
    turned: FloatArray = bars * np.cos(angle) + targets * np.sin(angle)
    turned[rest] = bars[rest]
    return turned


def _rotated(points: FloatArray, origin: FloatArray, axis: FloatArray, angle: float) -> FloatArray:
    """Points turned about the line through `origin` along the unit vector `axis` (Rodrigues)."""
    p = points - origin
    along = (p @ axis)[:, None] * axis
    rotated: FloatArray = (
        origin + along + (p - along) * np.cos(angle) + np.cross(axis, p) * np.sin(angle)
    )
    return rotated
