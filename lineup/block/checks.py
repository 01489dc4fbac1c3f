"""What a block must be to be printed in one go and to hold: checked on its solids.

The checks look at the parts alone and not at how they were made, so that they can be shown faults.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain, product
from typing import Any, TypeAlias

import igl
import numpy as np
from scipy import ndimage

from ..grid import FloatArray
from .parameters import Block
from .parts import join_clearance_mm, part_of, solids

Pair: TypeAlias = tuple[Any, Any]
"""Two solids that might meet."""

STATES = ((0, 0), (0, 1), (0, -1), (1, 0), (-1, 0))
"""The five states of a joint on the lattice: quarter turns about -y and z, of which one is 0."""

_STEPS = 8
"""Positions of a bar on its way along a slot that are looked at where nothing is to snap."""
_TWISTS_DEG = (22.5, 45.0, 67.5)
_HALVES = (("pin", "sleeve", None), ("tongue", "groove", 1))
"""What holds what, and along which axis it slides in."""
_VOLUME = 1e-6  # mm^3 that count as none
_TRIES = (8, 16)
"""Positions of a ball's centre along each half axis; the second where the first is too coarse."""


@dataclass(frozen=True)
class BlockReport:
    """What was found of a block.

    Attributes
    ----------
    ok : bool
    reason : str
        "printable", or the first thing that is wrong.
    poses : int
        Poses of two capsules and the hinge between them that were looked at: 0, and the numbers
        below nan, where a part on its own is wrong.
    overlap_mm3 : float
        Largest volume that two parts share in any of them.
    gap_mm : float
        Least distance between two parts in any of them, or twice the clearance if that is less.
    play_mm : float
        How far a ball can leave the centre of its socket before it is held, at most.
    snap_mm3 : float
        Largest volume that a bar shares with the sides of a slot on its way: 0 if nothing snaps.
    """

    ok: bool
    reason: str
    poses: int
    overlap_mm3: float
    gap_mm: float
    play_mm: float
    snap_mm3: float


@lru_cache(maxsize=32)
def check_block(block: Block) -> BlockReport:
    """Whether the parts of a block are solid, move, and hold together (Figures 2 and 16).

    Each part is one closed body without handles, and lies in its own two voxels; so a chain in the
    pose of any simple lattice path is printed without one piece running into another. In each of
    the 5 x 5 lattice states of a capsule, a hinge and a capsule nothing overlaps, and clearances
    are kept; if the block swivels, at every step along a slot and twist of the capsule, too. No
    ball leaves its socket by any way, as long as nothing gives.

    Returns
    -------
    BlockReport

    Examples
    --------
    >>> report = check_block(Block())
    >>> report.reason, report.poses, report.overlap_mm3
    ('printable', 25, 0.0)
    """
    return check_parts(solids(block), block)


def check_parts(parts: Mapping[str, Any], block: Block) -> BlockReport:
    """As `check_block`, of solids of manifold3d that claim to be the parts of a block.

    Raises
    ------
    ValueError
        If a part is missing.
    """
    needed = {"hinge", "end"} | ({"sleeve", "pin"} if block.swivel else {"middle"})
    missing = sorted(needed - set(parts))
    if missing:
        raise ValueError(f"a block needs a part {missing[0]!r}, got {sorted(parts)}")
    wrong = [f"{name}: {fault}" for name in sorted(parts) for fault in _faults(name, parts, block)]
    if wrong:  # what is not a body can be in no pose
        nan = float("nan")
        return BlockReport(False, wrong[0], 0, nan, nan, nan, nan)
    poses = list(_poses(parts, block))
    pairs = [*chain.from_iterable(poses), *_joints(parts, block)]
    overlap, gap = _overlap(pairs), _gap(pairs, 2 * block.clearance_mm)
    if overlap > _VOLUME:
        wrong.append(f"parts overlap by {overlap:.3g} mm^3 in a state of the joints")
    elif gap < block.clearance_mm - 1e-3:
        wrong.append(f"parts come within {gap:.3f} mm, and {block.clearance_mm:g} are asked for")
    radius = ball_radius(parts["hinge"], block)
    wrong += [f"{a} and {b} come apart" for a, b in _loose(parts, block)]
    play = 0.0
    for socket in _sockets(parts, block):
        play = max(play, play_mm(socket, radius)) if np.isfinite(play) else play
    if not np.isfinite(play):
        wrong.append("a ball leaves its socket")
    snap = _overlap(_ways(parts, block))
    if block.snap_mm <= 0 and snap > _VOLUME:
        wrong.append(f"a bar meets the sides of a slot, by {snap:.3g} mm^3")
    return BlockReport(
        not wrong, wrong[0] if wrong else "printable", len(poses), overlap, gap, play, snap
    )


def _faults(name: str, parts: Mapping[str, Any], block: Block) -> Iterator[str]:
    """What is wrong with a part on its own."""
    solid, a = parts[name], block.pitch_mm
    mesh = part_of(solid)
    edges = np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, uses = np.unique(edges, axis=0, return_counts=True)
    if solid.is_empty() or (uses != 2).any():
        yield "its surface is not closed"
        return
    if len(solid.decompose()) != 1:
        yield f"it is in {len(solid.decompose())} pieces"
    elif solid.genus() != 0:
        yield f"it has {solid.genus()} handles"
    reach = block.radius_mm + 1e-6
    box = np.array(solid.bounding_box())
    length = 0 if name == "end" else a
    if (box[:3] < -reach).any() or (box[3:] > np.array([length, 0, 0]) + reach).any():
        yield "it leaves its own voxels, less half the gap"


def _middle(parts: Mapping[str, Any]) -> list[Any]:
    """What is between two hinges; its last body has the last socket."""
    return [parts[name] for name in ("middle", "sleeve", "pin") if name in parts]


def _poses(parts: Mapping[str, Any], block: Block) -> Iterator[list[Pair]]:
    """What might meet of a capsule, a hinge and a capsule, in every state of the two joints.

    What a hinge might meet in the socket it is in is for `_joints`. Where capsules swivel, then
    also with the last half of the first one turned, and what follows with it.
    """
    a = block.pitch_mm
    before = _middle(parts)
    for first, second in product(STATES, repeat=2):
        after = [_bent(body, second, 90).translate([a, 0, 0]) for body in before]
        moved = [_bent(body, first, 90).translate([a, 0, 0]) for body in [parts["hinge"], *after]]
        hinge, *after = moved
        far = [*product(before[:-1], [hinge]), *product([hinge], after[1:])]
        yield [*product(before, after), *far]
        if block.swivel and second == (0, 0):
            sleeve, pin = before
            for twist in _TWISTS_DEG:
                yield [(sleeve, body.rotate([twist, 0, 0])) for body in [pin, *moved]]


def _joints(parts: Mapping[str, Any], block: Block) -> Iterator[Pair]:
    """Every socket and a hinge in it, in every state of the joint."""
    for socket, state in product(_sockets(parts, block), STATES):
        yield socket, _bent(parts["hinge"], state, 90)


def _ways(parts: Mapping[str, Any], block: Block) -> Iterator[Pair]:
    """A socket and a hinge on its way along a slot, from straight to bent all the way."""
    socket = _middle(parts)[-1].translate([-block.pitch_mm, 0, 0])
    for deg in np.linspace(0, block.bend_deg, _STEPS + 1).tolist():
        for state in STATES[1:]:
            yield socket, _bent(parts["hinge"], state, deg)


def _loose(parts: Mapping[str, Any], block: Block) -> Iterator[tuple[str, str]]:
    """Halves of a capsule that do not hold each other, or do not fit.

    A pin is held if wherever it is shifted to, by more than its play, it meets the sleeve; a groove
    if that is so but along y, the way it slides in.
    """
    directions = np.array(list(product((-1, 0, 1), repeat=3)))
    plays = (block.clearance_mm, join_clearance_mm(block))
    for (inner, outer, free), play in zip(_HALVES, plays, strict=True):
        if inner not in parts or outer not in parts:
            continue
        ways = [d for d in directions if (d if free is None else np.delete(d, free)).any()]
        shift = 2 * play + 0.1  # a flank at 30 degrees is met after twice its clearance
        across = [way if free is None else np.delete(way, free) for way in ways]
        moved = [shift * w / np.linalg.norm(a) for w, a in zip(ways, across, strict=True)]
        holds = all(_overlap([(parts[inner].translate(m), parts[outer])]) > _VOLUME for m in moved)
        if not holds or _overlap([(parts[inner], parts[outer])]) > _VOLUME:
            yield inner, outer


def _bent(solid: Any, state: tuple[int, int], deg: float) -> Any:
    """A solid turned by a bend of so many degrees; `state` tells in which slot."""
    return solid.rotate([0, -deg * state[0], deg * state[1]])


def _overlap(pairs: Iterable[Pair]) -> float:
    return max(float((a ^ b).volume()) for a, b in pairs)


def _gap(pairs: Iterable[Pair], reach: float) -> float:
    return min(float(a.min_gap(b, reach)) for a, b in pairs)


def _sockets(parts: Mapping[str, Any], block: Block) -> Iterator[Any]:
    """Every socket, moved so that it is at 0 and open towards +x, with the part it is in."""
    for name in ("end", "middle", "pin", "groove"):
        if name in parts:
            at = 0.0 if name == "end" else block.pitch_mm
            yield parts[name].translate([-at, 0, 0])
    for name in ("middle", "sleeve", "tongue"):
        if name in parts:
            yield parts[name].rotate([0, 0, 180])


def ball_radius(hinge: Any, block: Block) -> float:
    """Radius of the smaller of the two balls that fit into a hinge about its ends."""
    centres = np.array([(0.0, 0, 0), (block.pitch_mm, 0, 0)])
    return float(_distances(hinge, centres).min())


def play_mm(socket: Any, radius_mm: float) -> float:
    """How far the centre of a ball can come from that of the socket at 0, infinite if it gets out.

    Positions of the centre are tried on a grid. One counts as free if it is a ball's radius, less
    half the diagonal of a cell, from the surface of the socket; so whatever way there is, there is
    one on the grid, and what is reached is not underestimated. The hinge's bar would only be in
    the way, so its direction does not matter.
    """
    plays = (_play_on_grid(socket, radius_mm, tries) for tries in _TRIES)
    return next((play for play in plays if np.isfinite(play)), float("inf"))


def _play_on_grid(socket: Any, radius_mm: float, tries: int) -> float:
    half = radius_mm / 2
    ticks = np.linspace(-half, half, 2 * tries + 1)
    slack = np.sqrt(3) / 2 * half / tries
    seen = np.zeros((2 * tries + 1,) * 3, bool)
    fresh = seen.copy()
    fresh[tries, tries, tries] = True
    play = 0.0
    while fresh.any():
        seen |= fresh
        cells = np.argwhere(fresh)
        free = cells[_distances(socket, ticks[cells]) >= radius_mm - slack]
        if len(free) and (free.min() == 0 or free.max() == 2 * tries):
            return float("inf")
        play = max(play, np.linalg.norm(ticks[free], axis=1).max(initial=-slack) + slack)
        fresh[:] = False
        fresh[tuple(free.T)] = True
        fresh = ndimage.binary_dilation(fresh, np.ones((3, 3, 3), bool)) & ~seen
    return float(play)


def _distances(solid: Any, points: FloatArray) -> FloatArray:
    """Distances of (n, 3) points from the surface of a solid."""
    mesh = part_of(solid)
    squared = igl.point_mesh_squared_distance(points, mesh.vertices, mesh.faces.astype(np.int64))[0]
    distances: FloatArray = np.sqrt(squared)
    return distances
