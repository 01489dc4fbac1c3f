"""The models by name: a folder of meshes, a fetched original, or a procedural stand-in."""

from __future__ import annotations

import csv
import difflib
import hashlib
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import pandas as pd
import pooch  # type: ignore[import-untyped]

from ._files import content
from .meshes import Surface, read_surface, surface_of, turned_upright
from .shapes import triangulated
from .shells import Thickness
from .solid import VoxelSolid
from .voxelization import check_voxels, fitted_shell

FOLDER_VARIABLE = "LINEUP_MODELS"
"""Environment variable naming a folder of upright meshes NAME.ply; used before all else."""

CACHE_VARIABLE = "LINEUP_CACHE"
"""Environment variable naming the folder of fetched meshes, in place of the user's cache."""

_TABLE = Path(__file__).parent.parent / "data" / "models.csv"


@dataclass(frozen=True)
class _Entry:
    """A row of data/models.csv; `path` and what goes with it are empty for a formula."""

    name: str
    set: str
    up: str
    repository: str
    commit: str
    path: str
    sha256: str
    licence: str

    @property
    def url(self) -> str:
        return f"https://raw.githubusercontent.com/{self.repository}/{self.commit}/{self.path}"

    @property
    def in_folder(self) -> Path | None:
        """The model's mesh in the folder that the environment names, if it is there."""
        folder = os.environ.get(FOLDER_VARIABLE)
        if not folder:
            return None
        if not Path(folder).is_dir():
            raise ValueError(f"{FOLDER_VARIABLE} must name a folder of meshes, got {folder!r}")
        file = Path(folder) / f"{self.name}.ply"
        return file if file.is_file() else None

    @property
    def in_cache(self) -> Path:
        """Where the fetched original is, or would be."""
        folder = os.environ.get(CACHE_VARIABLE) or pooch.os_cache("lineup-workbench")
        return Path(folder) / f"{self.name}{Path(self.path).suffix}"

    @property
    def origin(self) -> str:
        if self.in_folder:
            return "folder"
        return "original" if self.path and self.in_cache.is_file() else "procedural"


def models() -> pd.DataFrame:
    """The catalogue, one row a model, those of Table 2 first.

    Returns
    -------
    DataFrame
        "name"; "set": 1 or 2 for the two sets of Table 2, 0 for further models; "kind": "mesh"
        where a published mesh stands behind the name, "formula" where the model is defined here;
        "up": the direction of the published mesh that is up; "source": where `model` would take
        it from now, "folder", "original" or "procedural"; "licence" of the published mesh.

    Examples
    --------
    >>> models()["name"].tolist()[:5]
    ['bunny', 'decocube', 'cannon', 'two_holed_torus', 'duck']
    """
    rows = [
        {
            "name": entry.name,
            "set": int(entry.set),
            "kind": "mesh" if entry.path else "formula",
            "up": entry.up,
            "source": entry.origin,
            "licence": entry.licence,
        }
        for entry in _entries().values()
    ]
    return pd.DataFrame(rows)


def model(
    name: str,
    voxels: int = 1600,
    up: str | tuple[float, float, float] | None = None,
    shell: Thickness | None = None,
) -> VoxelSolid:
    """A model of the catalogue, voxelized (Section 3, Table 2).

    The mesh is NAME.ply in the folder that the environment variable LINEUP_MODELS names, else the
    original if `fetch` has brought it, else a procedural stand-in.

    Parameters
    ----------
    name : str
        A name in `models`.
    voxels : int
        Target count, as in `voxelize`.
    up : {"+x", "-x", "+y", "-y", "+z", "-z"} or 3 numbers, optional
        Direction of the upright model that becomes +z, to lay it down; the same wherever the mesh
        comes from. None leaves it upright.
    shell : int or function of z, optional
        Thickness of a shell of `voxels` voxels, as in `voxelize`.

    Returns
    -------
    VoxelSolid
        As from `voxelize`; ``source["kind"]`` says which of "folder", "original" and "procedural"
        was used.

    Raises
    ------
    ValueError
        If there is no such model, a fetched file is not the one of the catalogue, or as `voxelize`.

    Examples
    --------
    >>> solid = model("two_holed_torus", voxels=300)
    >>> solid.name, solid.source["euler_solid"]
    ('two_holed_torus', -1)
    """
    entry = _entry(name)
    check_voxels(voxels)
    surface = turned_upright(_upright_surface(entry), "+z" if up is None else up)
    direction = up if up is None or isinstance(up, str) else [float(c) for c in up]
    return fitted_shell(surface, voxels, name, {"up": direction or "+z"}, shell)


def surface_for(
    source: object, up: str | tuple[float, float, float] | None = None
) -> tuple[Surface, str]:
    """The upright surface of a model by its name, or of what `voxelize` takes; and a name for it.

    Raises
    ------
    FileNotFoundError, ValueError
        As `model` and `voxelize`.
    """
    if isinstance(source, str) and not Path(source).suffix:  # a mesh file has an ending
        surface, name = _upright_surface(_entry(source)), source
    else:
        name = Path(source).stem if isinstance(source, str | os.PathLike) else ""
        surface = surface_of(source)
    return turned_upright(surface, "+z" if up is None else up), name


def fetch(
    names: Sequence[str] | None = None, downloader: Callable[..., Any] | None = None
) -> dict[str, Path]:
    """Download the original meshes of the catalogue into the cache, each checked by its SHA-256.

    Parameters
    ----------
    names : sequence of str, optional
        All models that have an original if not given.
    downloader : callable, optional
        How to download, as ``pooch.retrieve`` takes it.

    Returns
    -------
    dict
        The file of each model.

    Raises
    ------
    ValueError
        If a model is unknown or is a formula, or if what was downloaded is not the file of the
        catalogue; that file is not kept.
    ConnectionError
        If a download fails.
    """
    if names is None:
        names = [entry.name for entry in _entries().values() if entry.path]
    return {name: _fetched(_entry(name), downloader) for name in names}


def _fetched(entry: _Entry, downloader: Callable[..., Any] | None) -> Path:
    if not entry.path:
        raise ValueError(f"{entry.name!r} is a formula: there is nothing to fetch")
    file = entry.in_cache
    try:
        pooch.retrieve(
            entry.url, f"sha256:{entry.sha256}", file.name, file.parent, downloader=downloader
        )
    except ValueError as error:
        raise ValueError(
            f"the file at {entry.url} is not the {entry.name} of the catalogue: "
            f"its SHA-256 is not {entry.sha256}; it was not kept"
        ) from error
    except OSError as error:
        why = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ConnectionError(
            f"{entry.name} could not be fetched from {entry.url}: {why}"
        ) from error
    return file


def _upright_surface(entry: _Entry) -> Surface:
    folder_file = entry.in_folder
    if folder_file:
        surface, kind, up = read_surface(folder_file), "folder", "+z"
    elif entry.origin == "original":
        if hashlib.sha256(content(entry.in_cache)).hexdigest() != entry.sha256:
            raise ValueError(
                f"the fetched {entry.in_cache.name} is not the file of the catalogue: "
                "fetch it again, or delete it to use the procedural stand-in"
            )
        surface, kind, up = read_surface(entry.in_cache), "original", entry.up
    else:
        surface, kind, up = _procedural(entry.name), "procedural", "+z"
    surface = replace(surface, provenance={**surface.provenance, "kind": kind})
    return turned_upright(surface, up)


@lru_cache(maxsize=8)
def _procedural(name: str) -> Surface:
    return surface_of(triangulated(name))


def _entry(name: str) -> _Entry:
    if not isinstance(name, str):
        raise ValueError(f"a model is given by its name, got {type(name).__name__}")
    entries = _entries()
    if name not in entries:
        near = difflib.get_close_matches(name, entries, n=3)
        hint = f"did you mean {' or '.join(near)}?" if near else f"there are {', '.join(entries)}"
        raise ValueError(f"unknown model {name!r}; {hint}")
    return entries[name]


@lru_cache(maxsize=1)
def _entries() -> dict[str, _Entry]:
    with _TABLE.open(newline="", encoding="utf-8") as file:
        return {row["name"]: _Entry(**row) for row in csv.DictReader(file)}
