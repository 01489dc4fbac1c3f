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
"""A hinge's direction is at a pole of the angles if it is as near as this to it."""

BETWEEN = (0.25, 0.5, 0.75)
"""Shares of a step at which it is looked at besides its ends."""

EVEN = 1e-7
"""Degrees by which angles in the midst of a step may differ from those of an even change."""


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

    A move that angles do which all change evenly, as any PEEL, SWING and DOOR from a pose with
    frames on the lattice, is one step from key station to key station. Others have `substeps`
    even steps, in the midst of which even angles are near.

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
            yield station
        now = station


def _through(motion: Motion, k: int, row: IntArray, start: Station, substeps: int) -> list[Station]:
    """The stations of move k: in one step if angles that change evenly do what it does."""
    whole = _steps(motion, k, row, start, 1)
    first, last = (start if whole[0].share > 0 else whole[0]), whole[-1]
    turn = last.angles - first.angles
    uneven = [s.angles - first.angles - s.share * turn for s in whole if s.share > 0]
    return whole if np.abs(uneven).max() < EVEN else _steps(motion, k, row, start, substeps)


def _steps(motion: Motion, k: int, row: IntArray, start: Station, n_steps: int) -> list[Station]:
    """The stations of move k in even steps, and where there is a flip one before a step."""
    rigid = _rigid(start.pose, row) if row[0] in (Move.PEEL, Move.SWING, Move.DOOR) else None
    to_lattice = row[0] != Move.BEND or on_lattice(motion.angles[row[3]])
    shares = np.array([*BETWEEN, 1.0])
    now, found = start, list[Station]()
    for s in range(n_steps):
        places, near = [], (now.pose, now.pieces)
        for share in ((s + shares) / n_steps).tolist():
            pose = moved(start.pose, row, motion, share)
            pieces = _turned(start.pieces, rigid, share) if rigid else _carried(*near, pose)
            if share == 1 and to_lattice:
                pose, pieces = np.rint(pose), _settled(pieces)
            near = pose, pieces
            places.append((share, pose, pieces))
        flip = _flip(now, *places[1][1:], k, s / n_steps)
        if flip is not None:
            found.append(flip)
            now = flip
        for share, pose, pieces in places:
            angles = resolved(pieces, _hinges(pose), now.angles)
            found.append(Station(k, share, share == places[-1][0], pose, pieces, angles))
        now = found[-1]
    return found


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
    return np.round(angles, 12) + 0.0  # no -0


def _bend(hinge: FloatArray, y_before: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The angles y and z that turn x to a direction (n, 3): (cos y cos z, sin z, -sin y cos z)."""
    from_pole = np.hypot(hinge[:, 0], hinge[:, 2])
    at_pole = from_pole < POLE
    z = np.degrees(np.arctan2(hinge[:, 1], from_pole))
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
    near = (np.abs(pieces - whole) < 1e-6).all(axis=(1, 2), keepdims=True)
    return np.where(near, whole, pieces)


def _carried(last: FloatArray, frames: FloatArray, pose: FloatArray) -> FloatArray:
    """Frames of the pieces in a pose near the last, each turned the shortest way.

    A capsule that keeps its direction goes with the hinges that lie across it, if they agree.
    """
    bars, before = np.diff(pose, axis=0), np.diff(last, axis=0)
    of = _bars_of_pieces(len(bars))
    pieces = _shortest(before[of], bars[of]) @ frames
    capsules = np.arange(1, len(bars) - 1, 2)
    still = (np.abs(bars[capsules] - before[capsules]) < 1e-12).all(axis=1)
    spins = [
        _spin(before[capsules], before[capsules + side], bars[capsules + side]) for side in (-1, 1)
    ]
    spin = np.where(np.isnan(spins[0]), spins[1], spins[0])
    differ = np.abs(spins[0] - spins[1]) >= 1e-9  # no where one of them is nan
    for k in np.flatnonzero(still & ~differ & ~np.isnan(spin)):
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
