"""Pages side by side, as they would lie on a table."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

from .page import GREY, page

_HEIGHT, _GAP = 9.0, 0.12  # inches: of a page, and around it
_DPI = 100


def spread(pages: Sequence[Figure]) -> Figure:
    """Pages of a booklet side by side in a row, each in a thin frame (Section 7's manual).

    Parameters
    ----------
    pages : sequence of Figure
        As those of `lineup.manual_pages`; all are drawn at one height.

    Raises
    ------
    ValueError
        If there is no page.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from lineup import draw
    >>> len(draw.spread([Figure(figsize=(8.27, 11.7)), Figure(figsize=(8.27, 11.7))]).axes)
    2
    """
    if not pages:
        raise ValueError("a spread shows one page at least, got none")
    images = [_image(one) for one in pages]
    widths = [_HEIGHT * image.width / image.height for image in images]
    width, height = sum(widths) + _GAP * (len(pages) + 1), _HEIGHT + 2 * _GAP
    figure = page(width, height)
    left = _GAP
    for image, wide in zip(images, widths, strict=True):
        place = (left / width, _GAP / height, wide / width, _HEIGHT / height)
        axes = figure.add_axes(place)
        axes.imshow(np.asarray(image), aspect="auto", interpolation="antialiased")
        axes.set_xticks([])
        axes.set_yticks([])
        axes.spines[:].set_color(GREY)
        left += wide + _GAP
    return figure


def _image(one: Figure) -> Image.Image:
    drawn = BytesIO()
    one.savefig(drawn, format="png", dpi=_DPI)
    return Image.open(drawn).convert("RGB")
