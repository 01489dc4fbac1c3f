"""The ends of the chain take turns as seldom as they can: the same moves in another order.

Moves of the two ends mostly do not mind each other, but a planner may have let them alternate, and
a hand would have to change ends for every voxel.
"""

from dataclasses import replace

import numpy as np

from .._jit import kernel
from ..grid import IntArray
from ..motion._chain import Chain, Grid, link
from ..motion._search import may_peel, may_swing
from ..motion.plan import motion_of, path_grid, rod_states
from ..solid import Motion

_CHANGE, _HALF = 2, 1
"""Cost of a change of ends, and more where half a block is left."""

_NEVER = 2**30


def with_few_turns(motion: Motion) -> Motion:
    """The motion with its moves in an order in which the ends change least often.

    The order keeps the rules of a peel plan, by which rods have room (docs/motion.md, Lemma 6).
    The motion itself is returned if no other order is better, or it is not of two straight rods.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup.manual.turns import with_few_turns
    >>> motion = lu.fold(lu.VoxelSolid(np.ones((3, 2, 2), bool)), rounds=20, trial_rounds=5).motion
    >>> len(with_few_turns(motion)) == len(motion)
    True
    """
    states, best = rod_states(motion), motion
    while len(states):
        other = _ordered(motion, states)
        states_then = rod_states(other)
        # Joints that lie along their rod need no move, so they may be counted to the other end.
        if not len(states_then) or _cost(states_then) >= _cost(states):
            break
        states, best = states_then, other
    return best


def _ordered(motion: Motion, states: IntArray) -> Motion:
    """The motion with the moves of its states in the order of least cost, if there is any."""
    ways = [_way(states, end) for end in (0, 1)]
    grid, cells = path_grid(motion.start)
    ends = _fewest(grid, link(grid, cells), ways[0], ways[1])
    if not len(ends):
        return motion
    return replace(
        motion,
        moves=motion_of(motion.start, _states(ends, ways)).moves,
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
def _fewest(grid: Grid, chain: Chain, head: IntArray, tail: IntArray) -> IntArray:
    """The end of each move in the order of least cost; none if there is no order."""
    m, k = len(head), len(tail)
    cost = np.full((m, k, 2), _NEVER, np.int64)
    came = np.full((m, k, 2), -1, np.int8)  # the end that moved before
    cost[0, 0, :] = 0
    for i in range(m):
        for j in range(k):
            state = np.array([head[i, 0], tail[j, 0], head[i, 1], tail[j, 1]], np.int32)
            for end in range(2):
                i2, j2 = i + 1 - end, j + end
                if i2 == m or j2 == k or min(cost[i, j, 0], cost[i, j, 1]) >= _NEVER:
                    continue
                after = tail[j2] if end else head[i2]
                if not _may(grid, chain, state, end, after):
                    continue
                stay = cost[i, j, end]
                change = cost[i, j, 1 - end] + _change(state[1 - end], 1 - end)
                if i + j == 0:
                    change = stay
                cost[i2, j2, end] = min(stay, change)
                came[i2, j2, end] = end if stay <= change else 1 - end
    end = int(np.argmin(cost[m - 1, k - 1]))
    least = cost[m - 1, k - 1, end]
    ends = np.zeros(m + k - 2 if least < _NEVER else 0, np.int32)
    i, j = m - 1, k - 1
    for row in range(len(ends) - 1, -1, -1):
        ends[row] = end
        before = came[i, j, end]
        i, j, end = i - 1 + end, j - end, before
    return ends


@kernel
def _may(grid: Grid, chain: Chain, state: IntArray, end: int, after: IntArray) -> bool:
    """Whether an end may go on to this joint, or swing its rod to this direction."""
    if after[0] != state[end]:
        return may_peel(grid, chain, state, end)
    return may_swing(grid, chain, state, end, after[1])
