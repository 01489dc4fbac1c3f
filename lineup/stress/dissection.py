"""Cholesky factors of systems on voxels, cut apart again and again (nested dissection).

A layer of voxels parts a body in two that know nothing of each other. Each of the two is cut in
the same way, down to a few voxels; then unknowns are eliminated from the smallest part up, as
George and Liu (Computer Solution of Large Sparse Positive Definite Systems, 1981) do on a grid.
Each part is a dense block (Duff and Reid's multifrontal method, ACM TOMS 9, 1983), so nearly all
of the time goes into products of matrices.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from .._jit import kernel
from .._record import record
from ..grid import FloatArray, IntArray

Matrix = Any  # scipy.sparse.csr_matrix, which is generic in some versions only
Solver = Callable[[FloatArray], FloatArray]
Indices = NDArray[np.int64]

Strip = tuple[FloatArray, FloatArray]
"""Up to `TILE` columns of the factor: the inverse of the triangle there, and the rows below it."""

SMALL = 24
"""Voxels that are cut no further; at least 8."""

TILE = 64
"""Rows and columns of the products of matrices. Libraries multiply small ones in one thread; they
split larger ones, and threads that wait for each other take several times as long in all."""


@record
class Part:
    """Some voxels that are eliminated at one go, in places of the order of elimination.

    Attributes
    ----------
    start, stop : int
        Its own places are start ... stop - 1.
    border : (k,) int64
        Places beyond `stop` that elimination up to here has tied to it, sorted.
    below : tuple of int
        Numbers of the parts next to it that are eliminated before.
    """

    start: int
    stop: int
    border: Indices
    below: tuple[int, ...]


@record
class Parts:
    """How a body is cut apart: the voxel at each place (n,), and the parts in their order."""

    order: Indices
    parts: tuple[Part, ...]


def dissected(voxels: IntArray, matrix: Matrix) -> Parts:
    """How a body is cut apart for a matrix (6n, 6n) that couples only voxels that share a face."""
    cuts: list[tuple[Indices, tuple[int, ...]]] = []
    _cut(voxels.astype(np.int64), np.arange(len(voxels)), cuts)
    order = np.concatenate([own for own, _ in cuts])
    place = np.argsort(order)
    blocks = matrix.tobsr((6, 6))
    ties = sparse.csr_matrix((np.ones(len(blocks.indices)), blocks.indices, blocks.indptr))
    parts: list[Part] = []
    stop = 0
    for own, below in cuts:
        start, stop = stop, stop + len(own)
        tied = np.concatenate([place[ties[own].indices], *(parts[k].border for k in below)])
        parts.append(Part(start, stop, np.unique(tied[tied >= stop]), below))
    return Parts(order, tuple(parts))


def factorized(cut: Parts, matrix: Matrix) -> Solver:
    """What solves a symmetric positive definite system (6n, 6n) for any load (6n,).

    Raises
    ------
    LinAlgError
        If the matrix is not positive definite, or only just.
    """
    unknown = _unknowns(cut.order)
    place = np.argsort(unknown)
    rows = matrix[unknown].tocsr()
    places = [
        _unknowns(np.concatenate([np.arange(part.start, part.stop), part.border]))
        for part in cut.parts
    ]
    where, size = _where(cut.parts, places)
    values, beyond = np.empty(size), np.concatenate(places)
    strips = [_strip(values, *row) for row in where[:, :3].tolist()]
    left: dict[int, FloatArray] = {}
    done = 0
    for number, part in enumerate(cut.parts):
        front = _front(part, places[number], rows, place)
        for k in part.below:
            at = np.searchsorted(places[number], _unknowns(cut.parts[k].border))
            add_lower(front, left.pop(k), at)
        own = 6 * (part.stop - part.start)
        count = -(-own // TILE)
        _eliminate(front, own, strips[done : done + count])
        done += count
        left[number] = np.ascontiguousarray(front[own:, own:])

    def solve(load: FloatArray) -> FloatArray:
        x = load[unknown]
        solve_in_place(x, values, where, beyond)
        return x[place]

    return solve


def _where(parts: tuple[Part, ...], places: list[Indices]) -> tuple[Indices, int]:
    """Where each strip is among the values of the factor, and how many these are.

    A row (5) each: its first value, its columns, the rows below, its first place, and where in all
    `places` those of the rows below begin.
    """
    found: list[tuple[int, int, int, int, int]] = []
    at = before = 0
    for part, those in zip(parts, places, strict=True):
        own = 6 * (part.stop - part.start)
        for start, stop in pairwise([*range(0, own, TILE), own]):
            columns, below = stop - start, len(those) - stop
            found.append((at, columns, below, 6 * part.start + start, before + stop))
            at += columns * (columns + below)
        before += len(those)
    return np.array(found), at


@kernel
def _strip(values: FloatArray, at: int, columns: int, below: int) -> Strip:
    """The two matrices of a strip, which are places in `values`."""
    middle = at + columns * columns
    inverse = values[at:middle].reshape(columns, columns)
    return inverse, values[middle : middle + columns * below].reshape(below, columns)


def _cut(
    voxels: Indices, which: Indices, cuts: list[tuple[Indices, tuple[int, ...]]]
) -> tuple[int, ...]:
    """Append the parts of some voxels, what is eliminated first first; the numbers of the last.

    There is more than one last part where a layer is empty.
    """
    below: tuple[int, ...] = ()
    if len(which) > SMALL:
        axis, level = _layer(voxels[which])
        at = voxels[which, axis]
        below = _cut(voxels, which[at < level], cuts) + _cut(voxels, which[at > level], cuts)
        which = which[at == level]
        if not len(which):
            return below
    cuts.append((which, below))
    return (len(cuts) - 1,)


def _layer(voxels: Indices) -> tuple[int, int]:
    """Axis and coordinate of a layer with few voxels and many on both its sides."""
    best = (np.inf, 0, 0)
    for axis, at in enumerate(voxels.T):
        count = np.bincount(at - at.min())
        before = np.cumsum(count) - count
        after = len(at) - before - count
        with np.errstate(divide="ignore"):
            cost = count / (before * after)
        level = int(cost.argmin())
        best = min(best, (float(cost[level]), axis, level + int(at.min())))
    return best[1], best[2]


def _unknowns(places: Indices) -> Indices:
    """The six unknowns of each."""
    found: Indices = (6 * places[:, None] + np.arange(6)).ravel()
    return found


def _front(part: Part, places: Indices, rows: Matrix, place: Indices) -> FloatArray:
    """The matrix of a part and its border, of which the lower triangle counts and that of the
    border with itself is still to come."""
    front = np.zeros((len(places), len(places)))
    first, own = 6 * part.start, 6 * (part.stop - part.start)
    ends = rows.indptr[first : first + own + 1]
    to = place[rows.indices[ends[0] : ends[-1]]]
    later = to >= first
    at = np.repeat(np.arange(own), np.diff(ends))[later]
    front[np.searchsorted(places, to[later]), at] = rows.data[ends[0] : ends[-1]][later]
    return front


def _eliminate(front: FloatArray, own: int, strips: list[Strip]) -> None:
    """Write the factor's columns of the first `own` unknowns; the rest of `front` is what they
    leave."""
    size = len(front)
    for number, (start, stop) in enumerate(
        pairwise([*range(0, own, TILE), *range(own, size, TILE), size])
    ):
        column = np.ascontiguousarray(front[start:, start:stop])
        for k, (_, below) in enumerate(strips[:number]):
            known = below[start - min((k + 1) * TILE, own) :]
            column -= _times(known, known[: stop - start].T)
        if start < own:
            inverse, below = strips[number]
            inverse[:] = np.linalg.inv(np.linalg.cholesky(column[: stop - start]))
            below[:] = _times(column[stop - start :], inverse.T)
        else:
            front[start:, start:stop] = column


def _times(a: FloatArray, b: FloatArray) -> FloatArray:
    """a @ b, tile by tile."""
    whole = len(a) - len(a) % TILE
    product = np.empty((len(a), b.shape[1]))
    np.matmul(_tiles(a[:whole]), b, out=_tiles(product[:whole]))
    product[whole:] = a[whole:] @ b
    return product


def _tiles(a: FloatArray) -> FloatArray:
    """Rows in groups of as many as a tile has; no copy where rows are next to each other."""
    return a.reshape(-1, TILE, *a.shape[1:])


@kernel
def add_lower(front: FloatArray, left: FloatArray, at: Indices) -> None:
    """Add the lower triangle of a matrix to rows and columns `at`, ascending, of another."""
    for i in range(len(at)):
        for j in range(i + 1):
            front[at[i], at[j]] += left[i, j]


@kernel
def solve_in_place(x: FloatArray, values: FloatArray, where: Indices, beyond: Indices) -> None:
    """Solve for a load `x`, in the order of elimination, with the strips that `where` finds."""
    for at, columns, below, first, after in where:
        own, rest = x[first : first + columns], beyond[after : after + below]
        inverse, rows = _strip(values, at, columns, below)
        known = np.zeros(columns)
        for i in range(columns):
            for j in range(i + 1):
                known[i] += inverse[i, j] * own[j]
        own[:] = known
        for i in range(below):
            total = 0.0
            for j in range(columns):
                total += rows[i, j] * known[j]
            x[rest[i]] -= total
    for at, columns, below, first, after in where[::-1]:
        own, rest = x[first : first + columns], beyond[after : after + below]
        inverse, rows = _strip(values, at, columns, below)
        known = own.copy()
        for i in range(below):
            factor = x[rest[i]]
            for j in range(columns):
                known[j] -= rows[i, j] * factor
        own[:] = 0
        for i in range(columns):
            for j in range(i + 1):
                own[j] += inverse[i, j] * known[i]
