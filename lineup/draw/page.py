"""What the pictures in three dimensions share: a page, a picture on it, a caption."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase
from numpy.typing import ArrayLike

from ..grid import FloatArray
from ..solid import Folding, VoxelPath
from .bodies import joints
from .render import rendered
from .view import Body, View

INK, GREY, PALE = "#222222", "#666666", "#d5d5d5"
DPI = 100


def positions(chain: VoxelPath | Folding | ArrayLike) -> FloatArray:
    """The joints of a chain, however it is given."""
    if isinstance(chain, Folding):
        chain = chain.path
    return joints(chain.voxels if isinstance(chain, VoxelPath) else chain)


def page(width: float, height: float) -> Figure:
    """A white page of so many inches."""
    return Figure(figsize=(width, height), dpi=DPI, facecolor="white")


def picture(
    figure: FigureBase,
    place: tuple[float, float, float, float],
    bodies: Sequence[Body],
    view: View,
) -> Axes:
    """Axes at (left, bottom, width, height), in shares of the figure, with a picture of bodies."""
    axes = figure.add_axes(place)
    axes.axis("off")
    width, height = np.rint(axes.get_window_extent().size).astype(int).tolist()
    axes.imshow(rendered(bodies, view, width, height), aspect="auto", interpolation="auto")
    return axes


def literal(text: str) -> str:
    """A text for a figure as it stands: no dollar in it begins a formula."""
    return text.replace("$", r"\$")


def caption(axes: Axes, text: str) -> None:
    """The first line as a title, the others smaller under it, at the top of a picture."""
    title, _, rest = literal(text).partition("\n")
    axes.set_title(title, y=1.0, pad=-22, fontsize=14, fontweight="bold", color=INK)
    axes.annotate(
        rest,
        (0.5, 1.0),
        xytext=(0, -27),
        xycoords="axes fraction",
        textcoords="offset points",
        ha="center",
        va="top",
        fontsize=10,
        color=GREY,
    )
