"""Unfolding the projected path with bars of full width: a barrier instead of an energy.

The barrier is that of incremental potential contact (Li et al. 2020), on distances and bends.
"""

import numpy as np

from .._jit import kernel
from ..grid import FloatArray
from ..kinematics import QUARTER
from ..solid import Motion, VoxelPath
from ._bending import bend_motion
from ._descent import Descent
from ._linkage import Linkage, placed, project, share_along, straightness, torques
from .plan import DIAMETER, MAX_BEND_DEG

NEAR = 0.15
"""Bars nearer than their diameter and this push each other apart."""

SHARP = np.radians(5.0)
"""Bends sharper than their limit less this push back."""

BEND_ROOM = np.radians(0.002)
"""How far beyond the limit the barrier of bends stands, since a path starts at the limit."""

STIFFNESS = 0.2

MEMORY = 12

TINY = 1e-9
"""The spread of a single joint, where there is no bar across the axis."""


def barrier(
    path: VoxelPath,
    seed: int,
    *,
    diameter: float = DIAMETER,
    axes: tuple[int, ...] = (1, 0),
    steps: int = 2_000,
) -> Motion:
    """Spread the path projected along one of `axes` under barriers, by L-BFGS, then tilt.

    The first axis that gets it straight counts, or else the one that gets furthest. Every step
    surely keeps `diameter` between bars, and bends of at most 90 degrees.
    """
    del seed  # nothing is drawn
    return barrier_run(path, diameter, axes, steps)[0]


def barrier_run(
    path: VoxelPath, diameter: float, axes: tuple[int, ...], steps: int
) -> tuple[Motion, int]:
    """The same, and the number of steps made along all axes tried."""
    if not 0 < diameter < 1:
        raise ValueError(f"diameter must be above 0 and below 1, got {diameter}")
    if not axes or not set(axes) <= {0, 1, 2}:
        raise ValueError(f"axes must be some of 0, 1 and 2, got {axes}")
    if steps < 0:
        raise ValueError(f"steps must be at least 0, got {steps}")
    motions, far, n_steps = [], [], 0
    for axis in axes:
        linkage = project(path.voxels, axis)
        descent = barrier_descent(linkage, diameter)
        run = descent.run(steps)
        n_steps += run.steps
        motions.append(bend_motion(path.voxels, linkage, run, diameter, MAX_BEND_DEG))
        far.append(straightness(placed(descent.angles)))
        if motions[-1].straight:
            return motions[-1], n_steps
    return motions[int(np.argmax(far))], n_steps


def barrier_descent(linkage: Linkage, diameter: float) -> Descent:
    """L-BFGS on -m log of the squared radius of gyration, with barriers."""
    limit = np.pi / 2 + BEND_ROOM

    def objective(angles: FloatArray) -> tuple[float, FloatArray]:
        place = placed(angles)
        value, slope = contact_barrier(linkage, place, diameter)
        if value == np.inf:
            return value, angles
        offset = place - place.mean(axis=0)
        spread, m = max((offset * offset).sum(), TINY), max(len(angles), 1)
        value -= m * np.log(spread / m)
        gradient = torques(angles, slope - 2 * m * offset / spread)
        return value + bend_barrier(linkage, angles, limit, gradient), gradient

    return Descent(linkage, objective, diameter=diameter, memory=MEMORY, max_bend=QUARTER)


@kernel
def contact_barrier(
    linkage: Linkage, place: FloatArray, diameter: float
) -> tuple[float, FloatArray]:
    """Sum of -(1 - x)^2 log x over pairs at distance diameter + x NEAR, x < 1, and derivative."""
    value, slope = 0.0, np.zeros(place.shape)
    for k in range(linkage.n_apart):
        p, q, r = linkage.pairs[k, 0], linkage.pairs[k, 1], linkage.pairs[k, 2]
        x, y = place[p, 0] - place[q, 0], place[p, 1] - place[q, 1]
        far = diameter + NEAR + (r - q)
        if x * x + y * y < far * far:
            t = share_along(place, p, q, r)
            x += t * (place[q, 0] - place[r, 0])
            y += t * (place[q, 1] - place[r, 1])
            distance = np.sqrt(x * x + y * y)
            height, tilt = _barrier((distance - diameter) / NEAR)
            value += height
            if tilt != 0.0:
                tilt /= NEAR * distance
                slope[p, 0] += tilt * x
                slope[p, 1] += tilt * y
                slope[q, 0] -= tilt * (1 - t) * x
                slope[q, 1] -= tilt * (1 - t) * y
                slope[r, 0] -= tilt * t * x
                slope[r, 1] -= tilt * t * y
    return value, slope


@kernel
def bend_barrier(linkage: Linkage, angles: FloatArray, limit: float, gradient: FloatArray) -> float:
    """The same for bends at limit - x SHARP; its derivative is added to `gradient`."""
    value = 0.0
    for b in linkage.corners:
        bend = angles[b + 1] - angles[b]
        height, tilt = _barrier((limit - abs(bend)) / SHARP)
        value += height
        tilt *= -np.sign(bend) / SHARP
        gradient[b + 1] += tilt
        gradient[b] -= tilt
    return value


@kernel
def _barrier(x: float) -> tuple[float, float]:
    """STIFFNESS times -(1 - x)^2 log x for 0 < x < 1, and its derivative; nothing beyond."""
    if x >= 1.0:
        return 0.0, 0.0
    if x <= 0.0:
        return np.inf, 0.0
    log = np.log(x)
    return -STIFFNESS * (1 - x) ** 2 * log, STIFFNESS * (1 - x) * (2 * log - (1 - x) / x)
