"""Paths made by hand or at random, for tests of what folded chains bear."""

import numpy as np

import lineup as lu


def boustrophedon(*shape):
    """All voxels of a box on one path, row after row and layer after layer."""
    rows = []
    for z in range(shape[2]):
        ys = range(shape[1]) if z % 2 == 0 else range(shape[1] - 1, -1, -1)
        for k, y in enumerate(ys):
            forth = (z * shape[1] + k) % 2 == 0
            rows += [(x, y, z) for x in (range(shape[0]) if forth else range(shape[0] - 1, -1, -1))]
    return np.array(rows)


def walk(seed, length, box):
    """A random self-avoiding walk in a box, of at most so many voxels."""
    rng = np.random.default_rng(seed)
    at = tuple(int(rng.integers(side)) for side in box)
    found = [at]
    while len(found) < length:
        steps = np.concatenate([np.eye(3, dtype=int), -np.eye(3, dtype=int)]) + at
        free = [
            tuple(step)
            for step in steps.tolist()
            if all(0 <= c < side for c, side in zip(step, box, strict=True))
            and tuple(step) not in found
        ]
        if not free:
            break
        at = free[int(rng.integers(len(free)))]
        found.append(at)
    return np.array(found)


def path(voxels):
    return lu.VoxelPath(np.asarray(voxels))


def level(n):
    """So many voxels along the x axis."""
    return path([(x, 0, 0) for x in range(n)])


TRIPOD = path(
    [
        *((2, 0, 0), (2, 1, 0), (2, 1, 1), (1, 1, 1), (1, 2, 1), (1, 2, 0)),
        *((0, 2, 0), (0, 2, 1), (0, 2, 2), (0, 1, 2), (0, 0, 2)),
    ]
)
"""Stands on three corners where (1, 1, 1) is up."""

LEANING = path(
    [
        *((0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0), (4, 0, 0)),
        *((4, 0, 1), (4, 0, 2), (4, 0, 3), (5, 0, 3), (6, 0, 3), (7, 0, 3)),
    ]
)
"""A foot of five voxels, and a heavy head that reaches out beyond its toe."""
