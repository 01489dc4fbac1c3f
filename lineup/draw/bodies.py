"""Solids and chains as bodies to be drawn."""

import numpy as np
from numpy.typing import ArrayLike

from ..grid import FloatArray, colour, surface
from ..solid import VoxelSolid
from .view import Capsules, Cubes, colours

_BLOCK_RADIUS, _HINGE_RADIUS = 0.43, 0.2
_CLAY = np.array([(233, 196, 134), (214, 174, 110)], np.uint8)


def chain_body(positions: ArrayLike) -> Capsules:
    """A chain of blocks and hinges, coloured along its length.

    Every other bar is a block, the fat rods; the bars between them are hinges. A last joint that
    no block has left over, where the number of joints is odd, gets a fat bar too.
    """
    pose = joints(positions)
    block = np.arange(len(pose) - 1) % 2 == 0
    block[-1] = True
    radius = np.where(block, _BLOCK_RADIUS, _HINGE_RADIUS)
    return Capsules(pose[:-1], pose[1:], colours(len(pose) - 1), radius)


def joints(positions: ArrayLike) -> FloatArray:
    """Positions as (P, 3) floats.

    Raises
    ------
    ValueError
        If they are not two or more finite points with three coordinates each.
    """
    pose = np.asarray(positions, dtype=float)
    if pose.ndim != 2 or pose.shape[1] != 3 or len(pose) < 2 or not np.isfinite(pose).all():
        raise ValueError(
            f"a chain is drawn from two or more finite points (P, 3), got shape {pose.shape}"
        )
    return pose


def solid_body(solid: VoxelSolid) -> Cubes:
    """The surface voxels of a solid in the two tones of a checkerboard, so that each is seen."""
    voxels = np.argwhere(surface(solid.occupancy))
    return Cubes(voxels.astype(float), _CLAY[colour(voxels)], 1.0)


def left_out_body(solid: VoxelSolid, pose: FloatArray) -> Cubes:
    """The voxels of a solid that no joint lies in, small and grey; there may be none."""
    left = solid.occupancy.copy()
    visited = np.rint(pose).astype(int)
    left[tuple(visited[((visited >= 0) & (visited < left.shape)).all(axis=1)].T)] = False
    centre = np.argwhere(left).astype(float)
    return Cubes(centre, np.full(centre.shape, 214, np.uint8), 0.6)
