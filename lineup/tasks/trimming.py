"""Task `trimming`: how much of a path can go, at so much loss of surface (Section 5)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from .. import grid
from ..contraction import contraction_pairs, occupancy_of
from ..solid import Folding, VoxelPath
from ..trimming import TRIMMED, trim
from ._common import made, solid_of, source_of

COLUMNS = ("source", "n_voxels", "length", "pairs", "least", "removable", "surface_lost")
"""What is in a row."""


def trimming(
    model: str,
    voxels: int,
    item: str,
    method: str,
    loss: float = 0.0,
    seed: int = 0,
    *,
    folder: Path,
    progress: Callable[[str], None],
) -> dict[str, Any]:
    """The shortest length that `trim` brings an item to, if it may lose a share of its surface.

    Takes a key of `PATH_METHODS` as `item`, or "growth" for a folding; a key of `TRIM_METHODS` as
    `method`; and as `loss` the share of the surface voxels on the path that may go.
    """
    if not 0 <= loss <= 1:
        raise ValueError(f"loss must be a share from 0 to 1, got {loss}")
    progress("voxelize")
    solid = solid_of(model, voxels)
    progress(item)
    whole = made(solid, item, seed)
    n_surface = on_surface(whole, whole)

    def lost(length: int) -> float:
        cut = trim([whole], length, method)  # type: ignore[type-var]
        return 1.0 if cut.reason != TRIMMED else 1 - on_surface(cut[0], whole) / n_surface

    progress("trim")
    least = shortest(len(path_of(whole)), lambda length: lost(length) <= loss)
    keep = grid.surface(occupancy_of(path_of(whole)))
    return {
        "source": source_of(solid),
        "n_voxels": solid.size,
        "length": len(path_of(whole)),
        "pairs": len(contraction_pairs(path_of(whole), keep)),
        "least": least,
        "removable": 1 - least / len(path_of(whole)),
        "surface_lost": lost(least),
    }


def path_of(item: VoxelPath | Folding) -> VoxelPath:
    return item.path if isinstance(item, Folding) else item


def on_surface(item: VoxelPath | Folding, whole: VoxelPath | Folding) -> int:
    """Surface voxels, of the solid of `whole`, that an item visits."""
    surface = grid.surface(occupancy_of(path_of(whole)))
    return int(surface[tuple(path_of(item).voxels.T)].sum())


def shortest(length: int, may_be: Callable[[int], bool]) -> int:
    """The least even length found by halving, taken for granted that every longer one may be."""
    low, high = 0, length // 2  # low blocks are too few, high may be
    while high - low > 1:
        middle = (low + high) // 2
        if may_be(2 * middle):
            high = middle
        else:
            low = middle
    return 2 * high
