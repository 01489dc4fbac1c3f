"""What one end puts in place without a break, and the letters by which the booklet tells it."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from .actions import AT_ONCE, HINGE_FIRST, STRAIGHTEN, Action
from .assembly import Assembly
from .rows import bend

LINE = 10
"""The booklet breaks lines after every so many blocks."""

SIGNS = {AT_ONCE: "", STRAIGHTEN: "*", HINGE_FIRST: "+"}
"""By how a hinge is bent."""


class Stretch(NamedTuple):
    """Swings, and then voxels that one end puts in place."""

    swings: list[Action]
    laid: list[Action]

    @property
    def end(self) -> int:
        return self.laid[0].end

    @property
    def blocks(self) -> tuple[int, int]:
        """Numbers, from 1, of the first and the last block."""
        return self.laid[0].joint // 2 + 1, self.laid[-1].joint // 2 + 1


def stretches(actions: Sequence[Action]) -> list[Stretch]:
    """Actions, of which the last is no swing, in stretches.

    Examples
    --------
    >>> from lineup.manual.actions import Action
    >>> from lineup.manual.stretches import stretches
    >>> lay, swing, lay_on = Action(1, 2, 0, 0, 3), Action(1, 2, 0, 1, 2), Action(1, 3, 1, 1, 1)
    >>> [len(stretch.laid) for stretch in stretches([lay, swing, lay_on])]
    [1, 1]
    """
    found: list[Stretch] = []
    swings: list[Action] = []
    for action in actions:
        if action.swings:
            swings.append(action)
        elif swings or not found or found[-1].end != action.end:
            found.append(Stretch(swings, [action]))
            swings = []
        else:
            found[-1].laid.append(action)
    return found


def sign(assembly: Assembly, action: Action) -> str:
    """What marks an action that the slots do not let be done at once; empty for most."""
    return SIGNS[STRAIGHTEN] if action in assembly.twisting else SIGNS[action.manner]


def lines(assembly: Assembly, stretch: Stretch) -> Iterator[tuple[int, int, list[str]]]:
    """Lines of up to ten blocks: the first and the last, and the letters of each.

    Two letters a block: where its piece goes, where its hinge goes, and then a `sign`, if any;
    ``-`` stands for one that another stretch does.
    """
    words: dict[int, list[str]] = {}
    for action in stretch.laid:
        block = action.joint // 2
        word = words.setdefault(block, ["-", "-"])
        word[action.lays_hinge] = bend(assembly, action) + sign(assembly, action)
    rows: dict[int, list[int]] = {}
    for block in words:
        rows.setdefault(block // LINE, []).append(block)
    for row in rows.values():
        yield row[0] + 1, row[-1] + 1, ["".join(words[block]) for block in row]
