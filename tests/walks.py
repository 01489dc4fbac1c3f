"""Random simple lattice paths for property tests: wandering, crumpled, stretched, coiled, led."""

from collections import deque
from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st
from numpy.typing import NDArray
from polycubes import STEPS, polycubes

import lineup as lu

Voxel = tuple[int, int, int]


def beside(voxel: Voxel) -> list[Voxel]:
    """The six voxels that share a face with one."""
    x, y, z = voxel
    return [(x + dx, y + dy, z + dz) for dx, dy, dz in STEPS]


def closes_a_u(voxels: list[Voxel], step: Voxel) -> bool:
    """Whether going on to `step` puts three bars in a row on one unit square."""
    return len(voxels) > 2 and step in beside(voxels[-3])


def _wander(voxels: list[Voxel], free: list[Voxel]) -> list[Voxel]:
    return free


def _stretch(voxels: list[Voxel], free: list[Voxel]) -> list[Voxel]:
    """On in the same direction first."""
    before, here = voxels[-2:] if len(voxels) > 1 else (voxels[0], voxels[0])
    ahead = tuple(2 * h - b for b, h in zip(before, here, strict=True))
    return sorted(free, key=lambda v: v != ahead)


def _crumple(voxels: list[Voxel], free: list[Voxel]) -> list[Voxel]:
    """Where most neighbours are taken first."""
    return sorted(free, key=lambda v: -len(set(beside(v)) & set(voxels)))


def _coil(voxels: list[Voxel], free: list[Voxel]) -> list[Voxel]:
    """Round and round in one plane, as near to what is there as it goes."""
    return sorted(_crumple(voxels, free), key=lambda v: v[2] != voxels[0][2])


STYLES = {"wander": _wander, "stretch": _stretch, "crumple": _crumple, "coil": _coil}


@st.composite
def walks(
    draw: Any, min_bars: int = 3, max_bars: int = 14, without_us: bool = False
) -> NDArray[np.int64]:
    """A self-avoiding walk, (bars + 1, 3), that takes after one style as far as the draws let it.

    Half of the draws follow the style, so that even a crumpled walk can be any walk.
    """
    order = STYLES[draw(st.sampled_from(sorted(STYLES)))]
    n_bars = draw(st.integers(min_bars, max_bars))
    voxels: list[Voxel] = [(0, 0, 0)]
    for choice in draw(st.lists(st.integers(0, 9), min_size=n_bars, max_size=n_bars)):
        free = [v for v in beside(voxels[-1]) if v not in voxels]
        if without_us:
            free = [v for v in free if not closes_a_u(voxels, v)]
        if not free:
            break
        voxels.append(order(voxels, free)[max(0, choice - 4) % len(free)])
    assume(len(voxels) > min_bars)
    return np.array(voxels)


@st.composite
def paths(draw: Any, max_voxels: int = 14) -> NDArray[np.int64]:
    """A walk, or a layered path of a random polycube."""
    if draw(st.booleans()):
        return np.asarray(draw(walks(max_bars=max_voxels - 1)))
    occupancy = draw(polycubes(max_voxels))
    assume(occupancy.sum() > 3)
    voxels = lu.layered_path(lu.VoxelSolid(occupancy), starts=1).voxels
    assume(len(voxels) > 3)
    return voxels.astype(np.int64)


def way(
    start: Voxel, goal: Voxel, taken: Collection[Voxel], order: Sequence[int], reach: int = 12
) -> list[Voxel]:
    """A shortest way past the voxels taken, at most so many steps; empty if there is none.

    Of several shortest ways, `order`, of the six directions, picks one.
    """
    came: dict[Voxel, Voxel] = {start: start}
    todo = deque([(start, 0)])
    while todo and goal not in came:
        here, n_steps = todo.popleft()
        near = beside(here)
        for voxel in [near[k] for k in order]:
            if voxel not in came and voxel not in taken and n_steps < reach:
                came[voxel] = here
                todo.append((voxel, n_steps + 1))
    if goal not in came:
        return []
    found = [goal]
    while found[-1] != start:
        found.append(came[found[-1]])
    return found[::-1]
