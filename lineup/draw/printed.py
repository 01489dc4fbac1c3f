"""The printed block: its axes and parts, its joint states, its slots (Figures 2 and 16)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from ..block import Block, solids
from ..block.parts import NECK, part_of, slot_half_width_mm
from ..grid import FloatArray
from .page import GREY, INK, PALE, page, picture
from .view import Triangles, View, view_of

_SIZE = 10.0
"""Edge of a voxel in the units of a picture: shadows are made for things some units large."""

_SEGMENTS = 64  # that rounds look round

_FIRST, _SECOND, _THIRD, _STEEL = "#e8a33d", "#4c8fd6", "#6bb36b", "#6a7078"
_RED = "#c43c39"


def block(block: Block) -> Figure:
    """A block with its five axes, two blocks taken apart, and joint states (Figure 2).

    Where capsules swivel, one is taken apart, too.

    Examples
    --------
    >>> from lineup import Block, draw
    >>> [axes.get_title() for axes in draw.block(Block()).axes][:2]
    ['a  a block', 'b  two blocks, taken apart']
    """
    block = _smooth(block)
    figure = page(13, 7.2)
    _axes_panel(figure, (0.0, 0.4, 0.4, 0.53), block)
    _apart_panel(figure, (0.4, 0.4, 0.6, 0.53), block)
    most = block.bend_deg
    in_neck = ", in the neck" if block.snap_mm > 0 else ""
    states = (
        ("straight", (0, 0), (0, 0)),
        (f"$z_1$ = 45°{in_neck}", (0, 0.5), (0, 0)),
        (f"$z_1$ = {most:g}°", (0, most / 90), (0, 0)),
        ("$y_2$ = −90°", (0, 0), (1, 0)),
        ("$z_1$ = $z_2$ = 90°, a U", (0, 1), (0, 1)),
        ("$z_1$ = 90°, $y_2$ = −90°", (0, 1), (1, 0)),
    )
    for k, (title, first, second) in enumerate(states):
        place = (k / len(states), 0.0, 1 / len(states), 0.29)
        axes, _ = _shown(figure, place, _bent(block, first, second), -50, 28, 0.9)
        axes.set_title(title, fontsize=11, color=INK, y=0.98)
    figure.text(0.012, 0.37, "c  joint states", fontsize=13, fontweight="bold", color=INK)
    return figure


def slots(block: Block) -> Figure:
    """The ball in its socket, cut open; the four slots end on; how wide they are (Figure 16).

    Examples
    --------
    >>> from lineup import Block, draw
    >>> [axes.get_title() for axes in draw.slots(Block()).axes]
    ['a  cut open', 'b  end on', 'c  width of a slot']
    """
    block = _smooth(block)
    figure = page(13, 4.4)
    _cut_panel(figure, (0.0, 0.0, 0.43, 0.92), block)
    _end_on_panel(figure, (0.43, 0.0, 0.27, 0.92), block)
    axes = figure.add_axes((0.75, 0.14, 0.235, 0.78))
    _width_panel(axes, block)
    for panel, title in zip(figure.axes, ("cut open", "end on", "width of a slot"), strict=True):
        _titled(panel, f"{'abc'[figure.axes.index(panel)]}  {title}")
    return figure


def _smooth(block: Block) -> Block:
    return replace(block, segments=max(block.segments, _SEGMENTS))


def _titled(axes: Axes, title: str) -> None:
    axes.set_title(title, fontsize=13, fontweight="bold", color=INK)


def _body(block: Block, pieces: Sequence[tuple[Any, str]]) -> Triangles:
    """Solids of manifold3d in colours, as one body."""
    meshes = [(part_of(solid), colour) for solid, colour in pieces]
    counts = np.cumsum([0] + [len(mesh.vertices) for mesh, _ in meshes])
    scale = _SIZE / block.pitch_mm
    return Triangles(
        scale * np.concatenate([mesh.vertices for mesh, _ in meshes]),
        np.concatenate([mesh.faces + k for (mesh, _), k in zip(meshes, counts, strict=False)]),
        np.concatenate([np.tile(_rgb(c), (len(mesh.vertices), 1)) for mesh, c in meshes]),
    )


def _rgb(colour: str) -> Any:
    return np.frombuffer(bytes.fromhex(colour[1:]), np.uint8)


def _shown(
    figure: Figure,
    place: tuple[float, float, float, float],
    pieces: tuple[Block, list[tuple[Any, str]]],
    azimuth_deg: float,
    elevation_deg: float,
    share: float,
) -> tuple[Axes, View]:
    """A picture of pieces that fill a share of it."""
    body = _body(*pieces)
    size = figure.get_size_inches()
    aspect = place[2] * size[0] / (place[3] * size[1])
    view = view_of(body.points, aspect, azimuth_deg, elevation_deg).widened(share)
    return picture(figure, place, [body], view), view


def _pixels(axes: Axes, view: View, points: ArrayLike) -> FloatArray:
    """Where (n, 3) points are in a picture, as its axes count: columns and rows."""
    width, height = np.rint(axes.get_window_extent().size)
    seen = view.seen(np.atleast_2d(np.asarray(points, float)))[:, :2]
    unit = 2 * view.half_height / height
    flat: FloatArray = np.stack([width / 2 + seen[:, 0] / unit, height / 2 - seen[:, 1] / unit], 1)
    return flat - 0.5


def _middle(block: Block) -> Any:
    parts = solids(block)
    return parts["sleeve"] + parts["pin"] if block.swivel else parts["middle"]


def _turned(solid: Any, state: tuple[float, float]) -> Any:
    return solid.rotate([0, -90 * state[0], 90 * state[1]])


def _bent(
    block: Block, first: tuple[float, float], second: tuple[float, float]
) -> tuple[Block, list[tuple[Any, str]]]:
    """A block whose two joints are bent; the hinge keeps its place."""
    parts, a = solids(block), block.pitch_mm
    before = _turned(parts["end"], (-first[0], -first[1]))
    after = _turned(parts["end"].rotate([0, 0, 180]), second).translate([a, 0, 0])
    return block, [(before, _FIRST), (parts["hinge"], _STEEL), (after, _SECOND)]


def _axes_panel(figure: Figure, place: tuple[float, float, float, float], block: Block) -> None:
    axes, view = _shown(figure, place, _bent(block, (0, 0), (0, 0)), -58, 24, 0.62)
    _titled(axes, "a  a block")
    for index, (ball, way, name) in enumerate(((0.0, -1, "w_1"), (_SIZE, 1, "w_2")), start=1):
        arrows = (
            ("x", (way * 1.75, 0, 0)),
            ("y", (0, -1.45, 0)),
            ("z", (0, 0, 1.2)),
        )
        for letter, direction in arrows:
            start = np.array([ball, 0, 0])
            tip = start + 0.75 * _SIZE * np.asarray(direction)
            _arrow(axes, view, start, tip, f"${letter}_{index}$")
        at = _pixels(axes, view, (ball + way * 0.1 * _SIZE, -0.5 * _SIZE, -0.72 * _SIZE))[0]
        axes.text(at[0], at[1], f"${name}$, one voxel", ha="center", fontsize=12, color=GREY)
    _voxel_edges(axes, view)


def _arrow(axes: Axes, view: View, start: FloatArray, tip: FloatArray, text: str) -> None:
    ends = _pixels(axes, view, np.stack([start, tip]))
    axes.annotate(
        "",
        tuple(ends[1]),
        tuple(ends[0]),
        arrowprops={"arrowstyle": "-|>", "color": _RED, "lw": 1.6, "shrinkA": 0, "shrinkB": 0},
    )
    beyond = ends[1] + 14 * (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    axes.text(beyond[0], beyond[1], text, ha="center", va="center", fontsize=14, color=_RED)


def _voxel_edges(axes: Axes, view: View) -> None:
    """The two cubes that a block takes."""
    corner = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * _SIZE / 2
    for centre in (0.0, _SIZE):
        at = corner + np.array([centre, 0, 0])
        for i in range(8):
            for j in range(i + 1, 8):
                if (corner[i] != corner[j]).sum() == 1:
                    line = _pixels(axes, view, at[[i, j]])
                    axes.plot(*line.T, color="#b5b5b5", lw=0.8, zorder=3)


def _apart_panel(figure: Figure, place: tuple[float, float, float, float], block: Block) -> None:
    parts, a = solids(block), block.pitch_mm
    names = [("end", _FIRST, "$B_i(w_1)$\nan end"), ("hinge", _STEEL, "hinge")]
    if block.swivel:
        names += [("sleeve", _SECOND, "$B_i(w_2)$"), ("pin", _THIRD, "$B_j(w_1)$\nthey swivel")]
    else:
        names += [("middle", _SECOND, "$B_i(w_2) = B_j(w_1)$\none piece")]
    names += [("hinge", _STEEL, "hinge"), ("end", _FIRST, "$B_j(w_2)$\nan end")]
    pieces, at, x = [], [], 0.0
    for k, (name, colour, _) in enumerate(names):
        solid = parts[name].rotate([0, 0, 180]) if k == len(names) - 1 else parts[name]
        low, high = solid.bounding_box()[0], solid.bounding_box()[3]
        pieces.append((solid.translate([x - low, 0, 0]), colour))
        at.append((x + (high - low) / 2, 0, -0.62 * a))
        x += high - low + 0.3 * a
    axes, view = _shown(figure, place, (block, pieces), -72, 16, 1.0)
    _titled(axes, "b  two blocks, taken apart")
    for point, (_, _, text) in zip(at, names, strict=True):
        x, y = _pixels(axes, view, np.array(point) * _SIZE / a)[0].tolist()
        axes.text(x, y, text, ha="center", va="top", fontsize=10.5, color=INK, linespacing=1.5)


def _cut_panel(figure: Figure, place: tuple[float, float, float, float], block: Block) -> None:
    a = block.pitch_mm
    whole = [
        (_middle(block).translate([-a, 0, 0]), _SECOND),
        (_middle(block).translate([a, 0, 0]), _FIRST),
    ]
    window = (-0.62 * a, 1.62 * a)
    halves = [
        (
            solid.trim_by_plane([0, 1, 0], 0)
            .trim_by_plane([1, 0, 0], window[0])
            .trim_by_plane([-1, 0, 0], -window[1]),
            colour,
        )
        for solid, colour in whole
    ]
    axes, view = _shown(
        figure, place, (block, [*halves, (solids(block)["hinge"], _STEEL)]), -82, 12, 0.74
    )
    unit = _SIZE / a
    ball, r = block.ball_mm / 2, block.radius_mm
    labels = (
        (f"ball {block.ball_mm:g}", (0, 0, 0), (-0.4 * a, 0, 0.85 * a)),
        (f"bar {block.bar_mm:g}", (a / 2, 0, block.bar_mm / 4), (0.4 * a, 0, 0.85 * a)),
        (
            f"clearance {block.clearance_mm:g}",
            (a + (ball + block.clearance_mm / 2) * 0.8, 0, (ball + block.clearance_mm / 2) * 0.6),
            (1.3 * a, 0, 0.85 * a),
        ),
    )
    for text, point, where in labels:
        _label(axes, view, unit * np.array(point), unit * np.array(where), f"{text} mm")
    low = -0.75 * a
    _span(axes, view, unit * np.array([(0, 0, low), (a, 0, low)]), f"pitch {a:g} mm")
    edge = window[1] + 0.12 * a
    capsule = unit * np.array([(edge, 0, -r), (edge, 0, r)])
    _span(axes, view, capsule, f"capsule\n{2 * r:.4g} mm")


def _span(axes: Axes, view: View, ends: FloatArray, text: str) -> None:
    """A measure between two points, its text beside it where it is upright."""
    start, stop = _pixels(axes, view, ends)
    arrow = {"arrowstyle": "<->", "color": GREY, "lw": 1, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", tuple(start), tuple(stop), arrowprops=arrow)
    middle = (start + stop) / 2
    if abs(stop[0] - start[0]) > abs(stop[1] - start[1]):
        axes.text(middle[0], middle[1] + 6, text, ha="center", va="top", fontsize=11, color=GREY)
    else:
        axes.text(middle[0] + 8, middle[1], text, ha="left", va="center", fontsize=11, color=GREY)


def _label(axes: Axes, view: View, point: FloatArray, where: FloatArray, text: str) -> None:
    axes.annotate(
        text,
        tuple(_pixels(axes, view, point)[0]),
        tuple(_pixels(axes, view, where)[0]),
        ha="center",
        va="center",
        fontsize=11,
        color=INK,
        arrowprops={"arrowstyle": "-", "color": INK, "lw": 0.9, "shrinkA": 2, "shrinkB": 0},
    )


def _end_on_panel(figure: Figure, place: tuple[float, float, float, float], block: Block) -> None:
    parts = solids(block)
    tilted = parts["end"].rotate([0, -90, 0])
    axes, view = _shown(figure, place, (block, [(tilted, _SECOND)]), -50, 60, 0.8)
    unit = _SIZE / block.pitch_mm
    r = block.radius_mm
    neck = r * np.array([np.sin(NECK), 0, np.cos(NECK)])
    rest = r * np.array([0, -1, 0])
    _label(
        axes,
        view,
        unit * neck,
        unit * np.array([0.7 * r, 0.7 * r, 1.35 * r]),
        f"{'neck' if block.snap_mm > 0 else 'slot'} {block.neck_mm:g} mm",
    )
    _label(
        axes,
        view,
        unit * rest,
        unit * np.array([-0.9 * r, -1.2 * r, -1.3 * r]),
        f"hole {block.hole_mm:g} mm",
    )


def _width_panel(axes: Axes, block: Block) -> None:
    bend = np.linspace(0, block.bend_deg, 181)
    width = 2 * slot_half_width_mm(block, np.deg2rad(bend))
    axes.axhline(block.bar_mm, color=_STEEL, lw=1.5)
    axes.text(2, block.bar_mm, "bar", va="bottom", fontsize=10, color=_STEEL)
    axes.fill_between(bend, width, block.bar_mm, where=width < block.bar_mm, color="#f2c9c7")
    axes.plot(bend, width, color=_SECOND, lw=2.4)
    if block.neck_mm < block.bar_mm:
        axes.annotate(
            f"snaps: {block.snap_mm:g} mm\non each side",
            (45, block.neck_mm),
            (45, block.neck_mm - 0.35 * block.bar_mm),
            ha="center",
            va="top",
            fontsize=10,
            color=_RED,
            arrowprops={"arrowstyle": "-", "color": _RED, "lw": 0.9},
        )
    axes.set_xlabel("bend of the joint (degrees)", color=GREY)
    axes.set_ylabel("mm", color=GREY)
    axes.set_xticks(np.linspace(0, block.bend_deg, 5))
    axes.set_ylim(0, 1.15 * block.hole_mm)
    axes.tick_params(labelsize=9, colors=GREY)
    for name, edge in axes.spines.items():
        edge.set_color(PALE)
        edge.set_visible(name in ("left", "bottom"))
