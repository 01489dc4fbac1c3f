"""A solid on one fine lattice, from which the fill of voxels of any pitch and place follows."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from scipy import ndimage

from . import grid
from ._jit import kernel
from ._record import record
from .grid import BoolArray, FloatArray, IntArray
from .meshes import Surface

_PILOT_CELLS = 48
_BATCH = 500_000
_BLOCK = 4


@record
class Sampling:
    """Which cells of a fine lattice have their centre inside a surface.

    Attributes
    ----------
    origin : (3,) float64
        The lattice's lowest corner.
    cell : float
        Edge length of a cell.
    table : (X + 1, Y + 1, Z + 1) int32
        ``table[i, j, k]`` is the number of inside cells below (i, j, k).
    euler : int
        Euler number of the solid: of the surface where that knows it, else of the inside cells.
    n_void : int
        Cells of enclosed voids; they count as inside in `table`.
    """

    origin: FloatArray
    cell: float
    table: IntArray
    euler: int
    n_void: int

    @property
    def volume(self) -> float:
        """Volume of the inside cells."""
        return float(self.table[-1, -1, -1]) * self.cell**3

    def coverage(self, lines: Sequence[FloatArray], pitch: float) -> FloatArray:
        """Share of each voxel between consecutive grid lines that is inside, (X, Y, Z) in 0..1.

        The lines of each axis are `pitch` apart; the lattice is empty beyond its ends.
        """
        at = [(line - self.origin[a]) / self.cell for a, line in enumerate(lines)]
        below = _interpolated(self.table, at[0], at[1], at[2])
        inside = np.diff(np.diff(np.diff(below, axis=0), axis=1), axis=2)
        shares: FloatArray = inside * (self.cell / pitch) ** 3
        return shares


@lru_cache(maxsize=4)
def sampled(surface: Surface, n_cells: int) -> Sampling:
    """`surface` sampled so finely that about `n_cells` cells lie inside.

    Raises
    ------
    ValueError
        If the surface encloses no volume that a lattice of 200 cells across can see.
    """
    extent = float(np.ptp(surface.vertices, axis=0).max())
    for across in (_PILOT_CELLS, 2 * _PILOT_CELLS, 4 * _PILOT_CELLS):
        inside, _ = _inside_cells(surface, extent / across)
        n = int(inside.sum())
        # Too few hits make a poor estimate of the volume; plates are the usual case.
        if n >= 2 * across:
            break
    if n == 0:
        raise ValueError("the mesh encloses no volume: its faces may be open sheets or folded flat")
    cell = extent / across * (n / n_cells) ** (1 / 3)
    inside, origin = _inside_cells(surface, cell)
    outside, _ = grid.components(~inside)
    solid = outside != outside[0, 0, 0]  # the lattice has an empty margin
    table = np.zeros(tuple(s + 1 for s in solid.shape), np.int32)
    table[1:, 1:, 1:] = solid
    for axis in range(3):
        np.cumsum(table, axis=axis, out=table)
    euler = surface.euler
    if euler is None:
        euler = euler_number(largest_component(solid)[0])
    return Sampling(origin, cell, table, euler, int(solid.sum() - inside.sum()))


def largest_component(occupancy: BoolArray) -> tuple[BoolArray, int]:
    """The largest face-connected component, the first of equals, and how many voxels it omits."""
    label, n = grid.components(occupancy)
    if n <= 1:
        return occupancy, 0
    sizes = np.bincount(label.ravel())[1:]
    return label == 1 + int(sizes.argmax()), int(sizes.sum() - sizes.max())


def euler_number(occupancy: BoolArray) -> int:
    """Euler number of a solid whose voxels are joined through faces only.

    Voxels less joined pairs, plus full 2x2 blocks, less full 2x2x2 cubes: 1 for a ball, 0 for a
    ring, and half that of the surface when there is no void.

    Examples
    --------
    >>> import numpy as np
    >>> ring = np.ones((3, 3, 1), bool)
    >>> ring[1, 1] = False
    >>> euler_number(ring)
    0
    """
    return int(_euler_number(np.ascontiguousarray(occupancy)))


def _inside_cells(surface: Surface, cell: float) -> tuple[BoolArray, FloatArray]:
    """Whether the centre of each cell is inside, and the lowest corner of the lattice."""
    low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
    # A margin of at least two cells stays empty; whole blocks let an open mesh be looked over.
    shape = _BLOCK * np.ceil(((high - low) / cell + 4) / _BLOCK).astype(int)
    origin = (low + high) / 2 - shape * cell / 2
    band = np.zeros(tuple(shape), np.bool_)
    _mark_surface(surface.vertices, surface.faces, origin, cell, band)
    band = ndimage.binary_dilation(band, np.ones((3, 3, 3), bool))
    if not surface.closed:
        band |= _level_blocks(surface, origin, cell, band.shape)
    # The winding number crosses a half only in the band: elsewhere one cell speaks for its region.
    region, n = grid.components(~band)
    flat = region.ravel()
    first = np.zeros(n + 1, np.int64)
    first[flat[::-1]] = np.arange(flat.size - 1, -1, -1)
    spoken = np.zeros(n + 1, np.bool_)
    spoken[1:] = _inside(surface, origin, cell, np.unravel_index(first[1:], band.shape))
    inside = spoken[region]
    inside[band] = _inside(surface, origin, cell, np.nonzero(band))
    return inside, origin


def _inside(
    surface: Surface, origin: FloatArray, cell: float, index: tuple[np.ndarray, ...]
) -> BoolArray:
    answers = np.empty(len(index[0]), np.bool_)
    for start in range(0, len(answers), _BATCH):
        batch = slice(start, start + _BATCH)
        points = origin + (np.stack([i[batch] for i in index], axis=1) + 0.5) * cell
        answers[batch] = surface.winding(points) > 0.5
    return answers


def _level_blocks(
    surface: Surface, origin: FloatArray, cell: float, shape: tuple[int, ...]
) -> BoolArray:
    """Cells of the blocks through which the winding number crosses a half, holes included."""
    coarse = tuple(n // _BLOCK for n in shape)
    inside = _inside(
        surface, origin, cell * _BLOCK, tuple(i.ravel() for i in np.indices(coarse))
    ).reshape(coarse)
    near = np.ones((3, 3, 3), bool)
    mixed = ndimage.binary_dilation(inside, near) & ~ndimage.binary_erosion(inside, near)
    cells: BoolArray = np.kron(mixed, np.ones((_BLOCK,) * 3, bool))
    return cells


@kernel
def _mark_surface(
    vertices: FloatArray,
    faces: np.ndarray[tuple[int, int], np.dtype[np.int64]],
    origin: FloatArray,
    cell: float,
    band: BoolArray,
) -> None:
    """Set cells so that every point of the surface is in one of them or in a neighbour."""
    for f in range(faces.shape[0]):
        a = vertices[faces[f, 0]]
        u = vertices[faces[f, 1]] - a
        v = vertices[faces[f, 2]] - a
        longest = np.sqrt(max((u * u).sum(), (v * v).sum(), ((u - v) ** 2).sum()))
        n = max(1, int(np.ceil(longest / (0.9 * cell))))
        for i in range(n + 1):
            for j in range(n + 1 - i):
                p = (a + (i / n) * u + (j / n) * v - origin) / cell
                band[int(p[0]), int(p[1]), int(p[2])] = True


@kernel
def _interpolated(table: IntArray, xs: FloatArray, ys: FloatArray, zs: FloatArray) -> FloatArray:
    """The table at fractional indices; trilinear, hence exact for sums over cells of one value."""
    out = np.empty((xs.size, ys.size, zs.size))
    for i in range(xs.size):
        x = min(max(xs[i], 0.0), table.shape[0] - 1.0)
        i0 = min(int(x), table.shape[0] - 2)
        for j in range(ys.size):
            y = min(max(ys[j], 0.0), table.shape[1] - 1.0)
            j0 = min(int(y), table.shape[1] - 2)
            for k in range(zs.size):
                z = min(max(zs[k], 0.0), table.shape[2] - 1.0)
                k0 = min(int(z), table.shape[2] - 2)
                value = 0.0
                for a in range(2):
                    wx = x - i0 if a else 1.0 - (x - i0)
                    for b in range(2):
                        wy = y - j0 if b else 1.0 - (y - j0)
                        low, high = table[i0 + a, j0 + b, k0], table[i0 + a, j0 + b, k0 + 1]
                        value += wx * wy * (low + (z - k0) * (high - low))
                out[i, j, k] = value
    return out


@kernel
def _euler_number(occupancy: BoolArray) -> int:
    nx, ny, nz = occupancy.shape
    number = 0
    for x in range(nx):
        for y in range(ny):
            for z in range(nz):
                if not occupancy[x, y, z]:
                    continue
                px = x + 1 < nx and occupancy[x + 1, y, z]
                py = y + 1 < ny and occupancy[x, y + 1, z]
                pz = z + 1 < nz and occupancy[x, y, z + 1]
                xy = px and py and occupancy[x + 1, y + 1, z]
                xz = px and pz and occupancy[x + 1, y, z + 1]
                yz = py and pz and occupancy[x, y + 1, z + 1]
                cube = xy and xz and yz and occupancy[x + 1, y + 1, z + 1]
                number += 1 - px - py - pz + xy + xz + yz - cube
    return number
