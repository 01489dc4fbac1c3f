"""Files that mean harm, made byte by byte, and what reads them.

It imports little, so that a process which reads them with little memory begins soon.
"""

import base64
import json
import re
import struct
import zlib

import numpy as np
import pytest

import lineup as lu
from lineup import meshes, storage

TETRAHEDRON = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float64)
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
YAML = "title: t\ntask: path\nfixed: {seed: 0}\ngrids: [{model: [duck], voxels: [60, 90]}]\n"


def read(file):
    """What the reader of files with such a name makes of it."""
    if file.name.endswith((".manual.json", ".manual.csv")):
        return lu.read_manual(file)
    if file.suffix == ".json":
        return storage.load(file)
    if file.suffix == ".yaml":
        from lineup.experiment import read_experiment

        return read_experiment(file)
    meshes._read.cache_clear()
    return meshes.read_surface(file)


def refused(file, words=""):
    """Check that a file ends in one line that names it."""
    with pytest.raises((ValueError, FileNotFoundError)) as caught:
        read(file)
    said = str(caught.value)
    assert file.name in said
    assert re.search(words, said)
    assert "\n" not in said
    assert len(said) < 1000


def written(folder, name, content):
    file = folder / name
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    return file


def off(vertices, faces=FACES):
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [" ".join(map(str, vertex)) for vertex in np.asarray(vertices).tolist()]
    return "\n".join([*lines, *("3 " + " ".join(map(str, f)) for f in np.asarray(faces).tolist())])


def obj(vertices, faces=FACES):
    lines = ["v " + " ".join(map(str, vertex)) for vertex in np.asarray(vertices).tolist()]
    faces = np.asarray(faces)
    faces = np.where(faces < 0, faces, faces + 1).tolist()  # a negative one counts from the end
    return "\n".join([*lines, *("f " + " ".join(map(str, face)) for face in faces)])


def ply(vertices, faces=FACES, n_faces=None, form="ascii"):
    properties = "\n".join(f"property float {axis}" for axis in "xyz")
    return (
        f"ply\nformat {form} 1.0\nelement vertex {len(vertices)}\n{properties}\n"
        f"element face {len(faces) if n_faces is None else n_faces}\n"
        "property list uint int vertex_indices\nend_header\n"
        + "\n".join(off(vertices, faces).split("\n")[2:])
        + "\n"
    )


WRITERS = {"a.off": off, "a.obj": obj, "a.ply": ply}


def gltf(**changes):
    """A glTF tree of a tetrahedron whose 96 bytes are the first buffer; fields may be replaced."""
    parts = [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]
    accessors = [
        {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
        {"bufferView": 1, "componentType": 5125, "count": 12, "type": "SCALAR"},
    ]
    views = [{"buffer": 0, "byteOffset": at, "byteLength": 48} for at in (0, 48)]
    tree = {
        **{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}]},
        **{"nodes": [{"mesh": 0}], "meshes": parts, "accessors": accessors},
        **{"bufferViews": views, "buffers": [{"byteLength": 96}]},
    }
    return tree | changes


BUFFER = TETRAHEDRON.astype("<f4").tobytes() + FACES.astype("<u4").tobytes()


def glb(tree, binary=BUFFER):
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<I4s", len(text), b"JSON") + text
    body += struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def bomb(megabytes=1000):
    """Letters that unfold into so many megabytes of zeros."""
    packer = zlib.compressobj(9)
    first, other = (
        packer.compress(bytes(2**20)) + packer.flush(zlib.Z_FULL_FLUSH) for _ in range(2)
    )
    return base64.b64encode(first + other * (megabytes - 1)).decode()


def claims():
    """Small files that speak of much more than they hold, by name."""
    large = storage.document(lu.VoxelSolid(np.ones((2, 2, 1), bool))) | {"shape": [2**10] * 3}
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    still = lu.Motion(square, np.empty((0, 4), np.int32), 0.9, 90.0, False, "stuck")
    bends = storage.document(still) | {"n_angles": 2**20, "angles": bomb()}
    zeros = [
        {"componentType": 5126, "count": 10**9, "type": "VEC3"},
        {"componentType": 5125, "count": 10**8, "type": "SCALAR"},
    ]
    primitive = gltf()["meshes"][0]["primitives"]
    ways = [*({"children": [k + 1, k + 1]} for k in range(60)), {"mesh": 0}]
    many = {"scenes": [{"nodes": list(range(20_000))}], "nodes": [{"mesh": 0}] * 20_000}
    wide = [{"buffer": 0, "byteOffset": 0, "byteLength": 2**40}] * 2
    outside = [{**view, "byteOffset": 10**9} for view in gltf()["bufferViews"]]
    header = ply(TETRAHEDRON, n_faces=10**8).replace("vertex 4", "vertex 100000000")
    return {
        "zeros.glb": glb(gltf(accessors=zeros)),
        "many.glb": glb(gltf(**many)),
        "parts.glb": glb(gltf(meshes=[{"primitives": primitive * 20_000}])),
        "ways.glb": glb(gltf(nodes=ways)),
        "wide.glb": glb(gltf(bufferViews=wide)),
        "outside.glb": glb(gltf(bufferViews=outside)),
        "deep.glb": struct.pack("<4sIII4s", b"glTF", 2, 2 * 10**5, 10**5, b"JSON") + b"[" * 10**5,
        "faces.ply": header,
        "binary.ply": header.replace("ascii", "binary_little_endian"),
        "list.ply": ply([], n_faces=1, form="binary_little_endian").encode() + b"\xff" * 64,
        "faces.stl": b" " * 80 + struct.pack("<I", 10**8) + bytes(50),
        "solids.stl": "solid endsolid " * 100_000,
        "faces.off": "OFF\n100000000 100000000 0\n0 0 0\n",
        "corner.obj": obj(TETRAHEDRON, [[0, 1, 10**8]]),
        "grid.solid.json": json.dumps(large),
        "bomb.motion.json": json.dumps(bends),
        "deep.json": "[" * 10**6,
    }
