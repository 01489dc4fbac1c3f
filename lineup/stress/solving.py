"""Displacements at which all is balanced, with sides that only push (Figure 17)."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.linalg import LinAlgError
from scipy.sparse.linalg import splu

from .._record import record
from ..grid import FloatArray, IntArray
from .dissection import Matrix, Parts, Solver, dissected, factorized

BALANCED = 1e-9
"""A force or moment that may be left over on a voxel, as a share of the body's weight."""

_STEPS = 200
_NEAR = 16  # steps of conjugate gradients, which take as long as to factorize anew
_ENOUGH = 0.3  # of the energy norm of the error; the set of points is not the last one
_OPEN = 1e-6  # what keeps a step from running away where nothing else holds a part of the body
_ROUNDING = 8 * float(np.finfo(float).eps)


@record
class Held:
    """A stiffness (6n, 6n), and springs (m,) at the points of contact (m, 6n)."""

    stiffness: Matrix
    contact: Matrix
    springs: FloatArray


def balanced(
    stiffness: Matrix, load: FloatArray, contact: Matrix, share: FloatArray, voxels: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Displacements (6n,) under a load, and the push (m,) at each point of contact, 0 or more.

    The energy ``u K u / 2 - f u + sum of share * min(0, c u)^2 / 2`` is convex, and where it is
    least, points that push are closed and points that are open do not push. Newton's method
    finds the set of points that push; each step goes as far as the energy falls. Factors serve
    for several steps, as long as they lead to the next one quickly.

    Raises
    ------
    ArithmeticError
        If that does not come to an end. A body that does not tip over has a balance.
    """
    u = np.zeros(len(load))
    gap, left = contact @ u, load
    closed = np.ones(len(share), bool)
    held = Held(stiffness, contact, share)
    cut = dissected(voxels, whole(held))
    solve, fresh = solver(whole(held), cut), True
    sizes = abs(stiffness)
    for _ in range(_STEPS):
        step, enough = (solve(left), True) if fresh else _near(held, left, solve)
        lift, own = contact @ step, float(step @ (stiffness @ step))
        u = u + length(float(step @ left), own, gap, lift, share) * step
        gap = contact @ u
        left = load - stiffness @ u - contact.T @ (share * np.minimum(gap, 0))
        limit = max(BALANCED * len(voxels), _ROUNDING * float((sizes @ np.abs(u)).max()))
        if np.abs(left).max() <= limit:
            return u, share * np.maximum(-gap, 0)
        before, closed = closed, gap < 0
        same = np.array_equal(closed, before)
        held = Held(stiffness, contact, share * np.where(closed, 1.0, _OPEN))
        fresh = fresh and same
        if not fresh and (same or not enough):
            solve, fresh = solver(whole(held), cut), True
    raise ArithmeticError(
        f"no balance found in {_STEPS} steps; {np.abs(left).max():.1e} voxel weights are left over"
    )


def _near(held: Held, load: FloatArray, solve: Solver) -> tuple[FloatArray, bool]:
    """A step towards the solution of a system by what solves a like one, and if it is enough.

    Conjugate gradients, which the factors of a like system lead there quickly. It is a step
    along which the energy falls also where they have not come far.
    """
    found, left = np.zeros(len(load)), load
    way = towards = solve(left)
    start = pull = float(left @ towards)
    for _ in range(_NEAR):
        pushed = held.stiffness @ way + held.contact.T @ (held.springs * (held.contact @ way))
        share = pull / float(way @ pushed)
        found = found + share * way
        left = left - share * pushed
        towards = solve(left)
        before, pull = pull, float(left @ towards)
        if pull <= _ENOUGH**2 * start:
            return found, True
        way = towards + pull / before * way
    return found, False


def whole(held: Held) -> Matrix:
    """The stiffness with that of the springs."""
    return held.stiffness + held.contact.T @ sparse.diags(held.springs) @ held.contact


def length(pull: float, own: float, gap: FloatArray, lift: FloatArray, share: FloatArray) -> float:
    """How far along a step the energy is least: 1, or less or more where points lift or touch.

    The slope of the energy is -pull at first. It rises by `own` a step, and by as much as the
    points push that are closed, so it is made of straight pieces.
    """
    push = share * lift**2
    rise = own + float(push[(gap < 0) | ((gap == 0) & (lift < 0))].sum())
    turn = np.divide(-gap, lift, out=np.zeros(len(gap)), where=lift != 0)
    order = np.argsort(turn, kind="stable")
    order = order[turn[order] > 0]
    turns = np.concatenate([[0.0], turn[order]])
    rises = rise + np.concatenate([[0.0], np.cumsum((-np.sign(lift) * push)[order])])
    slopes = np.concatenate([[0.0], np.cumsum(rises[:-1] * np.diff(turns))]) - pull
    last = max(int(np.searchsorted(slopes, 0.0)) - 1, 0)
    return float(turns[last] - slopes[last] / rises[last]) if rises[last] > 0 else 1.0


def solver(matrix: Matrix, cut: Parts) -> Solver:
    """What solves a system for any load.

    The chain alone is nearly a band and so soft that Cholesky factors may not exist for rounding;
    it has others.
    """
    if len(matrix.tobsr((6, 6)).indices) <= 3 * len(cut.order):
        return _by_pivots(matrix)
    try:
        return factorized(cut, matrix)
    except LinAlgError:
        return _by_pivots(matrix)


def _by_pivots(matrix: Matrix) -> Solver:
    factors = splu(
        matrix.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    solve: Solver = factors.solve
    return solve
