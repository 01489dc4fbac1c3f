"""Task `path`: one path through one solid, judged."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..bounds import path_bound
from ..judging import certify_path
from ..solid import Folding
from ._common import made, solid_of, source_of, surface_visited

COLUMNS = (
    *("source", "n_voxels", "iou", "length", "coverage", "bound", "gap", "surface"),
    *("certified", "reason"),
)
"""What is in a row."""

U_FREE = ("ufree", "refined4")
"""Methods whose paths promise to have no U."""


def path(
    model: str,
    voxels: int,
    method: str,
    seed: int = 0,
    up: str | None = None,
    *,
    folder: Path,
    progress: Callable[[str], None],
) -> dict[str, Any]:
    """How much of a solid a method reaches, and how much it could at most.

    Takes a key of `PATH_METHODS` as `method`, or "growth".
    """
    progress("voxelize")
    solid = solid_of(model, voxels, up)
    progress(method)
    found = made(solid, method, seed)
    route = found.path if isinstance(found, Folding) else found
    u_free = method in U_FREE
    progress("judge")
    verdict = certify_path(route, solid, u_free=u_free)
    coverage = route.coverage(solid)
    bound = 1.0 if route.refinement > 1 else path_bound(solid, u_free=u_free) / solid.size
    return {
        "source": source_of(solid),
        "n_voxels": solid.size,
        "iou": solid.source["iou"],
        "length": len(route),
        "coverage": coverage,
        "bound": bound,
        "gap": bound - coverage,
        "surface": surface_visited(route, solid),
        "certified": verdict.ok,
        "reason": verdict.reason,
    }
