"""Peel plans of a lattice path, and the motions they stand for (Section 6)."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..grid import IntArray, bar_directions
from ..kinematics import Move
from ..solid import Motion
from ._chain import INWARD, Grid, box_grid, cells_of, link
from ._search import keeps_rules, search
from ._slots import (
    DETOUR,
    FREE,
    PLAIN,
    SLOTTED,
    SPARING,
    SWAP,
    may_detour,
    may_swap,
    twisted_by_peel,
)

DIAMETER = 0.999
"""Peels and swings keep bars a whole voxel apart; the rest is room for rounding."""

MAX_BEND_DEG = 90.0

BOTH_ENDS = -1

Row = tuple[int, int, int, int]
Directions = NDArray[np.int8]

JOINTS = {"free": FREE, "slotted": SLOTTED, "sparing": SPARING}
"""What a plan asks of the joints: nothing, no twist in their slots, or as few as it finds."""


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
    joints: str = "free",
) -> IntArray:
    """States (K, 4) of the best peel plan found for the chain through `cells`.

    With `only` 0 or 1, no other end of the chain lets go.
    """
    if starts is None:
        directions = np.stack(np.divmod(np.arange(36), 6), axis=1)
        starts = np.hstack([np.tile([0, len(cells) - 1], (36, 1)), directions])
    budget = max(100_000, 4 * len(cells)) if budget is None else budget
    chain = link(grid, np.ascontiguousarray(cells, np.int32))
    starts = starts.astype(np.int32)
    return search(grid, chain, starts, budget, patience, bias, only, rng, JOINTS[joints])


def left_folded(states: IntArray) -> int:
    """Bars still folded at the end of a plan; 1 when it is complete."""
    return int(states[-1, 1] - states[-1, 0])


def path_grid(voxels: IntArray) -> tuple[Grid, IntArray]:
    """A grid that just holds a path, and the path's cells in it."""
    corner = voxels.min(axis=0)
    shape = tuple(int(s) for s in voxels.max(axis=0) - corner + 1)
    return box_grid(shape), cells_of(voxels - corner, shape)


def motion_of(voxels: IntArray, states: IntArray, joints: str = "free") -> Motion:
    """The motion that a plan stands for, with the two swings that line up the last bar.

    Unless `joints` are free, peels that would twist a capsule are made in two or swapped with the
    next, where there is room for that.
    """
    manners = np.zeros(len(states) - 1, np.int32)
    return _made(voxels, states, manners if joints == "free" else manners_for_slots(voxels, states))


def manners_for_slots(voxels: IntArray, states: IntArray) -> IntArray:
    """How each step (K - 1,) of a plan keeps to the slots: PLAIN, DETOUR or SWAP.

    PLAIN as well where there is no room for either of the others.
    """
    grid, cells = path_grid(voxels)
    chain, states = link(grid, cells), states.astype(np.int32)
    manners = np.full(len(states) - 1, PLAIN, np.int32)
    for k, (state, after) in enumerate(pairwise(states)):
        end = int(state[1] != after[1])
        capsule = twisted_by_peel(grid, chain, state, end) if state[end] != after[end] else -1
        if capsule < 0:
            continue
        goes_on = k + 2 < len(states) and states[k + 2, end] != after[end]
        if goes_on and may_swap(grid, chain, state, end):
            manners[k] = SWAP
        elif may_detour(grid, chain, state, end, capsule):
            manners[k] = DETOUR
    return manners


def _made(voxels: IntArray, states: IntArray, manners: IntArray) -> Motion:
    """The motion of a plan whose steps are made in these manners."""
    bars = bar_directions(voxels)
    last = len(voxels) - 1
    moves = _moves(bars, last, states, manners)
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


def _moves(bars: Directions, last: int, states: IntArray, manners: IntArray) -> list[Row]:
    moves: list[Row] = []
    before = PLAIN
    for (old, new), manner in zip(pairwise(states.tolist()), manners.tolist(), strict=True):
        row = _move(bars, last, old, new)
        if row and manner == DETOUR:
            moves.append((*row[:3], inward_bar(bars, row[1], row[2])))
        if row:
            moves.append(row)
        if before == SWAP:
            moves[-2:] = moves[:-3:-1]
        before = manner
    return moves


def inward_bar(bars: Sequence[int] | Directions, inner: int, outer: int) -> int:
    """Direction, outward, of the bar that ends at `inner`, beside bar (inner, outer)."""
    return int(bars[inner - 1]) if outer > inner else int(bars[inner] + 3) % 6


def _move(bars: Directions, last: int, old: list[int], new: list[int]) -> Row | None:
    """The move from one state to the next; None where nothing turns."""
    (a, b, da, db), (a2, b2, da2, db2) = old, new
    if b2 < b and bars[b2] != db:
        return (Move.PEEL, b2, b, db)
    if a2 > a and (bars[a] + 3) % 6 != da:
        return (Move.PEEL, a2, a, da)
    if db2 != db and b < last:
        return (Move.SWING, b, b + 1, db2)
    if da2 != da and a > 0:
        return (Move.SWING, a, a - 1, da2)
    return None


def has_peel_plan(motion: Motion) -> bool:
    """Whether a motion ends straight by a peel plan: nothing but its two straight rods moves."""
    return len(_plan_behind(motion)) > 0


def states_of(motion: Motion) -> IntArray:
    """The plan behind a motion of peels and swings; the inverse of `motion_of`, for any joints.

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
    states, manners = rod_plan(motion)
    if not len(states) or (
        manners.any() and not np.array_equal(manners, manners_for_slots(motion.start, states))
    ):
        return states[:0]
    grid, cells = path_grid(motion.start)
    return states if keeps_rules(grid, link(grid, cells), states) else states[:0]


def rod_plan(motion: Motion) -> tuple[IntArray, IntArray]:
    """States (K, 4) of a motion to the line in which nothing but two straight end rods moves.

    And the manners (K - 1,) of the steps between. None at all, if the motion is not of this kind.
    That rods have room is not asked here.
    """
    none = np.empty((0, 4), np.int32), np.empty(0, np.int32)
    if not (motion.straight and np.isin(motion.moves[:, 0], (Move.PEEL, Move.SWING)).all()):
        return none
    moves = _in_order(motion.moves)
    bars = bar_directions(motion.start)
    rods = [_first_rod(bars, [row for row, _ in moves], end) for end in (0, 1)]
    state = [0, len(motion.start) - 1, *rods]
    states, manners = [tuple(state)], [PLAIN]

    def enter(end: int, joint: int) -> None:
        """Enter the states up to the one where `end` is at `joint`."""
        while state[end] != joint:
            state[end] += INWARD[end]
            states.append(tuple(state))
            manners.append(PLAIN)

    for (kind, joint, other, value), manner in moves:
        end = int(other > joint)
        if not state[0] <= joint <= state[1]:
            return none
        enter(end, joint)
        if kind == Move.SWING:
            state[2 + end] = value
            states.append(tuple(state))
            manners.append(PLAIN)
        else:
            manners[-1] = manner
    if state[0] == state[1]:
        return none
    enter(1, state[0] + 1)  # the rest is straight, so either end may take it
    for plan in _ended(np.array(states, np.int32)):
        made = np.array(manners[1 : len(plan)], np.int32)
        if np.array_equal(_made(motion.start, plan, made).moves, motion.moves):
            return plan, made
    return none


def _in_order(moves: IntArray) -> list[tuple[Row, int]]:
    """The moves and their manners: no peel in two, and none before that of the bar beyond it."""
    rows: list[tuple[Row, int]] = []
    for row in map(tuple, moves.tolist()):
        kind, joint, other, value = rows[-1][0] if rows else (-1, -1, -1, -1)
        if row[0] == kind == Move.PEEL and row[1:3] == (joint, other):
            rows[-1] = row, DETOUR
        elif row == (kind, other, 2 * other - joint, value) and kind == Move.PEEL:
            rows.insert(-1, (row, SWAP))
        else:
            rows.append((row, PLAIN))
    return rows


def _first_rod(bars: Directions, moves: list[Row], end: int) -> int:
    """The direction that the rod of `end` starts with."""
    flip = 3 * (1 - end)
    for kind, joint, other, value in moves:
        if (other > joint) == (end == 1):
            return int(value) if kind == Move.PEEL else int(bars[min(joint, other)] + flip) % 6
    return int(bars[-end] + flip) % 6


def _ended(states: IntArray) -> Iterator[IntArray]:
    """The plan without the last two states, the last, or none: `motion_of` swings the last bar.

    No more than that, for rods may swing behind the last bar for no need.
    """
    alone = int(np.argmax(states[:, 1] - states[:, 0] == 1)) + 1
    for stop in range(max(alone, len(states) - 2), len(states) + 1):
        yield states[:stop]
