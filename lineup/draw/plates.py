"""What comes off the printer, in its true shape (Section 7, Figure 15)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..block import Block, block_parts
from ..grid import FloatArray, IntArray
from .page import page, picture
from .view import Cubes, Triangles, colours, view_of

_STEEL = (95, 102, 112)
_BED = (226, 228, 230)
_AROUND = 0.3  # pitches of bed, at the least, that are seen around the pieces
_AZIMUTH_DEG, _ELEVATION_DEG = -62.0, 42.0
_WIDTH, _HEIGHT = 9.0, 5.0  # inches


class Piece(Protocol):
    """A part in its place, as `lineup.fabrication.Placed`."""

    @property
    def part(self) -> str:
        """Its name."""

    @property
    def rotation(self) -> IntArray:
        """(3, 3)"""

    @property
    def offset_mm(self) -> FloatArray:
        """(3,)"""


def plate(pieces: Sequence[Piece], block: Block) -> Figure:
    """The parts of a chain where they are printed, capsules coloured along the chain.

    Parameters
    ----------
    pieces : sequence
        As those of `lineup.fabrication.pieces_on`, in the order of the chain.

    Raises
    ------
    ValueError
        If there is no piece.

    Examples
    --------
    >>> import numpy as np
    >>> from lineup import Block, draw
    >>> from lineup.fabrication import placed
    >>> path = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
    >>> len(draw.plate(placed(path, Block()), Block()).axes)
    1
    """
    if not pieces:
        raise ValueError("a plate is drawn of one piece at least, got none")
    body = _body(pieces, block)
    low, high = body.points.min(axis=0), body.points.max(axis=0)
    bed = _bed(low, high)
    view = view_of(
        np.vstack([bed.points, body.points]), _WIDTH / _HEIGHT, _AZIMUTH_DEG, _ELEVATION_DEG
    )
    figure = page(_WIDTH, _HEIGHT)
    picture(figure, (0, 0, 1, 1), [bed, body], view)
    return figure


def _body(pieces: Sequence[Piece], block: Block) -> Triangles:
    """All pieces as one body, in pitches."""
    parts = block_parts(block)
    shades = colours(len(pieces))
    points, faces, rgb, n = [], [], [], 0
    for piece, shade in zip(pieces, shades, strict=True):
        part = parts[piece.part]
        points.append((part.vertices @ piece.rotation.T + piece.offset_mm) / block.pitch_mm)
        faces.append(part.faces + n)
        own: NDArray[np.uint8] = np.array(_STEEL if piece.part == "hinge" else shade, np.uint8)
        rgb.append(np.tile(own, (len(part.vertices), 1)))
        n += len(part.vertices)
    return Triangles(np.concatenate(points), np.concatenate(faces), np.concatenate(rgb))


def _bed(low: FloatArray, high: FloatArray) -> Cubes:
    """The bed under the pieces, as unit squares that touch."""
    first = np.floor(low[:2] - _AROUND).astype(int)
    last = np.ceil(high[:2] + _AROUND).astype(int)
    sides = [np.arange(a, b + 1) for a, b in zip(first, last, strict=True)]
    level = np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, 2)
    centre = np.column_stack([level, np.full(len(level), low[2] - 0.5)]).astype(float)
    return Cubes(centre, np.tile(np.array(_BED, np.uint8), (len(centre), 1)), 1.0)
