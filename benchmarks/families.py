"""Random polycubes of several families, each of about the voxels asked for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from heapq import heappop, heappush

import numpy as np
from numpy.random import Generator
from scipy import ndimage

import lineup as lu
from lineup import grid

Cell = tuple[int, int, int]
Cells = Iterator[Cell]
"""Cells without end, repeats among them; each but the first shares a face with one before it."""

ORIGIN: Cell = (0, 0, 0)
STEPS = [tuple(step) for step in grid.DIRECTIONS.tolist()]


def polycube(family: str, voxels: int, rng: Generator) -> lu.VoxelSolid:
    """The first `voxels` cells of a family, laid down at random; the voids between are filled."""
    cells: dict[Cell, None] = {}
    for cell in FAMILIES[family](rng):
        cells[cell] = None
        if len(cells) == voxels:
            break
    points = np.array(list(cells))
    points = points[:, rng.permutation(3)] * rng.choice((-1, 1), 3)
    points -= points.min(axis=0)
    occupancy = np.zeros(points.max(axis=0) + 1, bool)
    occupancy[tuple(points.T)] = True
    return lu.VoxelSolid(lu.mend(occupancy).occupancy, name=family)


def beside(cell: Cell, step: Cell) -> Cell:
    return cell[0] + step[0], cell[1] + step[1], cell[2] + step[2]


def grown(rng: Generator, steps: list[Cell], most_touched: int) -> Cells:
    """Cells put in random places beside random ones, if they touch so many of them at most."""
    cells = [ORIGIN]
    taken = {ORIGIN}
    yield ORIGIN
    while True:
        new = beside(cells[rng.integers(len(cells))], steps[rng.integers(len(steps))])
        touched = sum(beside(new, step) in taken for step in STEPS)
        if new not in taken and touched <= most_touched:
            taken.add(new)
            cells.append(new)
            yield new


def blob(rng: Generator) -> Cells:
    return grown(rng, STEPS, 6)


def tree(rng: Generator) -> Cells:
    return grown(rng, STEPS, 1)


def plate(rng: Generator) -> Cells:
    """One or two voxels thick, of any outline."""
    thick = int(rng.integers(1, 3))
    for x, y, _ in grown(rng, [step for step in STEPS if not step[2]], 6):
        yield from ((x, y, z) for z in range(thick))


def branching(rng: Generator) -> Cells:
    """Straight arms from random cells of those before."""
    cells = [ORIGIN]
    yield ORIGIN
    while True:
        cell, step = cells[rng.integers(len(cells))], STEPS[rng.integers(6)]
        for _ in range(rng.integers(2, 12)):
            cell = beside(cell, step)
            cells.append(cell)
            yield cell


def ringed(rng: Generator) -> Cells:
    """Handles: rectangles of rods, each from a random cell of those before."""
    cells = [ORIGIN]
    yield ORIGIN
    while True:
        cell = cells[rng.integers(len(cells))]
        there, across = (STEPS[axis + 3 * rng.integers(2)] for axis in rng.permutation(3)[:2])
        back, home = (STEPS[(STEPS.index(step) + 3) % 6] for step in (there, across))
        sides = rng.integers(2, 6, 2)
        for step, n in zip((there, across, back, home), (*sides, *sides), strict=True):
            for _ in range(n):
                cell = beside(cell, step)
                cells.append(cell)
                yield cell


def comb(rng: Generator) -> Cells:
    """A spine with teeth at even distances to one side or more."""
    gap, length, width = (int(rng.integers(*span)) for span in ((1, 4), (1, 12), (1, 3)))
    ways = rng.permutation([1, 2, 4, 5])[: rng.integers(1, 5)]
    x = 0
    while True:
        yield from ((x, y, 0) for y in range(width))
        for way in ways if x % (gap + 1) == 0 else ():
            cell = (x, 0, 0)
            for _ in range(length):
                cell = beside(cell, STEPS[way])
                yield cell
        x += 1


def noise(rng: Generator) -> Cells:
    """The highest voxels of smooth noise, from a peak downhill."""
    side = 24
    field = ndimage.gaussian_filter(rng.random((side,) * 3), rng.uniform(0.7, 2.5))
    peak = tuple(int(x) for x in np.unravel_index(field.argmax(), field.shape))
    queue, met = [(0.0, peak)], {peak}
    while queue:
        cell = heappop(queue)[1]
        yield cell
        for new in (beside(cell, step) for step in STEPS):
            if new not in met and min(new) >= 0 and max(new) < side:
                met.add(new)
                heappush(queue, (-float(field[new]), new))


FAMILIES: dict[str, Callable[[Generator], Cells]] = {
    "blob": blob,
    "tree": tree,
    "branching": branching,
    "ringed": ringed,
    "comb": comb,
    "plate": plate,
    "noise": noise,
}
