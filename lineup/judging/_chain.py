"""The chain as the judge keeps it: a body whose joints are found by place, and runs outside it.

A motion mostly turns straight rods about a body that rests. Joints first..last are the body, and
a hash table tells which of them is at a given lattice point. Bars outside are kept as straight
runs, a stack on either side, the run next to the body on top. Moves turn runs; where a move
turns joints of the body, these leave it first. Runs that have rested long enough enter it.
"""

from typing import NamedTuple

import numpy as np

from .._jit import part
from ._sweeps import Ints, write

Point = tuple[int, int, int]

NEAR, FAR, NEAR_X, FAR_X = 0, 1, 2, 5
ENTRY_COST = 8  # comparing that many runs costs about as much as entering one bar in the body
_X, _Y, _Z = 0x1F3D5B79A2C4E681, 0x2545F4914F6CDD1D, 0x369DEA0F31A53F85


class Chain(NamedTuple):
    """Joints 0..P-1; side 0 of the body is towards joint 0, side 1 towards joint P - 1."""

    pose: Ints  # (P, 3) positions; of joints outside the body they are out of date
    body: Ints  # (3,) its first and its last joint, and how many it had when it was boxed
    box: Ints  # (2, 3) lowest and highest position; no joint of the body lies outside
    table: Ints  # (T,) joints by the hash of their position, -1 where free
    entered: Ints  # (1,) slots of the table that are taken
    runs: Ints  # (2, P, 8) near and far joint of a run, as seen from the body, and their positions
    n_runs: Ints  # (2,)
    debt: Ints  # (2,) comparisons made with resting runs of a side since some last entered


def new_chain(pose: Ints) -> Chain:
    """The chain in a lattice pose, which it takes over; all of it is the body, see `start`."""
    size = 8
    while size < 4 * len(pose):
        size *= 2
    return Chain(
        pose,
        np.array([0, len(pose) - 1, 0]),
        np.zeros((2, 3), np.int64),
        np.full(size, -1, np.int64),
        np.zeros(1, np.int64),
        np.empty((2, len(pose), 8), np.int64),
        np.zeros(2, np.int64),
        np.zeros(2, np.int64),
    )


@part
def start(chain: Chain) -> None:
    """Make joint 0 alone the body of a new chain."""
    release(chain, 1, 0)
    _restart(chain)


@part
def lay_out(chain: Chain) -> None:
    """Bring `pose` up to date for the joints outside the body."""
    for side in range(2):
        for k in range(chain.n_runs[side]):
            run = chain.runs[side, k]
            for t in range(1, abs(run[FAR] - run[NEAR]) + 1):
                _put(chain, run, t)


@part
def _put(chain: Chain, run: Ints, t: int) -> int:
    """Bring `pose` up to date for the joint t bars along a run, and name it."""
    n_bars = abs(run[FAR] - run[NEAR])
    joint = run[NEAR] + t * (run[FAR] - run[NEAR]) // n_bars
    for axis in range(3):
        near, far = run[NEAR_X + axis], run[FAR_X + axis]
        chain.pose[joint, axis] = near + t * (far - near) // n_bars
    return int(joint)


@part
def position(chain: Chain, joint: int) -> Point:
    """Where a joint is."""
    if not chain.body[0] <= joint <= chain.body[1]:
        side = int(joint > chain.body[1])
        run = chain.runs[side, _run_with(chain, side, joint)]
        _put(chain, run, abs(joint - run[NEAR]))
    p = chain.pose[joint]
    return p[0], p[1], p[2]


@part
def _run_with(chain: Chain, side: int, joint: int) -> int:
    """The run outside the body that holds a joint, at its far end if it is at two."""
    k = chain.n_runs[side] - 1
    while abs(joint - chain.body[side]) > abs(chain.runs[side, k, FAR] - chain.body[side]):
        k -= 1
    return int(k)


@part
def split(chain: Chain, side: int, joint: int) -> int:
    """Part the run that holds a joint in two there; the number of runs beyond the joint."""
    runs, n = chain.runs[side], chain.n_runs[side]
    if joint == chain.body[side]:
        return int(n)
    k = _run_with(chain, side, joint)
    if joint == runs[k, FAR]:
        return k
    p = position(chain, joint)
    for row in range(n, k, -1):
        write(runs[row], runs[row - 1])
    runs[k, NEAR] = runs[k + 1, FAR] = joint
    for axis in range(3):
        runs[k, NEAR_X + axis] = runs[k + 1, FAR_X + axis] = p[axis]
    chain.n_runs[side] += 1
    return k + 1


@part
def mend(chain: Chain, side: int, k: int) -> None:
    """Make one of the runs k and k - 1, if there are both and they lie on one line."""
    runs, n = chain.runs[side], chain.n_runs[side]
    if not 1 <= k < n or not _aligned(runs[k], runs[k - 1]):
        return
    runs[k - 1, NEAR] = runs[k, NEAR]
    write(runs[k - 1, NEAR_X:FAR_X], runs[k, NEAR_X:FAR_X])
    for row in range(k, n - 1):
        write(runs[row], runs[row + 1])
    chain.n_runs[side] -= 1


@part
def _aligned(a: Ints, b: Ints) -> bool:
    """Whether two runs have one direction."""
    for axis in range(3):
        along_a = np.sign(a[FAR_X + axis] - a[NEAR_X + axis])
        if along_a != np.sign(b[FAR_X + axis] - b[NEAR_X + axis]):
            return False
    return True


@part
def release(chain: Chain, side: int, joint: int) -> None:
    """Let joints leave the body, until `joint` is its last on this side."""
    inward = 1 - 2 * side
    while chain.body[side] != joint:
        far = chain.body[side]
        near = far + inward
        chain.body[side] = near
        _push(chain, side, near, far, chain.pose[near], chain.pose[far])
    if 2 * (chain.body[1] - chain.body[0] + 1) < chain.body[2]:
        _box(chain)


@part
def _push(chain: Chain, side: int, near: int, far: int, p: Ints, q: Ints) -> None:
    """Put a run from p to q on top of a side's stack."""
    k = chain.n_runs[side]
    run = chain.runs[side, k]
    run[NEAR], run[FAR] = near, far
    write(run[NEAR_X:FAR_X], p)
    write(run[FAR_X:], q)
    chain.n_runs[side] += 1
    mend(chain, side, k)


@part
def settle(chain: Chain, side: int, joint: int) -> None:
    """Make a joint outside the body, on this side, the whole body; all other bars are runs."""
    other = 1 - side
    release(chain, other, chain.body[side])
    n_beyond = split(chain, side, joint)
    for k in range(chain.n_runs[side] - 1, n_beyond - 1, -1):
        run = chain.runs[side, k]
        _push(chain, other, run[FAR], run[NEAR], run[FAR_X:], run[NEAR_X:FAR_X])
    position(chain, joint)
    chain.n_runs[side] = n_beyond
    chain.body[0] = chain.body[1] = joint
    _restart(chain)


@part
def enter(chain: Chain, side: int, keep: int) -> None:
    """Let runs of a side enter the body, those next to it first, until `keep` are left."""
    while chain.n_runs[side] > keep:
        chain.n_runs[side] -= 1
        run = chain.runs[side, chain.n_runs[side]]
        for t in range(1, abs(run[FAR] - run[NEAR]) + 1):
            joint = _put(chain, run, t)
            chain.body[side] = joint
            insert(chain, joint)
    chain.body[2] = max(chain.body[2], chain.body[1] - chain.body[0] + 1)
    chain.debt[side] = 0


@part
def _restart(chain: Chain) -> None:
    """Find the body, as it is, by place."""
    _box(chain)
    for joint in range(chain.body[0], chain.body[1] + 1):
        insert(chain, joint)


@part
def _box(chain: Chain) -> None:
    first, last = chain.body[0], chain.body[1]
    chain.body[2] = last - first + 1
    for axis in range(3):
        chain.box[0, axis] = chain.box[1, axis] = chain.pose[first, axis]
    for joint in range(first, last + 1):
        _widen(chain, joint)


@part
def _widen(chain: Chain, joint: int) -> None:
    for axis in range(3):
        chain.box[0, axis] = min(chain.box[0, axis], chain.pose[joint, axis])
        chain.box[1, axis] = max(chain.box[1, axis], chain.pose[joint, axis])


@part
def insert(chain: Chain, joint: int) -> None:
    """Enter a joint of the body in the box and in the table.

    Nothing is ever deleted: a slot whose joint has left the body, or its place, is passed over.
    """
    _widen(chain, joint)
    _take_slot(chain, joint)
    if 2 * chain.entered[0] > len(chain.table):
        for slot in range(len(chain.table)):
            chain.table[slot] = -1
        chain.entered[0] = 0
        for other in range(chain.body[0], chain.body[1] + 1):
            _take_slot(chain, other)


@part
def _take_slot(chain: Chain, joint: int) -> None:
    p = chain.pose[joint]
    slot = _slot(chain, p[0], p[1], p[2])
    while chain.table[slot] >= 0:
        if chain.table[slot] == joint:
            return
        slot = (slot + 1) & (len(chain.table) - 1)
    chain.table[slot] = joint
    chain.entered[0] += 1


@part
def find(chain: Chain, x: int, y: int, z: int) -> int:
    """The joint of the body at a lattice point, -1 if there is none."""
    slot = _slot(chain, x, y, z)
    while chain.table[slot] >= 0:
        joint = chain.table[slot]
        if chain.body[0] <= joint <= chain.body[1]:
            p = chain.pose[joint]
            if p[0] == x and p[1] == y and p[2] == z:
                return int(joint)
        slot = (slot + 1) & (len(chain.table) - 1)
    return -1


@part
def _slot(chain: Chain, x: int, y: int, z: int) -> int:
    key = x * _X + y * _Y + z * _Z
    return (key ^ (key >> 31)) & (len(chain.table) - 1)
