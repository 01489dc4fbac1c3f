"""The judge of paths: simple, even, inside the solid, and truly described (Section 4)."""

import numpy as np
from numpy.typing import NDArray

from .. import grid
from .._record import of_kind
from ..solid import Certificate, VoxelPath, VoxelSolid
from ._lattice import not_simple


def certify_path(path: VoxelPath, solid: VoxelSolid, u_free: bool = False) -> Certificate:
    """Judge a path: simple, even, inside the solid, and truly described (Section 4).

    The voxels must be face-adjacent voxels of the solid refined `path.refinement` times, none
    visited twice, an even number of them; `dropped` must be exactly the rest, in lexicographic
    order. If there are `visits`, they must be the maximal runs of the path inside one layer
    component each, give no two components the same piece number, nest like brackets (never
    piece A, B, A, B), come back to a piece beside the voxel where they left it (Section 4.2,
    Case 2), and count in `depth` the pieces visited both before and after. Those of depth 0, the
    MSP, must lie in different components.

    Parameters
    ----------
    u_free : bool
        Ask as well that no three consecutive links are sides of one unit square, and that one
        end can leave the solid along a lattice ray without such a U: what pulling the chain out
        by that end takes.

    Returns
    -------
    Certificate
        `where` is the step of the path that fails, -1 where none does.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> solid = lu.VoxelSolid(np.ones((2, 1, 1), bool))
    >>> lu.certify_path(lu.VoxelPath(np.array([(0, 0, 0), (1, 0, 0)])), solid).reason
    'certified'
    """
    of_kind(path, VoxelPath)
    of_kind(solid, VoxelSolid)
    for check in (_path_fault, _inside_fault, _visits_fault, *([_u_fault] if u_free else [])):
        reason, where = check(path, solid)
        if reason:
            return Certificate(ok=False, reason=reason, where=where)
    return Certificate(ok=True, reason="certified")


def _path_fault(path: VoxelPath, solid: VoxelSolid) -> tuple[str, int]:
    reason, where = not_simple(path.voxels.astype(np.int64))
    if not reason and len(path) % 2:
        return f"{len(path)} voxels, not an even number", len(path) - 1
    return reason, where


def _inside_fault(path: VoxelPath, solid: VoxelSolid) -> tuple[str, int]:
    if path.refinement < 1:
        return f"refinement {path.refinement} is not a positive number", -1
    n_refined, n_told = solid.size * path.refinement**3, len(path) + len(path.dropped)
    if path.refinement > 1 and n_refined != n_told:  # before a grid of that many is made
        return f"the refined solid has {n_refined} voxels, path and dropped have {n_told}", -1
    occupancy = _refined(solid, path.refinement)
    voxels = path.voxels
    in_range = np.logical_and.reduce((voxels >= 0) & (voxels < occupancy.shape), axis=1)
    inside: grid.BoolArray = in_range & occupancy[tuple(np.where(in_range[:, None], voxels, 0).T)]
    if not inside.all():
        k = int(np.flatnonzero(~inside)[0])
        return f"voxel {tuple(voxels[k].tolist())} of step {k} is outside the solid", k
    occupancy[tuple(voxels.T)] = False
    rest = np.argwhere(occupancy)
    if not np.array_equal(rest, path.dropped):
        return (
            f"dropped is not the {len(rest)} voxels that the path leaves out, "
            f"in lexicographic order (it has {len(path.dropped)} rows)",
            -1,
        )
    return "", -1


def _refined(solid: VoxelSolid, refinement: int) -> grid.BoolArray:
    """A new grid with every voxel split in `refinement`^3."""
    return np.kron(solid.occupancy, np.ones((refinement,) * 3, bool))


def _visits_fault(path: VoxelPath, solid: VoxelSolid) -> tuple[str, int]:
    """Runs and node numbers first: the nesting is a matter of the numbers alone."""
    if not len(path.visits):
        return "", -1
    label, _ = grid.layer_components(_refined(solid, path.refinement))
    component = label[tuple(path.voxels.T)]
    starts = np.flatnonzero(np.diff(component, prepend=-1))
    stops = np.append(starts[1:], len(path))
    visits = path.visits
    for k, (start, stop) in enumerate(zip(starts, stops, strict=True)):
        if k >= len(visits) or tuple(visits[k, :2]) != (start, stop):
            return f"no visit {k} of steps {start} to {stop}, one run in a component", int(start)
    if len(visits) > len(starts):
        return f"{len(visits)} visits, but the path has {len(starts)} runs", len(path) - 1
    component_of: dict[int, int] = {}
    for start, piece, here in zip(starts, visits[:, 2], component[starts], strict=True):
        if component_of.setdefault(piece, here) != here:
            return f"piece {piece} lies in two components", int(start)
    reason, where = _nesting_fault(visits)
    return (reason, where) if reason else _return_fault(path, component)


def _nesting_fault(visits: grid.IntArray) -> tuple[str, int]:
    last = {int(piece): k for k, piece in enumerate(visits[:, 2])}
    open_pieces: list[int] = []
    for k, (start, _, piece, depth) in enumerate(visits.tolist()):
        while open_pieces and last[open_pieces[-1]] < k:
            open_pieces.pop()
        if piece not in open_pieces:
            open_pieces.append(piece)
        elif open_pieces[-1] != piece:
            inner = open_pieces[-1]
            return f"pieces {piece} and {inner} alternate instead of nesting", start
        n_around = len(open_pieces) - 1
        if depth != n_around:
            return f"visit {k} has depth {depth}, but {n_around} pieces enclose it", start
    return "", -1


def _return_fault(path: VoxelPath, component: NDArray[np.int32]) -> tuple[str, int]:
    left: dict[int, int] = {}
    on_msp: dict[int, int] = {}
    for start, stop, piece, depth in path.visits.tolist():
        if piece in left:
            gap = np.abs(path.voxels[start] - path.voxels[left[piece]]).sum()
            if gap != 1:
                return f"piece {piece} goes on {gap} voxels from where it was left", start
        left[piece] = stop - 1
        if depth == 0 and on_msp.setdefault(component[start], piece) != piece:
            other = on_msp[component[start]]
            return f"pieces {other} and {piece} of the MSP lie in one component", start
    return "", -1


def _u_fault(path: VoxelPath, solid: VoxelSolid) -> tuple[str, int]:
    steps = np.diff(path.voxels, axis=0)
    us = (steps[2:] == -steps[:-2]).all(axis=1)
    if us.any():
        k = int(np.argmax(us))
        return f"steps {k} to {k + 3} form a U", k
    occupancy = _refined(solid, path.refinement)
    for end, way_in in ((path.voxels[0], -steps[:2]), (path.voxels[-1], steps[-2:][::-1])):
        for direction in grid.DIRECTIONS:
            closes_a_u = len(way_in) == 2 and (direction == -way_in[1]).all()
            if not closes_a_u and not _ray(occupancy, end, direction).any():
                return "", -1
    return "no end can leave the solid along a lattice ray", -1


def _ray(occupancy: grid.BoolArray, end: grid.IntArray, direction: grid.IntArray) -> grid.BoolArray:
    """What lies ahead of a voxel in a direction, up to the rim of the grid."""
    axis = int(np.abs(direction).argmax())
    line = np.moveaxis(occupancy, axis, 2)[tuple(np.delete(end, axis))]
    return line[end[axis] + 1 :] if direction[axis] > 0 else line[: end[axis]]
