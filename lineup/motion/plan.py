"""Peel plans of a lattice path, and the motions they stand for (Section 6)."""

from itertools import pairwise

import numpy as np

from ..grid import IntArray, bar_directions
from ..kinematics import Move
from ..solid import Motion
from ._chain import INWARD, Grid, box_grid, cells_of, link
from ._search import keeps_rules, search

DIAMETER = 0.999
"""Peels and swings keep bars a whole voxel apart; the rest is room for rounding."""

MAX_BEND_DEG = 90.0

BOTH_ENDS = -1


def peel_plan(
    grid: Grid,
    cells: IntArray,
    rng: np.random.Generator,
    *,
    starts: IntArray | None = None,
    budget: int | None = None,
    patience: int = 5_000,
    bias: float = 0.02,
    only: int = BOTH_ENDS,
) -> IntArray:
    """States (K, 4) of the best peel plan found for the chain through `cells`.

    With `only` 0 or 1, no other end of the chain lets go.
    """
    if starts is None:
        directions = np.stack(np.divmod(np.arange(36), 6), axis=1)
        starts = np.hstack([np.tile([0, len(cells) - 1], (36, 1)), directions])
    budget = max(100_000, 4 * len(cells)) if budget is None else budget
    chain = link(grid, np.ascontiguousarray(cells, np.int32))
    return search(grid, chain, starts.astype(np.int32), budget, patience, bias, only, rng)


def left_folded(states: IntArray) -> int:
    """Bars still folded at the end of a plan; 1 when it is complete."""
    return int(states[-1, 1] - states[-1, 0])


def path_grid(voxels: IntArray) -> tuple[Grid, IntArray]:
    """A grid that just holds a path, and the path's cells in it."""
    corner = voxels.min(axis=0)
    shape = tuple(int(s) for s in voxels.max(axis=0) - corner + 1)
    return box_grid(shape), cells_of(voxels - corner, shape)


def motion_of(voxels: IntArray, states: IntArray) -> Motion:
    """The motion that a plan stands for, with the two swings that line up the last bar."""
    bars = bar_directions(voxels)
    last = len(voxels) - 1
    moves = []
    for (a, b, da, db), (a2, b2, da2, db2) in pairwise(states.tolist()):
        if b2 < b and bars[b2] != db:
            moves.append((Move.PEEL, b2, b, db))
        elif a2 > a and (bars[a] + 3) % 6 != da:
            moves.append((Move.PEEL, a2, a, da))
        elif db2 != db and b < last:
            moves.append((Move.SWING, b, b + 1, db2))
        elif da2 != da and a > 0:
            moves.append((Move.SWING, a, a - 1, da2))
    a, b, da, db = states[-1]
    straight = bool(b - a == 1)
    if straight:
        forward = int(bars[a])
        if b < last and db != forward:
            moves.append((Move.SWING, b, b + 1, forward))
        if a > 0 and da != (forward + 3) % 6:
            moves.append((Move.SWING, a, a - 1, (forward + 3) % 6))
    reason = "straight" if straight else f"stuck with joints {a} to {b} of {last + 1} still folded"
    rows = np.array(moves, np.int32).reshape(-1, 4)
    return Motion(voxels, rows, DIAMETER, MAX_BEND_DEG, straight, reason)


def has_peel_plan(motion: Motion) -> bool:
    """Whether a motion ends straight by a peel plan: nothing but its two straight rods moves."""
    return len(_plan_behind(motion)) > 0


def states_of(motion: Motion) -> IntArray:
    """The plan behind a motion of peels and swings; the inverse of `motion_of`.

    Raises
    ------
    ValueError
        If the motion moves in other ways or does not end straight.
    """
    states = _plan_behind(motion)
    if not len(states):
        raise ValueError("only a motion of peels and swings that ends straight has a peel plan")
    return states


def _plan_behind(motion: Motion) -> IntArray:
    """The states (K, 4) of `states_of`; none if they would not be a peel plan of this motion."""
    states = rod_states(motion)
    grid, cells = path_grid(motion.start)
    return states if len(states) and keeps_rules(grid, link(grid, cells), states) else states[:0]


def rod_states(motion: Motion) -> IntArray:
    """States (K, 4) of a motion to the line in which nothing but two straight end rods moves.

    None, (0, 4), if the motion is not of this kind. That rods have room is not asked here.
    """
    none = np.empty((0, 4), np.int32)
    if not (motion.straight and np.isin(motion.moves[:, 0], (Move.PEEL, Move.SWING)).all()):
        return none
    state = [0, len(motion.start) - 1, _first_rod(motion, 0), _first_rod(motion, 1)]
    states = [tuple(state)]

    def let_go(end: int, joint: int) -> None:
        """Enter the states up to the one where `end` is at `joint`."""
        while state[end] != joint:
            state[end] += INWARD[end]
            states.append(tuple(state))

    for kind, joint, other, value in motion.moves.tolist():
        end = int(other > joint)
        if not state[0] <= joint <= state[1]:
            return none
        let_go(end, joint)
        if kind == Move.SWING:
            state[2 + end] = value
            states.append(tuple(state))
    if state[0] == state[1]:
        return none
    let_go(1, state[0] + 1)
    plan = _without_last_swings(np.array(states, np.int32))
    same = np.array_equal(motion_of(motion.start, plan).moves, motion.moves)
    return plan if same else none


def _first_rod(motion: Motion, end: int) -> int:
    """The direction that the rod of `end` starts with."""
    bars = bar_directions(motion.start)
    flip = 3 * (1 - end)
    for kind, joint, other, value in motion.moves.tolist():
        if (other > joint) == (end == 1):
            return int(value) if kind == Move.PEEL else int(bars[min(joint, other)] + flip) % 6
    return int(bars[-end] + flip) % 6


def _without_last_swings(states: IntArray) -> IntArray:
    """A plan cut where its last joint is let go."""
    folded = states[:, 1] - states[:, 0]
    return states[: int(np.argmax(folded == folded[-1])) + 1]
