"""Voxel grids: neighbours, surface, colour (Section 4.1, Figures 5 and 10).

Positions are integers (x, y, z) with axis 2 up. Two voxels are adjacent when they share a face.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int32]
FloatArray = NDArray[np.float64]

DIRECTIONS = np.array(
    [(1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, 0, 0), (0, -1, 0), (0, 0, -1)], dtype=np.int32
)
"""The six axis directions; the opposite of direction d is ``(d + 3) % 6``."""

LETTERS = "ENUWSD"
"""East, north, up, west, south, down: one letter for each row of `DIRECTIONS`."""

_FACES = ndimage.generate_binary_structure(3, 1)
_IN_LAYER = _FACES.copy()
_IN_LAYER[:, :, [0, 2]] = False


def components(occupancy: BoolArray) -> tuple[IntArray, int]:
    """Label the face-connected components of a grid: (X, Y, Z) int32 from 1, and their number."""
    label, n = ndimage.label(occupancy, structure=_FACES)
    return label.astype(np.int32), int(n)


def layer_components(occupancy: BoolArray) -> tuple[IntArray, int]:
    """Label the 4-connected components of every layer; no component spans two layers."""
    label, n = ndimage.label(occupancy, structure=_IN_LAYER)
    return label.astype(np.int32), int(n)


def voids(occupancy: BoolArray) -> BoolArray:
    """Empty voxels that no face-connected way through empty voxels joins to the outside."""
    filled: BoolArray = ndimage.binary_fill_holes(occupancy, structure=_FACES)
    return filled & ~occupancy


def surface(occupancy: BoolArray) -> BoolArray:
    """Voxels of the solid with at least one face on the outside (Section 5 keeps them)."""
    inner: BoolArray = ndimage.binary_erosion(occupancy, structure=_FACES, border_value=0)
    return occupancy & ~inner


def colour(voxels: NDArray[Any]) -> NDArray[Any]:
    """Checkerboard colour 0 or 1 of each row of (..., 3) positions (Figure 10)."""
    parity: NDArray[Any] = np.asarray(voxels).sum(axis=-1) % 2
    return parity


def bar_directions(voxels: NDArray[Any]) -> NDArray[np.int8]:
    """Direction 0..5 of each bar of a lattice path, (P - 1,) int8.

    Raises
    ------
    ValueError
        If two consecutive voxels do not share a face.
    """
    steps = np.diff(np.asarray(voxels), axis=0)
    if not (np.abs(steps).sum(axis=1) == 1).all():
        bad = int(np.flatnonzero(np.abs(steps).sum(axis=1) != 1)[0])
        raise ValueError(f"voxels {bad} and {bad + 1} of the path do not share a face")
    axis = np.abs(steps).argmax(axis=1)
    negative = steps.sum(axis=1) < 0
    directions: NDArray[np.int8] = (axis + 3 * negative).astype(np.int8)
    return directions
