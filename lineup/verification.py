"""Judge stored results anew: what a file says of itself is not believed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from .judging import certify, certify_path, check_limits
from .solid import Certificate, Design, Folding, Motion, VoxelPath, VoxelSolid
from .storage import MOST_CELLS, load

ENDINGS = tuple(f".{kind}.json" for kind in ("solid", "path", "motion", "folding", "design"))


def stored_files(place: Path) -> list[Path]:
    """The file itself, or what a folder and its folders hold: NAME.KIND.json and design.json.

    Raises
    ------
    FileNotFoundError
        If there is no such file or folder, or the folder holds no stored result.
    """
    if place.is_file():
        return [place]
    if not place.is_dir():
        raise FileNotFoundError(f"no file or folder {place}")
    found = [f for f in place.rglob("*.json") if f.name.endswith(ENDINGS)]
    found += place.rglob("design.json")
    if not found:
        raise FileNotFoundError(f"no stored result (NAME.KIND.json or design.json) in {place}")
    return sorted(found)


def stored_name(file: Path) -> str:
    """NAME of a file NAME.KIND.json; NAME may have dots. The stem of any other file."""
    ending = next((ending for ending in ENDINGS if file.name.endswith(ending)), file.suffix)
    return file.name.removesuffix(ending)


def verdicts(
    file: Path, diameter: float | None = None, max_bend_deg: float | None = None
) -> Iterator[tuple[str, Certificate]]:
    """What the judge says of each part of a stored result.

    A path is judged against the solid stored beside it (NAME.solid.json); where there is none,
    against the voxels that it visits and those that it says it drops. A motion is judged at the
    diameter and the bend that it claims itself, unless others are given.

    Raises
    ------
    FileNotFoundError, ValueError
        As `load`.
    """
    stored = load(file)
    beside = file.with_name(f"{stored_name(file)}.solid.json")
    if isinstance(stored, VoxelSolid):
        # The record refuses whatever is not a solid, so one that loads is one.
        yield "solid", Certificate(True, "certified")
    if isinstance(stored, (VoxelPath, Folding)):
        path = stored if isinstance(stored, VoxelPath) else stored.path
        solid = load(beside) if beside.is_file() else _own_solid(path)
        if not isinstance(solid, VoxelSolid):
            raise ValueError(f"{beside} does not hold a solid")
        yield "path", certify_path(path, solid)
    if isinstance(stored, (Motion, Folding)):
        motion = stored if isinstance(stored, Motion) else stored.motion
        yield "motion", _judged(motion, diameter, max_bend_deg)
    if isinstance(stored, Design):
        yield "lengths", _common_length(stored)
        for solid, folding in zip(stored.models, stored.foldings, strict=True):
            yield f"{solid.name} path", certify_path(folding.path, solid)
            yield f"{solid.name} motion", _judged(folding.motion, diameter, max_bend_deg)


def _judged(motion: Motion, diameter: float | None, max_bend_deg: float | None) -> Certificate:
    check_limits(diameter, max_bend_deg)
    diameter = motion.diameter if diameter is None else diameter
    max_bend_deg = motion.max_bend_deg if max_bend_deg is None else max_bend_deg
    try:
        check_limits(diameter, max_bend_deg)
    except ValueError as error:
        return Certificate(False, f"its claim cannot be judged: {error}")
    return certify(motion, diameter, max_bend_deg)


def _own_solid(path: VoxelPath) -> VoxelSolid:
    """The solid that a path says it comes from: what it visits and what it drops."""
    if path.refinement != 1:
        raise ValueError("a refined path is judged against its solid, NAME.solid.json beside it")
    voxels = np.vstack([path.voxels, path.dropped])
    if voxels.min() < 0:
        raise ValueError(f"a voxel of the path has a negative coordinate: {voxels.min()}")
    if np.prod(voxels.max(axis=0) + 1, dtype=np.float64) > MOST_CELLS:
        raise ValueError("the voxels of the path lie too far apart for one grid")
    occupancy = np.zeros(voxels.max(axis=0) + 1, bool)
    occupancy[tuple(voxels.T)] = True
    return VoxelSolid(occupancy)


def _common_length(design: Design) -> Certificate:
    lengths = sorted({len(folding.path) for folding in design.foldings})
    if not lengths:
        return Certificate(False, "no model was folded")
    if len(lengths) > 1:
        return Certificate(False, f"the foldings differ in length: {lengths}")
    return Certificate(True, "certified")
