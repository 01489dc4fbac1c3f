"""Which assumptions of Algorithm 3 the nodes of a solid meet (Section 4.4).

The paper calls them mild, and easily met by a solid of high resolution. Here they are counted.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise

import numpy as np
import pandas as pd
from scipy import ndimage

from ._record import listed, record
from .grid import BoolArray, IntArray
from .planar.faces import Cell, connected_cells, is_cycle, outer_walk
from .planar.paper import (
    BOUNDARY_NOT_A_CYCLE,
    DANGLING_ATE_REGION,
    INTERIOR_DISCONNECTED,
    NO_INTERIOR,
    without_dangling,
)
from .planar.paper import REASONS as PLANAR_REASONS
from .planar.zhang_liu import NO_2_FACTOR, NOT_REGULAR, zhang_liu_cycle
from .reeb import ReebGraph, Traversal, reeb_graph, traverse
from .solid import VoxelSolid

HOLE = "hole"
NO_COMMON_INTERIOR = "no-common-interior"
NO_LINK_INSIDE = "no-link-inside"

REASONS: dict[str, str] = {
    **PLANAR_REASONS,
    HOLE: "the region has a hole",
    NO_COMMON_INTERIOR: "I_i minus v_s is empty (Section 4.3.1)",
    NO_LINK_INSIDE: "no free link of the path that it hangs off lies in its interior (4.3.2)",
}
"""What each reason code says: the assumption of Section 4 that does not hold."""

_NO_REGION = (DANGLING_ATE_REGION, NO_INTERIOR, INTERIOR_DISCONNECTED)

ASSUMPTIONS = {
    "interior_exists": (DANGLING_ATE_REGION, NO_INTERIOR),
    "interior_connected": (INTERIOR_DISCONNECTED,),
    "boundary_cycle": (DANGLING_ATE_REGION, BOUNDARY_NOT_A_CYCLE),
    "no_hole": (HOLE,),
    "linked": (NO_COMMON_INTERIOR, NO_LINK_INSIDE),
    "regular": (*_NO_REGION, NOT_REGULAR, NO_2_FACTOR),
}
"""The assumptions by name, each with the reason codes that say it does not hold."""


@record
class Anatomy:
    """What Algorithm 2 makes of a region before it draws a path (Section 4.1, Figure 5).

    Attributes
    ----------
    removed : (D, 2) int32
        Dangling voxels, in the order of their removal, until none is left.
    boundary : (B, 2) int32
        The walk round the outermost boundary of the rest; a voxel may come more than once.
    interior : (X, Y) bool
        What is left. A hole's rim belongs to it (the paper's footnote 2).
    reasons : tuple of str
        Keys of `REASONS` for what the region breaks.
    """

    removed: IntArray
    boundary: IntArray
    interior: BoolArray
    reasons: tuple[str, ...]


def anatomy(mask: BoolArray) -> Anatomy:
    """Dangling voxels, boundary and interior of a 4-connected region.

    Parameters
    ----------
    mask : (X, Y) bool

    Raises
    ------
    ValueError
        If `mask` is not that, or not one region.

    Examples
    --------
    >>> import numpy as np
    >>> from lineup.assumptions import anatomy
    >>> parts = anatomy(np.ones((4, 5), bool))
    >>> len(parts.boundary), int(parts.interior.sum()), parts.reasons
    (14, 6, ())
    """
    cells, removed = without_dangling(connected_cells(mask), mask)
    interior = np.zeros_like(mask)
    walk = outer_walk(cells) if cells else []
    inner = np.array(sorted(cells - set(walk)), int).reshape(-1, 2)
    interior[tuple(inner.T)] = True
    reasons = []
    if not cells:
        reasons.append(DANGLING_ATE_REGION)
    else:
        if not is_cycle(walk):
            reasons.append(BOUNDARY_NOT_A_CYCLE)
        if not len(inner):
            reasons.append(NO_INTERIOR)
    if (ndimage.binary_fill_holes(mask, structure=np.ones((3, 3), bool)) & ~mask).any():
        reasons.append(HOLE)
    if ndimage.label(interior)[1] > 1:
        reasons.append(INTERIOR_DISCONNECTED)
    return Anatomy(_rows(removed), _rows(walk), interior, tuple(reasons))


def audit(solid: VoxelSolid) -> pd.DataFrame:
    """Which assumptions of Section 4.4 each node of a solid's Reeb graph meets.

    Returns
    -------
    DataFrame
        One row for each node, in order.

        - "node"; "layer", its z; "part", "MSP" or "MSC" in the traversal of `traverse`;
        - "voxels" of the node, concerned where an assumption fails; "dangling", those removed,
          over and over; "boundary" and "interior", those of the rest;
        - "interior_exists", "interior_connected"; "boundary_cycle", the boundary is one simple
          cycle; "no_hole" (footnote 2 says how to do without this one);
        - "linked", for a node of the MSP: I_i minus v_s is not empty, whichever v_s Section 4.3.1
          draws. For a node of an MSC: two neighbours in its interior lie over or under what the
          node that it hangs off keeps; Section 4.3.2 asks that the path have a link there, so
          this is necessary, and all that can be said without the path. True where nothing
          is asked;
        - "regular", the hypotheses of Zhang and Liu, which Lemma 4.1 rests on: the interior's
          boundaries are disjoint simple cycles, the rest has a square-free 2-factor. False where
          the interior is empty or falls apart;
        - "listed", all of these but "regular", which Section 4 does not mention; "met", all;
          "reasons", keys of `assumptions.REASONS` with commas between.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> stairs = np.ones((6, 7, 2), bool)
    >>> stairs[2:, :, 1] = False
    >>> nodes = lu.audit(lu.VoxelSolid(stairs))
    >>> nodes[["voxels", "boundary", "interior", "met", "reasons"]].values.tolist()
    [[42, 22, 20, True, ''], [14, 14, 0, False, 'no-interior, no-common-interior']]
    """
    graph = reeb_graph(solid)
    traversal = traverse(graph)
    masks = [mask_of(graph, node) for node in range(len(graph))]
    parts = [anatomy(mask) for mask in masks]
    unlinked = _unlinked(traversal, masks, parts)
    rows = []
    for node, (mask, part) in enumerate(zip(masks, parts, strict=True)):
        reasons = [*part.reasons, *_irregular(part)]
        if node in unlinked:
            reasons.append(unlinked[node])
        holds = {name: not set(codes) & set(reasons) for name, codes in ASSUMPTIONS.items()}
        rows.append(
            {
                "node": node,
                "layer": int(graph.layer_of[node]),
                "part": "MSP" if node in traversal.msp else "MSC",
                "voxels": int(mask.sum()),
                "dangling": len(part.removed),
                "boundary": len(np.unique(part.boundary, axis=0)),
                "interior": int(part.interior.sum()),
                **holds,
                "listed": all(held for name, held in holds.items() if name != "regular"),
                "met": all(holds.values()),
                "reasons": ", ".join(reasons),
            }
        )
    return pd.DataFrame(rows)


def audit_summary(solids: Iterable[VoxelSolid]) -> pd.DataFrame:
    """The share of nodes and of voxels that meet the assumptions, one row for each solid.

    Returns
    -------
    DataFrame
        "name"; "voxels"; "nodes"; "dangling", share of the voxels that are removed; for each
        assumption the share of nodes that meet it; "nodes_listed" and "nodes_met", the share of
        nodes that meet all that Section 4 lists, and all; "voxels_listed" and "voxels_met", the
        share of the voxels in these.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> block = lu.VoxelSolid(np.ones((6, 7, 5), bool), name="block")
    >>> lu.audit_summary([block])[["name", "nodes", "nodes_met", "voxels_met"]].values.tolist()
    [['block', 5, 1.0, 1.0]]
    """
    if not isinstance(solids, Iterator):
        listed(solids, "solids")
    return pd.DataFrame([_summary(solid) for solid in solids])


def mask_of(graph: ReebGraph, node: int) -> BoolArray:
    """The region of a node, (X, Y) bool."""
    mask: BoolArray = graph.node_of[:, :, graph.layer_of[node]] == node
    return mask


def hanging_from(traversal: Traversal) -> dict[int, int]:
    """The node that each node of an MSC hangs off, in the order of the walk."""
    above: dict[int, int] = {}
    for cycle in traversal.mscs:
        for before, node in pairwise(cycle[:-1]):
            if node != cycle[0]:
                above.setdefault(node, before)
    return above


def _unlinked(traversal: Traversal, masks: list[BoolArray], parts: list[Anatomy]) -> dict[int, str]:
    """The nodes whose assumption on I_i or I~_i fails, with the reason code."""
    failed = {}
    msp = traversal.msp
    before = parts[msp[0]].interior
    for node, following in pairwise(msp):
        common = parts[node].interior & parts[following].interior
        if common.sum() <= (common & before).any():
            failed[node] = NO_COMMON_INTERIOR
        before = common
    for node, above in hanging_from(traversal).items():
        kept = masks[above].copy()
        kept[tuple(parts[above].removed.T)] = False
        both = kept & parts[node].interior
        if not ((both[1:] & both[:-1]).any() or (both[:, 1:] & both[:, :-1]).any()):
            failed[node] = NO_LINK_INSIDE
    return failed


def _irregular(part: Anatomy) -> list[str]:
    """Which hypotheses of Zhang and Liu a connected interior breaks."""
    if set(part.reasons) & set(_NO_REGION):
        return []
    found = zhang_liu_cycle(part.interior).reasons
    return [code for code in found if code in ASSUMPTIONS["regular"]]


def _summary(solid: VoxelSolid) -> dict[str, object]:
    nodes = audit(solid)
    return {
        "name": solid.name,
        "voxels": solid.size,
        "nodes": len(nodes),
        "dangling": nodes["dangling"].sum() / solid.size,
        **{name: nodes[name].mean() for name in ASSUMPTIONS},
        **{f"nodes_{kind}": nodes[kind].mean() for kind in ("listed", "met")},
        **{
            f"voxels_{kind}": nodes["voxels"][nodes[kind]].sum() / solid.size
            for kind in ("listed", "met")
        },
    }


def _rows(cells: list[Cell]) -> IntArray:
    return np.array(cells, np.int32).reshape(-1, 2)
