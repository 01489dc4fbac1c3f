"""One look at a whole motion: its joint angles, and what gravity asks of each joint."""

import numpy as np

from .._record import record
from ..grid import FloatArray, IntArray
from ..solid import Motion
from .angles import EVEN, Station
from .bodies import Bodies
from .torques import gravity_torques
from .trajectory import Trajectory, chain_pose, leg_between, spans, trajectory_of
from .tree import base_joint


@record
class Survey:
    """What a motion comes to as one of joints.

    Attributes
    ----------
    trajectory : Trajectory
    leg_nm : (K,) float64
        Largest torque of each change of the trajectory while it is made, in N m.
    held_nm, moved_nm : (n, 5) float64
        Largest torque of each joint over the whole motion, and while it moves.
    held_at, moved_at : (n, 5) int32
        The move in which that is, -1 for the start or for none.
    most_deg, least_deg : (n, 5) float64
        How far each angle goes.
    deviation : float
        How far joints are from the motion in the midst of steps, in pitches; 0 where evenly
        changing angles do just what the moves do.
    origin, frame : (3,), (3, 3) float64
        Of the base, at the start.
    """

    trajectory: Trajectory
    leg_nm: FloatArray
    held_nm: FloatArray
    moved_nm: FloatArray
    held_at: IntArray
    moved_at: IntArray
    most_deg: FloatArray
    least_deg: FloatArray
    deviation: float
    origin: FloatArray
    frame: FloatArray


def surveyed(motion: Motion, bodies: Bodies, base: int, gravity: float, substeps: int) -> Survey:
    """Look at every station of a motion (`robot.angles`).

    Parameters
    ----------
    gravity : float
        In m/s^2, downward along axis 2 of the start; the base is clamped as it is there.
    """
    (start, *_), *rest = spans(motion, substeps)
    frame = start.pieces[base]
    down = frame.T @ np.array((0.0, 0.0, -gravity))

    def torques(station: Station) -> FloatArray:
        turned = station.pieces[base] @ down
        found = gravity_torques(station.pose, station.pieces, station.angles, bodies, base, turned)
        return np.abs(found)

    held, moved = torques(start), np.zeros_like(start.angles)
    held_at, moved_at = (np.full(held.shape, -1, np.int32) for _ in range(2))
    most, least = start.angles.copy(), start.angles.copy()
    legs, leg_nm, deviation, before = [], [np.empty(0)], 0.0, held
    for span in rest:
        found = np.stack([before, *map(torques, span[1:])])
        leg = leg_between(span[0], span[-1])
        legs.append(leg)
        largest, before = found.max(axis=0), found[-1]
        leg_nm.append(largest[tuple(leg.joints.T)])
        _note(held, held_at, largest, leg.move)
        moving = np.zeros(held.shape, bool)
        moving[tuple(leg.joints.T)] = True
        _note(moved, moved_at, np.where(moving, largest, 0), leg.move)
        np.maximum(most, span[-1].angles, out=most)
        np.minimum(least, span[-1].angles, out=least)
        deviation = max(deviation, _deviation(span, base))
    return Survey(
        trajectory=trajectory_of(start, legs),
        leg_nm=np.concatenate(leg_nm),
        held_nm=held,
        moved_nm=moved,
        held_at=held_at,
        moved_at=moved_at,
        most_deg=most,
        least_deg=least,
        deviation=deviation,
        origin=start.pose[base_joint(len(held), base)],
        frame=frame,
    )


def _note(most: FloatArray, at: IntArray, found: FloatArray, move: int) -> None:
    """Take note of what is larger than before."""
    larger = found > most
    most[larger], at[larger] = found[larger], move


def _deviation(span: list[Station], base: int) -> float:
    """How far joints are from where even angles have them, in the midst of a step."""
    start, *between, stop = span
    begin = start.share if start.move == stop.move else 0.0
    joint, most = base_joint(len(start.angles), base), 0.0
    for station in between:
        share = (station.share - begin) / (stop.share - begin)
        angles = start.angles + share * (stop.angles - start.angles)
        if np.abs(station.angles - angles).max() < EVEN:
            continue
        pose, pieces = chain_pose(angles, np.zeros(3), np.eye(3))
        turn = station.pieces[base] @ pieces[base].T
        there = (pose - pose[joint]) @ turn.T + station.pose[joint]
        most = max(most, float(np.linalg.norm(there - station.pose, axis=1).max()))
    return most
