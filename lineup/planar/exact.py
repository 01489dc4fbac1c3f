"""The longest planar path by constraint programming, with a proof of it or a bound."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from ..grid import IntArray
from .blocks import Region, chain, chain_limit, reach
from .long import NO_WISHES, long_path


def exact_path(
    region: Region, start: int, end: int, limit: float, seed: int
) -> tuple[IntArray, int]:
    """A path between two different cells of a region, and a length that no path exceeds.

    A closed circuit over arcs between neighbours, one from `end` to `start`, and a loop at each
    cell left out (CP-SAT). One worker and deterministic time, so the result is reproducible.

    Parameters
    ----------
    limit : float
        Deterministic time, about seconds. When it runs out the path is the best one so far.

    Raises
    ------
    RuntimeError
        If OR-Tools is not installed.
    """
    try:
        from ortools.sat.python import cp_model
    except ImportError:
        raise RuntimeError(
            "method 'exact' needs OR-Tools: pip install 'lineup-workbench[exact]'"
        ) from None
    blocks = chain(region, start, end)
    longest, _ = chain_limit(region, blocks, start)
    cells = np.flatnonzero(reach(region, blocks)).tolist()
    hint = _shortest(region, start, end)
    model = cp_model.CpModel()
    arcs = _arcs(model, cells, region.width, hint)
    loops = [literal for cell, other, literal in arcs if cell == other]
    number = {cell: k for k, cell in enumerate(cells)}
    model.add_circuit([(number[cell], number[other], literal) for cell, other, literal in arcs])
    model.add(len(cells) - sum(loops) <= longest)
    model.minimize(sum(loops))
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.random_seed = seed
    solver.parameters.max_deterministic_time = limit
    if solver.solve(model) not in (cp_model.OPTIMAL, cp_model.FEASIBLE):
        return np.array(hint, np.int32), longest
    bound = len(cells) - int(np.ceil(solver.best_objective_bound - 1e-6))
    ahead = {cell: other for cell, other, literal in arcs if solver.value(literal)}
    path = [start]
    while path[-1] != end:
        path.append(ahead[path[-1]])
    return np.array(path, np.int32), bound


def _arcs(model: Any, cells: list[int], width: int, hint: list[int]) -> list[tuple[int, int, Any]]:
    """Rows (cell, cell after it, literal), with a path between the ends as a hint.

    The end is followed by the start, and a cell left out by itself.
    """
    start, end = hint[0], hint[-1]
    within, ahead = set(cells), dict(pairwise(hint))
    arcs = [(end, start, model.new_constant(True))]
    for cell in cells:
        near = (cell + 1, cell + width, cell - 1, cell - width)
        others = [other for other in near if other in within and cell != end and other != start]
        if cell not in (start, end):
            others.append(cell)
        for other in others:
            literal = model.new_bool_var(f"{cell}-{other}")
            model.add_hint(literal, ahead.get(cell, cell) == other)
            arcs.append((cell, other, literal))
    return arcs


def _shortest(region: Region, start: int, end: int) -> list[int]:
    """A shortest path: a search for a long one that makes no proposal."""
    path, _, _ = long_path(region, start, end, NO_WISHES, 1, 0, np.random.default_rng(0))
    return [int(cell) for cell in path]
