"""Algorithm 4 of the paper: energy-driven unfolding of the projected path (Section 6).

The energy is that of Cantarella, Demaine, Iben and O'Brien (An energy-driven approach to linkage
unfolding, 2004), summed over joints and bars of one depth.
"""

import numpy as np

from .._jit import kernel
from ..grid import FloatArray
from ..solid import Motion, VoxelPath
from ._bending import bend_motion
from ._descent import Descent
from ._linkage import Linkage, largest_bend, placed, project, torques
from ._safety import TOLERANCE, least_clearance
from .plan import DIAMETER, MAX_BEND_DEG

CROSSING = 1e-3
"""The paper's bars have no width; a step must surely keep them this far from crossing."""


def energy(path: VoxelPath, seed: int, *, axis: int = 1, steps: int = 5_000) -> Motion:
    """Descend the energy of the path projected along `axis` (the paper's is y), then tilt.

    The flow knows bars of no width. What the motion says of its diameter and bend is what its
    moves turn out to keep.
    """
    del seed  # nothing is drawn
    return energy_run(path, axis, steps)[0]


def energy_run(path: VoxelPath, axis: int, steps: int) -> tuple[Motion, int]:
    """The same, and the number of steps made."""
    if axis not in (0, 1, 2):
        raise ValueError(f"axis must be 0, 1 or 2, got {axis}")
    if steps < 0:
        raise ValueError(f"steps must be at least 0, got {steps}")
    linkage = project(path.voxels, axis)
    run = energy_descent(linkage).run(steps)
    bend_deg = largest_bend(linkage, run.rows)
    beside = np.cos(np.radians(max(bend_deg - 90, 0)))  # bars 0 and 2 of a sharp bend
    diameter = min(DIAMETER, float(beside) - TOLERANCE, least_clearance(linkage, run.rows))
    motion = bend_motion(path.voxels, linkage, run, diameter, max(MAX_BEND_DEG, bend_deg))
    return motion, run.steps


def energy_descent(linkage: Linkage) -> Descent:
    """The gradient flow of the energy in angles, each step under a safe cap."""

    def objective(angles: FloatArray) -> tuple[float, FloatArray]:
        value, slope = elliptic_energy(linkage, placed(angles))
        return value, torques(angles, slope)

    return Descent(linkage, objective, diameter=CROSSING)


@kernel
def elliptic_energy(linkage: Linkage, place: FloatArray) -> tuple[float, FloatArray]:
    """Sum of 1 / (|pq| + |pr| - |qr|)^2 over all pairs, and its derivative by the joints."""
    energy, slope = 0.0, np.zeros(place.shape)
    for k in range(len(linkage.pairs)):
        p, q, r = linkage.pairs[k, 0], linkage.pairs[k, 1], linkage.pairs[k, 2]
        ax, ay = place[p, 0] - place[q, 0], place[p, 1] - place[q, 1]
        bx, by = place[p, 0] - place[r, 0], place[p, 1] - place[r, 1]
        a, b = np.sqrt(ax * ax + ay * ay), np.sqrt(bx * bx + by * by)
        detour = a + b - (r - q)
        energy += 1 / (detour * detour)
        factor = -2 / (detour * detour * detour)
        ax, ay = factor * ax / a, factor * ay / a
        bx, by = factor * bx / b, factor * by / b
        slope[p, 0] += ax + bx
        slope[p, 1] += ay + by
        slope[q, 0] -= ax
        slope[q, 1] -= ay
        slope[r, 0] -= bx
        slope[r, 1] -= by
    return energy, slope
