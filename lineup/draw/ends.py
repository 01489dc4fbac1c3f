"""Where planar paths may start and end, so that neighbouring layers can be linked (Section 4.3)."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from ..assumptions import anatomy
from ..grid import BoolArray, IntArray
from ..planar.faces import Cell
from .page import INK
from .regions import (
    _BOUNDARY,
    _DANGLING,
    _INTERIOR,
    _JOINED,
    _MARK,
    _panels,
    _squares,
    _width,
    _words,
)

_EITHER, _OTHER = "#d8eed8", "#5cb85f"


def overlap(mask: BoolArray, following: BoolArray, start: Cell) -> Figure:
    """The interiors of two layers of the MSP, and where the first path may end (Section 4.3.1).

    Parameters
    ----------
    mask, following : (X, Y) bool
        The regions of nodes o_i and o_(i+1).
    start : (x, y)
        The starting voxel v_s of o_i.

    Raises
    ------
    ValueError
        If the regions are not of one shape.

    Examples
    --------
    >>> import numpy as np
    >>> from lineup import draw
    >>> mask = np.ones((6, 7), bool)
    >>> [axes.get_title() for axes in draw.overlap(mask, mask, (2, 2)).axes]
    ['layer of $o_i$', 'layer of $o_{i+1}$', '$I_i$, the common interior']
    """
    if mask.shape != following.shape:
        raise ValueError(f"regions must have one shape, got {mask.shape} and {following.shape}")
    figure, panels = _panels(mask, 3)
    first = _layer(panels[0], mask, "layer of $o_i$")
    second = _layer(panels[1], following, "layer of $o_{i+1}$")
    both = first & second
    x, y = np.indices(mask.shape)
    fit = both & ((x + y + sum(start)) % 2 == 1)
    _title(panels[2], "$I_i$, the common interior")
    _squares(panels[2], mask & ~both, "white")
    _squares(panels[2], both, _EITHER)
    _squares(panels[2], fit, _OTHER)
    for axes in (panels[0], panels[2]):
        axes.plot(*start, marker="*", ms=14, mfc="white", mec=INK, zorder=5)
    _words(panels[0], f"{int(first.sum())} interior voxels (yellow);\nthe star is $v_s(o_i)$")
    _words(panels[1], f"{int(second.sum())} interior voxels")
    _words(
        panels[2],
        f"{int(both.sum())} voxels, {int(fit.sum())} (dark) not of the colour of $v_s$:\n"
        "one of these becomes $v_e(o_i)$",
    )
    return figure


def shared_links(path: IntArray, mask: BoolArray, hanging: BoolArray) -> Figure:
    """The links of a planar path over which a node of an MSC can hang (Section 4.3.2).

    Parameters
    ----------
    path : (P, 2) int
        The planar path of o_(i-1).
    mask : (X, Y) bool
        Its region.
    hanging : (X, Y) bool
        The region of o_i, above or below.

    Raises
    ------
    ValueError
        If the regions are not of one shape.

    Examples
    --------
    >>> import numpy as np
    >>> from lineup import draw
    >>> from lineup.planar import paper_path
    >>> mask = np.ones((6, 7), bool)
    >>> cells = paper_path(mask, (2, 2), (3, 2)).cells
    >>> [axes.get_title() for axes in draw.shared_links(cells, mask, mask).axes]
    ['$p(o_{i-1})$', 'layer of $o_i$', 'links inside both']
    """
    if mask.shape != hanging.shape:
        raise ValueError(f"regions must have one shape, got {mask.shape} and {hanging.shape}")
    figure, panels = _panels(mask, 3)
    _title(panels[0], "$p(o_{i-1})$")
    _squares(panels[0], mask, "white")
    interior = _layer(panels[1], hanging, "layer of $o_i$")
    inside = links_inside(path, interior)
    _title(panels[2], "links inside both")
    _squares(panels[2], mask & ~interior, "white")
    _squares(panels[2], interior, _INTERIOR)
    for axes in (panels[0], panels[2]):
        axes.plot(*path.T, color=_JOINED, lw=0.16 * _width(axes), solid_joinstyle="round", zorder=3)
        axes.plot(*path[[0, -1]].T, ls="", marker="*", ms=13, mfc="white", mec=INK, zorder=5)
    thick = LineCollection(
        path[inside[:, None] + [0, 1]],
        colors=_MARK,
        linewidths=0.3 * _width(panels[2]),
        capstyle="round",
        zorder=4,
    )
    panels[2].add_collection(thick)
    _words(panels[0], f"{len(path)} voxels, ends are stars")
    _words(panels[1], f"{int(interior.sum())} interior voxels (yellow)")
    _words(
        panels[2], f"{len(inside)} links (red): one of these opens,\nand the path of $o_i$ goes in"
    )
    return figure


def links_inside(path: IntArray, interior: BoolArray) -> IntArray:
    """Steps k of a planar path such that cells k and k + 1 lie in an interior, both no end of it.

    Examples
    --------
    >>> import numpy as np
    >>> links_inside(np.array([(0, 0), (1, 0), (2, 0), (3, 0)]), np.ones((4, 1), bool)).tolist()
    [1]
    """
    held = interior[tuple(np.asarray(path).T)].copy()
    held[[0, -1]] = False
    steps: IntArray = np.flatnonzero([a and b for a, b in pairwise(held.tolist())]).astype(np.int32)
    return steps


def _layer(axes: Axes, mask: BoolArray, title: str) -> BoolArray:
    """Boundary, interior and dangling voxels of a region; its interior."""
    parts = anatomy(mask)
    dangling = np.zeros_like(mask)
    dangling[tuple(parts.removed.T)] = True
    _title(axes, title)
    _squares(axes, mask & ~parts.interior & ~dangling, _BOUNDARY)
    _squares(axes, dangling, _DANGLING)
    _squares(axes, parts.interior, _INTERIOR)
    return parts.interior


def _title(axes: Axes, title: str) -> None:
    axes.set_title(title, fontsize=12, fontweight="bold", color=INK)
