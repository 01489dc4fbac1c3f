"""Long paths in one layer of voxels, from one given cell to another (Section 4.1)."""

from .blocks import DIFFERENT, Region, chain, chain_limit, region
from .long import NO_WISHES, Wishes, long_path
from .paper import PaperPath, paper_path
from .problem import PLANAR_METHODS, PlanarPath, planar_path
from .zhang_liu import LongCycle, zhang_liu_cycle

__all__ = [
    "DIFFERENT",
    "NO_WISHES",
    "PLANAR_METHODS",
    "LongCycle",
    "PaperPath",
    "PlanarPath",
    "Region",
    "Wishes",
    "chain",
    "chain_limit",
    "long_path",
    "paper_path",
    "planar_path",
    "region",
    "zhang_liu_cycle",
]
