"""Path and motion designed together."""

from collections.abc import Callable
from typing import Any

import numpy as np

from .._options import checked
from .._record import of_kind
from ..solid import Folding, VoxelSolid
from .growing import growth
from .layerwise import layered_folding, paper_folding, top_ends_folding
from .pulling import pulled
from .shorten import shortened_folding


def fold(
    solid: VoxelSolid,
    method: str = "growth",
    length: int | None = None,
    seed: int = 0,
    **options: Any,
) -> Folding:
    """A path through `solid` and a motion that unfolds it.

    Parameters
    ----------
    method : str
        A key of `FOLD_METHODS`. ``"growth"`` changes path and motion together and always ends
        straight; its options are `paths`, `trial_rounds`, `rounds`, `ends` and `progress`.
        ``"layered"`` unfolds a layered path (Sections 4 and 6), which may get stuck; its option
        is `starts`. So is that of ``"top_ends"``, which puts both ends of the path on top and
        pulls them upward (Section 7). ``"paper"`` is Algorithms 2 to 4 as published.
        ``"pull"`` pulls a path of the method `path` (``"ufree"``) out by one end: for thinner
        bars, see `Motion.diameter` and `max_bend_deg`; its other option is `sweeps`, that of the
        path.
    length : int, optional
        Even number of voxels to trim to. A path that stays shorter is returned as it is.
    seed : int
        The same solid, seed and options give the same folding.

    Returns
    -------
    Folding
        Only `certify` says that its motion is free of collisions.

    Raises
    ------
    ValueError
        If the method or an option is unknown, the solid is one voxel, or the length is odd,
        less than 2 or more than the solid's voxels.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> solid = lu.VoxelSolid(np.ones((4, 4, 3), bool))
    >>> folding = lu.fold(solid, rounds=100, trial_rounds=10)
    >>> len(folding.path), lu.certify(folding.motion).ok
    (48, True)
    """
    of_kind(solid, VoxelSolid)
    checked(FOLD_METHODS, method, options, "fold method")
    if solid.size < 2:
        raise ValueError("a path needs at least two voxels, the solid has 1")
    if length is not None:
        whole = isinstance(length, int | np.integer)
        if not (whole and length % 2 == 0 and 2 <= length <= solid.size):
            raise ValueError(
                f"length must be an even number from 2 to the solid's {solid.size} voxels, "
                f"got {length!r}"
            )
    folding = FOLD_METHODS[method](solid, seed, length, **options)
    if length is None or len(folding.path) <= length:
        return folding
    return shortened_folding(folding, length)


FOLD_METHODS: dict[str, Callable[..., Folding]] = {
    "growth": growth,
    "layered": layered_folding,
    "top_ends": top_ends_folding,
    "pull": pulled,
    "paper": paper_folding,
}
"""The planners of path and motion by name: functions of a solid, seed, length and options."""
