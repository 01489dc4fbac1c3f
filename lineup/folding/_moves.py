"""Certified changes that lengthen a fold: insert, flip, reroute; and the search over them.

The voxels of the solid that the path leaves out are its holes.
"""

import heapq
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from .._jit import kernel
from ..grid import BoolArray, IntArray
from ..motion._chain import Grid, link
from ..motion._slots import plan_keeps_slots
from ._fold import BACK, NEXT, RANK, Fold, commit, load, n_joints, path_of, root_of, states_of, undo
from ._piece import replace

NEAR = 64  # holes looked at around a rerouted piece
FLIPS_PER_HOLE = 24
FILLING = 100  # tries of filling between commits
LONGEST = 5  # a rerouted piece has up to 2 + 2^LONGEST cells


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
def fill(fold: Fold, tries: int, target: int, rng: Generator) -> None:
    """Climb over all holes."""
    holes = no_holes(len(fold.free), len(fold.cells))
    for cell in np.flatnonzero(fold.free):
        add_hole(holes, int(cell))
    for _ in range(0, tries, FILLING):
        climb(fold, holes, FILLING, target, rng)
        commit(fold)


@kernel
def climb(fold: Fold, holes: Holes, tries: int, target: int, rng: Generator) -> None:
    """Insert pairs of holes and flip corners until tries, holes or length run out."""
    for _ in range(tries):
        if holes.size[0] == 0 or n_joints(fold) + 2 > target:
            return
        hole = holes.cell[rng.integers(0, holes.size[0])]
        if rng.random() < 0.6:
            _insert_pair(fold, holes, hole, rng)
        else:
            _flip_corner(fold, holes, hole, rng)


@kernel
def _insert_pair(fold: Fold, holes: Holes, hole: int, rng: Generator) -> bool:
    """Lead a bar that runs beside two adjacent holes through them."""
    offset, notes = fold.grid.offset, fold.notes
    d = rng.integers(0, 6)
    mate = hole + offset[d]
    if not fold.free[mate]:
        return False
    side = rng.integers(0, 6)
    for turn in range(6):
        f = (side + turn) % 6
        u, v = hole + offset[f], mate + offset[f]
        if f % 3 == d % 3 or notes[RANK, u] < 0 or notes[RANK, v] < 0:
            continue
        if notes[NEXT, u] == v:
            done = replace(fold, u, v, np.array([hole, mate], np.int32))
        elif notes[NEXT, v] == u:
            done = replace(fold, v, u, np.array([mate, hole], np.int32))
        else:
            continue
        if done:
            drop_hole(holes, hole)
            drop_hole(holes, mate)
            return True
    return False


@kernel
def _flip_corner(fold: Fold, holes: Holes, hole: int, rng: Generator) -> bool:
    """Move a corner of the path across its unit square into the hole opposite."""
    grid, notes, root = fold.grid, fold.notes, root_of(fold)
    beside = hole + grid.offset[rng.integers(0, 6)]
    onward = NEXT if rng.random() < 0.5 else BACK
    if notes[RANK, beside] < 0:
        return False
    corner = notes[onward, beside]
    if corner == root or notes[onward, corner] == root:
        return False
    far = notes[onward, corner]
    if not _adjacent(grid, far, hole):
        return False
    if fold.weight[corner] > fold.weight[hole] and rng.random() < 0.7:
        return False
    u, v = (beside, far) if onward == NEXT else (far, beside)
    if not replace(fold, u, v, np.array([hole], np.int32)):
        return False
    drop_hole(holes, hole)
    add_hole(holes, corner)
    return True


@kernel
def _adjacent(grid: Grid, cell: int, other: int) -> bool:
    return bool((grid.offset == other - cell).any())


@kernel
def contract_all(
    fold: Fold,
    keep: BoolArray,
    length: int,
    longest: int,
    in_layer: bool,
    slotted: bool = False,
) -> None:
    """Contract pairs of index up to `longest` down to `length`, none with a voxel to `keep`.

    The joints between two may go where the two are adjacent and a plan remains, if asked for one
    for `slotted` joints, and if asked for where all of them lie in one layer.
    """
    changed = True
    while changed and n_joints(fold) > length:
        changed = False
        joint = fold.notes[NEXT, root_of(fold)]
        while joint != root_of(fold) and n_joints(fold) > length:
            index = min(longest, n_joints(fold) - length)
            changed |= _contract_from(fold, keep, joint, index, in_layer, slotted)
            commit(fold)
            joint = fold.notes[NEXT, joint]


@kernel
def _contract_from(
    fold: Fold, keep: BoolArray, u: int, longest: int, in_layer: bool, slotted: bool
) -> bool:
    """Contract the pair of least index that begins at joint u, if there is one."""
    xyz, onward, root = fold.grid.xyz, fold.notes[NEXT], root_of(fold)
    v = onward[u]
    for _ in range(0, longest, 2):
        for _ in range(2):
            if v == root or keep[v] or (in_layer and xyz[v, 2] != xyz[u, 2]):
                return False
            v = onward[v]
        if v == root or (in_layer and xyz[v, 2] != xyz[u, 2]):
            return False
        if _adjacent(fold.grid, u, v) and replace(fold, u, v, np.empty(0, np.int32)):
            if not slotted or _keeps_slots(fold):
                return True
            undo(fold)
    return False


@kernel
def _keeps_slots(fold: Fold) -> bool:
    return plan_keeps_slots(fold.grid, link(fold.grid, path_of(fold)), states_of(fold))


@kernel
def anneal(fold: Fold, rounds: int, hot: float, cold: float, target: int, rng: Generator) -> None:
    """Reroute random pieces near holes, climb around them, keep what a cooling random test lets.

    The fold ends as the best met. Worth falls within `hot` at first and `cold` at last.
    """
    near = no_holes(len(fold.free), NEAR)
    commit(fold)
    best, best_path, best_states = -1.0, path_of(fold), states_of(fold)
    for k in range(rounds):
        if n_joints(fold) >= target:
            break
        before = fold.worth[0]
        if not _reroute(fold, near, rng):
            continue
        climb(fold, near, FLIPS_PER_HOLE * near.size[0], target, rng)
        loss = before - fold.worth[0]
        if loss > 0:
            heat = hot + (cold - hot) * k / rounds
            if before > best or rng.random() >= np.exp(-loss / heat):
                undo(fold)
            if before > best:
                best, best_path, best_states = before, path_of(fold), states_of(fold)
        commit(fold)
    if fold.worth[0] < best:
        load(fold, best_path, best_states)


@kernel
def _reroute(fold: Fold, near: Holes, rng: Generator) -> bool:
    """Cut a random piece near a random hole and join its ends another way; note the holes there.

    A piece that reaches to a tip of the path gives way to one that ends elsewhere.
    """
    hole = _random_hole(fold, rng)
    joint = _joint_near(fold, hole, rng) if hole >= 0 else -1
    if joint < 0:
        return False
    root, notes = root_of(fold), fold.notes
    length = 2 + rng.integers(0, 1 << rng.integers(1, LONGEST + 1))
    u = notes[BACK, joint]
    for _ in range(rng.integers(0, length)):
        if u == root:
            break
        u = notes[BACK, u]
    old, n_old, v = np.empty(length, np.int32), 0, notes[NEXT, u]
    while n_old < length and v != root:
        old[n_old] = v
        n_old += 1
        v = notes[NEXT, v]
    old = old[:n_old]
    if u == root and v == root:
        return False
    fold.free[old] = True
    new = _new_piece(fold, u, v, n_old, hole, rng)
    fold.free[old] = False
    if new[0] < 0 or not replace(fold, u, v, new[1:]):
        return False
    clear_holes(near)
    for cell in old:
        _note_holes(fold, near, int(cell))
    _note_holes(fold, near, hole)
    return True


@kernel
def _new_piece(fold: Fold, u: int, v: int, n_old: int, hole: int, rng: Generator) -> IntArray:
    """Free cells to lie between joints u and v in place of `n_old`, behind a 1; -1 for none.

    Where u or v is the root they run from the other to a hole, or one short of it.
    """
    root = root_of(fold)
    if u != root and v != root:
        fold.free[u] = fold.free[v] = True
        way = _random_way(fold, u, v, hole if rng.random() < 0.5 else -1, rng)
        fold.free[u] = fold.free[v] = False
        if len(way) == 0:
            return np.array([-1], np.int32)
        way[0] = 1
        return way[:-1]
    joint = v if u == root else u
    fold.free[joint] = True
    way = random_shortest(fold.grid, fold.free, joint, hole, 3.0, rng)
    fold.free[joint] = False
    if len(way) == 0:
        return np.array([-1], np.int32)
    if (len(way) - 1 - n_old) % 2:
        way = way[:-1]
    if u == root:
        way[1:] = way[1:][::-1].copy()
    way[0] = 1
    return way


@kernel
def _random_hole(fold: Fold, rng: Generator) -> int:
    """A hole, each as likely as any other; -1 if there seems to be none."""
    for _ in range(len(fold.cells)):
        cell = fold.cells[rng.integers(0, len(fold.cells))]
        if fold.free[cell]:
            return cell
    return -1


@kernel
def _joint_near(fold: Fold, hole: int, rng: Generator) -> int:
    """A joint met by a random walk through the holes from `hole`, -1 if none was met."""
    cell = hole
    for _ in range(100):
        step = cell + fold.grid.offset[rng.integers(0, 6)]
        if fold.notes[RANK, step] >= 0:
            return step
        if fold.free[step]:
            cell = step
    return -1


@kernel
def _note_holes(fold: Fold, near: Holes, cell: int) -> None:
    if fold.free[cell]:
        add_hole(near, cell)
    for d in range(6):
        if fold.free[cell + fold.grid.offset[d]]:
            add_hole(near, cell + fold.grid.offset[d])


@kernel
def _random_way(fold: Fold, start: int, goal: int, via: int, rng: Generator) -> IntArray:
    """Free cells from start to goal, through `via` unless it is -1; empty if there is no way."""
    grid, free = fold.grid, fold.free
    spread = 3.0 * rng.random() ** 2
    if via < 0:
        return random_shortest(grid, free, start, goal, spread, rng)
    free[goal] = False
    first = random_shortest(grid, free, start, via, spread, rng)
    free[goal] = True
    if len(first) == 0:
        return first
    free[first[:-1]] = False
    second = random_shortest(grid, free, via, goal, spread, rng)
    free[first[:-1]] = True
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
