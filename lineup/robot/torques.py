"""Torques that hold a chain against gravity, one piece of it clamped and nothing else in touch."""

import numpy as np

from ..grid import FloatArray
from .angles import Y1, Y2, Z1, Z2, X, about
from .bodies import Bodies, masses

GRAVITY = 9.81
"""Metres a second squared on Earth."""


def gravity_torques(
    pose: FloatArray,
    pieces: FloatArray,
    angles: FloatArray,
    bodies: Bodies,
    base: int,
    gravity: FloatArray,
) -> FloatArray:
    """Torques (n, 5) in N m that the joints must give for the chain to rest.

    Parameters
    ----------
    pose, pieces, angles : (P, 3), (n + 1, 3, 3), (n, 5) float64
        As in `angles.Station`.
    base : int
        The piece that is clamped, 0 to n.
    gravity : (3,) float64
        In m/s^2, along the axes of `pose`.

    Notes
    -----
    A joint bears the moment, about its axis, of all that is on its side away from the base.
    Positive torque increases the angle.
    """
    n = len(angles)
    weights, at = masses(n, bodies), bodies.pitch_m * pose
    moments = weights[:, None] * _centres(at, pieces, bodies)
    weight_from, moment_from = _sums_from(weights[:, None])[:, 0], _sums_from(moments)
    axes = _axes(pose, pieces, angles)
    outward = np.arange(n) >= base
    torques = np.empty((n, 5))
    for ball, joints in ((0, [Y1, Z1, X]), (1, [Y2, Z2])):
        first = 2 * np.arange(n) + 1 + ball  # of what lies beyond the ball
        weight = np.where(outward, weight_from[first], weight_from[0] - weight_from[first])
        moment = np.where(outward[:, None], moment_from[first], moment_from[0] - moment_from[first])
        pull = np.cross(moment - weight[:, None] * at[ball::2], gravity)
        side = np.where(outward, -1.0, 1.0)
        torques[:, joints] = side[:, None] * np.einsum("nki,ni->nk", axes[:, joints], pull)
    return torques


def _axes(pose: FloatArray, pieces: FloatArray, angles: FloatArray) -> FloatArray:
    """Unit vectors (n, 5, 3) about which the joints turn what is after them."""
    axes = np.empty((len(angles), 5, 3))
    axes[:, Y1] = pieces[:-1, :, 1]
    axes[:, Z1] = (pieces[:-1] @ about(1, angles[:, Y1]))[:, :, 2]
    axes[:, X] = pose[1::2] - pose[0::2]
    axes[:, Z2] = (pieces[1:] @ about(1, -angles[:, Y2]))[:, :, 2]
    axes[:, Y2] = pieces[1:, :, 1]
    return axes


def _centres(at: FloatArray, pieces: FloatArray, bodies: Bodies) -> FloatArray:
    """Centres of mass of piece 0, hinge 0, piece 1, ..., piece n, (2 n + 1, 3) in metres."""
    middles = (at[1:] + at[:-1]) / 2
    first = at[0] - bodies.end_com_m * pieces[0, :, 0]
    last = at[-1] + bodies.end_com_m * pieces[-1, :, 0]
    return np.vstack([first, middles, last])


def _sums_from(rows: FloatArray) -> FloatArray:
    """Sums of the rows from each on, and of none."""
    sums: FloatArray = np.vstack([rows, np.zeros_like(rows[:1])])[::-1].cumsum(axis=0)[::-1]
    return sums
