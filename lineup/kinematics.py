"""The chain as a mechanism: kinds of move and the poses they pass through (Section 6, Figure 2).

A pose is the (P, 3) positions of the joints (voxel centres); bar k joins joints k and k + 1.
"""

from collections.abc import Iterator
from enum import IntEnum

import numpy as np

from ._record import of_kind
from .grid import DIRECTIONS, FloatArray, IntArray
from .solid import Motion

TICK = 2 * np.pi / 2**20
"""Radians in one unit of `Motion.angles`; a quarter turn is `QUARTER` units."""

QUARTER = 2**18

_REACH = 7
"""Pieces of a track from the one that leads a wave on which the phase is 0 or 1 within 1e-26."""


class Move(IntEnum):
    """What a row (kind, joint, other, value) of `Motion.moves` does.

    PEEL
        ``other`` is joint ± 1. The bar (joint, other) turns by 90 degrees about `joint` to
        direction `value`; everything beyond `other` keeps its directions and is carried along.
    SWING
        ``other`` is joint ± 1. The bar (joint, other) and everything beyond it turn rigidly by 90
        degrees about `joint` until that bar has direction `value`.
    DOOR
        The joints strictly between joint < other turn rigidly about the line through those two,
        by +90 degrees (value 1) or -90 degrees (value -1), right-handed from `joint` to `other`.
    TILT
        Every bar turns at once, by the same angle, to its direction in ``poses[value]`` (bars
        that have it already stay); joint 0 rests. `joint` and `other` are 0 and P - 1.
    PULL
        The whole chain glides along itself by one voxel: end `joint` goes one step in direction
        `value`, and every other joint takes the place of the one before it. `joint` and `other`
        are the two ends, 0 and P - 1 or P - 1 and 0. On the way every joint stays on the track,
        the lattice path through the old and the new pose.
    BEND
        Bars along axis `joint` (0, 1 or 2) keep their directions; every other bar lies across
        that axis and turns about it, evenly in time, from its angle in ``angles[other]`` to that
        in ``angles[value]``, right-handed from axis `joint` + 1 to axis `joint` + 2; joint 0
        rests. The entries of bars along the axis are 0.

    A reversed move is a move of the same kind, so a motion can be played backwards. All but BEND
    lead from a lattice pose to a lattice pose; a BEND may begin and end between.
    """

    PEEL = 0
    SWING = 1
    DOOR = 2
    TILT = 3
    PULL = 4
    BEND = 5


TURNS = (Move.PEEL, Move.SWING, Move.DOOR)
"""Kinds of move that turn a row of bars by 90 degrees, and no others."""


def frames(motion: Motion, every: int = 1, substeps: int = 1) -> Iterator[FloatArray]:
    """Poses of a motion, (P, 3) float64 each, from the folded pose to the last.

    Parameters
    ----------
    every : int
        Show every so many moves; the first and the last pose always come.
    substeps : int
        Poses inside each move shown, the last at its end: at equal steps of its angle, and of
        the wave that runs from the leading end to the other in a PULL.

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
    of_kind(motion, Motion)
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
        pose = after(pose, move, motion)
        if k % every == 0 or k == len(motion):
            yield pose.copy()


def after(pose: FloatArray, move: IntArray, motion: Motion) -> FloatArray:
    """The pose after a whole move, rounded where it is on the lattice."""
    made = moved(pose, move, motion, 1.0)
    between = move[0] == Move.BEND and not on_lattice(motion.angles[move[3]])
    return made if between else np.rint(made)


def moved(pose: FloatArray, move: IntArray, motion: Motion, t: float) -> FloatArray:
    """The pose after the share t (0 to 1) of one move.

    Raises
    ------
    ValueError
        If the move is of no known kind, or cannot be made from this pose.
    """
    kind, joint, other, value = (int(x) for x in move)
    angle = t * np.pi / 2
    if kind == Move.TILT:
        bars = np.diff(pose, axis=0)
        return _chained(pose[0], _turned(bars, DIRECTIONS[motion.poses[value]], angle))
    if kind == Move.PULL:
        return _pulled(pose, joint, DIRECTIONS[value], t)
    if kind == Move.BEND:
        before, after = motion.angles[other], motion.angles[value]
        return _chained(pose[0], _bent(np.diff(pose, axis=0), joint, before, after, t))
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


def on_lattice(angles: IntArray) -> bool:
    """Whether bars at these angles all lie along lattice axes."""
    return not (angles % QUARTER).any()


def _chained(first: FloatArray, bars: FloatArray) -> FloatArray:
    joints: FloatArray = first + np.vstack([np.zeros(3), bars.cumsum(axis=0)])
    return joints


def _bent(bars: FloatArray, axis: int, before: IntArray, after: IntArray, t: float) -> FloatArray:
    """Bars (n, 3) after the share t of a BEND about `axis`."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    across = np.abs(bars[:, axis]) < 0.5
    angle = TICK * ((1 - t) * before[across] + t * after[across])
    bent = np.rint(bars)
    bent[across, axis] = 0
    bent[across, u], bent[across, v] = np.cos(angle), np.sin(angle)
    return bent


def _pulled(pose: FloatArray, head: int, step: IntArray, t: float) -> FloatArray:
    """The pose after the share t of a PULL by end `head`.

    Each joint is at a phase, 0 to 1, between its old place and its new one. Joints on one straight
    piece of the track have one phase; past a corner it is g(p) = sqrt(1 - (1 - p)^2) for p before
    it, so that bars keep their length. The phase of one piece after the other, from the head on,
    runs from 1 - sqrt(1/2) to sqrt(1/2); there the piece behind has the phase 1 - sqrt(1/2) and
    takes over. This looks the same from both ends of time and of the chain: the pull back, led by
    the other end, shows the same poses backwards.
    """
    if head not in (0, len(pose) - 1):
        raise ValueError(f"a pull is by joint 0 or {len(pose) - 1}, got {head}")
    joints = pose if head else pose[::-1]  # the head last
    bars = np.empty_like(joints)
    np.subtract(joints[1:], joints[:-1], out=bars[:-1])
    bars[-1] = step
    cosine = np.einsum("ij,ij->i", bars[1:], bars[:-1])
    if cosine.min(initial=0) < -0.5:
        raise ValueError(f"a pull by joint {head} would go straight back")
    piece = np.concatenate([[0], (cosine < 0.5).cumsum()])
    phase = _wave(int(piece[-1]) + 1, t)
    moved_on: FloatArray = joints + phase[piece][:, None] * bars
    return moved_on if head else moved_on[::-1]


def _wave(n_pieces: int, t: float) -> FloatArray:
    """Phases of the straight pieces of a track, the head's last, after the share t of a PULL."""
    first, last = 1 - np.sqrt(0.5), np.sqrt(0.5)
    travelled = t * (1 + (last - first) * (n_pieces - 1))
    k = int(np.clip((travelled - first) // (last - first), 0, n_pieces - 1))
    leader = n_pieces - 1 - k
    phase = np.zeros(n_pieces)
    phase[leader:] = 1.0
    phase[leader] = np.clip(travelled - (last - first) * k, 0.0, 1.0)
    for i in range(leader + 1, min(leader + _REACH, n_pieces)):
        phase[i] = np.sqrt(phase[i - 1] * (2 - phase[i - 1]))
    for i in range(leader - 1, max(leader - _REACH, -1), -1):
        phase[i] = phase[i + 1] ** 2 / (1 + np.sqrt(1 - phase[i + 1] ** 2))
    return phase


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
