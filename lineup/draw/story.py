"""A motion told in moments: poses, what to say of each, and where to look from (Figures 1, 18)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..grid import FloatArray, IntArray
from ..kinematics import frames
from ..solid import Motion
from ..transformation.reversal import TURNS
from .view import View, view_of


class Moment(NamedTuple):
    """A pose after so many moves, and what to say of it."""

    pose: FloatArray
    title: str
    where: str


def scenes_of(motion: Motion, pictures: int) -> Iterator[tuple[Moment, View]]:
    """Moments, the first, the last and those equally spaced between, each with its camera."""
    shown, line = _shown(motion, pictures)
    near = view_of(motion.start).widened(0.8)
    if not len(motion.goal):
        for move, pose in shown:
            yield Moment(pose, *told(motion, move, pose)), near
    elif line is None:
        wide = view_of(np.concatenate([pose for _, pose in shown]))
        for move, pose in shown:
            yield Moment(pose, *_told_between(motion, move)), wide
    else:
        upright = _turn_to(motion.goal, shown[-1][1])
        far = view_of(motion.goal).widened(0.8)
        for move, pose in shown[:line]:
            yield Moment(pose, *told(motion, move, pose)), near
        for move, pose in shown[line:]:
            yield Moment(_carried(pose, upright), *_told_after(motion, move, pose)), far


def _shown(motion: Motion, pictures: int) -> tuple[list[tuple[int, FloatArray]], int | None]:
    """Poses to show, each after how many moves, and the first of them that is not before the line.

    None if the motion never comes to the straight line.
    """
    substeps = max(1, (pictures - 1) // max(len(motion), 1))
    wanted = set(np.rint(np.linspace(0, substeps * len(motion), pictures)).astype(int).tolist())
    shown: list[tuple[int, FloatArray]] = []
    line = None
    for k, pose in enumerate(frames(motion, substeps=substeps)):
        if line is None and not bends(pose):
            line = len(shown)
        if k in wanted:
            shown.append((k // substeps, pose))
    return shown, line


class _Turn(NamedTuple):
    """The rotation about one point that is then carried to another."""

    rotation: FloatArray
    origin: FloatArray
    target: FloatArray


def _turn_to(goal: IntArray, last: FloatArray) -> _Turn:
    bars, wanted = np.diff(last, axis=0), np.diff(goal, axis=0)
    off = [np.abs(bars @ turn.T - wanted).sum() for turn in TURNS]
    return _Turn(TURNS[int(np.argmin(off))].astype(float), last[0], goal[0].astype(float))


def _carried(pose: FloatArray, turn: _Turn) -> FloatArray:
    carried: FloatArray = (pose - turn.origin) @ turn.rotation.T + turn.target
    return carried


def _told_after(motion: Motion, move: int, pose: FloatArray) -> tuple[str, str]:
    """What to say of a pose between the straight line and the goal."""
    share = bends(pose) / max(bends(motion.goal), 1)
    where = f"after move {move:,} of {len(motion):,}"
    if share == 0:
        return "straight", where
    done = move == len(motion)
    return ("folded anew" if done else f"{100 * share:.0f} % folded anew"), where


def _told_between(motion: Motion, move: int) -> tuple[str, str]:
    """What to say of a motion from shape to shape that is never straight."""
    title = {0: "folded", len(motion): "folded anew"}.get(move, "from shape to shape")
    return title, f"after move {move:,} of {len(motion):,}"


def told(motion: Motion, move: int, pose: FloatArray) -> tuple[str, str]:
    """What to say of the pose after so many moves: how far it is unfolded, and where that is."""
    if move == 0:
        return "folded", f"before the first of {len(motion):,} moves"
    left = bends(pose) / max(bends(motion.start), 1)
    where = f"after move {move:,} of {len(motion):,}"
    return ("straight" if left == 0 else f"{100 * left:.0f} % still folded"), where


def bends(pose: ArrayLike) -> int:
    """Number of joints whose two bars differ in direction.

    Examples
    --------
    >>> bends([[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0]])
    1
    """
    turns = np.diff(np.asarray(pose, dtype=float), n=2, axis=0)
    return int((np.abs(turns) > 1e-6).any(axis=1).sum())
