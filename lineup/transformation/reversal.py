"""Motions played backwards, turned as a whole, and joined (Section 6: unfolding is reversible).

A reversed move is a move of the same kind that passes through the same poses, so whatever the
judge says of a motion holds of its reversal.
"""

from collections.abc import Iterator
from itertools import permutations, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..grid import DIRECTIONS, IntArray, bar_directions
from ..kinematics import QUARTER, Move, on_lattice
from ..solid import Motion

_AXIS_TURNS = [
    np.eye(3, dtype=np.int32)[list(axes)] * np.array(signs, np.int32)[:, None]
    for axes, signs in product(permutations(range(3)), product((1, -1), repeat=3))
]
TURNS = np.array([turn for turn in _AXIS_TURNS if round(np.linalg.det(turn)) == 1])
"""(24, 3, 3) the proper rotations of the lattice, the identity first."""


def opposite(d: int) -> int:
    """The direction opposite to direction d, 0 to 5."""
    return (d + 3) % 6


def turned_code(turn: IntArray) -> IntArray:
    """Where a rotation (3, 3) of the lattice takes each of the six directions, (6,)."""
    code: IntArray = np.argmax(DIRECTIONS @ turn.T @ DIRECTIONS.T, axis=1).astype(np.int32)
    return code


def quarter_turn(before: int, after: int) -> IntArray:
    """The rotation (3, 3) by 90 degrees that takes one direction to another across it."""
    e, d = DIRECTIONS[before], DIRECTIONS[after]
    axis = np.cross(e, d)
    turn: IntArray = (np.outer(axis, axis) + np.outer(d, e) - np.outer(e, d)).astype(np.int32)
    return turn


def words(motion: Motion) -> Iterator[IntArray]:
    """Bar directions (P - 1,) before each move, and after the last.

    Raises
    ------
    ValueError
        If the last pose is off the lattice; the words between are those of lattice poses, and
        the last such one where a pose is off it.
    """
    bars = bar_directions(motion.start).astype(np.int32)
    yield bars
    off = False
    for move in motion.moves.tolist():
        off = move[0] == Move.BEND and not on_lattice(motion.angles[move[3]])
        if not off:
            bars = _word_after(move, bars, motion)
        yield bars
    if off:
        raise ValueError("the motion ends between lattice poses, so it has no reversal")


def _word_after(move: list[int], bars: IntArray, motion: Motion) -> IntArray:
    kind, joint, other, value = move
    if kind == Move.TILT:
        tilted: IntArray = motion.poses[value].astype(np.int32)
        return tilted
    if kind == Move.PULL:
        ends = (bars[1:], [value]) if joint else ([opposite(value)], bars[:-1])
        return np.concatenate(ends).astype(np.int32)
    after = bars.copy()
    if kind == Move.BEND:
        across = bars % 3 != joint
        after[across] = np.array(_around(joint))[motion.angles[value, across] // QUARTER % 4]
    elif kind == Move.DOOR:
        axis = np.sign(DIRECTIONS[bars[joint:other]].sum(axis=0)) * value
        u, v = _around(int(np.abs(axis).argmax()))[:2]
        turn = quarter_turn(u, v) if axis.sum() > 0 else quarter_turn(v, u)
        after[joint:other] = turned_code(turn)[bars[joint:other]]
    else:
        bar = min(joint, other)
        forward = value if other > joint else opposite(value)
        beyond = slice(bar, None) if other > joint else slice(None, bar + 1)
        if kind == Move.SWING:
            after[beyond] = turned_code(quarter_turn(int(bars[bar]), forward))[bars[beyond]]
        after[bar] = forward
    return after


def reversal(motion: Motion) -> Motion:
    """The same motion backwards: from its last pose, through the same poses, to its start.

    Raises
    ------
    ValueError
        If the motion ends between lattice poses.
    """
    rows: list[tuple[int, int, int, int]] = []
    poses: list[IntArray] = []
    word = words(motion)
    for move in motion.moves.tolist():
        bars = next(word)
        rows.append(_undoing(move, bars, len(poses)))
        if move[0] == Move.TILT:
            poses.append(bars)
    last, first = next(word), bar_directions(motion.start)
    next(word, None)
    return Motion(
        np.vstack([np.zeros((1, 3), int), DIRECTIONS[last].cumsum(axis=0)]),
        np.array(rows[::-1], np.int32).reshape(-1, 4),
        motion.diameter,
        motion.max_bend_deg,
        bool((first == first[0]).all()),
        "played backwards",
        np.array(poses, np.int8).reshape(len(poses), len(last) if poses else 0),
        motion.angles,
        motion.start,
    )


def _undoing(move: list[int], bars: IntArray, n_poses: int) -> tuple[int, int, int, int]:
    """The move that leads back to the pose with these bars."""
    kind, joint, other, value = move
    if kind == Move.TILT:
        return kind, joint, other, n_poses
    if kind == Move.PULL:
        return kind, other, joint, int(bars[-1]) if other else opposite(int(bars[0]))
    if kind == Move.BEND:
        return kind, joint, value, other
    if kind == Move.DOOR:
        return kind, joint, other, -value
    forward = int(bars[min(joint, other)])
    return kind, joint, other, forward if other > joint else opposite(forward)


def turned(motion: Motion, turn: IntArray) -> Motion:
    """The same motion, turned as a whole by a rotation (3, 3) of the lattice."""
    code = turned_code(turn)
    rows, angles = motion.moves.copy(), motion.angles.copy()
    kinds = rows[:, 0]
    for kind in (Move.PEEL, Move.SWING, Move.PULL):
        rows[kinds == kind, 3] = code[rows[kinds == kind, 3]]
    for k, bars in zip(np.flatnonzero(kinds == Move.BEND), _words_at_bends(motion), strict=True):
        axis = int(rows[k, 1])
        rows[k, 1] = code[axis] % 3
        sign = 1 if code[axis] < 3 else -1
        shift = QUARTER * _around(int(rows[k, 1])).index(int(code[(axis + 1) % 3]))
        which = rows[k, 2:]
        angles[which] = np.where(bars % 3 == axis, 0, sign * motion.angles[which] + shift)
    return Motion(
        motion.start @ turn.T,
        rows,
        motion.diameter,
        motion.max_bend_deg,
        motion.straight,
        motion.reason,
        code[motion.poses].astype(np.int8) if motion.poses.size else motion.poses,
        angles,
        motion.goal @ turn.T,
    )


def _words_at_bends(motion: Motion) -> list[IntArray]:
    bends = motion.moves[:, 0] == Move.BEND
    return [bars for bars, bend in zip(words(motion), bends, strict=False) if bend]


def _around(axis: int) -> list[int]:
    """The directions across an axis, as a right-handed turn about it meets them."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    return [u, v, u + 3, v + 3]


def joined(first: Motion, second: Motion, reason: str) -> Motion:
    """`first` and then `second`, which must start in the last pose of `first`, shifted or not."""
    rows = second.moves.copy()
    rows[rows[:, 0] == Move.TILT, 3] += len(first.poses)
    rows[rows[:, 0] == Move.BEND, 2:] += len(first.angles)
    return Motion(
        first.start,
        np.vstack([first.moves, rows]),
        min(first.diameter, second.diameter),
        max(first.max_bend_deg, second.max_bend_deg),
        second.straight,
        reason,
        _stacked(first.poses, second.poses),
        _stacked(first.angles, second.angles),
        second.goal,
    )


def _stacked(first: NDArray[Any], second: NDArray[Any]) -> NDArray[Any]:
    parts = [rows for rows in (first, second) if len(rows)]
    return np.vstack(parts) if parts else first
