"""Numbers of a table as dots, a line a row: ours beside the paper's, method beside method."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from .page import GREY, INK, PALE, page

_WIDTH, _ROW, _HEAD, _FOOT = 9.0, 0.3, 0.95, 0.75  # inches
_LETTER = 0.085  # inches of a row's name for each letter
_APART = 0.07  # of a line: between dots of neighbouring columns, so that equal ones are all seen
_COLOURS = ("#c43c39", "#1f5fa8", "#2c7a51", "#e8a33d", "#7a4fa3", "#4aa5b0", "#8a6d3b", "#555555")
_MARKERS = "Dosv^Pp*"


def dots(
    table: pd.DataFrame, axis: str, title: str = "", log: bool = False, mark: float | None = None
) -> Figure:
    """A line for each row of a table, on it a dot for each column that has a number there.

    Dots of one line are a little apart up and down, so that equal numbers are all seen.

    Parameters
    ----------
    table : DataFrame
        Numbers; its index names the lines, its columns (at most eight) the dots.
    axis : str
        What the numbers are, with their unit.
    log : bool
        Whether equal steps are equal factors; all numbers must then be positive.
    mark : float, optional
        Where to draw a line upright, such as a limit or a time to compare with.

    Raises
    ------
    ValueError
        If the table has no row, or no column or more than eight, or a number that cannot be
        placed.

    Examples
    --------
    >>> import pandas as pd
    >>> from lineup import draw
    >>> table = pd.DataFrame({"paper": [0.9, None], "ours": [0.95, 0.99]}, ["bunny", "duck"])
    >>> [text.get_text() for text in draw.dots(table, "coverage").axes[0].get_yticklabels()]
    ['bunny', 'duck']
    """
    values = _checked(table, log)
    names = [str(name) for name in table.index]
    left = (0.35 + _LETTER * max(map(len, names))) / _WIDTH
    height = _HEAD + _FOOT + _ROW * len(names)
    figure = page(_WIDTH, height)
    axes = figure.add_axes((left, _FOOT / height, 0.97 - left, _ROW * len(names) / height))
    if log:
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.10g}"))
    for line, row in enumerate(values):
        there = row[np.isfinite(row)]
        if len(there):
            axes.plot([there.min(), there.max()], [line, line], color=PALE, lw=2, zorder=1)
    _place(axes, values, [str(name) for name in table.columns])
    if mark is not None:
        axes.axvline(mark, color=INK, lw=1, ls="--", zorder=2)
    axes.set_yticks(range(len(names)), names, fontsize=10, color=INK)
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.set_xlabel(axis, fontsize=10, color=INK)
    axes.tick_params(axis="x", labelsize=9, colors=GREY)
    axes.grid(axis="x", color=PALE, lw=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.tick_params(axis="y", length=0)
    figure.text(0.015, 1 - 0.28 / height, title, fontsize=13, fontweight="bold", color=INK)
    key = (0.01, 1 - 0.88 / height)
    figure.legend(loc="lower left", bbox_to_anchor=key, ncols=8, frameon=False, columnspacing=1.2)
    return figure


def _place(axes: Axes, values: np.ndarray, names: list[str]) -> None:
    """The dots of each column, those of neighbouring columns a little apart."""
    for column, name in enumerate(names):
        axes.scatter(
            values[:, column],
            np.arange(len(values)) + _APART * (column - (len(names) - 1) / 2),
            s=38,
            color=_COLOURS[column],
            marker=_MARKERS[column],
            label=name,
            zorder=3,
        )


def _checked(table: pd.DataFrame, log: bool) -> np.ndarray:
    n_rows, n_columns = table.shape
    if not n_rows or not 0 < n_columns <= len(_COLOURS):
        raise ValueError(
            f"dots are drawn of one row or more and of 1 to {len(_COLOURS)} columns, "
            f"got {n_rows} rows and {n_columns} columns"
        )
    values: np.ndarray = table.to_numpy(float)
    wrong = np.isinf(values) | (log & (values <= 0))
    if wrong.any():
        row, column = np.argwhere(wrong)[0].tolist()
        need = "positive and finite" if log else "finite"
        raise ValueError(
            f"numbers here must be {need}, got {values[row, column]:g} for "
            f"{table.index[row]}, {table.columns[column]}"
        )
    return values
