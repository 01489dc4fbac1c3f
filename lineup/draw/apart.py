"""Solids and paths with their layers pulled apart, as in a doll's house (Figure 4)."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from ..grid import FloatArray, IntArray, colour
from ..reeb import ReebGraph, Traversal
from ..solid import VoxelPath, VoxelSolid
from .page import GREY, INK, page, picture
from .plans import MSCS, MSP, reeb_axes, reeb_key
from .view import Capsules, Cubes, View, colours, view_of

_APART, _NEAR = 3, 2  # the height of a storey, in voxels, for paths and for solids
_MOST_LABELLED = 30
_ROD, _LINK, _LEFT_OUT = 0.3, 0.16, 0.35  # radii of path and links, edge of a voxel left out
_ELEVATION_DEG = 28.0


def nodes(graph: ReebGraph, traversal: Traversal) -> Figure:
    """A solid with its layers pulled apart, and its Reeb graph in the same colours (Figure 4).

    Parameters
    ----------
    traversal : Traversal
        Nodes of the MSP are red, those of each MSC have a colour of their own.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup import draw
    >>> arch = np.ones((3, 1, 2), bool)
    >>> arch[1, 0, 0] = False
    >>> graph = lu.reeb_graph(lu.VoxelSolid(arch))
    >>> [axes.get_title() for axes in draw.nodes(graph, lu.traverse(graph)).axes]
    ['layers pulled apart', 'Reeb graph']
    """
    shade = dict.fromkeys(traversal.msp, MSP)
    for k, cycle in enumerate(traversal.mscs):
        shade |= dict.fromkeys(cycle[1:-1], MSCS[k % len(MSCS)])
    figure = page(12, 6)
    axes = _apart(figure, (0, 0, 0.5, 0.93), graph, shade)
    right = figure.add_axes((0.56, 0.12, 0.42, 0.8))
    reeb_axes(right, graph, traversal)
    figure.legend(
        handles=reeb_key(traversal), loc="lower right", ncols=3, frameon=False, fontsize=9
    )
    for panel, title in ((axes, "layers pulled apart"), (right, "Reeb graph")):
        panel.set_title(title, fontsize=13, fontweight="bold", color=INK)
    return figure


def layer(graph: ReebGraph, z: int) -> Figure:
    """One layer of a solid among the others, and from above: each connected piece is a node.

    Raises
    ------
    ValueError
        If the solid has no voxel in layer `z`.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup import draw
    >>> graph = lu.reeb_graph(lu.VoxelSolid(np.ones((3, 4, 2), bool)))
    >>> [axes.get_title() for axes in draw.layer(graph, 1).axes]
    ['layer 1 of 0 to 1', 'from above: 1 node']
    """
    there = np.flatnonzero(graph.layer_of == z).tolist()
    if not there:
        raise ValueError(f"z must be a layer 0..{int(graph.layer_of.max())}, got {z}")
    shade = {node: MSCS[k % len(MSCS)] for k, node in enumerate(there)}
    figure = page(11, 5)
    left = _apart(figure, (0, 0, 0.5, 0.92), graph, shade)
    left.set_title(
        f"layer {z} of {int(graph.layer_of.min())} to {int(graph.layer_of.max())}",
        fontsize=13,
        fontweight="bold",
        color=INK,
    )
    right = figure.add_axes((0.54, 0.06, 0.42, 0.84))
    _pieces(right, graph, shade)
    word = "node" if len(there) == 1 else "nodes"
    right.set_title(f"from above: {len(there)} {word}", fontsize=13, fontweight="bold", color=INK)
    return figure


def storeys(path: VoxelPath, solid: VoxelSolid) -> Figure:
    """A layered path with its layers pulled apart; thin rods are the links between them.

    The path is coloured from blue, its first voxel, to red. Voxels it leaves out are small and
    grey.

    Raises
    ------
    ValueError
        If the path lives on a refined solid.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup import draw
    >>> solid = lu.VoxelSolid(np.ones((4, 3, 2), bool))
    >>> len(draw.storeys(lu.layered_path(solid), solid).axes)
    1
    """
    if path.refinement != 1:
        raise ValueError(f"the path lives on a solid refined {path.refinement} times, give its own")
    rods = _rods(path.voxels)
    left = solid.occupancy.copy()
    left[tuple(path.voxels.T)] = False
    spare = _spread(np.argwhere(left).astype(float))
    boxes = Cubes(spare, np.full(spare.shape, 190, np.uint8), _LEFT_OUT)
    view = view_of(_spread(np.argwhere(solid.occupancy).astype(float)), 1.0, None, _ELEVATION_DEG)
    figure = page(7, 7)
    picture(figure, (0, 0, 1, 1), [boxes, rods], view)
    return figure


def _spread(voxels: FloatArray, height: int = _APART) -> FloatArray:
    spread: FloatArray = voxels * [1, 1, height]
    return spread


def _rods(voxels: IntArray) -> Capsules:
    """Unit rods along a path whose layers are pulled apart, each link between layers in pieces."""
    place = _spread(voxels.astype(float))
    shade = colours(max(len(voxels) - 1, 1))
    rows: list[tuple[FloatArray, FloatArray, NDArray[np.uint8], float]] = []
    for k, (a, b) in enumerate(pairwise(place)):
        n = round(float(np.abs(b - a).max()))
        radius = _ROD if n == 1 else _LINK
        rows += [
            (a + (b - a) * i / n, a + (b - a) * (i + 1) / n, shade[k], radius) for i in range(n)
        ]
    start, stop, rgb, radii = zip(*rows, strict=True)
    return Capsules(np.array(start), np.array(stop), np.array(rgb), np.array(radii))


def _apart(
    figure: Figure,
    place: tuple[float, float, float, float],
    graph: ReebGraph,
    shade: Mapping[int, str],
) -> Axes:
    """Voxels in the colours of their nodes, grey where they have none, and numbers beside."""
    voxels = np.argwhere(graph.node_of >= 0)
    node = graph.node_of[tuple(voxels.T)]
    base = np.array([to_rgb(shade.get(k, GREY)) for k in range(len(graph))])
    tone = np.where(colour(voxels) == 0, 0.35, 0.5)[:, None]
    rgb: NDArray[np.uint8] = np.rint(255 * (base[node] * (1 - tone) + tone)).astype(np.uint8)
    centre = _spread(voxels.astype(float), _NEAR)
    aspect = place[2] * figure.get_figwidth() / (place[3] * figure.get_figheight())
    view = view_of(centre, aspect, None, _ELEVATION_DEG).widened(0.95)
    axes = picture(figure, place, [Cubes(centre, rgb, 1.0)], view)
    if len(shade) <= _MOST_LABELLED:
        for k, face in shade.items():
            _label(axes, view, centre[node == k], str(k), face)
    return axes


def _label(axes: Axes, view: View, centre: FloatArray, text: str, face: str) -> None:
    """A number on the foremost side of some voxels of a picture."""
    seen = view.seen(centre)
    right, up = seen[seen[:, 2].argmax(), :2]
    height = axes.get_window_extent().height
    width = axes.get_window_extent().width
    unit = 2 * view.half_height / height
    axes.text(
        width / 2 + right / unit,
        height / 2 - up / unit,
        text,
        ha="center",
        va="center",
        fontsize=8,
        color=INK,
        bbox={"boxstyle": "round,pad=0.2", "fc": "white", "ec": face, "lw": 1.2},
    )


def _pieces(axes: Axes, graph: ReebGraph, shade: Mapping[int, str]) -> None:
    """The pieces of a layer as squares in their colours, each with its number.

    Pale behind them: what the whole solid covers, seen from above.
    """
    z = int(graph.layer_of[next(iter(shade))])
    below = np.argwhere((graph.node_of >= 0).any(axis=2)).tolist()
    squares = [Rectangle((x - 0.5, y - 0.5), 1, 1) for x, y in below]
    axes.add_collection(PatchCollection(squares, facecolor="#f1f1f1", edgecolor="white"))
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.axis("off")
    for node, face in shade.items():
        cells = np.argwhere(graph.node_of[:, :, z] == node)
        squares = [Rectangle((x - 0.5, y - 0.5), 1, 1) for x, y in cells.tolist()]
        axes.add_collection(PatchCollection(squares, facecolor=face, edgecolor="white", alpha=0.6))
        middle = cells[np.abs(cells - cells.mean(axis=0)).sum(axis=1).argmin()]
        x, y = middle.tolist()
        axes.text(
            x,
            y,
            str(node),
            ha="center",
            va="center",
            fontsize=12,
            fontweight="bold",
            color=INK,
        )
