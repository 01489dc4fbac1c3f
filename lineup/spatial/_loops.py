"""Closed lattice polygons: the shapes, and where in a solid they fit."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import grid

LENGTHS = (4, 6, 8)
"""Numbers of sides of the polygons; there are 3, 22 and 207 shapes."""

Point = tuple[int, int, int]

_STEPS: list[Point] = [(int(x), int(y), int(z)) for x, y, z in grid.DIRECTIONS]


class Loops(NamedTuple):
    """The polygons of a solid, on its flat cells, sorted by number of sides.

    ``anchor[k]`` is the first corner of polygon k and ``shape[k]`` its shape; polygons of
    ``LENGTHS[i]`` sides are ``first[i] .. first[i + 1]``. Corner c of shape s is ``offset[s, c]``
    cells from the anchor, and side c leads from there along ``direction[s, c]``.
    """

    anchor: NDArray[np.int32]
    shape: NDArray[np.int16]
    first: NDArray[np.int64]
    n_sides: NDArray[np.int64]
    offset: NDArray[np.int64]
    direction: NDArray[np.int64]


@cache
def polygons(n_sides: int) -> tuple[tuple[Point, ...], ...]:
    """Corners of every simple lattice polygon, once each, from its least corner at the origin."""
    found: list[tuple[Point, ...]] = []
    _grow([(0, 0, 0)], n_sides, found)
    return tuple(sorted(found))


def _grow(corners: list[Point], n_sides: int, found: list[tuple[Point, ...]]) -> None:
    x, y, z = corners[-1]
    n_left = n_sides - len(corners)
    if n_left == 0:
        if abs(x) + abs(y) + abs(z) == 1 and corners[1] < corners[-1]:  # of two ways round, one
            found.append(tuple(corners))
        return
    for a, b, c in _STEPS:
        corner = x + a, y + b, z + c
        near = abs(corner[0]) + abs(corner[1]) + abs(corner[2]) <= n_left
        if near and corner > corners[0] and corner not in corners:
            _grow([*corners, corner], n_sides, found)


def loops_of(inside: grid.BoolArray, stride: NDArray[np.int64]) -> Loops:
    """All polygons whose corners are cells of a padded flat grid with steps `stride`."""
    shapes = [corners for n in LENGTHS for corners in polygons(n)]
    offset = np.zeros((len(shapes), max(LENGTHS)), np.int64)
    direction = np.zeros_like(offset)
    cells = np.flatnonzero(inside)
    anchors, kinds, first = [], [], [0]
    for s, corners in enumerate(shapes):
        points = np.array(corners)
        n = len(points)
        offset[s, :n] = points @ stride[:3]
        direction[s, :n] = grid.bar_directions(np.vstack([points, points[:1]]))
        fits = cells
        for step in offset[s, 1:n]:  # one by one, since the step after a corner stays in the grid
            fits = fits[inside[fits + step]]
        anchors.append(fits.astype(np.int32))
        kinds.append(np.full(len(fits), s, np.int16))
        if s + 1 == len(shapes) or len(shapes[s + 1]) > n:
            first.append(sum(map(len, anchors)))
    return Loops(
        np.concatenate(anchors),
        np.concatenate(kinds),
        np.array(first),
        np.array([len(corners) for corners in shapes]),
        offset,
        direction,
    )
