"""The judge of PEEL, SWING and DOOR without any of its speed: every moving bar, every bar at rest.

Poses come from `kinematics`; with the judge it shares only the closed form for two bars.
"""

from typing import NamedTuple

import numpy as np
from oracles import pose_bend_deg

from lineup import grid, kinematics
from lineup.judging._sweeps import slide_distance, turn_distance
from lineup.kinematics import Move


class Outcome(NamedTuple):
    """Where a motion fails (-1 if no move does) and why; what was met up to there."""

    where: int
    fault: str  # "", "malformed", "touch" or "bend"
    clearance: float
    bend_deg: float


def outcome(motion, diameter=0.999, max_bend_deg=90.0):
    """Judge a motion of at least three bars whose start is a good pose."""
    pose = motion.start.astype(int)
    clearance, bend_deg = 1.0, pose_bend_deg(pose.astype(float))
    for where, move in enumerate(motion.moves.tolist()):
        if malformed(pose, *move):
            return Outcome(where, "malformed", clearance, bend_deg)
        clearance = min(clearance, move_clearance(pose, *move))
        if clearance < diameter:
            return Outcome(where, "touch", clearance, bend_deg)
        pose = np.rint(kinematics.moved(pose.astype(float), np.array(move), motion, 1.0))
        bend_deg = max(bend_deg, pose_bend_deg(pose))
        pose = pose.astype(int)
        if bend_deg > max_bend_deg:
            return Outcome(where, "bend", clearance, bend_deg)
    return Outcome(-1, "", clearance, bend_deg)


def malformed(pose, kind, joint, other, value):
    if kind not in (Move.PEEL, Move.SWING, Move.DOOR):
        return True
    if not (0 <= joint < len(pose) and 0 <= other < len(pose)):
        return True
    apart = np.abs(pose[other] - pose[joint])
    if kind == Move.DOOR:
        on_axis = apart.max() == apart.sum() < other - joint
        return other - joint < 2 or not on_axis or value not in (1, -1)
    return abs(other - joint) != 1 or value not in range(6) or apart[value % 3] != 0


def move_clearance(pose, kind, joint, other, value, only=None):
    """Smallest distance, capped at 1, of bars two or more apart in a move, of all or some."""
    bars = np.arange(len(pose) - 1) if only is None else np.array(only)
    local = seen(pose, kind, joint, other, value)
    if kind == Move.DOOR:
        moves = (joint <= bars) & (bars < other)
    else:
        moves = bars >= joint if other > joint else bars < joint
    rest, moving = rows(local, bars[~moves]), rows(local, bars[moves])
    if kind != Move.PEEL:
        return nearest(moving, rest, turning=True)
    turns = moving[:, 6] == min(joint, other)
    from_other = local - (1, 0, 0)  # where the bar turns about `other`, seen from what it carries
    bar, carried = rows(from_other, moving[turns, 6]), rows(from_other, moving[~turns, 6])
    return min(
        nearest(moving[turns], rest, turning=True),
        nearest(moving[~turns], rest, turning=False),
        nearest(bar, carried, turning=True),
    )


def seen(pose, kind, joint, other, value):
    """The pose about `joint`, in a frame in which the move turns the first axis to the second."""
    axis = np.sign(pose[other] - pose[joint])
    if kind == Move.DOOR:
        h = value * axis
        x = np.roll(h, 1)
        y = np.cross(h, x)
    else:
        x, y = axis, grid.DIRECTIONS[value]
        h = np.cross(x, y)
    return (pose - pose[joint]) @ np.stack([x, y, h], axis=1)


def rows(local, bars):
    """Bars as the runs of `_sweeps`."""
    bars = np.asarray(bars, int)
    a, b = local[bars], local[bars + 1]
    grows = np.sign(b - a).sum(axis=1)
    return np.column_stack([np.minimum(a, b), np.maximum(a, b), bars, bars, grows]).astype(int)


def nearest(moving, rest, turning):
    """Smallest distance, capped at 1, of two sets of bars over a quarter turn, or a slide."""
    m, r = moving[:, None], rest[None]
    heights_meet = (m[..., 2] <= r[..., 5]) & (r[..., 2] <= m[..., 5])
    near = heights_meet & (np.abs(m[..., 6] - r[..., 6]) >= 2)
    if turning:
        near &= (inner(r) < outer(m) + 1) & (inner(m) < outer(r) + 1)
    else:
        reach = np.array([2, 1]), np.array([1, 2])
        near &= (r[..., :2] <= m[..., 3:5] + reach[1]).all(axis=-1)
        near &= (m[..., :2] <= r[..., 3:5] + reach[0]).all(axis=-1)
    distance = turn_distance if turning else slide_distance
    return min((distance(moving[i], rest[k]) for i, k in np.argwhere(near)), default=1.0)


def inner(bars):
    """Distance of the origin of the plane from each bar."""
    return np.linalg.norm(np.clip(0, bars[..., :2], bars[..., 3:5]), axis=-1)


def outer(bars):
    return np.linalg.norm(np.maximum(np.abs(bars[..., :2]), np.abs(bars[..., 3:5])), axis=-1)
