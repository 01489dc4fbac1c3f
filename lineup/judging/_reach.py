"""How far joints reach while bars turn evenly in time about one axis; see `_approach`."""

import numpy as np

from .._jit import kernel
from ._approach import Floats, Turn

RESOLUTION = 1e-3
"""The reach shown is never below that of the joints, and seldom more than this above it."""

_MOST_HALVINGS, _MOST_INTERVALS = 40, 2_000


@kernel
def reach(turn: Turn) -> Floats:
    """Lowest and highest place of the joints along both axes of the plane, from joint 0 on.

    Intervals of time are halved until none can hold a joint more than `RESOLUTION` outside the
    places met; the bound of an interval that is not halved any more is good all the same.
    """
    met, shown = np.zeros((2, 2)), np.zeros((2, 2))
    for end in range(2):
        _reach_near(turn, float(end), 0.0, met)
    intervals = [(0, 0)]
    for seen in range(_MOST_INTERVALS):
        halvings, number = intervals.pop()
        half = 0.5 / 2.0**halvings
        time = (2 * number + 1) * half
        _reach_near(turn, time, 0.0, met)
        bound = np.zeros((2, 2))
        _reach_near(turn, time, half, bound)
        excess = max((met[0] - bound[0]).max(), (bound[1] - met[1]).max())
        may_halve = halvings < _MOST_HALVINGS and seen + len(intervals) + 2 < _MOST_INTERVALS
        if excess > RESOLUTION and may_halve:
            intervals.append((halvings + 1, 2 * number + 1))
            intervals.append((halvings + 1, 2 * number))
        else:
            shown[0] = np.minimum(shown[0], bound[0])
            shown[1] = np.maximum(shown[1], bound[1])
        if not intervals:
            break
    return shown


@kernel
def _reach_near(turn: Turn, time: float, half: float, reached: Floats) -> None:
    """Widen `reached` by the joints' Taylor series of the second order, and what it leaves."""
    place, speed, acceleration, rest = 0j, 0j, 0j, 0.0
    for bar in range(len(turn.angles)):
        if not turn.across[bar]:
            continue
        angle, rate = turn.angles[bar] + time * turn.rates[bar], turn.rates[bar]
        step = complex(np.cos(angle), np.sin(angle))
        place += step
        speed += 1j * rate * step
        acceleration -= rate**2 * step
        rest += abs(rate) ** 3
        for axis in range(2):
            p, v, a = place, speed, acceleration
            if axis == 1:
                p, v, a = -1j * p, -1j * v, -1j * a
            slack = half * abs(v.real) + half**3 / 6 * rest
            low = p.real - slack + half**2 / 2 * min(a.real, 0.0)
            high = p.real + slack + half**2 / 2 * max(a.real, 0.0)
            reached[0, axis] = min(reached[0, axis], low)
            reached[1, axis] = max(reached[1, axis], high)
