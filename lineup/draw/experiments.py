"""The rows of an experiment, drawn as its file says."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..experiment import Plot
from ..styled import check_names, heading, printed
from .page import GREY, INK, PALE, literal, page

_COLOURS = (
    *("#1b6ca8", "#d1495b", "#2c7a51", "#e0912f", "#7b5ea7", "#3ba7a0", "#8c5a3c", "#c06c9f"),
    *("#6b7a8f", "#a3a82b"),
)
_WIDTH, _HEIGHT = 8.6, 5.0  # inches
_DASH = 6.0  # points; lines at one height take turns, so that each is seen
_ROOM = 0.72  # of the distance between two texts on the axis, for the series side by side


def experiment(rows: pd.DataFrame, plot: Plot, title: str = "") -> Figure:
    """One column of the rows against another, a colour for each value of the columns `by`.

    Over numbers a line runs through the medians, with a pale dot for each row; over texts each
    row is a dot and the median a bar. A row without x is a level line across. Rows that failed,
    or that have no y, are left out, and counted below.

    Raises
    ------
    ValueError
        If the plot names a column that is not there, or y is not a number.

    Examples
    --------
    >>> from lineup import draw
    >>> from lineup.experiment import Plot
    >>> rows = pd.DataFrame({"voxels": [10, 20], "gap": [0.2, 0.1], "failure": ["", ""]})
    >>> figure = draw.experiment(rows, Plot(x="voxels", y="gap"))
    >>> figure.axes[0].get_xlabel()
    'voxels wanted'
    """
    check_names(rows, plot.names)
    good = rows[(rows["failure"] == "") & rows[plot.y].notna()]
    if not all(isinstance(v, (bool, int, float, np.number)) for v in good[plot.y]):
        raise ValueError(f"y of a plot must be a column of numbers, and {plot.y!r} is not")
    figure = page(_WIDTH, _HEIGHT)
    figure.set_layout_engine("constrained")
    axes = figure.add_subplot()
    over_texts = any(isinstance(v, str) for v in good[plot.x])
    series = _series(good, plot.by)
    if over_texts:
        _dots(axes, good, series, plot)
        marks = ["dot: one run, bar: median"]
    else:
        several = _lines(axes, series, plot)
        marks = ["line: median, pale dot: one run"] if several else []
    n_missing = len(rows) - len(good)
    if n_missing:
        marks.append(f"{n_missing} of the rows {'has' if n_missing == 1 else 'have'} no value here")
    _dress(axes, plot, plot.title or title, "; ".join(marks))
    if plot.by and series:
        figure.legend(loc="outside right center", frameon=False, title=_joined(plot.by))
    return figure


def _series(good: pd.DataFrame, by: list[str]) -> dict[str, pd.DataFrame]:
    """The rows of each colour, by its name in the legend."""
    if not by:
        return {"": good}
    names = [
        ", ".join(printed(n, None if pd.isna(v) else v) for n, v in zip(by, values, strict=True))
        for values in good[by].astype(object).itertuples(index=False)
    ]
    return {literal(n): good[[own == n for own in names]] for n in dict.fromkeys(names)}


def _joined(by: list[str]) -> str:
    return literal(", ".join(map(heading, by)))


def _colour(k: int) -> str:
    return _COLOURS[k % len(_COLOURS)]


def _lines(axes: Axes, series: dict[str, pd.DataFrame], plot: Plot) -> bool:
    """Draw a line for each colour; whether any goes through the medians of several rows."""
    several, n_levels = False, 0
    n_level = sum(bool(rows[plot.x].isna().any()) for rows in series.values())
    for k, (name, rows) in enumerate(series.items()):
        level = rows[rows[plot.x].isna()]
        rows = rows.dropna(subset=plot.x)
        if len(level):
            height = float(level[plot.y].median())
            style = (_DASH * n_levels, (_DASH, _DASH * max(n_level - 1, 1)))
            axes.axhline(height, color=_colour(k), linestyle=style, linewidth=1.8)
            axes.plot([], [], "--", color=_colour(k), label=name)
            n_levels += 1
        if len(rows):
            x, y = rows[plot.x].astype(float), rows[plot.y].astype(float)
            middle = y.groupby(x).median()
            label = None if len(level) else name
            if len(middle) < len(rows):
                several = True
                axes.scatter(x, y, s=16, color=_colour(k), alpha=0.35, linewidths=0)
            axes.plot(middle.index, middle, "o-", color=_colour(k), markersize=5, label=label)
    return several


def _dots(axes: Axes, good: pd.DataFrame, series: dict[str, pd.DataFrame], plot: Plot) -> None:
    texts = list(dict.fromkeys(good[plot.x].astype(str)))
    apart = _ROOM / len(series)
    for k, (name, rows) in enumerate(series.items()):
        shift = (k - (len(series) - 1) / 2) * apart
        place = np.array([texts.index(str(v)) for v in rows[plot.x]]) + shift
        y = rows[plot.y].to_numpy(float)
        axes.scatter(place, y, s=26, color=_colour(k), alpha=0.75, linewidths=0, label=name)
        for at in np.unique(place):
            ends = at - 0.4 * apart, at + 0.4 * apart
            axes.hlines(np.median(y[place == at]), *ends, color=_colour(k), linewidth=2.2)
    many = len(texts) > 7
    rotation, side = (30, "right") if many else (0, "center")
    names = [literal(text) for text in texts]
    axes.set_xticks(range(len(texts)), names, rotation=rotation, ha=side)
    for between in range(len(texts) - 1):
        axes.axvline(between + 0.5, color=PALE, linewidth=0.8)


def _dress(axes: Axes, plot: Plot, title: str, marks: str) -> None:
    for axis, name, label in (("x", plot.x, plot.x_label), ("y", plot.y, plot.y_label)):
        text: dict[str, Any] = {f"{axis}label": literal(label or heading(name))}
        axes.set(**text)
        if axis in plot.log:
            axes.set(**{f"{axis}scale": "log"})
            _plain_ticks(axes, axis)
    axes.set_title(literal(title), loc="left", fontsize=12, fontweight="bold", color=INK)
    axes.grid(axis="y", color=PALE, linewidth=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.text(
        1, -0.14, marks, transform=axes.transAxes, ha="right", va="top", fontsize=8, color=GREY
    )


def _plain_ticks(axes: Axes, axis: str) -> None:
    """Numbers as they are said, 1,000 rather than a power of ten."""
    from matplotlib.ticker import FuncFormatter, LogLocator

    ruler = axes.xaxis if axis == "x" else axes.yaxis
    ruler.set_major_locator(LogLocator(subs=(1, 2, 5)))
    ruler.set_major_formatter(FuncFormatter(lambda value, place: f"{value:,g}"))
    ruler.set_minor_formatter(FuncFormatter(lambda value, place: ""))
