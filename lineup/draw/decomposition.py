"""The traversing walk taken apart into its MSP and MSCs (Figures 8 and 9)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from ..grid import FloatArray
from ..reeb import ReebGraph, Traversal
from .page import GREY, INK, PALE, page
from .plans import MSCS, MSP, places

_MOST = 5
_WIDE, _NARROW, _LAYER = 4.2, 2.6, 0.3  # inches: the walk, each of its parts, a layer
_ARROW = {
    "arrowstyle": "-|>,head_width=0.15,head_length=0.3",
    "lw": 1.4,
    "shrinkA": 7,
    "shrinkB": 7,
}


def decomposition(
    graph: ReebGraph, traversal: Traversal, names: Mapping[int, object] | None = None
) -> Figure:
    """The walk p(G) on the Reeb graph, and beside it its MSP and its largest MSCs.

    Arrows point the way of the walk; an edge walked there and back has two. Of more than five
    MSCs the five with the most nodes are drawn apart, and the title counts the others.

    Parameters
    ----------
    names : mapping, optional
        What to call each node; by default its number.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup import draw
    >>> table = np.ones((5, 5, 2), bool)
    >>> table[1:4, :, 0] = False
    >>> graph = lu.reeb_graph(lu.VoxelSolid(table))
    >>> [axes.get_title() for axes in draw.decomposition(graph, lu.traverse(graph)).axes]
    ['p(G), 4 visits of 3 nodes', 'MSP $I_1$, 2 nodes', 'MSC $C_{1}$, 2 nodes at 2']
    """
    called = {node: str((names or {}).get(node, node)) for node in range(len(graph))}
    place = places(graph, apart=max(1.2, np.ptp(places(graph)[:, 0]) / 9))
    cycles = list(enumerate(traversal.mscs, 1))
    shown = sorted(sorted(cycles, key=lambda row: -len(set(row[1])))[:_MOST])
    colours = {number: MSCS[(number - 1) % len(MSCS)] for number, _ in cycles}
    n_left = len(cycles) - len(shown)
    walked = f"p(G), {len(traversal.walk)} visits of {len(graph)} nodes"
    left = f"\n{n_left} more MSCs not drawn apart" if n_left else ""
    height = 1.2 + _LAYER * (1 + np.ptp(graph.layer_of))
    widths = [_WIDE, *[_NARROW] * (1 + len(shown))]
    figure = page(sum(widths), max(3.0, height))
    panels = figure.subplots(1, len(widths), sharey=True, width_ratios=widths)
    panels[0].set_ylabel("layer", color=INK)
    panels[0].yaxis.get_major_locator().set_params(integer=True)
    whole = [(traversal.msp, MSP), *((cycle, colours[number]) for number, cycle in cycles)]
    _panel(panels[0], called, graph, place, whole, walked + left)
    title = f"MSP $I_1$, {len(traversal.msp)} nodes"
    _panel(panels[1], called, graph, place, [(traversal.msp, MSP)], title)
    for axes, (number, cycle) in zip(panels[2:], shown, strict=True):
        title = f"MSC $C_{{{number}}}$, {len(set(cycle))} nodes at {called[cycle[0]]}"
        _panel(axes, called, graph, place, [(cycle, colours[number])], title)
    figure.tight_layout()
    return figure


def _panel(
    axes: Axes,
    called: Mapping[int, str],
    graph: ReebGraph,
    place: FloatArray,
    ways: Sequence[tuple[Sequence[int], str]],
    title: str,
) -> None:
    """The graph in pale, and some ways through it in their colours."""
    axes.add_collection(
        LineCollection([place[edge] for edge in graph.edges], colors=PALE, linewidths=1)
    )
    shade = dict.fromkeys(range(len(graph)), PALE)
    for nodes, colour in reversed(ways):
        shade |= dict.fromkeys(nodes, colour)
        steps = set(pairwise(nodes))
        for a, b in pairwise(nodes):
            bend = 0.25 if (b, a) in steps else 0.0
            axes.annotate(
                "",
                place[b],
                place[a],
                arrowprops=_ARROW | {"color": colour, "connectionstyle": f"arc3,rad={bend}"},
            )
    edge = [shade[node] for node in range(len(graph))]
    x, y = place.T
    axes.scatter(x, y, s=190, c="white", edgecolors=edge, linewidths=1.8, zorder=3)
    for node, (left, up) in enumerate(place.tolist()):
        dark = INK if shade[node] != PALE else GREY
        axes.text(
            left, up, called[node], ha="center", va="center", fontsize=8, color=dark, zorder=4
        )
    axes.set_title(title, fontsize=10, color=INK)
    axes.set_xticks([])
    axes.tick_params(left=False, colors=GREY)
    axes.spines[:].set_visible(False)
    axes.margins(0.12, 0.04)
