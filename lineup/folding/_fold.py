"""A path and its peel plan, changed together (certified growth).

The plan keeps the rules of `motion._search`: every rod counts as infinitely long. Therefore a
change between two joints touches the rest of the motion in two ways only. A new voxel must not
lie in what an earlier transition sweeps, and the end that passes the changed piece must enter
and leave it in the states it had before, while the other end rests. All else is local.
"""

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ..grid import IntArray
from ..motion._chain import INWARD, Grid, ray_meets_quadrant, rays_meet

NEVER = 1 << 30
MAX_SWINGS = 2  # in one changed piece


class Fold(NamedTuple):
    """A path of cells and its plan, with what is needed to check a change quickly."""

    path: IntArray  # (cap,) cells; the first size[0] count
    states: IntArray  # (cap, 4) states (a, b, da, db); the first size[1] count
    size: IntArray  # (3,) joints, states, swings
    joint: IntArray  # (C,) joint at each cell, -1 where there is none
    when: IntArray  # (C,) the transition by which an end arrived at the cell, NEVER if none did
    rod: IntArray  # (C,) the direction of the rod when it arrived
    swings: IntArray  # (cap, 4) cell, from, to, transition
    piece: IntArray  # (C,) scratch: place in the piece being changed, -1 elsewhere


class Span(NamedTuple):
    """The part of a plan in which one end passes from joint `outer` to joint `inner`."""

    end: int
    outer: np.int64
    inner: np.int64
    first: np.int64  # the last state with the end at `outer`
    last: np.int64  # the state from which the end goes to `inner`
    is_middle: bool  # `inner` is never reached: the piece lies between the two last joints


@kernel
def new_fold(n_cells: int, path: IntArray, states: IntArray, capacity: int) -> Fold:
    """The fold of a path (cells) and its plan, with room for `capacity` joints."""
    fold = Fold(
        np.empty(capacity, np.int32),
        np.empty((4 * capacity + 400, 4), np.int32),
        np.zeros(3, np.int32),
        np.full(n_cells, -1, np.int32),
        np.full(n_cells, NEVER, np.int32),
        np.full(n_cells, -1, np.int32),
        np.empty((4 * capacity + 400, 4), np.int32),
        np.full(n_cells, -1, np.int32),
    )
    load(fold, path, states)
    return fold


@kernel
def load(fold: Fold, path: IntArray, states: IntArray) -> None:
    """Put another path and plan in place of what the fold holds."""
    for k in range(fold.size[0]):
        _forget(fold, fold.path[k])
    fold.path[: len(path)] = path
    fold.states[: len(states)] = states
    fold.size[0] = len(path)
    fold.size[1] = len(states)
    refresh(fold)


@kernel
def _forget(fold: Fold, cell: int) -> None:
    fold.joint[cell] = -1
    fold.when[cell] = NEVER
    fold.rod[cell] = -1


@kernel
def refresh(fold: Fold) -> None:
    """Bring joint, when, rod and swings up to date with path and states."""
    n, n_states = fold.size[0], fold.size[1]
    for k in range(n):
        fold.joint[fold.path[k]] = k
        fold.when[fold.path[k]] = NEVER
        fold.rod[fold.path[k]] = -1
    for end in range(2):
        if fold.states[n_states - 1, end] != (n - 1) * end:
            cell = fold.path[(n - 1) * end]
            fold.when[cell] = -1
            fold.rod[cell] = fold.states[0, 2 + end]
    fold.size[2] = 0
    for k in range(n_states - 1):
        _note_transition(fold, k)


@kernel
def _note_transition(fold: Fold, k: int) -> None:
    """Record what transition k sweeps."""
    old, new = fold.states[k], fold.states[k + 1]
    for end in range(2):
        if new[end] != old[end]:
            cell = fold.path[new[end]]
            fold.when[cell] = k
            fold.rod[cell] = new[2 + end]
        elif new[2 + end] != old[2 + end]:
            swing = fold.swings[fold.size[2]]
            swing[0] = fold.path[old[end]]
            swing[1] = old[2 + end]
            swing[2] = new[2 + end]
            swing[3] = k
            fold.size[2] += 1


@kernel
def swept_before(grid: Grid, fold: Fold, cell: int, k: np.int64) -> bool:
    """Whether a transition before k sweeps `cell`."""
    for d in range(6):
        c = cell - grid.offset[d]
        while not grid.outside[c]:
            if fold.rod[c] == d and fold.when[c] < k:
                return True
            c -= grid.offset[d]
    for s in range(fold.size[2]):
        pivot, d, f, when = fold.swings[s]
        if when >= k:
            break
        if cell != pivot and _in_quadrant(grid.xyz[cell], grid.xyz[pivot], d, f):
            return True
    return False


@kernel
def _in_quadrant(p: IntArray, q: IntArray, d: int, f: int) -> bool:
    """Whether p lies in the closed quadrant at q between directions d and f."""
    normal = 3 - d % 3 - f % 3
    if p[normal] != q[normal]:
        return False
    u = (p[d % 3] - q[d % 3]) * (1 - 2 * (d // 3))
    v = (p[f % 3] - q[f % 3]) * (1 - 2 * (f // 3))
    return u >= 0 and v >= 0


@kernel
def replace(grid: Grid, fold: Fold, i: int, j: int, new: IntArray) -> bool:
    """Put cells `new` between joints i < j in place of what is there, if a plan remains.

    Returns whether it did; the fold is unchanged if not.
    """
    span = _find_span(fold, i, j)
    if span.end < 0 or not _has_room(fold, len(new) - (j - i - 1)):
        return False
    for cell in new:
        if swept_before(grid, fold, cell, span.first):
            return False
    piece = np.empty(len(new) + 2, np.int32)
    piece[0] = fold.path[span.outer]
    piece[1:-1] = new if span.end == 0 else new[::-1]
    piece[-1] = fold.path[span.inner]
    route = _plan_piece(grid, fold, span, piece)
    if len(route) == 0:
        return False
    for k in range(i + 1, j):
        _forget(fold, fold.path[k])
    same_shape = len(new) == j - i - 1 and len(route) == j - i + 1 == span.last + 2 - span.first
    if same_shape and not span.is_middle:
        fold.path[i + 1 : j] = new
        _overwrite(fold, span, route)
    else:
        _splice_states(fold, span, route, len(new) - (j - i - 1))
        _splice_path(fold, i, j, new)
        refresh(fold)
    return True


@kernel
def _has_room(fold: Fold, growth: int) -> bool:
    spare = len(fold.states) - fold.size[1]
    return fold.size[0] + growth <= len(fold.path) and spare > 8 * (growth + 8)


@kernel
def _find_span(fold: Fold, i: int, j: int) -> Span:
    """The span of the end that passes joints i..j; its `end` is -1 if none does alone."""
    zero = np.int64(0)
    nothing = Span(-1, zero, zero, zero, zero, False)
    last = fold.size[1] - 1
    a, b = fold.states[last, 0], fold.states[last, 1]
    is_middle = i == a and j == b
    if not (j <= a or i >= b or is_middle):
        return nothing
    end = 0 if j <= a else 1
    if is_middle and b == fold.size[0] - 1 and a > 0:
        end = 0  # the end that has a rod
    outer, inner = (i, j) if end == 0 else (j, i)
    stop = last if is_middle else fold.when[fold.path[inner]]
    first = stop
    while fold.states[first, end] != outer:
        first -= 1
    for k in range(first, stop):
        for column in (1 - end, 3 - end):
            if fold.states[k, column] != fold.states[stop, column]:
                return nothing
    return Span(end, np.int64(outer), np.int64(inner), np.int64(first), np.int64(stop), is_middle)


@kernel
def _plan_piece(grid: Grid, fold: Fold, span: Span, piece: IntArray) -> IntArray:
    """States (R, 2) of place in the piece and rod direction, from its entry to its exit.

    Fewest swings first, at most MAX_SWINGS; empty if there is no way.
    """
    goal_place = len(piece) - 1 - int(span.is_middle)
    goal_rod = -1 if span.is_middle else fold.states[span.last + 1, 2 + span.end]
    start = fold.states[span.first, 2 + span.end]
    fold.piece[piece] = np.arange(len(piece))
    parent = np.full(6 * len(piece), -2, np.int32)
    parent[start] = -1
    level = np.empty(6 * len(piece), np.int32)
    level[0] = start
    n_level, goal = 1, -1
    if span.outer == (fold.size[0] - 1) * span.end:  # no rod yet: none to swing, its ray unproven
        parent[:6] = -1
        n_level = int(_clear_ray(grid, fold, span, piece[0], start, 1))
    for _ in range(MAX_SWINGS + 1):
        n_level = _peel_on(grid, fold, span, piece, goal_place, parent, level, n_level)
        for k in range(n_level):
            if level[k] // 6 == goal_place and goal_rod in (-1, level[k] % 6):
                goal = level[k]
                break
        if goal >= 0:
            break
        level, n_level = _swing_all(grid, fold, span, piece, parent, level, n_level)
    fold.piece[piece] = -1
    return _route(parent, goal)


@kernel
def _peel_on(
    grid: Grid,
    fold: Fold,
    span: Span,
    piece: IntArray,
    goal: int,
    parent: IntArray,
    level: IntArray,
    n_level: int,
) -> int:
    """Add to a level whatever its nodes reach by peels alone; its new size."""
    k = 0
    while k < n_level:
        place, rod = level[k] // 6, level[k] % 6
        node = level[k] + 6
        if place < goal and parent[node] == -2:
            along_bar = piece[place] == piece[place + 1] + grid.offset[rod]
            if along_bar or _clear_ray(grid, fold, span, piece[place + 1], rod, place + 2):
                parent[node] = level[k]
                level[n_level] = node
                n_level += 1
        k += 1
    return n_level


@kernel
def _swing_all(
    grid: Grid,
    fold: Fold,
    span: Span,
    piece: IntArray,
    parent: IntArray,
    level: IntArray,
    n_level: int,
) -> tuple[IntArray, int]:
    """The level that one more swing reaches."""
    following = np.empty(len(level), np.int32)
    count = 0
    for k in range(n_level):
        place, rod = level[k] // 6, level[k] % 6
        for turned in range(6):
            node = 6 * place + turned
            if turned % 3 == rod % 3 or parent[node] != -2:
                continue
            if _clear_quadrant(grid, fold, span, piece[place], rod, turned, place + 1):
                parent[node] = level[k]
                following[count] = node
                count += 1
    return following, count


@kernel
def _route(parent: IntArray, goal: int) -> IntArray:
    length = 0
    node = goal
    while node >= 0:
        length += 1
        node = parent[node]
    route = np.empty((length, 2), np.int32)
    node = goal
    for k in range(length - 1, -1, -1):
        route[k, 0] = node // 6
        route[k, 1] = node % 6
        node = parent[node]
    return route


@kernel
def _still_folded(fold: Fold, span: Span, cell: int, place: int) -> bool:
    """Whether `cell` holds a joint that is folded while the end is before `place`."""
    if fold.piece[cell] >= 0:
        return fold.piece[cell] >= place
    joint = fold.joint[cell]
    if min(span.outer, span.inner) < joint < max(span.outer, span.inner):
        return False
    other = fold.states[span.first, 1 - span.end]
    return joint >= 0 and (joint - span.inner) * (joint - other) <= 0


@kernel
def _clear_ray(grid: Grid, fold: Fold, span: Span, start: int, d: int, place: int) -> bool:
    c = start + grid.offset[d]
    while not grid.outside[c]:
        if _still_folded(fold, span, c, place):
            return False
        c += grid.offset[d]
    other = fold.states[span.first, 1 - span.end]
    if other == (fold.size[0] - 1) * (1 - span.end):
        return True
    p = grid.xyz[fold.path[other]]
    return not rays_meet(p, fold.states[span.first, 3 - span.end], grid.xyz[start], d)


@kernel
def _clear_quadrant(
    grid: Grid, fold: Fold, span: Span, start: int, d: int, f: int, place: int
) -> bool:
    row = start
    while not grid.outside[row]:
        c = row
        while not grid.outside[c]:
            if _still_folded(fold, span, c, place):
                return False
            c += grid.offset[f]
        row += grid.offset[d]
    other = fold.states[span.first, 1 - span.end]
    if other == (fold.size[0] - 1) * (1 - span.end):
        return True
    p = grid.xyz[fold.path[other]]
    rod = fold.states[span.first, 3 - span.end]
    return not ray_meets_quadrant(p, rod, grid.xyz[start], d, f)


@kernel
def _overwrite(fold: Fold, span: Span, route: IntArray) -> None:
    """Change a piece that keeps its length and has no swing, before or after."""
    for k in range(len(route)):
        joint = span.outer + INWARD[span.end] * k
        cell = fold.path[joint]
        fold.states[span.first + k, 2 + span.end] = route[k, 1]
        if k > 0:
            fold.joint[cell] = joint
            fold.when[cell] = span.first + k - 1
            fold.rod[cell] = route[k, 1]


@kernel
def _splice_states(fold: Fold, span: Span, route: IntArray, growth: int) -> None:
    """Put the states of `route` in the span's place; joints behind it move by `growth`."""
    n_states = fold.size[1]
    after = n_states if span.is_middle else span.last + 2
    shift = span.first + len(route) - after
    other = fold.states[span.first].copy()
    tail = fold.states[after:n_states].copy()
    fold.states[after + shift : n_states + shift] = tail
    fold.size[1] = n_states + shift
    back = max(span.outer, span.inner)
    for k in range(fold.size[1]):
        if span.first <= k < span.first + len(route):
            fold.states[k] = other
            fold.states[k, span.end] = span.outer + INWARD[span.end] * route[k - span.first, 0]
            fold.states[k, 2 + span.end] = route[k - span.first, 1]
            if span.end == 1:
                fold.states[k, 1] += growth
            else:
                fold.states[k, 1] += growth * int(other[1] >= back)
        else:
            for end in range(2):
                fold.states[k, end] += growth * int(fold.states[k, end] >= back)


@kernel
def _splice_path(fold: Fold, i: int, j: int, new: IntArray) -> None:
    n = fold.size[0]
    growth = len(new) - (j - i - 1)
    tail = fold.path[j:n].copy()
    fold.path[j + growth : n + growth] = tail
    fold.path[i + 1 : i + 1 + len(new)] = new
    fold.size[0] = n + growth
