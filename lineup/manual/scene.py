"""How far the body is built at a moment: what is in place, and where the loose ends point."""

import numpy as np

from .. import grid
from ..grid import IntArray, bar_directions
from .actions import ENDS, HEAD, TAIL
from .assembly import Assembly
from .pictures import LooseEnd


def in_place(assembly: Assembly, n_actions: int) -> IntArray:
    """Joints that are in place after so many actions, the base first, then in order."""
    actions = assembly.actions[:n_actions]
    laid = [action.joint for action in actions if not action.swings]
    return np.array([*assembly.base, *laid], np.int32)


def loose_ends(assembly: Assembly, n_actions: int) -> list[LooseEnd]:
    """The loose ends after so many actions, with directions on the card.

    Of an end all of whose voxels are in place there is none.
    """
    first = int(bar_directions(assembly.folding.path.voxels)[assembly.base[0]])
    at = list(assembly.base)
    ways = [(first + 3) % 6, first]
    for action in assembly.actions[:n_actions]:
        at[action.end], ways[action.end] = action.joint, action.loose
    return [
        LooseEnd(
            ENDS[end],
            assembly.places[at[end]],
            grid.LETTERS.index(assembly.build.letters[ways[end]]),
        )
        for end, last in ((HEAD, 0), (TAIL, len(assembly.places) - 1))
        if at[end] != last
    ]
