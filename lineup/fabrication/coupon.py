"""A small test print that tells which clearance and snap a printer and its material need."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd
from manifold3d import Manifold

from ..block import Block, Part, block_parts, solids
from ..block.parts import part_of
from ..grid import IntArray
from .placing import Placed, placed

CLEARANCES = (0.6, 1.0, 1.4)
SNAPS = (0.5, 2.0)
"""What the coupon tries, relative to the block's own."""

_PIP_STEP_DEG = 18.0


@dataclass(frozen=True, eq=False)
class Coupon:
    """Short chains that differ in clearance, and in the snap of their two ends.

    Attributes
    ----------
    parts : dict of str to Part
    places : tuple of Placed
        `part` is a key of `parts`.
    table : DataFrame
        Columns pips, ring, clearance_mm, snap_mm: what the marks on an end stand for.
    """

    parts: dict[str, Part]
    places: tuple[Placed, ...]
    table: pd.DataFrame


def coupon(block: Block) -> Coupon:
    """Three blocks of three clearances; their ends snap less, or more and have a ring.

    An end has one to three pips, for its clearance. Where capsules swivel, each of the three is a
    chain of two blocks with a swivel in its middle, and the ends are alike. What a block cannot be
    printed with is left out.

    Examples
    --------
    >>> from lineup.block import Block
    >>> coupon(Block()).table["snap_mm"].tolist()
    [0.05, 0.2, 0.05, 0.2, 0.05, 0.2]
    """
    parts: dict[str, Part] = {"hinge": block_parts(block)["hinge"]}
    places: list[Placed] = []
    rows = []
    n_blocks = 2 if block.swivel else 1
    for row, (pips, ends) in enumerate(_variants(block)):
        for piece in placed(_row(n_blocks, 2 * row), block):
            name = piece.part
            if name == "end":
                name = f"end-{pips}{'-ring' if piece.bar >= 0 and len(ends) > 1 else ''}"
            elif name != "hinge":
                name = f"{name}-{pips}"
            places.append(replace(piece, part=name))
        for ring, end in enumerate(ends):
            name = f"end-{pips}{'-ring' if ring else ''}"
            parts[name] = part_of(_marked(solids(end)["end"], end, pips, bool(ring)))
            rows.append((pips, "yes" if ring else "no", end.clearance_mm, end.snap_mm))
        for name in ("sleeve", "pin") if block.swivel else ():
            parts[f"{name}-{pips}"] = block_parts(ends[0])[name]
    table = pd.DataFrame(rows, columns=["pips", "ring", "clearance_mm", "snap_mm"])
    return Coupon(parts, tuple(places), table)


def _variants(block: Block) -> Iterator[tuple[int, tuple[Block, ...]]]:
    """Pips and the blocks whose ends are tried at a clearance."""
    for pips, share in enumerate(CLEARANCES, start=1):
        clearance = round(share * block.clearance_mm, 3)
        snaps = [round(s * block.snap_mm, 3) for s in SNAPS] if block.snap_mm > 0 else [-clearance]
        try:
            gap = max(clearance, block.gap_mm)
            fit = replace(block, clearance_mm=clearance, gap_mm=gap, snap_mm=min(snaps))
            ends = tuple(replace(fit, snap_mm=snap) for snap in snaps)
        except ValueError:  # out of the ranges of this block
            continue
        yield pips, ends


def _row(n_blocks: int, y: int) -> IntArray:
    x = np.arange(2 * n_blocks)
    return np.stack([x, np.full_like(x, y), np.zeros_like(x)], axis=1).astype(np.int32)


def _marked(end: Any, block: Block, pips: int, ring: bool) -> Any:
    """An end with pips in a row round it, between two slots, and a ring behind them."""
    r = block.radius_mm
    dot = Manifold.sphere(0.1 * r, 16).translate([-0.5 * r, 0, r])
    for k in range(pips):
        end -= dot.rotate([45 + _PIP_STEP_DEG * (k - (pips - 1) / 2), 0, 0])
    if ring:
        groove = Manifold.cylinder(0.16 * r, 2 * r, circular_segments=block.segments)
        core = Manifold.cylinder(0.16 * r, 0.9 * r, circular_segments=block.segments)
        end -= (groove - core).rotate([0, 90, 0]).translate([-0.9 * r, 0, 0])
    return end
