"""Algorithm 1: from solids to poses of one chain, and back to a straight line."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import permutations
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from . import grid
from ._files import plain_name
from ._record import listed, of_kind
from .bounds import path_bound
from .catalog import model
from .folding import fold
from .joints import JOINTS
from .judging import certify, certify_path
from .layered import layered_paths
from .motion.plan import DIAMETER, MAX_BEND_DEG
from .solid import Certificate, Design, Folding, VoxelSolid
from .storage import save
from .transformation import DONE, transform
from .trimming import trim
from .voxelization import voxelize

LIKELY_COVERAGE = 0.97
MAX_TRIES = 6
MIN_BLOCKS = 2

Source = Any
"""A name of the catalogue, a mesh file, a trimesh or pyvista mesh, or a VoxelSolid."""


@dataclass(frozen=True)
class _Result:
    solid: VoxelSolid
    folding: Folding
    certificate: Certificate
    row: dict[str, Any]


def lineup(
    models: Sequence[Source],
    blocks: int = 754,
    *,
    seed: int = 0,
    ends: int = 2,
    joints: str = "free",
    folder: str | os.PathLike[str] | None = None,
    progress: Callable[[str, str], None] | None = None,
) -> Design:
    """Fold one chain of `blocks` building blocks into every model (Algorithm 1).

    The number of voxels of each model is chosen so that its path reaches the common length,
    and the path is trimmed to exactly that.

    Parameters
    ----------
    models : sequence
        Names of the catalogue, mesh files, meshes, or solids; a VoxelSolid is taken as it is.
    blocks : int
        Number of building blocks; each is two voxels.
    ends : int
        How many ends of the chain may let go, see `fold`; with 1, `transform` can stay in a box.
    joints : str
        "free", or "slotted": folded and judged so that no printed capsule has to twist, see `fold`.
    folder : path, optional
        Store each model as soon as it is done: ``NAME.solid.json`` and ``NAME.folding.json``. Made
        if it does not exist.
    progress : function, optional
        Told (name, stage); the last stage of a model is "done" or "failed: reason".

    Returns
    -------
    Design
        A model that fails is a row of the table with its reason, and is in no other part.

    Raises
    ------
    ValueError
        If there are no models, two that would be stored under one name, one under a name that no
        file can have, fewer than two blocks, the seed is negative, or the joints are of no known
        kind.

    Examples
    --------
    >>> import lineup as lu
    >>> design = lu.lineup(["duck", "mug"], blocks=40)
    >>> [len(folding.path) for folding in design.foldings], [c.ok for c in design.certificates]
    ([80, 80], [True, True])
    """
    names = _names(models)
    _check_settings(blocks, seed)
    if joints not in JOINTS:
        raise ValueError(f"joints must be one of {JOINTS}, got {joints!r}")
    if folder is not None:
        if len(set(names)) < len(names):
            listed = ", ".join(sorted(names))
            raise ValueError(f"two models would be stored under one name: {listed}")
        for name in names:
            plain_name(name)
        Path(folder).mkdir(parents=True, exist_ok=True)
    attempts = [
        _attempt(name, source, blocks, seed, folder, progress, ends, joints)
        for name, source in zip(names, models, strict=True)
    ]
    return _extended(Design((), (), (), pd.DataFrame()), attempts)


def add(
    design: Design,
    model: Source,
    seed: int = 0,
    *,
    progress: Callable[[str, str], None] | None = None,
) -> Design:
    """`design` with one model more for the same chain (incremental design, Section 8, Figure 15).

    The model is voxelized so that its path reaches the length of the chain, trimmed to exactly
    that, and unfolded into the same line.

    Parameters
    ----------
    model : str, path, mesh or VoxelSolid
        As in `lineup`. Unlike there, a name the design has already may come again.
    progress : function, optional
        As in `lineup`.

    Returns
    -------
    Design
        Its earlier models, foldings and certificates are those of `design`, untouched; so is
        `design`. A model that fails is a row of the table with its reason, and no more.

    Raises
    ------
    ValueError
        If the design has no folding, foldings of several lengths, or the seed is negative.

    Examples
    --------
    >>> import lineup as lu
    >>> design = lu.add(lu.lineup(["duck"], blocks=40), "mug")
    >>> design.table["model"].tolist(), [len(folding.path) for folding in design.foldings]
    (['duck', 'mug'], [80, 80])
    """
    of_kind(design, Design)
    lengths = sorted({len(folding.path) for folding in design.foldings})
    if len(lengths) != 1 or lengths[0] % 2:
        got = f"foldings of {', '.join(map(str, lengths))} voxels" if lengths else "no folding"
        raise ValueError(
            f"a model is added to a chain of one even length, and the design has {got}"
        )
    blocks = lengths[0] // 2
    _check_settings(blocks, seed)
    (name,) = _names([model], first=len(design.table) + 1)
    return _extended(design, [_attempt(name, model, blocks, seed, None, progress)])


def transformations(
    design: Design,
    folder: str | os.PathLike[str],
    *,
    within: tuple[int, int, int] | None = None,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
) -> pd.DataFrame:
    """Write the motion from each shape of a design to each other, ``A-to-B.motion.json``.

    Parameters
    ----------
    folder : path
        Made if it does not exist.
    within : (X, Y, Z), optional
        As in `transform`.
    progress : function, optional
        Told "A to B" as each begins.

    Returns
    -------
    DataFrame
        One row for each ordered pair: from, to, moves, certified, diameter, max_bend_deg,
        clearance, the box (box_x, box_y, box_z) in pitches that the motion needs, reason. A pair
        without a motion has its reason, and no file.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    tell = progress or (lambda pair: None)
    named = design.table.loc[design.table["failure"] == "", "model"]
    made = [plain_name(str(name)) for name in named]
    rows = []
    for (name, a), (other, b) in permutations(zip(made, design.foldings, strict=True), 2):
        tell(f"{name} to {other}")
        motion = transform(a, b, within=within, seed=seed)
        row = {"from": name, "to": other, "moves": len(motion)}
        if motion.reason == DONE:
            save(motion, folder / f"{name}-to-{other}.motion.json")
            row |= _transformation_row(certify(motion, motion.diameter, motion.max_bend_deg))
        else:
            row |= {"certified": False, "reason": motion.reason}
        rows.append(row)
    return pd.DataFrame(rows)


def _transformation_row(verdict: Certificate) -> dict[str, Any]:
    return {
        "certified": verdict.ok,
        "diameter": verdict.diameter,
        "max_bend_deg": verdict.max_bend_deg,
        "clearance": verdict.clearance,
        **dict(zip(("box_x", "box_y", "box_z"), verdict.extent, strict=True)),
        "reason": verdict.reason,
    }


def _attempt(
    name: str,
    source: Source,
    blocks: int,
    seed: int,
    folder: str | os.PathLike[str] | None,
    progress: Callable[[str, str], None] | None,
    ends: int = 2,
    joints: str = "free",
) -> tuple[_Result | None, dict[str, Any]]:
    """What became of one model, None if it failed, and its row; stored if there is a folder."""
    tell = progress or (lambda name, stage: None)
    try:
        result = _line_up(source, blocks, seed, partial(tell, name), ends, joints)
    except Exception as error:  # whatever is wrong with one model, the others go on
        expected = isinstance(error, ValueError | OSError)
        reason = str(error) if expected else f"{type(error).__name__}: {error}"
        tell(name, f"failed: {reason}")
        return None, {"model": name, "blocks": blocks, "failure": reason}
    if folder is not None:
        _store(result, name, Path(folder))
    tell(name, "done")
    return result, {"model": name, "blocks": blocks, **result.row, "failure": ""}


def _extended(design: Design, attempts: Sequence[tuple[_Result | None, dict[str, Any]]]) -> Design:
    """A design with more rows, and what those attempts that went well made."""
    results = [result for result, _ in attempts if result is not None]
    return Design(
        (*design.models, *(result.solid for result in results)),
        (*design.foldings, *(result.folding for result in results)),
        (*design.certificates, *(result.certificate for result in results)),
        pd.DataFrame([*design.table.to_dict("records"), *(row for _, row in attempts)]),
    )


def table2_task(
    model: str, blocks: int, seed: int, *, folder: Path, progress: Callable[[str], None]
) -> dict[str, Any]:
    """One row of Table 2; stores ``NAME.solid.json`` and ``NAME.folding.json`` in `folder`."""
    _check_settings(blocks, seed)
    result = _line_up(model, blocks, seed, progress)
    _store(result, Path(model).stem, folder)
    return result.row


def _store(result: _Result, name: str, folder: Path) -> None:
    save(result.solid, folder / f"{name}.solid.json")
    save(result.folding, folder / f"{name}.folding.json")


def _names(models: Sequence[Source], first: int = 1) -> list[str]:
    """What each source is called in tables and file names, a nameless one by its number."""
    listed(models, "models")
    if len(models) == 0:
        raise ValueError("there are no models; give at least one name, file, mesh or solid")
    return [
        Path(source).stem
        if isinstance(source, str | os.PathLike)
        else str(getattr(source, "name", "")) or f"model{number}"
        for number, source in enumerate(models, start=first)
    ]


def _check_settings(blocks: int, seed: int) -> None:
    for name, value, least in (("blocks", blocks, MIN_BLOCKS), ("seed", seed, 0)):
        if not isinstance(value, int | np.integer) or value < least:
            raise ValueError(f"{name} must be an integer of at least {least}, got {value!r}")


def _line_up(
    source: Source,
    blocks: int,
    seed: int,
    tell: Callable[[str], None],
    ends: int = 2,
    joints: str = "free",
) -> _Result:
    """Voxelize, fold, trim and judge one model; more voxels again while its path is too short."""
    length = 2 * blocks
    wanted = round(length / LIKELY_COVERAGE)
    clock = _Clock(tell)
    for _ in range(MAX_TRIES):
        with clock("voxelize"):
            solid = _solid(source, wanted)
        with clock("layered"):
            paths = layered_paths(solid, seed)
        with clock("fold"):
            folding = fold(solid, seed=seed, paths=paths, ends=ends, joints=joints)
        found = len(folding.path)
        if found >= length or isinstance(source, VoxelSolid):
            break
        wanted = max(round(1.004 * wanted * length / found), wanted + 2)
    if found < length:
        raise ValueError(
            f"the longest path found has {found} of the {length} voxels of {blocks} blocks; "
            "use fewer blocks, or a solid with more voxels"
        )
    with clock("trim"):
        trimmed = trim([folding], length)[0]
    with clock("certify"):
        path_certificate = certify_path(trimmed.path, solid)
        certificate = certify(trimmed.motion, DIAMETER, MAX_BEND_DEG, joints=joints)
    judged = {
        **_path_row(solid, len(paths[0]), found, trimmed),
        **_verdict_row(trimmed, certificate, path_certificate),
    }
    return _Result(solid, trimmed, certificate, {**judged, **clock.seconds})


def _solid(source: Source, voxels: int) -> VoxelSolid:
    if isinstance(source, VoxelSolid):
        return source
    if isinstance(source, str) and not Path(source).suffix:  # a mesh file has an ending
        return model(source, voxels=voxels)
    return voxelize(source, voxels=voxels)


def _path_row(solid: VoxelSolid, layered: int, folded: int, trimmed: Folding) -> dict[str, Any]:
    surface = grid.surface(solid.occupancy)
    bound = path_bound(solid)
    return {
        "source": str(solid.source.get("kind", "solid")),
        "voxels": solid.size,
        "iou": solid.source.get("iou"),
        "layered_coverage": layered / solid.size,
        "folded_coverage": folded / solid.size,
        "bound": bound,
        "gap": bound - folded,
        "surface_kept": float(surface[tuple(trimmed.path.voxels.T)].sum() / surface.sum()),
        "length": len(trimmed.path),
        "moves": len(trimmed.motion),
    }


def _verdict_row(trimmed: Folding, motion: Certificate, path: Certificate) -> dict[str, Any]:
    faults = [c.reason for c in (path, motion) if not c.ok]
    return {
        "straight": trimmed.motion.straight,
        "certified": motion.ok and path.ok,
        "diameter": motion.diameter,
        "max_bend_deg": motion.max_bend_deg,
        "clearance": motion.clearance,
        "reason": "; ".join(faults) or "certified",
    }


class _Clock:
    """Seconds spent in each stage, told as each begins."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        self.seconds: dict[str, float] = {}
        self._tell = tell

    def __call__(self, stage: str) -> _Clock:
        self._stage = f"seconds_{stage}"
        self._tell(stage)
        return self

    def __enter__(self) -> None:
        self._start = time.perf_counter()

    def __exit__(self, *exception: object) -> None:
        spent = time.perf_counter() - self._start
        self.seconds[self._stage] = self.seconds.get(self._stage, 0.0) + spent
