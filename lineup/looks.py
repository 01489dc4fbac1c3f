"""How much of a model's appearance is left in its voxels, its path, and what trimming leaves.

The paper keeps appearance by keeping surface voxels (Section 5), and names a finer resolution and
shells as ways to improve it (Section 9). Here it is measured against the mesh.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import igl
import numpy as np
import pandas as pd
import trimesh
from PIL import Image, ImageDraw

from . import grid
from ._record import of_kind
from .catalog import surface_for
from .grid import BoolArray, FloatArray
from .meshes import FaceArray, Surface
from .sampling import sampled, shares_inside
from .solid import Folding, VoxelPath, VoxelSolid
from .voxelization import cells_wanted

Shape = VoxelPath | Folding

VIEWS = ("x", "y", "z")
"""The axes that silhouettes are seen along. From the opposite side each is mirrored, so these
three stand for the six directions."""

_PIXELS = 32  # to a voxel
_FINER = 4
_SAMPLES = 20_000  # points on the mesh
_PER_FACE = np.array([(a, b) for a in (0.25, 0.75) for b in (0.25, 0.75)])


@dataclass(frozen=True)
class Reference:
    """What a model should look like, in voxels of a padded grid.

    Attributes
    ----------
    vertices, faces : (V, 3) float64, (F, 3) int64
    shares : (X, Y, Z) float64
        How much of each voxel is inside.
    margin : int
        Empty voxels that pad the solid on each side.
    seen : tuple of (W, H) bool
        Its silhouettes along x, y and z, 32 pixels to a voxel.
    """

    vertices: FloatArray
    faces: FaceArray
    shares: FloatArray
    margin: int
    seen: tuple[BoolArray, ...]


def appearance(
    shape: Shape | Mapping[str, Shape], solid: VoxelSolid, mesh: object = None
) -> pd.DataFrame:
    """How like the model its voxels are, before and after path and trimming (Sections 5 and 9).

    Parameters
    ----------
    shape : VoxelPath, Folding, or mapping of names to them
        Each is measured by the voxels that it visits.
    solid : VoxelSolid
        The solid that they are paths of.
    mesh : str, Path, mesh or pair of arrays, optional
        What the solid was made of, as a name of the catalogue or as `voxelize` takes it. Without
        it the solid itself is what everything is compared with.

    Returns
    -------
    DataFrame
        A row for the solid, then one for each shape: "stage", its name; "voxels"; "iou" of the
        voxels with the inside of the mesh; "surface_kept", the share of the solid's surface
        voxels; "distance_mean" and "distance_max", the symmetric surface distance in voxels: from
        20,000 points of the mesh to the nearest point of the outermost voxel faces, and from four
        points of each such face to the mesh (mean of both means; the larger maximum, Hausdorff's
        distance up to the spacing of the points); "distance_share", the mean as a share of the
        diagonal of the mesh's box; "silhouette_x", "_y", "_z", the IoU of what is seen along each
        axis, and "silhouette", their mean.

    Raises
    ------
    ValueError
        If a shape is no path in the solid or lives on a refined one, if there is none, or if the
        mesh is not the one that the solid was made of.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> solid = lu.VoxelSolid(np.ones((4, 4, 3), bool))
    >>> table = lu.appearance(lu.layered_path(solid), solid)
    >>> table[["stage", "iou", "silhouette"]].values.tolist()
    [['solid', 1.0, 1.0], ['path', 1.0, 1.0]]
    """
    reference = reference_of(solid, mesh)
    surface = grid.surface(solid.occupancy)
    rows = []
    for stage, occupancy in stages(shape, solid).items():
        padded = np.pad(occupancy, reference.margin)
        inside = float(reference.shares[padded].sum())
        total = float(reference.shares.sum())
        row: dict[str, Any] = {
            "stage": stage,
            "voxels": int(occupancy.sum()),
            "iou": inside / (int(occupancy.sum()) + total - inside),
            "surface_kept": float(occupancy[surface].mean()),
            **_distances(padded, reference),
        }
        found = [agreement(a, b) for a, b in zip(reference.seen, shadows(padded), strict=True)]
        row.update({f"silhouette_{view}": a for view, a in zip(VIEWS, found, strict=True)})
        rows.append({**row, "silhouette": sum(found) / len(found)})
    return pd.DataFrame(rows)


def stages(shape: Shape | Mapping[str, Shape], solid: VoxelSolid) -> dict[str, BoolArray]:
    """The voxels of the solid, then those of each shape, each on the grid of the solid."""
    of_kind(solid, VoxelSolid)
    shapes = dict(shape) if isinstance(shape, Mapping) else {"path": shape}
    if not shapes or "solid" in shapes:
        raise ValueError("at least one path or folding is needed, none of them named 'solid'")
    found = {"solid": solid.occupancy}
    for name, item in shapes.items():
        of_kind(item, VoxelPath, Folding)
        path = item.path if isinstance(item, Folding) else item
        if path.refinement != 1:
            raise ValueError(f"{name!r} is a path on voxels split {path.refinement}-fold")
        at = path.voxels
        on_grid = bool(((at >= 0) & (at < solid.occupancy.shape)).all())
        if not on_grid or not solid.occupancy[tuple(at.T)].all():
            raise ValueError(f"{name!r} is no path in the solid")
        visited = np.zeros_like(solid.occupancy)
        visited[tuple(at.T)] = True
        found[name] = visited
    return found


def reference_of(solid: VoxelSolid, mesh: object) -> Reference:
    """The mesh on a grid like that of the solid, wide enough to hold it; or the solid itself."""
    of_kind(solid, VoxelSolid)
    if mesh is None:
        padded = np.pad(solid.occupancy, 1)
        vertices, faces = boundary(padded)
        return Reference(vertices, faces, padded.astype(np.float64), 1, shadows(padded))
    surface, _ = surface_for(mesh, solid.source.get("up"))
    _check_same(solid, surface)
    origin, pitch = np.array(solid.source["origin"]), solid.pitch
    shape = np.array(solid.occupancy.shape)
    low = (surface.vertices.min(axis=0) - origin) / pitch
    high = (surface.vertices.max(axis=0) - origin) / pitch
    margin = 1 + int(np.ceil(max(0.0, float((-low).max()), float((high - shape).max()))))
    corner = origin - margin * pitch
    wide = tuple((shape + 2 * margin).tolist())
    hollow = sampled(surface, cells_wanted(int(solid.source["target"]))).n_void > 0
    shares = shares_inside(surface, corner, pitch, wide, hollow)
    vertices = (surface.vertices - corner) / pitch
    seen = _outlines(vertices, surface.faces, wide)
    return Reference(vertices, surface.faces, shares, margin, seen)


def _check_same(solid: VoxelSolid, surface: Surface) -> None:
    if "origin" not in solid.source:
        raise ValueError("the solid does not say where in a mesh it lies: voxelize the mesh")
    made_of, given = solid.source.get("sha256"), surface.provenance.get("sha256")
    if made_of != given:
        raise ValueError(
            f"the mesh is not the one that the solid was made of: its SHA-256 is {given}, "
            f"that of the solid's {made_of}"
        )


def boundary(occupancy: BoolArray) -> tuple[FloatArray, FaceArray]:
    """The faces between a solid and what is outside of it, as (V, 3) vertices and triangles.

    Examples
    --------
    >>> vertices, faces = boundary(np.ones((1, 1, 1), bool))
    >>> len(vertices), len(faces)
    (24, 12)
    """
    corners = _quads(occupancy)
    first = 4 * np.arange(len(corners))[:, None]
    halves = np.array([[0, 1, 2], [0, 2, 3]])
    faces = (first[:, None] + halves).reshape(-1, 3)
    return corners.reshape(-1, 3), faces.astype(np.int64)


def _quads(occupancy: BoolArray) -> FloatArray:
    """Corners, in turn, of each face that the outside touches: (Q, 4, 3)."""
    whole = np.pad(occupancy | grid.voids(occupancy), 1)
    found = []
    for step in grid.DIRECTIONS:
        axis = int(np.abs(step).argmax())
        bare = np.argwhere(whole & ~np.roll(whole, -step, axis=(0, 1, 2))) - 1.0
        middle = bare + 0.5 + step / 2
        u, v = np.delete(np.eye(3), axis, axis=0) / 2
        around = np.array([-u - v, u - v, u + v, -u + v])
        found.append(middle[:, None] + around)
    return np.concatenate(found)


def _distances(occupancy: BoolArray, reference: Reference) -> dict[str, float]:
    """Symmetric distance between the outermost faces of voxels and the reference."""
    vertices, faces = boundary(occupancy)
    quads = vertices.reshape(-1, 4, 3)
    sides = np.stack([quads[:, 1] - quads[:, 0], quads[:, 3] - quads[:, 0]], axis=1)
    ours = (quads[:, :1] + np.einsum("ka,qad->qkd", _PER_FACE, sides)).reshape(-1, 3)
    theirs = _sampled(reference)
    there = _to_mesh(ours, reference.vertices, reference.faces)
    back = _to_mesh(theirs, vertices, faces)
    mean = float(there.mean() + back.mean()) / 2
    diagonal = float(np.linalg.norm(np.ptp(reference.vertices, axis=0)))
    return {
        "distance_mean": mean,
        "distance_max": float(max(there.max(), back.max())),
        "distance_share": mean / diagonal,
    }


def _sampled(reference: Reference) -> FloatArray:
    mesh = trimesh.Trimesh(reference.vertices, reference.faces, process=False)
    points, _ = trimesh.sample.sample_surface(mesh, _SAMPLES, seed=0)
    return np.asarray(points, np.float64)


def _to_mesh(points: FloatArray, vertices: FloatArray, faces: FaceArray) -> FloatArray:
    squared = igl.point_mesh_squared_distance(
        np.ascontiguousarray(points), np.ascontiguousarray(vertices), np.ascontiguousarray(faces)
    )[0]
    distance: FloatArray = np.sqrt(np.maximum(squared, 0.0))
    return distance


def _outlines(
    vertices: FloatArray, faces: FaceArray, shape: tuple[int, ...]
) -> tuple[BoolArray, ...]:
    """What is seen of triangles along each axis.

    They are drawn finer, because a pixel that an edge merely touches is filled, too.
    """
    fine = _PIXELS * _FINER
    seen = []
    for axis in range(3):
        across = [a for a in range(3) if a != axis]
        image = Image.new("1", (shape[across[0]] * fine, shape[across[1]] * fine))
        draw = ImageDraw.Draw(image)
        flat = vertices[:, across] * fine - 0.5  # pixels are at their middles
        for triangle in flat[faces].reshape(-1, 6).tolist():
            draw.polygon(triangle, fill=1)
        middle = _FINER // 2
        seen.append(np.ascontiguousarray(np.asarray(image, bool)[middle::_FINER, middle::_FINER].T))
    return tuple(seen)


def shadows(occupancy: BoolArray) -> tuple[BoolArray, ...]:
    """What is seen of voxels along x, y and z, 32 pixels to a voxel.

    Examples
    --------
    >>> [mask.shape for mask in shadows(np.ones((1, 2, 3), bool))]
    [(64, 96), (32, 96), (32, 64)]
    """
    flat = [occupancy.any(axis=axis) for axis in range(3)]
    return tuple(mask.repeat(_PIXELS, axis=0).repeat(_PIXELS, axis=1) for mask in flat)


def agreement(a: BoolArray, b: BoolArray) -> float:
    """Intersection over union of two masks."""
    return float((a & b).sum() / (a | b).sum())
