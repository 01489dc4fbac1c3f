"""Small solids on which the paper's figures and symbols can be followed by eye."""

from __future__ import annotations

import numpy as np

from .grid import BoolArray
from .solid import VoxelSolid

_FIGURE_8 = """
....#
....#
#...#
#####
.###.
.###.
.###.
.###.
#####
#...#
#...#
#...#
....#
....#
"""

_FIGURE_9 = """
..#.#
..#.#
#.#.#
#####
..#..
..#..
"""

_THICK = 3


def figure_8() -> VoxelSolid:
    """A solid with the Reeb graph of Figure 8: a trunk, a horn and a hanging arm.

    Walked from its lower horn, o_1, to its foot, o_18, nodes come in the order of the paper.

    Examples
    --------
    >>> import lineup as lu
    >>> len(lu.reeb_graph(figure_8()))
    18
    """
    return _seen_from_the_front(_FIGURE_8, "figure 8")


def figure_9() -> VoxelSolid:
    """A solid with the Reeb graph of Figure 9: two horns on one node, and a trunk.

    Walked from its short horn, o_1, to its foot, o_10, nodes come in the order of the paper.

    Examples
    --------
    >>> import lineup as lu
    >>> len(lu.reeb_graph(figure_9()))
    10
    """
    return _seen_from_the_front(_FIGURE_9, "figure 9")


def arch() -> VoxelSolid:
    """A bridge on two legs, wide enough for every node to meet every assumption of Section 4.4.

    Examples
    --------
    >>> import lineup as lu
    >>> bool(lu.audit(arch())["met"].all())
    True
    """
    occupancy = np.ones((9, 4, 5), bool)
    occupancy[4, :, :3] = False
    return VoxelSolid(occupancy, name="arch")


def comb(n_teeth: int = 6, length: int = 12) -> BoolArray:
    """A layer whose interior is a tree: a spine and teeth, three cells wide, gaps of one, (X, Y).

    Examples
    --------
    >>> comb(2, 3).astype(int).sum(axis=1).tolist()
    [6, 6, 6, 3, 6, 6, 6]
    """
    mask = np.zeros((4 * n_teeth - 1, 3 + length), bool)
    mask[:, :3] = True
    for k in range(n_teeth):
        mask[4 * k : 4 * k + 3] = True
    return mask


def leaf() -> BoolArray:
    """A layer with a dangling stem, an ellipse of 12 by 8 cells (Figures 5 and 7), (X, Y).

    Examples
    --------
    >>> leaf().shape
    (15, 8)
    """
    x, y = np.indices((15, 8))
    mask = ((x - 8.5) / 6.2) ** 2 + ((y - 3.5) / 4.2) ** 2 <= 1
    mask[:3, 4] = True
    return mask


def _seen_from_the_front(picture: str, name: str) -> VoxelSolid:
    rows = picture.split()
    front = np.array([[cell == "#" for cell in row] for row in reversed(rows)])
    return VoxelSolid(np.repeat(front.T[:, None, :], _THICK, axis=1), name=name)
