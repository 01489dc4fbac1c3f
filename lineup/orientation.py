"""Which way up a model is best turned before it is voxelized (Section 9, future work).

The layers, and with them the Reeb graph, depend on the direction that is up. Orientations are
told apart by a stated objective: first by what is cheap, a solid and a layered path; the best are
folded as well.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd

from .catalog import surface_for
from .folding import fold
from .grid import BoolArray, FloatArray
from .headings import AXES, apart_deg, resting, spread, tilted
from .judging import certify
from .layered import layered_path
from .meshes import Surface, turned_upright
from .reeb import reeb_graph, traverse
from .solid import VoxelSolid
from .stress.support import tip_margin
from .voxelization import check_voxels, fitted

WEIGHTS = {
    "layered": 0.5,
    "folded": 1.0,
    "certified": 1.0,
    "iou": 1.0,
    "simplicity": 0.1,
    "stands": 0.05,
}
"""The objective: the sum of these columns, each from 0 to 1, times its weight."""

FRONT = ("layered", "iou", "simplicity")
"""The columns between which the Pareto front trades."""

COLUMNS = (
    *("up_x", "up_y", "up_z", "kind", "tilt_deg", "voxels", "iou", "nodes", "mscs", "simplicity"),
    *("base", "margin", "stands", "layered", "folded", "certified", "score", "pareto", "reason"),
)

Progress = Callable[[str, str], None]

_AT_REST = 8  # resting directions tried
_EXPLORED = 2 / 3  # of the evaluations; the rest refine
_PARENTS, _CHILDREN = 3, 2  # orientations refined at a time, and tilts of each
_WIDEST_DEG, _SMALLEST_DEG = 20.0, 2.5
_SAME_DEG = 2.0
_CELLS = 8000  # of the coarse solid whose centre of mass decides how the model rests


@dataclass
class _Search:
    """A search on its way: what has been tried so far, and where it tells so."""

    surface: Surface
    name: str
    voxels: int
    seed: int
    starts: int
    weights: Mapping[str, float]
    tell: Progress
    rows: list[dict[str, Any]] = field(default_factory=list)
    solids: list[VoxelSolid | None] = field(default_factory=list)

    @property
    def ups(self) -> FloatArray:
        ups = [[row["up_x"], row["up_y"], row["up_z"]] for row in self.rows]
        return np.array(ups).reshape(-1, 3)

    def is_new(self, up: FloatArray) -> bool:
        return bool((apart_deg(up, self.ups) > _SAME_DEG).all())


def rank_orientations(
    model: object,
    voxels: int = 1600,
    *,
    evaluations: int = 40,
    finalists: int = 5,
    weights: Mapping[str, float] | None = None,
    front: Sequence[str] = FRONT,
    seed: int = 0,
    starts: int = 2,
    progress: Progress | None = None,
) -> pd.DataFrame:
    """Orientations of a model, best first (Section 9).

    Tried are the upright orientation, the other axes, poses in which the model rests on its
    convex hull, and directions spread over the sphere; a third of the evaluations then goes to
    tilts of the best, by 20 degrees and ever less. Each gets a solid and a layered path; the
    finalists, upright among them, are folded by certified growth and judged.

    Parameters
    ----------
    model : str, Path, mesh or pair of arrays
        A name of the catalogue, or what `voxelize` takes.
    voxels : int
        Target count of each solid.
    evaluations : int
        Orientations that get a solid and a layered path. One takes about a second at 1,600 voxels.
    finalists : int
        Orientations that are folded, at several seconds each.
    weights : mapping, optional
        Weights that differ from `WEIGHTS`: of "layered" and "folded" (coverage), "certified" (1
        if the judge accepts the motion), "iou" (with the mesh), "simplicity" (1 / (1 + MSCs)),
        and "stands" (1 if the solid does not tip over). Each is at least 0.
    front : sequence of str
        Columns between which the Pareto front is drawn.
    seed : int
        The same model, seed and options give the same table. Coverage differs from seed to seed,
        so that the best of many looks better than it is: report it on other seeds.
    starts : int
        Layered paths tried in each orientation.
    progress : function, optional
        Called with an orientation, as "17 refined", and what is done with it.

    Returns
    -------
    DataFrame
        One row an orientation, those folded first, each part by falling score. "up_x", "up_y",
        "up_z": the direction that becomes +z, as `lineup.model` and `voxelize` take it; "kind":
        "upright", "axis", "rest", "sphere" or "refined"; "tilt_deg": from upright; "voxels",
        "iou"; "nodes" and "mscs" of the Reeb graph, as `traverse` walks it; "simplicity";
        "base": voxels on the floor; "margin": how far inside of the base the centre of mass is,
        in voxels, negative if it tips over; "stands"; "layered", "folded": coverage, the latter
        nan where not folded; "certified" (None where not folded); "score"; "pareto"; "reason":
        "ok", or why there is no solid, and then the score is nan and the row one of the last.

    Raises
    ------
    FileNotFoundError, ValueError
        As `lineup.model` and `voxelize`; a ValueError if a number is out of range, or a weight or
        a column of the front unknown.

    Examples
    --------
    >>> import lineup as lu
    >>> table = lu.rank_orientations("duck", voxels=60, evaluations=4, finalists=1)
    >>> len(table), table["kind"].tolist()[0], bool(table["certified"].iloc[0])
    (4, 'upright', True)
    """
    weighed = _weighed(weights)
    _check(evaluations, finalists, starts, seed, front)
    check_voxels(voxels)
    surface, name = surface_for(model)
    tell = progress or (lambda what, stage: None)
    search = _Search(surface, name, voxels, seed, starts, weighed, tell)
    rng = np.random.default_rng([seed, 9])
    _explore(search, evaluations, rng)
    _refine(search, evaluations, rng)
    _fold_best(search, finalists)
    return _table(search, front)


def _weighed(weights: Mapping[str, float] | None) -> dict[str, float]:
    unknown = sorted(set(weights or {}) - set(WEIGHTS))
    if unknown:
        raise ValueError(f"there is no weight {unknown[0]!r}; known: {sorted(WEIGHTS)}")
    weighed = {**WEIGHTS, **(weights or {})}
    for name, value in weighed.items():
        if not 0 <= value < np.inf:
            raise ValueError(f"the weight of {name} must be at least 0, got {value}")
    return weighed


def _check(evaluations: int, finalists: int, starts: int, seed: int, front: Sequence[str]) -> None:
    least = {"evaluations": (evaluations, 1), "finalists": (finalists, 0), "seed": (seed, 0)}
    for name, (value, low) in {**least, "starts": (starts, 1)}.items():
        if value < low:
            raise ValueError(f"{name} must be at least {low}, got {value}")
    unknown = sorted(set(front) - set(WEIGHTS))
    if unknown or not front or isinstance(front, str):
        got = repr(unknown[0]) if unknown else repr(front)
        raise ValueError(f"the front is between some of {sorted(WEIGHTS)}, got {got}")


def _explore(search: _Search, evaluations: int, rng: np.random.Generator) -> None:
    first = min(evaluations, max(len(AXES), round(_EXPLORED * evaluations)))
    for k, up in enumerate(AXES[:first]):
        _evaluate(search, up, "axis" if k else "upright")
    for up in resting(search.surface.vertices, _centre(search.surface))[:_AT_REST]:
        if len(search.rows) < first and search.is_new(up):
            _evaluate(search, up, "rest")
    for up in spread(first - len(search.rows), rng):
        if search.is_new(up):
            _evaluate(search, up, "sphere")


def _centre(surface: Surface) -> FloatArray:
    """The centre of mass of what is inside, to a fraction of a coarse voxel."""
    low, extent = surface.vertices.min(axis=0), np.ptp(surface.vertices, axis=0)
    cell = float(extent.prod() / _CELLS) ** (1 / 3)
    shape = np.ceil(extent / cell).astype(int)
    points = low + (np.indices(shape).reshape(3, -1).T + 0.5) * extent / shape
    inside = points[surface.winding(points) > 0.5]
    middle: FloatArray = (inside if len(inside) else surface.vertices).mean(axis=0)
    return middle


def _refine(search: _Search, evaluations: int, rng: np.random.Generator) -> None:
    angle_deg, tries = _WIDEST_DEG, 0
    while len(search.rows) < evaluations and tries < 4 * evaluations:
        parents = _best(search)[:_PARENTS]
        if not parents:
            return
        ups = search.ups
        for parent in [k for k in parents for _ in range(_CHILDREN)]:
            up = tilted(ups[parent], angle_deg, rng)
            tries += 1
            if len(search.rows) < evaluations and search.is_new(up):
                _evaluate(search, up, "refined")
        angle_deg = max(angle_deg / 2, _SMALLEST_DEG)


def _best(search: _Search) -> list[int]:
    """Orientations that have a solid, by falling score, the earlier of equals first."""
    scores = {k: row["score"] for k, row in enumerate(search.rows) if row["reason"] == "ok"}
    return sorted(scores, key=lambda k: (-scores[k], k))


def _evaluate(search: _Search, up: FloatArray, kind: str) -> None:
    label = f"{len(search.rows)} {kind}"
    search.tell(label, "layered")
    x, y, z = (float(c) for c in up)
    row: dict[str, Any] = {"up_x": x, "up_y": y, "up_z": z, "kind": kind}
    row["tilt_deg"] = float(apart_deg(up, AXES[:1])[0])
    solid = None
    try:
        upright = turned_upright(search.surface, (x, y, z))
        solid = fitted(upright, search.voxels, search.name, {"up": [x, y, z]})
        path = layered_path(solid, seed=search.seed, starts=search.starts)
    except ValueError as error:
        search.rows.append({**row, "score": np.nan, "reason": str(error)})
        search.tell(label, f"failed: {error}")
    else:
        row.update(_measured(solid), layered=path.coverage(solid), reason="ok")
        search.rows.append({**row, "score": _score(row, search.weights)})
        search.tell(label, "done")
    search.solids.append(solid)


def _measured(solid: VoxelSolid) -> dict[str, Any]:
    graph = reeb_graph(solid)
    n_mscs = len(traverse(graph).mscs)
    base, margin = footing(solid)
    return {
        "voxels": solid.size,
        "iou": solid.source["iou"],
        "nodes": len(graph),
        "mscs": n_mscs,
        "simplicity": 1 / (1 + n_mscs),
        "base": base,
        "margin": margin,
        "stands": margin > 0,
    }


def footing(solid: VoxelSolid) -> tuple[int, float]:
    """Voxels that a solid stands on, and how far within them its centre of mass is, in voxels.

    Examples
    --------
    >>> footing(VoxelSolid(np.ones((4, 2, 5), bool)))
    (8, 1.0)
    """
    voxels = np.argwhere(solid.occupancy)
    floor = voxels[voxels[:, 2] == voxels[:, 2].min(), :2]
    half = np.array([(-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5)])
    corners = (floor[:, None] + half).reshape(-1, 2)
    return len(floor), round(tip_margin(corners, voxels[:, :2].mean(axis=0)), 9)


def _score(row: Mapping[str, Any], weights: Mapping[str, float]) -> float:
    return float(sum(weight * row.get(name, 0.0) for name, weight in weights.items()))


def _fold_best(search: _Search, finalists: int) -> None:
    chosen = _best(search)
    if 0 in chosen:
        chosen = [0, *(k for k in chosen if k)]
    for k in chosen[:finalists]:
        row, solid = search.rows[k], search.solids[k]
        if solid is None:
            continue
        label = f"{k} {row['kind']}, folded"
        search.tell(label, "fold")
        folding = fold(solid, seed=search.seed)
        row["folded"] = folding.path.coverage(solid)
        row["certified"] = folding.motion.straight and certify(folding.motion).ok
        row["score"] = _score(row, search.weights)
        search.tell(label, "done")


def _table(search: _Search, front: Sequence[str]) -> pd.DataFrame:
    table = pd.DataFrame(search.rows, columns=list(COLUMNS))
    table["certified"] = table["certified"].astype(object).where(table["certified"].notna(), None)
    table["pareto"] = on_front(table[list(front)].astype(float).to_numpy())
    table["first"] = table["folded"].isna().astype(int)
    table = table.sort_values(["first", "score"], ascending=[True, False], kind="stable")
    return table.drop(columns="first").reset_index(drop=True)


def on_front(values: FloatArray) -> BoolArray:
    """Which rows of (n, d) values no other row matches everywhere and exceeds somewhere.

    Rows with a nan are never on the front, and dominate none.

    Examples
    --------
    >>> on_front(np.array([(1.0, 2), (2, 1), (1, 1), (np.nan, 9)])).tolist()
    [True, True, False, False]
    """
    known = ~np.isnan(values).any(axis=1)
    as_good = np.all(values[None] >= values[:, None], axis=2)
    better = np.any(values[None] > values[:, None], axis=2)
    front: BoolArray = known & ~np.any(as_good & better, axis=1)
    return front
