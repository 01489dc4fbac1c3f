"""The judge of motions: whether the chain keeps clear of itself at every instant (Section 6)."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .. import grid
from ..joints import JOINTS, slot_violations
from ..kinematics import Move
from ..solid import Certificate, Motion
from . import _bends, _sweeps
from ._lattice import congruent, largest_bend, not_simple
from ._tilts import malformed_tilt, not_monotone

_MALFORMED = {
    _sweeps.KIND: "is of no known kind",
    _sweeps.JOINTS: "names joints that its kind of move cannot turn",
    _sweeps.DIRECTION: "must turn its bar to a direction 0..5 perpendicular to it",
    _sweeps.DOOR: "must turn by value 1 or -1 about a lattice line that does not hold its joints",
}


def certify(
    motion: Motion, diameter: float = 0.999, max_bend_deg: float = 90.0, joints: str = "free"
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
    joints : str
        "free", or "slotted" to ask as well that no capsule twists between two bent joints, which
        the slots of the printed block do not let it (Figure 16, see `lineup.joints`).

    Returns
    -------
    Certificate
        `clearance` is the smallest distance over the motion within 1e-9, but a TILT counts by a
        lower bound, and a BEND by one that is at most 1e-4 too low; a chain of less than three
        bars has infinite clearance. `where` is the first move that fails, -1 where the fault is
        in the start or the end. After a fault, `clearance` and `bend_deg` cover the moves up to
        it.

    Notes
    -----
    A move that moves nothing (a bar that has its direction already, a DOOR whose joints all lie
    on its axis) is refused as malformed. The axis of a DOOR is any lattice line through both its
    joints. A TILT is judged by a lemma: all its bars turn to one direction (or all from it), no
    bar steps against it, and a bar that rests neither has that direction nor an axis of a
    bar that turns; then no two points come nearer than in the folded one of its two poses.
    Any other TILT is refused.

    A BEND must begin in the pose that is, angles counted modulo a full turn, and may end off the
    lattice; then only a BEND about the same axis may follow. Its distances are bounded on ever
    shorter intervals of time. What 40 halvings or 10,000 intervals do not settle is refused as
    undecided: a distance that all but equals the diameter, or bars that turn many times over.

    Raises
    ------
    ValueError
        If `diameter` is not positive, `max_bend_deg` is not in (0, 180], or `joints` is none of
        those.

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
    if joints not in JOINTS:
        raise ValueError(f"unknown joints {joints!r}; known: {', '.join(JOINTS)}")
    verdict = _Trial(motion, diameter, max_bend_deg).verdict()
    return verdict if joints == "free" else _slotted(motion, verdict)


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

    def __init__(self, motion: Motion, diameter: float, max_bend_deg: float) -> None:
        self.motion = motion
        self.diameter, self.max_bend_deg = diameter, max_bend_deg
        self.pose = np.array(motion.start, np.int64, order="C")
        self.clearance = 1.0 if len(self.pose) > 3 else float("inf")
        self.bend_deg = 0.0
        self.was_straight = False
        self.lying: _bends.Lying | None = None  # the pose, while it is off the lattice
        self.tally = np.array([diameter, 1.0, 1.0])  # of the bends, see `_approach.approach`
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
        fault, _ = not_simple(self.pose)
        if fault:
            self.clearance = float("nan")
            return self._refuse(f"start: {fault}")
        if self.clearance < self.diameter:
            return self._refuse(f"start: bars 0 and 2 are {self.clearance:g} apart")
        self.bend_deg, joint = largest_bend(self.pose)
        if self.bend_deg > self.max_bend_deg:
            return self._refuse(f"start: bend of {self.bend_deg:g} degrees at joint {joint}")
        self.was_straight = self.bend_deg == 0
        return None

    def _moves(self) -> Certificate | None:
        moves = self.motion.moves.astype(np.int64)
        while self.checked < len(moves):
            if self.lying is not None and moves[self.checked, 0] != Move.BEND:
                fault = f"malformed: {_named(moves[self.checked])} starts off the lattice"
                return self._refuse(fault, self.checked)
            match moves[self.checked, 0]:
                case Move.TILT:
                    refused = self._tilt()
                case Move.BEND:
                    refused = self._bend()
                case _:
                    refused = self._turns(moves)
            if refused:
                return refused
        return None

    def _turns(self, moves: NDArray[np.int64]) -> Certificate | None:
        """Peels, swings and doors up to the next move of another kind."""
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
        self.pose[1:] = self.pose[0] + targets.cumsum(axis=0)
        fault, _ = not_simple(self.pose)
        if fault:
            self.clearance = 0.0
            return self._refuse(f"the tilt's last pose is not simple: {fault}", where)
        bend_deg, joint = largest_bend(self.pose)
        self.bend_deg = max(self.bend_deg, bend_deg)
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
        self.bend_deg = max(self.bend_deg, float(bends_deg.max()))
        if bends_deg.max() > self.max_bend_deg:
            joint = int(bends_deg.argmax())
            return self._refuse(f"bend of {bends_deg[joint]:g} degrees at joint {joint}", where)
        reason, clearance = _bends.approached(before, after, bends_deg, self.tally)
        if len(self.pose) > 3:
            self.clearance = min(self.clearance, clearance)
        if reason:
            return self._refuse(f"{reason} of {_named(move)}", where)
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
