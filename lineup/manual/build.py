"""Which side of the model lies on the table while it is folded, and places on the base card."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .. import grid
from ..grid import IntArray
from ..transformation.reversal import turned_code
from .actions import HEAD, Action

LYING = {
    "D": "upright",
    "U": "upside down",
    "N": "lying on its north side",
    "S": "lying on its south side",
    "E": "lying on its east side",
    "W": "lying on its west side",
}
"""How the model lies, by the side of it that is on the table."""

_TURNS = {
    "D": [(1, 0, 0), (0, 1, 0), (0, 0, 1)],
    "U": [(1, 0, 0), (0, -1, 0), (0, 0, -1)],
    "N": [(1, 0, 0), (0, 0, 1), (0, -1, 0)],
    "S": [(1, 0, 0), (0, 0, -1), (0, 1, 0)],
    "E": [(0, 0, 1), (0, 1, 0), (-1, 0, 0)],
    "W": [(0, 0, -1), (0, 1, 0), (1, 0, 0)],
}


class Build(NamedTuple):
    """Where the model lies on the base card; columns, rows and layers count from 1.

    Attributes
    ----------
    down : str
        Letter of the side of the model that is on the table.
    turn : (3, 3) int32
        The rotation that lays the model so.
    shift : (3,) int32
        Column, row and layer are the turned position and this.
    """

    down: str
    turn: IntArray
    shift: IntArray

    def places(self, voxels: IntArray) -> IntArray:
        """Columns (eastwards), rows (northwards) and layers of (n, 3) voxels."""
        there: IntArray = (voxels @ self.turn.T + self.shift).astype(np.int32)
        return there

    @property
    def letters(self) -> str:
        """Letters on the card of the six directions of the model."""
        return "".join(grid.LETTERS[code] for code in turned_code(self.turn))


def best_build(voxels: IntArray, base: tuple[int, int], actions: Sequence[Action]) -> Build:
    """The lie in which the fewest voxels have to go below others, in the longest runs in a layer.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup.manual.actions import actions_of
    >>> from lineup.manual.build import best_build
    >>> tower = np.array([(0, 0, z) for z in range(4)])
    >>> best_build(tower, *actions_of(lu.unfold(lu.VoxelPath(tower), method="peel"))).down
    'N'
    """
    builds = [build_of(down, voxels) for down in LYING]
    return min(builds, key=lambda build: _toil(build, voxels, base, actions))


def build_of(down: str, voxels: IntArray) -> Build:
    """The model with that side of it on the table, moved to the corner of the base card."""
    turn = np.array(_TURNS[down], np.int32)
    return Build(down, turn, (1 - (voxels @ turn.T).min(axis=0)).astype(np.int32))


def covered(places: IntArray, base: tuple[int, int], actions: Sequence[Action]) -> list[int]:
    """Joints that are put in place below a voxel that is there already, in order."""
    highest: dict[tuple[int, int], int] = {}
    below = []
    for joint in (*base, *(action.joint for action in actions if not action.swings)):
        column, row, layer = places[joint].tolist()
        top = highest.get((column, row), layer)
        if top > layer:
            below.append(joint)
        highest[column, row] = max(top, layer)
    return below


def _toil(build: Build, voxels: IntArray, base: tuple[int, int], actions: Sequence[Action]) -> int:
    """Voxels that go below others, and one more for each change of layer or of end."""
    places = build.places(voxels)
    runs = [(a.end == HEAD, int(places[a.joint, 2])) for a in actions if not a.swings]
    changes = sum(run != before for run, before in zip(runs[1:], runs, strict=False))
    return len(covered(places, base, actions)) + changes
