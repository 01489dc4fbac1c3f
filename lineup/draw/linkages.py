"""Paths as planar linkages: their projections, depth by depth, and how they straighten (Section 6).

A path is projected along an axis, y in the paper; a joint's *depth* is its coordinate on it.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import ArrayLike

from ..grid import FloatArray
from ..kinematics import Move, frames
from ..solid import Folding, Motion, VoxelPath
from .bodies import chain_body
from .page import GREY, INK, PALE, page, picture, positions
from .view import colours, view_of

_NAMES = "xyz"
_COMPOSITE = "#c43c39"
_SPREAD = 0.34  # how far apart the deepest and the nearest bar over one edge are drawn


def projection(path: VoxelPath | Folding | ArrayLike, axis: int = 1) -> Figure:
    """The projected path P_xz as a linkage, its composite joints in red (Figures 12b and 13b).

    Bars that lie over one another are drawn side by side, the deepest lowest to the right.

    Parameters
    ----------
    axis : int
        The axis to look along, 0, 1 or 2.

    Raises
    ------
    ValueError
        If the axis is none of these.

    Examples
    --------
    >>> from lineup import draw
    >>> corner = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    >>> draw.projection(corner).axes[0].get_xlabel()
    'x'
    """
    pose = positions(path)
    figure = page(6, 6)
    axes = figure.add_axes((0.09, 0.08, 0.88, 0.84))
    n_composite = _linkage(axes, pose, _checked(axis))
    axes.set_title(f"{n_composite} composite squares", fontsize=11, color=GREY)
    return figure


def depths(path: VoxelPath | Folding | ArrayLike, axis: int = 1, most: int = 6) -> Figure:
    """The subpaths of a projected path, one panel for each depth (Figure 14).

    Parameters
    ----------
    most : int
        Panels at most: the depths with most joints.

    Raises
    ------
    ValueError
        If the axis is not 0, 1 or 2.

    Examples
    --------
    >>> from lineup import draw
    >>> corner = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    >>> [axes.get_title() for axes in draw.depths(corner).axes]
    ['y = 0: 2 joints', 'y = 1: 2 joints']
    """
    pose, axis = positions(path), _checked(axis)
    depth = np.rint(pose[:, axis]).astype(int)
    shown, count = np.unique(depth, return_counts=True)
    kept = np.sort(shown[np.argsort(-count, kind="stable")[:most]])
    figure = page(3.1 * len(kept), 3.3)
    figure.subplots_adjust(left=0.01, right=0.99, bottom=0.01, top=0.9, wspace=0.05)
    flat = _flat(pose, axis)
    for k, here in enumerate(kept.tolist()):
        axes = figure.add_subplot(1, len(kept), k + 1)
        both = (depth[1:] == here) & (depth[:-1] == here)
        _bars(axes, flat, np.zeros(len(flat) - 1), "0.88", 1.0)
        _bars(axes, flat, np.zeros(len(flat) - 1), colours(len(flat) - 1) / 255, 2.4, both)
        on = flat[depth == here]
        axes.plot(on[:, 0], on[:, 1], "o", color=INK, markersize=3)
        axes.set_title(f"{_NAMES[axis]} = {here}: {len(on)} joints", fontsize=10)
        _frame(axes, flat)
        axes.axis("off")
    return figure


def two_stages(motion: Motion | Folding, moments: int = 3) -> Figure:
    """Algorithm 4 on one path: the path, its projection straightened, then the other (Figure 12).

    Parameters
    ----------
    motion : Motion or Folding
        With BEND moves, as `unfold` by ``"energy"`` or ``"barrier"`` gives it.
    moments : int
        Poses of the first stage that are shown, its end included.

    Raises
    ------
    ValueError
        If the motion has no BEND move.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup import draw
    >>> path = lu.layered_path(lu.VoxelSolid(np.ones((3, 2, 1), bool)))
    >>> len(draw.two_stages(lu.unfold(path, "energy")).axes)
    6
    """
    motion = motion.motion if isinstance(motion, Folding) else motion
    bends = np.flatnonzero(motion.moves[:, 0] == Move.BEND)
    if not len(bends):
        raise ValueError("two stages are shown of a motion with BEND moves, and this has none")
    axis = int(motion.moves[bends[0], 1])
    n_bends = int(bends[-1]) + 1
    substeps = -(-moments // n_bends)  # poses to show within a bend, if there are few
    poses = list(frames(motion, substeps=substeps))
    n = moments + 3
    figure = page(3.4 * n, 3.9)
    body = chain_body(motion.start)
    solid = picture(figure, (0.005, 0.08, 0.8 / n, 0.8), [body], view_of(body.points))
    _told(solid, "a", "the path")
    panels: list[Axes] = [solid]
    panels += [figure.add_axes(((k + 0.16) / n, 0.13, 0.78 / n, 0.74)) for k in range(1, n)]
    composite = _linkage(panels[1], poses[0], axis)
    _told(panels[1], "b", f"along {_NAMES[axis]}: {composite} composite squares")
    when = np.linspace(0, substeps * n_bends, moments + 1).astype(int)[1:].tolist()
    for panel, k in zip(panels[2:], when, strict=False):
        _linkage(panel, poses[k], axis, squares=False)
        _told(panel, "c", f"along {_NAMES[axis]}, {k / (substeps * n_bends):.0%} of the flow")
    other = 0 if axis != 0 else 1
    _linkage(panels[-1], poses[substeps * n_bends], other, squares=False)
    ending = "one tilt to go" if motion.straight else motion.reason.split(" after")[0]
    _told(panels[-1], "d", f"along {_NAMES[other]}: {ending}")
    return figure


def _told(axes: Axes, letter: str, text: str) -> None:
    axes.set_title(f"{letter}  {text}", fontsize=10, color=INK, loc="left", wrap=True)


def _checked(axis: int) -> int:
    if axis not in (0, 1, 2):
        raise ValueError(f"axis must be 0, 1 or 2, got {axis}")
    return axis


def _flat(pose: FloatArray, axis: int) -> FloatArray:
    """The two coordinates across an axis, z upwards where it is one of them."""
    u, v = [k for k in range(3) if k != axis]
    return pose[:, [u, v]]


def _linkage(axes: Axes, pose: FloatArray, axis: int, squares: bool = True) -> int:
    """Draw a projected path; the number of squares that several joints are projected to."""
    flat, depth = _flat(pose, axis), pose[:, axis]
    cells, count = np.unique(np.rint(flat), axis=0, return_counts=True)
    if squares:
        tiles = [Rectangle((x - 0.5, y - 0.5), 1, 1) for x, y in cells.tolist()]
        edge = [_COMPOSITE if n > 1 else PALE for n in count.tolist()]
        face = ["#f6dedd" if n > 1 else "#f7f7f7" for n in count.tolist()]
        axes.add_collection(PatchCollection(tiles, edgecolor=edge, facecolor=face, linewidth=0.8))
    spread = _SPREAD * ((depth - depth.min()) / max(np.ptp(depth), 1) - 0.5)
    if not squares:
        spread = np.zeros_like(spread)
    _bars(axes, flat, spread, colours(len(flat) - 1) / 255, 2.2)
    _frame(axes, flat)
    names = [_NAMES[k] for k in range(3) if k != axis]
    axes.set_xlabel(names[0], color=GREY)
    axes.set_ylabel(names[1], color=GREY)
    return int((count > 1).sum())


def _bars(
    axes: Axes,
    flat: FloatArray,
    spread: FloatArray,
    shades: ArrayLike | str,
    width: float,
    shown: ArrayLike | None = None,
) -> None:
    offset = np.pad(spread, (0, max(0, len(flat) - len(spread))), mode="edge")
    moved = flat + np.stack([offset, -offset], axis=1)
    lines = np.stack([moved[:-1], moved[1:]], axis=1)
    if shown is not None:
        mask = np.asarray(shown)
        lines, shades = lines[mask], np.asarray(shades)[mask]
    axes.add_collection(LineCollection(list(lines), colors=shades, linewidths=width))


def _frame(axes: Axes, flat: FloatArray) -> None:
    low, high = flat.min(axis=0) - 0.8, flat.max(axis=0) + 0.8
    centre, half = (low + high) / 2, float((high - low).max()) / 2
    axes.set_xlim(centre[0] - half, centre[0] + half)
    axes.set_ylim(centre[1] - half, centre[1] + half)
    axes.set_aspect("equal")
    axes.tick_params(labelsize=7, colors=GREY)
    for edge in axes.spines.values():
        edge.set_color(PALE)
