"""Triangle meshes as the voxelizer takes them: read, checked, turned upright, oriented outwards."""

from __future__ import annotations

import hashlib
import sys
from dataclasses import dataclass, field, replace
from functools import lru_cache
from os import PathLike
from pathlib import Path
from typing import Any

import igl
import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ._files import content
from .grid import FloatArray
from .mesh_files import Beside, triangles

FaceArray = NDArray[np.int64]

FORMATS = (".obj", ".ply", ".stl", ".off", ".glb", ".gltf")
"""File name endings that `read_surface` takes."""
LARGEST = 1e60
"""Coordinates beyond it, and extents below its inverse, have volumes that no float holds."""

_AXES = {
    f"{sign}{name}": np.where(np.arange(3) == axis, 1.0 if sign == "+" else -1.0, 0.0)
    for axis, name in enumerate("xyz")
    for sign in "+-"
}


@dataclass(frozen=True)
class Surface:
    """A triangle soup with its provenance; equal surfaces are those with equal keys.

    Attributes
    ----------
    vertices : (V, 3) float64
    faces : (F, 3) int64
    key : str
        SHA-256 of the file, with those that it names, or of the arrays, and what was done to them
        since.
    provenance : dict
        What `VoxelSolid.source` will say about the input: plain JSON values.
    closed : bool
        Whether the faces, with their orientation, have no boundary; then winding numbers are
        integers off the surface.
    euler : int or None
        Euler number of the solid inside, where the faces are one closed manifold; else None.
    """

    vertices: FloatArray = field(compare=False, repr=False)
    faces: FaceArray = field(compare=False, repr=False)
    key: str
    provenance: dict[str, Any] = field(compare=False)
    closed: bool = field(compare=False)
    euler: int | None = field(compare=False)

    def winding(self, points: FloatArray) -> FloatArray:
        """Winding number of the surface at each of (Q, 3) points."""
        queries = np.ascontiguousarray(points, np.float64)
        numbers: FloatArray = igl.fast_winding_number(self.vertices, self.faces, queries)
        return numbers


def surface_of(mesh: object) -> Surface:
    """The surface of a file, a mesh of trimesh or pyvista, or a (vertices, faces) pair.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If the file name's ending is not one of `FORMATS`, the file is spoilt or unfolds into more
        than is read (docs/formats.md), or the mesh is of another type, empty, flat, or not made of
        triangles with finite vertices of up to `LARGEST`.
    """
    if isinstance(mesh, Surface):
        return mesh
    if isinstance(mesh, str | PathLike):
        return read_surface(Path(mesh))
    vertices, faces = _arrays_of(mesh)
    vertices, faces = _checked(vertices, faces, "the mesh")
    digest = hashlib.sha256(vertices.tobytes() + faces.tobytes()).hexdigest()
    return _oriented(vertices, faces, "the mesh", digest, {"kind": "mesh", "sha256": digest})


def read_surface(path: Path) -> Surface:
    """The surface in a mesh file; read once as long as the file does not change."""
    if not path.is_file():
        raise FileNotFoundError(f"no mesh file {str(path)!r}")
    if path.suffix.lower() not in FORMATS:
        raise ValueError(
            f"{path.name!r} has an ending that is not read here; "
            f"{', '.join(ending[1:].upper() for ending in FORMATS)} are"
        )
    return _read(path.resolve(), path.stat().st_mtime_ns)


@lru_cache(maxsize=16)
def _read(path: Path, mtime_ns: int) -> Surface:
    name, beside = repr(path.name), Beside(path.parent)
    try:
        data = content(path)
        vertices, faces = triangles(data, path.suffix.lower(), beside)
    except ValueError as error:
        raise ValueError(f"{name} {error}") from error
    digest = hashlib.sha256(b"".join([data, *beside.values()])).hexdigest()
    provenance = {"kind": "mesh", "file": path.name, "sha256": digest}
    return _oriented(*_checked(vertices, faces, name), name, digest, provenance)


def _arrays_of(mesh: object) -> tuple[NDArray[Any], NDArray[Any]]:
    if isinstance(mesh, trimesh.Scene):
        mesh = mesh.to_mesh()
    if isinstance(mesh, trimesh.Trimesh):
        return np.asarray(mesh.vertices), np.asarray(mesh.faces)
    pyvista = sys.modules.get("pyvista")  # a pyvista mesh exists only where it was imported
    if pyvista is not None and isinstance(mesh, pyvista.DataSet):
        poly = mesh.extract_surface(algorithm="dataset_surface").triangulate()
        return np.asarray(poly.points), np.asarray(poly.regular_faces)
    if isinstance(mesh, tuple | list) and len(mesh) == 2:
        return np.asarray(mesh[0]), np.asarray(mesh[1])
    raise ValueError(
        f"a mesh is a file name, a trimesh or pyvista mesh, or a pair (vertices, faces); "
        f"got {type(mesh).__name__}"
    )


def _checked(
    vertices: NDArray[Any], faces: NDArray[Any], name: str
) -> tuple[FloatArray, FaceArray]:
    if vertices.size == 0 or faces.size == 0:
        raise ValueError(f"{name} is empty: it needs at least four triangles around a volume")
    if vertices.ndim != 2 or vertices.shape[1] != 3 or vertices.dtype.kind not in "fiu":
        raise ValueError(f"{name} needs vertices of shape (V, 3), got {vertices.shape}")
    if faces.ndim != 2 or faces.shape[1] != 3 or faces.dtype.kind not in "iu":
        raise ValueError(f"{name} needs triangles, integers of shape (F, 3), got {faces.shape}")
    if not np.isfinite(vertices).all():
        bad = int(np.flatnonzero(~np.isfinite(vertices).all(axis=1))[0])
        raise ValueError(f"{name} has a vertex that is not finite: vertex {bad}")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise ValueError(
            f"{name} has faces that name vertices {faces.min()}..{faces.max()}, "
            f"but it has only 0..{len(vertices) - 1}"
        )
    vertices = vertices.astype(np.float64)
    reach = float(np.abs(vertices).max())
    if reach > LARGEST or float(np.ptp(vertices, axis=0).max()) < 1 / LARGEST:
        raise ValueError(
            f"{name} has coordinates of up to {reach:.3g}, too large or too close together to "
            "reckon with; another unit of length would do"
        )
    used, faces = np.unique(faces, return_inverse=True)
    return vertices[used], faces.reshape(-1, 3).astype(np.int64)


def _oriented(
    vertices: FloatArray, faces: FaceArray, name: str, digest: str, provenance: dict[str, Any]
) -> Surface:
    """Weld equal vertices and turn badly oriented faces outwards, counting them."""
    vertices, faces = _welded(vertices, faces, name)
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    part = _parts(faces)
    consistent = faces
    if not mesh.is_winding_consistent:
        trimesh.repair.fix_winding(mesh)  # type: ignore[no-untyped-call]
        consistent = np.array(mesh.faces)
        # A part follows its first face; where that one was among the few, follow the many.
        away = np.bincount(part, weights=~_same_cycle(faces, consistent)) * 2 > np.bincount(part)
        consistent[away[part]] = consistent[away[part]][:, ::-1]
    outwards = _turned_outwards(vertices, consistent, part)
    n_turned = int((~_same_cycle(faces, outwards)).sum())
    return Surface(
        vertices=np.ascontiguousarray(vertices, np.float64),
        faces=np.ascontiguousarray(outwards, np.int64),
        key=digest,
        provenance={**provenance, "faces_turned": n_turned},
        closed=not _on_boundary(outwards).any(),
        euler=int(mesh.euler_number) // 2 if mesh.is_watertight and part.max() == 0 else None,
    )


def _welded(vertices: FloatArray, faces: FaceArray, name: str) -> tuple[FloatArray, FaceArray]:
    """One vertex for all that agree to 1e-8 of the extent, and no face that this collapses."""
    low, extent = vertices.min(axis=0), np.ptp(vertices, axis=0).max()
    rounded = np.round((vertices - low) / extent * 1e8)
    _, first, index = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    faces = index.reshape(-1)[faces]
    distinct = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    vertices, faces = vertices[first], np.ascontiguousarray(faces[distinct])
    if not faces.size or not np.ptp(vertices, axis=0).all():
        raise ValueError(f"{name} is flat: it spans no volume")
    return vertices, faces


def _turned_outwards(vertices: FloatArray, faces: FaceArray, part: NDArray[Any]) -> FaceArray:
    """Faces with the whole, then every closed part that is no cavity, of positive volume."""
    faces = faces.copy()
    corners = vertices[faces] - vertices[faces].mean(axis=(0, 1))
    volumes = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    if volumes.sum() < 0:
        faces, volumes = faces[:, ::-1].copy(), -volumes
    inverted = np.bincount(part, weights=volumes) < 0
    if inverted.any():
        owner = np.zeros(len(vertices), part.dtype)
        owner[faces] = part[:, None]
        others = np.ascontiguousarray(faces[~inverted[part]])
        used = np.unique(faces[inverted[part]])
        around = igl.fast_winding_number(vertices, others, vertices[used])
        turned = np.zeros(len(inverted), np.bool_)
        # A part inside the others is the wall of a cavity, rightly inwards.
        turned[owner[used[around < 0.5]]] = True
        turned[part[_on_boundary(faces)]] = False
        faces[turned[part]] = faces[turned[part]][:, ::-1]
    return faces


def _parts(faces: FaceArray) -> NDArray[np.int32]:
    """Label of the part that each face belongs to; faces that share a vertex share a part."""
    n = int(faces.max()) + 1
    edges = (faces[:, [0, 1]].ravel(), faces[:, [1, 2]].ravel())
    graph = coo_array((np.ones(len(edges[0]), bool), edges), shape=(n, n))
    label: NDArray[np.int32] = connected_components(graph, directed=False)[1][faces[:, 0]]
    return label


def _same_cycle(a: FaceArray, b: FaceArray) -> NDArray[np.bool_]:
    """Whether each two triangles, of the same three vertices, go round the same way."""
    same = np.zeros(len(a), np.bool_)
    for turn in range(3):
        same |= np.all(a == np.roll(b, turn, axis=1), axis=1)
    return same


def _on_boundary(faces: FaceArray) -> NDArray[np.bool_]:
    """Which triangles have an edge that is walked more often one way than the other."""
    start, stop = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    n = int(faces.max()) + 1
    edge = np.minimum(start, stop) * n + np.maximum(start, stop)
    _, index = np.unique(edge, return_inverse=True)
    balance = np.bincount(index, weights=np.where(start < stop, 1, -1))
    on_boundary: NDArray[np.bool_] = (balance[index] != 0).reshape(-1, 3).any(axis=1)
    return on_boundary


def turned_upright(surface: Surface, up: str | tuple[float, float, float]) -> Surface:
    """The surface turned, by the smallest turn, so that its direction `up` becomes +z.

    Parameters
    ----------
    up : {"+x", "-x", "+y", "-y", "+z", "-z"} or 3 numbers
        Turning -z up is half a turn about x.
    """
    direction = _direction(up)
    x, y, z = direction
    if np.hypot(x, y) < 1e-12:
        if z > 0:
            return surface
        turn = np.diag([1.0, -1.0, -1.0])
    else:
        # Rodrigues' formula about the axis direction × z; near -z, 1 + z would lose its digits.
        across = np.array([[0, 0, -x], [0, 0, -y], [x, y, 0]])
        one_more = 1 + z if z > 0 else (x * x + y * y) / (1 - z)
        turn = np.eye(3) + across + across @ across / one_more
    return replace(
        surface,
        vertices=np.ascontiguousarray(surface.vertices @ turn.T),
        key=f"{surface.key} up {direction.tolist()}",
    )


def _direction(up: object) -> FloatArray:
    if isinstance(up, str):
        if up not in _AXES:
            raise ValueError(f"up must be one of {', '.join(_AXES)} or three numbers, got {up!r}")
        return _AXES[up]
    try:
        direction = np.asarray(up, np.float64)
    except (TypeError, ValueError):
        direction = np.empty(0)
    if direction.shape != (3,) or not np.isfinite(direction).all() or not direction.any():
        raise ValueError(f"up must be three finite numbers, not all zero, got {up!r}")
    unit: FloatArray = direction / np.linalg.norm(direction)
    return unit
