"""A shell in place of a solid (Section 9, future work): as thick as need be, and vented.

A void-free solid may have no enclosed empty component, so every cavity gets a vent: a straight
hole, one voxel wide, from its floor down to the outside.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from scipy import ndimage

from . import grid
from ._record import of_kind
from .grid import BoolArray, IntArray
from .solid import VoxelSolid

Thickness = int | Sequence[int] | Callable[[int], int]
"""In voxels: one number, one for each layer from the lowest, or a function of the layer's z."""


def shell(solid: VoxelSolid, thickness: Thickness = 2) -> VoxelSolid:
    """The solid without what lies deeper than `thickness`, vented at the bottom (Section 9).

    The depth of a voxel is 1 at the outside and counts steps to any of 26 neighbours, so that
    walls are as thick across corners as across faces.

    Parameters
    ----------
    thickness : int, sequence of int, or function
        Thickness of the wall in voxels, at least 1: one for all, one for each layer from the
        lowest, or a function of z; thicker where the shell has to bear more, as at the bottom.

    Returns
    -------
    VoxelSolid
        One connected component without voids. ``source["shell"]`` holds the "thickness" of each
        layer, "saved" (voxels taken out, vents included), "vents" ([x, y, lowest z, highest z] of
        each hole), and "filled" (voxels of cavities that no vent could reach without cutting the
        shell apart; they stay solid).

    Raises
    ------
    ValueError
        If a thickness is no integer of at least 1, if there is not one for each layer, or if the
        shell would be no thinner than the solid.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> hollow = lu.shell(lu.VoxelSolid(np.ones((5, 5, 5), bool)), thickness=1)
    >>> hollow.size, hollow.source["shell"]["vents"]
    (97, [[2, 2, 0, 0]])
    """
    of_kind(solid, VoxelSolid)
    layers = _by_layer(thickness, solid.occupancy.shape[2])
    depth = depths(solid.occupancy)
    cavity = depth > np.array(layers)
    if not cavity.any():
        raise ValueError(
            f"a shell of {min(layers)} voxels is no thinner than the solid, whose deepest voxel "
            f"has depth {depth.max()}; {_advice(depth, layers)}"
        )
    occupancy = solid.occupancy & ~cavity
    label, n = grid.components(cavity)
    vents: list[list[int]] = []
    filled = 0
    for k in range(1, n + 1):
        part = label == k
        vent = _vent(occupancy, part)
        if vent is None:
            occupancy, filled = occupancy | part, filled + int(part.sum())
        else:
            x, y, low, high = vent
            occupancy[x, y, low : high + 1] = False
            vents.append(vent)
    if not vents:
        raise ValueError(
            f"no cavity of a shell of {min(layers)} voxels can be vented without cutting the "
            "shell apart; thicker walls, or more voxels, would do"
        )
    told: dict[str, Any] = {
        "thickness": layers,
        "saved": solid.size - int(occupancy.sum()),
        "vents": vents,
        "filled": filled,
    }
    return VoxelSolid(occupancy, solid.pitch, solid.name, {**solid.source, "shell": told})


def depths(occupancy: BoolArray) -> IntArray:
    """Depth of each voxel, 1 where one of its 26 neighbours is outside; 0 outside."""
    padded = np.pad(occupancy, 1)
    depth = ndimage.distance_transform_cdt(padded, metric="chessboard")[1:-1, 1:-1, 1:-1]
    return np.asarray(depth, np.int32)


def _by_layer(thickness: Thickness, n_layers: int) -> list[int]:
    if isinstance(thickness, int | np.integer):
        values: list[Any] = [thickness] * n_layers
    elif callable(thickness):
        values = [thickness(z) for z in range(n_layers)]
    else:
        values = list(thickness)
    if len(values) != n_layers:
        raise ValueError(f"thickness has {len(values)} numbers for {n_layers} layers")
    for value in values:
        whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
        if not whole or value < 1:
            raise ValueError(f"a thickness must be an integer of at least 1, got {value!r}")
    return [int(value) for value in values]


def _advice(depth: IntArray, layers: list[int]) -> str:
    if depth.max() <= 1:
        return "more voxels would do"
    return f"a thickness of {min(int(depth.max()) - 1, max(layers))} or less would do"


def _vent(occupancy: BoolArray, cavity: BoolArray) -> list[int] | None:
    """The shortest hole from the lowest cells of a cavity down, [x, y, low, high], if any.

    It must leave the shell in one piece and not end in another cavity. Where no hole down does,
    one from the ceiling up is taken.
    """
    enclosed = grid.voids(occupancy)
    ways = [_way(occupancy, *cell, step) for step in (-1, 1) for cell in _ends(cavity, step)]
    ordered = sorted((w for w in ways if w), key=lambda w: (w[4], w[3] - w[2], _far(w, cavity), w))
    for x, y, low, high, up in ordered:
        beyond = high + 1 if up else low - 1
        inside = 0 <= beyond < occupancy.shape[2]
        if inside and enclosed[x, y, beyond]:
            continue
        drilled = occupancy.copy()
        drilled[x, y, low : high + 1] = False
        if grid.components(drilled)[1] == 1:
            return [x, y, low, high]
    return None


def _ends(cavity: BoolArray, step: int) -> list[tuple[int, int, int]]:
    """The lowest (step -1) or the highest cell of each column of a cavity."""
    columns = np.argwhere(cavity.any(axis=2))
    ends = []
    for x, y in columns.tolist():
        heights = np.flatnonzero(cavity[x, y])
        ends.append((x, y, int(heights[0] if step < 0 else heights[-1])))
    return ends


def _way(
    occupancy: BoolArray, x: int, y: int, z: int, step: int
) -> tuple[int, int, int, int, int] | None:
    """Lowest and highest voxel on the straight way from a cell to the next empty one."""
    stop = z + step
    while 0 <= stop < occupancy.shape[2] and occupancy[x, y, stop]:
        stop += step
    low, high = (stop + 1, z - 1) if step < 0 else (z + 1, stop - 1)
    return (x, y, low, high, int(step > 0)) if low <= high else None


def _far(way: tuple[int, int, int, int, int], cavity: BoolArray) -> float:
    """How far a hole is from the middle of its cavity, seen from above; squared."""
    middle = np.argwhere(cavity)[:, :2].mean(axis=0)
    return round(float(((np.array(way[:2]) - middle) ** 2).sum()), 6)
