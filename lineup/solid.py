"""The records every stage hands to the next: solid, path, motion, folding, certificate, design."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd

from . import grid
from ._record import of_kind, record


@record
class VoxelSolid:
    """A void-free solid as a set of unit voxels (Section 3); axis 2 is up.

    Attributes
    ----------
    occupancy : (X, Y, Z) bool
        ``occupancy[:, :, z]`` is layer z.
    pitch : float
        Edge length of a voxel in the units of the source mesh.
    name : str
    source : dict
        Where the solid came from and what was changed on the way, as plain JSON values.

    Raises
    ------
    ValueError
        If the grid is not a 3D bool array with at least one voxel, if its voxels do not form
        one face-connected component, or if they enclose a void. `mend` repairs the last two.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> lu.VoxelSolid(np.ones((4, 3, 2), bool)).size
    24
    """

    occupancy: grid.BoolArray
    pitch: float = 1.0
    name: str = ""
    source: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        occupancy = check_occupancy(self.occupancy)
        if not (np.isfinite(self.pitch) and self.pitch > 0):
            raise ValueError(f"pitch must be a positive number, got {self.pitch}")
        _, n = grid.components(occupancy)
        if n > 1:
            raise ValueError(
                f"the solid has {n} face-connected components, not one; "
                "lineup.mend keeps the largest and reports what it dropped"
            )
        n_void = int(grid.voids(occupancy).sum())
        if n_void:
            raise ValueError(
                f"the solid encloses {n_void} empty voxels, and the method needs a void-free "
                "solid; lineup.mend fills them and reports it"
            )
        object.__setattr__(self, "source", dict(self.source))

    @property
    def size(self) -> int:
        """Number of voxels, n in the paper."""
        return int(self.occupancy.sum())


def check_occupancy(occupancy: object) -> grid.BoolArray:
    """`occupancy` itself, if it is a non-empty 3D bool array; a ValueError otherwise."""
    if not isinstance(occupancy, np.ndarray) or occupancy.dtype != bool or occupancy.ndim != 3:
        got = (
            f"{occupancy.dtype} of shape {occupancy.shape}"
            if isinstance(occupancy, np.ndarray)
            else type(occupancy).__name__
        )
        raise ValueError(f"occupancy must be a bool array of shape (X, Y, Z), got {got}")
    if not occupancy.any():
        raise ValueError(f"occupancy of shape {occupancy.shape} has no voxel set")
    return occupancy


@record
class VoxelPath:
    """A simple path of face-adjacent voxels (Section 4).

    Attributes
    ----------
    voxels : (P, 3) int32
    visits : (V, 4) int32
        The layer visits of a layered path in order, empty where the path is not layered. A row
        is (start, stop, piece, depth): steps start..stop-1 lie in that planar piece, and depth
        counts the pieces whose visits enclose this one (0 on the MSP, 1 or more in nested MSCs).
        A strictly layered path has one piece in each node of the Reeb graph, of the node's
        number.
    dropped : (D, 3) int32
        The voxels of the solid that the path leaves out, in lexicographic order.
    refinement : int
        The path lives on the solid refined this many times along each axis.
    method : str
    """

    voxels: grid.IntArray
    visits: grid.IntArray = field(default_factory=lambda: np.empty((0, 4), np.int32))
    dropped: grid.IntArray = field(default_factory=lambda: np.empty((0, 3), np.int32))
    refinement: int = 1
    method: str = ""

    def __post_init__(self) -> None:
        for name, width in (("voxels", 3), ("visits", 4), ("dropped", 3)):
            object.__setattr__(self, name, _int_rows(getattr(self, name), name, width))

    def __len__(self) -> int:
        return len(self.voxels)

    def coverage(self, solid: VoxelSolid) -> float:
        """Share of the solid's voxels that the path visits."""
        return len(self) / (solid.size * self.refinement**3)


@record
class Motion:
    """A motion of the chain, stored as moves of its joints (Sections 6 and 7).

    Attributes
    ----------
    start : (P, 3) int32
        Lattice positions of the joints before the first move; bar k joins joints k and k + 1.
    moves : (M, 4) int32
        Rows (kind, joint, other, value), see `kinematics.Move`.
    diameter : float
        Diameter of the bars, in voxel units, that the planner worked for.
    max_bend_deg : float
        Largest bend between consecutive bars that the planner worked for.
    straight : bool
        Whether the planner says that the last pose is a straight line.
    reason : str
        Why the planner stopped: "straight", or what is in the way.
    poses : (K, P - 1) int8
        Bar directions that the TILT moves lead to.
    angles : (K, P - 1) int32
        Bar angles that the BEND moves pass through, in units of `kinematics.TICK`.
    goal : (P, 3) int32
        The pose that the motion claims to end in, as it is or turned as a whole; empty where it
        claims none. A motion without a goal is one to or from a straight line.
    """

    start: grid.IntArray
    moves: grid.IntArray
    diameter: float
    max_bend_deg: float
    straight: bool
    reason: str
    poses: np.ndarray[Any, np.dtype[np.int8]] = field(
        default_factory=lambda: np.empty((0, 0), np.int8)
    )
    angles: grid.IntArray = field(default_factory=lambda: np.empty((0, 0), np.int32))
    goal: grid.IntArray = field(default_factory=lambda: np.empty((0, 3), np.int32))

    def __post_init__(self) -> None:
        for name, width in (("start", 3), ("moves", 4), ("goal", 3)):
            object.__setattr__(self, name, _int_rows(getattr(self, name), name, width))
        object.__setattr__(self, "poses", np.asarray(self.poses, np.int8))
        object.__setattr__(self, "angles", np.asarray(self.angles, np.int32))

    def __len__(self) -> int:
        return len(self.moves)


@record
class Obstacles:
    """Unit voxels that a chain has to keep out of, beside it in the frame of its motion.

    Attributes
    ----------
    occupancy : (X, Y, Z) bool
        No obstacle lies beyond the grid.
    origin : (3,) int32
        Position of ``occupancy[0, 0, 0]``.

    Raises
    ------
    ValueError
        If the grid is not a 3D bool array with a voxel set, or the origin not three integers.
    """

    occupancy: grid.BoolArray
    origin: grid.IntArray = field(default_factory=lambda: np.zeros(3, np.int32))

    def __post_init__(self) -> None:
        check_occupancy(self.occupancy)
        if np.shape(self.origin) != (3,):
            raise ValueError(f"origin must be three integers, got shape {np.shape(self.origin)}")
        origin = _int_rows(np.asarray(self.origin)[None], "origin", 3)[0]
        object.__setattr__(self, "origin", origin)

    def holds(self, positions: np.ndarray[Any, Any]) -> grid.BoolArray:
        """Which of (n, 3) integer positions are obstacles, (n,) bool."""
        cell = np.asarray(positions) - self.origin
        inside = ((cell >= 0) & (cell < self.occupancy.shape)).all(axis=1)
        held = np.zeros(len(cell), bool)
        held[inside] = self.occupancy[tuple(cell[inside].T)]
        return held


@record
class Folding:
    """A path and a motion that unfolds exactly this path: ``motion.start == path.voxels``."""

    path: VoxelPath
    motion: Motion

    def __post_init__(self) -> None:
        of_kind(self.path, VoxelPath)
        of_kind(self.motion, Motion)
        if not np.array_equal(self.path.voxels, self.motion.start):
            raise ValueError("the motion does not start at the path")


@dataclass(frozen=True)
class Certificate:
    """The judge's verdict on a path or a motion.

    Attributes
    ----------
    ok : bool
    reason : str
        "certified", or what is wrong.
    where : int
        Step of the path or index of the move that fails, -1 if none.
    diameter, max_bend_deg : float
        The values judged against (voxel units, degrees); nan for a path.
    clearance : float
        A distance that no two bars two or more apart come nearer than, as proved; nan for a path.
    bend_deg : float
        Largest bend between consecutive bars anywhere in the motion; nan for a path.
    moves_checked : int
    nearest : (int, int, int)
        The move and two bars that come as near as `clearance` in it; move -1 is the start. All
        -1 if there are no bars two apart, the bars -1 where only a lemma tells of them.
    most_bent : (int, int)
        The move and a joint that bends by `bend_deg` in it; move -1 is the start. Both -1 if no
        joint ever bends.
    extent : (float, float, float)
        Sides, in voxel units and along the motion's own axes, of the smallest box that holds all
        blocks over the whole motion, the blocks unturned: that of the bars' centre lines, and 1
        more. Up to rounding it is exact, but where there are BENDs it is up to 2e-3 too long;
        nan for a path.
    violations : int
        Moves that slotted joints do not let the chain make; 0 where they were not asked about.
    """

    ok: bool
    reason: str
    where: int = -1
    diameter: float = float("nan")
    clearance: float = float("nan")
    max_bend_deg: float = float("nan")
    bend_deg: float = float("nan")
    moves_checked: int = 0
    nearest: tuple[int, int, int] = (-1, -1, -1)
    most_bent: tuple[int, int] = (-1, -1)
    extent: tuple[float, float, float] = (float("nan"), float("nan"), float("nan"))
    violations: int = 0


@dataclass(frozen=True, eq=False)
class Design:
    """Result of Algorithm 1: solids whose foldings are poses of the same chain.

    Attributes
    ----------
    models : tuple of VoxelSolid
    foldings : tuple of Folding
        All of one length, twice the number of blocks.
    certificates : tuple of Certificate
        The judge's verdict on each motion.
    table : DataFrame
        One row for each model asked for; one that failed has its reason in ``failure``, and is in
        no other part.
    """

    models: tuple[VoxelSolid, ...]
    foldings: tuple[Folding, ...]
    certificates: tuple[Certificate, ...]
    table: pd.DataFrame


def _int_rows(value: Any, name: str, width: int) -> grid.IntArray:
    array = np.asarray(value)
    if array.ndim != 2 or array.shape[1] != width or not np.issubdtype(array.dtype, np.integer):
        raise ValueError(
            f"{name} must be an integer array of shape (n, {width}), "
            f"got {array.dtype} of shape {array.shape}"
        )
    bounds = np.iinfo(np.int32)
    if array.size and not bounds.min <= array.min() <= array.max() <= bounds.max:
        raise ValueError(
            f"{name} must be from {bounds.min} to {bounds.max}, got {array.min()} to {array.max()}"
        )
    return array.astype(np.int32)
