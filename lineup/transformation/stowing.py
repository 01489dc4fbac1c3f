"""A chain unfolded without ever being long: what has been let go is folded away like a napkin.

One end of the chain lets go of bar after bar, as in any peel plan. Its rod is kept at most
`strand` bars long: what is longer is laid at the far end of the rod in zigzag layers across it,
the *stow*, whose base moves by one cell for each bar. The stow is carried along by the rod, moves
in parallel with itself when a bar is let go, and turns with the rod when it swings. A strand
longer than the folded body is wide keeps the two apart whatever the plan; a shorter one may do.
"""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from ..grid import DIRECTIONS, IntArray, bar_directions
from ..kinematics import Move
from ..motion._chain import INWARD
from ..motion.plan import (
    DIAMETER,
    MAX_BEND_DEG,
    has_peel_plan,
    left_folded,
    path_grid,
    peel_plan,
    states_of,
)
from ..solid import Motion
from .reversal import opposite, quarter_turn, turned_code, words

Row = tuple[int, int, int, int]

INWARDS = -1
"""A step of the stow's base along the strand: the next layer begins, and no bar turns."""

REPLANS = 6


def one_ended_plans(motion: Motion, seed: int) -> list[tuple[int, IntArray]]:
    """Peel plans in which one end of the chain never lets go, each after the end that does."""
    plans = [states_of(motion)] if has_peel_plan(motion) else []
    rng = np.random.default_rng(seed)
    grid, cells = path_grid(motion.start)
    plans += [peel_plan(grid, cells, rng, bias=k % 2, only=1 - k % 2) for k in range(REPLANS)]
    complete = [states for states in plans if left_folded(states) == 1]
    return [
        (end, states)
        for states in complete
        for end in (0, 1)
        if (states[:, 1 - end] == states[0, 1 - end]).all()
    ]


def stowed(voxels: IntArray, end: int, states: IntArray, strand: int) -> Motion:
    """The motion of a one-ended plan with all but `strand` + 1 bars folded away at its end."""
    stow = _Stow(len(voxels), end, strand)
    bars = bar_directions(voxels)
    outer = 0 if end == 0 else len(voxels) - 1
    for before, after in pairwise(states[:, [end, 2 + end]].tolist()):
        stow.rod_leaves(before[1])
        if after[0] != before[0]:
            forward = int(bars[min(before[0], after[0])])
            if (forward if end else opposite(forward)) != after[1]:
                stow.moves.append((Move.PEEL, after[0], before[0], after[1]))
            stow.lay(after[0])
        elif before[0] != outer:
            stow.swing(before[0], after[1])
        else:
            stow.frame = _frame(after[1])
    joint, rod = int(states[-1, end]), int(states[-1, 2 + end])
    last = int(bars[joint] if end == 0 else bars[joint - 1])
    along = opposite(last) if end == 0 else last
    if rod != along and joint != outer:
        stow.swing(joint, along)
    stow.lay(joint + INWARD[end])
    return _motion(voxels, stow.moves)


def passed_on(start: IntArray, end: int, strand: int) -> Motion:
    """The motion that moves the whole stow of a stowed chain from `end` to the other end."""
    n_joints = len(start)
    bars = bar_directions(start)
    base = n_joints - 1 - _n_stowed(n_joints, strand) if end else _n_stowed(n_joints, strand)
    inner = base + INWARD[end]
    out = int(bars[min(base, inner)])
    out = out if end else opposite(out)  # along the strand, towards the stow
    other = _Stow(n_joints, 1 - end, strand)
    other.frame = _frame(opposite(out))
    while base != (n_joints - 1 if end else 0):
        outward = base - INWARD[end]
        bar = int(bars[min(base, outward)])
        if (bar if end else opposite(bar)) != out:  # the stow rests, and all else is carried
            other.moves.append((Move.PEEL, outward, base, opposite(out)))
        base = outward
        other.lay(base)
    return _motion(start, other.moves)


class _Stow:
    """The moves made so far, and the stow at one end of the chain: how much, and which way up."""

    def __init__(self, n_joints: int, end: int, strand: int) -> None:
        self.end, self.strand = end, strand
        self.moves: list[Row] = []
        self.frame: tuple[int, int, int] | None = None
        self._base = 0 if end == 0 else n_joints - 1
        self._steps = _zigzag(int(np.ceil(np.cbrt(n_joints))))

    def rod_leaves(self, along: int) -> None:
        """The rod begins in this direction, unless it has begun."""
        self.frame = self.frame or _frame(along)

    def swing(self, joint: int, to: int) -> None:
        """The rod swings about `joint`, and the stow with it."""
        assert self.frame is not None  # a rod has begun
        self.moves.append((Move.SWING, joint, joint - INWARD[self.end], to))
        code = turned_code(quarter_turn(self.frame[2], to))
        u, v, along = (int(code[d]) for d in self.frame)
        self.frame = (u, v, along)

    def lay(self, joint: int) -> None:
        """Fold away what of the rod from `joint` outwards is longer than the strand."""
        assert self.frame is not None  # a rod has begun
        while abs(joint - self._base) > self.strand:
            step = next(self._steps)
            inner = self._base + INWARD[self.end]
            if step != INWARDS:
                u, v, _ = self.frame
                out = (opposite(u), opposite(v), u, v)[step]
                self.moves.append((Move.PEEL, inner, self._base, out))
            self._base = inner


def _n_stowed(n_joints: int, strand: int) -> int:
    return max(n_joints - 1 - strand, 0)


def _frame(along: int) -> tuple[int, int, int]:
    """Directions (u, v, along) of a right-handed frame."""
    u, v = (along + 1) % 3, (along + 2) % 3
    return (u, v, along) if along < 3 else (v, u, along)


def _zigzag(side: int) -> Iterator[int]:
    """Steps of the stow's base, +u, +v, -u, -v as 0 to 3, through square after square of cells."""
    square: list[int] = []
    for row in range(side):
        square += [0 if row % 2 == 0 else 2] * (side - 1)
        square += [1] * (row < side - 1)
    back = [(step + 2) % 4 for step in reversed(square)]
    while True:
        yield from square
        yield INWARDS
        yield from back
        yield INWARDS


def _motion(start: IntArray, moves: list[Row]) -> Motion:
    rows = np.array(moves, np.int32).reshape(-1, 4)
    motion = Motion(start, rows, DIAMETER, MAX_BEND_DEG, False, "folded away")
    *_, last = words(motion)
    goal = start[0] + np.vstack([np.zeros(3, int), DIRECTIONS[last].cumsum(axis=0)])
    straight = bool((last == last[0]).all())
    return Motion(start, rows, DIAMETER, MAX_BEND_DEG, straight, "folded away", goal=goal)
