"""A solid on one fine lattice, from which the fill of voxels of any pitch and place follows."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from . import grid
from ._jit import kernel
from ._record import record
from .grid import BoolArray, FloatArray
from .meshes import FaceArray, Surface

_PILOTS = (48, 96, 192)
_SEEN = 500
"""Cells that must lie inside for a volume to be believed, and estimated from them."""
_MOST_CELLS = 100_000_000
_MOST_PILOT_CELLS = 12_000_000
"""A plate 30,000 times as wide as thick takes so many to be seen at all."""
_MOST_LINES = 2_000_000_000
"""Vertical lines that are tried on all faces; a real mesh takes a tenth at most."""
_MOST_AREA = 100
"""Of all faces, in areas of the bounding box; a real mesh seldom has ten."""
_HEAP = "the mesh has too many large faces, one above the other, to be sampled"
_BATCH = 500_000
_BLOCK = 4
_MARGIN = 2
_COLUMNS = 4


@record
class Sampling:
    """How much of each cell of a fine lattice is inside a surface.

    Attributes
    ----------
    origin : (3,) float64
        The lattice's lowest corner.
    cell : (3,) float64
        Edge lengths of a cell, equal or nearly so.
    table : (X + 1, Y + 1, Z + 1) float64
        ``table[i, j, k]`` is the volume inside below (i, j, k), in cells. Enclosed voids count as
        inside.
    euler : int
        Euler number of the solid: of the surface where that knows it, else of the inside cells.
    n_void : int
        Cells of enclosed voids.
    """

    origin: FloatArray
    cell: FloatArray
    table: FloatArray
    euler: int
    n_void: int

    @property
    def volume(self) -> float:
        """Volume of the inside cells."""
        return float(self.table[-1, -1, -1] * self.cell.prod())

    def coverage(self, lines: Sequence[FloatArray], pitch: float) -> FloatArray:
        """Share of each voxel between consecutive grid lines that is inside, (X, Y, Z) in 0..1.

        The lines of each axis are `pitch` apart; the lattice is empty beyond its ends.
        """
        at = [(line - self.origin[a]) / self.cell[a] for a, line in enumerate(lines)]
        below = _interpolated(self.table, at[0], at[1], at[2])
        inside = np.diff(np.diff(np.diff(below, axis=0), axis=1), axis=2)
        shares: FloatArray = inside * (self.cell / pitch).prod()
        return shares


@lru_cache(maxsize=4)
def sampled(surface: Surface, n_cells: int) -> Sampling:
    """`surface` sampled so finely that about `n_cells` cells, or more, lie inside.

    Raises
    ------
    ValueError
        If the surface encloses too little volume for a lattice of 192^3 cells to see, is a plate
        or a needle that takes too many cells, or a heap of large faces.
    """
    sides = np.ptp(surface.vertices, axis=0)
    box = float(np.prod(sides))
    u, v = np.diff(surface.vertices[surface.faces], axis=1).transpose(1, 0, 2)
    area = float(np.linalg.norm(np.cross(u, v), axis=1).sum()) / 2
    if area > _MOST_AREA * 2 * float((sides * np.roll(sides, 1)).sum()):
        raise ValueError(_HEAP)
    for across in _PILOTS:
        pilot = (box / across**3) ** (1 / 3)
        seen = float(_filled_cells(surface, pilot, _MOST_PILOT_CELLS)[0].sum())
        if seen >= _SEEN:
            break
    if seen < _SEEN:
        raise ValueError(
            f"the mesh encloses too little volume, {seen / across**3:.1g} of its bounding box: "
            "it may be made of open or flat sheets; a closed surface around a volume would do"
        )
    # A lattice coarser than the one that first saw a thin plate might miss it.
    cell = min(pilot, max(pilot * (seen / n_cells) ** (1 / 3), (box / _MOST_CELLS) ** (1 / 3)))
    fill, origin, edges = _filled_cells(surface, cell)
    void = _voids(fill)
    fill[void] = 1.0
    table = np.zeros(tuple(s + 1 for s in fill.shape))
    table[1:, 1:, 1:] = fill
    for axis in range(3):
        np.cumsum(table, axis=axis, out=table)
    euler = surface.euler
    if euler is None:
        euler = euler_number(largest_component(fill > 0.5)[0])
    return Sampling(origin, edges, table, euler, int(void.sum()))


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


def shares_inside(
    surface: Surface, origin: FloatArray, pitch: float, shape: tuple[int, ...], fill_voids: bool
) -> FloatArray:
    """Share of each voxel of a grid that is inside, from 64 cells a voxel that do not straddle it.

    `Sampling.coverage` takes each cell as evenly filled, which blurs the surface; this does not.
    """
    fine = tuple(n * _BLOCK for n in shape)
    fill = _fill(surface, origin, np.full(3, pitch / _BLOCK), fine)
    if fill_voids:
        fill[_voids(fill)] = 1.0
    x, y, z = shape
    blocks = fill.reshape(x, _BLOCK, y, _BLOCK, z, _BLOCK)
    shares: FloatArray = blocks.mean(axis=(1, 3, 5), dtype=np.float64)
    return shares


def _voids(fill: NDArray[np.float32]) -> BoolArray:
    outside, _ = grid.components(fill <= 0.5)
    enclosed: BoolArray = (fill <= 0.5) & (outside != outside[0, 0, 0])  # the margin is empty
    return enclosed


def _filled_cells(
    surface: Surface, cell: float, most: int = 2 * _MOST_CELLS
) -> tuple[NDArray[np.float32], FloatArray, FloatArray]:
    """The share of each cell that is inside, the lattice's lowest corner, and a cell's edges."""
    low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
    extent = high - low
    if surface.closed:
        # Whole cells across the bounding box: a face of the mesh in one of its planes is exact.
        n = np.maximum(1, np.round(extent / cell))
        edges, shape = extent / n, n + 2 * _MARGIN
    else:
        edges = np.full(3, cell)
        shape = _BLOCK * np.ceil((extent / cell + 2 * _MARGIN) / _BLOCK)
    if shape.prod() > most:
        sides = " by ".join(f"{side:.3g}" for side in extent)
        raise ValueError(f"the mesh is too thin to be sampled: its bounding box is {sides}")
    origin = (low + high) / 2 - shape * edges / 2
    return _fill(surface, origin, edges, tuple(shape.astype(int))), origin, edges


def _fill(
    surface: Surface, origin: FloatArray, edges: FloatArray, shape: tuple[int, ...]
) -> NDArray[np.float32]:
    if not surface.closed:
        return _inside_open(surface, origin, float(edges[0]), shape).astype(np.float32)
    vertices = (surface.vertices - origin) / edges
    boxes = 1 + _COLUMNS * np.ptp(vertices[surface.faces, :2], axis=1)
    if boxes.prod(axis=1).sum() > _MOST_LINES:
        raise ValueError(_HEAP)
    fill = np.zeros(shape, np.float32)
    _cross_columns(vertices, surface.faces, fill)
    np.cumsum(fill, axis=2, out=fill)
    return np.clip(fill, 0, 1, out=fill)


def _inside_open(
    surface: Surface, origin: FloatArray, cell: float, shape: tuple[int, ...]
) -> BoolArray:
    """Inside where there are holes: the fast winding number, wherever it may cross a half.

    Off the surface it varies smoothly, so blocks of cells far from the surface and unlike none of
    their neighbours are decided by their centre.
    """
    blocks = tuple(n // _BLOCK for n in shape)
    everywhere = np.ones(blocks, np.bool_)
    inside = _winds_round(surface, origin, cell * _BLOCK, everywhere).reshape(blocks)
    touched = np.zeros(blocks, np.bool_)
    _mark_surface((surface.vertices - origin) / (cell * _BLOCK), surface.faces, touched)
    near = np.ones((3, 3, 3), bool)
    unlike = ndimage.binary_dilation(inside, near) & ~ndimage.binary_erosion(inside, near)
    unsure = unlike | ndimage.binary_dilation(touched, near)
    block = np.ones((_BLOCK,) * 3, bool)
    cells, ask = np.kron(inside, block), np.kron(unsure, block)
    cells[ask] = _winds_round(surface, origin, cell, ask)
    return cells


def _winds_round(surface: Surface, origin: FloatArray, cell: float, ask: BoolArray) -> BoolArray:
    index = np.argwhere(ask)
    batches = [index[start : start + _BATCH] for start in range(0, len(index), _BATCH)]
    return np.concatenate([surface.winding(origin + (b + 0.5) * cell) > 0.5 for b in batches])


@kernel
def _cross_columns(vertices: FloatArray, faces: FaceArray, change: NDArray[np.float32]) -> None:
    """Add to each unit cell the change of the winding number since the cell below it.

    A vertical line enters the solid where it meets a face looking down, and leaves it where one
    looks up; where it does so inside a cell is kept, as a share of the cell. `_COLUMNS` squared
    lines stand for each cell. A line through an edge or a vertex is taken as shifted by an
    infinitesimal amount, so that it meets one face of each fan; an edge is judged alike by both
    its faces because its ends are taken in index order.
    """
    sign = np.empty(3)
    area = np.empty(3)
    for f in range(faces.shape[0]):
        corners = vertices[faces[f]]
        for i in range(_first(corners[:, 0].min()), _first(corners[:, 0].max())):
            for j in range(_first(corners[:, 1].min()), _first(corners[:, 1].max())):
                for e in range(3):
                    a, b = faces[f, (e + 1) % 3], faces[f, (e + 2) % 3]
                    way = 1.0 if a < b else -1.0
                    p, q = vertices[min(a, b)], vertices[max(a, b)]
                    area[e], side = _side(p, q, (i + 0.5) / _COLUMNS, (j + 0.5) / _COLUMNS)
                    sign[e], area[e] = way * side, way * area[e]
                if sign[0] != sign[1] or sign[1] != sign[2] or sign[0] == 0:
                    continue
                whole = area.sum()
                height = (area * corners[:, 2]).sum() / whole if whole else corners[:, 2].max()
                k = int(height)
                weight = sign[0] / _COLUMNS**2
                change[i // _COLUMNS, j // _COLUMNS, k] -= weight * (k + 1 - height)
                change[i // _COLUMNS, j // _COLUMNS, k + 1] -= weight * (height - k)


@kernel
def _first(x: float) -> int:
    """Index of the first line at or beyond `x`."""
    return int(np.ceil(x * _COLUMNS - 0.5))


@kernel
def _side(a: FloatArray, b: FloatArray, x: float, y: float) -> tuple[float, float]:
    """Twice the area of (a, b, p) seen from above, and the side of a-b that p, nudged, is on.

    The nudge is to p + (ε, ε²), with ε -> 0.
    """
    dx, dy = b[0] - a[0], b[1] - a[1]
    area = dx * (y - a[1]) - dy * (x - a[0])
    return area, np.sign(area if area else -dy if dy else dx)


@kernel
def _mark_surface(vertices: FloatArray, faces: FaceArray, touched: BoolArray) -> None:
    """Set unit cells so that each point of the surface is in one of them or in a neighbour.

    Along lines parallel to the shortest edge, so that a needle takes no more steps than its area.
    """
    edge = np.empty(3)
    for f in range(faces.shape[0]):
        for e in range(3):
            along = vertices[faces[f, (e + 1) % 3]] - vertices[faces[f, e]]
            edge[e] = np.sqrt((along * along).sum())
        short = int(edge.argmin())
        tip = vertices[faces[f, (short + 2) % 3]]
        first, last = vertices[faces[f, short]] - tip, vertices[faces[f, (short + 1) % 3]] - tip
        n = max(1, int(np.ceil(edge.max() / 0.9)))
        for i in range(n + 1):
            m = max(1, int(np.ceil(edge[short] * i / n / 0.9)))
            for j in range(m + 1):
                p = tip + (i / n) * (first + (j / m) * (last - first))
                touched[int(p[0]), int(p[1]), int(p[2])] = True


@kernel
def _interpolated(table: FloatArray, xs: FloatArray, ys: FloatArray, zs: FloatArray) -> FloatArray:
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
