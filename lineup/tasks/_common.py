"""What tasks share: the solid that settings name, and the path or folding through it."""

from __future__ import annotations

from pathlib import Path

from .. import grid
from ..catalog import model as model_of
from ..folding import fold
from ..layered import layered_path
from ..refinement import refine
from ..solid import Folding, VoxelPath, VoxelSolid
from ..voxelization import voxelize

GROWTH = "growth"
"""The one way to make a path that is no path method: the folding by certified growth."""


def solid_of(
    model: str, voxels: int, up: str | tuple[float, float, float] | None = None
) -> VoxelSolid:
    """A model of the catalogue, or a mesh file (it has an ending), as voxels."""
    if Path(model).suffix:
        return voxelize(model, voxels, "+z" if up is None else up)
    return model_of(model, voxels, up)


def source_of(solid: VoxelSolid) -> str:
    """Where its mesh came from: "folder", "original", "procedural"; "mesh" for a file."""
    return str(solid.source.get("kind", "solid"))


def made(solid: VoxelSolid, method: str, seed: int) -> VoxelPath | Folding:
    """A path by a key of `PATH_METHODS`, or the folding by "growth"."""
    return fold(solid, seed=seed) if method == GROWTH else layered_path(solid, method, seed)


def surface_visited(path: VoxelPath, solid: VoxelSolid) -> float:
    """Share of the surface voxels, of the refined solid if the path is on one, that it visits."""
    surface = grid.surface(refine(solid, path.refinement).occupancy)
    return float(surface[tuple(path.voxels.T)].sum() / surface.sum())
