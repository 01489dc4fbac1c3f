"""Chains, their moves and their motions, for the tests of the judge."""

import itertools

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st
from polycubes import STEPS

import lineup as lu
from lineup import grid
from lineup.kinematics import Move

EAST, NORTH, UP, WEST, SOUTH, DOWN = range(6)


def motion(start, moves, straight=True, poses=(), reason="straight"):
    poses = np.array(poses, np.int8).reshape(len(poses), max(len(start) - 1, 0))
    moves = np.array(moves, int).reshape(-1, 4)
    return lu.Motion(np.array(start), moves, 1.0, 90.0, straight, reason, poses)


def walk(word, start=(0, 0, 0)):
    """The voxels of a path spelled in the letters of `grid.LETTERS`."""
    steps = [grid.DIRECTIONS[grid.LETTERS.index(c)] for c in word]
    return np.vstack([start, start + np.cumsum(steps, axis=0)])


def boustrophedon(nx, ny, nz):
    """Every voxel of a block, row by row and layer by layer upwards."""
    cells = []
    for z in range(nz):
        rows = range(ny) if z % 2 == 0 else range(ny - 1, -1, -1)
        for y in rows:
            forth = (y % 2 == 0) if z % 2 == 0 else ((ny - 1 - y) % 2 == 0) != (ny % 2 == 1)
            cells += [(x, y, z) for x in (range(nx) if forth else range(nx - 1, -1, -1))]
    return np.array(cells)


def peeled(start, direction):
    """The motion that peels the last bar, then the one before, and so on, to one direction."""
    bars = grid.bar_directions(start)
    rows = [(Move.PEEL, k, k + 1, direction) for k in range(len(bars)) if bars[k] != direction]
    return motion(start, rows[::-1])


def peeled_from_both_ends(start, direction):
    """The same with the two ends taking turns: end 0 peels to the opposite direction."""
    bars, middle = grid.bar_directions(start), len(start) // 2
    opposite = (direction + 3) % 6
    last = [(Move.PEEL, k, k + 1, direction) for k in range(len(bars) - 1, middle - 1, -1)]
    first = [(Move.PEEL, k + 1, k, opposite) for k in range(middle)]
    turns = itertools.chain(*itertools.zip_longest(last, first))
    return motion(start, [r for r in turns if r and bars[min(r[1:3])] != direction])


def single(start, row, pose=()):
    """A motion of one move."""
    poses = np.array([pose], np.int8) if len(pose) else np.empty((0, 0), np.int8)
    return lu.Motion(start, np.array([row], int), 1.0, 90.0, False, "one move", poses)


def turns(pose):
    """Every well-formed PEEL, SWING and DOOR of a lattice pose."""
    n = len(pose)
    rows = []
    for joint in range(n):
        for other in (joint - 1, joint + 1):
            if 0 <= other < n:
                bar = pose[other] - pose[joint]
                values = [d for d in range(6) if not bar[d % 3]]
                rows += [(k, joint, other, d) for k in (Move.PEEL, Move.SWING) for d in values]
        for other in range(joint + 2, n):
            apart = np.abs(pose[other] - pose[joint])
            if apart.max() == apart.sum() < other - joint:
                rows += [(Move.DOOR, joint, other, value) for value in (1, -1)]
    return rows


def extended(voxels, rng, straightness):
    """A simple path one voxel longer, or shorter where there is no way on."""
    x, y, z = voxels[-1]
    ahead = [STEPS[k] for k in rng.permutation(6)]
    if len(voxels) > 1 and rng.random() < straightness:
        ahead.insert(0, tuple(np.subtract(voxels[-1], voxels[-2]).tolist()))
    for dx, dy, dz in ahead:
        if (x + dx, y + dy, z + dz) not in voxels:
            return [*voxels, (x + dx, y + dy, z + dz)]
    return voxels[:-1]


def wander(rng, n_bars, n_moves, diameter, max_bend_deg):
    """A motion of random moves from a random pose, all good but the last.

    Half of the moves begin beside the one before, as those of planners do.
    """
    voxels, straightness = [(0, 0, 0)], rng.choice([0.0, 0.6, 0.95])
    while len(voxels) <= n_bars:
        voxels = extended(voxels, rng, straightness)
    start = pose = np.array(voxels)
    rows, near = [], rng.integers(n_bars)
    for _ in range(n_moves):
        candidates = turns(pose)
        beside = [row for row in candidates if abs(row[1] - near) < 3]
        for attempt in range(10):
            of = beside if beside and attempt < 5 else candidates
            row = of[rng.integers(len(of))]
            trial = single(pose, row)
            if lu.certify(trial, diameter, max_bend_deg).where < 0:
                rows.append(row)
                near = row[1]
                pose = np.rint(list(lu.frames(trial))[-1]).astype(int)
                break
    candidates = turns(pose)
    return motion(start, [*rows, candidates[rng.integers(len(candidates))]])


@st.composite
def chains(draw, max_bars=12):
    """A simple lattice path of 3 to `max_bars` bars, often crumpled."""
    voxels = [(0, 0, 0)]
    n_bars = draw(st.integers(3, max_bars))
    for _ in range(n_bars):
        x, y, z = voxels[-1]
        free = [
            (x + dx, y + dy, z + dz)
            for dx, dy, dz in STEPS
            if (x + dx, y + dy, z + dz) not in voxels
        ]
        assume(free)
        voxels.append(draw(st.sampled_from(free)))
    return np.array(voxels)
