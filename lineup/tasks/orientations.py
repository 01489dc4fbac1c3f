"""Task `orientation`: one model set on another side, or tilted (Section 9)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..bounds import path_bound
from ..folding import fold
from ..layered import layered_path
from ..reeb import reeb_graph, traverse
from ..solid import VoxelSolid
from ._common import solid_of, source_of

COLUMNS = (
    *("source", "lean_deg", "n_voxels", "iou", "layers", "nodes", "mscs"),
    *("layered", "folded", "bound"),
)
"""What is in a row."""

Vector = tuple[float, float, float]

AXES: dict[str, Vector] = {
    "+x": (1.0, 0.0, 0.0),
    "-x": (-1.0, 0.0, 0.0),
    "+y": (0.0, 1.0, 0.0),
    "-y": (0.0, -1.0, 0.0),
    "+z": (0.0, 0.0, 1.0),
    "-z": (0.0, 0.0, -1.0),
}


def orientation(
    model: str,
    voxels: int,
    up: str = "+z",
    turn: int = 0,
    tilt_deg: float = 0.0,
    azimuth_deg: float = 0.0,
    seed: int = 0,
    *,
    folder: Path,
    progress: Callable[[str], None],
) -> dict[str, Any]:
    """Paths of a model with another direction up, and how its layers hang together then.

    `up` and `turn` quarter turns about it give the 24 axis orientations; `tilt_deg` from +z
    towards `azimuth_deg` gives any direction, for `up` +z alone.
    """
    direction = direction_of(up, tilt_deg, azimuth_deg)
    if turn not in range(4):
        raise ValueError(f"turn must be 0, 1, 2 or 3 quarter turns, got {turn}")
    progress("voxelize")
    solid = turned(solid_of(model, voxels, direction), turn)
    graph = reeb_graph(solid)
    progress("layered")
    layered = layered_path(solid, seed=seed)
    progress("fold")
    folded = fold(solid, seed=seed).path
    return {
        "source": source_of(solid),
        "lean_deg": lean_deg(direction),
        "n_voxels": solid.size,
        "iou": solid.source["iou"],
        "layers": solid.occupancy.shape[2],
        "nodes": len(graph),
        "mscs": len(traverse(graph).mscs),
        "layered": layered.coverage(solid),
        "folded": folded.coverage(solid),
        "bound": path_bound(solid) / solid.size,
    }


def direction_of(up: str, tilt_deg: float, azimuth_deg: float) -> str | Vector:
    """The direction that becomes +z, as `voxelize` takes it."""
    if up not in AXES:
        raise ValueError(f"up must be one of {', '.join(AXES)}, got {up!r}")
    if tilt_deg and up != "+z":
        raise ValueError(f"a tilt is from up +z, and up is {up}")
    if not tilt_deg:
        return up
    tilt, azimuth = math.radians(tilt_deg), math.radians(azimuth_deg)
    level = math.sin(tilt)
    return level * math.cos(azimuth), level * math.sin(azimuth), math.cos(tilt)


def lean_deg(direction: str | Vector) -> float:
    """The angle between a direction and +z."""
    height = AXES[direction][2] if isinstance(direction, str) else direction[2]
    return round(math.degrees(math.acos(height)), 6)


def turned(solid: VoxelSolid, turn: int) -> VoxelSolid:
    """A solid after so many quarter turns about z, from x to y."""
    return replace(solid, occupancy=np.rot90(solid.occupancy, turn, axes=(0, 1)))
