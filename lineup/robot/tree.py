"""The chain as a tree of bodies that grows both ways from the piece that is clamped.

Every body's frame has the chain's axes when all angles are 0. Hinge i and what follows lie towards
+x of the base if i is at least the base's number, towards -x if less; a body's origin is the ball
that joins it to its parent. Towards -x the axes of the joints are reversed, so that an angle means
the same on both sides.
"""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from ..grid import FloatArray
from .angles import AXES, Y1, Y2, Z1, Z2, X


class Placed(NamedTuple):
    """A chain in a pose, one piece of it clamped."""

    name: str
    base: int
    origin: FloatArray  # (3,) of the base, in pitches
    frame: FloatArray  # (3, 3) of the base
    angles_deg: FloatArray  # (n, 5)

    @property
    def n_blocks(self) -> int:
        return len(self.angles_deg)


class Joint(NamedTuple):
    """One of the five of a block."""

    block: int
    axis: int  # column of angles
    sign: int  # -1 where it turns the parent's side against the body

    @property
    def name(self) -> str:
        """What files call it."""
        return joint_name(self.block, self.axis)

    @property
    def letter(self) -> str:
        """x, y or z."""
        return AXES[self.axis][0]


class Body(NamedTuple):
    """A hinge, or a piece; from its origin it extends towards `side` along x."""

    name: str
    kind: str  # "hinge", "capsule" or "end"
    at: int  # pitches from the parent's origin
    side: int  # +1 or -1
    joints: tuple[Joint, ...]  # from the parent on


def joint_name(block: int, axis: int) -> str:
    """What files call a joint."""
    return f"b{block}_{AXES[axis]}"


def checked_base(base: int | None, n_blocks: int) -> int:
    """The piece to clamp; the middle one unless told otherwise."""
    if base is None:
        return (n_blocks + 1) // 2
    if not 0 <= base <= n_blocks:
        raise ValueError(f"base must be a piece from 0 to {n_blocks}, got {base}")
    return base


def base_body(n_blocks: int, base: int) -> Body:
    """The body that is clamped."""
    kind = "capsule" if 0 < base < n_blocks else "end"
    return Body(f"piece{base}", kind, 0, 1 if base == n_blocks else -1, ())


def base_joint(n_blocks: int, base: int) -> int:
    """The joint of the chain at which the base has its origin."""
    return min(2 * base, 2 * n_blocks - 1)


def outward(n_blocks: int, base: int) -> tuple[list[Body], list[Body]]:
    """The bodies towards +x and towards -x of the base, each the parent of the next."""
    return list(_ahead(n_blocks, base)), list(_behind(n_blocks, base))


def _ahead(n: int, base: int) -> Iterator[Body]:
    for i in range(base, n):
        near, far = (Y1, Z1), (X, Z2, Y2)
        yield Body(f"hinge{i}", "hinge", int(i > base), 1, _joints(i, near, 1))
        kind = "end" if i == n - 1 else "capsule"
        yield Body(f"piece{i + 1}", kind, 1, 1, _joints(i, far, 1))


def _behind(n: int, base: int) -> Iterator[Body]:
    for i in range(base - 1, -1, -1):
        near, far = (Y2, Z2), (X, Z1, Y1)
        yield Body(f"hinge{i}", "hinge", 0 if i == n - 1 else -1, -1, _joints(i, near, -1))
        kind = "end" if i == 0 else "capsule"
        yield Body(f"piece{i}", kind, -1, -1, _joints(i, far, -1))


def _joints(block: int, axes: tuple[int, ...], sign: int) -> tuple[Joint, ...]:
    return tuple(Joint(block, axis, sign) for axis in axes)


def number(value: float) -> str:
    """A number as files have it."""
    return f"{value:.12g}"


def row(values: Iterable[float]) -> str:
    """Numbers in a row."""
    return " ".join(map(number, values))
