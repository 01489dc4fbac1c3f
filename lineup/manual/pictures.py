"""Pictures in three dimensions for the booklet: the finished model, and the body so far."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from .. import grid
from ..draw.render import rendered
from ..draw.view import Body, Capsules, Cubes, Pixels, View, view_of
from ..grid import FloatArray, IntArray

OLD, NEW, ROD = (158, 158, 158), (176, 64, 36), (40, 40, 40)
"""Colours of what is there, what a step adds, and the loose ends; in grey, light, dark, black."""

_CLAY = ((233, 196, 134), (214, 174, 110))
_ROD_LENGTH = 4.0
_COLOURS = 128  # so that a page is small


class LooseEnd(NamedTuple):
    """Where a loose end leaves the body, and which way it points."""

    name: str
    place: IntArray
    direction: int


class Picture(NamedTuple):
    """An image, and where on it names stand: (x, y) shares of its width and height from the top."""

    image: Pixels
    names: list[tuple[str, float, float]]


def model_picture(voxels: IntArray, width: int, height: int) -> Pixels:
    """The finished model in the two tones of a checkerboard."""
    shown = outside(voxels)
    shade = np.array(_CLAY, np.uint8)[grid.colour(shown)]
    view = view_of(voxels, width / height).widened(0.86)
    return few_colours(rendered([Cubes(shown.astype(float), shade, 0.96)], view, width, height))


def body_picture(
    old: IntArray,
    new: IntArray,
    loose: Sequence[LooseEnd],
    whole: IntArray,
    width: int,
    height: int,
) -> Picture:
    """The body so far: what is new is dark, loose ends are short black rods.

    Parameters
    ----------
    old, new, whole : (n, 3) int32
        Places of the body before the step, of what the step adds, and of the finished model; the
        last only sets the scale.
    """
    both = np.concatenate([old, new])
    shade = np.repeat(np.array([OLD, NEW], np.uint8), [len(old), len(new)], axis=0)
    shown = np.isin(_keys(both), _keys(outside(both)))
    bodies: list[Body] = [Cubes(both[shown].astype(float), shade[shown], 0.92)]
    starts = np.array([end.place for end in loose], float).reshape(-1, 3)
    ways = np.array([grid.DIRECTIONS[end.direction] for end in loose], float).reshape(-1, 3)
    if len(loose):
        bodies += [_rod(start, way) for start, way in zip(starts, ways, strict=True)]
    tips = starts + _ROD_LENGTH * ways
    view = _view(np.concatenate([whole, tips]), width / height)
    image = few_colours(rendered(bodies, view, width, height))
    return Picture(image, _names(view, loose, starts, ways, width / height))


def outside(voxels: IntArray) -> IntArray:
    """The voxels of which a face is free."""
    body = np.zeros(np.ptp(voxels, axis=0) + 3, bool)
    corner = voxels.min(axis=0) - 1
    body[tuple((voxels - corner).T)] = True
    kept: IntArray = voxels[grid.surface(body)[tuple((voxels - corner).T)]]
    return kept


def few_colours(image: Pixels) -> Pixels:
    """The picture in so few colours that it is stored as a palette."""
    palette = Image.fromarray(image).quantize(
        _COLOURS, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE
    )
    return np.asarray(palette.convert("RGB"), np.uint8)


def _rod(start: FloatArray, way: FloatArray) -> Capsules:
    steps = np.arange(_ROD_LENGTH)[:, None] * way
    shade = np.tile(np.array(ROD, np.uint8), (len(steps), 1))
    return Capsules(start + steps, start + steps + way, shade, np.full(len(steps), 0.22))


def _view(points: NDArray[np.float64], aspect: float) -> View:
    return view_of(points, aspect, azimuth_deg=-60.0, elevation_deg=32.0)


def _names(
    view: View, loose: Sequence[LooseEnd], starts: FloatArray, ways: FloatArray, aspect: float
) -> list[tuple[str, float, float]]:
    """Names of the loose ends beside their tips, on the picture."""
    names = []
    for end, start, way in zip(loose, starts, ways, strict=True):
        x, y, _ = view.seen((start + (_ROD_LENGTH + 0.9) * way)[None])[0].tolist()
        across, up = x / (view.half_height * aspect), y / view.half_height
        names.append((end.name, 0.5 + 0.5 * across, 0.5 - 0.5 * up))
    return names


def _keys(voxels: IntArray) -> NDArray[np.int64]:
    """A number for each voxel, equal for equal ones."""
    wide = voxels.astype(np.int64) + 2**20
    keys: NDArray[np.int64] = (wide[:, 0] << 42) | (wide[:, 1] << 21) | wide[:, 2]
    return keys
