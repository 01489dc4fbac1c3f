"""The paper's long planar path, as written (Section 4.1, Algorithm 2, Figures 5 to 7).

Boundary cycle by marching, interior path by Zhang and Liu, merged into one. Each assumption that
a region breaks is named by a reason code. Where no path can come of it the path is empty; where
only the interior has no cycle of Zhang and Liu, a shortest path with all detours that EXTEND
finds takes the place of theirs.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy import ndimage

from .._record import record
from ..grid import BoolArray, IntArray
from .faces import (
    Cell,
    beside,
    cell_set,
    check_ends,
    connected_cells,
    is_cycle,
    outer_walk,
    part_of,
)
from .zhang_liu import REASONS as INTERIOR_REASONS
from .zhang_liu import interior_path

DANGLING_ATE_REGION = "dangling-ate-region"
BOUNDARY_NOT_A_CYCLE = "boundary-not-a-cycle"
NO_INTERIOR = "no-interior"
INTERIOR_DISCONNECTED = "interior-disconnected"
END_NOT_INTERIOR = "end-not-interior"
ENDS_APART = "ends-apart"
NO_MERGE = "no-merge"

REASONS: dict[str, str] = {
    DANGLING_ATE_REGION: "removing dangling voxels leaves nothing",
    BOUNDARY_NOT_A_CYCLE: "the walk round the boundary meets a voxel twice",
    NO_INTERIOR: "every voxel is a boundary voxel",
    INTERIOR_DISCONNECTED: "the interior falls into several parts",
    END_NOT_INTERIOR: "a given end is not an interior voxel",
    ENDS_APART: "the given ends lie in different parts of the interior",
    NO_MERGE: "no link of the interior path runs beside a link of the boundary cycle",
    **INTERIOR_REASONS,
}
"""What each reason code says: the assumption of Section 4 that does not hold."""


@record
class PaperPath:
    """A long planar path of Algorithm 2, with its steps (Figure 7).

    Attributes
    ----------
    cells : (P, 2) int32
        The path p(o), (x, y) from start to end; empty if there is none.
    boundary : (B, 2) int32
        The cycle C_bdy in order; empty if the boundary is not a cycle.
    interior : (I, 2) int32
        The path p_inter in order, from start to end; empty if there is none.
    cycle : (C, 2) int32
        Zhang and Liu's cycle in the interior, which has no ends; what the given ends cost is
        ``len(cycle) - len(interior)``. Empty if the interior breaks its hypotheses.
    removed : (D, 2) int32
        Dangling voxels, in the order of their removal.
    reasons : tuple of str
        Keys of `REASONS`, one for each assumption that fails; none if all hold.
    """

    cells: IntArray
    boundary: IntArray
    interior: IntArray
    cycle: IntArray
    removed: IntArray
    reasons: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.cells)


def paper_path(mask: BoolArray, start: Cell, end: Cell, seed: int = 0) -> PaperPath:
    """The long planar path of Algorithm 2 between two interior voxels of a region.

    Boundary voxels are those of the outermost boundary (the paper's footnote 2 on holes). The
    paper does not say where to merge cycle and path: a random one of the places is taken.

    Parameters
    ----------
    mask : (X, Y) bool
        A 4-connected region.
    start, end : (x, y)
        Two different cells of it.

    Raises
    ------
    ValueError
        If the mask or an end is not as said.

    Examples
    --------
    >>> import numpy as np
    >>> from lineup.planar import paper_path
    >>> path = paper_path(np.ones((4, 5), bool), (1, 1), (1, 2))
    >>> len(path), len(path.boundary), len(path.interior), path.reasons
    (20, 14, 6, ())
    """
    cells, removed = without_dangling(connected_cells(mask), mask)
    check_ends(mask, start, end)
    if not cells:
        return _failed(removed, DANGLING_ATE_REGION)
    boundary = outer_walk(cells)
    if not is_cycle(boundary):
        return _failed(removed, BOUNDARY_NOT_A_CYCLE)
    inner = cells - set(boundary)
    if not inner:
        return _failed(removed, NO_INTERIOR, boundary=boundary)
    home = start if start in inner else end if end in inner else min(inner)
    part = part_of(inner, home)
    reasons = [INTERIOR_DISCONNECTED] if part != inner else []
    if not {start, end} <= inner:
        return _failed(removed, *reasons, END_NOT_INTERIOR, boundary=boundary)
    if end not in part:
        return _failed(removed, *reasons, ENDS_APART, boundary=boundary)
    interior, cycle, found = interior_path(part, start, end)
    reasons += found
    cells_of_path = _merged(boundary, interior, np.random.default_rng(seed))
    if interior and not cells_of_path:
        reasons.append(NO_MERGE)
    return PaperPath(
        _array(cells_of_path),
        _array(boundary),
        _array(interior),
        _array(cycle),
        _array(removed),
        tuple(reasons),
    )


def without_dangling(cells: set[Cell], mask: BoolArray) -> tuple[set[Cell], list[Cell]]:
    """The cells that stay when dangling voxels go, over and over, and those that go.

    Both neighbours of a voxel on the walk round the boundary are boundary voxels. So a dangling
    one is where that walk turns back: it has one neighbour at most in the whole region. A spur
    into a hole has no part in the outermost boundary and stays.
    """
    cells, removed = set(cells), []
    holes = cell_set(ndimage.binary_fill_holes(mask, structure=np.ones((3, 3), bool)) & ~mask)
    todo = sorted(cells)
    while todo:
        dangling = []
        for cell in todo:
            missing = [other for other in beside(cell) if other not in cells]
            if len(missing) >= 3 and not holes.issuperset(missing):
                dangling.append(cell)
        cells -= set(dangling)
        removed += dangling
        todo = sorted({other for cell in dangling for other in beside(cell)} & cells)
    return cells, removed


def _merged(cycle: list[Cell], path: list[Cell], rng: np.random.Generator) -> list[Cell]:
    """Cycle and path joined where two links run side by side (Figure 6); empty if none do."""
    place = {cell: k for k, cell in enumerate(cycle)}
    n = len(cycle)
    places = []
    for k, (a, b) in enumerate(pairwise(path)):
        for dx, dy in ((a[1] - b[1], b[0] - a[0]), (b[1] - a[1], a[0] - b[0])):
            i, j = place.get((a[0] + dx, a[1] + dy)), place.get((b[0] + dx, b[1] + dy))
            if i is not None and j is not None and (i - j) % n in (1, n - 1):
                places.append((k, i, j))
    if not places:
        return []
    k, i, j = places[int(rng.integers(len(places)))]
    # All round the cycle from i to j, away from the link that is taken out.
    step = 1 if (i - j) % n == 1 else -1
    return [*path[: k + 1], *(cycle[(i + step * m) % n] for m in range(n)), *path[k + 1 :]]


def _failed(removed: list[Cell], *reasons: str, boundary: list[Cell] | None = None) -> PaperPath:
    nothing = _array([])
    return PaperPath(nothing, _array(boundary or []), nothing, nothing, _array(removed), reasons)


def _array(cells: list[Cell]) -> IntArray:
    return np.array(cells, np.int32).reshape(-1, 2)
