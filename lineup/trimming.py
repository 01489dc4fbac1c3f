"""Trimming to a common length (Section 5)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar, cast

from .contraction import shortened_path
from .folding.shorten import shortened_folding
from .solid import Folding, VoxelPath

Item = TypeVar("Item", VoxelPath, Folding)


def trim(items: Sequence[Item], length: int | None = None) -> list[Item]:
    """Paths or foldings, all of one even length (Section 5).

    Contraction pairs inside the solid go first. Where they are too few, pairs with surface
    voxels go, and last whole blocks off the end of the path; ``path.method`` says how many of
    each. A folding of peels and swings keeps a valid plan through every contraction; any other
    is unfolded anew.

    Parameters
    ----------
    items : sequence of VoxelPath or of Folding
    length : int, optional
        Number of voxels to keep; the length of the shortest item by default.

    Returns
    -------
    list
        In the order given; an item of the right length is handed back as it is.

    Raises
    ------
    ValueError
        If there are no items, or `length` is odd, less than 2 or more than the shortest item.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> big, small = (lu.VoxelSolid(np.ones((n, 4, 4), bool)) for n in (5, 4))
    >>> paths = [lu.layered_path(big), lu.layered_path(small)]
    >>> [len(path) for path in lu.trim(paths)]
    [64, 64]
    """
    if not items:
        raise ValueError("there is nothing to trim; give at least one path or folding")
    shortest = min(_length(item) for item in items)
    if length is None:
        length = shortest - shortest % 2
    if length % 2 or not 2 <= length <= shortest:
        raise ValueError(
            f"length must be an even number from 2 to the {shortest} voxels of the shortest item, "
            f"got {length}"
        )
    return [cast(Item, _trimmed(item, length)) for item in items]


def _length(item: VoxelPath | Folding) -> int:
    return len(item.path if isinstance(item, Folding) else item)


def _trimmed(item: VoxelPath | Folding, length: int) -> VoxelPath | Folding:
    if _length(item) == length:
        return item
    if isinstance(item, Folding):
        return shortened_folding(item, length)
    return shortened_path(item, length)
