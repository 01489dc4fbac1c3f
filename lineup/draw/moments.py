"""Moments of an unfolding (Figures 1 and 18)."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure, FigureBase

from ..grid import FloatArray
from ..solid import Folding, Motion
from .bodies import chain_body
from .page import GREY, INK, PALE, page, picture
from .story import scenes_of
from .view import View, colours

PANEL = (5.2, 4.3)  # inches


def unfolding(folding: Folding | Motion, moments: int = 6) -> Figure:
    """Moments of an unfolding, at equal numbers of moves from the folded pose to the last.

    Each is seen by a camera that stays where it saw the folded chain. Since the straightened part
    of the chain soon leaves its view, the whole chain stands beside it, smaller and smaller. The
    share still folded is the number of joints that bend, relative to the folded pose. A motion from
    shape to shape is told as in `animation`.

    Raises
    ------
    ValueError
        If `moments` is less than 2.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup import draw
    >>> folding = lu.fold(lu.VoxelSolid(np.ones((3, 2, 1), bool)), rounds=2, trial_rounds=2)
    >>> page = draw.unfolding(folding, moments=2)
    >>> [axes.get_title(loc="left") for axes in page.axes][::2]
    ['folded', 'straight']
    """
    if moments < 2:
        raise ValueError(f"moments must be at least 2, got {moments}")
    motion = folding.motion if isinstance(folding, Folding) else folding
    columns = min(3, moments)
    rows = -(-moments // columns)
    figure = page(PANEL[0] * columns, PANEL[1] * rows)
    panels = figure.subfigures(rows, columns, squeeze=False).ravel()
    for panel, (moment, view) in zip(panels, scenes_of(motion, moments), strict=False):
        moment_panel(panel, moment.pose, view, moment.title, moment.where)
    return figure


def moment_panel(panel: FigureBase, pose: FloatArray, view: View, title: str, where: str) -> None:
    """One moment: the camera's picture, and the whole chain in a column to the right of it."""
    width, height = PANEL
    side = 3.6
    axes = picture(
        panel,
        (0.15 / width, 0.1 / height, side / width, side / height),
        [chain_body(_in_sight(pose, view))],
        view,
    )
    axes.set_title(title, loc="left", pad=18, fontsize=14, fontweight="bold", color=INK)
    axes.text(0, 1.015, where, transform=axes.transAxes, fontsize=10, color=GREY)
    _frame(axes)
    column = panel.add_axes((3.75 / width, 0.1 / height, 1.3 / width, side / height))
    _whole_chain(column, pose, view, (1.3, side))


def _frame(axes: Axes) -> None:
    axes.axis("on")
    axes.set_xticks([])
    axes.set_yticks([])
    for edge in axes.spines.values():
        edge.set_color(PALE)


def _in_sight(pose: FloatArray, view: View) -> FloatArray:
    """The pose, moved so that its nearest joint is in the middle if none of it is in the view."""
    seen = view.seen(pose)
    if (np.abs(seen[:, :2]) < view.half_height).all(axis=1).any():
        return pose
    nearest = int(np.argmin((seen[:, :2] ** 2).sum(axis=1)))
    moved: FloatArray = pose + view.centre - pose[nearest]
    return moved


def _whole_chain(axes: Axes, pose: FloatArray, view: View, size: tuple[float, float]) -> None:
    """The whole chain as a line in a frame of that size, seen along the direction of the view."""
    flat = view.seen(pose)[:, :2]
    lines = np.stack([flat[:-1], flat[1:]], axis=1)
    shades = colours(len(lines)) / 255
    axes.add_collection(
        LineCollection(list(lines), colors=shades, linewidths=2, capstyle="projecting")
    )
    low, high = flat.min(axis=0), flat.max(axis=0)
    centre = (low + high) / 2
    half = 0.55 * float(((high - low) / size).max()) * np.array(size)
    axes.set_xlim(centre[0] - half[0], centre[0] + half[0])
    axes.set_ylim(centre[1] - half[1], centre[1] + half[1])
    _frame(axes)
    reach = int(np.rint(np.ptp(pose, axis=0).max())) + 1
    axes.set_title(f"whole chain,\n{reach:,} voxels across", fontsize=8, color=GREY, pad=4)
