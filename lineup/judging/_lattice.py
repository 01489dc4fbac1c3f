"""Facts about lattice poses that judging rests on."""

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
