"""Layered paths through a solid (Section 4): the best of several spanning trees and MSPs.

The paper takes one depth-first tree. Which voxels can be linked depends on the tree and on its
MSP, by tens of percent where the solid has handles, so several of both are tried.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ._options import checked
from ._record import of_kind
from .linking import Effort, assembled, layers, linked, promising_plan
from .paper import algorithm3
from .refinement import REFINED
from .solid import VoxelPath, VoxelSolid
from .spatial import free3d, nested, ufree

ONE_START, SHORT_SEARCH = 20_000, 500_000
"""Voxels beyond which one start is made, and beyond which its planar searches are half as long."""


def layered_path(
    solid: VoxelSolid, method: str = "layered", seed: int = 0, **options: Any
) -> VoxelPath:
    """A long simple path that visits the solid layer by layer (Section 4, Algorithm 3).

    Parameters
    ----------
    method : str
        A key of `PATH_METHODS`.
    seed : int
        The same solid, seed and options give the same path.
    options
        Keyword options of the method. Those of ``"layered"``: `starts`, spanning trees and MSPs
        tried (4; 1 for more than 20,000 voxels); `sweeps`, length of each planar search, see
        `planar.long_path` (100; 50 for more than 500,000 voxels); `both_ends_on_top` (False),
        put both ends in one node, as high up as can be. Those of
        ``"nested"``, ``"free3d"`` and ``"ufree"``, which anneal a layered path: `starts` for that
        path; `sweeps` (6000, 3000, 10000), proposals for each voxel; `surface_weight` (1.5),
        worth of a surface voxel, an interior one being 1.
        ``"refined"`` and ``"refined4"`` have none: they visit all of ``refine(solid, 2)``, and
        all of ``refine(solid, 4)`` without a U. Nor has ``"paper"``, see `algorithm3`.

    Returns
    -------
    VoxelPath
        Even and of at least two voxels; `dropped` holds the voxels that could not be linked.

    Raises
    ------
    ValueError
        If the method or an option is unknown or out of range, or the solid is one voxel and the
        method does not refine it.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> path = lu.layered_path(lu.VoxelSolid(np.ones((4, 3, 2), bool)))
    >>> len(path), path.visits[:, 2:].tolist()
    (24, [[1, 0], [0, 0]])
    """
    of_kind(solid, VoxelSolid)
    checked(PATH_METHODS, method, options, "path method")
    if solid.size < 2 and method not in REFINED:
        raise ValueError("a path needs at least two voxels, the solid has 1")
    return PATH_METHODS[method](solid, seed, **options)


def layered_paths(
    solid: VoxelSolid,
    seed: int = 0,
    *,
    starts: int | None = None,
    sweeps: int | None = None,
    both_ends_on_top: bool = False,
) -> list[VoxelPath]:
    """One layered path for each start, the longest first: varied starts for the planners.

    Takes the options of `layered_path` with ``method="layered"`` and raises as it does.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup.layered import layered_paths
    >>> [len(p) for p in layered_paths(lu.VoxelSolid(np.ones((4, 3, 2), bool)), starts=2)]
    [24, 24]
    """
    starts = starts if starts is not None else 4 if solid.size <= ONE_START else 1
    sweeps = sweeps if sweeps is not None else 100 if solid.size <= SHORT_SEARCH else 50
    for name, value, least in (("seed", seed, 0), ("starts", starts, 1), ("sweeps", sweeps, 1)):
        if value < least:
            raise ValueError(f"{name} must be at least {least}, got {value}")
    if solid.size < 2:
        raise ValueError("a path needs at least two voxels, the solid has 1")
    shape = layers(solid)
    effort = Effort(sweeps=sweeps)
    paths = []
    for k in range(starts):
        rng = np.random.default_rng([seed, k])
        plan, ahead = promising_plan(shape, k, both_ends_on_top, rng)
        paths.append(assembled(shape, linked(shape, plan, ahead, effort, rng), "layered"))
    return sorted(paths, key=len, reverse=True)


def _layered(
    solid: VoxelSolid,
    seed: int,
    *,
    starts: int | None = None,
    sweeps: int | None = None,
    both_ends_on_top: bool = False,
) -> VoxelPath:
    return layered_paths(
        solid, seed, starts=starts, sweeps=sweeps, both_ends_on_top=both_ends_on_top
    )[0]


def _annealed(
    method: Callable[[VoxelPath, VoxelSolid, int, float, int], VoxelPath],
    solid: VoxelSolid,
    seed: int,
    *,
    sweeps: int,
    starts: int | None = None,
    surface_weight: float = 1.5,
) -> VoxelPath:
    """A layered path annealed as a whole by `method`."""
    for name, value, least in (("sweeps", sweeps, 1), ("surface_weight", surface_weight, 0)):
        if value < least:
            raise ValueError(f"{name} must be at least {least}, got {value}")
    path = _layered(solid, seed, starts=starts)
    return method(path, solid, sweeps, surface_weight, seed)


def _paper(solid: VoxelSolid, seed: int) -> VoxelPath:
    return algorithm3(solid, seed).path


PATH_METHODS: dict[str, Callable[..., VoxelPath]] = {
    "layered": _layered,
    "nested": partial(_annealed, nested, sweeps=6000),
    "free3d": partial(_annealed, free3d, sweeps=3000),
    "ufree": partial(_annealed, ufree, sweeps=10000),
    "paper": _paper,
    **REFINED,
}
"""The path methods by name: functions of a solid, a seed and keyword-only options."""
