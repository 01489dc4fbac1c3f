"""The faces of a planar region that are not unit squares: its outside and its holes.

Cells are the nodes of a planar graph with an edge between 4-neighbours. Its faces are the unit
squares of four cells, and others: one outer face and the holes. A cell touches a face of the
second kind exactly if one of its 8-neighbours is missing, so walking round those faces meets
exactly the paper's boundary voxels (Section 4.1).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..grid import BoolArray

Cell = tuple[int, int]

STEPS = ((1, 0), (0, 1), (-1, 0), (0, -1))
"""The four directions, each a quarter turn to the left of the one before."""


def cell_set(mask: BoolArray) -> set[Cell]:
    """The cells (x, y) of a mask."""
    return {(int(x), int(y)) for x, y in np.argwhere(mask)}


def connected_cells(mask: BoolArray) -> set[Cell]:
    """The cells (x, y) of a mask, which must be one 4-connected region."""
    check_mask(mask)
    cells = cell_set(mask)
    if not cells or part_of(cells, min(cells)) != cells:
        raise ValueError(
            f"mask must be one 4-connected region, got {len(cells)} cells that are not"
        )
    return cells


def check_mask(mask: BoolArray) -> None:
    """Raise a ValueError if a mask is not (X, Y) bool."""
    if not isinstance(mask, np.ndarray):
        raise ValueError(f"mask must be an (X, Y) bool array, got {type(mask).__name__}")
    if mask.ndim != 2 or mask.dtype != bool:
        raise ValueError(f"mask must be (X, Y) bool, got {mask.dtype} of shape {mask.shape}")


def check_ends(mask: BoolArray, start: Cell, end: Cell) -> None:
    """Raise a ValueError if the ends are not two different cells of a mask."""
    for name, cell in (("start", start), ("end", end)):
        in_grid = len(cell) == 2 and all(0 <= c < n for c, n in zip(cell, mask.shape, strict=True))
        if not in_grid or not mask[tuple(cell)]:
            raise ValueError(f"{name} must be a cell (x, y) of the region, got {tuple(cell)}")
    if tuple(start) == tuple(end):
        raise ValueError(f"start and end must differ, both are {tuple(start)}")


def part_of(cells: set[Cell], first: Cell) -> set[Cell]:
    """The 4-connected part of `cells` around one of them."""
    part, todo = {first}, [first]
    while todo:
        ahead = [c for c in beside(todo.pop()) if c in cells and c not in part]
        part.update(ahead)
        todo += ahead
    return part


def beside(cell: Cell) -> Iterator[Cell]:
    """The four cells that share a side with `cell`, inside or not."""
    x, y = cell
    return ((x + dx, y + dy) for dx, dy in STEPS)


def outer_walk(cells: set[Cell]) -> list[Cell]:
    """The closed walk round the outer face of a connected region, by linear marching.

    A cell at which the region is one cell wide comes more than once. The outside is on the right
    of the walk, so it turns right whenever it can.
    """
    return _walk(cells, min(cells), 0)


def face_walks(cells: set[Cell]) -> list[list[Cell]]:
    """The closed walks round all faces but unit squares, the outer face first."""
    outer = outer_walk(cells)
    walks, met = [outer], set(_sides(outer))
    for cell in sorted(cells):
        for direction in range(4):
            ahead = _moved(cell, direction)
            if (cell, ahead) in met or ahead not in cells:
                continue
            right = (direction - 1) % 4
            if not {_moved(cell, right), _moved(ahead, right)} <= cells:
                walks.append(_walk(cells, cell, direction))
                met.update(_sides(walks[-1]))
    return walks


def is_cycle(walk: list[Cell]) -> bool:
    """Whether a closed walk meets no cell twice, and has four cells at least."""
    return len(walk) >= 4 and len(set(walk)) == len(walk)


def _sides(walk: list[Cell]) -> Iterator[tuple[Cell, Cell]]:
    return zip(walk, [*walk[1:], walk[0]], strict=True)


def _moved(cell: Cell, direction: int) -> Cell:
    dx, dy = STEPS[direction % 4]
    return cell[0] + dx, cell[1] + dy


def _walk(cells: set[Cell], first: Cell, heading: int) -> list[Cell]:
    """Cells of the face on the right of `first`, which is left as if reached in `heading`."""
    heading = next((heading + t for t in (0, 1, 2, 3) if _moved(first, heading + t) in cells), -1)
    if heading < 0:
        return [first]
    start = heading = heading % 4
    cell, walk = first, []
    while True:
        walk.append(cell)
        cell = _moved(cell, heading)
        turns = (heading - 1, heading, heading + 1, heading + 2)
        heading = next(t % 4 for t in turns if _moved(cell, t) in cells)
        if (cell, heading) == (first, start):
            return walk
