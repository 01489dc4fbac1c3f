"""How many nodes meet which assumption (Section 4.4)."""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from .page import GREY, INK, PALE, page

_NAMES = {
    "nodes_met": "all of them",
    "nodes_listed": "all that Section 4 lists",
    "regular": "interior fit for Zhang and Liu",
    "linked": "a common interior with the next layer",
    "no_hole": "no hole",
    "boundary_cycle": "boundary is one cycle",
    "interior_connected": "interior in one piece",
    "interior_exists": "has an interior",
}
_MET, _ALL = "#5b8db8", "#c1272d"


def assumptions(summary: pd.DataFrame) -> Figure:
    """Share of the nodes of each solid that meet each assumption, a dot for each solid.

    Parameters
    ----------
    summary : DataFrame
        From `audit_summary`. Bars are the means over its rows.

    Raises
    ------
    ValueError
        If it has no row.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup import draw
    >>> summary = lu.audit_summary([lu.VoxelSolid(np.ones((6, 7, 5), bool), name="block")])
    >>> len(draw.assumptions(summary).axes[0].patches)
    8
    """
    if not len(summary):
        raise ValueError("there is no row in the summary; give at least one solid")
    figure = page(9, 3.8)
    axes = figure.add_axes((0.33, 0.16, 0.58, 0.8))
    for row, (column, name) in enumerate(_NAMES.items()):
        shares = 100 * summary[column].astype(float)
        colour = _ALL if column.startswith("nodes") else _MET
        axes.barh(row, shares.mean(), color=colour, alpha=0.75, height=0.7)
        axes.plot(shares, [row] * len(shares), "o", ms=4, mfc="white", mec=INK, zorder=3)
        axes.text(102, row, f"{shares.mean():.0f} %", va="center", fontsize=10, color=INK)
        axes.text(-2, row, name, va="center", ha="right", fontsize=10, color=INK)
    axes.set_xlim(0, 100)
    axes.set_yticks([])
    axes.xaxis.grid(True, color=PALE, lw=0.8)
    axes.set_axisbelow(True)
    axes.tick_params(colors=GREY)
    axes.spines[:].set_visible(False)
    axes.set_xlabel("nodes that meet it, % (a dot for each model)", color=GREY)
    return figure
