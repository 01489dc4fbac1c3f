"""Descent of an objective of a linkage's angles, in steps that surely keep bars apart."""

from collections import deque
from collections.abc import Callable

import numpy as np

from ..grid import FloatArray, IntArray
from ._bending import Keyframes, Run, line_ahead, ticks
from ._linkage import Linkage, clearance, placed, radians, straightness
from ._safety import safe_share

Objective = Callable[[FloatArray], tuple[float, FloatArray]]
"""The value, infinite where there is none, and the gradient at angles (m,) in radians."""

MOST_TURN = 0.2
"""Radians that an angle may turn in one step."""

FIRST_TURN = 0.01
"""The same for the first step, and for the first after L-BFGS has forgotten all."""

STATIONARY = 1e-8
"""A gradient smaller than this share of the objective is none."""

LOOK_AHEAD = 10
"""Steps between two looks at the direct way to the line; later, a tenth of those made."""

SLACK = 0.01
"""How much nearer than in the steps bars may come where steps are left out."""


class Descent:
    """Lowers an objective until the direct way to a line is safe, or nothing lowers it.

    Parameters
    ----------
    diameter : float
        Bars keep it within every step.
    memory : int
        Steps that L-BFGS learns from; 0 is steepest descent.
    max_bend : int
        In ticks. With it every step ends at whole ticks, so that the rows are the very steps.
    """

    def __init__(
        self,
        linkage: Linkage,
        objective: Objective,
        *,
        diameter: float,
        memory: int = 0,
        max_bend: int | None = None,
    ) -> None:
        self.linkage, self.objective = linkage, objective
        self.diameter, self.max_bend = diameter, max_bend
        self.angles = radians(linkage.start)
        self.value, self.gradient = objective(self.angles)
        self.reached = clearance(linkage, placed(self.angles))
        self.learnt: deque[tuple[FloatArray, FloatArray]] = deque(maxlen=memory)
        self.stretch = FIRST_TURN / max(np.abs(self.gradient).max(initial=0), FIRST_TURN)
        self.frames = Keyframes(linkage)

    def run(self, steps: int) -> Run:
        """At most so many steps, and why they end."""
        reason, next_look = "straight", 0
        for done in range(steps + 1):
            floor = max(self.diameter, self.reached - SLACK)
            row = self._row()
            self.frames.add(row, floor)
            if done >= next_look or done == steps:
                next_look = done + max(LOOK_AHEAD, done // LOOK_AHEAD)
                line = line_ahead(self.linkage, row, floor)
                if line is not None:
                    self.frames.add(line, floor)
                    break
            if done == steps:
                reason = "step limit"
            elif self._stationary() or not self._step():
                reason = "stationary"
            if reason != "straight":
                far = straightness(placed(self.angles))
                reason += f" after {done} steps at straightness {far:.2f}"
                break
        return Run(self.frames.rows(floor), reason, done, self.value)

    def _row(self) -> IntArray:
        most = np.iinfo(np.int32).max if self.max_bend is None else self.max_bend
        return ticks(self.angles, self.linkage.corners, most)

    def _stationary(self) -> bool:
        steepest = np.abs(self.gradient).max(initial=0)
        return bool(steepest <= STATIONARY * max(abs(self.value), 1.0))

    def _step(self) -> bool:
        """One step; False if there is none that lowers the objective."""
        direction = self._direction()
        most = MOST_TURN / np.abs(direction).max()
        share = min(1.0 if self.learnt else self.stretch, most)
        slope = float(direction @ self.gradient)
        while share * np.abs(direction).max() > 1e-12:
            trial = self.angles + share * direction
            if self.max_bend is not None:
                trial = radians(ticks(trial, self.linkage.corners, self.max_bend))
            turn = trial - self.angles
            if not turn.any():
                break
            safe = safe_share(self.linkage, self.angles, turn, self.diameter)
            if safe < 1.0:
                share *= max(0.1, 0.9 * safe)
                continue
            value, gradient = self.objective(trial)
            if value <= self.value + 1e-4 * share * slope:
                self._learn(turn, gradient - self.gradient)
                self.angles, self.value, self.gradient = trial, value, gradient
                self.reached = min(self.reached, clearance(self.linkage, placed(trial)))
                self.stretch = 1.5 * share
                return True
            share *= 0.5
        if self.learnt:
            self.learnt.clear()
            self.stretch = FIRST_TURN / np.abs(self.gradient).max()
            return self._step()
        return False

    def _learn(self, turn: FloatArray, change: FloatArray) -> None:
        if turn @ change > 1e-10 * np.linalg.norm(turn) * np.linalg.norm(change):
            self.learnt.append((turn, change))

    def _direction(self) -> FloatArray:
        """Downhill, by the two loops of L-BFGS (Nocedal and Wright, algorithm 7.4)."""
        out = -self.gradient
        shares = []
        for turn, change in reversed(self.learnt):
            shares.append((turn @ out) / (turn @ change))
            out = out - shares[-1] * change
        if self.learnt:
            turn, change = self.learnt[-1]
            out = out * ((turn @ change) / (change @ change))
        for (turn, change), share in zip(self.learnt, reversed(shares), strict=True):
            out = out + (share - (change @ out) / (turn @ change)) * turn
        if out @ self.gradient >= 0:
            self.learnt.clear()
            return -self.gradient
        return out
