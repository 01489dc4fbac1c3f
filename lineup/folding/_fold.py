"""A path and its peel plan in linked lists, so that a change costs no more than what it changes.

The plan is a list of *events* in order of time: an end of the chain starts (it takes its first rod
while it still is at the end of the path), arrives at a joint by a peel, or swings its rod. An event
knows where it leaves both ends. Path and plan are ordered by labels with gaps between them, so
that nothing behind a change is touched; every write is logged, so that changes can be undone.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._jit import kernel, part
from ..grid import BoolArray, FloatArray, IntArray
from ..motion._chain import Grid

NEXT, BACK, RANK, AFTER, BEFORE, TIME, END, AT, ROD, FROM, OTHER, OTHER_ROD, COUNT = range(13)
"""Rows of `Fold.notes`. Of a joint: its neighbours and its label in the path (-1 off it). Of an
event: its neighbours and its label in the plan (`NEVER` if it is in none), the end that moves,
where that end is then, its rod then and before, and place (-1 before it starts) and rod of the
other."""

JOINTS, SLOTS, SPARE, CROWDED = range(4)
"""Columns of the row COUNT: joints of the path, slots for swings ever used, the first that is free
again (-1: none), and whether labels ran out of gaps."""

NEVER = 1 << 62
SPACING = 1 << 40


Longs = NDArray[np.int64]


class Body(NamedTuple):
    """The solid to fill, cell by cell."""

    solid: BoolArray  # (C,)
    weight: FloatArray  # (C,) worth of a voxel on the path


class Fold(NamedTuple):
    """A path of cells and its plan. An arrival or a start has its cell's number, a swing C + slot.

    The last number is the *root*: path and plan are circles that begin and end there.
    """

    grid: Grid
    weight: FloatArray  # (C,) worth of a voxel on the path
    cells: IntArray  # (V,) the cells of the solid
    free: BoolArray  # (C,) cells of the solid off the path
    notes: Longs  # (13, C + S + 1)
    log: Longs  # (L, 3): row, number and former value of each write since `commit`
    n_log: Longs  # (1,)
    worth: FloatArray  # (1,) sum of the weights on the path
    piece: IntArray  # (C,) scratch: place in the piece being changed, -1 elsewhere


@kernel
def new_fold(grid: Grid, body: Body, path: IntArray, states: IntArray) -> Fold:
    """The fold of a path (cells) and its plan (states, see `motion._search`)."""
    cells = np.flatnonzero(body.solid).astype(np.int32)
    n_numbers = len(body.solid) + 4 * len(cells) + 401
    notes = np.full((13, n_numbers), -1, np.int64)
    notes[TIME] = NEVER
    fold = Fold(
        grid,
        body.weight,
        cells,
        body.solid.copy(),
        notes,
        np.empty((32 * len(cells) + 4000, 3), np.int64),
        np.zeros(1, np.int64),
        np.zeros(1),
        np.full(len(body.solid), -1, np.int32),
    )
    _set_up(fold, path, states)
    return fold


@kernel
def load(fold: Fold, path: IntArray, states: IntArray) -> None:
    """Put another path and plan in place of what the fold holds."""
    notes, root = fold.notes, root_of(fold)
    cell = notes[NEXT, root]
    while cell != root:
        fold.free[cell] = True
        notes[RANK, cell] = -1
        cell = notes[NEXT, cell]
    event = notes[AFTER, root]
    while event != root:
        notes[TIME, event] = NEVER
        notes[ROD, event] = -1
        event = notes[AFTER, event]
    _set_up(fold, path, states)


@kernel
def root_of(fold: Fold) -> int:
    """The number of the root."""
    return fold.notes.shape[1] - 1


@kernel
def n_joints(fold: Fold) -> int:
    """Joints of the path."""
    return fold.notes[COUNT, JOINTS]


@kernel
def _set_up(fold: Fold, path: IntArray, states: IntArray) -> None:
    notes, root = fold.notes, root_of(fold)
    notes[COUNT, :4] = np.array([0, 0, -1, 0])
    notes[RANK, root] = notes[TIME, root] = 0
    notes[AFTER, root] = notes[BEFORE, root] = notes[NEXT, root] = notes[BACK, root] = root
    fold.n_log[0] = 0
    fold.worth[0] = 0.0
    _link(fold, root, root, path)
    spread_labels(fold, NEXT, RANK)
    last = len(path) - 1
    for k in range(len(states) - 1):
        old, new = states[k], states[k + 1]
        end = int(old[1] != new[1] or old[3] != new[3])
        tip = last * end
        other = path[old[1 - end]] if old[1 - end] != last - tip else -1
        other_rod = old[3 - end] if other >= 0 else -1
        if new[end] != old[end]:
            if old[end] == tip:
                _add(fold, path[tip], end, path[tip], old[2 + end], -1, other, other_rod)
            cell = path[new[end]]
            _add(fold, cell, end, cell, new[2 + end], -1, other, other_rod)
        elif old[end] != tip:
            _add(
                fold,
                new_slot(fold),
                end,
                path[old[end]],
                new[2 + end],
                old[2 + end],
                other,
                other_rod,
            )
    commit(fold)


@part
def _add(
    fold: Fold, event: int, end: int, at: int, rod: int, before: int, other: int, other_rod: int
) -> None:
    """Add an event at the end of the plan."""
    root = root_of(fold)
    last = fold.notes[BEFORE, root]
    note_event(fold, event, last, fold.notes[TIME, last] + SPACING, end)
    note_states(fold, event, at, rod, before, other, other_rod)
    put(fold, BEFORE, root, event)
    put(fold, AFTER, event, root)
    fold.n_log[0] = 0


@part
def put(fold: Fold, row: int, number: int, value: int) -> None:
    """Write a note, and log what it was."""
    entry = fold.log[fold.n_log[0]]
    entry[0], entry[1], entry[2] = row, number, fold.notes[row, number]
    fold.n_log[0] += 1
    fold.notes[row, number] = value


@kernel
def undo(fold: Fold) -> None:
    """Take back all that was written since `commit`."""
    for k in range(fold.n_log[0] - 1, -1, -1):
        row, number, value = fold.log[k]
        if row == RANK and number < len(fold.free):
            was_free = fold.free[number]
            fold.free[number] = value < 0
            fold.worth[0] += fold.weight[number] * (int(was_free) - int(value < 0))
        fold.notes[row, number] = value
    fold.n_log[0] = 0


@kernel
def commit(fold: Fold) -> None:
    """Let all changes stand; make new gaps between the labels where there were none left."""
    fold.n_log[0] = 0
    if fold.notes[COUNT, CROWDED]:
        fold.notes[COUNT, CROWDED] = 0
        spread_labels(fold, NEXT, RANK)
        spread_labels(fold, AFTER, TIME)


@part
def spread_labels(fold: Fold, onward: int, label: int) -> None:
    """Label path or plan anew, evenly."""
    root = root_of(fold)
    number, value = fold.notes[onward, root], SPACING
    while number != root:
        fold.notes[label, number] = value
        value += SPACING
        number = fold.notes[onward, number]


@part
def end_after(fold: Fold, event: int, end: int) -> tuple[int, int]:
    """Where an event leaves an end, and its rod then; its tip and -1 before it has started."""
    root = root_of(fold)
    if event != root:
        if fold.notes[END, event] == end:
            return fold.notes[AT, event], fold.notes[ROD, event]
        if fold.notes[OTHER, event] >= 0:
            return fold.notes[OTHER, event], fold.notes[OTHER_ROD, event]
    return fold.notes[BACK if end else NEXT, root], -1


@part
def label_step(fold: Fold, label: int, low: int, high: int, n: int) -> int:
    """The step that spreads n labels evenly between two numbers; 0 if they do not fit in.

    In that case `commit` will make room.
    """
    gap = fold.notes[label, high] - fold.notes[label, low]
    if high == root_of(fold):
        gap = 2 * SPACING
    step = gap // (n + 1)
    if step == 0:
        fold.notes[COUNT, CROWDED] = 1
    return step


@part
def relink(fold: Fold, u: int, v: int, new: IntArray) -> None:
    """Put cells `new` between joints u and v in place of those there."""
    cell = fold.notes[NEXT, u]
    while cell != v:
        put(fold, RANK, cell, -1)
        put(fold, COUNT, JOINTS, fold.notes[COUNT, JOINTS] - 1)
        fold.free[cell] = True
        fold.worth[0] -= fold.weight[cell]
        cell = fold.notes[NEXT, cell]
    _link(fold, u, v, new)


@part
def _link(fold: Fold, u: int, v: int, new: IntArray) -> None:
    step = label_step(fold, RANK, u, v, len(new))
    joint = u
    for cell in new:
        put(fold, NEXT, joint, cell)
        put(fold, BACK, cell, joint)
        put(fold, RANK, cell, fold.notes[RANK, joint] + step)
        fold.free[cell] = False
        fold.worth[0] += fold.weight[cell]
        joint = cell
    put(fold, NEXT, joint, v)
    put(fold, BACK, v, joint)
    put(fold, COUNT, JOINTS, fold.notes[COUNT, JOINTS] + len(new))


@part
def cancel_events(fold: Fold, first: int, last: int) -> None:
    """Take the events strictly between two off the plan; their neighbours are not joined."""
    event = fold.notes[AFTER, first]
    while event != last:
        following = fold.notes[AFTER, event]
        put(fold, TIME, event, NEVER)
        put(fold, ROD, event, -1)
        if event >= len(fold.free):
            put(fold, AFTER, event, fold.notes[COUNT, SPARE])
            put(fold, COUNT, SPARE, event)
        event = following


@part
def note_event(fold: Fold, event: int, before: int, time: int, end: int) -> None:
    """Put an event behind another."""
    put(fold, AFTER, before, event)
    put(fold, BEFORE, event, before)
    put(fold, TIME, event, time)
    put(fold, END, event, end)


@part
def note_states(
    fold: Fold, event: int, at: int, rod: int, former: int, other: int, other_rod: int
) -> None:
    """Note where an event leaves the two ends."""
    put(fold, AT, event, at)
    put(fold, ROD, event, rod)
    put(fold, FROM, event, former)
    put(fold, OTHER, event, other)
    put(fold, OTHER_ROD, event, other_rod)


@part
def new_slot(fold: Fold) -> int:
    """The number of a swing to be."""
    spare = fold.notes[COUNT, SPARE]
    if spare >= 0:
        put(fold, COUNT, SPARE, fold.notes[AFTER, spare])
        return spare
    put(fold, COUNT, SLOTS, fold.notes[COUNT, SLOTS] + 1)
    return len(fold.free) + fold.notes[COUNT, SLOTS] - 1


@kernel
def path_of(fold: Fold) -> IntArray:
    """The cells of the path, in order."""
    path = np.empty(n_joints(fold), np.int32)
    cell = root_of(fold)
    for k in range(len(path)):
        cell = fold.notes[NEXT, cell]
        path[k] = cell
    return path


@kernel
def states_of(fold: Fold) -> IntArray:
    """The plan as states (K, 4), see `motion._search`."""
    notes, root = fold.notes, root_of(fold)
    path = path_of(fold)
    fold.piece[path] = np.arange(len(path))
    states = np.empty((1 + len(path) + notes[COUNT, SLOTS], 4), np.int32)
    states[0] = np.array(
        [0, len(path) - 1, max(notes[ROD, path[0]], 0), max(notes[ROD, path[-1]], 0)]
    )
    n, event = 1, notes[AFTER, root]
    while event != root:
        end, at = notes[END, event], notes[AT, event]
        if event != path[-end]:
            states[n] = states[n - 1]
            states[n, end] = fold.piece[at]
            states[n, 2 + end] = notes[ROD, event]
            n += 1
        event = notes[AFTER, event]
    fold.piece[path] = -1
    return states[:n]
