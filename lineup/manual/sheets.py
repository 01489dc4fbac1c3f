"""Sheets of paper to draw on, in millimetres from the top left corner."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from ..draw.page import GREY, INK
from ..draw.view import Pixels
from ..grid import FloatArray

PAPERS = {"a4": (210.0, 297.0), "letter": (215.9, 279.4)}
"""Width and height, in millimetres."""

MARGIN = 15.0
POINT = 72 / 25.4
"""Points in a millimetre."""

RAMP = ListedColormap(matplotlib.colormaps["viridis"](np.linspace(0.0, 0.9, 256)))
"""Along a step, from dark to light, so that it is read in grey as well."""


@dataclass(frozen=True)
class Sheet:
    """A page: a figure of one pair of axes in millimetres, y downwards."""

    figure: Figure
    axes: Axes
    width: float
    height: float

    @property
    def right(self) -> float:
        """Where the right margin begins."""
        return self.width - MARGIN


def blank(paper: str) -> Sheet:
    """An empty sheet."""
    width, height = PAPERS[paper]
    figure = Figure(figsize=(width / 25.4, height / 25.4), facecolor="white")
    axes = figure.add_axes((0, 0, 1, 1))
    axes.axis("off")
    axes.set_xlim(0, width)
    axes.set_ylim(height, 0)
    return Sheet(figure, axes, width, height)


def check_sheet(paper: str, pitch_mm: float) -> None:
    """Raise a ValueError if there is no such paper, or the pitch is none."""
    if paper not in PAPERS:
        raise ValueError(f"unknown paper {paper!r}; known: {', '.join(PAPERS)}")
    if not (np.isfinite(pitch_mm) and pitch_mm > 0):
        raise ValueError(f"pitch_mm must be a positive number, got {pitch_mm}")


def say(sheet: Sheet, x: float, y: float, text: str, size: float = 10, **style: Any) -> None:
    """Write text with its first line's top at y; `style` is matplotlib's."""
    given: dict[str, Any] = {"va": "top", "color": INK, "linespacing": 1.35} | style
    sheet.axes.text(x, y, text, fontsize=size, **given)


def box(sheet: Sheet, left: float, top: float, width: float, height: float, **style: Any) -> None:
    """A rectangle; `style` is matplotlib's."""
    given: dict[str, Any] = {"facecolor": "none", "edgecolor": INK, "linewidth": 1.0} | style
    sheet.axes.fill(
        [left, left + width, left + width, left], [top, top, top + height, top + height], **given
    )


def show(sheet: Sheet, left: float, top: float, width: float, height: float, image: Pixels) -> None:
    """Put a picture on the sheet, as it is."""
    sheet.axes.imshow(
        image,
        extent=(left, left + width, top + height, top),
        aspect="auto",
        interpolation="none",
    )


def line(sheet: Sheet, points: Any, width_mm: float, colour: Any = INK, **style: Any) -> None:
    """A line through (n, 2) points, so many millimetres wide, with round ends."""
    x, y = np.asarray(points, float).T
    given = {"solid_capstyle": "round", "solid_joinstyle": "round"} | style
    sheet.axes.plot(x, y, color=colour, linewidth=width_mm * POINT, **given)


def arrow(sheet: Sheet, start: Any, stop: Any, width_mm: float = 0.6, colour: Any = INK) -> None:
    """An arrow between two points."""
    sheet.axes.annotate(
        "",
        xy=stop,
        xytext=start,
        arrowprops={
            "arrowstyle": "-|>",
            "color": colour,
            "linewidth": width_mm * POINT,
            "mutation_scale": 12,
            "shrinkA": 0,
            "shrinkB": 0,
        },
    )


def wedge(
    sheet: Sheet, at: FloatArray, towards: FloatArray, size: float, facecolor: Any, **style: Any
) -> None:
    """A triangle of so many millimetres at a point, its tip `towards` a unit vector."""
    across = np.array([-towards[1], towards[0]])
    corners = np.array([at + 0.5 * size * towards, at, at]) + np.outer(
        [0, 1, -1], 0.45 * size * across
    )
    corners[1:] -= 0.4 * size * towards
    x, y = corners.T
    given: dict[str, Any] = {"edgecolor": INK, "linewidth": 0.6, "zorder": 6} | style
    sheet.axes.fill(x, y, facecolor=facecolor, **given)


def compass(sheet: Sheet, x: float, y: float) -> None:
    """A small arrow to the north."""
    arrow(sheet, (x, y + 4), (x, y - 3), 0.4)
    say(sheet, x, y + 4.5, "N", 8, ha="center", fontweight="bold")


def title(sheet: Sheet, text: str, below: str = "") -> None:
    """The head of a page."""
    say(sheet, MARGIN, 13, text, 20, fontweight="bold")
    say(sheet, MARGIN, 24, below, 10.5, color=GREY)


def foot(sheet: Sheet, text: str) -> None:
    """The foot of a page, under a line."""
    y = sheet.height - 12
    line(sheet, [(MARGIN, y), (sheet.right, y)], 0.2, GREY)
    say(sheet, sheet.right, y + 1.5, text, 8, color=GREY, ha="right")
