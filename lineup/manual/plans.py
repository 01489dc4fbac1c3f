"""One layer from above, with what a step puts there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.patches import Rectangle

from ..draw.page import GREY, INK
from ..grid import FloatArray, IntArray
from .actions import HEAD, TAIL, Action
from .assembly import Assembly
from .sheets import POINT, RAMP, Sheet, line, say, wedge
from .stretches import sign

PIECE, HINGE = 0.6, 0.15
"""Width of a bar, in cells."""

BELOW, HERE, EMPTY, GRID = "#ececec", "#c4c4c4", "#ffffff", "#bbbbbb"
TENTH = 10
_UP, _DOWN = np.array([0.0, -1.0]), np.array([0.0, 1.0])


@dataclass(frozen=True)
class Plan:
    """A layer on a sheet: cells of `cell` millimetres, row 1 at the foot.

    Attributes
    ----------
    left, top : float
        Corner of the grid, in millimetres.
    size : (int, int)
        Columns and rows.
    first : (int, int)
        The column and the row that it begins with.
    """

    left: float
    top: float
    cell: float
    size: tuple[int, int]
    first: tuple[int, int] = (1, 1)

    def at(self, places: IntArray) -> FloatArray:
        """Centres of the cells of (n, 3) places, in millimetres on the sheet."""
        across, up = np.moveaxis(np.asarray(places, float)[..., :2] - self.first, -1, 0)
        x = self.left + self.cell * (across + 0.5)
        y = self.top + self.cell * (self.size[1] - up - 0.5)
        return np.stack([x, y], axis=-1)

    def inside(self, places: IntArray) -> IntArray:
        """Those of (n, 3) places that are on it, in any layer."""
        across = places[:, :2] - self.first
        kept: IntArray = places[((across >= 0) & (across < self.size)).all(axis=1)]
        return kept


def draw_plan(
    sheet: Sheet, plan: Plan, assembly: Assembly, old: IntArray, laid: Sequence[Action], layer: int
) -> None:
    """Draw what `laid`, put in place after the joints `old`, adds in a layer.

    Cells are pale where the layer below is filled and grey where this one is; hatched ones lie
    below voxels that are there already. Thick bars are printed pieces, thin ones hinges, dark to
    light in the order in which they are laid, which arrows show. Triangles tell where the chain
    leaves for the layer above or below (dark) and where it comes from there (white). A `sign`
    stands in the corner of the cell in which its hinge leaves the piece.
    """
    places = assembly.places
    ground(sheet, plan, places[old], layer)
    shades = RAMP(np.linspace(0, 1, len(laid)))
    bars = [_Bar(action, places, shade) for action, shade in zip(laid, shades, strict=True)]
    _draw_bars(sheet, plan, bars, layer)
    for bar in bars:
        _draw_way(sheet, plan, bar, layer)
    _numbers(sheet, plan, assembly, laid, layer)
    for action in laid:
        what = sign(assembly, action)
        if what and places[action.before, 2] == layer:
            x, y = plan.at(places[action.before]).tolist()
            sign_mark(sheet, x, y, what, plan.cell)


class _Bar:
    """The bar that a voxel is laid by, from the one before it at its end."""

    def __init__(self, action: Action, places: IntArray, shade: Any) -> None:
        self.start, self.stop = places[action.before], places[action.joint]
        self.piece = not action.lays_hinge
        self.shade = shade

    @property
    def climb(self) -> int:
        return int(self.stop[2] - self.start[2])

    @property
    def is_dark(self) -> bool:
        return bool(np.dot(self.shade[:3], (0.299, 0.587, 0.114)) < 0.5)


def ground(sheet: Sheet, plan: Plan, there: IntArray, layer: int) -> None:
    """The grid, and what is there already in this layer and in that below."""
    there = plan.inside(there)
    cells = np.stack(np.divmod(np.arange(np.prod(plan.size)), plan.size[1]), axis=1)
    fills = (
        (cells + plan.first, EMPTY),
        (there[there[:, 2] == layer - 1], BELOW),
        (there[there[:, 2] == layer], HERE),
    )
    for places, colour in fills:
        squares = [_square(plan, place) for place in places]
        sheet.axes.add_collection(
            PatchCollection(squares, facecolor=colour, edgecolor=GRID, linewidth=0.4, zorder=1)
        )
    roof = np.unique(there[there[:, 2] > layer, :2], axis=0)
    sheet.axes.add_collection(
        PatchCollection(
            [_square(plan, place) for place in roof],
            facecolor="none",
            edgecolor="#8a8a8a",
            hatch="////",
            linewidth=0,
            zorder=1.5,
        )
    )
    _ticks(sheet, plan)


def base_bar(sheet: Sheet, plan: Plan, assembly: Assembly, layer: int) -> None:
    """The base, white: its piece, or its hinge."""
    a, b = assembly.base
    places = assembly.places[[a, b]]
    here = plan.at(places[places[:, 2] == layer])
    width = plan.cell * (PIECE if a % 2 else HINGE)
    for colour, wider, zorder in ((INK, 0.9, 2.0), ("white", 0.0, 3.0)):
        if len(here) == 2:
            line(sheet, here, width + wider, colour, zorder=zorder)
        for at in here:
            line(sheet, [at, at], plan.cell * PIECE + wider, colour, zorder=zorder)


def _square(plan: Plan, place: IntArray) -> Rectangle:
    x, y = (plan.at(place) - plan.cell / 2).tolist()
    return Rectangle((x, y), plan.cell, plan.cell)


def _ticks(sheet: Sheet, plan: Plan) -> None:
    """Numbers of columns under the grid and of rows beside it: all, or every fifth."""
    size = min(8.0, 1.6 * plan.cell + 2.5)
    foot = plan.top + plan.size[1] * plan.cell
    column, row = plan.first
    for k in _ticked(column, plan.size[0], plan.cell):
        x, _ = plan.at(np.array([k, row])).tolist()
        say(sheet, x, foot + 0.8, str(k), size, ha="center", color=GREY)
    for k in _ticked(row, plan.size[1], plan.cell):
        _, y = plan.at(np.array([column, k])).tolist()
        say(sheet, plan.left - 1.2, y, str(k), size, ha="right", va="center", color=GREY)


def _ticked(first: int, n: int, cell: float) -> list[int]:
    every = 1 if cell > 7 else 5
    return [k for k in range(first, first + n) if k in (1, first) or k % every == 0]


def _draw_bars(sheet: Sheet, plan: Plan, bars: Sequence[_Bar], layer: int) -> None:
    """Pieces, the ends of pieces, and over them hinges, each with an outline."""
    here = [bar for bar in bars if bar.stop[2] == layer]
    level = [bar for bar in here if bar.climb == 0]
    thick = [(plan.at(np.stack([bar.stop, bar.stop])), bar.shade) for bar in here]
    thick += [(plan.at(np.stack([bar.start, bar.stop])), bar.shade) for bar in level if bar.piece]
    thin = [(plan.at(np.stack([bar.start, bar.stop])), bar.shade) for bar in level if not bar.piece]
    width = plan.cell * np.array([PIECE, HINGE])
    # The outline of a hinge is dark where it leaves its pieces, and white over them.
    for segments, wide, outline, zorder in (
        (thick, width[0] + 0.7, INK, 2.0),
        (thin, width[1] + 0.7, INK, 2.0),
        (thick, width[0], None, 3.0),
        (thin, width[1] + 0.5, "white", 3.4),
        (thin, width[1], None, 3.5),
    ):
        collection = LineCollection(
            [ends for ends, _ in segments],
            colors=[outline or shade for _, shade in segments],
            linewidths=float(wide) * POINT,
            capstyle="round",
            zorder=zorder,
        )
        sheet.axes.add_collection(collection)


def _draw_way(sheet: Sheet, plan: Plan, bar: _Bar, layer: int) -> None:
    """An arrow on a piece, and triangles where a bar stands upright."""
    start, stop = plan.at(bar.start), plan.at(bar.stop)
    size = 0.34 * plan.cell
    if bar.climb == 0:
        if bar.stop[2] == layer and bar.piece:
            colour = "white" if bar.is_dark else INK
            way = (stop - start) / plan.cell
            wedge(sheet, (start + stop) / 2, way, 0.3 * plan.cell, colour, edgecolor="none")
        return
    tip = _UP if bar.climb > 0 else _DOWN
    aside = 0.27 * plan.cell
    if bar.start[2] == layer:
        wedge(sheet, start + np.array([aside, -aside]), tip, size, INK, edgecolor="white")
    if bar.stop[2] == layer:
        wedge(sheet, stop - aside, tip, size, "white")


def _numbers(
    sheet: Sheet, plan: Plan, assembly: Assembly, laid: Sequence[Action], layer: int
) -> None:
    """Numbers of blocks at their hinges: an end's first (black), its last (square), each tenth."""
    for end in (HEAD, TAIL):
        blocks = list(dict.fromkeys(a.joint // 2 for a in laid if a.end == end))
        for block in blocks:
            places = assembly.places[
                [a.joint for a in laid if (a.joint // 2, a.end) == (block, end)]
            ]
            kind = "first" if block == blocks[0] else "last" if block == blocks[-1] else ""
            # The number of an upright hinge is in the layer of its voxel that comes first.
            if places[0, 2] != layer or not (kind or (block + 1) % TENTH == 0):
                continue
            x, y = plan.at(places[places[:, 2] == layer]).mean(axis=0).tolist()
            number_mark(sheet, x, y, block + 1, plan.cell, kind)


def sign_mark(sheet: Sheet, x: float, y: float, what: str, cell: float) -> None:
    """A sign at the corner of the cell about a point, where no bar is."""
    at = 0.34 * cell
    sheet.axes.text(
        x + at,
        y + at,
        what,
        fontsize=max(5.0, min(12.0, 0.42 * cell * POINT)),
        ha="center",
        va="center",
        color=INK,
        fontweight="bold",
        zorder=8,
        bbox={"boxstyle": "circle,pad=0.02", "facecolor": "white", "edgecolor": "none"},
    )


def number_mark(sheet: Sheet, x: float, y: float, number: int, cell: float, kind: str) -> None:
    """The number of a block: white on black at the start, in a square at the end, else a circle."""
    ink, paper = ("white", INK) if kind in ("first", "last") else (INK, "white")
    sheet.axes.text(
        x,
        y,
        str(number),
        fontsize=max(4.0, min(8.0, 0.29 * cell * POINT)),
        ha="center",
        va="center",
        color=ink,
        zorder=9,
        bbox={
            "boxstyle": "square,pad=0.25" if kind == "last" else "circle,pad=0.18",
            "facecolor": paper,
            "edgecolor": "white" if paper == INK else INK,
            "linewidth": 0.7,
        },
    )
