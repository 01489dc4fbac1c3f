"""The printable building block: its parameters, its parts, and what is checked of them."""

from .checks import BlockReport, check_block, check_parts
from .parameters import BLOCKS, WALL_MM, Block, named_block, scaled
from .parts import Part, block_parts, solids
from .strength import (
    block_strength,
    buckling_force_n,
    column_force_n,
    insertion_strain,
    slenderness,
    snap_force_n,
    snap_strain,
)

__all__ = [
    "BLOCKS",
    "WALL_MM",
    "Block",
    "BlockReport",
    "Part",
    "block_parts",
    "block_strength",
    "buckling_force_n",
    "check_block",
    "check_parts",
    "column_force_n",
    "insertion_strain",
    "named_block",
    "scaled",
    "slenderness",
    "snap_force_n",
    "snap_strain",
    "solids",
]
