"""Long paths in one layer of voxels, from one given cell to another (Section 4.1)."""

from .blocks import DIFFERENT, Region, chain, chain_limit, region
from .long import NO_WISHES, Wishes, long_path

__all__ = [
    "DIFFERENT",
    "NO_WISHES",
    "Region",
    "Wishes",
    "chain",
    "chain_limit",
    "long_path",
    "region",
]
