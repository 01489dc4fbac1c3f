"""Displacements at which all is balanced, with sides that only push (Figure 17)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy import sparse
from scipy.optimize import brentq
from scipy.sparse.linalg import splu

from ..grid import BoolArray, FloatArray, IntArray
from .network import Matrix, modes

DIRECT = 2000
"""Voxels up to which a system is factorized; beyond, multigrid is faster and lighter."""

BALANCED = 1e-9
"""A force or moment that may be left over on a voxel, as a share of the body's weight."""

_STEPS = 200
_OPEN = 1e-6  # what keeps a step from running away where nothing else holds a part of the body
_RELATIVE = 1e-9
_ROUNDING = 8 * float(np.finfo(float).eps)

Solver = Callable[[FloatArray], FloatArray]


def balanced(
    stiffness: Matrix, load: FloatArray, contact: Matrix, share: FloatArray, voxels: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Displacements (6n,) under a load, and the push (m,) at each point of contact, 0 or more.

    The energy ``u K u / 2 - f u + sum of share * min(0, c u)^2 / 2`` is convex, and where it is
    least, points that push are closed and points that are open do not push. Newton's method
    finds the set of points that push; each step goes as far as the energy falls.

    Raises
    ------
    ArithmeticError
        If that does not come to an end. A body that does not tip over has a balance.
    """
    u = np.zeros(len(load))
    gap, left = contact @ u, load
    closed = np.ones(len(share), bool)
    sliding = bool((np.diff(contact.indptr) > 6).any())  # points between two voxels
    solve = solver(_held(stiffness, contact, share, closed), voxels, sliding)
    sizes = abs(stiffness)
    for _ in range(_STEPS):
        step = solve(left)
        u = u + _length(float(step @ left), step, stiffness, gap, contact @ step, share) * step
        gap = contact @ u
        left = load - stiffness @ u - contact.T @ (share * np.minimum(gap, 0))
        limit = max(BALANCED * len(voxels), _ROUNDING * float((sizes @ np.abs(u)).max()))
        if np.abs(left).max() <= limit:
            return u, share * np.maximum(-gap, 0)
        if not np.array_equal(gap < 0, closed):
            closed = gap < 0
            solve = solver(_held(stiffness, contact, share, closed), voxels, sliding)
    raise ArithmeticError(
        f"no balance found in {_STEPS} steps; {np.abs(left).max():.1e} voxel weights are left over"
    )


def _held(stiffness: Matrix, contact: Matrix, share: FloatArray, closed: BoolArray) -> Matrix:
    """The stiffness with that of the points that push."""
    springs = sparse.diags(share * np.where(closed, 1.0, _OPEN))
    return stiffness + contact.T @ springs @ contact


def _length(
    pull: float,
    step: FloatArray,
    stiffness: Matrix,
    gap: FloatArray,
    lift: FloatArray,
    share: FloatArray,
) -> float:
    """How far along a step the energy falls: 1, or less or more where points lift or touch."""
    own = float(step @ (stiffness @ step))
    before = np.minimum(gap, 0)

    def slope(t: float) -> float:
        change = share * (np.minimum(gap + t * lift, 0) - before)
        return t * own - pull + float(change @ lift)

    if abs(slope(1.0)) <= _RELATIVE * abs(pull):
        return 1.0
    end = 1.0
    while slope(end) < 0:
        end *= 2
        if end > 2**40:
            return 1.0
    return float(brentq(slope, 0.0, end, xtol=1e-14, rtol=1e-12))


def solver(matrix: Matrix, voxels: IntArray, sliding: bool = False) -> Solver:
    """What solves a system for any load: a factorization, or multigrid for large bodies.

    Multigrid is smoothed aggregation with the six rigid movements, inside conjugate gradients;
    where that does not come to an end, as with bonds of very unlike stiffness, the system is
    factorized. So it is from the first where strands can slide along each other, which multigrid
    is slow with, and for the chain alone, which is factorized quickly at any length.
    """
    blocks = matrix.tobsr((6, 6))
    if sliding or len(voxels) <= DIRECT or len(blocks.indices) <= 3 * len(voxels):
        return _factorized(matrix)
    import pyamg  # takes seconds, which small bodies need not wait for

    levels = pyamg.smoothed_aggregation_solver(
        blocks,
        B=modes(voxels),
        strength=("symmetric", {"theta": 0.0}),
        smooth=("jacobi", {"omega": 4 / 3, "weighting": "local"}),
        max_coarse=300,
    )
    direct: list[Solver] = []

    def solve(load: FloatArray) -> FloatArray:
        if not direct:
            found: FloatArray = levels.solve(load, tol=_RELATIVE, accel="cg", maxiter=400)
            if np.linalg.norm(matrix @ found - load) <= 10 * _RELATIVE * np.linalg.norm(load):
                return found
            direct.append(_factorized(matrix))
        return direct[0](load)

    return solve


def _factorized(matrix: Matrix) -> Solver:
    factors = splu(
        matrix.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    solve: Solver = factors.solve
    return solve
