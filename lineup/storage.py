"""Results as files: documented, versioned JSON that loads back exactly (docs/formats.md).

Nothing is pickled and no timings are stored, so equal runs give equal bytes.
"""

from __future__ import annotations

import base64
import json
import math
import os
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias, TypeVar

import numpy as np
import pandas as pd
from pydantic import BaseModel, ConfigDict, FailFast, Field, FiniteFloat, ValidationError

from . import grid, notation
from ._files import content, whole
from .solid import Certificate, Design, Folding, Motion, VoxelPath, VoxelSolid

Record: TypeAlias = VoxelSolid | VoxelPath | Motion | Folding | Design

Whole = Annotated[int, Field(ge=-(2**30), le=2**30)]
Positive = Annotated[int, Field(ge=1, le=2**30)]
Letters = Annotated[str, Field(pattern=f"^[{grid.LETTERS}]*$", max_length=2**24)]
Point: TypeAlias = tuple[Whole, Whole, Whole]
Number: TypeAlias = FiniteFloat | Literal["inf", "-inf"] | None
Cell: TypeAlias = bool | int | FiniteFloat | str | None
T = TypeVar("T")
List = Annotated[list[T], FailFast()]  # of a million wrong entries, the first is enough

MOST_CELLS = 2**28
"""Of a grid that a file speaks of."""


def save(obj: Record, file: str | os.PathLike[str]) -> Path:
    """Write a solid, path, motion, folding or design to a JSON file, whole or not at all.

    Parameters
    ----------
    obj : VoxelSolid, VoxelPath, Motion, Folding or Design
    file : path
        A folder stands for the file ``design.json`` in it. An existing file is replaced.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    ValueError
        If `obj` is something else, or holds what the format cannot say (a path with a gap, a
        move of no known kind).
    FileNotFoundError
        If the folder to write into does not exist.

    Examples
    --------
    >>> import numpy as np, tempfile, lineup as lu
    >>> file = lu.save(lu.VoxelSolid(np.ones((4, 3, 2), bool)), tempfile.mkdtemp() + "/bar.json")
    >>> lu.load(file).size
    24
    """
    return write_whole(_design_file(file), text(obj))


def text(obj: Record) -> str:
    """What `save` writes into the file of `obj`; a ValueError as there."""
    fields = document(obj).items()
    lines = [f"{json.dumps(k)}: {json.dumps(v, allow_nan=False)}" for k, v in fields]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def document(obj: Record) -> dict[str, Any]:
    """The fields of the file of `obj` (docs/formats.md); a ValueError as from `save`."""
    kind = next((d for kind, d in _DOCUMENTS.items() if isinstance(obj, kind)), None)
    if kind is None:
        known = ", ".join(kind.__name__ for kind in _DOCUMENTS)
        raise ValueError(f"cannot save a {type(obj).__name__}; what can be saved: {known}")
    try:
        return kind.of(obj).model_dump()
    except ValidationError as error:
        raise ValueError(f"cannot save this {type(obj).__name__}: {first_error(error)}") from None


def load(file: str | os.PathLike[str]) -> Record:
    """Read what `save` wrote; the file says what it holds.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If the file is not one of these formats, is of a later version, or is malformed: one
        line that names the file and the first thing wrong.

    Examples
    --------
    >>> import numpy as np, tempfile, lineup as lu
    >>> path = lu.VoxelPath(np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0]]))
    >>> lu.load(lu.save(path, tempfile.mkdtemp() + "/corner.json")).voxels.tolist()
    [[0, 0, 0], [1, 0, 0], [1, 1, 0]]
    """
    file = _design_file(file)
    try:
        data = content(file)
        return _document_of(_Header.model_validate_json(data)).model_validate_json(data).record()
    except ValidationError as error:
        raise ValueError(f"{file}: {first_error(error)}") from None
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from None


def write_whole(file: Path, text: str) -> Path:
    """Write a text file so that a reader meets the old file or the new one, never a part."""
    if not file.parent.is_dir():
        raise FileNotFoundError(f"no folder {file.parent} to write {file.name} into")
    with whole(file) as half:
        half.write_text(text, encoding="utf-8")
    return file


def first_error(error: ValidationError) -> str:
    """The first thing that is wrong with a file, in one line: the field and what it must be."""
    first = error.errors()[0]
    return ": ".join([".".join(str(part) for part in first["loc"]), first["msg"]]).lstrip(": ")


def plain(value: Any) -> Any:
    """A value in JSON's own types: NumPy scalars and tuples converted, nan as None."""
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(v) for v in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not np.isfinite(value):
        return None if np.isnan(value) else str(value)
    return value


class _Header(BaseModel):
    format: str
    version: int


class _Document(BaseModel):
    """One kind of file; the fields of a subclass are the format, in the order they are written."""

    model_config = ConfigDict(extra="forbid", strict=True, hide_input_in_errors=True)


class _Solid(_Document):
    format: Literal["lineup-solid"] = "lineup-solid"
    version: Literal[1] = 1
    name: str
    pitch: FiniteFloat
    source: dict[str, Any]
    shape: tuple[Positive, Positive, Positive]
    occupancy: str

    @classmethod
    def of(cls, solid: Any) -> _Solid:
        return cls(
            name=solid.name,
            pitch=float(solid.pitch),
            source=plain(solid.source),
            shape=solid.occupancy.shape,
            occupancy=base64.b64encode(np.packbits(solid.occupancy).tobytes()).decode(),
        )

    def record(self) -> VoxelSolid:
        n = math.prod(self.shape)
        if n > MOST_CELLS:
            raise ValueError(f"a grid of {n:,} cells, and up to {MOST_CELLS:,} are read")
        n_bytes = -(-n // 8)
        if len(self.occupancy) != 4 * -(-n_bytes // 3):
            raise ValueError(
                f"occupancy has {len(self.occupancy)} base64 letters, not those of {n} voxels"
            )
        packed = np.frombuffer(base64.b64decode(self.occupancy, validate=True), np.uint8)
        bits = np.unpackbits(packed, count=n).astype(bool)
        return VoxelSolid(bits.reshape(self.shape), self.pitch, self.name, self.source)


class _Path(_Document):
    format: Literal["lineup-path"] = "lineup-path"
    version: Literal[1] = 1
    origin: Point
    letters: Letters
    visits: List[tuple[Whole, Whole, Whole, Whole]]
    dropped: List[Point]
    refinement: Positive
    method: str

    @classmethod
    def of(cls, path: Any) -> _Path:
        origin, letters = notation.lettered(path.voxels)
        return cls(
            origin=origin,
            letters=letters,
            visits=[tuple(row) for row in path.visits.tolist()],
            dropped=[tuple(row) for row in path.dropped.tolist()],
            refinement=path.refinement,
            method=path.method,
        )

    def record(self) -> VoxelPath:
        return VoxelPath(
            notation.positions(self.origin, self.letters),
            _rows(self.visits, 4),
            _rows(self.dropped, 3),
            self.refinement,
            self.method,
        )


class _Motion(_Document):
    format: Literal["lineup-motion"] = "lineup-motion"
    version: Literal[1, 2] = 2
    origin: Point
    letters: Letters
    moves: str
    poses: List[Letters]
    diameter: FiniteFloat
    max_bend_deg: FiniteFloat
    straight: bool
    reason: str
    n_angles: Annotated[int, Field(ge=0, le=2**20)] = 0
    angles: str = ""
    goal: tuple[Point, Letters] | None = None

    @classmethod
    def of(cls, motion: Any) -> _Motion:
        origin, letters = notation.lettered(motion.start)
        last = len(motion.start) - 1
        tokens = [notation.token(k, move, last) for k, move in enumerate(motion.moves.tolist())]
        return cls(
            origin=origin,
            letters=letters,
            moves=" ".join(tokens),
            poses=["".join(grid.LETTERS[d] for d in pose) for pose in motion.poses],
            diameter=float(motion.diameter),
            max_bend_deg=float(motion.max_bend_deg),
            straight=bool(motion.straight),
            reason=motion.reason,
            n_angles=len(motion.angles),
            angles=notation.packed(motion.angles),
            goal=notation.lettered(motion.goal) if len(motion.goal) else None,
        )

    def record(self) -> Motion:
        last = len(self.letters)
        wrong = next((k for k, pose in enumerate(self.poses) if len(pose) != last), None)
        if wrong is not None:
            raise ValueError(
                f"pose {wrong} has {len(self.poses[wrong])} letters, not {last}, one for each bar"
            )
        moves = (
            notation.move(k, token, last, len(self.poses), self.n_angles)
            for k, token in enumerate(self.moves.split())
        )
        n_bars = last if self.poses else 0
        poses = np.array([notation.directions(pose) for pose in self.poses], np.int8)
        return Motion(
            notation.positions(self.origin, self.letters),
            np.fromiter(moves, np.dtype((np.int32, 4))),
            self.diameter,
            self.max_bend_deg,
            self.straight,
            self.reason,
            poses.reshape(len(self.poses), n_bars),
            notation.unpacked(self.angles, self.n_angles, last),
            _rows([], 3) if self.goal is None else notation.positions(*self.goal),
        )


class _Folding(_Document):
    format: Literal["lineup-folding"] = "lineup-folding"
    version: Literal[1] = 1
    path: _Path
    motion: _Motion

    @classmethod
    def of(cls, folding: Any) -> _Folding:
        return cls(path=_Path.of(folding.path), motion=_Motion.of(folding.motion))

    def record(self) -> Folding:
        return Folding(self.path.record(), self.motion.record())


class _Certificate(_Document):
    ok: bool
    reason: str
    where: Whole
    diameter: Number
    clearance: Number
    max_bend_deg: Number
    bend_deg: Number
    moves_checked: Whole
    nearest: tuple[Whole, Whole, Whole] = (-1, -1, -1)
    most_bent: tuple[Whole, Whole] = (-1, -1)
    extent: tuple[Number, Number, Number] = (None, None, None)
    violations: Whole = 0

    @classmethod
    def of(cls, certificate: Certificate) -> _Certificate:
        fields = plain(asdict(certificate))
        places = {name: tuple(fields[name]) for name in ("nearest", "most_bent", "extent")}
        return cls(**fields | places)

    def record(self) -> Certificate:
        fields = self.model_dump()
        for name in ("diameter", "clearance", "max_bend_deg", "bend_deg"):
            fields[name] = _number(fields[name])
        fields["extent"] = tuple(_number(side) for side in fields["extent"])
        return Certificate(**fields)


class _Design(_Document):
    format: Literal["lineup-design"] = "lineup-design"
    version: Literal[1, 2] = 2
    models: List[_Solid]
    foldings: List[_Folding]
    certificates: List[_Certificate]
    columns: List[str]
    rows: List[List[Cell]]

    @classmethod
    def of(cls, design: Any) -> _Design:
        table = design.table[[c for c in design.table if not str(c).startswith("seconds")]]
        return cls(
            models=[_Solid.of(solid) for solid in design.models],
            foldings=[_Folding.of(folding) for folding in design.foldings],
            certificates=[_Certificate.of(certificate) for certificate in design.certificates],
            columns=[str(c) for c in table],
            rows=plain(list(table.itertuples(index=False, name=None))),
        )

    def record(self) -> Design:
        if not len(self.models) == len(self.foldings) == len(self.certificates) <= len(self.rows):
            raise ValueError(
                "models, foldings and certificates differ in number, or are more than the rows"
            )
        if any(len(row) != len(self.columns) for row in self.rows):
            raise ValueError(f"a row has not {len(self.columns)} cells, one for each column")
        return Design(
            tuple(solid.record() for solid in self.models),
            tuple(folding.record() for folding in self.foldings),
            tuple(certificate.record() for certificate in self.certificates),
            pd.DataFrame(self.rows, columns=self.columns),
        )


_DOCUMENTS: dict[type, type[_Solid | _Path | _Motion | _Folding | _Design]] = {
    VoxelSolid: _Solid,
    VoxelPath: _Path,
    Motion: _Motion,
    Folding: _Folding,
    Design: _Design,
}


def _document_of(header: _Header) -> type[_Solid | _Path | _Motion | _Folding | _Design]:
    known = {d.model_fields["format"].default: d for d in _DOCUMENTS.values()}
    if header.format not in known:
        raise ValueError(f"unknown format {header.format!r}; known: {', '.join(known)}")
    latest = known[header.format].model_fields["version"].default
    if not 1 <= header.version <= latest:
        raise ValueError(
            f"version {header.version} of {header.format}; this program reads 1 to {latest}"
        )
    return known[header.format]


def _design_file(file: str | os.PathLike[str]) -> Path:
    if not isinstance(file, str | os.PathLike):
        raise ValueError(f"a file is named by a text or a path, got {type(file).__name__}")
    path = Path(file)
    return path / "design.json" if path.is_dir() else path


def _number(value: float | str | None) -> float:
    return float("nan") if value is None else float(value)


def _rows(rows: Sequence[Sequence[int]], width: int) -> grid.IntArray:
    return np.array(rows, np.int32).reshape(len(rows), width)
