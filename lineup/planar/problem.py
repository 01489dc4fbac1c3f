"""The planar problem by several methods: a long path between two cells of one layer."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .._options import checked
from .._record import record
from ..grid import BoolArray, IntArray, components
from .blocks import Region, chain, chain_limit, region
from .exact import exact_path
from .faces import Cell, check_ends, check_mask
from .long import NO_WISHES, long_path
from .paper import paper_path

OPTIMAL = "optimal"
SEARCHED = "searched"
OUT_OF_TIME = "time ran out"
APART = "ends not connected"


@record
class PlanarPath:
    """A path between two cells of a planar region, and how good it can be.

    Attributes
    ----------
    cells : (P, 2) int32
        (x, y) from start to end; empty if there is no path, or none was found.
    bound : int
        No path between these ends has more cells; 0 if the region does not connect them.
    optimal : bool
        Whether `cells` has `bound` cells.
    reason : str
        ``"optimal"``; ``"searched"``, if a heuristic ended below the bound; ``"time ran out"``,
        if a proof did not end; ``"ends not connected"``; or the reason codes of the assumptions
        of the paper that fail, with commas between.
    method : str
        Key of `PLANAR_METHODS`.
    """

    cells: IntArray
    bound: int
    optimal: bool
    reason: str
    method: str

    def __len__(self) -> int:
        return len(self.cells)


def planar_path(
    mask: BoolArray,
    start: Cell,
    end: Cell,
    method: str = "long",
    seed: int = 0,
    **options: Any,
) -> PlanarPath:
    """A long simple path between two given cells of a planar region (Section 4.1).

    Parameters
    ----------
    mask : (X, Y) bool
        The region. Cells that are not connected to `start` do not matter.
    start, end : (x, y)
        Two different cells of it.
    method : str
        ``"paper"`` is Algorithm 2 (`planar.paper_path` gives its steps), ``"long"`` our search,
        ``"exact"`` CP-SAT, which needs the extra ``exact``.
    seed : int
        The same region, ends, seed and options give the same path.
    options
        Keyword options of the method. Those of ``"long"``: `restarts` (8) and `sweeps` (300),
        see `planar.long_path`. That of ``"exact"``: `limit` (60.0), deterministic time in
        about seconds.

    Raises
    ------
    ValueError
        If the mask, an end, the method or an option is not as said.
    RuntimeError
        If ``"exact"`` finds no OR-Tools.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> path = lu.planar_path(np.ones((3, 5), bool), (0, 0), (0, 1))
    >>> len(path), path.bound, path.reason
    (14, 14, 'optimal')
    """
    checked(PLANAR_METHODS, method, options, "planar method")
    if seed < 0:
        raise ValueError(f"seed must be at least 0, got {seed}")
    for name, value in options.items():
        if not value > 0:
            raise ValueError(f"{name} must be positive, got {value}")
    part = _part(mask, start, end)
    if not part[end]:
        return PlanarPath(np.empty((0, 2), np.int32), 0, True, APART, method)
    return PLANAR_METHODS[method](part, start, end, seed, **options)


def _part(mask: BoolArray, start: Cell, end: Cell) -> BoolArray:
    """The part of the region around `start`, after checks."""
    check_mask(mask)
    check_ends(mask, start, end)
    label, _ = components(mask[:, :, None])
    part: BoolArray = label[:, :, 0] == label[(*start, 0)]
    return part


def _paper(mask: BoolArray, start: Cell, end: Cell, seed: int) -> PlanarPath:
    found = paper_path(mask, start, end, seed)
    flat, first, last = _flat(mask, start, end)
    bound, _ = chain_limit(flat, chain(flat, first, last), first)
    optimal = len(found) == bound
    reason = ", ".join(found.reasons) or (OPTIMAL if optimal else SEARCHED)
    return PlanarPath(found.cells, bound, optimal, reason, "paper")


def _long(
    mask: BoolArray, start: Cell, end: Cell, seed: int, *, restarts: int = 8, sweeps: int = 300
) -> PlanarPath:
    flat, first, last = _flat(mask, start, end)
    rng = np.random.default_rng(seed)
    path, _, limit = long_path(flat, first, last, NO_WISHES, restarts, sweeps, rng)
    optimal = len(path) == limit
    reason = OPTIMAL if optimal else SEARCHED
    return PlanarPath(_cells(path, flat.width), int(limit), optimal, reason, "long")


def _exact(
    mask: BoolArray, start: Cell, end: Cell, seed: int, *, limit: float = 60.0
) -> PlanarPath:
    flat, first, last = _flat(mask, start, end)
    path, bound = exact_path(flat, first, last, limit, seed)
    optimal = len(path) == bound
    reason = OPTIMAL if optimal else OUT_OF_TIME
    return PlanarPath(_cells(path, flat.width), bound, optimal, reason, "exact")


def _flat(mask: BoolArray, start: Cell, end: Cell) -> tuple[Region, int, int]:
    """A connected region with a margin and weights 1, and its ends, numbered as in `Region`."""
    inside = np.pad(mask, 1)
    width = inside.shape[1]
    first, last = ((int(x) + 1) * width + int(y) + 1 for x, y in (start, end))
    return region(inside.ravel(), np.ones(inside.size), width), first, last


def _cells(path: IntArray, width: int) -> IntArray:
    """Positions (x, y) of flat cells."""
    return np.stack(np.divmod(path, width), axis=1) - np.int32(1)


PLANAR_METHODS: dict[str, Callable[..., PlanarPath]] = {
    "paper": _paper,
    "long": _long,
    "exact": _exact,
}
"""The planar methods by name: functions of a connected region, ends, a seed and options."""
