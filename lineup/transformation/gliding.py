"""From shape to shape without a line between: the chain glides out of A and into B (Section 6).

Its track is the path of A, a way through free voxels, and the path of B, so that the chain takes
no more room than the two and the way. Blocks and joints have to allow what `motion.pulling` says.
"""

from collections.abc import Iterator
from itertools import product

import numpy as np

from ..grid import BoolArray, IntArray, bar_directions
from ..kinematics import Move
from ..motion._ways import State, steps_to, strides_of, ways
from ..motion.pulling import MARGIN, U_FREE, WITH_US, has_u
from ..solid import Motion, Obstacles
from .reversal import TURNS

GAPS = range(4)
"""Free voxels between the boxes of the two shapes that are tried."""

NO_WAY = "no way leads from one shape into the other"


def glide(
    a: IntArray,
    b: IntArray,
    obstacles: Obstacles | None = None,
    ends: tuple[int, ...] = (0, 1),
) -> Motion:
    """The chain glides from path `a` into path `b`, where they lie, past obstacles.

    One end leads: the last joint, which leaves A as its end and enters B where B begins, or the
    first, the other way round; the end that needs no U is taken, and then the one with fewer pulls.

    Parameters
    ----------
    a, b : (P, 3) int
        Two paths of one length, of two joints or more, that share no voxel.
    obstacles : Obstacles, optional
        The way leads no further than `MARGIN` voxels past the box of the paths (a straight tail
        left out), or the edge of the grid of obstacles where that is further.
    ends : tuple of int
        Which ends may lead: 0 is the first joint, 1 the last.

    Returns
    -------
    Motion
        Pulls only; `goal` is `b`. Where there is no way, a motion without moves whose `reason`
        says why.

    Raises
    ------
    ValueError
        If the paths differ in length.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> corner = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (1, 2, 0)])
    >>> motion = glide(corner, corner + (0, 0, 2))
    >>> motion.reason, motion.diameter, len(motion)
    ('glides into its goal', 0.914, 8)
    """
    if len(a) != len(b) or len(a) < 2:
        raise ValueError(f"gliding takes two paths of one length from 2 on, got {len(a)}, {len(b)}")
    bars = [bar_directions(path) for path in (a, b)]
    reason = _in_the_way(a, b, obstacles)
    kinds = (WITH_US,) if reason or any(has_u(word) for word in bars) else (U_FREE, WITH_US)
    line_a, line_b = (bool((word == word[0]).all()) for word in bars)
    for kind in kinds if not reason else ():
        found = []
        for end in ends:
            along = slice(None, None, 1 if end else -1)
            values = _led(a[along], b[along], obstacles, u_free=kind == U_FREE)
            if values is not None:
                found.append((values, end * (len(a) - 1)))
        if found:
            values, head = min(found, key=lambda track: len(track[0]))
            rows = [(Move.PULL, head, len(a) - 1 - head, value) for value in values]
            moves = np.array(rows, np.int32)
            return Motion(a, moves, *kind, line_b, "glides into its goal", goal=b)
    nothing = np.empty((0, 4), np.int32)
    return Motion(a, nothing, *kinds[-1], line_a, reason or NO_WAY, goal=b)


def _led(
    a: IntArray, b: IntArray, obstacles: Obstacles | None, *, u_free: bool
) -> list[int] | None:
    """The pulls by the last joint that lead from `a` into `b`, None if there is no way."""
    bends = np.diff(a, n=2, axis=0).any(axis=1)
    coiled = a[min(int(bends.argmax()) if bends.any() else len(a), len(a) - 2) :]
    corner = np.minimum(coiled.min(axis=0), b.min(axis=0)) - MARGIN
    top = np.maximum(coiled.max(axis=0), b.max(axis=0)) + MARGIN
    if obstacles is not None:
        corner = np.minimum(corner, obstacles.origin - 1)
        top = np.maximum(top, obstacles.origin + obstacles.occupancy.shape)
    wall = _grid(corner, top, obstacles)
    shut = wall.copy()
    taken = np.vstack([a, b])
    taken = taken[((taken >= corner) & (taken <= top)).all(axis=1)]
    shut[tuple((taken - corner).T)] = True
    shut = np.pad(shut[1:-1, 1:-1, 1:-1], 1, constant_values=True)
    first, goal = (int(np.ravel_multi_index(tuple(p - corner), shut.shape)) for p in (a[-1], b[0]))
    out: list[int] = bar_directions(a).tolist()
    into: list[int] = bar_directions(b).tolist()
    ends = _entries(wall, goal, into, u_free=u_free)
    closed = shut.ravel()
    closed[first] = False  # for the count of steps; no way leads back to where it starts
    fronts = np.unique(np.nonzero(ends)[1])
    ahead = steps_to(fronts[~closed[fronts]], closed.reshape(shut.shape))
    start: State = (first, out[-1], out[-2] if u_free and len(out) > 1 else out[-1])
    for cells, steps in ways(shut, start, ends, wall, ahead, u_free=u_free):
        closes_u = u_free and ([out[-1], *steps][-2] + 3) % 6 == into[0]
        if len(set(cells)) == len(cells) and not closes_u:
            return steps + into
    return None


def _grid(corner: IntArray, top: IntArray, obstacles: Obstacles | None) -> BoolArray:
    """The obstacles in the box from `corner` to `top`."""
    wall = np.zeros(top - corner + 1, bool)
    if obstacles is not None:
        low = obstacles.origin - corner
        x, y, z = (slice(k, k + n) for k, n in zip(low, obstacles.occupancy.shape, strict=True))
        wall[x, y, z] = obstacles.occupancy
    return wall


def _entries(wall: BoolArray, goal: int, into: list[int], *, u_free: bool) -> BoolArray:
    """From where, and in which direction, a way may enter the path `into` at its cell `goal`."""
    strides = strides_of(wall.shape)
    ends = np.zeros((6, wall.size), bool)
    for d in range(6):
        cell = goal - strides[d]
        u = u_free and len(into) > 1 and (into[1] + 3) % 6 == d
        in_crook = d != into[0] and wall.ravel()[cell + strides[into[0]]]
        ends[d, cell] = not u and not in_crook and (d + 3) % 6 != into[0]
    return ends


def _in_the_way(a: IntArray, b: IntArray, obstacles: Obstacles | None) -> str:
    """Why the chain cannot lie in both paths, "" if it can."""
    if len(np.unique(np.vstack([a, b]), axis=0)) < len(a) + len(b):
        return "the two shapes overlap"
    if obstacles is None:
        return ""
    for name, path in (("A", a), ("B", b)):
        if obstacles.holds(path).any():
            return f"an obstacle is inside shape {name}"
        corner = (path[2:] - 2 * path[1:-1] + path[:-2]).any(axis=1)
        if obstacles.holds((path[:-2] + path[2:] - path[1:-1])[corner]).any():
            return f"an obstacle is in the crook of a corner of shape {name}"
    return ""


def beside(
    a: IntArray, b: IntArray, within: tuple[float, float, float]
) -> Iterator[tuple[IntArray, IntArray]]:
    """Places of `b`, turned, beside `a`, and the sides of the box of both, by its volume.

    All of them leave both in the box `within`.
    """
    room = np.sort(within)
    low, size = a.min(axis=0), np.ptp(a, axis=0) + 1
    places: list[tuple[int, int, IntArray, IntArray]] = []
    for turn in TURNS:
        path = (b @ turn.T).astype(np.int32)
        path -= path.min(axis=0)
        wide = path.max(axis=0) + 1
        for axis, gap, after in product(range(3), GAPS, (False, True)):
            for flush in product((False, True), repeat=2):
                shift = np.where(np.insert(flush, axis, after), size - wide, 0)
                shift[axis] = size[axis] + gap if after else -gap - wide[axis]
                box = np.maximum(size, shift + wide) - np.minimum(0, shift)
                if (np.sort(box) <= room).all():
                    places.append((int(box.prod()), len(places), path + low + shift, box))
    for _, _, path, box in sorted(places, key=lambda place: place[:2]):
        yield path, box
