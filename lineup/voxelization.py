"""Closed surface to voxel solid at a target count (Section 3), and the mending of voxel arrays.

The paper voxelizes by testing voxel centres. Here pitch and sub-voxel offset of the grid are
searched for the count and for the best agreement with the shape, measured as intersection over
union (IoU) with a much finer sampling.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from scipy import ndimage

from .grid import BoolArray, FloatArray, voids
from .meshes import Surface, surface_of, turned_upright
from .sampling import Sampling, euler_number, largest_component, sampled, shares_inside
from .shells import Thickness
from .shells import shell as hollowed
from .solid import VoxelSolid, check_occupancy

MAX_VOXELS = 2_000_000
TOLERANCE = 0.02
"""How far from its target the count of a solid may be, as a share."""

_FEW = 4096
"""Up to this count a solid is coarse enough that quarter offsets and fine cells tell."""
_FULL = 0.7
"""A voxel with more of it inside than this is always taken."""
_COUNT_WEIGHT = 0.1
"""What missing the target by its whole costs, in IoU: smaller voxels alone raise the IoU."""
_WRONG_TOPOLOGY = 0.02
_NEAR_BEST = 0.01
_SAME = 1e-9
_SHORTLIST = 48
_SHELLS_TRIED, _SHELL_POWER = 6, 1.3
"""Solids tried for the count of their shell; a shell grows slower than the solid."""


def voxelize(
    mesh_or_path: object,
    voxels: int = 1600,
    up: str | tuple[float, float, float] = "+z",
    name: str | None = None,
    shell: Thickness | None = None,
) -> VoxelSolid:
    """A connected, void-free solid of about `voxels` voxels in the shape of a mesh (Section 3).

    Inside is where the winding number exceeds one half, so that meshes may be open, overlap
    themselves, have several bodies, or have faces that point the wrong way.

    Parameters
    ----------
    mesh_or_path : str, Path, trimesh.Trimesh, trimesh.Scene, pyvista dataset, or pair of arrays
        A file (OBJ, PLY, STL, OFF, GLB, GLTF), a mesh, or (vertices (V, 3), triangles (F, 3)).
    voxels : int
        Target count, met within 2 % wherever a grid allows; a plate along the axes jumps from
        one count to the next, and then the nearest count is taken and ``source["note"]`` says so.
    up : {"+x", "-x", "+y", "-y", "+z", "-z"} or 3 numbers
        Direction of the mesh that becomes +z.
    name : str, optional
        Name of the solid; that of the file if not given.
    shell : int or function of z, optional
        Thickness of a vented shell in place of the solid, as `lineup.shell` takes it; then the
        target is the count of the shell, whose voxels are smaller than those of a solid.

    Returns
    -------
    VoxelSolid
        Its ``source`` holds the input ("kind", "file", "sha256", "up", "faces_turned": faces that
        pointed the wrong way), the "target", the grid found ("pitch", and "origin": the lowest
        corner of the occupancy array in the upright mesh), and how well it fits: "iou" with 64
        cells a voxel; "voids_filled", "crumbs_dropped", "thin_voxels" (in
        no 2x2 block of their layer), "euler_mesh" and "euler_solid" (Euler numbers of the finely
        sampled mesh and of the solid), "emptiest" (the least share of a taken voxel that is
        inside), and "note": what fell short. Only a mesh that is thinner than a voxel is
        thickened, by taking voxels less than 30 % inside, and the note says so.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If the mesh is empty, flat, thin beyond measure, not finite, spoilt or of an unknown type,
        if `voxels` is not an integer from 1 to 2,000,000, or if `up` is no direction.

    Examples
    --------
    >>> import trimesh
    >>> solid = voxelize(trimesh.creation.box((2, 1, 1)), voxels=16)
    >>> solid.size, solid.occupancy.shape, round(solid.pitch, 6)
    (16, (4, 2, 2), 0.5)
    """
    if name is None:
        name = Path(mesh_or_path).stem if isinstance(mesh_or_path, str | PathLike) else ""
    check_voxels(voxels)
    surface = turned_upright(surface_of(mesh_or_path), up)
    direction = up if isinstance(up, str) else [float(c) for c in up]
    return fitted_shell(surface, voxels, name, {"up": direction}, shell)


def fitted_shell(
    surface: Surface,
    voxels: int,
    name: str,
    provenance: dict[str, Any],
    thickness: Thickness | None,
) -> VoxelSolid:
    """As `fitted`; with a thickness, a shell of about `voxels` voxels ("iou" is its outside's)."""
    if thickness is None:
        return fitted(surface, voxels, name, provenance)
    wanted, found, why = voxels, [], ""
    for _ in range(_SHELLS_TRIED):
        try:
            hollow = hollowed(fitted(surface, wanted, name, provenance), thickness)
        except ValueError as error:  # too coarse for a cavity; smaller voxels may have one
            why, wanted = str(error), min(MAX_VOXELS, round(1.4 * wanted))
            continue
        found.append(hollow)
        if not _miss(hollow.size, voxels):
            break
        wanted = min(MAX_VOXELS, round(wanted * (voxels / hollow.size) ** _SHELL_POWER))
    if not found:
        raise ValueError(why)
    best = min(found, key=lambda solid: _miss(solid.size, voxels))
    short = f"no shell of {voxels} voxels within 2 %: nearest count"
    notes = [best.source["note"], short if _miss(best.size, voxels) else ""]
    note = "; ".join(filter(None, notes))
    source = {**best.source, "target": int(voxels), "note": note}
    return VoxelSolid(best.occupancy, best.pitch, name, source)


def check_voxels(voxels: object) -> None:
    """Refuse a target count that is not an integer from 1 to `MAX_VOXELS`."""
    if (
        not isinstance(voxels, int | np.integer)
        or isinstance(voxels, bool)
        or not 1 <= voxels <= MAX_VOXELS
    ):
        raise ValueError(f"voxels must be an integer from 1 to {MAX_VOXELS}, got {voxels!r}")


def fitted(surface: Surface, voxels: int, name: str, provenance: dict[str, Any]) -> VoxelSolid:
    """The solid that fits an upright surface best; `provenance` is added to the surface's own."""
    sampling = sampled(surface, cells_wanted(voxels))
    fit = _best_fit(sampling, voxels)
    voids_of_mesh = sampling.n_void * float((sampling.cell / fit.pitch).prod())
    hollow = sampling.n_void > 0
    # The lowest line of an offset grid may lie within the mesh; a margin holds what is below it.
    padded = np.pad(fit.occupancy, ((1, 0), (1, 0), (1, 0)))
    shares = shares_inside(surface, fit.origin - fit.pitch, fit.pitch, padded.shape, hollow)
    occupancy, origin = _cropped(fit.occupancy, fit.origin, fit.pitch)
    source = {
        **surface.provenance,
        **provenance,
        "target": int(voxels),
        "iou": round(_iou(padded, shares, float(shares.sum())), 6),
        "pitch": fit.pitch,
        "origin": [float(c) for c in origin],
        "voids_filled": fit.voids_filled + round(voids_of_mesh),
        "crumbs_dropped": fit.crumbs_dropped,
        "thin_voxels": fit.thin,
        "euler_mesh": sampling.euler,
        "euler_solid": fit.euler,
        "emptiest": round(fit.emptiest, 6),
        "note": _note(fit, voxels),
    }
    return VoxelSolid(occupancy, pitch=fit.pitch, name=name, source=source)


def _note(fit: _Fit, voxels: int) -> str:
    remarks = []
    if _miss(fit.size, voxels):
        remarks.append(f"no grid gives {voxels} voxels within 2 %: nearest count")
    if fit.crumbs_dropped > TOLERANCE * fit.size:
        remarks.append("pieces apart from the largest are left out")
    if fit.emptiest < _SEARCHES[0].floor:
        remarks.append(
            f"thickened: the mesh is thinner than a voxel, and voxels only "
            f"{fit.emptiest:.0%} inside are taken"
        )
    return "; ".join(remarks)


@dataclass(frozen=True)
class _Fit:
    """A solid on a grid, and how it compares with the finely sampled shape."""

    occupancy: BoolArray
    origin: FloatArray
    pitch: float
    iou: float
    euler: int
    thin: int
    voids_filled: int
    crumbs_dropped: int
    emptiest: float

    @property
    def size(self) -> int:
        return int(self.occupancy.sum())


@dataclass(frozen=True)
class _Search:
    """Pitches and offsets to try; the next search follows where the best count is still far off.

    Attributes
    ----------
    scales : pitches, as multiples of that whose cube is the mesh's volume over the count
    steps : offsets in a voxel along each axis
    floor : a voxel with less of it inside than this is not taken
    content : how far off the count may be, as a share, to stop here
    """

    scales: FloatArray
    steps: int
    floor: float
    content: float


_SEARCHES = (
    _Search(np.linspace(0.955, 1.045, 7), steps=4, floor=0.3, content=TOLERANCE),
    _Search(np.linspace(0.7, 1.4, 57), steps=2, floor=0.3, content=0.5),
    # Sheets much thinner than a voxel: fill says little, and far fewer voxels carry the volume.
    _Search(np.geomspace(1, 12, 80), steps=2, floor=0.0, content=np.inf),
)


@dataclass(frozen=True)
class _Cut:
    """The `n` fullest voxels of the grid of this pitch and offset (a share of the pitch)."""

    pitch: float
    offset: tuple[float, ...]
    n: int
    worth: float
    miss: float


def cells_wanted(voxels: int) -> int:
    """Sampling cells inside; rounded up so that nearby counts share one sampling."""
    per_voxel = 216 if voxels <= _FEW else 64
    return int(per_voxel * 2 ** np.ceil(np.log2(max(voxels, 256))))


def _best_fit(sampling: Sampling, voxels: int) -> _Fit:
    fits: list[_Fit] = []
    aim = voxels
    for search in _SEARCHES:
        cuts = sorted(_cuts(sampling, aim, search), key=lambda cut: (cut.miss, -cut.worth))
        fits += [_fit(sampling, cut) for cut in cuts[:_SHORTLIST]]
        if not fits:
            continue
        nearest = min(fits, key=lambda fit: _miss(fit.size, voxels))
        if abs(nearest.size - voxels) <= search.content * voxels:
            break
        # Where pieces lie apart from the largest, it alone has to make up the count.
        aim = round(voxels * (1 + nearest.crumbs_dropped / nearest.size))
    least = min(_miss(fit.size, voxels) for fit in fits)
    fits = [fit for fit in fits if _miss(fit.size, voxels) == least]
    best = max(fit.iou for fit in fits)
    fits = [fit for fit in fits if fit.iou >= best - _NEAR_BEST]
    return max(fits, key=lambda fit: _worth(fit, voxels, sampling.euler))


def _worth(fit: _Fit, voxels: int, euler: int) -> float:
    """IoU less what a path will suffer from: thin and missing voxels, a wrong topology."""
    lost = (0.5 * fit.thin + fit.crumbs_dropped) / fit.size
    off = _COUNT_WEIGHT * abs(fit.size / voxels - 1)
    return fit.iou - lost - off - _WRONG_TOPOLOGY * (fit.euler != euler)


def _miss(n: int, voxels: int) -> float:
    return max(0.0, abs(n - voxels) - TOLERANCE * voxels)


def _cuts(sampling: Sampling, voxels: int, search: _Search) -> Iterator[_Cut]:
    """The best cut of each grid searched that has one."""
    steps = search.steps if voxels <= _FEW else 2
    offsets = list(product(np.arange(steps) / steps, repeat=3))
    usual = (sampling.volume / voxels) ** (1 / 3)
    for pitch in (usual * search.scales).tolist():
        total = sampling.volume / pitch**3
        for offset in offsets:
            shares = sampling.coverage(_lines(sampling, pitch, offset), pitch)
            fullest = np.sort(shares[shares > 0], axis=None)[::-1]
            inside = np.cumsum(fullest)
            n = np.arange(1, len(fullest) + 1)
            # Equal voxels are taken together, so that a symmetric shape stays symmetric.
            drop = np.append(fullest[:-1] - fullest[1:], 1.0) > _SAME
            first_left_out = np.append(fullest[1:], 0.0)
            n = n[drop & (fullest >= search.floor) & (first_left_out <= _FULL)]
            if not n.size:
                continue
            iou = inside[n - 1] / (n + total - inside[n - 1])
            worth = iou - _COUNT_WEIGHT * np.abs(n / voxels - 1)
            miss = np.maximum(0, np.abs(n - voxels) - TOLERANCE * voxels)
            at = int(np.lexsort((-worth, miss))[0])
            yield _Cut(pitch, offset, int(n[at]), float(worth[at]), float(miss[at]))


def _lines(sampling: Sampling, pitch: float, offset: tuple[float, ...]) -> list[FloatArray]:
    """Grid lines of each axis that cover the sampling; offset 0 puts one through its centre."""
    half = (np.array(sampling.table.shape) - 1) * sampling.cell / 2
    reaches = np.ceil(half / pitch)
    return [
        centre + pitch * (np.arange(-reach, reach + 2) + shift)
        for centre, reach, shift in zip(sampling.origin + half, reaches, offset, strict=True)
    ]


def _fit(sampling: Sampling, cut: _Cut) -> _Fit:
    lines = _lines(sampling, cut.pitch, cut.offset)
    shares = sampling.coverage(lines, cut.pitch)
    threshold = np.partition(shares, shares.size - cut.n, axis=None)[shares.size - cut.n]
    occupancy, crumbs = largest_component(shares >= threshold - _SAME)
    void = voids(occupancy)
    occupancy = occupancy | void
    return _Fit(
        occupancy=occupancy,
        origin=np.array([line[0] for line in lines]),
        pitch=cut.pitch,
        iou=_iou(occupancy, shares, sampling.volume / cut.pitch**3),
        euler=euler_number(occupancy),
        thin=thin_voxels(occupancy),
        voids_filled=int(void.sum()),
        crumbs_dropped=crumbs,
        emptiest=float(threshold),
    )


def _iou(occupancy: BoolArray, shares: FloatArray, total: float) -> float:
    inside = float(shares[occupancy].sum())
    return inside / (int(occupancy.sum()) + total - inside)


def thin_voxels(occupancy: BoolArray) -> int:
    """Number of voxels in no full 2x2 block of their layer; layered paths tend to lose them."""
    square = np.ones((2, 2, 1), bool)
    thick = ndimage.binary_opening(np.pad(occupancy, ((1, 1), (1, 1), (0, 0))), square)
    return int(occupancy.sum() - thick.sum())


def _cropped(
    occupancy: BoolArray, origin: FloatArray, pitch: float
) -> tuple[BoolArray, FloatArray]:
    filled = np.argwhere(occupancy)
    low, high = filled.min(axis=0), filled.max(axis=0) + 1
    box = tuple(slice(a, b) for a, b in zip(low, high, strict=True))
    return occupancy[box], origin + low * pitch


def mend(occupancy_or_mesh: object) -> VoxelSolid:
    """A solid of an array or mesh that is in several pieces or hollow; what it changed is reported.

    The largest face-connected component is kept, the voids that it encloses are filled, and empty
    margins are cut off. A mesh is voxelized at the default count.

    Parameters
    ----------
    occupancy_or_mesh : (X, Y, Z) bool, or what `voxelize` takes

    Returns
    -------
    VoxelSolid
        ``source["mended"]`` holds "crumbs_dropped" and "voids_filled", in voxels, and for an array
        "margin": the planes cut off at the low and at the high end of each axis.

    Raises
    ------
    ValueError
        If the array is not a 3D bool array with at least one voxel; for a mesh, as `voxelize`.

    Examples
    --------
    >>> import numpy as np
    >>> hollow = np.ones((5, 3, 3), bool)
    >>> hollow[1, 1, 1] = hollow[3] = False
    >>> mend(hollow).source["mended"]
    {'crumbs_dropped': 9, 'voids_filled': 1, 'margin': [[0, 2], [0, 0], [0, 0]]}
    """
    if not isinstance(occupancy_or_mesh, np.ndarray):
        solid = voxelize(occupancy_or_mesh)
        mended = {key: solid.source[key] for key in ("crumbs_dropped", "voids_filled")}
        return VoxelSolid(
            solid.occupancy, solid.pitch, solid.name, {**solid.source, "mended": mended}
        )
    occupancy, crumbs = largest_component(check_occupancy(occupancy_or_mesh))
    void = voids(occupancy)
    whole, low = _cropped(occupancy | void, np.zeros(3), 1.0)
    ends = np.array(occupancy.shape) - low - whole.shape
    mended = {
        "crumbs_dropped": crumbs,
        "voids_filled": int(void.sum()),
        "margin": [[int(a), int(b)] for a, b in zip(low, ends, strict=True)],
    }
    return VoxelSolid(whole, source={"kind": "array", "mended": mended})
