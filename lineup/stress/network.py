"""Rigid voxels joined by springs over their faces: stiffness, forces, balance (Figure 17).

A voxel is a rigid body with six degrees of freedom, its shift and its small turn about its centre.
A face is a layer of springs of no thickness, kn = E / a for each area against pulling and
ks = G / a against shearing, times the share that the bonding has. Integrated over the square face,
they resist bending by kn a^4 / 12 and twisting by ks a^4 / 6.

Here the pitch a, kn and the weight of a voxel are 1. Forces do not depend on E but through ratios
of stiffnesses; in newtons they are multiples of density * a^3 * g, tractions of density * a * g.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from ..grid import FloatArray
from .contacts import Points
from .faces import Faces

POISSON = 0.35
"""Of cured resin, an assumption; it sets the stiffness against shearing, E / (2 (1 + nu))."""

Matrix = Any  # scipy.sparse.csr_matrix, which is generic in some versions only


def stretch(faces: Faces, n: int) -> Matrix:
    """(6F, 6n): how far each face opens, shears, bends and twists for shifts and turns of voxels.

    Rows are the shift (3) and turn (3) of the second voxel against the first at the middle of the
    face; a support does not move.
    """
    arm = faces.normal / 2
    inner = faces.second >= 0
    blocks = [-_at(arm), _at(-arm[inner])]
    rows = [np.arange(len(faces)), np.flatnonzero(inner)]
    columns = [faces.first, faces.second[inner]]
    return _blocks(np.concatenate(blocks), np.concatenate(rows), np.concatenate(columns), n)


def springs(faces: Faces) -> FloatArray:
    """(6F,) stiffness of each row of `stretch`."""
    along = np.abs(faces.normal)
    shear = 1 / (2 * (1 + POISSON))
    shift = along + (1 - along) * shear
    turn = along * shear / 6 + (1 - along) / 12
    stiffness: FloatArray = (np.hstack([shift, turn]) * faces.share[:, None]).ravel()
    return stiffness


def opening(points: Points, n: int) -> Matrix:
    """(m, 6n): how far the two sides part at each point for shifts and turns of voxels."""
    inner = points.second >= 0
    here = -np.hstack([points.normal, np.cross(points.arm, points.normal)])
    there = np.hstack([points.normal, np.cross(points.far_arm, points.normal)])[inner]
    sides = [(here, np.arange(len(points)), points.first)]
    sides.append((there, np.flatnonzero(inner), points.second[inner]))
    values = np.concatenate([side[0].ravel() for side in sides])
    rows = np.concatenate([np.repeat(side[1], 6) for side in sides])
    voxel = np.concatenate([side[2] for side in sides]).astype(np.int64)
    columns = (6 * voxel[:, None] + np.arange(6)).ravel()
    return sparse.csr_matrix((values, (rows, columns)), shape=(len(points), 6 * n))


def weights(n: int, up: FloatArray) -> FloatArray:
    """(6n,) forces and moments on the voxels by their own weight."""
    load = np.zeros((n, 6))
    load[:, :3] = -up
    return load.ravel()


def face_forces(faces: Faces, displacement: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Force (F, 3) and moment about the middle of the face (F, 3), by the second on the first."""
    n = len(displacement) // 6
    borne = (springs(faces) * (stretch(faces, n) @ displacement)).reshape(-1, 6)
    return borne[:, :3], borne[:, 3:]


def unbalanced(
    faces: Faces,
    force: FloatArray,
    moment: FloatArray,
    points: Points,
    pushed: FloatArray,
    up: FloatArray,
    n: int,
) -> float:
    """The largest force or moment that no other balances on a voxel, in voxel weights.

    It is summed up voxel by voxel from what faces and points bear, and knows nothing of
    the equations that were solved.
    """
    total = weights(n, up).reshape(n, 6)
    arm = faces.normal / 2
    np.add.at(total, faces.first, np.hstack([force, np.cross(arm, force) + moment]))
    inner = faces.second >= 0
    back = np.hstack([force, np.cross(-arm, force) + moment])[inner]
    np.subtract.at(total, faces.second[inner], back)
    by_point = -pushed[:, None] * points.normal
    np.add.at(total, points.first, np.hstack([by_point, np.cross(points.arm, by_point)]))
    inner = points.second >= 0
    back = np.hstack([by_point, np.cross(points.far_arm, by_point)])[inner]
    np.subtract.at(total, points.second[inner], back)
    return float(np.abs(total).max())


def _cross(r: FloatArray) -> FloatArray:
    """(n, 3, 3) matrices of the product r x w."""
    x, y, z = r.T
    o = np.zeros(len(r))
    rows = [[o, -z, y], [z, o, -x], [-y, x, o]]
    return np.stack([np.stack(row, axis=1) for row in rows], axis=1)


def _at(arm: FloatArray) -> FloatArray:
    """(n, 6, 6): shift and turn of a rigid body at a point at `arm` from its centre."""
    block = np.tile(np.eye(6), (len(arm), 1, 1))
    block[:, :3, 3:] = -_cross(arm)
    return block


def _blocks(
    blocks: FloatArray, rows: NDArray[np.integer], columns: NDArray[np.integer], n: int
) -> Matrix:
    order = np.lexsort((columns, rows))
    n_rows = int(rows.max(initial=-1)) + 1
    starts = np.searchsorted(rows[order], np.arange(n_rows + 1))
    shape = (6 * n_rows, 6 * n)
    return sparse.bsr_matrix((blocks[order], columns[order], starts), shape=shape).tocsr()
