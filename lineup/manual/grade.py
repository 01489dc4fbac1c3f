"""How hard a model is to fold, and how long it may take."""

from dataclasses import asdict, dataclass
from itertools import pairwise

import numpy as np

from ..grid import layer_components
from .assembly import Assembly
from .build import covered

SECONDS_A_BEND, SECONDS_A_STEP, SECONDS_A_SWING = 15, 90, 60
"""Assumed, not measured: bending a joint; finding a page and checking it; swinging a loose end."""

WORDS = ("very easy", "easy", "medium", "hard", "very hard")


@dataclass(frozen=True)
class Grade:
    """What makes a model hard; all but the last three are counts.

    Attributes
    ----------
    blocks : int
    visits : int
        Times that the hand comes to another layer, or changes ends.
    limbs : int
        Most parts that stand apart in one layer.
    swings : int
        Times that a loose end changes its direction.
    turns : int
        Hinges that the slots do not let bend at once (`joints`): bends and swings that would twist
        a piece, and hinges bent in a manner that does not.
    covered : int
        Voxels that go below others that are there already.
    points : int
        blocks + 4 visits + 10 (limbs - 1) + 6 swings + 2 turns + 2 covered.
    grade : int
        1, and 1 more for each of 100, 300, 900 and 2700 points that are reached.
    minutes : int
        `SECONDS_A_BEND` for each joint that bends, and so on for steps and swings, rounded up.
    """

    blocks: int
    visits: int
    limbs: int
    swings: int
    turns: int
    covered: int
    points: int
    grade: int
    minutes: int

    @property
    def counts(self) -> dict[str, int]:
        """All of it by name."""
        return asdict(self)


def grade_of(assembly: Assembly) -> Grade:
    """The grade of a folding as it is laid out.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup.manual.assembly import assembly_of
    >>> from lineup.manual.grade import grade_of
    >>> folding = lu.fold(lu.VoxelSolid(np.ones((2, 2, 1), bool)), rounds=20, trial_rounds=5)
    >>> grade_of(assembly_of(folding)).grade
    1
    """
    laid = [action for action in assembly.actions if not action.swings]
    runs = [(action.end, int(assembly.places[action.joint, 2])) for action in laid]
    n_swings = len(assembly.actions) - len(laid)
    counts = {
        "blocks": assembly.n_blocks,
        "visits": 1 + sum(before != after for before, after in pairwise(runs)),
        "limbs": _limbs(assembly),
        "swings": n_swings,
        "turns": len(assembly.twists) + sum(action.manner != "" for action in laid),
        "covered": len(covered(assembly.places, assembly.base, assembly.actions)),
    }
    weights = {"blocks": 1, "visits": 4, "limbs": 10, "swings": 6, "turns": 2, "covered": 2}
    points = sum(weights[name] * count for name, count in counts.items()) - weights["limbs"]
    seconds = (
        SECONDS_A_BEND * (len(assembly.folding.motion) - n_swings)
        + SECONDS_A_STEP * len(assembly.steps)
        + SECONDS_A_SWING * n_swings
    )
    grade = 1 + sum(points >= least for least in (100, 300, 900, 2700))
    return Grade(**counts, points=points, grade=grade, minutes=-(-seconds // 60))


def _limbs(assembly: Assembly) -> int:
    body = np.zeros(assembly.places.max(axis=0) + 1, bool)
    body[tuple(assembly.places.T)] = True
    label, _ = layer_components(body)
    return max(len(np.unique(layer[layer > 0])) for layer in np.moveaxis(label, 2, 0))
