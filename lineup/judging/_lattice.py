"""Facts about lattice poses that judging rests on."""

from itertools import permutations, product

import numpy as np
from numpy.typing import NDArray


def not_simple(voxels: NDArray[np.int64]) -> tuple[str, int]:
    """Why these positions are no simple lattice path, and at which step; ("", -1) if they are."""
    if not len(voxels):
        return "it has no voxel", -1
    steps = np.abs(np.diff(voxels, axis=0)).sum(axis=1)
    if (steps != 1).any():
        k = int(np.flatnonzero(steps != 1)[0])
        return f"voxels {k} and {k + 1} do not share a face", k
    order = np.lexsort(voxels.T)
    again = (voxels[order[1:]] == voxels[order[:-1]]).all(axis=1)
    if again.any():
        pairs = np.sort(np.stack([order[1:][again], order[:-1][again]], axis=1), axis=1)
        first, second = (int(x) for x in pairs[pairs[:, 1].argmin()])
        return f"steps {first} and {second} visit one voxel", second
    return "", -1


def largest_bend(pose: NDArray[np.int64]) -> tuple[float, int]:
    """Largest bend of a lattice pose, 0, 90 or 180 degrees, and the first joint that has it."""
    bars = np.diff(pose, axis=0)
    if len(bars) < 2:
        return 0.0, -1
    cosines = (bars[1:] * bars[:-1]).sum(axis=1)
    k = int(cosines.argmin())
    return 90.0 * float(1 - cosines[k]), k + 1


def congruent(pose: NDArray[np.int64], goal: NDArray[np.int64]) -> bool:
    """Whether a turn and a shift, but no mirror, bring pose to goal, joint by joint."""
    if pose.shape != goal.shape:
        return False
    bars, wanted = np.diff(pose, axis=0), np.diff(goal, axis=0)
    for axes in permutations(range(3)):
        for signs in product((-1, 1), repeat=3):
            turn = np.zeros((3, 3), np.int64)
            turn[range(3), axes] = signs
            if round(np.linalg.det(turn)) == 1 and np.array_equal(bars @ turn.T, wanted):
                return True
    return False
