"""A motion in angles of the block's five joints (Figure 2, Section 8).

Seen from piece i, ball 2i turns hinge i by y1 about the piece's y axis and then by z1 about the z
axis carried along. The next piece is turned about the hinge by x, then by z2 and by y2, so that
ball 2i + 1 looks from piece i + 1 as ball 2i does from piece i, and the chain is the same from both
its ends. With frames as in `words`, F_{i+1} = F_i Ry(y1) Rz(z1) Rx(x) Rz(z2) Ry(y2).

A motion tells where joints go, not how pieces turn about themselves. Here is how that is settled.

- In a PEEL, SWING or DOOR a piece turns with its bar, rigidly. A capsule along the axis of the
  turn, with one part of the chain turning at either end, goes with the end that is bent; where
  both are straight it stays with its bar, and the hinge at the straight end twists (x). So nothing
  slides round in a socket, unless a capsule is bent at both ends, which is against the slots.
- In a TILT, PULL or BEND a capsule turns the shortest way from direction to direction.

Where a hinge stands along the y axis of a piece (z1 = 90 degrees), y1 and x do the same: y1 stays
what it was. If it has to be another for the next move, it changes beforehand and x makes up for it,
while nothing moves: a *flip*. Moves that keep to the slots never need one.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..grid import DIRECTIONS, BoolArray, FloatArray, IntArray
from ..kinematics import Move, moved, on_lattice
from ..solid import Motion
from ..words import bar_frames, block_angles, joint_word

AXES = ("y1", "z1", "x", "y2", "z2")
"""Joints of a block, in the order of Figure 2 and of the columns of angles."""

Y1, Z1, X, Y2, Z2 = range(5)

POLE = 1e-9
BETWEEN = (0.25, 0.5, 0.75)
"""Shares of an exact move at which it is looked at besides its ends."""

_EXACT = (Move.PEEL, Move.SWING, Move.DOOR)


class Station(NamedTuple):
    """A moment of a motion; from each `key` one to the next all angles change evenly."""

    move: int  # -1 before the first
    share: float  # of the move
    key: bool
    pose: FloatArray  # (P, 3)
    pieces: FloatArray  # (n + 1, 3, 3) frames, axes as columns
    angles: FloatArray  # (n, 5) in degrees, columns as AXES


def stations(motion: Motion, substeps: int) -> Iterator[Station]:
    """Moments of a motion in order of time, the first and last of each move among them.

    What a PEEL, SWING or DOOR does between its two key stations is exactly what even angles do.
    Other moves have `substeps` key stations, and angles between are near.

    Raises
    ------
    ValueError
        If the number of joints is odd, or the start is no lattice pose.
    """
    word = joint_word(motion.start)
    frames = bar_frames(word).astype(np.float64)
    pieces = np.concatenate([frames[:1], frames[1::2], frames[-1:]])
    now = Station(
        -1, 1.0, True, motion.start.astype(np.float64), pieces, block_angles(word).astype(float)
    )
    yield now
    for k, row in enumerate(motion.moves):
        for station in _through(motion, k, row, now, substeps):
            if station.key:
                now = station
            yield station


def _through(
    motion: Motion, k: int, row: IntArray, start: Station, substeps: int
) -> Iterator[Station]:
    """The stations of move k, one at its beginning among them if there is a flip."""
    rigid = _rigid(start.pose, row) if row[0] in _EXACT else None
    exact = rigid is not None and is_lattice(start.pieces)
    n_steps = 1 if exact else substeps
    to_lattice = row[0] != Move.BEND or on_lattice(motion.angles[row[3]])
    now = start
    for s in range(1, n_steps + 1):
        places = []
        for share in (*BETWEEN, 1.0) if exact else (s / n_steps,):
            pose = moved(start.pose, row, motion, share)
            pieces = _turned(start.pieces, rigid, share) if rigid else _carried(now, pose)
            if share == 1 and to_lattice:
                pose, pieces = np.rint(pose), _settled(pieces)
            places.append((share, pose, pieces))
        flip = _flip(now, *places[len(places) // 2][1:], k, (s - 1) / n_steps)
        if flip is not None:
            yield flip
            now = flip
        for share, pose, pieces in places:
            angles = resolved(pieces, _hinges(pose), now.angles)
            last = Station(k, share, share == places[-1][0], pose, pieces, angles)
            yield last
        now = last


def _flip(
    now: Station, pose: FloatArray, pieces: FloatArray, k: int, share: float
) -> Station | None:
    """This moment with other y where hinges stand at poles, if the way ahead needs it."""
    ahead = resolved(pieces, _hinges(pose), now.angles)
    angles = now.angles.copy()
    for y, z in ((Y1, Z1), (Y2, Z2)):
        at_pole = np.cos(np.radians(angles[:, z])) < POLE
        angles[at_pole, y] = ahead[at_pole, y]
    if np.allclose(angles, now.angles, rtol=0, atol=1e-9):
        return None
    angles = resolved(now.pieces, _hinges(now.pose), angles)
    return Station(k, share, True, now.pose, now.pieces, angles)


def resolved(pieces: FloatArray, hinges: FloatArray, before: FloatArray) -> FloatArray:
    """Angles (n, 5) in degrees of pieces (n + 1, 3, 3) and hinge directions (n, 3).

    What they leave open, y at a pole and whole turns of x, is as near as can be to `before`.
    """
    angles = np.empty((len(hinges), 5))
    ahead = np.einsum("nij,ni->nj", pieces[:-1], hinges)
    angles[:, Y1], angles[:, Z1] = _bend(ahead, before[:, Y1])
    back = np.einsum("nij,ni->nj", pieces[1:], hinges)
    y2, z2 = _bend(back, -before[:, Y2])
    angles[:, Y2], angles[:, Z2] = -y2, -z2
    first = pieces[:-1] @ about(1, angles[:, Y1]) @ about(2, angles[:, Z1])
    second = pieces[1:] @ about(1, y2) @ about(2, z2)
    twist = np.einsum("nji,njk->nik", first, second)
    x = np.degrees(np.arctan2(twist[:, 2, 1], twist[:, 1, 1]))
    angles[:, X] = x - 360 * np.rint((x - before[:, X]) / 360)
    return angles + 0.0  # no -0


def _bend(hinge: FloatArray, y_before: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The angles y and z that turn x to a direction (n, 3): (cos y cos z, sin z, -sin y cos z)."""
    z = np.degrees(np.arcsin(np.clip(hinge[:, 1], -1, 1)))
    at_pole = np.hypot(hinge[:, 0], hinge[:, 2]) < POLE
    y = np.degrees(np.arctan2(-hinge[:, 2], hinge[:, 0]))
    return np.where(at_pole, y_before, y), z


def about(axis: int, angles_deg: FloatArray) -> FloatArray:
    """Right-handed turns (n, 3, 3) about one of the axes 0, 1, 2."""
    c, s = np.cos(np.radians(angles_deg)), np.sin(np.radians(angles_deg))
    u, v = (axis + 1) % 3, (axis + 2) % 3
    turns = np.zeros((len(angles_deg), 3, 3))
    turns[:, axis, axis] = 1
    turns[:, u, u] = turns[:, v, v] = c
    turns[:, v, u], turns[:, u, v] = s, -s
    return turns


def is_lattice(pieces: FloatArray) -> bool:
    """Whether all axes of all frames lie along those of the lattice."""
    return bool((np.abs(pieces - np.rint(pieces)) < 1e-9).all())


def _hinges(pose: FloatArray) -> FloatArray:
    along: FloatArray = pose[1::2] - pose[0::2]
    return along


def _bars_of_pieces(n_bars: int) -> NDArray[np.intp]:
    """The bar along which each piece lies; an end piece is in line with the hinge beside it."""
    return np.array([0, *range(1, n_bars, 2), n_bars - 1])


class _Rigid(NamedTuple):
    """A quarter turn of some of the pieces."""

    axis: FloatArray  # (3,)
    turning: BoolArray  # (n + 1,)


def _rigid(pose: FloatArray, row: IntArray) -> _Rigid:
    """What a PEEL, SWING or DOOR turns; see above for capsules along its axis."""
    kind, joint, other, value = (int(x) for x in row)
    bars = np.diff(pose, axis=0)
    bar = pose[other] - pose[joint]
    turning = np.zeros(len(bars), bool)
    if kind == Move.DOOR:
        axis = value * bar / np.linalg.norm(bar)
        turning[joint:other] = True
    else:
        axis = np.cross(bar, DIRECTIONS[value])
        beyond = slice(joint, None) if other > joint else slice(None, joint)
        turning[beyond if kind == Move.SWING else min(joint, other)] = True
    along = np.abs(bars @ axis) > 0.5
    capsules = np.arange(1, len(bars) - 1, 2)
    before, after = capsules - 1, capsules + 1
    apart = along[capsules] & (turning[before] != turning[after])
    only_before, only_after = along[after] & ~along[before], along[before] & ~along[after]
    turning[capsules[apart & only_before]] = turning[before[apart & only_before]]
    turning[capsules[apart & only_after]] = turning[after[apart & only_after]]
    return _Rigid(axis, turning[_bars_of_pieces(len(bars))])


def _turned(pieces: FloatArray, rigid: _Rigid, share: float) -> FloatArray:
    angle = share * np.pi / 2
    turned = pieces.copy()
    turned[rigid.turning] = _rotation(rigid.axis, angle) @ pieces[rigid.turning]
    return turned


def _rotation(axis: FloatArray, angle: float) -> FloatArray:
    """Right-handed turn about a unit vector."""
    x, y, z = axis
    cross = np.array([(0, -z, y), (z, 0, -x), (-y, x, 0)])
    turn: FloatArray = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return turn


def _settled(pieces: FloatArray) -> FloatArray:
    """Frames at the end of a move, those on the lattice without rounding errors."""
    whole = np.rint(pieces)
    near = (np.abs(pieces - whole) < 1e-6).all(axis=(1, 2))
    return np.where(near[:, None, None], whole, pieces)


def _carried(now: Station, pose: FloatArray) -> FloatArray:
    """Frames of the pieces in the next pose, each turned the shortest way.

    A capsule that keeps its direction goes with the hinges that lie across it, if they agree.
    """
    bars, before = np.diff(pose, axis=0), np.diff(now.pose, axis=0)
    of = _bars_of_pieces(len(bars))
    pieces = _shortest(before[of], bars[of]) @ now.pieces
    capsules = np.arange(1, len(bars) - 1, 2)
    still = (np.abs(bars[capsules] - before[capsules]) < 1e-12).all(axis=1)
    spins = [
        _spin(before[capsules], before[capsules + side], bars[capsules + side]) for side in (-1, 1)
    ]
    spin = np.where(np.isnan(spins[0]), spins[1], spins[0])
    agree = np.isnan(spins).any(axis=0) | (np.abs(spins[0] - spins[1]) < 1e-9)
    for k in np.flatnonzero(still & agree & ~np.isnan(spin)):
        pieces[k + 1] = _rotation(bars[capsules[k]], spin[k]) @ pieces[k + 1]
    return pieces


def _spin(axes: FloatArray, before: FloatArray, after: FloatArray) -> FloatArray:
    """Angles that bars turn by about axes (n, 3); nan where they do not lie across throughout."""
    across = np.abs(np.einsum("ni,ni->n", axes, before)) + np.abs(
        np.einsum("ni,ni->n", axes, after)
    )
    sine = np.einsum("ni,ni->n", axes, np.cross(before, after))
    angle = np.arctan2(sine, np.einsum("ni,ni->n", before, after))
    return np.where(across < 1e-9, angle, np.nan)


def _shortest(before: FloatArray, after: FloatArray) -> FloatArray:
    """The shortest turns (n, 3, 3) from unit vectors to others, none of them opposite."""
    cross = np.cross(before, after)
    zero = np.zeros(len(cross))
    x, y, z = cross.T
    matrix = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
    cosine = np.einsum("ni,ni->n", before, after)
    turns: FloatArray = np.eye(3) + matrix + matrix @ matrix / (1 + cosine)[:, None, None]
    return turns
