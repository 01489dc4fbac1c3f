"""Mesh files, read by trimesh once it is clear that they do not unfold into more than they hold."""

from __future__ import annotations

import json
import logging
import re
import warnings
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray

from ._files import MOST_BYTES, content, plain_name

MOST_NUMBERS = 100_000_000
"""Coordinates and corners that a glTF file may unfold into."""
MOST_PIECES = 5_000
"""Meshes, and places of meshes, that a file may have; trimesh takes a second for a thousand."""

_COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_FACES = {".ply": rb"(?m)^\s*element\s+face\s+(\d+)", ".off": rb"OFF\s+\d+\s+(\d+)"}
_HEAD = 2**16

# What a file is refused for is said by an error, and not on stderr as well.
logging.getLogger("trimesh").addHandler(logging.NullHandler())


def triangles(data: bytes, ending: str, beside: Beside) -> tuple[NDArray[Any], NDArray[Any]]:
    """Vertices and triangles in a mesh file, of all its meshes in their places.

    Nothing else is read but what a glTF file names, which is then in `beside`.

    Raises
    ------
    ValueError
        If it cannot be read, ends early, or unfolds into more than `MOST_NUMBERS` or `MOST_PIECES`.
    """
    try:
        data = _prepared(data, ending)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            # A file holding one mesh and a file holding a scene of placed meshes read alike.
            mesh = trimesh.load_scene(
                BytesIO(data),
                file_type=ending[1:],
                resolver=beside,
                process=False,
                skip_materials=True,
            ).to_mesh()
        vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    except Exception as error:  # every reader of trimesh fails in its own way
        why = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ValueError(f"cannot be read as a mesh: {why}") from error
    declared = _declared(data, ending)
    if len(faces) < declared:
        raise ValueError(
            f"cannot be read as a mesh: it speaks of {declared} faces, and {len(faces)} are there"
        )
    return vertices, faces


class Beside(dict[str, bytes]):
    """The files that a glTF file may name: those in its own folder, of `MOST_BYTES` in all."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __missing__(self, name: str) -> bytes:
        left = MOST_BYTES - sum(map(len, self.values()))
        self[name] = content(self.folder / plain_name(name), left)
        return self[name]


def _prepared(data: bytes, ending: str) -> bytes:
    """What trimesh is given of a file, once its claims are checked."""
    if ending == ".obj":  # one mesh, not one for each change of material
        return re.sub(rb"(?m)^\s*(usemtl|mtllib)\b.*$", b"", data)
    if ending == ".stl":
        _check_most("solids", len(re.findall(rb"(?i)endsolid", data)), MOST_PIECES)
    if ending == ".gltf":
        _check_claims(json.loads(data))
    if ending == ".glb":
        _check_claims(json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")]))
    return data


def _check_claims(header: dict[str, Any]) -> None:
    """Refuse a glTF file that takes much memory or time for what a few of its bytes claim."""
    counts = [abs(a["count"]) * _COMPONENTS[a["type"]] for a in header.get("accessors", [])]
    parts = [mesh["primitives"] for mesh in header.get("meshes", [])]
    sizes = [sum(counts[k] for part in mesh for k in _accessors(part)) for mesh in parts]
    nodes = header.get("nodes", [])
    edges = [k for scene in header.get("scenes", []) for k in scene.get("nodes", [])]
    edges += [k for node in nodes for k in node.get("children", [])]
    placed = [nodes[k]["mesh"] for k in edges if "mesh" in nodes[k]]
    n_pieces = sum(map(len, parts)) + sum(len(parts[k]) for k in placed) + len(edges)
    n_numbers = sum(counts) + sum(sizes) + sum(sizes[k] for k in placed)
    n_bytes = sum(abs(view["byteLength"]) for view in header.get("bufferViews", []))
    _check_most("numbers", n_numbers, MOST_NUMBERS)
    _check_most("meshes and places of meshes", n_pieces, MOST_PIECES)
    _check_most("bytes", n_bytes, MOST_BYTES)


def _accessors(part: dict[str, Any]) -> list[int]:
    return [*part["attributes"].values(), *([part["indices"]] if "indices" in part else [])]


def _check_most(what: str, n: int, most: int) -> None:
    if not n <= most:  # a nan is not, either
        raise ValueError(f"it claims {n:,} {what}, and up to {most:,} are read")


def _declared(data: bytes, ending: str) -> int:
    """How many faces a file says that it has; one that was cut short has fewer."""
    if ending == ".stl":
        return len(re.findall(rb"(?i)facet\s+normal", data))
    head = re.sub(rb"#.*", b"", data[:_HEAD])
    found = re.search(_FACES[ending], head) if ending in _FACES else None
    return int(found[1]) if found else 0
