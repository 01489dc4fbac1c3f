"""Silhouettes of a model and of what is left of it in voxels, path and trimmed path."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ..grid import BoolArray
from ..looks import Shape, agreement, reference_of, shadows, stages
from ..solid import VoxelSolid
from .page import INK, page

_VIEWS = ("from the side, along x", "from the front, along y", "from above, along z")
_BOTH, _LACKS, _ADDS, _NONE = (201, 208, 214), (200, 48, 52), (47, 111, 196), (255, 255, 255)
_CELL, _LEFT, _TOP, _FOOT = 2.7, 1.2, 0.35, 0.45  # inches


def silhouettes(
    shape: Shape | Mapping[str, Shape], solid: VoxelSolid, mesh: object = None
) -> Figure:
    """Silhouettes along the three axes: a row for the solid, then one for each shape.

    Grey is seen of both the mesh and the voxels, red of the mesh alone, blue of the voxels alone.
    The number is the intersection over union.

    Parameters
    ----------
    shape, solid, mesh
        As `lineup.appearance` takes them; without a mesh the solid is compared with.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup import draw
    >>> solid = lu.VoxelSolid(np.ones((4, 4, 3), bool))
    >>> figure = draw.silhouettes(lu.layered_path(solid), solid)
    >>> [axes.get_title() for axes in figure.axes][3:]
    ['1.000', '1.000', '1.000']
    """
    reference = reference_of(solid, mesh)
    found = stages(shape, solid)
    width, height = _LEFT + 3 * _CELL, _TOP + _CELL * len(found) + _FOOT
    figure = page(width, height)
    for row, (stage, occupancy) in enumerate(found.items()):
        seen = shadows(np.pad(occupancy, reference.margin))
        bottom = _FOOT + _CELL * (len(found) - 1 - row)
        middle = (bottom + _CELL / 2) / height
        figure.text(0.15 / width, middle, stage, fontsize=12, color=INK, va="center", weight="bold")
        for column, (ours, theirs) in enumerate(zip(seen, reference.seen, strict=True)):
            left = _LEFT + _CELL * column
            place = (left / width, bottom / height, 0.94 * _CELL / width, 0.86 * _CELL / height)
            axes = figure.add_axes(place)
            axes.axis("off")
            axes.imshow(np.flipud(_overlaid(ours, theirs).transpose(1, 0, 2)))
            axes.set_title(f"{agreement(ours, theirs):.3f}", fontsize=10, color=INK, pad=3)
    for column, view in enumerate(_VIEWS):
        centre = (_LEFT + _CELL * (column + 0.47)) / width
        figure.text(centre, 1 - 0.2 / height, view, fontsize=11, color=INK, ha="center")
    names = ("both", "only the model", "only the voxels")
    key = [
        Patch(color=(r / 255, g / 255, b / 255), label=name)
        for name, (r, g, b) in zip(names, (_BOTH, _LACKS, _ADDS), strict=True)
    ]
    figure.legend(handles=key, loc="lower center", ncols=3, frameon=False, fontsize=10)
    return figure


def _overlaid(ours: BoolArray, theirs: BoolArray) -> np.ndarray:
    colours = np.array([_NONE, _LACKS, _ADDS, _BOTH], np.uint8)
    picture: np.ndarray = colours[theirs.astype(int) + 2 * ours.astype(int)]
    return picture
