"""What a picture shows and from where: bodies, and an orthographic camera."""

from __future__ import annotations

from dataclasses import dataclass

import matplotlib
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..grid import BoolArray, FloatArray, IntArray

Pixels = NDArray[np.uint8]

ELEVATION_DEG = 24.0


@dataclass(frozen=True)
class Capsules:
    """Unit-long rods with round ends: (n, 3) starts, stops and colours, (n,) radii."""

    start: FloatArray
    stop: FloatArray
    rgb: Pixels
    radius: FloatArray

    def __len__(self) -> int:
        return len(self.start)

    @property
    def points(self) -> FloatArray:
        return np.concatenate([self.start, self.stop])

    def inside(self, view: View, aspect: float) -> Capsules:
        """The rods that a view of this aspect may have in its picture."""
        kept = view.holds((self.start + self.stop) / 2, aspect)
        return Capsules(self.start[kept], self.stop[kept], self.rgb[kept], self.radius[kept])


@dataclass(frozen=True)
class Cubes:
    """Axis-parallel cubes: (n, 3) centres, (n, 3) colours, one edge length."""

    centre: FloatArray
    rgb: Pixels
    edge: float

    def __len__(self) -> int:
        return len(self.centre)

    @property
    def points(self) -> FloatArray:
        return self.centre

    def inside(self, view: View, aspect: float) -> Cubes:
        """The cubes that a view of this aspect may have in its picture."""
        kept = view.holds(self.centre, aspect)
        return Cubes(self.centre[kept], self.rgb[kept], self.edge)


@dataclass(frozen=True)
class Triangles:
    """A triangle mesh: (n, 3) vertices and their colours, (m, 3) faces."""

    vertices: FloatArray
    faces: IntArray
    rgb: Pixels

    def __len__(self) -> int:
        return len(self.faces)

    @property
    def points(self) -> FloatArray:
        return self.vertices

    def inside(self, view: View, aspect: float) -> Triangles:
        """All of it: a mesh is drawn whole."""
        return self


Body = Capsules | Cubes | Triangles


@dataclass(frozen=True)
class View:
    """An orthographic camera: the point it looks at, the way back from there, half its height."""

    centre: FloatArray
    back: FloatArray
    half_height: float

    @property
    def axes(self) -> FloatArray:
        """Unit vectors to the right, up and back to the camera, as the rows of a matrix."""
        right = np.cross([0.0, 0.0, 1.0], self.back)
        right /= np.linalg.norm(right)
        return np.array([right, np.cross(self.back, right), self.back])

    def seen(self, points: ArrayLike) -> FloatArray:
        """(n, 3) points as the camera has them: right, up and towards it, from the centre."""
        seen: FloatArray = (np.asarray(points, float) - self.centre) @ self.axes.T
        return seen

    def holds(self, points: FloatArray, aspect: float) -> BoolArray:
        """Which of (n, 3) points are in the picture or at most a voxel beside it."""
        half = self.half_height * np.array([aspect, 1.0]) + 1
        x, y = (np.abs(self.seen(points)[:, :2]) < half).T
        held: BoolArray = x & y
        return held

    def widened(self, share: float) -> View:
        """The view in which what fills this one fills a share of the height, a little low."""
        half_height = self.half_height / share
        lift = 0.4 * (half_height - self.half_height)
        return View(self.centre + lift * self.axes[1], self.back, half_height)


def view_of(
    points: ArrayLike,
    aspect: float = 1.0,
    azimuth_deg: float | None = None,
    elevation_deg: float = ELEVATION_DEG,
) -> View:
    """The view that just holds voxels at (n, 3) centres, where width = aspect * height.

    Parameters
    ----------
    azimuth_deg : float, optional
        From the x axis towards y; by default, so that the wider of the sides x and y is seen.
    elevation_deg : float
        Above the floor, from -89 to 89.

    Raises
    ------
    ValueError
        If the camera would look straight down or up.

    Examples
    --------
    >>> view_of([[0, 0, 0], [0, 0, 8]], elevation_deg=0).half_height
    5.0
    """
    if not -89 <= elevation_deg <= 89:
        raise ValueError(f"elevation_deg must be from -89 to 89, got {elevation_deg}")
    wide = np.ptp(np.asarray(points, float), axis=0)
    if azimuth_deg is None:
        azimuth_deg = -60.0 if wide[0] >= wide[1] else -30.0
    azimuth, elevation = np.deg2rad([azimuth_deg, elevation_deg])
    level = np.cos(elevation)
    back = np.array([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)])
    axes = View(np.zeros(3), back, 1.0).axes
    across = np.asarray(points, float) @ axes.T
    low, high = across.min(axis=0), across.max(axis=0)
    half_width, half_height = ((high - low)[:2] / 2 + 1).tolist()
    return View((low + high) / 2 @ axes, back, max(half_height, half_width / aspect))


def colours(n: int) -> Pixels:
    """Colours of n things along the chain, from its first to its last: (n, 3) uint8.

    The ends of the colour map `turbo` are left out: they are too dark to be told apart.

    Examples
    --------
    >>> colours(3).shape
    (3, 3)
    """
    rgba = matplotlib.colormaps["turbo"](np.linspace(0.08, 0.92, n))
    rgb: Pixels = np.rint(255 * rgba[:, :3]).astype(np.uint8)
    return rgb
