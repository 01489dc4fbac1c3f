"""3MF and STL, written so that equal chains give equal bytes."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from .._files import whole
from ..block import Part
from ..grid import FloatArray
from .placing import Placed

_DECIMALS = range(4, 10)  # of millimetres; more where rounding would make two vertices one
_EPOCH = (1980, 1, 1, 0, 0, 0)
_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_PACKAGE = "http://schemas.openxmlformats.org/package/2006"
_TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    f'<Types xmlns="{_PACKAGE}/content-types">'
    '<Default Extension="rels" ContentType='
    '"application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType='
    '"application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>\n'
)
_RELATIONS = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    f'<Relationships xmlns="{_PACKAGE}/relationships">'
    '<Relationship Target="/3D/3dmodel.model" Id="model" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>\n'
)
_STL_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


@dataclass(frozen=True)
class Painted:
    """A part in a colour, #rrggbb, that is placed several times."""

    part: Part
    name: str
    colour: str


def write_3mf(
    file: Path,
    title: str,
    objects: Mapping[str, Painted],
    places: Sequence[tuple[str, Placed]],
    shift_mm: FloatArray,
) -> Path:
    """One object that is made of many components, in millimetres.

    Parameters
    ----------
    objects : mapping of str to Painted
        The meshes; each is stored once.
    places : sequence of (key of `objects`, Placed)
    shift_mm : (3,) float64
        Added to every place: a build has no negative coordinates.
    """
    number = {key: k + 2 for k, key in enumerate(objects)}
    colours = sorted({painted.colour for painted in objects.values()})
    out = io.StringIO()
    out.write(
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<model unit="millimeter" xml:lang="en-US" xmlns="{_CORE}">\n'
        f'<metadata name="Title">{escape(title)}</metadata>\n'
        '<resources>\n<basematerials id="1">\n'
    )
    for colour in colours:
        out.write(f'<base name="{colour}" displaycolor="{colour.upper()}FF"/>\n')
    out.write("</basematerials>\n")
    for key, painted in objects.items():
        _write_object(out, number[key], colours.index(painted.colour), painted)
    chain = len(objects) + 2
    out.write(f'<object id="{chain}" type="model" name={quoteattr(title)}>\n<components>\n')
    for key, place in places:
        # 3MF multiplies rows of coordinates from the left.
        matrix = [*place.rotation.T.ravel().tolist(), *(place.offset_mm + shift_mm).tolist()]
        transform = " ".join(f"{x:.7g}" for x in matrix)
        out.write(f'<component objectid="{number[key]}" transform="{transform}"/>\n')
    out.write("</components>\n</object>\n</resources>\n")
    out.write(f'<build>\n<item objectid="{chain}"/>\n</build>\n</model>\n')
    texts = {
        "[Content_Types].xml": _TYPES,
        "_rels/.rels": _RELATIONS,
        "3D/3dmodel.model": out.getvalue(),
    }
    with whole(file) as half:
        half.write_bytes(_zipped(texts))
    return file


def _write_object(out: io.StringIO, number: int, material: int, painted: Painted) -> None:
    out.write(
        f'<object id="{number}" type="model" name={quoteattr(painted.name)} '
        f'pid="1" pindex="{material}">\n<mesh>\n<vertices>\n'
    )
    vertices = painted.part.vertices
    d = next((d for d in _DECIMALS if _apart(vertices.round(d))), _DECIMALS[-1])
    for x, y, z in vertices.tolist():
        out.write(f'<vertex x="{x:.{d}f}" y="{y:.{d}f}" z="{z:.{d}f}"/>\n')
    out.write("</vertices>\n<triangles>\n")
    for a, b, c in painted.part.faces.tolist():
        out.write(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>\n')
    out.write("</triangles>\n</mesh>\n</object>\n")


def _apart(vertices: FloatArray) -> bool:
    return len(np.unique(vertices, axis=0)) == len(vertices)


def _zipped(texts: Mapping[str, str]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name, text in texts.items():
            entry = zipfile.ZipInfo(name, _EPOCH)
            entry.create_system = 3  # the same on every system
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, text.encode(), compresslevel=9)
    return buffer.getvalue()


def write_stl(
    file: Path,
    parts: Mapping[str, Part],
    places: Iterable[Placed],
    shift_mm: FloatArray | None = None,
) -> Path:
    """Parts in their places as one binary STL, in millimetres."""
    shift = np.zeros(3) if shift_mm is None else shift_mm
    corners = {name: part.vertices[part.faces] for name, part in parts.items()}
    places = tuple(places)
    count = sum(len(corners[place.part]) for place in places)
    with whole(file) as half, half.open("wb") as out:
        out.write(b"LineUp, millimetres".ljust(80))
        out.write(np.uint32(count).astype("<u4").tobytes())
        for place in places:
            out.write(
                _stl_records(corners[place.part] @ place.rotation.T + place.offset_mm + shift)
            )
    return file


def _stl_records(corners: FloatArray) -> bytes:
    records = np.zeros(len(corners), _STL_RECORD)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    records["normal"] = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0)
    records["corners"] = corners
    return records.tobytes()
