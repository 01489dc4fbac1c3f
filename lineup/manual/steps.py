"""Actions in steps that a hand can do at a time: a page of the booklet each."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from ..grid import IntArray
from .actions import Action

LEAST, MOST = 10, 60
"""Voxels of a step: a run of fewer is joined to one beside it, and one of more is cut."""

MOST_RUNS, MOST_LAYERS, MOST_BY_BOTH = 8, 4, 20
"""Of a step that is joined from short runs; the last, voxels if both ends are at work."""


class _Run(NamedTuple):
    """Actions first to stop - 1, which put so many voxels in place, in these layers."""

    first: int
    stop: int
    n_voxels: int
    layers: frozenset[int]
    ends: frozenset[int]
    n_runs: int = 1


def steps_of(places: IntArray, actions: Sequence[Action]) -> list[range]:
    """The actions of each step, as ranges one after the other.

    A run is what one end puts in place in one layer without a swing between. One over `MOST`
    voxels is cut into equal parts, but no block is; runs under `LEAST` are joined to others.
    A block whose hinge stands upright counts to the layer of its voxel that comes first.

    Examples
    --------
    >>> import numpy as np
    >>> from lineup.manual.actions import Action
    >>> from lineup.manual.steps import steps_of
    >>> row = np.array([(k, 1, 1) for k in range(100)])
    >>> steps_of(row, [Action(1, k, 0, 0, 0) for k in range(2, 100)])
    [range(0, 50), range(50, 98)]
    """
    steps: list[_Run] = []
    for run in _runs(places, actions):
        if steps and _go_together(steps[-1], run):
            steps[-1] = _joined(steps[-1], run)
        else:
            steps.append(run)
    return [range(step.first, step.stop) for step in steps]


def _runs(places: IntArray, actions: Sequence[Action]) -> Iterator[_Run]:
    units: list[_Run] = []
    kind = None
    for unit in _units(places, actions):
        first = actions[unit.first]
        of_unit = (unit.ends, unit.layers)
        if units and (first.swings or of_unit != kind):
            yield from _cut(units)
            units = []
        kind = of_unit
        units.append(unit)
    yield from _cut(units)


def _units(places: IntArray, actions: Sequence[Action]) -> Iterator[_Run]:
    """The voxels of one block that an end puts in place in a row, with the swings before them."""
    first, layer, n_voxels = 0, -1, 0
    for k, action in enumerate(actions):
        if not action.swings:
            layer = layer if n_voxels else int(places[action.joint, 2])
            n_voxels += 1
        after = actions[k + 1] if k + 1 < len(actions) else None
        same = (action.end, action.joint // 2) == (after and (after.end, after.joint // 2))
        if n_voxels and (after is None or after.swings or not same):
            yield _Run(first, k + 1, n_voxels, frozenset([layer]), frozenset([action.end]))
            first, n_voxels = k + 1, 0


def _cut(units: list[_Run]) -> Iterator[_Run]:
    """Units of one run, joined to few parts of like size and at most `MOST` voxels."""
    n_voxels = sum(unit.n_voxels for unit in units)
    n_parts = -(-n_voxels // MOST)
    part: _Run | None = None
    done = 0
    for unit in units:
        full = part is not None and part.n_voxels + unit.n_voxels > MOST
        if part is not None and (full or done * n_parts >= n_voxels):
            yield part
            part, done = None, done - -(-n_voxels // n_parts)
        part = unit if part is None else _joined(part, unit)._replace(n_runs=1)
        done += unit.n_voxels
    if part is not None:
        yield part


def _joined(run: _Run, after: _Run) -> _Run:
    return _Run(
        run.first,
        after.stop,
        run.n_voxels + after.n_voxels,
        run.layers | after.layers,
        run.ends | after.ends,
        run.n_runs + after.n_runs,
    )


def _go_together(step: _Run, run: _Run) -> bool:
    both = _joined(step, run)
    return (
        min(step.n_voxels, run.n_voxels) < LEAST
        and both.n_voxels <= (MOST if len(both.ends) == 1 else MOST_BY_BOTH)
        and both.n_runs <= MOST_RUNS
        and len(both.layers) <= MOST_LAYERS
    )
