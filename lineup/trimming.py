"""Trimming to a common length (Section 5)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar, cast, overload

import numpy as np

from . import grid
from ._options import checked
from ._record import listed, of_kind
from .contraction import contracted, contraction_pairs, occupancy_of, shortened_path
from .folding.shorten import shortened_folding
from .grid import BoolArray
from .solid import Folding, VoxelPath
from .subset_sums import of_index_2, smallest_subsets

Item = TypeVar("Item", VoxelPath, Folding)

TRIMMED = "trimmed"


@dataclass(frozen=True, eq=False)
class Trimming(Sequence[Item]):
    """Paths or foldings of one length, in the order given; a sequence of them.

    Attributes
    ----------
    items : tuple of VoxelPath or of Folding
    reason : str
        "trimmed", or why the method cannot bring them to one length; then `items` are those
        given.
    """

    items: tuple[Item, ...]
    reason: str

    def __len__(self) -> int:
        return len(self.items)

    @overload
    def __getitem__(self, k: int) -> Item: ...
    @overload
    def __getitem__(self, k: slice) -> Sequence[Item]: ...
    def __getitem__(self, k: int | slice) -> Item | Sequence[Item]:
        return self.items[k]

    def __iter__(self) -> Iterator[Item]:
        return iter(self.items)


def trim(
    items: Sequence[Item], length: int | None = None, method: str = "exact", **options: Any
) -> Trimming[Item]:
    """Paths or foldings, all of one even length (Section 5).

    Parameters
    ----------
    items : sequence of VoxelPath or of Folding
    length : int, optional
        Number of voxels to keep. By default that of the shortest item; for ``"paper"`` the method
        chooses, where pairs of index 2 are too few.
    method : str
        A key of `TRIM_METHODS`. ``"exact"`` always comes to the length, and loses as few voxels
        to keep as contractions can. ``"paper"`` is Section 5 as written, for paths only; it may
        fail.
    options
        ``keep``, of both methods: the voxels to keep. ``"surface"`` (default), ``"none"``, or
        one (X, Y, Z) bool mask for each item.

    Returns
    -------
    Trimming
        A sequence in the order given; an item of the right length is handed back as it is.
        ``path.method`` says how the voxels went.

    Raises
    ------
    ValueError
        If there are no items, one has an odd number of voxels, the method or an option is
        unknown, or `length` is odd, less than 2 or more than the shortest item.

    Notes
    -----
    ``"exact"``: the voxels between contraction pairs go first. Where they are too few, these
    follow, each only where those before it do not do: whole excursions (between two adjacent
    voxels the path leaves its piece, and there is nothing to keep where it goes), blocks off
    either end, and last voxels to keep, between pairs or off the ends, as few as possible.

    A folding of peels and swings keeps a valid plan through every contraction, so fewer are
    open to it: any pair with nothing to keep between, then blocks without voxels to keep off
    the ends, then pairs of index 2, then blocks off the ends that cost the least. A folding that
    is pulled out stays one; without Us it loses voxels between pairs that make none, with nothing
    to keep between, then blocks off the ends that cost the least. Any other folding is unfolded
    anew.

    ``"paper"``: one linear scan of each path. If every path has enough disjoint pairs of index
    2, the first of them go; otherwise the least number of pairs whose indices bring the paths
    to one length, by dynamic programming over subset sums. The paper is silent on pairs that
    overlap: only disjoint ones are taken. Of several such choices the longest paths are kept.
    It speaks of two paths; any number are treated alike.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> big, small = (lu.VoxelSolid(np.ones((n, 4, 4), bool)) for n in (5, 4))
    >>> paths = [lu.layered_path(big), lu.layered_path(small)]
    >>> [len(path) for path in lu.trim(paths)]
    [64, 64]
    """
    checked(TRIM_METHODS, method, options, "trimming method")
    listed(items, "items")
    if not len(items):
        raise ValueError("there is nothing to trim; give at least one path or folding")
    lengths = [len(_path(item)) for item in items]
    odd = [n for n in lengths if n % 2]
    if odd:
        raise ValueError(f"blocks are two voxels each, but an item has {odd[0]} voxels")
    if length is not None and (length % 2 or not 2 <= length <= min(lengths)):
        raise ValueError(
            f"length must be an even number from 2 to the {min(lengths)} voxels of the shortest "
            f"item, got {length}"
        )
    return cast("Trimming[Item]", TRIM_METHODS[method](items, length, **options))


def _path(item: VoxelPath | Folding) -> VoxelPath:
    of_kind(item, VoxelPath, Folding)
    return item.path if isinstance(item, Folding) else item


def _exact(
    items: Sequence[Item], length: int | None, *, keep: str | Sequence[BoolArray] = "surface"
) -> Trimming[Item]:
    if length is None:
        length = min(len(_path(item)) for item in items)
    masks = _masks(items, keep)
    trimmed = [_shortened(item, length, mask) for item, mask in zip(items, masks, strict=True)]
    return Trimming(tuple(cast("list[Item]", trimmed)), TRIMMED)


def _shortened(item: VoxelPath | Folding, length: int, keep: BoolArray) -> VoxelPath | Folding:
    if len(_path(item)) == length:
        return item
    if isinstance(item, Folding):
        return shortened_folding(item, length, keep)
    return shortened_path(item, length, keep)


def _masks(
    items: Sequence[VoxelPath | Folding], keep: str | Sequence[BoolArray]
) -> list[BoolArray]:
    """What to keep of each item, on the smallest grid from 0 that holds its solid."""
    solids = [occupancy_of(_path(item)) for item in items]
    if isinstance(keep, str):
        if keep not in ("surface", "none"):
            raise ValueError(
                f"keep must be 'surface', 'none' or a mask for each item, got {keep!r}"
            )
        return [grid.surface(s) if keep == "surface" else np.zeros_like(s) for s in solids]
    if len(keep) != len(items):
        raise ValueError(f"keep has {len(keep)} masks for {len(items)} items")
    for mask, solid in zip(keep, solids, strict=True):
        fits = mask.ndim == 3 and (np.array(mask.shape) >= solid.shape).all()
        if mask.dtype != bool or not fits:
            raise ValueError(
                f"a mask to keep must be bool and of shape {solid.shape} or more, "
                f"got {mask.dtype} of shape {mask.shape}"
            )
    return [mask[tuple(map(slice, s.shape))] for mask, s in zip(keep, solids, strict=True)]


def _paper(
    items: Sequence[VoxelPath],
    length: int | None,
    *,
    keep: str | Sequence[BoolArray] = "surface",
) -> Trimming[VoxelPath]:
    if any(isinstance(item, Folding) for item in items):
        raise ValueError("method 'paper' trims paths, before their motion is planned")
    masks = _masks(items, keep)
    scans = [contraction_pairs(path, mask) for path, mask in zip(items, masks, strict=True)]
    target = min(map(len, items)) if length is None else length
    excess = [len(path) - target for path in items]
    chosen = [of_index_2(scan, n // 2) for scan, n in zip(scans, excess, strict=True)]
    which = "of index 2"
    if any(2 * len(pairs) < n for pairs, n in zip(chosen, excess, strict=True)):
        which = "of a smallest subset"
        found = smallest_subsets(scans, [len(path) for path in items], length)
        if isinstance(found, str):
            return Trimming(tuple(items), found)
        chosen = found
    trimmed = [contracted(*cut, which) for cut in zip(items, chosen, strict=True)]
    return Trimming(tuple(trimmed), TRIMMED)


TRIM_METHODS: dict[str, Callable[..., Trimming[Any]]] = {"exact": _exact, "paper": _paper}
"""The ways to trim by name: functions of items, a length or None, and keyword-only options."""
