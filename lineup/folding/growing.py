"""Certified growth: path and motion designed together (in place of Algorithms 3 and 4).

A start path loses the pieces that keep it from being peeled straight; then voxels are won back
by changes that each keep a valid plan. Every state on the way has one, so the search can stop
anywhere; what it cannot promise is how many voxels it reaches. See PAPER.md, deviation 5.
"""

from collections.abc import Callable, Sequence

import numpy as np

from .. import grid as voxels_of
from ..grid import IntArray
from ..layered import layered_paths
from ..motion._chain import Grid, box_grid, cells_of
from ..motion.plan import BOTH_ENDS, left_folded, motion_of, peel_plan
from ..solid import Folding, VoxelPath, VoxelSolid
from ._fold import NEVER, Body, Fold, load, new_fold, path_of, states_of
from ._moves import anneal, fill, random_shortest
from .slotting import slotted

SURFACE_WORTH = 1.5
HOT, COLD = 0.6, 0.1  # worth lost with likelihood 1/e, at first and at last
TRIAL_ROUNDS, ROUNDS = (3, 15_000), (40, 160_000)  # for each voxel, and at most
BATCH = 400
RESUMED = 400  # states of a stuck plan from which the search goes on
BIASES = (0.02, 0.98, 0.02, 0.5)


def body_of(solid: VoxelSolid) -> tuple[Grid, Body]:
    """The grid of a solid, and what its cells are worth."""
    grid = box_grid(solid.occupancy.shape)
    inside = np.pad(solid.occupancy, 1).ravel()
    surface = np.pad(voxels_of.surface(solid.occupancy), 1).ravel()
    return grid, Body(inside, np.where(surface, SURFACE_WORTH, 1.0))


def straightenable(
    grid: Grid,
    cells: IntArray,
    rng: np.random.Generator,
    only: int = BOTH_ENDS,
    tries: int = 400,
    joints: str = "free",
) -> tuple[IntArray, IntArray]:
    """A path with a complete peel plan, got from `cells` by shortcuts where the plan gets stuck.

    A shortcut pays if it frees eight joints more than it costs; short ones are tried first. If
    the tries run out, only the first bar of the path is left, which is always straight.
    """
    plans = [
        peel_plan(grid, cells, rng, bias=bias, only=only, joints=joints) for bias in 2 * BIASES
    ]
    states, length = min(plans, key=left_folded), 4
    for _ in range(0, tries, 4):
        left = left_folded(states)
        if left <= 1:
            return cells, states
        cuts = [_cut(grid, cells, states, length, only, rng, joints) for _ in range(4)]
        paying = [
            (path, plan)
            for path, plan in cuts
            if left_folded(plan) <= 1 or left - left_folded(plan) >= len(cells) - len(path) + 8
        ]
        if paying:
            cells, states = max(paying, key=lambda cut: len(cut[0]) - left_folded(cut[1]) / 2)
        length = 4 if paying else min(2 * length, left)
    return cells[:2], np.array([[0, 1, 0, 0]], np.int32)


def _cut(
    grid: Grid,
    cells: IntArray,
    states: IntArray,
    length: int,
    only: int,
    rng: np.random.Generator,
    joints: str,
) -> tuple[IntArray, IntArray]:
    """Shortcut some `length` folded cells near one stuck end; the shorter path and a plan of it.

    The states of the plan so far remain good, and the search goes on from the last of them.
    """
    a, b = int(states[-1, 0]), int(states[-1, 1])
    reach = min(length + int(rng.integers(length)), b - a)
    slack = min(int(rng.integers(4)), b - a - reach)
    i = a + slack if rng.random() < 0.5 else b - slack - reach
    j = i + reach
    free = np.zeros(len(grid.outside), bool)
    free[cells[i : j + 1]] = True
    way = random_shortest(grid, free, cells[i], cells[j], float(rng.choice((0.01, 0.5, 2.0))), rng)
    shorter = np.concatenate([cells[:i], way, cells[j + 1 :]])
    former = states + np.array([0, len(shorter) - len(cells), 0, 0], np.int32)
    bias = float(rng.choice(BIASES))
    more = peel_plan(
        grid,
        shorter,
        rng,
        starts=former[-RESUMED:],
        patience=1000,
        bias=bias,
        only=only,
        joints=joints,
    )
    resumed = int(np.flatnonzero((former == more[0]).all(axis=1))[0])
    return shorter, np.concatenate([former[:resumed], more])


def growth(
    solid: VoxelSolid,
    seed: int,
    length: int | None,
    *,
    paths: Sequence[VoxelPath] | None = None,
    trial_rounds: int | None = None,
    rounds: int | None = None,
    ends: int = 2,
    joints: str = "free",
    slot_rounds: int = 60,
    progress: Callable[[float], None] | None = None,
) -> Folding:
    """Grow a fold from each start, and the best of them for longer.

    Parameters
    ----------
    length : int, optional
        Stop at this many voxels.
    paths : sequence of VoxelPath, optional
        Start paths; layered paths by default. Without any, growth starts from a single bar.
    trial_rounds, rounds : int, optional
        Rounds of annealing for each start, and for the best of them; by default 3 and 40 for
        each voxel, but at most 15,000 and 160,000.
    ends : int
        How many ends of the chain may let go; with 1 it is the last, and the motion can be made
        within a box (`transform`).
    joints : str
        With ``"slotted"`` no move of the motion is against the slots of the printed block
        (`lineup.joints`); the path is then mended up to `slot_rounds` times (`slotting`).
    progress : function, optional
        Told the share of the work done, 0 to 1.
    """
    trial_rounds = _so_many(TRIAL_ROUNDS, solid) if trial_rounds is None else trial_rounds
    rounds = _so_many(ROUNDS, solid) if rounds is None else rounds
    efforts = (("trial_rounds", trial_rounds), ("rounds", rounds), ("slot_rounds", slot_rounds))
    for name, value in efforts:
        if value < 0:
            raise ValueError(f"{name} must not be negative, got {value}")
    if ends not in (1, 2):
        raise ValueError(f"ends must be 1 or 2, got {ends}")
    if joints not in ("free", "slotted"):
        raise ValueError(f"unknown joints {joints!r}; known: free, slotted")
    only = BOTH_ENDS if ends == 2 else 1
    rng = np.random.default_rng(seed)
    grid, body = body_of(solid)
    paths = layered_paths(solid, seed) if paths is None else paths
    starts = _checked_starts(solid, paths) or [_exposed_bar(solid)]
    target = NEVER if length is None else length
    report = progress or (lambda share: None)
    slot_rounds = slot_rounds if joints == "slotted" else 0
    work = len(starts) * trial_rounds + rounds + slot_rounds * BATCH
    best: Fold | None = None
    for k, start in enumerate(starts):
        fold = _grown(grid, body, cells_of(start, solid.occupancy.shape), only, rng, target)
        _deepen(fold, only, rng, trial_rounds, target)
        report((k + 1) * trial_rounds / max(work, 1))
        if best is None or fold.worth[0] > best.worth[0]:
            best = fold
    assert best is not None  # there is at least one start
    spent = len(starts) * trial_rounds
    _deepen(best, only, rng, rounds, target, lambda done: report((spent + done) / work))
    if joints == "slotted":
        spent += rounds
        path, states = slotted(
            best,
            lambda cells, tries: straightenable(grid, cells, rng, only, tries, joints),
            only,
            rng,
            slot_rounds,
            target,
            lambda done: report((spent + done * BATCH) / work),
        )
        load(best, path, states)
    return folding_of(solid, grid, best, "growth", joints)


def folding_of(
    solid: VoxelSolid, grid: Grid, fold: Fold, method: str, joints: str = "free"
) -> Folding:
    """The path and the motion that a fold stands for."""
    path = path_of(fold)
    inside = np.pad(solid.occupancy, 1).ravel()
    inside[path] = False
    dropped = grid.xyz[np.flatnonzero(inside)]
    voxels = grid.xyz[path]
    motion = motion_of(voxels, states_of(fold), joints)
    return Folding(VoxelPath(voxels, dropped=dropped, method=method), motion)


def _so_many(rounds: tuple[int, int], solid: VoxelSolid) -> int:
    return min(rounds[0] * solid.size, rounds[1])


def _checked_starts(solid: VoxelSolid, paths: Sequence[VoxelPath]) -> list[IntArray]:
    """The voxels of start paths, once it is clear that they are even simple paths of the solid."""
    shape = solid.occupancy.shape
    for k, path in enumerate(paths):
        voxels = path.voxels
        simple = len(np.unique(voxels, axis=0)) == len(voxels)
        adjacent = (np.abs(np.diff(voxels, axis=0)).sum(axis=1) == 1).all()
        inside = ((voxels >= 0) & (voxels < shape)).all() and solid.occupancy[tuple(voxels.T)].all()
        if not (simple and adjacent and inside and len(voxels) % 2 == 0 and len(voxels)):
            raise ValueError(
                f"start path {k} must be a simple path of an even number of voxels of the solid, "
                "each sharing a face with the next"
            )
    return [path.voxels for path in paths]


def _exposed_bar(solid: VoxelSolid) -> IntArray:
    """Two adjacent voxels, the second with nothing of the solid on one of its sides."""
    voxels = np.argwhere(solid.occupancy).astype(np.int32)
    top = voxels[np.lexsort(voxels.T)[-1]]
    beside = np.abs(voxels - top).sum(axis=1) == 1
    return np.stack([voxels[beside][0], top])


def _grown(
    grid: Grid, body: Body, cells: IntArray, only: int, rng: np.random.Generator, target: int
) -> Fold:
    """A start path made straightenable, with what fits in at once."""
    n_voxels = int(body.solid.sum())
    cells, states = straightenable(grid, cells, rng, only)
    fold = new_fold(grid, body, cells, states)
    fill(fold, 20 * n_voxels, target, rng)
    return fold


def _deepen(
    fold: Fold,
    only: int,
    rng: np.random.Generator,
    rounds: int,
    target: int,
    report: Callable[[int], None] = lambda done: None,
) -> None:
    """Anneal in batches, with another plan of the same path for each, as far as one is found."""
    longest = max(BATCH, len(fold.cells) // 2)  # a plan costs as much as so many rounds
    for done in range(0, rounds, longest):
        batch = min(longest, rounds - done)
        hot, cold = (HOT * (1 - x / rounds) + COLD for x in (done, done + batch))
        anneal(fold, batch, hot, cold, target, rng)
        path = path_of(fold)
        states = peel_plan(fold.grid, path, rng, bias=float(rng.choice(BIASES)), only=only)
        if left_folded(states) <= 1:
            load(fold, path, states)
        report(done + batch)
