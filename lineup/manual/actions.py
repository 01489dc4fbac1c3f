"""What a hand does, in order, from the straight line to the body: the motion backwards (Section 7).

The motion lets go of the chain's joints from both ends, head and tail, and each end that has been
let go is a straight rod. Backwards, two joints are the base, and the rods are laid down on either
side of it, voxel by voxel; the part of the chain that still is to come is the loose end.
"""

from itertools import pairwise
from typing import NamedTuple

from ..grid import bar_directions
from ..motion._slots import DETOUR, PLAIN
from ..motion.plan import rod_plan
from ..solid import Motion

HEAD, TAIL = 0, 1
ENDS = ("head", "tail")
"""The loose end before joint 0, and that after the last joint."""

AT_ONCE, STRAIGHTEN, HINGE_FIRST = MANNERS = ("", "straighten", "hinge first")
"""How a hinge is bent: after its piece and at once; through the pole of its socket, so that it
first is in line with its piece; or before its piece. By the manners of a plan (`motion._slots`)."""


class Action(NamedTuple):
    """Put one voxel in its place, or swing a loose end.

    Attributes
    ----------
    end : int
        HEAD or TAIL: the loose end at work.
    joint : int
        The joint put in place; of a swing, the joint last put in place at this end.
    was, loose : int
        Direction of this loose end before and after, away from the body; they differ in a swing.
    moves : int
        The pose after it is the one that `moves` moves of the unfolding lead to; where the hinge
        goes first, of the piece's that in which the hinge alone is bent.
    manner : str
        One of `MANNERS`; "" of all but a hinge's.
    """

    end: int
    joint: int
    was: int
    loose: int
    moves: int
    manner: str = AT_ONCE

    @property
    def swings(self) -> bool:
        """Whether it is a swing."""
        return self.was != self.loose

    @property
    def before(self) -> int:
        """The joint, in place already, from which the bar leads to `joint`."""
        return self.joint + (1 if self.end == HEAD else -1)

    @property
    def lays_hinge(self) -> bool:
        """Whether that bar is a hinge, and not a piece."""
        return min(self.joint, self.before) % 2 == 0


def actions_of(motion: Motion) -> tuple[tuple[int, int], list[Action]]:
    """The two joints of the base, and all actions from the straight line to ``motion.start``.

    Raises
    ------
    ValueError
        If the motion does not end straight, or moves anything but two straight rods.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup.manual.actions import actions_of
    >>> corner = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0)])
    >>> base, actions = actions_of(lu.unfold(lu.VoxelPath(corner), method="peel"))
    >>> len(actions)
    2
    """
    plan, manners = rod_plan(motion)
    states = [(a, b, da, db) for a, b, da, db in plan.tolist()]
    if not states:
        raise ValueError(
            "a manual follows peels and swings of the chain's two straight ends until it is a "
            f"line, and this motion ({motion.reason}) is none of these; "
            "lu.unfold(path, method='peel') may find one"
        )
    bars = bar_directions(motion.start).tolist()
    last = len(motion.start) - 1
    a, b, da, db = states[-1]
    # The last bar is lined up by the tail's rod first, then by the head's.
    if b < last and db != bars[a]:
        states.append((a, b, da, bars[a]))
    if a > 0 and da != (bars[a] + 3) % 6:
        states.append((a, b, (bars[a] + 3) % 6, states[-1][3]))
    actions, moves = [], 0
    lined_up = [PLAIN] * (len(states) - len(plan))
    how = [*manners.tolist(), *lined_up]
    for (old, new), manner in zip(pairwise(states), how, strict=True):
        end = HEAD if old[1] == new[1] and old[3] == new[3] else TAIL
        joint, rod = old[end], new[2 + end]
        placed = joint != new[end]
        away = (bars[joint] + 3) % 6 if end == HEAD else bars[joint - 1]
        loose = rod if placed else old[2 + end]
        actions.append(Action(end, joint, rod, loose, moves, MANNERS[manner]))
        moves += (not placed or away != rod) + (manner == DETOUR)
    return (a, b), actions[::-1]
