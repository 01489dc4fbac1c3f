"""The block's slots, and which moves they do not let a chain make (Section 7, Figures 2 and 16).

Joints 2i and 2i + 1 are block i. Bar 2i, inside it, is the hinge: a round bar with a ball at each
end. Bar 2i + 1, between blocks, is a capsule: w2 of one block and w1 of the next, printed as one
rigid piece. A ball sits in each hemispherical end of a capsule, and its hinge leaves through the
hole at the pole, where the joint is straight, or through one of four slots from there to the
equator, a quarter turn apart, where it is bent. The slots of both ends lie in the same two planes.
So, seen from the capsule, of the bends (y, z) of a hinge one is 0; a hinge turns freely about
itself, and so do the single voxels at the chain's two ends.

While one end of a capsule is bent, the capsule turns about itself with that bend's plane; while
none is, as it likes. While both are, the angle about the capsule from one plane to the other must
stay a multiple of 90 degrees, and so stay the same: it cannot twist. Nothing else is asked, and
every lattice pose keeps to it. `free` joints bend in any plane, as the paper's five axes let them.
"""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from . import grid
from .kinematics import QUARTER, Move, frames, moved
from .solid import Motion

JOINTS = ("free", "slotted")
"""Joint models that `certify` judges by: the paper's five axes, or the slots of Figure 16."""

_GENERIC = (0.37, 0.61)  # moments of a move, none at which planes are square by chance
_SQUARE = 1e-6


def slot_violations(motion: Motion) -> grid.IntArray:
    """Capsules that would have to twist between two bent joints, move by move.

    Parameters
    ----------
    motion : Motion
        Of an even number of joints; what `certify` accepts but for the slots.

    Returns
    -------
    (V, 2) int32
        Rows (move, bar) in order; `bar` is odd.

    Raises
    ------
    ValueError
        If the number of joints is odd, or a move cannot be carried out.

    Notes
    -----
    A PEEL, SWING or DOOR turns one part of the chain against another about a lattice line through
    a joint. The capsule at that joint twists just if it lies along that line and the hinges at
    both its ends lie across. In a TILT and in a PULL all bars turn; whether planes stay square is
    then seen at two generic moments. A BEND twists a capsule along its axis if the hinges at its
    ends do not turn together, at a multiple of 90 degrees.

    Examples
    --------
    >>> import numpy as np
    >>> from lineup import Motion
    >>> from lineup.kinematics import Move
    >>> crank = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (1, 1, 1)])
    >>> turn = np.array([(Move.SWING, 2, 3, 0)])  # the last hinge, about the capsule
    >>> slot_violations(Motion(crank, turn, 1.0, 90.0, False, "turned"))
    array([[0, 1]], dtype=int32)
    """
    if len(motion.start) % 2:
        raise ValueError(f"a chain of blocks has an even number of joints, got {len(motion.start)}")
    rows = [
        (k, bar)
        for k, ((pose, _), move) in enumerate(
            zip(pairwise(frames(motion)), motion.moves, strict=True)
        )
        for bar in _twisted(pose, move, motion)
    ]
    return np.array(rows, np.int32).reshape(-1, 2)


def _twisted(pose: grid.FloatArray, move: grid.IntArray, motion: Motion) -> list[int]:
    kind, joint, other, value = (int(x) for x in move)
    match kind:
        case Move.TILT:
            bars = np.diff(moved(pose, move, motion, _GENERIC[0]), axis=0)
            return _capsules(_not_square(bars[:-2], bars[1:-1], bars[2:]))
        case Move.PULL:
            return _twisted_by_pull(pose, joint, value)
        case Move.BEND:
            along = np.abs(np.diff(pose[:, joint])) > 0.5
            return _twisted_by_bend(along, motion.angles[other], motion.angles[value])
        case _:
            return _twisted_at_hinges(pose, kind, joint, other, value)


def _capsules(at_inner_bar: NDArray[np.bool_]) -> list[int]:
    """Odd bars of which something holds, from the same for bars 1, 2, ..., P - 3."""
    return [bar for bar in (np.flatnonzero(at_inner_bar) + 1).tolist() if bar % 2]


def _not_square(
    before: grid.FloatArray, bars: grid.FloatArray, after: grid.FloatArray
) -> NDArray[np.bool_]:
    """Whether the bars before and after (n, 3) unit bars bend in planes that are not square."""
    sides = [side - (side * bars).sum(axis=1, keepdims=True) * bars for side in (before, after)]
    along = np.abs((sides[0] * sides[1]).sum(axis=1))
    across = np.abs((np.cross(sides[0], sides[1]) * bars).sum(axis=1))
    oblique: NDArray[np.bool_] = np.minimum(along, across) > _SQUARE
    return oblique


def _twisted_at_hinges(
    pose: grid.FloatArray, kind: int, joint: int, other: int, value: int
) -> list[int]:
    turning = int(np.abs(pose[other] - pose[joint]).argmax())
    axis = turning if kind == Move.DOOR else 3 - turning - value % 3
    twisted = []
    for hinge in (joint,) if kind == Move.SWING else (joint, other):
        capsule = hinge - 1 + hinge % 2
        if 0 < hinge < len(pose) - 1:
            near = np.abs(np.diff(pose[capsule - 1 : capsule + 3, axis]))
            if (np.rint(near) == (0, 1, 0)).all():
                twisted.append(capsule)
    return sorted(twisted)


def _twisted_by_pull(pose: grid.FloatArray, head: int, value: int) -> list[int]:
    """The end of each bar goes on along the next, past a corner as `kinematics` says of a PULL."""
    joints = pose if head else pose[::-1]  # the head last
    track = np.rint(np.vstack([np.diff(joints, axis=0), grid.DIRECTIONS[value]]))
    corner = (track[1:] != track[:-1]).any(axis=1)
    oblique = np.zeros(max(len(track) - 3, 0), bool)
    for phase in _GENERIC:
        ahead = np.where(corner, np.sqrt(phase * (2 - phase)), phase)
        behind = np.where(corner, phase**2 / (1 + np.sqrt(1 - phase**2)), phase)
        beyond = np.where(corner[2:], np.sqrt(ahead[1:-1] * (2 - ahead[1:-1])), ahead[1:-1])
        phases = (behind[:-2], np.full(len(oblique), phase), ahead[1:-1], beyond)
        bars = [
            (1 - p)[:, None] * track[k : k + len(oblique)]
            + q[:, None] * track[k + 1 : k + 1 + len(oblique)]
            for k, (p, q) in enumerate(pairwise(phases))
        ]
        oblique |= _not_square(bars[0], bars[1], bars[2])
    return _capsules(oblique if head else oblique[::-1])


def _twisted_by_bend(
    along: NDArray[np.bool_], before: grid.IntArray, after: grid.IntArray
) -> list[int]:
    between = along[1:-1] & ~along[:-2] & ~along[2:]
    starts, stops = (row[2:].astype(np.int64) - row[:-2] for row in (before, after))
    return _capsules(between & ((starts % QUARTER != 0) | (starts != stops)))
