"""A motion as changes of joint angles, and back from angles to positions."""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from .._record import record
from ..grid import FloatArray, IntArray
from ..solid import Motion
from .angles import Y1, Y2, Z1, Z2, Station, X, about, stations

STILL = 1e-9
"""Degrees by which an angle may differ and still be the same."""


@record
class Trajectory:
    """Joint angles along a motion (Figure 2, Section 8; see `robot.angles` for what they mean).

    Attributes
    ----------
    origin : (3,) float64
        Where joint 0 is at the start.
    frame : (3, 3) float64
        Axes of piece 0 at the start, as columns.
    start_deg : (n, 5) float64
        Angles at the start, columns as `angles.AXES`.
    joints : (K, 3) int32
        Rows (move, block, axis): an angle that changes, in order of time.
    spans : (K, 2) float64
        From which share of the move to which. A span of no length is a flip.
    angles_deg : (K, 2) float64
        From which angle to which, evenly.
    """

    origin: FloatArray
    frame: FloatArray
    start_deg: FloatArray
    joints: IntArray
    spans: FloatArray
    angles_deg: FloatArray

    def __len__(self) -> int:
        """Number of changes, K."""
        return len(self.joints)

    @property
    def n_flips(self) -> int:
        """Times at which a ball changes its y while nothing moves."""
        flips = self.joints[(self.spans[:, 0] == self.spans[:, 1]) & (self.joints[:, 2] != X)]
        return len(flips)


class Leg(NamedTuple):
    """What changes from one key station to the next."""

    move: int
    span: tuple[float, float]
    joints: IntArray  # (k, 2) block and axis
    angles_deg: FloatArray  # (k, 2)


def joint_trajectory(motion: Motion, substeps: int = 32) -> Trajectory:
    """The angles of all joints along a motion.

    Parameters
    ----------
    substeps : int
        Into how many even steps a TILT, PULL or BEND is cut. Other moves are exact in one.

    Raises
    ------
    ValueError
        If `substeps` is not positive, the number of joints is odd, or a move cannot be made.

    Examples
    --------
    >>> import numpy as np
    >>> from lineup import Motion
    >>> from lineup.kinematics import Move
    >>> from lineup.robot import joint_trajectory
    >>> path = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (1, 2, 0)])
    >>> motion = Motion(path, np.array([(Move.SWING, 1, 2, 0)]), 1.0, 90.0, True, "straight")
    >>> plan = joint_trajectory(motion)
    >>> plan.joints.tolist(), plan.angles_deg.tolist()
    ([[0, 0, 4]], [[90.0, 0.0]])
    """
    (start, *_), *legs = spans(motion, substeps)
    return trajectory_of(start, [leg_between(leg[0], leg[-1]) for leg in legs])


def spans(motion: Motion, substeps: int) -> Iterator[list[Station]]:
    """The first station alone; then, from each key station to the next, all from the one on."""
    if substeps < 1:
        raise ValueError(f"substeps must be at least 1, got {substeps}")
    span: list[Station] = []
    for station in stations(motion, substeps):
        span.append(station)
        if station.key:
            yield span
            span = [station]


def leg_between(start: Station, stop: Station) -> Leg:
    """What changes between two key stations."""
    joints = np.argwhere(np.abs(stop.angles - start.angles) > STILL)
    at = tuple(joints.T)
    angles = np.stack([start.angles[at], stop.angles[at]], axis=1)
    begin = start.share if start.move == stop.move else 0.0
    return Leg(stop.move, (begin, stop.share), joints.astype(np.int32), angles)


def trajectory_of(start: Station, legs: list[Leg]) -> Trajectory:
    """The legs in one table."""
    joints = [np.insert(leg.joints, 0, leg.move, axis=1) for leg in legs]
    times = [np.tile(leg.span, (len(leg.joints), 1)) for leg in legs]
    return Trajectory(
        origin=start.pose[0],
        frame=start.pieces[0],
        start_deg=start.angles,
        joints=np.concatenate([np.empty((0, 3), np.int32), *joints]).astype(np.int32),
        spans=np.concatenate([np.empty((0, 2)), *times]),
        angles_deg=np.concatenate([np.empty((0, 2)), *(leg.angles_deg for leg in legs)]),
    )


def angles_at(trajectory: Trajectory, times: Iterable[float]) -> Iterator[FloatArray]:
    """Angles (n, 5) in degrees at times that do not fall; move k lasts from time k to k + 1.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup.robot import angles_at, joint_trajectory
    >>> path = lu.layered_path(lu.VoxelSolid(np.ones((3, 2, 1), bool)))
    >>> motion = lu.unfold(path, "peel")
    >>> (last,) = angles_at(joint_trajectory(motion), [len(motion)])
    >>> float(abs(last).max())
    0.0
    """
    angles = trajectory.start_deg.copy()
    moves = trajectory.joints[:, :1] + trajectory.spans
    k = 0
    for time in times:
        while k < len(moves) and moves[k, 1] <= time:
            angles[tuple(trajectory.joints[k, 1:])] = trajectory.angles_deg[k, 1]
            k += 1
        now = angles.copy()
        for m in range(k, len(moves)):
            if moves[m, 0] >= time:
                break
            share = (time - moves[m, 0]) / (moves[m, 1] - moves[m, 0])
            begin, end = trajectory.angles_deg[m]
            now[tuple(trajectory.joints[m, 1:])] = begin + share * (end - begin)
        yield now


def chain_pose(
    angles_deg: FloatArray, origin: FloatArray, frame: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Positions (P, 3) of the joints and frames (n + 1, 3, 3) of the pieces, from piece 0 on.

    Examples
    --------
    >>> import numpy as np
    >>> from lineup.robot import chain_pose
    >>> chain_pose(np.array([[0, 0, 0, 0, 90.0]]), np.zeros(3), np.eye(3))[0].tolist()
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]
    """
    n = len(angles_deg)
    to_hinge = about(1, angles_deg[:, Y1]) @ about(2, angles_deg[:, Z1])
    onward = about(0, angles_deg[:, X]) @ about(2, angles_deg[:, Z2]) @ about(1, angles_deg[:, Y2])
    pieces, bars = np.empty((n + 1, 3, 3)), np.empty((2 * n, 3))
    pieces[0] = frame
    for i in range(n):
        hinge = pieces[i] @ to_hinge[i]
        pieces[i + 1] = hinge @ onward[i]
        bars[2 * i], bars[2 * i + 1] = hinge[:, 0], pieces[i + 1][:, 0]
    return np.vstack([origin, origin + bars[:-1].cumsum(axis=0)]), pieces
