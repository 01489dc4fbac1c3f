"""What orientations of a model are worth: a map of directions, and what trades with what."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle

from .page import GREY, INK, PALE, page

_MAP = "viridis"
_MARKS = {"upright": "s", "axis": "D", "rest": "v", "sphere": "o", "refined": "^"}
_BEST = "#d33a2c"
_MOST_MSCS = 12  # beyond which the colour no longer tells


def orientations(table: pd.DataFrame) -> Figure:
    """A map of the directions that were tried, and coverage beside likeness to the mesh.

    Left, the sphere of directions seen from above and from below, coloured by the coverage of the
    layered path: a mark in the middle of the upper disc is upright. Right, the same orientations
    by coverage and IoU; the colour counts MSCs, the Pareto front is ringed, an arrow leads from
    the layered to the folded coverage, and the first row of the table is red.

    Parameters
    ----------
    table : DataFrame
        What `lineup.rank_orientations` returned.

    Raises
    ------
    ValueError
        If no orientation has a solid.

    Examples
    --------
    >>> import lineup as lu
    >>> from lineup import draw
    >>> table = lu.rank_orientations("duck", voxels=60, evaluations=3, finalists=1)
    >>> [axes.get_title() for axes in draw.orientations(table).axes][:2]
    ['up is in the upper half', 'up is in the lower half']
    """
    known = table[table["reason"] == "ok"]
    if known.empty:
        raise ValueError("no orientation in the table has a solid: there is nothing to draw")
    figure = page(12.0, 5.4)
    places = [(0.02, 0.47, 0.27, 0.44), (0.02, 0.0, 0.27, 0.44)]
    for place, sign, half in zip(places, (1, -1), ("upper", "lower"), strict=True):
        axes = figure.add_axes(place)
        _disc(axes, known, sign)
        axes.set_title(f"up is in the {half} half", fontsize=10, color=INK, pad=2)
    _trade(figure, figure.add_axes((0.37, 0.12, 0.52, 0.76)), known)
    return figure


def _disc(axes: Axes, table: pd.DataFrame, sign: int) -> None:
    """Half of the sphere, by Lambert's projection, which keeps areas."""
    axes.set_aspect("equal")
    axes.axis("off")
    axes.add_patch(_circle(1.0, PALE))
    axes.add_patch(_circle(float(np.sqrt(1 - np.cos(np.pi / 4))), PALE))
    norm = (float(table["layered"].min()), float(table["layered"].max()))
    half = table[np.sign(table["up_z"] + 1e-12) == sign]
    for row in half.iloc[::-1].to_dict("records"):
        wide = np.hypot(row["up_x"], row["up_y"])
        stretch = np.sqrt(1 - abs(row["up_z"])) / wide if wide > 1e-9 else 0.0
        best = row["up_x"] == table["up_x"].iloc[0] and row["up_y"] == table["up_y"].iloc[0]
        axes.scatter(
            row["up_x"] * stretch,
            row["up_y"] * stretch,
            c=[row["layered"]],
            cmap=_MAP,
            vmin=norm[0],
            vmax=norm[1] + 1e-9,
            marker=_MARKS[row["kind"]],
            s=70,
            edgecolors=_BEST if best and row["up_z"] == table["up_z"].iloc[0] else "white",
            linewidths=2.0 if best else 0.6,
        )
    axes.set_xlim(-1.1, 1.1)
    axes.set_ylim(-1.1, 1.1)


def _circle(radius: float, colour: str) -> Circle:
    return Circle((0, 0), radius, fill=False, color=colour, lw=1.2)


def _trade(figure: Figure, axes: Axes, table: pd.DataFrame) -> None:
    front = table[table["pareto"]]
    axes.scatter(
        front["layered"], front["iou"], s=190, facecolors="none", edgecolors=INK, linewidths=1.2
    )
    for row in table[table["folded"].notna()].to_dict("records"):
        axes.annotate(
            "",
            (row["folded"], row["iou"]),
            (row["layered"], row["iou"]),
            arrowprops={"arrowstyle": "->", "color": GREY, "lw": 1.2},
            annotation_clip=False,
        )
    shown = None
    for kind, mark in _MARKS.items():
        of = table[table["kind"] == kind]
        if of.empty:
            continue
        counts = of["mscs"].clip(upper=_MOST_MSCS)
        shown = axes.scatter(
            of["layered"], of["iou"], c=counts, cmap="cividis_r", vmin=0, vmax=_MOST_MSCS,
            marker=mark, s=70, edgecolors="white", linewidths=0.6,
        )  # fmt: skip
    best = table.iloc[0]
    axes.plot(best["layered"], best["iou"], "o", ms=15, mfc="none", mec=_BEST, mew=2.2)
    axes.set_title(
        f"{len(table)} orientations, {len(front)} on the Pareto front (ringed); red: the best",
        fontsize=11,
        color=INK,
    )
    _frame(axes, table)
    if shown is not None:
        bar = figure.colorbar(shown, cax=figure.add_axes((0.92, 0.12, 0.012, 0.76)))
        bar.set_label(f"MSCs, {_MOST_MSCS} or more in one colour", fontsize=9)


def _frame(axes: Axes, table: pd.DataFrame) -> None:
    marks = [
        Line2D([], [], ls="", marker=mark, color=GREY, ms=8, label=kind)
        for kind, mark in _MARKS.items()
        if (table["kind"] == kind).any()
    ]
    axes.legend(handles=marks, loc="best", frameon=False, fontsize=9)
    most = float(np.nanmax(table[["layered", "folded"]].to_numpy(float)))
    axes.set_xlim(float(table["layered"].min()) - 0.005, most + 0.005)
    axes.set_xlabel("coverage: layered path; arrow: folded", fontsize=10, color=INK)
    axes.set_ylabel("IoU with the mesh", fontsize=10, color=INK)
    axes.grid(color=PALE, lw=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
