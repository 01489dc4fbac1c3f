"""Solids that are hard to fold: rods, rings, combs, lattices, shells, trees, clusters."""

import numpy as np
from scipy import ndimage

import lineup as lu
from lineup import grid


def hostile(kind, seed, n):
    """A random solid of a kind, of about n voxels (within a factor of three)."""
    rng = np.random.default_rng(seed)
    return lu.mend(np.ascontiguousarray(turned(KINDS[kind](rng, n), rng)))


def turned(occupancy, rng):
    """One of the ways to lay a solid down."""
    return np.transpose(occupancy, rng.permutation(3))[:: rng.choice((-1, 1))]


def rod(rng, n):
    """A stick that turns corners, one to three voxels thick."""
    thick = int(rng.integers(1, 4))
    centre, points = np.zeros(3, int), []
    while len(points) * thick**2 < n:
        step = grid.DIRECTIONS[rng.integers(6)]
        for _ in range(int(rng.integers(thick + 2, 12))):
            points.append(centre)
            centre = centre + step
    return swollen(points, thick)


def tree(rng, n):
    """A tall trunk with thin branches, each from a random point of what is there."""
    points = [np.array((0, 0, z)) for z in range(n // 6)]
    while len(points) < n // 2:
        at, step = points[rng.integers(len(points))], grid.DIRECTIONS[rng.integers(6)]
        points += [at + k * step for k in range(1, int(rng.integers(3, 12)))]
    return swollen(points, 1 + int(rng.integers(2)))


def swollen(points, thick):
    points = np.unique(points, axis=0)
    points -= points.min(axis=0)
    occupancy = np.zeros(points.max(axis=0) + thick, bool)
    for shift in np.ndindex(thick, thick, thick):
        occupancy[tuple((points + shift).T)] = True
    return occupancy


def torus(rng, n):
    """A ring, round and thick or thin."""
    ratio = rng.uniform(1.5, 6)
    radius = (n / (2 * np.pi**2 * ratio)) ** (1 / 3)
    x, y, z = axes(ratio * radius + radius)
    return (np.hypot(x, y) - ratio * radius) ** 2 + z**2 <= max(radius, 0.8) ** 2


def shell(rng, n):
    """A hollow ball, some voxels thick, with windows."""
    thick = int(rng.integers(1, 4))
    radius = np.sqrt(n / (4 * np.pi * thick)) + thick
    x, y, z = axes(radius)
    r = np.sqrt(x**2 + y**2 + z**2)
    windows = rng.normal(size=(int(rng.integers(1, 7)), 3))
    windows /= np.linalg.norm(windows, axis=1)[:, None]
    closest = np.max([(x * a + y * b + z * c) / (r + 1e-9) for a, b, c in windows], axis=0)
    return (r <= radius) & (r > radius - thick) & (closest < rng.uniform(0.85, 0.95))


def comb(rng, n):
    """A plate with long teeth on one or both sides."""
    thick, gap, side = int(rng.integers(1, 3)), int(rng.integers(1, 3)), int(rng.integers(3, 6))
    teeth = np.tile(np.arange(thick + gap) < thick, side)
    cross = teeth[:, None] & teeth
    length = max(2, int(n / cross.sum()) // 2)
    occupancy = np.repeat(cross[:, :, None], 2 * length, axis=2)
    if rng.random() < 0.5:
        occupancy = occupancy[:, :, length:]
    occupancy[:, :, occupancy.shape[2] // 2] = True
    return occupancy


def lattice(rng, n):
    """A scaffold of rods."""
    thick, gap = int(rng.integers(1, 4)), int(rng.integers(1, 4))
    period = thick + gap
    fill = (thick**2 * (3 * period - 2 * thick)) / period**3
    side = max(1, round((n / fill) ** (1 / 3) / period)) * period + thick
    solid = (np.indices((side,) * 3) % period) < thick
    return solid.sum(axis=0) >= 2


def noise(rng, n):
    """What a random field leaves above a level."""
    side = max(4, int((2.5 * n) ** (1 / 3)))
    field = ndimage.gaussian_filter(rng.random((side,) * 3), rng.uniform(0.7, 2.5))
    return field > np.quantile(field, 0.5)


def cluster(rng, n):
    """A polycube that grew voxel by voxel."""
    points, rim = {(0, 0, 0)}, [(0, 0, 0)]
    while len(points) < n:
        at = np.array(rim[rng.integers(len(rim))])
        new = tuple((at + grid.DIRECTIONS[rng.integers(6)]).tolist())
        if new not in points:
            points.add(new)
            rim.append(new)
    return swollen(np.array(sorted(points)), 1)


def axes(reach):
    reach = int(reach) + 1
    return np.meshgrid(*3 * [np.arange(-reach, reach + 1)], indexing="ij")


KINDS = {
    "rod": rod,
    "tree": tree,
    "torus": torus,
    "shell": shell,
    "comb": comb,
    "lattice": lattice,
    "noise": noise,
    "cluster": cluster,
}
