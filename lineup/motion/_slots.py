"""What slotted joints ask of a peel plan (Section 7, Figures 2 and 16; see `lineup.joints`).

The bar inward of joint k is a capsule if k is even (end 1) or odd (end 0). Call it *crooked* if the
hinge at its far end lies across it. Where an end lets go of the hinge beside a crooked capsule,
turning it about the capsule, its peel would twist the capsule between two bent joints; so would a
swing of the rod about a crooked capsule. Such a swing is left out. Such a peel can be made in two:

- by a *detour*: the hinge turns until it lies along the capsule and then on to the rod's direction,
  through the pole of its socket;
- by a *swap*, if the same end lets go of the capsule next: the capsule goes first, with the hinge
  still bent, and then the hinge.

Either needs more of what is beside the rod to be clear, see docs/motion.md, Section 11.
"""

from .._jit import kernel
from ..grid import IntArray
from ._chain import INWARD, Chain, Grid, has_rod, rays_meet

FREE, SLOTTED, SPARING = range(3)
"""Peels that would twist a capsule are made as any other, never, or where nothing else helps."""

PLAIN, DETOUR, SWAP = range(3)
"""Manners of a step of a plan: as it is, or a peel made in two in one of these ways."""


@kernel
def _direction(grid: Grid, chain: Chain, k: int, to: int) -> int:
    """The direction of the bar from joint k to the joint beside it."""
    step = chain.cell[to] - chain.cell[k]
    for d in range(6):
        if grid.offset[d] == step:
            return d
    return -1


@kernel
def crooked_capsule(grid: Grid, chain: Chain, state: IntArray, end: int, k: int) -> int:
    """Direction, outward, of the capsule inward of joint k of an end; -1 if none is crooked."""
    if k % 2 == end:
        return -1
    inner = k + INWARD[end]
    along = _direction(grid, chain, inner, k)
    if inner != state[1 - end]:
        hinge = _direction(grid, chain, inner, inner + INWARD[end])
    elif has_rod(state, 1 - end, len(chain.cell)):
        hinge = state[3 - end]
    else:
        return -1
    return along if hinge % 3 != along % 3 else -1


@kernel
def twisted_by_peel(grid: Grid, chain: Chain, state: IntArray, end: int) -> int:
    """Direction, outward, of the capsule that the next peel of an end twists; -1 if none."""
    k, d = state[end], state[2 + end]
    inner = k + INWARD[end]
    if inner == state[1 - end]:
        return -1
    capsule = crooked_capsule(grid, chain, state, end, inner)
    hinge = _direction(grid, chain, inner, k)
    across = hinge % 3 != d % 3 and hinge % 3 != capsule % 3 and d % 3 != capsule % 3
    return capsule if capsule >= 0 and across else -1


@kernel
def twisted_by_swing(grid: Grid, chain: Chain, state: IntArray, end: int, f: int) -> bool:
    """Whether a swing of an end's rod to direction f twists a capsule."""
    capsule = crooked_capsule(grid, chain, state, end, state[end])
    return capsule >= 0 and capsule % 3 != state[2 + end] % 3 and capsule % 3 != f % 3


@kernel
def peels_at_once(grid: Grid, chain: Chain, state: IntArray, end: int) -> int:
    """Joints that an end, which may peel, lets go so that no capsule twists: 0, 1 or 2."""
    capsule = twisted_by_peel(grid, chain, state, end)
    if capsule < 0 or may_detour(grid, chain, state, end, capsule):
        return 1
    return 2 if may_swap(grid, chain, state, end) else 0


@kernel
def may_detour(grid: Grid, chain: Chain, state: IntArray, end: int, capsule: int) -> bool:
    """Whether there is room for an end's peel by way of the direction of the capsule."""
    k, d = state[end], state[2 + end]
    inner = k + INWARD[end]
    pole = chain.cell[inner] + grid.offset[capsule]
    corner = pole + chain.cell[k] - chain.cell[inner]
    return _clear(grid, chain, state, end, pole, d) and _clear(grid, chain, state, end, corner, d)


@kernel
def may_swap(grid: Grid, chain: Chain, state: IntArray, end: int) -> bool:
    """Whether an end may let go of a capsule first, and then of the hinge before it."""
    k, d = state[end], state[2 + end]
    hinge, capsule = k + INWARD[end], k + 2 * INWARD[end]
    if capsule == state[1 - end]:
        return False
    step = grid.offset[d]
    beside = chain.cell[capsule] + chain.cell[k] - chain.cell[hinge]
    return _clear(grid, chain, state, end, chain.cell[capsule] + step, d) and _clear(
        grid, chain, state, end, beside + step, d
    )


@kernel
def _clear(grid: Grid, chain: Chain, state: IntArray, end: int, cell: int, d: int) -> bool:
    """No folded joint but an end's own, and not the other rod, at a cell or beyond it along d."""
    other, k = state[1 - end], state[end]
    c = cell
    while not grid.outside[c]:
        joint = chain.joint[c]
        folded = (joint - other) * INWARD[end] <= 0 < (joint - k) * INWARD[end]
        if joint >= 0 and folded:
            return False
        c += grid.offset[d]
    if not has_rod(state, 1 - end, len(chain.cell)):
        return True
    return not rays_meet(grid.xyz[chain.cell[other]], state[3 - end], grid.xyz[cell], d)


@kernel
def plan_keeps_slots(grid: Grid, chain: Chain, states: IntArray) -> bool:
    """Whether a plan twists no capsule, once its peels are swapped or made in two where need be."""
    k = 0
    while k < len(states) - 1:
        old, new = states[k], states[k + 1]
        end = 0 if old[1] == new[1] and old[3] == new[3] else 1
        if old[end] == new[end]:
            if twisted_by_swing(grid, chain, old, end, new[2 + end]):
                return False
        else:
            capsule = twisted_by_peel(grid, chain, old, end)
            if capsule >= 0:
                if k + 2 < len(states) and abs(states[k + 2, end] - old[end]) == 2:
                    swapped = may_swap(grid, chain, old, end)
                else:
                    swapped = False
                if not (swapped or may_detour(grid, chain, old, end, capsule)):
                    return False
                k += int(swapped)
        k += 1
    return True
