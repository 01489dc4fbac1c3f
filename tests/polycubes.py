"""Random solids for property tests."""

from typing import Any

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy import ndimage

from lineup import grid

STEPS = [tuple(d) for d in grid.DIRECTIONS.tolist()]


@st.composite
def polycubes(draw: Any, max_voxels: int = 40) -> NDArray[np.bool_]:
    """A bool array with one face-connected, void-free component of 1 to `max_voxels` voxels."""
    seen = {(0, 0, 0)}
    voxels, rim = [], [(0, 0, 0)]
    n = draw(st.integers(1, max_voxels))
    for choice in draw(st.lists(st.integers(0, 2**16), min_size=n, max_size=n)):
        x, y, z = rim.pop(choice % len(rim))
        voxels.append((x, y, z))
        around = [(x + dx, y + dy, z + dz) for dx, dy, dz in STEPS]
        rim += [place for place in around if place not in seen]
        seen.update(around)
    points = np.array(voxels)
    points -= points.min(axis=0)
    occupancy = np.zeros(points.max(axis=0) + 1, bool)
    occupancy[tuple(points.T)] = True
    assume(not grid.voids(occupancy).any())
    return occupancy


def blob(seed: int, side: int = 12) -> NDArray[np.bool_]:
    """The largest part of thresholded noise, its voids filled: layers with interiors, limbs."""
    rng = np.random.default_rng(seed)
    noise = ndimage.gaussian_filter(rng.random((side,) * 3), rng.uniform(1, 3, 3))
    label, _ = grid.components(noise > np.quantile(noise, rng.uniform(0.3, 0.7)))
    part: NDArray[np.bool_] = label == np.bincount(label.ravel())[1:].argmax() + 1
    return part | grid.voids(part)
