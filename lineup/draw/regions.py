"""Pictures of one layer: Algorithm 2 step by step, and what trimming takes out."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from textwrap import fill

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import ArrayLike, NDArray

from .. import grid
from ..contraction import contraction_pairs, occupancy_of
from ..grid import BoolArray, IntArray
from ..planar.paper import REASONS, PaperPath
from ..solid import VoxelPath
from .page import GREY, INK, PALE, page

_PANEL, _FOOT = 3.4, 0.7  # inches: width of a panel, room for the words under it
_INTERIOR, _BOUNDARY, _DANGLING, _BOARD = "#f7efcf", "#cfe0f2", "#f3c6c0", "#d9d4c9"
_CYCLE, _PATH, _JOINED, _MARK = "#1f5fa8", "#c77f00", "#222222", "#c1272d"


def planar_steps(mask: BoolArray, path: PaperPath) -> Figure:
    """Algorithm 2 on one region: voxel types, cycle, interior path, merged (Figures 5 and 7).

    Parameters
    ----------
    mask : (X, Y) bool
        The region Ω.
    path : PaperPath
        What `planar.paper_path` made of it; a step that failed is an empty panel with the reason.

    Examples
    --------
    >>> import numpy as np
    >>> from lineup import draw
    >>> from lineup.planar import paper_path
    >>> mask = np.ones((6, 7), bool)
    >>> figure = draw.planar_steps(mask, paper_path(mask, (2, 2), (3, 2)))
    >>> [axes.get_title() for axes in figure.axes]
    ['a  voxels of Ω', 'b  boundary cycle', 'c  interior path', 'd  long planar path']
    """
    figure, panels = _panels(mask, 4)
    boundary = _mask_of(path.boundary, mask.shape)
    dangling = _mask_of(path.removed, mask.shape)
    titles = ("voxels of Ω", "boundary cycle", "interior path", "long planar path")
    for letter, title, axes in zip("abcd", titles, panels, strict=True):
        axes.set_title(f"{letter}  {title}", fontsize=12, fontweight="bold", color=INK)
        _squares(axes, mask & ~boundary & ~dangling, _INTERIOR)
        _squares(axes, boundary, _BOUNDARY)
        _squares(axes, dangling, _DANGLING)
    lines = (path.boundary, path.interior, path.cells)
    for axes, cells, colour in zip(panels[1:], lines, (_CYCLE, _PATH, _JOINED), strict=True):
        _line(axes, cells, colour, closed=axes is panels[1])
    n_inner = int(mask.sum()) - len(path.boundary) - len(path.removed)
    _words(
        panels[0],
        f"{len(path.boundary)} on the boundary (blue), {n_inner} inside,\n"
        f"{len(path.removed)} dangling (red), removed first",
    )
    told = "; ".join(REASONS[code] for code in path.reasons) or "every assumption holds"
    _words(panels[1], f"{len(path.boundary)} voxels, an even number" if len(path.boundary) else "")
    _words(panels[2], f"{len(path.interior)} of {n_inner} voxels\nbetween the given ends")
    _words(panels[3], f"{len(path.cells)} of {int(mask.sum())} voxels\n{fill(told, 46)}")
    for axes in panels[2:]:
        _ends(axes, path.interior)
    if len(path.cells):
        _mark(panels[3], _merge_square(path))
    return figure


def merge(path: PaperPath) -> Figure:
    """How Algorithm 2 joins cycle and path over one unit square, seen near by (Figure 6).

    Parameters
    ----------
    path : PaperPath
        One that has cells.

    Raises
    ------
    ValueError
        If Algorithm 2 found no path.

    Examples
    --------
    >>> import numpy as np
    >>> from lineup import draw
    >>> from lineup.planar import paper_path
    >>> figure = draw.merge(paper_path(np.ones((6, 7), bool), (2, 2), (3, 2)))
    >>> [axes.get_title() for axes in figure.axes]
    ['cycle and path', 'one path']
    """
    if not len(path.cells):
        raise ValueError(f"there is nothing merged: {', '.join(path.reasons)}")
    square = _merge_square(path)
    mask = _mask_of(path.cells, tuple(path.cells.max(axis=0) + 1))
    figure, (before, after) = _panels(_window(mask, square), 2, _corner(square))
    for axes, title in ((before, "cycle and path"), (after, "one path")):
        axes.set_title(title, fontsize=12, fontweight="bold", color=INK)
        _squares(axes, mask, _INTERIOR)
        _mark(axes, square)
    _line(before, path.boundary, _CYCLE, closed=True)
    _line(before, path.interior, _PATH)
    _line(after, path.cells, _JOINED)
    _words(before, "two links face each other\nacross a unit square")
    _words(after, "its other two sides\ntake their place")
    return figure


def checkerboard(mask: BoolArray, path: PaperPath) -> Figure:
    """The two colours of voxels, and a boundary cycle that alternates them (Figure 10).

    Parameters
    ----------
    mask : (X, Y) bool
    path : PaperPath
        What `planar.paper_path` made of it.

    Examples
    --------
    >>> import numpy as np
    >>> from lineup import draw
    >>> from lineup.planar import paper_path
    >>> mask = np.ones((6, 7), bool)
    >>> len(draw.checkerboard(mask, paper_path(mask, (2, 2), (3, 2))).axes)
    2
    """
    figure, panels = _panels(mask, 2)
    x, y = np.indices(mask.shape)
    for axes, title in zip(panels, ("two colours", "boundary cycle"), strict=True):
        axes.set_title(title, fontsize=12, fontweight="bold", color=INK)
        _squares(axes, mask & ((x + y) % 2 == 0), _BOARD)
        _squares(axes, mask & ((x + y) % 2 == 1), "white")
    _line(panels[1], path.boundary, _CYCLE, closed=True)
    panels[1].plot(*path.boundary.T, ls="", marker="o", ms=4, color=_MARK, zorder=4)
    _words(panels[0], "neighbours differ in colour")
    _words(panels[1], f"{len(path.boundary)} voxels by turns of one colour\nand the other: even")
    return figure


def contraction(path: VoxelPath, pair: tuple[int, int] | None = None) -> Figure:
    """A contraction pair of a path and what is left once it is contracted (Figure 11).

    Parameters
    ----------
    pair : (i, j), optional
        Two steps of the path; by default its first pair of index 2 inside the solid, or the
        first of any index.

    Raises
    ------
    ValueError
        If the path has no contraction pair, or `pair` is none.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup import draw
    >>> path = lu.layered_path(lu.VoxelSolid(np.ones((6, 6, 3), bool)))
    >>> [axes.get_title() for axes in draw.contraction(path).axes]
    ['contraction pair of index 2', 'contracted']
    """
    i, j = _chosen_pair(path, pair)
    z = path.voxels[i, 2]
    region = occupancy_of(path)[:, :, z]
    around = path.voxels[[i, i + 1, j - 1, j], :2]
    figure, (before, after) = _panels(_window(region, around), 2, _corner(around))
    gone = np.arange(i + 1, j)
    for axes, title in ((before, f"contraction pair of index {len(gone)}"), (after, "contracted")):
        axes.set_title(title, fontsize=12, fontweight="bold", color=INK)
        _squares(axes, region, _INTERIOR)
        axes.plot(*path.voxels[[i, j], :2].T, ls="", marker="o", ms=9, color=_MARK, zorder=4)
    _squares(after, _mask_of(path.voxels[gone, :2], region.shape), "white")
    _runs(before, path.voxels, z)
    _runs(after, np.delete(path.voxels, gone, axis=0), z)
    _words(before, f"steps {i} and {j} of layer {z} are adjacent;\n{len(gone)} voxels between")
    _words(after, f"the path is {len(gone)} voxels shorter")
    return figure


def _chosen_pair(path: VoxelPath, pair: tuple[int, int] | None) -> tuple[int, int]:
    surface = grid.surface(occupancy_of(path))
    found = contraction_pairs(path, keep=np.zeros_like(surface)).tolist()
    if pair is not None and list(pair) in found:
        return pair
    if pair is not None or not found:
        raise ValueError(f"{pair or 'no two steps'} of the path form a contraction pair")
    inside = contraction_pairs(path, keep=surface).tolist()
    least = min(inside or found, key=lambda ij: (ij[1] - ij[0], ij[0]))
    return least[0], least[1]


def _panels(mask: BoolArray, n: int, corner: tuple[int, int] = (0, 0)) -> tuple[Figure, list[Axes]]:
    """Axes side by side for plans of a region whose first cell is `corner`."""
    width, depth = mask.shape
    height = _PANEL * depth / width
    figure = page(_PANEL * n, height + _FOOT + 0.5)
    panels = []
    for k in range(n):
        foot = _FOOT / (height + _FOOT + 0.5)
        share = height / (height + _FOOT + 0.5)
        axes = figure.add_axes((k / n + 0.03 / n, foot, 0.94 / n, share))
        axes.set_aspect("equal")
        axes.set_xlim(corner[0] - 0.6, corner[0] + width - 0.4)
        axes.set_ylim(corner[1] - 0.6, corner[1] + depth - 0.4)
        axes.axis("off")
        panels.append(axes)
    return figure, panels


def _corner(cells: IntArray) -> tuple[int, int]:
    """The least corner of a window of three cells round some cells."""
    x, y = cells.min(axis=0) - 3
    return max(int(x), 0), max(int(y), 0)


def _window(mask: BoolArray, cells: IntArray) -> BoolArray:
    """The part of a mask in the window round some cells."""
    x, y = _corner(cells)
    right, top = cells.max(axis=0) + 4
    return mask[x:right, y:top]


def _mask_of(cells: IntArray, shape: tuple[int, ...]) -> BoolArray:
    mask = np.zeros(shape, bool)
    mask[tuple(cells.T)] = True
    return mask


def _squares(axes: Axes, mask: BoolArray, face: str) -> None:
    squares = [Rectangle((x - 0.5, y - 0.5), 1, 1) for x, y in np.argwhere(mask).tolist()]
    axes.add_collection(PatchCollection(squares, facecolor=face, edgecolor=PALE, lw=0.8))


def _width(axes: Axes) -> float:
    """Points to a voxel."""
    return float(72 * axes.get_window_extent().width / axes.figure.dpi / np.ptp(axes.get_xlim()))


def _line(axes: Axes, cells: IntArray, colour: str, closed: bool = False) -> None:
    way = np.vstack([cells, cells[:1]]) if closed and len(cells) else cells
    axes.plot(*way.T, color=colour, lw=0.22 * _width(axes), solid_joinstyle="round", zorder=3)


def _runs(axes: Axes, voxels: IntArray, z: int) -> None:
    """The links of a path in one layer."""
    links = [(a[:2], b[:2]) for a, b in pairwise(voxels.tolist()) if a[2] == b[2] == z]
    width = 0.22 * _width(axes)
    axes.add_collection(LineCollection(links, colors=_JOINED, lw=width, capstyle="round", zorder=3))


def _ends(axes: Axes, cells: IntArray) -> None:
    if len(cells):
        axes.plot(*cells[[0, -1]].T, ls="", marker="*", ms=13, mfc="white", mec=INK, zorder=5)


def _mark(axes: Axes, square: IntArray) -> None:
    x, y = square.min(axis=0) - 0.5
    axes.add_patch(Rectangle((x, y), 2, 2, fill=False, ec=_MARK, lw=2, zorder=6))


def _merge_square(path: PaperPath) -> IntArray:
    """The four cells of the unit square where cycle and path were joined."""
    links = {frozenset(map(tuple, link)) for link in pairwise(path.cells.tolist())}
    cycle = path.boundary.tolist()
    old = [*pairwise([*cycle, cycle[0]]), *pairwise(path.interior.tolist())]
    gone: Sequence[ArrayLike] = [link for link in old if frozenset(map(tuple, link)) not in links]
    square: NDArray[np.int32] = np.array(gone, np.int32).reshape(-1, 2)
    return square


def _words(axes: Axes, text: str) -> None:
    axes.text(
        0.5, -0.03, text, transform=axes.transAxes, ha="center", va="top", fontsize=9, color=GREY
    )
