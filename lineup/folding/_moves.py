"""Certified changes that lengthen a fold: insert, flip, reroute; and the search over them.

The voxels of the solid that the path leaves out are its holes.
"""

import heapq
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from .._jit import kernel
from ..grid import BoolArray, FloatArray, IntArray
from ..motion._chain import Grid
from ._fold import Fold, load, replace

NEAR = 64  # holes looked at around a rerouted piece
FLIPS_PER_HOLE = 24


class Body(NamedTuple):
    """The solid to fill, cell by cell."""

    solid: BoolArray  # (C,)
    weight: FloatArray  # (C,) worth of a voxel on the path


class Holes(NamedTuple):
    """A list of hole cells that finds and forgets a cell in constant time."""

    cell: IntArray  # (cap,)
    place: IntArray  # (C,) where in the list a cell is, -1 if it is not
    size: IntArray  # (1,)


@kernel
def no_holes(n_cells: int, capacity: int) -> Holes:
    """An empty list."""
    return Holes(
        np.empty(capacity, np.int32), np.full(n_cells, -1, np.int32), np.zeros(1, np.int32)
    )


@kernel
def add_hole(holes: Holes, cell: int) -> None:
    """Add `cell` if it is not listed and there is room."""
    if holes.place[cell] < 0 and holes.size[0] < len(holes.cell):
        holes.place[cell] = holes.size[0]
        holes.cell[holes.size[0]] = cell
        holes.size[0] += 1


@kernel
def drop_hole(holes: Holes, cell: int) -> None:
    """Take `cell` off the list if it is on it."""
    place = holes.place[cell]
    if place >= 0:
        holes.size[0] -= 1
        moved = holes.cell[holes.size[0]]
        holes.cell[place] = moved
        holes.place[moved] = place
        holes.place[cell] = -1


@kernel
def clear_holes(holes: Holes) -> None:
    """Forget all."""
    for k in range(holes.size[0]):
        holes.place[holes.cell[k]] = -1
    holes.size[0] = 0


@kernel
def all_holes(body: Body, fold: Fold) -> Holes:
    """Every hole of a fold."""
    holes = no_holes(len(body.solid), len(body.solid))
    for cell in np.flatnonzero(body.solid):
        if fold.joint[cell] < 0:
            add_hole(holes, int(cell))
    return holes


@kernel
def is_hole(body: Body, fold: Fold, cell: int) -> bool:
    """Whether `cell` is in the solid and not on the path."""
    return body.solid[cell] and fold.joint[cell] < 0


@kernel
def fill(grid: Grid, body: Body, fold: Fold, tries: int, target: int, rng: Generator) -> None:
    """Climb over all holes."""
    climb(grid, body, fold, all_holes(body, fold), tries, target, rng)


@kernel
def climb(
    grid: Grid, body: Body, fold: Fold, holes: Holes, tries: int, target: int, rng: Generator
) -> None:
    """Insert pairs of holes and flip corners until tries, holes or length run out."""
    for _ in range(tries):
        if holes.size[0] == 0 or fold.size[0] + 2 > target:
            return
        hole = holes.cell[rng.integers(0, holes.size[0])]
        if rng.random() < 0.6:
            _insert_pair(grid, body, fold, holes, hole, rng)
        else:
            _flip_corner(grid, body, fold, holes, hole, rng)


@kernel
def _insert_pair(
    grid: Grid, body: Body, fold: Fold, holes: Holes, hole: int, rng: Generator
) -> bool:
    """Lead a bar that runs beside two adjacent holes through them."""
    d = rng.integers(0, 6)
    mate = hole + grid.offset[d]
    if not is_hole(body, fold, mate):
        return False
    side = rng.integers(0, 6)
    for turn in range(6):
        f = (side + turn) % 6
        if f % 3 == d % 3:
            continue
        i, j = fold.joint[hole + grid.offset[f]], fold.joint[mate + grid.offset[f]]
        if i < 0 or j < 0 or abs(i - j) != 1:
            continue
        new = np.array([hole, mate] if i < j else [mate, hole], np.int32)
        if replace(grid, fold, min(i, j), max(i, j), new):
            drop_hole(holes, hole)
            drop_hole(holes, mate)
            return True
    return False


@kernel
def _flip_corner(
    grid: Grid, body: Body, fold: Fold, holes: Holes, hole: int, rng: Generator
) -> bool:
    """Move a corner of the path across its unit square into the hole opposite."""
    beside = fold.joint[hole + grid.offset[rng.integers(0, 6)]]
    i = beside - 2 * rng.integers(0, 2)
    if beside < 0 or i < 0 or i + 2 >= fold.size[0]:
        return False
    before, corner, after = fold.path[i], fold.path[i + 1], fold.path[i + 2]
    if not (_adjacent(grid, before, hole) and _adjacent(grid, after, hole)):
        return False
    if body.weight[corner] > body.weight[hole] and rng.random() < 0.7:
        return False
    if not replace(grid, fold, i, i + 2, np.array([hole], np.int32)):
        return False
    drop_hole(holes, hole)
    add_hole(holes, corner)
    return True


@kernel
def _adjacent(grid: Grid, cell: int, other: int) -> bool:
    return bool((grid.offset == other - cell).any())


@kernel
def contract_all(
    grid: Grid, fold: Fold, keep: BoolArray, length: int, longest: int, in_layer: bool
) -> None:
    """Contract pairs of index up to `longest` down to `length`, none with a voxel to `keep`.

    The joints between i and j may go where i and j are adjacent and a plan remains, and if asked
    for, where i to j lie in one layer.
    """
    changed = True
    while changed and fold.size[0] > length:
        changed = False
        i = 0
        while i + 3 < fold.size[0] and fold.size[0] > length:
            index = min(longest, fold.size[0] - length)
            changed |= _contract_from(grid, fold, keep, i, index, in_layer)
            i += 1


@kernel
def _contract_from(
    grid: Grid, fold: Fold, keep: BoolArray, i: int, longest: int, in_layer: bool
) -> bool:
    """Contract the pair of least index that begins at joint i, if there is one."""
    z = grid.xyz[fold.path[i], 2]
    for j in range(i + 3, min(i + 2 + longest, fold.size[0]), 2):
        for cell in fold.path[j - 2 : j]:
            if keep[cell] or (in_layer and grid.xyz[cell, 2] != z):
                return False
        if in_layer and grid.xyz[fold.path[j], 2] != z:
            return False
        adjacent = _adjacent(grid, fold.path[i], fold.path[j])
        if adjacent and replace(grid, fold, i, j, np.empty(0, np.int32)):
            return True
    return False


@kernel
def worth(body: Body, fold: Fold) -> float:
    """Sum of the weights on the path."""
    return body.weight[fold.path[: fold.size[0]]].sum()


@kernel
def anneal(
    grid: Grid,
    body: Body,
    fold: Fold,
    rounds: int,
    hot: float,
    cold: float,
    target: int,
    rng: Generator,
) -> None:
    """Reroute random pieces near holes, climb around them, keep what a cooling random test lets.

    The fold ends as the best met. Worth falls within `hot` at first and `cold` at last.
    """
    near = no_holes(len(body.solid), NEAR)
    current = worth(body, fold)
    best, best_path, best_states = current, _path(fold), _states(fold)
    for k in range(rounds):
        if fold.size[0] >= target:
            break
        path, states = _path(fold), _states(fold)
        if not _reroute(grid, body, fold, near, rng):
            continue
        climb(grid, body, fold, near, FLIPS_PER_HOLE * near.size[0], target, rng)
        found = worth(body, fold)
        heat = hot + (cold - hot) * k / rounds
        if found >= current or rng.random() < np.exp((found - current) / heat):
            current = found
            if found > best:
                best, best_path, best_states = found, _path(fold), _states(fold)
        else:
            load(fold, path, states)
    if current < best:
        load(fold, best_path, best_states)


@kernel
def _path(fold: Fold) -> IntArray:
    return fold.path[: fold.size[0]].copy()


@kernel
def _states(fold: Fold) -> IntArray:
    return fold.states[: fold.size[1]].copy()


@kernel
def _reroute(grid: Grid, body: Body, fold: Fold, near: Holes, rng: Generator) -> bool:
    """Cut a random piece near a random hole and join its ends another way; note the holes there."""
    n = fold.size[0]
    free = body.solid & (fold.joint < 0)
    holes = np.flatnonzero(free)
    if n < 8 or len(holes) == 0:
        return False
    hole = holes[rng.integers(0, len(holes))]
    joint = _joint_near(grid, fold, free, hole, rng)
    if joint < 0:
        return False
    length = min(n - 2, 2 + rng.integers(0, 1 << rng.integers(1, 6)))
    i = min(max(joint - rng.integers(0, length + 1), 0), n - length - 1)
    old = fold.path[i : i + length + 1].copy()
    free[old] = True
    new = _random_way(grid, free, old[0], old[-1], hole if rng.random() < 0.5 else -1, rng)
    if len(new) == 0 or not replace(grid, fold, i, i + length, new[1:-1]):
        return False
    clear_holes(near)
    for cell in old:
        _note_holes(grid, body, fold, near, cell)
    _note_holes(grid, body, fold, near, hole)
    return True


@kernel
def _note_holes(grid: Grid, body: Body, fold: Fold, near: Holes, cell: int) -> None:
    if is_hole(body, fold, cell):
        add_hole(near, cell)
    for d in range(6):
        if is_hole(body, fold, cell + grid.offset[d]):
            add_hole(near, cell + grid.offset[d])


@kernel
def _joint_near(grid: Grid, fold: Fold, free: BoolArray, hole: int, rng: Generator) -> int:
    """A joint met by a random walk through the holes from `hole`, -1 if none was met."""
    cell = hole
    for _ in range(100):
        step = cell + grid.offset[rng.integers(0, 6)]
        if fold.joint[step] >= 0:
            return fold.joint[step]
        if free[step]:
            cell = step
    return -1


@kernel
def _random_way(
    grid: Grid, free: BoolArray, start: int, goal: int, via: int, rng: Generator
) -> IntArray:
    """Free cells from start to goal, through `via` unless it is -1; empty if there is no way."""
    spread = 3.0 * rng.random() ** 2
    if via < 0:
        return random_shortest(grid, free, start, goal, spread, rng)
    open_now = free.copy()
    open_now[goal] = False
    first = random_shortest(grid, open_now, start, via, spread, rng)
    if len(first) == 0:
        return first
    open_now[first[:-1]] = False
    open_now[goal] = True
    second = random_shortest(grid, open_now, via, goal, spread, rng)
    if len(second) == 0:
        return second
    return np.concatenate((first, second[1:]))


@kernel
def random_shortest(
    grid: Grid, free: BoolArray, start: int, goal: int, spread: float, rng: Generator
) -> IntArray:
    """Dijkstra's way through free cells, each step costing 1 to 1 + spread at random.

    Empty if there is no way.
    """
    came = {np.int64(start): np.int64(-1)}
    came.clear()
    queue = [(0.0, np.int64(start), np.int64(-1))]
    while len(queue) > 0 and goal not in came:
        cost, cell, parent = heapq.heappop(queue)
        if cell in came:
            continue
        came[cell] = parent
        for d in range(6):
            step = cell + np.int64(grid.offset[d])
            if free[step] and step not in came:
                heapq.heappush(queue, (cost + 1.0 + spread * rng.random(), step, cell))
    if goal not in came:
        return np.zeros(0, np.int32)
    way = [np.int32(goal)]
    while came[np.int64(way[-1])] >= 0:
        way.append(np.int32(came[np.int64(way[-1])]))
    return np.array(way[::-1], np.int32)
