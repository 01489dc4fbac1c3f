"""Pictures in three dimensions: solids, chains, contact sheets (Figures 1, 3 and 18)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from ..solid import Folding, VoxelPath, VoxelSolid
from .bodies import chain_body, left_out_body, solid_body
from .page import GREY, caption, page, picture, positions
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
