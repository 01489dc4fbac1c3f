"""The ends of the chain take turns as seldom as they can: the same moves in another order.

Moves of the two ends mostly do not mind each other, but a planner may have let them alternate, and
a hand would have to change ends for every voxel.
"""

from dataclasses import replace

import numpy as np

from .._jit import kernel
from ..grid import IntArray
from ..joints import slot_violations
from ..motion._chain import Chain, Grid, link
from ..motion._search import may_peel, may_swing
from ..motion._slots import peels_at_once, twisted_by_swing
from ..motion.plan import motion_of, path_grid, rod_plan
from ..solid import Motion

_CHANGE, _HALF = 2, 1
"""Cost of a change of ends, and more where half a block is left."""

_NEVER = 2**30


def with_few_turns(motion: Motion) -> Motion:
    """The motion with its moves in an order in which the ends change least often.

    The order keeps the rules of a peel plan, by which rods have room (docs/motion.md, Lemma 6), and
    keeps to the slots if the motion does (Section 11). The motion itself is returned if no other
    order is better, if it is not of two straight rods, or if it has moves for the slots and twists
    pieces all the same.

    Raises
    ------
    ValueError
        If the number of joints is odd.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup.manual.turns import with_few_turns
    >>> motion = lu.fold(lu.VoxelSolid(np.ones((3, 2, 2), bool)), rounds=20, trial_rounds=5).motion
    >>> len(with_few_turns(motion)) == len(motion)
    True
    """
    states, manners = rod_plan(motion)
    joints = "free" if len(states) and len(slot_violations(motion)) else "slotted"
    if joints == "free" and manners.any():
        return motion
    best = motion
    while len(states):
        other = _ordered(motion, states, joints)
        states_then, _ = rod_plan(other)
        # Joints that lie along their rod need no move, so they may be counted to the other end.
        if not len(states_then) or _cost(states_then) >= _cost(states):
            break
        states, best = states_then, other
    return best


def _ordered(motion: Motion, states: IntArray, joints: str) -> Motion:
    """The motion with the moves of its states in the order of least cost, if there is any."""
    ways = [_way(states, end) for end in (0, 1)]
    grid, cells = path_grid(motion.start)
    ends = _fewest(grid, link(grid, cells), ways[0], ways[1], joints == "slotted")
    if not len(ends):
        return motion
    return replace(
        motion,
        moves=motion_of(motion.start, _states(ends, ways), joints).moves,
        reason=f"{motion.reason}; the ends in another order",
    )


def _way(states: IntArray, end: int) -> IntArray:
    """Joint and direction of one end, (K, 2), each time that they change."""
    of_end = states[:, [end, 2 + end]]
    changed = np.append(True, (of_end[1:] != of_end[:-1]).any(axis=1))
    way: IntArray = np.ascontiguousarray(of_end[changed], np.int32)
    return way


def _states(ends: IntArray, ways: list[IntArray]) -> IntArray:
    """The states passed through if these ends move in turn."""
    done = np.vstack([[0, 0], np.cumsum(np.stack([ends == 0, ends == 1], axis=1), axis=0)])
    head, tail = ways[0][done[:, 0]], ways[1][done[:, 1]]
    states: IntArray = np.stack([head[:, 0], tail[:, 0], head[:, 1], tail[:, 1]], axis=1)
    return states


def _cost(states: IntArray) -> int:
    """Of all changes of ends in a plan."""
    ends = (states[1:, [1, 3]] != states[:-1, [1, 3]]).any(axis=1).astype(int)
    changes = np.flatnonzero(ends[1:] != ends[:-1]) + 1
    return sum(_change(int(states[k, ends[k - 1]]), int(ends[k - 1])) for k in changes)


@kernel
def _change(joint: int, end: int) -> int:
    """The cost of leaving an end at this joint."""
    return _CHANGE + _HALF * ((joint + end) % 2)


@kernel
def _fewest(grid: Grid, chain: Chain, head: IntArray, tail: IntArray, slots: bool) -> IntArray:
    """The end of each move in the order of least cost; none if there is no order."""
    m, k = len(head), len(tail)
    cost = np.full((m, k, 2), _NEVER, np.int32)
    came = np.full((m, k, 2), -1, np.int32)  # the end that moved before
    leap = np.zeros((m, k, 2), np.int32)  # by so many moves of this end
    cost[0, 0, :] = 0
    for i in range(m):
        for j in range(k):
            state = np.array([head[i, 0], tail[j, 0], head[i, 1], tail[j, 1]], np.int32)
            for end in range(2):
                if min(cost[i, j, 0], cost[i, j, 1]) >= _NEVER:
                    continue
                way = tail[j:] if end else head[i:]
                n = _at_once(grid, chain, state, end, way, slots)
                if n == 0:
                    continue
                i2, j2 = i + n * (1 - end), j + n * end
                stay = cost[i, j, end]
                change = cost[i, j, 1 - end] + _change(state[1 - end], 1 - end)
                if i + j == 0:
                    change = stay
                if min(stay, change) < cost[i2, j2, end]:
                    cost[i2, j2, end] = min(stay, change)
                    came[i2, j2, end] = end if stay <= change else 1 - end
                    leap[i2, j2, end] = n
    return _ends(cost, came, leap)


@kernel
def _ends(cost: IntArray, came: IntArray, leap: IntArray) -> IntArray:
    """The end of each move on the way to the last state; none if there is none."""
    i, j = cost.shape[0] - 1, cost.shape[1] - 1
    end = int(np.argmin(cost[i, j]))
    ends = np.zeros(i + j if cost[i, j, end] < _NEVER else 0, np.int32)
    while len(ends) and i + j > 0:
        n, before = leap[i, j, end], came[i, j, end]
        ends[i + j - n : i + j] = end
        i, j, end = i - n * (1 - end), j - n * end, before
    return ends


@kernel
def _at_once(
    grid: Grid, chain: Chain, state: IntArray, end: int, way: IntArray, slots: bool
) -> int:
    """Moves along its way that an end may make together: 0, 1, or 2 that swap for the slots."""
    if len(way) == 1:
        return 0
    after = way[1]
    if after[0] == state[end]:
        fine = may_swing(grid, chain, state, end, after[1])
        if slots and fine and twisted_by_swing(grid, chain, state, end, after[1]):
            fine = False
        return int(fine)
    if not may_peel(grid, chain, state, end):
        return 0
    n = peels_at_once(grid, chain, state, end) if slots else 1
    if n == 2 and (len(way) == 2 or way[2, 0] == after[0]):
        return 0
    return n
