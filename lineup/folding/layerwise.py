"""First a layered path, then a motion that unfolds it: the paper's order of work."""

from ..contraction import shortened_path
from ..grid import surface
from ..layered import layered_path
from ..motion import unfold
from ..motion.peeling import peel_upward
from ..solid import Folding, VoxelSolid


def layered_folding(
    solid: VoxelSolid, seed: int, length: int | None, *, starts: int = 4
) -> Folding:
    """A layered path, unfolded by whichever method can."""
    del length  # the caller trims
    path = layered_path(solid, seed=seed, starts=starts)
    return Folding(path, unfold(path, seed=seed))


def top_ends_folding(
    solid: VoxelSolid, seed: int, length: int | None, *, starts: int = 4
) -> Folding:
    """Section 7's heuristic: both ends of a layered path on top, and pulled upward.

    The ends are in one component of a layer, as high up as can be; where pulling them upward is
    not enough, the motion's `reason` says so, and other peels and doors follow.
    """
    del length  # the caller trims
    path = layered_path(solid, seed=seed, starts=starts, both_ends_on_top=True)
    return Folding(path, peel_upward(path, seed))


def paper_folding(solid: VoxelSolid, seed: int, length: int | None) -> Folding:
    """Algorithms 2 and 3, the trimming of Section 5, and Algorithm 4's energy-driven motion.

    The motion may end not straight, which its `reason` tells.
    """
    path = layered_path(solid, "paper", seed)
    if length is not None and length < len(path):
        path = shortened_path(path, length, surface(solid.occupancy))
    return Folding(path, unfold(path, "energy", seed))
