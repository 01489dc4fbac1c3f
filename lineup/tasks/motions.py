"""Task `motion`: how far a planner unfolds a path within so many steps, judged (Section 6)."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ..folding import fold
from ..judging import certify
from ..kinematics import frames
from ..layered import layered_path
from ..motion import unfold
from ..solid import Motion
from ._common import GROWTH, solid_of, source_of

COLUMNS = (
    *("source", "n_voxels", "length", "moves", "straight", "straightness", "certified"),
    *("diameter", "max_bend_deg", "clearance", "reason", "verdict"),
)
"""What is in a row."""


def motion(
    model: str,
    voxels: int,
    method: str,
    steps: int | None = None,
    path: str = "layered",
    seed: int = 0,
    *,
    folder: Path,
    progress: Callable[[str], None],
) -> dict[str, Any]:
    """A motion by a key of `MOTION_METHODS`, or "growth", which finds a path of its own.

    `steps` is for the methods that have such an option, "energy" and "barrier". The judge is
    asked for the diameter and the bend that the planner worked for.
    """
    progress("voxelize")
    solid = solid_of(model, voxels)
    progress(method)
    options: dict[str, Any] = {} if steps is None else {"steps": steps}
    if method == GROWTH:
        plan = fold(solid, seed=seed, **options).motion
    else:
        plan = unfold(layered_path(solid, path, seed), method, seed, **options)
    progress("judge")
    verdict = certify(plan, plan.diameter, plan.max_bend_deg)
    return {
        "source": source_of(solid),
        "n_voxels": solid.size,
        "length": len(plan.start),
        "moves": len(plan),
        "straight": plan.straight,
        "straightness": straightness(plan),
        "certified": verdict.ok,
        "diameter": plan.diameter,
        "max_bend_deg": plan.max_bend_deg,
        "clearance": verdict.clearance,
        "reason": plan.reason,
        "verdict": verdict.reason,
    }


def straightness(plan: Motion) -> float:
    """How far apart the ends are in the last pose, as a share of the length of the chain."""
    (pose,) = deque(frames(plan, every=max(len(plan), 1)), maxlen=1)
    return float(np.linalg.norm(pose[-1] - pose[0]) / (len(pose) - 1))
