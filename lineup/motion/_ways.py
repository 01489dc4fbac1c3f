"""Shortest ways for the leading end of a chain that glides: lattice paths through free cells."""

from collections.abc import Iterator
from heapq import heappop, heappush
from itertools import count

import numpy as np
from numpy.typing import NDArray

from ..grid import DIRECTIONS, BoolArray, IntArray

State = tuple[int, int, int]
"""A cell, the direction of the step to it, and a direction whose opposite would close a U.

Where Us are allowed the third is the second again. Cells are numbers in the raveled grid.
"""


def strides_of(shape: tuple[int, ...]) -> IntArray:
    """What a step in each of the six directions adds to a cell's number."""
    strides: IntArray = DIRECTIONS @ np.array([shape[1] * shape[2], shape[2], 1])
    return strides


def ways(
    shut: BoolArray,
    start: State,
    ends: BoolArray,
    wall: BoolArray | None = None,
    ahead: IntArray | None = None,
    *,
    u_free: bool,
) -> Iterator[tuple[list[int], list[int]]]:
    """Ways from `start`, in order of their lengths: the cells, and the step from each of them.

    The way to a state is a shortest one, which may meet itself where it has to turn round without
    a U.

    Parameters
    ----------
    shut : (X, Y, Z) bool
        Cells not to be entered; all at the rim are among them.
    ends : (6, X * Y * Z) bool
        A way ends with a step in direction d from a cell where ``ends[d, cell]``.
    wall : (X, Y, Z) bool, optional
        Cells that must not lie in the crook of a corner either.
    ahead : (X * Y * Z,) int, optional
        A lower bound on the steps from each cell to an end, -1 where none is reached, which
        changes by 1 at most from cell to cell. It makes the search faster, not another.
    """
    strides = strides_of(shut.shape).tolist()
    closed = shut.ravel()
    solid = np.zeros_like(closed) if wall is None else wall.ravel()
    left = np.zeros(closed.size, np.int32) if ahead is None else ahead
    came_from: dict[State, State | None] = {start: None}
    number = count()
    queue = [(int(left[start[0]]), int(left[start[0]]), next(number), start)]
    while queue:
        total, still, _, state = heappop(queue)
        cell, last, before = state
        onward = [
            d
            for d in (last, *range(6))
            if (d + 3) % 6 not in (last, before)
            and (d == last or not solid[cell - strides[last] + strides[d]])
        ]
        for d in onward:
            if ends[d, cell]:
                states = _led(came_from, state)
                yield [s[0] for s in states], [*(s[1] for s in states[1:]), d]
        for d in onward:
            new = (cell + strides[d], d, last if u_free else d)
            if not closed[new[0]] and new not in came_from and left[new[0]] >= 0:
                came_from[new] = state
                h = int(left[new[0]])
                heappush(queue, (total - still + 1 + h, h, next(number), new))


def steps_to(goals: NDArray[np.intp], shut: BoolArray) -> IntArray:
    """Steps through cells that are not shut from each cell to the nearest goal, -1 where none."""
    strides = strides_of(shut.shape)
    steps = np.full(shut.size, -1, np.int32)
    closed = shut.ravel()
    front = goals
    reached = 0
    while len(front):
        steps[front] = reached
        near = np.unique(front[:, None] + strides)
        front = near[(steps[near] < 0) & ~closed[near]]
        reached += 1
    return steps


def _led(came_from: dict[State, State | None], state: State) -> list[State]:
    """The states that led to this one, from the first on."""
    states = [state]
    while (before := came_from[states[-1]]) is not None:
        states.append(before)
    return states[::-1]
