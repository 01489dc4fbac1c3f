"""Changing a piece of a path and planning it anew, while the rest of the plan stands.

The plan keeps the rules of `motion._search`: every rod counts as infinitely long. Therefore a
change between two joints touches the rest of the motion in two ways only. A new voxel must not
lie in what an earlier event sweeps, and the end that passes the changed piece must enter
and leave it in the states it had before, while the other end rests. All else is local.
"""

from typing import NamedTuple

import numpy as np

from .._jit import kernel, part
from ..grid import IntArray
from ..motion._chain import ray_meets_quadrant, rays_meet
from ._fold import (
    AFTER,
    AT,
    BACK,
    BEFORE,
    COUNT,
    END,
    FROM,
    NEVER,
    NEXT,
    RANK,
    ROD,
    SLOTS,
    TIME,
    Fold,
    Longs,
    cancel_events,
    end_after,
    label_step,
    new_slot,
    note_event,
    note_states,
    put,
    relink,
    root_of,
)

MAX_SWINGS = 2  # in one changed piece


class Span(NamedTuple):
    """The part of a plan in which one end passes from joint `outer` to joint `inner`.

    `outer` is the root where the piece reaches to the tip of the end. The span is *open* where
    `inner` is never reached: the plan ends in the piece, and `inner` may be the root.
    """

    end: int  # -1: no end passes there alone
    outer: int
    inner: int
    first: int  # the last event before the span; its rod is `rod`, -1 if the end starts in the span
    last: int  # the first event behind the span, perhaps the root
    rod: int
    goal: int  # the rod with which the end has to leave the span, -1 if open
    other: int  # where the other end rests, -1 if it has not started; and its rod
    other_rod: int
    low: int  # labels of the first and last joint further inward, all still folded
    high: int


@kernel
def replace(fold: Fold, u: int, v: int, new: IntArray) -> bool:
    """Put cells `new` between joints u and v, u first, in place of what is there.

    The root stands for what lies beyond a tip of the path, so that the path gets another tip.
    Returns whether a plan remained; the fold is unchanged if not.
    """
    span = _find_span(fold, u, v)
    starts_at_inner = span.outer == root_of(fold) and len(new) == 0
    if span.end < 0 or (starts_at_inner and fold.notes[END, span.last] != span.end):
        return False
    limit = fold.notes[TIME, span.first]
    for cell in new:
        if swept_before(fold, cell, limit):
            return False
    root = root_of(fold)
    from_tip, to_tip = int(span.outer == root), int(span.inner == root)
    piece = np.empty(len(new) + 2 - from_tip - to_tip, np.int64)
    piece[1 - from_tip : 1 - from_tip + len(new)] = new if span.end == 0 else new[::-1]
    if not from_tip:
        piece[0] = span.outer
    if not to_tip:
        piece[-1] = span.inner
    route = _plan_piece(fold, span, piece)
    if len(route) == 0 or not _has_room(fold, span, u, v, len(new), len(route)):
        return False
    relink(fold, u, v, new)
    cancel_events(fold, span.first, span.last)
    _add_events(fold, span, piece, route)
    return True


@part
def _has_room(fold: Fold, span: Span, u: int, v: int, n_new: int, n_events: int) -> bool:
    n_old, joint = 0, fold.notes[NEXT, u]
    while joint != v:
        n_old += 1
        joint = fold.notes[NEXT, joint]
    spare = len(fold.log) - fold.n_log[0]
    slots = fold.notes.shape[1] - 1 - len(fold.free) - fold.notes[COUNT, SLOTS]
    if spare < 8 * n_old + 16 * (n_new + n_events + 4) or slots < n_events:
        return False
    path_step = label_step(fold, RANK, u, v, n_new)
    return path_step > 0 and label_step(fold, TIME, span.first, span.last, n_events) > 0


@part
def _find_span(fold: Fold, u: int, v: int) -> Span:
    """The span between two joints, or beyond one of them."""
    notes, root = fold.notes, root_of(fold)
    nothing = Span(-1, u, v, root, root, -1, -1, -1, -1, 1, 0)
    a, rod_a = end_after(fold, notes[BEFORE, root], 0)
    b, rod_b = end_after(fold, notes[BEFORE, root], 1)
    at_front, at_back = u == root, v == root
    open_front = notes[RANK, u] <= notes[RANK, a] if not at_front else rod_a < 0
    open_back = notes[RANK, v] >= notes[RANK, b] if not at_back else rod_b < 0
    if open_front and open_back:
        return _open_span(fold, u, v)
    if not at_back and notes[RANK, v] <= notes[RANK, a] and notes[TIME, v] < NEVER:
        end, outer, inner = 0, u, v
    elif not at_front and notes[RANK, u] >= notes[RANK, b] and notes[TIME, u] < NEVER:
        end, outer, inner = 1, v, u
    else:
        return nothing
    event = notes[BEFORE, inner]
    while event != root and notes[END, event] == end and notes[AT, event] != outer:
        event = notes[BEFORE, event]
    tip = notes[BACK if end else NEXT, root]
    cell, rod = end_after(fold, event, end)
    if outer == tip and rod >= 0:
        event = notes[BEFORE, event]
        cell, rod = end_after(fold, event, end)
    if cell != (tip if outer == root else outer) or (outer == root and rod >= 0):
        return nothing
    other, other_rod = end_after(fold, event, 1 - end)
    low, high = notes[RANK, inner], notes[RANK, other]
    if end == 1:
        low, high = high, low
    if other_rod < 0:
        other = -1
    arrived = inner
    while outer == root and notes[AT, notes[AFTER, arrived]] == inner:
        arrived = notes[AFTER, arrived]  # a tip may not swing: its swings belong to the span
    last, goal = notes[AFTER, arrived], notes[ROD, arrived]
    return Span(end, outer, inner, event, last, rod, goal, other, other_rod, low, high)


@part
def _open_span(fold: Fold, u: int, v: int) -> Span:
    """The span of all that comes after the ends have reached u and v."""
    notes, root = fold.notes, root_of(fold)
    nothing = Span(-1, u, v, root, root, -1, -1, -1, -1, 1, 0)
    event = notes[BEFORE, root]
    while True:
        a, rod_a = end_after(fold, event, 0)
        b, rod_b = end_after(fold, event, 1)
        if u in (a, root) and v in (b, root):
            break
        past_u = u != root and notes[RANK, a] < notes[RANK, u]
        past_v = v != root and notes[RANK, b] > notes[RANK, v]
        if event == root or past_u or past_v:
            return nothing
        event = notes[BEFORE, event]
    if event in (notes[NEXT, root], notes[BACK, root]):  # a start may be another
        event = notes[BEFORE, event]
        a, rod_a = end_after(fold, event, 0)
        b, rod_b = end_after(fold, event, 1)
    end = 0 if v == root or (u != root and rod_a >= 0) else 1
    outer, inner = (v, u) if end else (u, v)
    rod, other, other_rod = (rod_b, a, rod_a) if end else (rod_a, b, rod_b)
    place = notes[RANK, inner] if inner != root else 0
    if other_rod < 0:
        other = -1
    return Span(end, outer, inner, event, root, rod, -1, other, other_rod, place, place)


@kernel
def swept_before(fold: Fold, cell: int, limit: int) -> bool:
    """Whether an event up to time `limit` sweeps `cell`."""
    notes, grid = fold.notes, fold.grid
    for d in range(6):
        c = cell - grid.offset[d]
        while not grid.outside[c]:
            if notes[ROD, c] == d and notes[TIME, c] <= limit:
                return True
            c -= grid.offset[d]
    p = grid.xyz[cell]
    first = len(fold.free)
    for swing in range(first, first + notes[COUNT, SLOTS]):
        if notes[TIME, swing] <= limit and cell != notes[AT, swing]:
            pivot = grid.xyz[notes[AT, swing]]
            if _in_quadrant(p, pivot, notes[FROM, swing], notes[ROD, swing]):
                return True
    return False


@part
def _in_quadrant(p: IntArray, q: IntArray, d: int, f: int) -> bool:
    """Whether p lies in the closed quadrant at q between directions d and f."""
    normal = 3 - d % 3 - f % 3
    if p[normal] != q[normal]:
        return False
    u = (p[d % 3] - q[d % 3]) * (1 - 2 * (d // 3))
    v = (p[f % 3] - q[f % 3]) * (1 - 2 * (f // 3))
    return u >= 0 and v >= 0


@kernel
def _plan_piece(fold: Fold, span: Span, piece: Longs) -> Longs:
    """States (R, 2) of place in the piece and rod direction, from its entry to its exit.

    Fewest swings first, at most MAX_SWINGS; empty if there is no way.
    """
    is_open = span.goal < 0
    goal_place = len(piece) - 1 - int(is_open)
    if goal_place < int(is_open):
        return np.zeros((goal_place + 1, 2), np.int64)
    fold.piece[piece] = np.arange(len(piece))
    parent = np.full(6 * len(piece), -2, np.int32)
    level = np.empty(6 * len(piece), np.int32)
    n_level, goal = 0, -1
    for rod in range(6):  # an end that starts has no rod to swing, and its ray is unproven
        if rod == span.rod or (span.rod < 0 and _clear_ray(fold, span, piece[0], rod, 1)):
            level[n_level] = rod
            n_level += 1
        if rod == span.rod or span.rod < 0:
            parent[rod] = -1
    for _ in range(MAX_SWINGS + 1):
        n_level = _peel_on(fold, span, piece, goal_place, parent, level, n_level)
        for k in range(n_level):
            if level[k] // 6 == goal_place and span.goal in (-1, level[k] % 6):
                goal = level[k]
                break
        if goal >= 0:
            break
        level, n_level = _swing_all(fold, span, piece, parent, level, n_level)
    fold.piece[piece] = -1
    return _route(parent, goal)


@part
def _peel_on(
    fold: Fold,
    span: Span,
    piece: Longs,
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
            along_bar = piece[place] == piece[place + 1] + fold.grid.offset[rod]
            if along_bar or _clear_ray(fold, span, piece[place + 1], rod, place + 2):
                parent[node] = level[k]
                level[n_level] = node
                n_level += 1
        k += 1
    return n_level


@kernel
def _swing_all(
    fold: Fold, span: Span, piece: Longs, parent: IntArray, level: IntArray, n_level: int
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
            if _clear_quadrant(fold, span, piece[place], rod, turned, place + 1):
                parent[node] = level[k]
                following[count] = node
                count += 1
    return following, count


@kernel
def _route(parent: IntArray, goal: int) -> Longs:
    length = 0
    node = goal
    while node >= 0:
        length += 1
        node = parent[node]
    route = np.empty((length, 2), np.int64)
    node = goal
    for k in range(length - 1, -1, -1):
        route[k, 0] = node // 6
        route[k, 1] = node % 6
        node = parent[node]
    return route


@part
def _still_folded(fold: Fold, span: Span, cell: int, place: int) -> bool:
    """Whether `cell` holds a joint that is folded while the end is before `place`."""
    if fold.piece[cell] >= 0:
        return fold.piece[cell] >= place
    return span.low <= fold.notes[RANK, cell] <= span.high


@part
def _clear_ray(fold: Fold, span: Span, start: int, d: int, place: int) -> bool:
    grid = fold.grid
    c = start + grid.offset[d]
    while not grid.outside[c]:
        if _still_folded(fold, span, c, place):
            return False
        c += grid.offset[d]
    if span.other < 0:
        return True
    return not rays_meet(grid.xyz[span.other], span.other_rod, grid.xyz[start], d)


@part
def _clear_quadrant(fold: Fold, span: Span, start: int, d: int, f: int, place: int) -> bool:
    grid = fold.grid
    row = start
    while not grid.outside[row]:
        c = row
        while not grid.outside[c]:
            if _still_folded(fold, span, c, place):
                return False
            c += grid.offset[f]
        row += grid.offset[d]
    if span.other < 0:
        return True
    return not ray_meets_quadrant(grid.xyz[span.other], span.other_rod, grid.xyz[start], d, f)


@part
def _add_events(fold: Fold, span: Span, piece: Longs, route: Longs) -> None:
    """Put the events of a route into the gap of a span."""
    begin = 0 if span.rod < 0 else 1
    stop = begin if span.goal < 0 and len(route) == 1 else len(route)
    event, step = span.first, label_step(fold, TIME, span.first, span.last, stop - begin)
    for k in range(begin, stop):
        place, rod = route[k]
        swings = k > 0 and route[k - 1, 0] == place
        number = new_slot(fold) if swings else piece[place]
        note_event(fold, number, event, fold.notes[TIME, event] + step, span.end)
        former = route[k - 1, 1] if swings else -1
        note_states(fold, number, piece[place], rod, former, span.other, span.other_rod)
        event = number
    put(fold, AFTER, event, span.last)
    put(fold, BEFORE, span.last, event)
