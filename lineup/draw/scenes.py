"""Pictures in three dimensions: solids, chains, contact sheets (Figures 1, 3 and 18)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from ..reeb import Traversal, reeb_graph
from ..solid import Folding, VoxelPath, VoxelSolid
from .bodies import chain_body, left_out_body, solid_body
from .page import GREY, INK, caption, page, picture, positions
from .plans import reeb_axes, reeb_key
from .view import ELEVATION_DEG, Body, colours, view_of

_COLUMNS, _CELL, _FOOT = 5, 3.3, 0.5  # of a contact sheet: cells to a row; inches


def solid(
    solid: VoxelSolid, azimuth_deg: float | None = None, elevation_deg: float = ELEVATION_DEG
) -> Figure:
    """A solid as voxels (Figure 3, after voxelization).

    Parameters
    ----------
    azimuth_deg : float, optional
        Where the camera stands, from the x axis towards y; by default, where the solid is wide.
    elevation_deg : float
        How high it stands above the floor.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup import draw
    >>> draw.solid(lu.VoxelSolid(np.ones((4, 3, 2), bool))).get_size_inches().tolist()
    [6.0, 6.0]
    """
    return _one([solid_body(solid)], azimuth_deg, elevation_deg)


def solids(solids: Sequence[VoxelSolid], captions: Sequence[str]) -> Figure:
    """Solids side by side, each as large as it fits, with words above (Section 3).

    Parameters
    ----------
    captions : sequence of str
        One for each solid; the first line is its title.

    Raises
    ------
    ValueError
        If there is no solid, or not one caption for each.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup import draw
    >>> slab = lu.VoxelSolid(np.ones((4, 3, 2), bool))
    >>> [axes.get_title() for axes in draw.solids([slab], ["slab"]).axes]
    ['slab']
    """
    if not solids or len(solids) != len(captions):
        raise ValueError(
            f"a row needs one caption for each solid, "
            f"got {len(solids)} solids and {len(captions)} captions"
        )
    figure = page(_CELL * len(solids), 1.15 * _CELL)
    for k, (one, text) in enumerate(zip(solids, captions, strict=True)):
        body = solid_body(one)
        view = view_of(body.points, 1 / 1.15).widened(0.78)
        caption(picture(figure, (k / len(solids), 0, 1 / len(solids), 1), [body], view), text)
    return figure


def chain(
    chain: VoxelPath | Folding | ArrayLike,
    solid: VoxelSolid | None = None,
    azimuth_deg: float | None = None,
    elevation_deg: float = ELEVATION_DEG,
) -> Figure:
    """A chain coloured along its length, from blue at its first block to red at its last.

    Parameters
    ----------
    chain : VoxelPath, Folding, or (P, 3) positions such as a pose from `frames`
    solid : VoxelSolid, optional
        Its voxels that no joint of the chain lies in are drawn too, small and grey.

    Raises
    ------
    ValueError
        If there are fewer than two positions or they are not finite points.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup import draw
    >>> path = lu.layered_path(lu.VoxelSolid(np.ones((4, 3, 2), bool)))
    >>> len(draw.chain(path).axes)
    1
    """
    pose = positions(chain)
    bodies: list[Body] = [chain_body(pose)]
    if solid is not None:
        bodies.insert(0, left_out_body(solid, pose))
    return _one(bodies, azimuth_deg, elevation_deg)


def layering(path: VoxelPath, solid: VoxelSolid) -> Figure:
    """From a solid over its Reeb graph and its traversal to a layered path (Figure 4).

    Parameters
    ----------
    path : VoxelPath
        A strictly layered path: its visits are the traversal, nodes that it leaves out apart.

    Raises
    ------
    ValueError
        If the path has no visits.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup import draw
    >>> solid = lu.VoxelSolid(np.ones((4, 3, 2), bool))
    >>> figure = draw.layering(lu.layered_path(solid), solid)
    >>> [axes.get_title() for axes in figure.axes]
    ['a  solid', 'b  Reeb graph and traversal', 'c  layered path']
    """
    if not len(path.visits):
        raise ValueError(f"a path by {path.method!r} has no visits; give a layered one")
    figure = page(14, 5)
    view = view_of(solid_body(solid).points).widened(0.85)
    left = picture(figure, (0, 0, 0.33, 0.94), [solid_body(solid)], view)
    middle = figure.add_axes((0.38, 0.15, 0.26, 0.75))
    reeb_axes(middle, reeb_graph(solid), _traversal(path))
    key = reeb_key(_traversal(path))
    figure.legend(handles=key, loc="lower center", ncols=3, frameon=False, fontsize=9)
    right = picture(figure, (0.67, 0, 0.33, 0.94), [chain_body(positions(path))], view)
    for axes, title in zip(
        (left, middle, right),
        ("a  solid", "b  Reeb graph and traversal", "c  layered path"),
        strict=True,
    ):
        axes.set_title(title, fontsize=13, fontweight="bold", color=INK)
    return figure


def _traversal(path: VoxelPath) -> Traversal:
    """The traversal that the visits of a path are."""
    nodes = tuple(path.visits[:, 2].tolist())
    on_msp = np.flatnonzero(path.visits[:, 3] == 0).tolist()
    mscs = tuple(nodes[a : b + 1] for a, b in pairwise(on_msp) if nodes[a] == nodes[b])
    return Traversal(nodes, tuple(dict.fromkeys(nodes[k] for k in on_msp)), mscs)


def contact_sheet(
    foldings: Sequence[Folding | VoxelPath | ArrayLike], captions: Sequence[str]
) -> Figure:
    """Chains side by side, five to a row, coloured along their length (Figures 1 and 18).

    Parameters
    ----------
    captions : sequence of str
        One for each chain; the first line is its title.

    Raises
    ------
    ValueError
        If there is no chain, or not one caption for each.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup import draw
    >>> path = lu.layered_path(lu.VoxelSolid(np.ones((4, 3, 2), bool)))
    >>> sheet = draw.contact_sheet([path, path], ["slab", "the same slab"])
    >>> [axes.get_title() for axes in sheet.axes][:2]
    ['slab', 'the same slab']
    """
    if not foldings or len(foldings) != len(captions):
        raise ValueError(
            f"a sheet needs one caption for each chain, "
            f"got {len(foldings)} chains and {len(captions)} captions"
        )
    columns = min(_COLUMNS, len(foldings))
    rows = -(-len(foldings) // columns)
    height = rows * _CELL + _FOOT
    figure = page(_CELL * columns, height)
    for k, (folding, text) in enumerate(zip(foldings, captions, strict=True)):
        row, column = divmod(k, columns)
        place = (column / columns, 1 - (row + 1) * _CELL / height, 1 / columns, _CELL / height)
        body = chain_body(positions(folding))
        # Room above for the caption, and below for the shadow.
        view = view_of(body.points).widened(0.76)
        caption(picture(figure, place, [body], view), text)
    _key(figure, _FOOT / height)
    return figure


def _one(bodies: Sequence[Body], azimuth_deg: float | None, elevation_deg: float) -> Figure:
    points = np.concatenate([body.points for body in bodies])
    view = view_of(points, 1.0, azimuth_deg, elevation_deg)
    figure = page(6, 6)
    picture(figure, (0, 0, 1, 1), bodies, view)
    return figure


def _key(figure: Figure, below: float) -> None:
    """A strip of the chain's colours along the foot of a figure."""
    axes = figure.add_axes((0.3, 0.3 * below, 0.4, 0.25 * below))
    ramp: NDArray[np.float64] = np.linspace(0, 1, 256)[None]
    axes.imshow(ramp, aspect="auto", cmap=ListedColormap(colours(256) / 255))
    axes.axis("off")
    for x, word, side in (
        (-0.02, "first block of the chain", "right"),
        (1.02, "last block", "left"),
    ):
        axes.text(
            x, 0.5, word, transform=axes.transAxes, ha=side, va="center", fontsize=10, color=GREY
        )
