"""Where the voxels of a folded chain touch, and what holds them together there (Section 7)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._record import record
from ..grid import DIRECTIONS, BoolArray, FloatArray, IntArray, bar_directions

KINDS = ("printed", "hinge", "velcro", "touch", "table", "held")
"""What a face is: inside a printed piece, at a hinge, between two strands with velcro or without,
or at the support."""

PRINTED, HINGE, VELCRO, TOUCH, TABLE, HELD = range(6)

AT_SUPPORT = 2.0
"""Stiffness at a support: only half a voxel of resin lies between it and the centre."""


_COLUMNS = ("kind", "first", "second", "direction", "share")


@dataclass(frozen=True)
class Bonding:
    """How stiff faces are, as shares of the stiffness of solid resin there; not how strong.

    A share is for pulling, shearing, bending and twisting alike. Solid resin has E / a for each
    area against pulling and G / a against shearing, a being the pitch.

    Attributes
    ----------
    printed : float
        Bars 2i + 1, each printed as one piece. 1, that of a voxel of solid resin.
    hinge : float
        Bars 2i. By default 0.05: of a pitch of 10 mm, a round bar of 2.6 mm has 5.3 % of the area.
    velcro : float
        Faces between voxels that are no neighbours on the path; 0 leaves them open. By default
        0.01, an estimate: 1 mm of fabric and glue with a thousandth of the resin's modulus.
    pulls : bool
        Whether these faces hold against being pulled apart and along, as velcro does. If not, two
        strands that touch only push each other, without friction.

    Raises
    ------
    ValueError
        If `printed` or `hinge` is not positive, `velcro` negative, or one is not finite.

    Examples
    --------
    >>> Bonding(velcro=0).hinge
    0.05
    """

    printed: float = 1.0
    hinge: float = 0.05
    velcro: float = 0.01
    pulls: bool = True

    def __post_init__(self) -> None:
        good = 0 < self.printed < np.inf and 0 < self.hinge < np.inf and 0 <= self.velcro < np.inf
        if not good:
            raise ValueError(
                "printed and hinge must be positive and velcro 0 or more, "
                f"got {self.printed}, {self.hinge} and {self.velcro}"
            )


BONDINGS = {
    "velcro": Bonding(),
    "none": Bonding(pulls=False),
    "chain": Bonding(velcro=0.0),
    "solid": Bonding(1.0, 1.0, 1.0),
}
"""By name: the default; without velcro, where strands only push each other; the chain alone, where
they do not even that; and one lump of resin."""


def bonding_of(bonding: Bonding | str) -> Bonding:
    """A bonding as given or by its name; a ValueError if there is none of that name."""
    if isinstance(bonding, Bonding):
        return bonding
    if bonding not in BONDINGS:
        raise ValueError(f"unknown bonding {bonding!r}; known: {sorted(BONDINGS)}, or a Bonding")
    return BONDINGS[bonding]


def name_of(bonding: Bonding | str) -> str:
    """Its name, or its shares where it has none."""
    if isinstance(bonding, str):
        return bonding
    named = [name for name, known in BONDINGS.items() if known == bonding]
    shares = f"{bonding.printed:g}/{bonding.hinge:g}/{bonding.velcro:g}"
    return named[0] if named else shares + ("" if bonding.pulls else " pushing")


@record
class Faces:
    """The faces that bear load, square to an axis and of area 1, in voxel units.

    Attributes
    ----------
    kind : (F,) int32
        Index into `KINDS`.
    first, second : (F,) int32
        The voxels on the two sides, the one that comes first on the path first; `second` is -1
        at a support.
    direction : (F,) int32
        Row of `grid.DIRECTIONS` from `first` to `second`.
    share : (F,) float64
        Stiffness as a share of that of solid resin.
    """

    kind: IntArray
    first: IntArray
    second: IntArray
    direction: IntArray
    share: FloatArray

    def __len__(self) -> int:
        return len(self.kind)

    @property
    def normal(self) -> FloatArray:
        """(F, 3) unit vectors from `first` to `second`."""
        normal: FloatArray = DIRECTIONS[self.direction].astype(np.float64)
        return normal


def checked_chain(voxels: NDArray[np.integer]) -> IntArray:
    """The voxels of a simple lattice path as (n, 3) int32.

    Raises
    ------
    ValueError
        If there are fewer than two, one comes twice, or two neighbours share no face.
    """
    if len(voxels) < 2:
        raise ValueError(f"a chain has 2 or more voxels, got {len(voxels)}")
    bar_directions(voxels)
    if len(np.unique(voxels, axis=0)) != len(voxels):
        raise ValueError("the path visits a voxel twice; lineup.certify_path says where")
    return voxels.astype(np.int32)


def inner_faces(voxels: IntArray, bonding: Bonding, odd: bool = False) -> Faces:
    """The faces between the voxels of a chain that bear load, sorted by their two voxels.

    Those between strands are of the kind "touch" where they do not pull.

    Parameters
    ----------
    voxels : (n, 3) int32
        Of a simple lattice path.
    odd : bool
        Whether the first voxel is the second one of a block, so that bar 0 is a printed piece.
    """
    first, second, direction = _touching(voxels)
    along = second - first == 1
    hinge = (first % 2 == 1) if odd else (first % 2 == 0)
    kind = np.where(along, np.where(hinge, HINGE, PRINTED), VELCRO if bonding.pulls else TOUCH)
    share = np.array([bonding.printed, bonding.hinge, bonding.velcro, bonding.velcro])[kind]
    kept = share > 0
    kind = kind.astype(np.int32)
    return Faces(kind[kept], first[kept], second[kept], direction[kept], share[kept])


def outer_faces(voxels: IntArray, side: str) -> Faces:
    """The faces of the outermost layer on a side, held by a rigid wall.

    Raises
    ------
    ValueError
        If `side` is not "+x" ... "-z".
    """
    direction = direction_of(side)
    out = voxels @ DIRECTIONS[direction]
    first = np.flatnonzero(out == out.max()).astype(np.int32)
    n = len(first)
    same = [np.full(n, value, np.int32) for value in (HELD, -1, direction)]
    return Faces(same[0], first, same[1], same[2], np.full(n, AT_SUPPORT))


def direction_of(side: str) -> int:
    """Row of `grid.DIRECTIONS` of "+x" ... "-z"; a ValueError for anything else."""
    sides = ["+x", "+y", "+z", "-x", "-y", "-z"]
    if side not in sides:
        raise ValueError(f"a side must be one of {sides}, got {side!r}")
    return sides.index(side)


def chosen(faces: Faces, which: BoolArray) -> Faces:
    """Some of the faces."""
    return Faces(*(getattr(faces, name)[which] for name in _COLUMNS))


def joined(*parts: Faces) -> Faces:
    """Several sets of faces as one, in the order given."""
    return Faces(*(np.concatenate([getattr(part, name) for part in parts]) for name in _COLUMNS))


def _touching(voxels: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Pairs of voxels that share a face and the direction from the first to the second."""
    corner = voxels.min(axis=0).astype(np.int64) - 1
    size = voxels.max(axis=0).astype(np.int64) - corner + 2
    key = _keys(voxels.astype(np.int64) - corner, size)
    order = np.argsort(key)
    rows = []
    for d, step in enumerate(DIRECTIONS):
        sought = key + _keys(step.astype(np.int64), size)
        at = np.searchsorted(key, sought, sorter=order).clip(max=len(key) - 1)
        found = np.flatnonzero((key[order[at]] == sought) & (order[at] > np.arange(len(key))))
        rows.append(np.stack([found, order[at[found]], np.full(len(found), d)], axis=1))
    pairs = np.concatenate(rows)
    pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))].astype(np.int32)
    return pairs[:, 0], pairs[:, 1], pairs[:, 2]


def _keys(cells: NDArray[np.int64], size: NDArray[np.int64]) -> NDArray[np.int64]:
    keys: NDArray[np.int64] = (cells[..., 0] * size[1] + cells[..., 1]) * size[2] + cells[..., 2]
    return keys
