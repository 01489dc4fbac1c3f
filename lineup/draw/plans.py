"""Pictures in the plane: the Reeb graph with its traversal, and layers with their paths."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from ..grid import BoolArray, FloatArray, IntArray
from ..reeb import ReebGraph, Traversal
from ..solid import VoxelPath, VoxelSolid
from .page import GREY, INK, PALE, page
from .view import colours

MSP = "#c1272d"
MSCS = ["#1f77b4", "#2ca02c", "#ff7f0e", "#9467bd", "#17becf", "#8c564b", "#bcbd22", "#e377c2"]
_MOST_NUMBERED = 60
_PLAN, _KEY = 3.6, 0.5  # inches: width of a plan, height of the key
_VOXEL, _LEFT_OUT = "#eeeae2", "#ffffff"


def reeb(graph: ReebGraph, traversal: Traversal) -> Figure:
    """The Reeb graph, layer above layer, with its MSP and MSCs coloured (Figures 4, 8 and 9).

    The area of a node grows with its number of voxels, and nodes of a layer stand in the order
    of their voxels along the wider of the axes x and y. Numbers are left out in large graphs.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup import draw
    >>> arch = np.ones((3, 1, 2), bool)
    >>> arch[1, 0, 0] = False
    >>> graph = lu.reeb_graph(lu.VoxelSolid(arch))
    >>> figure = draw.reeb(graph, lu.traverse(graph, root=2, end=0))
    >>> [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    ['MSP, 2 nodes', '1 MSC', 'edge not walked']
    """
    figure = page(7, 6)
    axes = figure.add_axes((0.09, 0.1, 0.88, 0.87))
    reeb_axes(axes, graph, traversal)
    axes.legend(handles=reeb_key(traversal), loc="best", frameon=False)
    return figure


def reeb_axes(axes: Axes, graph: ReebGraph, traversal: Traversal) -> None:
    """Draw what `reeb` draws into given axes, but for the key."""
    place = places(graph)
    ways: list[tuple[Sequence[int], str, float]] = [
        (cycle, MSCS[k % len(MSCS)], 3.0) for k, cycle in enumerate(traversal.mscs)
    ]
    axes.add_collection(
        LineCollection(
            [place[edge] for edge in graph.edges], colors=GREY, linewidths=1, linestyles=":"
        )
    )
    shade: dict[int, str] = {}
    for nodes, colour, width in [*ways, (traversal.msp, MSP, 5.0)]:
        lines = [place[list(step)] for step in pairwise(nodes)]
        axes.add_collection(LineCollection(lines, colors=[colour], linewidths=width, zorder=2))
        shade |= dict.fromkeys(nodes, colour)
    _nodes(axes, graph, place, shade)
    for word, node in (("start", traversal.walk[0]), ("end", traversal.walk[-1])):
        beside = place[(place[:, 1] == place[node, 1]) & (place[:, 0] > place[node, 0]), 0]
        crowded = len(beside) and beside.min() - place[node, 0] < 0.25 * np.ptp(place[:, 0])
        axes.annotate(
            word,
            place[node],
            (-14 if crowded else 14, 0),
            textcoords="offset points",
            ha="right" if crowded else "left",
            va="center",
            color=MSP,
        )
    axes.set_ylabel("layer", color=INK)
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("one circle a node, the larger the more voxels", color=GREY)
    axes.set_xticks([])
    axes.spines[["top", "right", "bottom"]].set_visible(False)
    axes.margins(0.16, 0.08)


def places(graph: ReebGraph, apart: float = 1.2) -> FloatArray:
    """Where each node stands: (N, 2), its layer upwards, nodes of a layer so far apart."""
    voxels = np.argwhere(graph.node_of >= 0)
    node = graph.node_of[tuple(voxels.T)]
    wide = int(np.argmax(np.ptp(voxels[:, :2], axis=0)))
    n_voxels = np.bincount(node, minlength=len(graph))
    across = np.bincount(node, voxels[:, wide], len(graph)) / np.maximum(n_voxels, 1)
    for layer in np.unique(graph.layer_of):
        there = np.flatnonzero(graph.layer_of == layer)
        ranked = there[np.argsort(across[there], kind="stable")]
        across[ranked] = _spread(across[ranked], apart)
    return np.stack([across, graph.layer_of.astype(float)], axis=1)


def _spread(at: FloatArray, apart: float) -> FloatArray:
    """Ascending numbers, moved as little as a sweep from each side needs to part them."""
    up, down = at.copy(), at.copy()
    for k in range(1, len(at)):
        up[k] = max(up[k], up[k - 1] + apart)
        down[-1 - k] = min(down[-1 - k], down[-k] - apart)
    parted: FloatArray = (up + down) / 2
    return parted


def _nodes(axes: Axes, graph: ReebGraph, place: FloatArray, shade: dict[int, str]) -> None:
    n_voxels = np.bincount(graph.node_of[graph.node_of >= 0], minlength=len(graph))
    area = 130 + 350 * n_voxels / n_voxels.max()
    edge = [shade.get(node, GREY) for node in range(len(graph))]
    axes.scatter(
        place[:, 0], place[:, 1], s=area, c="white", edgecolors=edge, linewidths=2.5, zorder=3
    )
    if len(graph) <= _MOST_NUMBERED:
        for node in range(len(graph)):
            x, y = place[node].tolist()
            axes.text(x, y, str(node), ha="center", va="center", fontsize=8, color=INK, zorder=4)


def reeb_key(traversal: Traversal) -> list[Line2D]:
    """Handles for the key of a Reeb graph."""
    n = len(traversal.mscs)
    entries = [Line2D([], [], color=MSP, lw=5, label=f"MSP, {len(traversal.msp)} nodes")]
    if n:
        word = "MSC" if n == 1 else "MSCs, a colour each"
        entries.append(Line2D([], [], color=MSCS[0], lw=3, label=f"{n} {word}"))
    entries.append(Line2D([], [], color=GREY, lw=1, ls=":", label="edge not walked"))
    return entries


def layers(path: VoxelPath, solid: VoxelSolid, layers: Iterable[int] | None = None) -> Figure:
    """Plans of a few layers with what the path does there (Figures 5 to 7).

    Voxels are squares, white where the path leaves them out. The path is coloured along the
    chain; triangles mark where it goes up to the next layer or down to the one below.

    Parameters
    ----------
    solid : VoxelSolid
        The solid of the path, unrefined.
    layers : iterable of int, optional
        Heights z on the grid of the path; by default four of the solid's, evenly spread.

    Raises
    ------
    ValueError
        If there is no layer in `layers`, or one is empty.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup import draw
    >>> solid = lu.VoxelSolid(np.ones((4, 3, 2), bool))
    >>> figure = draw.layers(lu.layered_path(solid), solid)
    >>> [axes.get_title() for axes in figure.axes]
    ['layer 0', 'layer 1']
    """
    k = path.refinement
    occupancy = solid.occupancy.repeat(k, 0).repeat(k, 1).repeat(k, 2)
    filled = np.flatnonzero(occupancy.any(axis=(0, 1)))
    if layers is None:
        chosen = np.unique(np.rint(np.linspace(0.1, 0.9, 4) * (len(filled) - 1)).astype(int))
        shown = filled[chosen].tolist()
    else:
        shown = list(layers)
    wrong = [z for z in shown if z not in filled]
    if wrong or not shown:
        raise ValueError(f"layers must be some of {int(filled[0])}..{int(filled[-1])}, got {shown}")
    columns = min(4, len(shown))
    rows = -(-len(shown) // columns)
    height = rows * (_PLAN * occupancy.shape[1] / occupancy.shape[0] + 0.4) + _KEY
    figure = page(_PLAN * columns, height)
    for n, z in enumerate(shown):
        _plan(figure.add_subplot(rows, columns, n + 1), path, occupancy[:, :, z], z)
    _plan_key(figure)
    figure.tight_layout(rect=(0, _KEY / height, 1, 0.98))
    return figure


def _plan(axes: Axes, path: VoxelPath, region: BoolArray, z: int) -> None:
    here = path.voxels[:, 2] == z
    visited = np.zeros_like(region)
    visited[tuple(path.voxels[here, :2].T)] = True
    for mask, face in ((region & visited, _VOXEL), (region & ~visited, _LEFT_OUT)):
        squares = [Rectangle((x - 0.5, y - 0.5), 1, 1) for x, y in np.argwhere(mask).tolist()]
        axes.add_collection(PatchCollection(squares, facecolor=face, edgecolor=PALE, lw=0.8))
    axes.set_title(f"layer {z}", fontsize=13, fontweight="bold", color=INK)
    axes.set_aspect("equal")
    axes.set_xlim(-0.7, region.shape[0] - 0.3)
    axes.set_ylim(-0.7, region.shape[1] - 0.3)
    axes.axis("off")
    _path_in_plan(axes, path.voxels, here, voxel=72 * _PLAN / (max(region.shape) + 1))


def _path_in_plan(axes: Axes, voxels: IntArray, here: BoolArray, voxel: float) -> None:
    """The steps of the path inside a layer, its links and its ends; `voxel` is in points."""
    shades = colours(len(voxels)) / 255
    steps = np.flatnonzero(here[:-1] & here[1:])
    lines = np.stack([voxels[steps, :2], voxels[steps + 1, :2]], axis=1)
    axes.add_collection(
        LineCollection(list(lines), colors=shades[steps], linewidths=0.3 * voxel, capstyle="round")
    )
    climb = np.diff(voxels[:, 2])
    for way, marker in ((1, "^"), (-1, "v")):
        # The step after a voxel leads up, or the step before it came down from there.
        linked = np.append(climb == way, False) | np.append(False, climb == -way)
        x, y = voxels[here & linked, :2].T
        size = (0.5 * voxel) ** 2
        axes.scatter(x, y + 0.12 * way, s=size, marker=marker, c="white", edgecolors=INK, zorder=3)
    for end in (0, -1):
        if here[end]:
            x, y = voxels[end, :2]
            axes.scatter(x, y, s=voxel**2, marker="*", c="white", edgecolors=INK, zorder=4)


def _plan_key(figure: Figure) -> None:
    def mark(marker: str, label: str, size: float = 8) -> Line2D:
        return Line2D(
            [], [], ls="", marker=marker, mfc="white", mec=INK, markersize=size, label=label
        )

    line: NDArray[np.float64] = colours(3)[1] / 255
    entries = [
        Line2D([], [], color=line.tolist(), lw=4, label="path in the layer"),
        mark("^", "link to the layer above"),
        mark("v", "link to the layer below"),
        mark("*", "end of the path", 12),
        Line2D(
            [], [], ls="", marker="s", mfc=_LEFT_OUT, mec="#aaaaaa", markersize=9, label="left out"
        ),
    ]
    figure.legend(handles=entries, loc="lower center", ncols=5, frameon=False, fontsize=10)
