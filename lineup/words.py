"""A pose of the chain as a word of joint letters, and back, in whole numbers (Figure 2, Section 7).

Bar k joins joints k and k + 1. Its frame F_k has the columns x, y, z, where x is the direction of
the bar. The joint between bars k and k + 1 turns the one frame into the other, F_{k+1} = F_k R[c],
by the smallest turn there is: none (S, straight), or 90 degrees towards +y, -y, +z, -z of bar k
(y, Y, z, Z). A pose is where the first joint is, the first frame, and a letter for each joint
between two bars.

Block i is joints 2i and 2i + 1. Bar 2i is its hinge and bar 2i + 1 is w2 of block i and w1 of
block i + 1, one piece. Of its five degrees of freedom, y1 and z1 bend joint 2i, x turns w2 against
w1 about the hinge, y2 and z2 bend joint 2i + 1. In a lattice pose reached by letters x is 0, and
of y and z at each joint one is 0, just as the slots of the printed block have it (`joints`).
"""

from typing import Any

import numpy as np

from . import grid
from ._record import record
from .solid import Folding, VoxelPath

LETTERS = "SyYzZ"
"""What a joint does: S straight on; y, Y, z, Z to +y, -y, +z, -z of the bar before it."""

BENDS_DEG = {"S": (0, 0), "y": (0, 90), "Y": (0, -90), "z": (-90, 0), "Z": (90, 0)}
"""The same as right-handed angles about y and about z."""

_TURNS = {
    "S": np.eye(3, dtype=np.int32),
    "y": np.array([(0, -1, 0), (1, 0, 0), (0, 0, 1)], np.int32),
    "Y": np.array([(0, 1, 0), (-1, 0, 0), (0, 0, 1)], np.int32),
    "z": np.array([(0, 0, -1), (0, 1, 0), (1, 0, 0)], np.int32),
    "Z": np.array([(0, 0, 1), (0, 1, 0), (-1, 0, 0)], np.int32),
}


@record
class JointWord:
    """A lattice pose of a chain of blocks, told by its joints.

    Attributes
    ----------
    origin : (3,) int32
        Where joint 0 is.
    frame : (3, 3) int32
        Columns: the direction of bar 0, and directions y and z right-handed with it.
    letters : str
        P - 2 of `LETTERS`, one for each joint from 1 to P - 2.

    Raises
    ------
    ValueError
        If the origin is not three integers, the frame is not three lattice directions,
        right-handed, or the letters are odd in number or others.
    """

    origin: grid.IntArray
    frame: grid.IntArray
    letters: str

    def __post_init__(self) -> None:
        object.__setattr__(self, "origin", _whole(self.origin, "origin", (3,)))
        object.__setattr__(self, "frame", _whole(self.frame, "frame", (3, 3)))
        frame = self.frame.astype(np.int64)
        if np.abs(frame).max() > 1 or not _right_handed(frame):
            raise ValueError(
                "the columns of frame must be three lattice directions, right-handed, "
                f"got {self.frame.T.tolist()}"
            )
        unknown = sorted(set(self.letters) - set(LETTERS))
        if unknown:
            raise ValueError(f"unknown letter {unknown[0]!r}; a joint is one of {LETTERS}")
        if len(self.letters) % 2:
            raise ValueError(
                f"{len(self.letters)} letters are of no chain of blocks; "
                "it has two joints a block, and a letter for each but the first and the last"
            )

    def __len__(self) -> int:
        """Number of joints, P."""
        return len(self.letters) + 2


def joint_word(path: VoxelPath | Folding | grid.IntArray) -> JointWord:
    """The joints of a lattice pose (Figure 2).

    Parameters
    ----------
    path : VoxelPath, Folding or (P, 3) int
        Of a folding, its path.

    Returns
    -------
    JointWord
        Its frame is such that the first joint that bends does so to +y, so that a pose turned as
        a whole has the same letters, and a mirrored one the same but for z and Z.

    Raises
    ------
    ValueError
        If the number of voxels is odd or 0, two in a row do not share a face, or the path goes
        straight back on itself.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> path = np.array([(0, 0, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1)])
    >>> lu.joint_word(path).letters
    'yz'
    >>> lu.joint_word(path[:, [2, 0, 1]]).letters
    'yz'
    """
    voxels = _voxels(path)
    steps = grid.DIRECTIONS[grid.bar_directions(voxels)]
    frame = _first_frame(steps)
    word = []
    turned = frame
    for k, step in enumerate(steps[1:].tolist(), start=1):
        letter = _letter(turned.T @ np.array(step, np.int32))
        if letter is None:
            raise ValueError(
                f"the path goes straight back at voxel {k}, and no joint bends by 180 degrees"
            )
        word.append(letter)
        turned = turned @ _TURNS[letter]
    return JointWord(voxels[0], frame, "".join(word))


def forward(word: JointWord) -> grid.IntArray:
    """Positions of the joints of a pose, (P, 3) int32: the inverse of `joint_word`.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> word = lu.JointWord(np.zeros(3, int), np.eye(3, dtype=int), "yy")
    >>> lu.forward(word).tolist()
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    """
    steps = np.vstack([word.origin, bar_frames(word)[:, :, 0]])
    return steps.cumsum(axis=0, dtype=np.int32)


def bar_frames(word: JointWord) -> grid.IntArray:
    """The frame of each bar, (P - 1, 3, 3) int32, its x, y and z as columns.

    Examples
    --------
    >>> import numpy as np
    >>> from lineup.words import JointWord, bar_frames
    >>> frames = bar_frames(JointWord(np.zeros(3, int), np.eye(3, dtype=int), "zS"))
    >>> frames[1, :, 0].tolist()
    [0, 0, 1]
    """
    frames = np.empty((len(word) - 1, 3, 3), np.int32)
    frames[0] = word.frame
    for k, letter in enumerate(word.letters):
        frames[k + 1] = frames[k] @ _TURNS[letter]
    return frames


def block_angles(word: JointWord) -> grid.IntArray:
    """The five angles y1, z1, x, y2, z2 of each block in degrees, (P / 2, 5) int32 (Figure 2).

    The chain's two ends bend nowhere, so the first block has y1 = z1 = 0 and the last y2 = z2 = 0.

    Examples
    --------
    >>> import numpy as np
    >>> from lineup.words import JointWord, block_angles
    >>> block_angles(JointWord(np.zeros(3, int), np.eye(3, dtype=int), "yz")).tolist()
    [[0, 0, 0, 0, 90], [-90, 0, 0, 0, 0]]
    """
    bends = np.array([BENDS_DEG[letter] for letter in f"S{word.letters}S"], np.int32)
    still = np.zeros((len(word) // 2, 1), np.int32)
    return np.hstack([bends[0::2], still, bends[1::2]])


def _voxels(path: VoxelPath | Folding | grid.IntArray) -> grid.IntArray:
    path = path.path if isinstance(path, Folding) else path
    voxels = (path if isinstance(path, VoxelPath) else VoxelPath(path)).voxels
    if not len(voxels) or len(voxels) % 2:
        raise ValueError(
            f"a block is two voxels, so a chain has an even number of them, got {len(voxels)}"
        )
    return voxels


def _first_frame(steps: grid.IntArray) -> grid.IntArray:
    """The frame of the first bar in which the first bend is to +y."""
    x = steps[0]
    across = np.flatnonzero(steps @ x == 0)
    y = steps[across[0]] if len(across) else np.roll(np.abs(x), 1)
    return np.stack([x, y, np.cross(x, y)], axis=1).astype(np.int32)


def _letter(direction: grid.IntArray) -> str | None:
    """The letter that leads to a direction, given in the frame of the bar before it."""
    along, y, z = (int(c) for c in direction)
    if along:
        return "S" if along > 0 else None
    return ("y" if y > 0 else "Y") if y else ("z" if z > 0 else "Z")


def _right_handed(frame: np.ndarray[Any, Any]) -> bool:
    square = np.array_equal(frame.T @ frame, np.eye(3))
    return square and np.array_equal(np.cross(frame[:, 0], frame[:, 1]), frame[:, 2])


def _whole(value: Any, name: str, shape: tuple[int, ...]) -> grid.IntArray:
    array = np.asarray(value)
    if array.shape != shape or not np.issubdtype(array.dtype, np.integer):
        raise ValueError(
            f"{name} must be integers of shape {shape}, got {array.dtype} of shape {array.shape}"
        )
    bounds = np.iinfo(np.int32)
    if not bounds.min <= array.min() <= array.max() <= bounds.max:
        raise ValueError(f"{name} must be from {bounds.min} to {bounds.max}")
    return array.astype(np.int32)
