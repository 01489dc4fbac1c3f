"""What a folded model bears, in colours (Figure 17), and whether it stands while it is folded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, PowerNorm
from matplotlib.figure import Figure

from ..grid import FloatArray
from ..stress.results import BUCKLING_N, TENSION_PA, Strength
from ..stress.support import level_axes, upward
from .page import GREY, INK, PALE, literal, page, picture
from .view import Body, Cubes, View, view_of

_WIDTH, _HEIGHT = 11.0, 6.6  # inches
_HEAD, _STRIP, _FOOT = 1.1, 0.3, 0.8  # of the height: the head, the titles, the colour bar
_COLOURS = LinearSegmentedColormap.from_list(
    "tension", ["#e3e7ea", "#f3d28b", "#ec8b3a", "#c92a2a", "#6b0f2a"]
)
_FLOOR = np.array([96, 104, 116], np.uint8)
_FOOT_EDGE = 0.5  # of the cubes under voxels that rest on the table
_TITLES = ("the whole", "cut open at the worst face")
_ROOM = 1.06  # around the model
_MARK = "#1b4fd1"
_LABELS = ("margin before it tips over, mm", "safety factor", "longest side, m")
_GOOD, _BAD = "#2c7a51", "#c43c39"


def strength(result: Strength) -> Figure:
    """A folded model coloured by the tension at its faces, whole and cut open (Figure 17).

    A voxel has the colour of the largest tension at a corner of one of its faces. Grey feet are
    under the voxels that the table bears. The second picture lacks what is in front of the face
    that gives way first, which is ringed.

    Raises
    ------
    ValueError
        If the body tips over, so that there is nothing to show.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup import draw
    >>> arch = np.array([(0, 0, 0), (0, 0, 1), (1, 0, 1), (2, 0, 1), (2, 0, 0)])
    >>> figure = draw.strength(lu.strength(lu.VoxelPath(arch)))
    >>> [axes.get_title() for axes in figure.axes][1:3]
    ['the whole', 'cut open at the worst face']
    """
    if not result.stands:
        raise ValueError(f"there is no balance to draw: the body {result.reason}")
    voxels, worst, feet = _upright(result)
    tension_kpa = _tension(result) / 1e3
    norm = PowerNorm(0.5, 0.0, max(float(tension_kpa.max()), 1e-9))
    rgb = np.rint(255 * _COLOURS(norm(tension_kpa))[:, :3]).astype(np.uint8)
    figure = page(_WIDTH, _HEIGHT)
    head = figure.add_axes((0.03, 1 - _HEAD / _HEIGHT, 0.94, _HEAD / _HEIGHT))
    _head(head, result)
    top, bottom = 1 - (_HEAD + _STRIP) / _HEIGHT, _FOOT / _HEIGHT
    aspect = 0.5 * _WIDTH / ((top - bottom) * _HEIGHT)
    view = view_of(np.vstack([voxels, feet]), aspect)
    view = replace(view, half_height=_ROOM * view.half_height)
    shown = [np.ones(len(voxels), bool), _behind(voxels, worst, view)]
    for k, (kept, title) in enumerate(zip(shown, _TITLES, strict=True)):
        bodies: list[Body] = [Cubes(voxels[kept], rgb[kept], 1.0)]
        if len(feet):
            under = feet if k == 0 else feet[_behind(feet, worst, view)]
            bodies.append(Cubes(under, np.tile(_FLOOR, (len(under), 1)), _FOOT_EDGE))
        axes = picture(figure, (0.5 * k, bottom, 0.5, top - bottom), bodies, view)
        axes.set_title(title, fontsize=10, color=INK)
        if k == 1:
            _ring(axes, worst, view)
    bar = figure.add_axes((0.2, 0.055, 0.6, 0.02))
    mappable = ScalarMappable(norm, _COLOURS)
    figure.colorbar(mappable, cax=bar, orientation="horizontal")
    bar.set_title("largest tension at a corner of a voxel's faces, kPa", fontsize=9, pad=4)
    bar.tick_params(labelsize=8, color=GREY)
    return figure


def _upright(result: Strength) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Voxels, the middle of the worst face and the feet, turned so that up is axis 2."""
    up = upward(result.setting.up)
    along_axis = bool((np.abs(up) > 1 - 1e-9).any())
    turn = np.vstack([level_axes(up), up]) if along_axis else np.eye(3)
    table = result.table
    borne = table[(table["kind"] == "table") & (table["normal_n"] < 0)]
    places = table[["x", "y", "z"]].to_numpy(float)
    feet = borne[["x", "y", "z"]].to_numpy(float) @ turn.T - (0, 0, _FOOT_EDGE / 2)
    return result.voxels @ turn.T, places[result.worst] @ turn.T, feet


def _tension(result: Strength) -> FloatArray:
    """(n,) the largest tension, in Pa, at a corner of a face of each voxel."""
    table, most = result.table, np.zeros(len(result.voxels))
    start = int(table["first"].min())
    for side in ("first", "second"):
        known = table[(table[side] >= 0) & table["tension_pa"].notna()]
        np.maximum.at(most, known[side].to_numpy(int) - start, known["tension_pa"].to_numpy(float))
    return most


def _behind(points: FloatArray, worst: FloatArray, view: View) -> np.ndarray:
    """Which points are not in front of the worst face, along the level axis most towards us."""
    axis = int(np.abs(view.back[:2]).argmax())
    towards = np.sign(view.back[axis])
    kept: np.ndarray = towards * (points[:, axis] - worst[axis]) <= 0.5 + 1e-6
    return kept


def _ring(axes: Axes, worst: FloatArray, view: View) -> None:
    height, width = axes.get_images()[0].get_size()
    unit = 2 * view.half_height / height
    right, up, _ = view.seen([worst])[0]
    at = (width / 2 + right / unit, height / 2 - up / unit)
    size = 2 * np.clip(1.6 / unit, 9, 40)
    axes.plot(*at, "o", ms=size * 0.72, mfc="none", mec=_MARK, mew=2)


def _head(axes: Axes, result: Strength) -> None:
    axes.axis("off")
    setting = result.setting
    title = f"{result.name or 'folded chain'} {result.reason}"
    axes.text(0, 0.8, literal(title), fontsize=14, fontweight="bold", color=INK, va="center")
    body = f"{len(result.voxels):,} voxels of {setting.pitch_mm:g} mm, {result.mass_kg:.2f} kg. "
    if setting.held is None:
        body += (
            f"Its centre of mass is {result.margin_mm:.0f} mm inside of what it rests on; "
            "grey feet show what the table bears."
        )
    row = result.table.iloc[result.worst]
    bears = f"{row['tension_pa'] / 1e3:.1f} kPa of tension at a corner"
    if not row["tension_pa"] > 0:
        bears = f"{-row['normal_n']:.2f} N of compression"
    lines = [
        body,
        f"Ringed: {result.worst_face}, which gives way first. It bears {bears}; "
        f"all could be {result.safety:.3g} times as heavy.",
        f"Limits, as the paper measured them: {TENSION_PA / 1e3:g} kPa of tension, "
        f"{BUCKLING_N:g} N of compression.",
    ]
    text = "\n".join(lines)
    axes.text(0, 0.3, text, fontsize=9.5, color=GREY, va="center", linespacing=1.5)


def standing(table: pd.DataFrame) -> Figure:
    """How a body stands while it is folded: margin, safety and room, along the motion.

    The margin is from the plumb line of its centre of mass to the edge of what it rests on; the
    room is the longest side of the box that holds the whole chain.

    Parameters
    ----------
    table : DataFrame
        What `lineup.standing` returned; rows where nothing is folded are left out of the first
        two panels.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup import draw
    >>> folding = lu.fold(lu.VoxelSolid(np.ones((4, 3, 2), bool)), rounds=20, trial_rounds=5)
    >>> [axes.get_ylabel() for axes in draw.standing(lu.standing(folding)).axes]
    ['margin before it tips over, mm', 'safety factor', 'longest side, m']
    """
    figure = page(7.5, 7.0)
    panels = figure.subplots(3, 1, sharex=True)
    figure.subplots_adjust(left=0.11, right=0.97, top=0.93, bottom=0.08, hspace=0.14)
    ordered = table.sort_values("move", kind="stable")
    some = ordered[ordered["folded"] > 0]
    stands = some["stands"].to_numpy(bool)
    colour = np.where(stands, _GOOD, _BAD)
    _curve(panels[0], some["folded"], some["margin_mm"], colour)
    panels[0].axhspan(min(float(some["margin_mm"].min()), -1) * 1.15, 0, color="#f6dcdb", zorder=0)
    panels[0].axhline(0, color=_BAD, lw=1)
    panels[0].text(0.01, 0.04, "tips over", transform=panels[0].transAxes, color=_BAD, fontsize=9)
    held = some[some["stands"]]
    _safety(panels[1], held)
    room = ordered[["box_x_mm", "box_y_mm", "box_z_mm"]].max(axis=1) / 1e3
    _curve(panels[2], ordered["folded"], room, np.full(len(ordered), INK))
    for panel, label in zip(panels, _LABELS, strict=True):
        panel.set_ylabel(label, fontsize=9, color=INK)
        panel.tick_params(labelsize=8)
        panel.grid(color=PALE, lw=0.6)
        panel.set_axisbelow(True)
        panel.spines[["top", "right"]].set_visible(False)
    panels[2].set_xlabel("voxels folded", fontsize=9, color=INK)
    panels[0].set_title(
        f"the folded part stands by itself at {int(stands.sum())} of {len(some)} moments",
        fontsize=12,
        color=INK,
    )
    return figure


def _curve(axes: Axes, x: pd.Series, y: pd.Series, colours: np.ndarray) -> None:
    axes.plot(x.to_numpy(), y.to_numpy(), color=PALE, lw=1.5, zorder=1)
    axes.scatter(x.to_numpy(), y.to_numpy(), c=list(colours), s=28, zorder=2)


def _safety(axes: Axes, held: pd.DataFrame) -> None:
    axes.scatter(held["folded"], held["safety"], c=_GOOD, s=28)
    axes.axhline(1, color=_BAD, lw=1)
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set_ylim(bottom=min([0.5, *(0.8 * held["safety"])]))
    left = axes.get_yaxis_transform()
    axes.text(0.01, 0.97, "gives way", transform=left, color=_BAD, fontsize=9, va="top")
