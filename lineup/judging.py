"""The judge of paths and motions: it proves what planners claim, and shares no code with them.

Only the records, the grid's constants and the move format are common ground.
"""

import numpy as np
from numpy.typing import NDArray

from . import _sweeps, grid
from .kinematics import Move
from .solid import Certificate, Motion, VoxelPath, VoxelSolid

_MALFORMED = {
    _sweeps.KIND: "is of no known kind",
    _sweeps.JOINTS: "names joints that its kind of move cannot turn",
    _sweeps.DIRECTION: "must turn its bar to a direction 0..5 perpendicular to it",
    _sweeps.DOOR: "must turn by value 1 or -1 about a lattice line that does not hold its joints",
}

_MIXED = "its bars neither turn all to one direction nor all from one"


def certify(motion: Motion, diameter: float = 0.999, max_bend_deg: float = 90.0) -> Certificate:
    """Judge a whole motion, at every instant, from its start to its last pose (Section 6).

    Bars two or more apart must keep `diameter` from each other (as centre lines of capsules),
    and consecutive bars must bend by `max_bend_deg` at most. The motion must be straight at some
    lattice pose: at its end if it unfolds, at its start if it folds, between if it leads from
    one shape to another; `motion.straight` must tell truly whether it is at its end. What
    `motion` says of its diameter and bend is not used.

    Parameters
    ----------
    diameter : float
        In voxel units. The default is that of touching blocks less a numerical tolerance.
    max_bend_deg : float
        Between 0 (exclusive) and 180.

    Returns
    -------
    Certificate
        `clearance` is the smallest distance over the motion within 1e-9, but a TILT counts by a
        lower bound; a chain of less than three bars has infinite clearance. `where` is the first
        move that fails, -1 where the fault is in the start or the end. After a fault,
        `clearance` and `bend_deg` cover the moves up to it.

    Notes
    -----
    A move that moves nothing (a bar that has its direction already, a DOOR whose joints all lie
    on its axis) is refused as malformed. The axis of a DOOR is any lattice line through both its
    joints. A TILT is judged by a lemma: all its bars turn to one direction (or all from it), no
    bar steps against it, and a bar that rests neither has that direction nor an axis of a
    bar that turns; then no two points come nearer than in the folded one of its two poses.
    Any other TILT is refused.

    Raises
    ------
    ValueError
        If `diameter` is not positive or `max_bend_deg` is not in (0, 180].

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup.kinematics import Move
    >>> corner = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (1, 2, 0)])
    >>> straighten = np.array([(Move.SWING, 1, 2, 0)])
    >>> lu.certify(lu.Motion(corner, straighten, 1.0, 90.0, True, "straight")).reason
    'certified'
    """
    if not (np.isfinite(diameter) and diameter > 0):
        raise ValueError(f"diameter must be a positive number of voxels, got {diameter}")
    if not 0 < max_bend_deg <= 180:
        raise ValueError(f"max_bend_deg must be above 0 and at most 180, got {max_bend_deg}")
    return _Trial(motion, diameter, max_bend_deg).verdict()


class _Trial:
    """One motion under judgement: its pose, and what has been met so far."""

    def __init__(self, motion: Motion, diameter: float, max_bend_deg: float) -> None:
        self.motion = motion
        self.diameter, self.max_bend_deg = diameter, max_bend_deg
        self.pose = np.array(motion.start, np.int64, order="C")
        self.clearance = 1.0 if len(self.pose) > 3 else float("inf")
        self.bend_deg = 0.0
        self.was_straight = False
        self.checked = 0

    def verdict(self) -> Certificate:
        return (
            self._start()
            or self._moves()
            or self._end()
            or self._certificate(ok=True, reason="certified")
        )

    def _certificate(self, *, ok: bool, reason: str, where: int = -1) -> Certificate:
        return Certificate(
            ok=ok,
            reason=reason,
            where=where,
            diameter=self.diameter,
            clearance=self.clearance,
            max_bend_deg=self.max_bend_deg,
            bend_deg=self.bend_deg,
            moves_checked=self.checked,
        )

    def _refuse(self, reason: str, where: int = -1) -> Certificate:
        return self._certificate(ok=False, reason=reason, where=where)

    def _start(self) -> Certificate | None:
        fault, _ = _not_simple(self.pose)
        if fault:
            self.clearance = float("nan")
            return self._refuse(f"start: {fault}")
        if self.clearance < self.diameter:
            return self._refuse(f"start: bars 0 and 2 are {self.clearance:g} apart")
        self.bend_deg, joint = _largest_bend(self.pose)
        if self.bend_deg > self.max_bend_deg:
            return self._refuse(f"start: bend of {self.bend_deg:g} degrees at joint {joint}")
        self.was_straight = self.bend_deg == 0
        return None

    def _moves(self) -> Certificate | None:
        moves = self.motion.moves.astype(np.int64)
        while self.checked < len(moves):
            tilts = moves[self.checked, 0] == Move.TILT
            refused = self._tilt() if tilts else self._turns(moves)
            if refused:
                return refused
        return None

    def _turns(self, moves: NDArray[np.int64]) -> Certificate | None:
        """Peels, swings and doors up to the next tilt."""
        where, fault, clearance, bend_deg, straight, a, b = _sweeps.carry_out(
            self.pose, moves, self.checked, self.diameter, self.max_bend_deg
        )
        self.checked = where + (fault != _sweeps.FINE)
        if len(self.pose) > 3:
            self.clearance = min(self.clearance, clearance)
        self.bend_deg = max(self.bend_deg, bend_deg)
        self.was_straight = self.was_straight or straight
        if fault == _sweeps.FINE:
            return None
        if fault == _sweeps.TOUCH:
            a, b = min(a, b), max(a, b)
            return self._refuse(
                f"the runs of bars {a} and {b} come within {clearance:.6g}, "
                f"less than the diameter {self.diameter:g}",
                where,
            )
        if fault == _sweeps.BEND:
            return self._refuse(f"bend of {bend_deg:g} degrees at joint {a}", where)
        return self._refuse(f"malformed: {_named(moves[where])} {_MALFORMED[fault]}", where)

    def _tilt(self) -> Certificate | None:
        where, move = self.checked, self.motion.moves[self.checked]
        self.checked += 1
        _, joint, other, value = (int(x) for x in move)
        fault = _malformed_tilt(self.motion, joint, other, value)
        if fault:
            return self._refuse(f"malformed: {_named(move)} {fault}", where)
        bars = np.diff(self.pose, axis=0)
        targets = grid.DIRECTIONS[self.motion.poses[value]].astype(np.int64)
        turning = (bars != targets).any(axis=1)
        if (bars[turning] * targets[turning]).any() or not turning.any():
            return self._refuse(
                f"malformed: {_named(move)} must turn some bars, "
                "each to a direction perpendicular to it",
                where,
            )
        fault = _not_monotone(bars, targets, turning)
        if fault:
            return self._refuse(f"tilt of a path that is not monotone: {fault}", where)
        self.pose[1:] = self.pose[0] + targets.cumsum(axis=0)
        fault, _ = _not_simple(self.pose)
        if fault:
            self.clearance = 0.0
            return self._refuse(f"the tilt's last pose is not simple: {fault}", where)
        bend_deg, joint = _largest_bend(self.pose)
        self.bend_deg = max(self.bend_deg, bend_deg)
        if bend_deg > self.max_bend_deg:
            return self._refuse(f"bend of {bend_deg:g} degrees at joint {joint}", where)
        self.was_straight = self.was_straight or bend_deg == 0
        return None

    def _end(self) -> Certificate | None:
        bend_deg, joint = _largest_bend(self.pose)
        straight = bend_deg == 0
        if straight != self.motion.straight:
            if straight:
                return self._refuse("ends straight, but the motion says that it does not")
            return self._refuse(f"not straight: the last pose bends at joint {joint}")
        if not self.was_straight:
            return self._refuse("ends not straight, and is straight nowhere before")
        return None


def _named(move: NDArray[np.int64] | grid.IntArray) -> str:
    kind, joint, other, value = (int(x) for x in move)
    name = Move(kind).name if kind in list(Move) else str(kind)
    return f"({name}, {joint}, {other}, {value})"


def _not_simple(voxels: NDArray[np.int64]) -> tuple[str, int]:
    """Why these positions are no simple lattice path, and at which step; ("", -1) if they are."""
    if not len(voxels):
        return "it has no voxel", -1
    steps = np.abs(np.diff(voxels, axis=0)).sum(axis=1)
    if (steps != 1).any():
        k = int(np.flatnonzero(steps != 1)[0])
        return f"voxels {k} and {k + 1} do not share a face", k
    order = np.lexsort(voxels.T)
    again = (voxels[order[1:]] == voxels[order[:-1]]).all(axis=1)
    if again.any():
        pairs = np.sort(np.stack([order[1:][again], order[:-1][again]], axis=1), axis=1)
        first, second = (int(x) for x in pairs[pairs[:, 1].argmin()])
        return f"steps {first} and {second} visit one voxel", second
    return "", -1


def _largest_bend(pose: NDArray[np.int64]) -> tuple[float, int]:
    """Largest bend of a lattice pose, 0, 90 or 180 degrees, and the first joint that has it."""
    bars = np.diff(pose, axis=0)
    if len(bars) < 2:
        return 0.0, -1
    cosines = (bars[1:] * bars[:-1]).sum(axis=1)
    k = int(cosines.argmin())
    return 90.0 * float(1 - cosines[k]), k + 1


def _malformed_tilt(motion: Motion, joint: int, other: int, value: int) -> str:
    n_joints, poses = len(motion.start), motion.poses
    if (joint, other) != (0, n_joints - 1):
        return f"must name the joints 0 and {n_joints - 1}"
    if poses.ndim != 2 or poses.shape[1] != n_joints - 1 or not 0 <= value < len(poses):
        return f"has no row in poses of shape {poses.shape}"
    if not ((poses[value] >= 0) & (poses[value] < 6)).all():
        return "leads to a direction outside 0..5"
    return ""


def _not_monotone(
    bars: NDArray[np.int64], targets: NDArray[np.int64], turning: NDArray[np.bool_]
) -> str:
    """Why the accordion lemma holds neither forwards nor backwards; "" if it does."""
    reasons = [
        _not_accordion(bars, targets, turning),
        _not_accordion(targets, bars, turning),
    ]
    if "" in reasons:
        return ""
    return next((reason for reason in reasons if reason != _MIXED), _MIXED)


def _not_accordion(
    folded: NDArray[np.int64], unfolded: NDArray[np.int64], turning: NDArray[np.bool_]
) -> str:
    """Why the accordion lemma does not hold from `folded` to `unfolded`; "" if it does.

    Between two points of the chain let the turning bars make a displacement d over an arc of
    length N >= |d|, and the resting ones r across and h >= 0 along the one direction. At angle a
    from the folded pose the squared distance is cos(a)^2 d^2 + r^2 + (h + N sin(a))^2, because r
    is perpendicular to d, and that is at least d^2 + r^2 + h^2. Neighbours that both turn have
    the cosine (their first) cos(a)^2 + sin(a)^2, so that every bend is largest at an end.
    """
    along = unfolded[turning][0]
    if (unfolded[turning] != along).any():
        return _MIXED
    against = (folded == -along).all(axis=1)
    if against.any():
        return f"bar {int(np.flatnonzero(against)[0])} steps against the others' direction"
    axes = np.abs(folded[turning]).any(axis=0)
    rests_beside = ~turning & np.abs(folded)[:, axes].any(axis=1)
    if rests_beside.any():
        return f"bar {int(np.flatnonzero(rests_beside)[0])} rests on an axis of bars that turn"
    return ""


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
    for check in (_path_fault, _inside_fault, _visits_fault, *([_u_fault] if u_free else [])):
        reason, where = check(path, solid)
        if reason:
            return Certificate(ok=False, reason=reason, where=where)
    return Certificate(ok=True, reason="certified")


def _path_fault(path: VoxelPath, solid: VoxelSolid) -> tuple[str, int]:
    reason, where = _not_simple(path.voxels.astype(np.int64))
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
