"""Growth for slotted joints: a path near a grown one, with a plan that twists no capsule.

The path loses what keeps it from such a plan, is grown on for a while without regard to the
slots, loses again what that asks for, and so on, as long as it does not become worth less.
"""

from collections.abc import Callable

import numpy as np

from ..grid import IntArray
from ..motion.plan import left_folded, peel_plan
from ._fold import Fold, load, path_of
from ._moves import anneal, fill

STARTS = 4
BIASES = (0.02, 0.98, 0.5)
HOT, COLD = 0.7, 0.1
STRIDES = (30, 100, 300)
"""Rounds of annealing between two looks at the slots."""

FILLED = 0.5
"""Share of the looks before which all holes are climbed over."""

TRIES = (400, 40)
"""Shortcuts tried where a path has no plan: at the start, and later."""

Planned = tuple[IntArray, IntArray]


def slotted(
    fold: Fold,
    shortcut: Callable[[IntArray, int], Planned],
    only: int,
    rng: np.random.Generator,
    rounds: int,
    target: int,
    report: Callable[[int], None],
) -> Planned:
    """The best path met, and its plan; the fold is left somewhere else.

    Parameters
    ----------
    shortcut : function
        Of a path (cells) and how many tries: the path with shortcuts that let it have a plan for
        slotted joints, and that plan.
    """

    def worth(planned: Planned) -> float:
        return float(fold.weight[planned[0]].sum())

    def planned(tries: int) -> Planned:
        cells = path_of(fold)
        for bias in BIASES:
            states = peel_plan(fold.grid, cells, rng, bias=bias, only=only, joints="slotted")
            if left_folded(states) <= 1:
                return cells, states
        return shortcut(cells, tries)

    best = max((planned(TRIES[0]) for _ in range(STARTS)), key=worth)
    most = min(target, len(fold.cells) - len(fold.cells) % 2)
    for k in range(rounds):
        if len(best[0]) >= most:
            break
        load(fold, *best)
        heat = HOT + (COLD - HOT) * k / rounds
        anneal(fold, int(rng.choice(STRIDES)), heat, COLD, target, rng)
        if rng.random() < FILLED:
            fill(fold, len(fold.cells), target, rng)
        best = max(planned(TRIES[1]), best, key=worth)
        report(k + 1)
    return best
