"""The measures of a block, and what they may be (Figures 2 and 16).

A block is two voxels: two capsules of the chain reach into it, w1 and w2, and a hinge joins them.
Everything is in millimetres; a voxel is a cube of edge `pitch_mm`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from typing import Any

WALL_MM = 0.8
"""Least thickness of a wall, a lip or a rod that is printed."""

RETAINED, RETAINED_MM = 0.03, 0.1
"""By how much a ball must be too large for where slots cross: of its diameter, and beyond that."""


@dataclass(frozen=True)
class Block:
    """The measures of a printable building block (Section 3, Figures 2 and 16).

    Attributes
    ----------
    pitch_mm : float
        Edge of a voxel: what two neighbouring balls, or sockets, are apart.
    gap_mm : float
        Between neighbouring capsules; their diameter is the pitch less the gap.
    ball_mm : float
        Diameter of the two balls of a hinge.
    bar_mm : float
        Diameter of the bar between them.
    clearance_mm : float
        All round between what moves: ball and cavity, bar and hole.
    snap_mm : float
        By how much each side of a slot's neck reaches into the way of the bar (Figure 16); below
        0 it leaves room, and nothing snaps.
    bend_deg : float
        Where the four slots end, from the pole on: the largest bend of a joint.
    swivel : bool
        Whether the capsules are in two halves that turn about their axis, each with its slots.
    segments : int
        Sides of what is round; a multiple of 4.

    Raises
    ------
    ValueError
        If a measure is out of its range, which depends on those before it.

    Examples
    --------
    >>> Block().diameter, Block(ball_mm=5.2).cavity_mm
    (0.97, 5.7)
    """

    pitch_mm: float = 10.0
    gap_mm: float = 0.3
    ball_mm: float = 5.0
    bar_mm: float = 2.6
    clearance_mm: float = 0.25
    snap_mm: float = 0.1
    bend_deg: float = 90.0
    swivel: bool = False
    segments: int = 32

    def __post_init__(self) -> None:
        for name, low, high, remedy in _ranges(self):
            value = getattr(self, name)
            if not (math.isfinite(value) and low - 1e-9 <= value <= high + 1e-9):
                unit = name.rpartition("_")[2] if "_" in name else "sides"
                raise ValueError(
                    f"{name} must be from {low:.4g} to {high:.4g} {unit} here, "
                    f"got {value:g}; {remedy}"
                )
        if self.segments % 4:
            raise ValueError(f"segments must be a multiple of 4, got {self.segments}")

    @property
    def radius_mm(self) -> float:
        """Radius R of the capsules."""
        return (self.pitch_mm - self.gap_mm) / 2

    @property
    def diameter(self) -> float:
        """Diameter of the capsules in voxel units, to be compared with that of a certificate."""
        return 1 - self.gap_mm / self.pitch_mm

    @property
    def cavity_mm(self) -> float:
        """Diameter of the cavity that a ball sits in."""
        return self.ball_mm + 2 * self.clearance_mm

    @property
    def hole_mm(self) -> float:
        """Width of a slot at its two ends, where the bar rests."""
        return self.bar_mm + 2 * self.clearance_mm

    @property
    def neck_mm(self) -> float:
        """Width of a slot at its narrowest, at a bend of 45 degrees."""
        return self.bar_mm - 2 * self.snap_mm


def _ranges(b: Block) -> Iterator[tuple[str, float, float, str]]:
    """(name, least, most, what would do) of each measure, given that those before it are good."""
    yield "pitch_mm", 5.0, 200.0, "print larger voxels, or smaller ones"
    yield "segments", 24, 256, "take 32 for a draft, 64 for smooth rounds"
    yield "clearance_mm", 0.05, b.pitch_mm / 20, "print the coupon to find what your printer needs"
    yield "bend_deg", 90.0, 120.0, "90 is a lattice bend, 120 what pulling a path with Us asks"
    # A capsule that starts beside another, a pitch away at the largest bend, must keep clear of it.
    least = max(b.clearance_mm, b.pitch_mm * (1 - math.sin(math.radians(b.bend_deg))))
    yield (
        "gap_mm",
        least,
        b.pitch_mm / 4,
        "capsules need clearance, and more of it the further they bend",
    )
    yield from _ranges_within(b)


def _ranges_within(b: Block) -> Iterator[tuple[str, float, float, str]]:
    """Of what goes into a capsule, whose size and clearance are good."""
    largest = 2 * (b.radius_mm - WALL_MM - b.clearance_mm)
    widest = ((1 - RETAINED) * largest - RETAINED_MM) / math.sqrt(2)
    yield (
        "bar_mm",
        WALL_MM,
        widest - 2 * b.clearance_mm,
        "a thicker bar leaves no ball that slots retain, a larger pitch_mm does",
    )
    yield (
        "snap_mm",
        -b.clearance_mm,
        b.bar_mm / 6,
        "a neck narrower than two thirds of the bar is not passed unbroken",
    )
    yield (
        "ball_mm",
        _least_ball_mm(b.hole_mm),
        largest,
        "a smaller ball slips out where slots cross, a larger one breaks through its shell",
    )
    if b.swivel:
        room, need = swivel_room_mm(b)
        yield (
            "pitch_mm",
            b.pitch_mm + need - room,
            200.0,
            "a swivel needs more room between two sockets; make pitch_mm larger or ball_mm smaller",
        )


def _least_ball_mm(hole_mm: float) -> float:
    """The smallest ball that is held where two slots cross, whose corners are a diagonal apart."""
    return (math.sqrt(2) * hole_mm + RETAINED_MM) / (1 - RETAINED)


def socket_depth_mm(block: Block, radius_mm: float) -> float:
    """How far behind its centre a socket takes away material, anywhere up to this radius."""
    bend = math.radians(block.bend_deg)
    slot = (block.hole_mm / 2 - radius_mm * math.cos(bend)) / math.sin(bend)
    return max(block.cavity_mm / 2, slot)


@dataclass(frozen=True)
class Swivel:
    """A swivel along its axis, from the centre of the first socket: a sleeve holds a pin.

    The head of the pin turns in a chamber of the sleeve, its neck in the sleeve's lip.
    """

    neck_radius: float
    head_radius: float
    chamber: float  # where the chamber starts
    lip: float  # where the chamber ends and the lip starts
    face: float  # where the sleeve ends
    pin_face: float  # where the body of the pin starts


def swivel(block: Block) -> Swivel:
    """The swivel of a block, as near to its first socket as walls of `WALL_MM` let it be."""
    c = block.clearance_mm
    neck = block.bar_mm / 2
    head = neck + c + WALL_MM
    chamber = socket_depth_mm(block, head + c) + WALL_MM
    lip = chamber + WALL_MM + 2 * c
    face = lip + WALL_MM
    return Swivel(neck, head, chamber, lip, face, face + c)


def swivel_room_mm(block: Block) -> tuple[float, float]:
    """What is left for the second socket behind a swivel, and what it needs."""
    need = max(block.cavity_mm / 2 + WALL_MM, socket_depth_mm(block, block.radius_mm))
    return block.pitch_mm - swivel(block).pin_face, need


def scaled(block: Block, pitch_mm: float) -> Block:
    """The block at another pitch.

    All lengths grow with the pitch but the clearance, which is the printer's, and a negative snap,
    which is clearance. The gap is no less than the clearance, a ball no smaller than slots hold.

    Raises
    ------
    ValueError
        If that is no good block: where the clearance is too large for the pitch.

    Examples
    --------
    >>> scaled(Block(), 20.0).bar_mm, scaled(Block(), 20.0).clearance_mm
    (5.2, 0.25)
    """
    share = pitch_mm / block.pitch_mm
    if not (math.isfinite(pitch_mm) and pitch_mm > 0):
        raise ValueError(f"pitch_mm must be a positive number, got {pitch_mm}")
    grown = {
        f.name: round(getattr(block, f.name) * share, 9)
        for f in fields(block)
        if f.name in ("gap_mm", "ball_mm", "bar_mm")
    }
    grown["gap_mm"] = max(grown["gap_mm"], block.clearance_mm)
    held = _least_ball_mm(grown["bar_mm"] + 2 * block.clearance_mm)
    grown["ball_mm"] = max(grown["ball_mm"], math.ceil(1000 * held) / 1000)
    snap = block.snap_mm * share if block.snap_mm > 0 else block.snap_mm
    return replace(block, pitch_mm=pitch_mm, snap_mm=round(snap, 9), **grown)


BLOCKS = {
    "standard": Block(),
    "pull": Block(gap_mm=0.9, snap_mm=-0.25, swivel=True),
    "pull120": Block(
        gap_mm=1.4, ball_mm=4.2, bar_mm=2.0, snap_mm=-0.25, bend_deg=120.0, swivel=True
    ),
}
"""The paper's block; one thin and free enough to be pulled along a path without Us; and along any.

A swivel lets the slots of each end turn with the bend, so that a joint bends in any plane. The
slots of the paper's block make the bends (y, z) a cross: it has the clearance of a pull but not its
bends.
"""


def named_block(name: str, pitch_mm: float = 10.0, **measures: float) -> Block:
    """One of `BLOCKS` at a pitch, with some of its measures changed.

    Raises
    ------
    ValueError
        If there is no such block, or it is none with these measures.

    Examples
    --------
    >>> named_block("pull", 20.0, clearance_mm=0.2).snap_mm
    -0.2
    """
    if name not in BLOCKS:
        raise ValueError(f"unknown block {name!r}; known: {sorted(BLOCKS)}")
    block = scaled(BLOCKS[name], pitch_mm)
    changed: dict[str, Any] = dict(measures)
    if block.snap_mm < 0 and "clearance_mm" in changed:  # slots as wide as the holes at their ends
        changed.setdefault("snap_mm", -changed["clearance_mm"])
    return replace(block, **changed)
