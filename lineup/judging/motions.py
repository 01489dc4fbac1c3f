"""The judge of motions: whether the chain keeps clear of itself at every instant (Section 6)."""

from dataclasses import replace
from types import NoneType

import numpy as np
from numpy.typing import NDArray

from .. import grid
from .._record import of_kind
from ..joints import JOINTS, slot_violations
from ..kinematics import TURNS, Move
from ..solid import Certificate, Motion, Obstacles
from . import _bends, _obstacles, _pulls, _turns
from ._approach import FINE, TOUCH, approach
from ._lattice import congruent, largest_bend, not_simple
from ._tilts import malformed_tilt, not_monotone, tilt_box

_ROUNDING = 1e-9

_MALFORMED = {
    _turns.JOINTS: "names joints that its kind of move cannot turn",
    _turns.DIRECTION: "must turn its bar to a direction 0..5 perpendicular to it",
    _turns.DOOR: "must turn by value 1 or -1 about a lattice line that does not hold its joints",
}

_MALFORMED_PULL = "must lead from one end to the other, in a direction 0..5"


def certify(
    motion: Motion,
    diameter: float = 0.999,
    max_bend_deg: float = 90.0,
    within: tuple[float, float, float] | None = None,
    joints: str = "free",
    obstacles: Obstacles | None = None,
) -> Certificate:
    """Judge a whole motion, at every instant, from its start to its last pose (Section 6).

    Bars two or more apart must keep `diameter` from each other (as centre lines of capsules),
    and consecutive bars must bend by `max_bend_deg` at most. The motion must be straight at some
    lattice pose: at its end if it unfolds, at its start if it folds, between if it leads from
    one shape to another; or it must end in its `goal`, turned and shifted as a whole, if it has
    one. `motion.straight` must tell truly whether it is straight at its end. What `motion` says
    of its diameter and bend is not used.

    Parameters
    ----------
    diameter : float
        In voxel units. The default is that of touching blocks less a numerical tolerance.
    max_bend_deg : float
        Between 0 (exclusive) and 180.
    within : (float, float, float), optional
        Sides, in voxel units and along the axes of `motion`, of a box that all blocks have to
        stay in, wherever it is put: no side of the certificate's `extent` may be longer.
    joints : str
        "free", or "slotted" to ask as well that no capsule twists between two bent joints, which
        the slots of the printed block do not let it (Figure 16, see `lineup.joints`).
    obstacles : Obstacles, optional
        Unit voxels, in the frame of `motion`, that no bar may enter. Only pulls, and bars of
        diameter 1 at most, are judged beside obstacles; other motions are refused.

    Returns
    -------
    Certificate
        `clearance` is the smallest distance over the motion within 1e-9, but TILT and PULL count by
        lower bounds, and a BEND by one that is at most 1e-4 too low; a chain of less than three
        bars has infinite clearance. `where` is the first move that fails, -1 where the fault is
        in the start or the end. After a fault, `clearance`, `bend_deg` and `extent` cover the
        moves up to it, and that move as far as it was judged.

    Notes
    -----
    A move that moves nothing (a bar that has its direction already, a DOOR whose joints all lie
    on its axis) is refused as malformed. The axis of a DOOR is any lattice line through both its
    joints. A TILT is judged by a lemma: all its bars turn to one direction (or all from it), no
    bar steps against it, and a bar that rests neither has that direction nor an axis of a
    bar that turns; then no two points come nearer than in the folded one of its two poses.
    Any other TILT is refused. A PULL is judged by a lemma, too: where the P + 1 voxels that the
    chain leaves, passes and reaches are all different, bars keep 1 from each other if these
    lie in a straight line; .9142, with bends of 90 degrees at most, if they make corners but no
    U (three edges of a unit square in a row); sqrt(3)/2 and 120 degrees if they do. Beside
    obstacles these voxels have to be free, and at each corner a, b, c also that in its crook,
    a + c - b: bars of diameter 1 at most then stay in free voxels (proved in `_obstacles`).

    A BEND must begin in the pose that is, angles counted modulo a full turn, and may end off the
    lattice; then only a BEND about the same axis may follow. Its distances are bounded on ever
    shorter intervals of time. What 40 halvings or 10,000 intervals do not settle is refused as
    undecided: a distance that all but equals the diameter, or bars that turn many times over.

    Raises
    ------
    ValueError
        If `diameter` is not positive, `max_bend_deg` is not in (0, 180], `within` is not three
        positive numbers, `joints` is none of those, or `motion` is no Motion.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup.kinematics import Move
    >>> corner = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (1, 2, 0)])
    >>> straighten = np.array([(Move.SWING, 1, 2, 0)])
    >>> verdict = lu.certify(lu.Motion(corner, straighten, 1.0, 90.0, True, "straight"))
    >>> verdict.reason, verdict.most_bent, verdict.extent
    ('certified', (-1, 1), (4.0, 3.0, 1.0))
    """
    of_kind(motion, Motion)
    of_kind(obstacles, Obstacles, NoneType)
    check_limits(diameter, max_bend_deg)
    box = np.array([np.inf] * 3 if within is None else within, np.float64)
    if box.shape != (3,) or not (box > 0).all():
        raise ValueError(f"within must be three positive numbers of voxels, got {within}")
    if joints not in JOINTS:
        raise ValueError(f"unknown joints {joints!r}; known: {', '.join(JOINTS)}")
    verdict = _Trial(motion, diameter, max_bend_deg, box, obstacles).verdict()
    return verdict if joints == "free" else _slotted(motion, verdict)


def check_limits(diameter: float | None, max_bend_deg: float | None) -> None:
    """Raise a ValueError if no motion can be judged at this diameter or this bend."""
    if diameter is not None and not (np.isfinite(diameter) and diameter > 0):
        raise ValueError(f"diameter must be a positive number of voxels, got {diameter}")
    if max_bend_deg is not None and not 0 < max_bend_deg <= 180:
        raise ValueError(f"max_bend_deg must be above 0 and at most 180, got {max_bend_deg}")


def _slotted(motion: Motion, verdict: Certificate) -> Certificate:
    """The verdict, and what the slots say of the moves that it covers."""
    if len(motion.start) % 2:
        reason = f"start: {len(motion.start)} joints are no chain of blocks, which have two each"
        return replace(verdict, ok=False, reason=reason, where=-1)
    n_made = verdict.where if verdict.where >= 0 else verdict.moves_checked
    rows = slot_violations(replace(motion, moves=motion.moves[:n_made]))
    verdict = replace(verdict, violations=len(np.unique(rows[:, 0])))
    if not (verdict.ok and len(rows)):
        return verdict
    where, bar = (int(x) for x in rows[0])
    reason = f"bar {bar} would twist in its slots, bent at both ends"
    return replace(verdict, ok=False, reason=reason, where=where)


class _Trial:
    """One motion under judgement: its pose, and what has been met so far."""

    def __init__(
        self,
        motion: Motion,
        diameter: float,
        max_bend_deg: float,
        within: grid.FloatArray,
        obstacles: Obstacles | None,
    ) -> None:
        self.motion, self.obstacles = motion, obstacles
        self.diameter, self.max_bend_deg, self.within = diameter, max_bend_deg, within
        self.pose = np.array(motion.start, np.int64, order="C")
        self.clearance, self.nearest = float("inf"), (-1, -1, -1)
        self.bend_deg, self.most_bent = 0.0, (-1, -1)
        self.box = np.full((2, 3), np.nan)  # lowest and highest positions met
        self.was_straight = False
        self.lying: _bends.Lying | None = None  # the pose, while it is off the lattice
        self.checked = 0

    def verdict(self) -> Certificate:
        return (
            self._start()
            or self._start_beside()
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
            nearest=self.nearest,
            most_bent=self.most_bent,
            extent=self._extent(),
        )

    def _refuse(self, reason: str, where: int = -1) -> Certificate:
        return self._certificate(ok=False, reason=reason, where=where)

    def _extent(self) -> tuple[float, float, float]:
        x, y, z = (self.box[1] - self.box[0] + 1).tolist()
        return x, y, z

    def _widen(self, box: grid.FloatArray) -> None:
        """Take note that the centre lines reach as far as a box (2, 3), lowest and highest."""
        self.box = np.stack([np.fmin(self.box[0], box[0]), np.fmax(self.box[1], box[1])])

    def _note_bend(self, bend_deg: float, move: int, joint: int) -> None:
        if bend_deg > self.bend_deg:
            self.bend_deg, self.most_bent = bend_deg, (move, joint)

    def _start(self) -> Certificate | None:
        fault, _ = not_simple(self.pose)
        if fault:
            self.clearance = float("nan")
            return self._refuse(f"start: {fault}")
        if len(self.pose) > 3:
            self.clearance, self.nearest = 1.0, (-1, 0, 2)
        if self.clearance < self.diameter:
            return self._refuse(f"start: bars 0 and 2 are {self.clearance:g} apart")
        bend_deg, joint = largest_bend(self.pose)
        self._note_bend(bend_deg, -1, joint)
        if bend_deg > self.max_bend_deg:
            return self._refuse(f"start: bend of {self.bend_deg:g} degrees at joint {joint}")
        self.was_straight = self.bend_deg == 0
        self._widen(np.stack([self.pose.min(axis=0), self.pose.max(axis=0)]))
        return self._outgrown(-1)

    def _start_beside(self) -> Certificate | None:
        """What speaks against the start beside the obstacles, if there are any."""
        if self.obstacles is None:
            return None
        if self.diameter > _obstacles.THICKEST:
            return self._refuse("bars thicker than 1 are not judged beside obstacles")
        inside = self.obstacles.holds(self.pose)
        if inside.any():
            return self._refuse(f"start: joint {int(inside.argmax())} is inside an obstacle")
        return None

    def _outgrown(self, where: int) -> Certificate | None:
        extent = self._extent()
        for axis in range(3):
            if extent[axis] > self.within[axis] + _ROUNDING:
                return self._refuse(
                    f"the blocks reach over {extent[axis]:.6g} along axis {axis}, "
                    f"more than the {self.within[axis]:g} of the box",
                    where,
                )
        return None

    def _moves(self) -> Certificate | None:
        judges = dict.fromkeys(TURNS, self._turns)
        judges |= {Move.TILT: self._tilt, Move.PULL: self._pulls, Move.BEND: self._bend}
        while self.checked < len(self.motion):
            where = self.checked
            move = self.motion.moves[where]
            if move[0] not in judges:
                self.checked += 1
                return self._refuse(f"malformed: {_named(move)} is of no known kind", where)
            if self.obstacles is not None and move[0] != Move.PULL:
                self.checked += 1
                return self._refuse(f"{_named(move)} is not judged beside obstacles", where)
            if self.lying is not None and move[0] != Move.BEND:
                self.checked += 1
                return self._refuse(f"malformed: {_named(move)} starts off the lattice", where)
            refused = judges[move[0]]() or self._outgrown(self.checked - 1)
            if refused:
                return refused
        return None

    def _turns(self) -> Certificate | None:
        """Peels, swings and doors up to the next move of another kind."""
        moves, first = self.motion.moves.astype(np.int64, order="C"), self.checked
        limits = _turns.Limits(self.diameter, self.max_bend_deg, self.within - 1 + _ROUNDING)
        found = _turns.carry_out(self.pose, moves, first, limits, self.box)
        where = found.where
        self.checked = where + (found.fault != _turns.FINE)
        if found.clearance < self.clearance and len(self.pose) > 3:
            self.clearance, self.nearest = found.clearance, found.near
        if found.bend_deg > self.bend_deg:
            self.bend_deg, self.most_bent = found.bend_deg, found.bent
        self.was_straight = self.was_straight or found.straight
        if found.fault in (_turns.FINE, _turns.OUTGROWN):
            return None
        if found.fault == _turns.TOUCH:
            _, a, b = found.near
            return self._refuse(
                f"bars {a} and {b} come within {found.clearance:.6g}, "
                f"less than the diameter {self.diameter:g}",
                where,
            )
        if found.fault == _turns.BEND:
            joint = found.bent[1]
            return self._refuse(f"bend of {found.bend_deg:g} degrees at joint {joint}", where)
        move = _named(moves[where])
        return self._refuse(f"malformed: {move} {_MALFORMED[found.fault]}", where)

    def _pulls(self) -> Certificate | None:
        """Pulls by one end up to the next move that is none of them."""
        moves, first, last = self.motion.moves, self.checked, len(self.pose) - 1
        head, tail = (int(x) for x in moves[first, 1:3])
        values = moves[first:, 3]
        run = (moves[first:, :3] == moves[first, :3]).all(axis=1) & (values >= 0) & (values < 6)
        if {head, tail} != {0, last} or head == tail or not run[0]:
            self.checked += 1
            return self._refuse(f"malformed: {_named(moves[first])} {_MALFORMED_PULL}", first)
        values = values[: len(run) if run.all() else int(np.argmin(run))]
        ahead = slice(None, None, 1 if head == last else -1)
        steps = grid.DIRECTIONS[values].astype(np.int64)
        hit = self._hit(self.pose[ahead], steps)
        steps = steps[: max(hit.vertex - last, 1)] if hit else steps
        n_held = self._n_held(self.pose[head] + steps.cumsum(axis=0))
        if n_held + 1 < len(steps):
            steps, hit = steps[: n_held + 1], None
        pulled = _pulls.carry_out(self.pose[ahead], steps, self.diameter, self.max_bend_deg)
        where = first + pulled.made
        heads = self.pose[head] + np.vstack([0 * steps[:1], steps[: pulled.made]]).cumsum(axis=0)
        self._widen(np.stack([heads.min(axis=0), heads.max(axis=0)]))
        self.pose = np.ascontiguousarray(pulled.pose[ahead])
        if pulled.clearance < self.clearance:
            self.clearance, self.nearest = pulled.clearance, (first, -1, -1)
        self._note_bend(pulled.bend_deg, first, -1)
        self.was_straight = self.was_straight or pulled.straight
        self.checked = where + (pulled.fault != _pulls.FINE)
        if pulled.fault == _pulls.FINE:
            return hit and self._refuse(f"the pull meets an obstacle: {hit.what}", where - 1)
        if pulled.fault == _pulls.BACK:
            return self._refuse(f"malformed: {_named(moves[where])} goes straight back", where)
        if pulled.fault == _pulls.BLOCKED:
            joint = pulled.joint if head == last else last - pulled.joint
            return self._refuse(f"the pull is blocked: joint {joint} is in the way", where)
        if pulled.fault == _pulls.TOUCH:
            return self._refuse(
                f"a pull is proven to keep {pulled.clearance:.6g} only, "
                f"less than the diameter {self.diameter:g}",
                where,
            )
        return self._refuse(f"bend of {pulled.bend_deg:g} degrees round a corner or U", where)

    def _n_held(self, heads: NDArray[np.int64]) -> int:
        """How many pulls stay in the box, of those that lead an end to these positions."""
        low = np.minimum(self.box[0], np.minimum.accumulate(heads))
        high = np.maximum(self.box[1], np.maximum.accumulate(heads))
        out = (high - low + 1 > self.within + _ROUNDING).any(axis=1)
        return int(out.argmax()) if out.any() else len(heads)

    def _hit(self, pose: NDArray[np.int64], steps: NDArray[np.int64]) -> _obstacles.Hit | None:
        """The first obstacle on the track of pulls by the last joint of a pose."""
        if self.obstacles is None:
            return None
        track = np.vstack([pose, pose[-1] + steps.cumsum(axis=0)])
        return _obstacles.first_hit(track, self.obstacles)

    def _tilt(self) -> Certificate | None:
        where, move = self.checked, self.motion.moves[self.checked]
        self.checked += 1
        _, joint, other, value = (int(x) for x in move)
        fault = malformed_tilt(self.motion, joint, other, value)
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
        fault = not_monotone(bars, targets, turning)
        if fault:
            return self._refuse(f"tilt of a path that is not monotone: {fault}", where)
        self._widen(tilt_box(self.pose[0], bars, targets, turning))
        self.pose[1:] = self.pose[0] + targets.cumsum(axis=0)
        fault, _ = not_simple(self.pose)
        if fault:
            self.clearance, self.nearest = 0.0, (where, -1, -1)
            return self._refuse(f"the tilt's last pose is not simple: {fault}", where)
        bend_deg, joint = largest_bend(self.pose)
        self._note_bend(bend_deg, where, joint)
        if bend_deg > self.max_bend_deg:
            return self._refuse(f"bend of {bend_deg:g} degrees at joint {joint}", where)
        self.was_straight = self.was_straight or bend_deg == 0
        return None

    def _bend(self) -> Certificate | None:
        where, move = self.checked, self.motion.moves[self.checked]
        self.checked += 1
        _, axis, first, last = (int(x) for x in move)
        now = _bends.lying(self.pose, axis) if self.lying is None else self.lying
        fault = _bends.malformed_bend(self.motion, move, now)
        if fault:
            return self._refuse(f"malformed: {_named(move)} {fault}", where)
        before, after = (now.at(self.motion.angles[row]) for row in (first, last))
        bends_deg = _bends.sharpest_bends(before, after)
        joint = int(bends_deg.argmax())
        self._note_bend(float(bends_deg[joint]), where, joint)
        if bends_deg[joint] > self.max_bend_deg:
            return self._refuse(f"bend of {bends_deg[joint]:g} degrees at joint {joint}", where)
        turn = _bends.turning(before, after, bends_deg)
        self._widen(_bends.box(self.pose[0], axis, turn))
        verdict, near, time, a, b = approach(turn, self.diameter, min(1.0, self.clearance))
        if near < self.clearance and len(self.pose) > 3:
            self.clearance, self.nearest = near, (where, a, b)
        if verdict != FINE:
            told = f"bars {a} and {b} come within {near:.6g}, less than"
            if verdict != TOUCH:
                told = f"undecided: bars {a} and {b} may come within"
            told = f"{told} the diameter {self.diameter:g}"
            return self._refuse(f"{told}, at {time:.6g} of {_named(move)}", where)
        bars = after.bars()
        self.lying = after if bars is None else None
        if bars is not None:
            self.pose[1:] = self.pose[0] + bars.cumsum(axis=0)
            self.was_straight = self.was_straight or largest_bend(self.pose)[0] == 0
        return None

    def _end(self) -> Certificate | None:
        if self.lying is not None:
            return self._refuse("the last pose is off the lattice")
        bend_deg, joint = largest_bend(self.pose)
        straight = bend_deg == 0
        if straight != self.motion.straight:
            if straight:
                return self._refuse("ends straight, but the motion says that it does not")
            return self._refuse(f"not straight: the last pose bends at joint {joint}")
        if len(self.motion.goal):
            if not congruent(self.pose, self.motion.goal.astype(np.int64)):
                return self._refuse("the last pose is not the motion's goal, turned as a whole")
        elif not self.was_straight:
            return self._refuse("ends not straight, and is straight nowhere before")
        return None


def _named(move: NDArray[np.int64] | grid.IntArray) -> str:
    kind, joint, other, value = (int(x) for x in move)
    name = Move(kind).name if kind in list(Move) else str(kind)
    return f"({name}, {joint}, {other}, {value})"
