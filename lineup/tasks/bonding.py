"""Task `bonding`: what a folded chain bears, by what joins its blocks (Section 7, Figure 17)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..stress import strength
from ..stress.results import summary
from ._common import made, solid_of, source_of

_BORNE = (
    *("stands", "margin_mm", "safety", "worst", "tension_pa", "corner_tension_pa"),
    *("compression_pa", "compression_n", "sag_mm", "reason"),
)

COLUMNS = ("source", "n_voxels", "length", "mass_kg", *_BORNE)
"""What is in a row."""


def bonding(
    model: str,
    voxels: int,
    bonding: str,
    path: str = "layered",
    pitch_mm: float = 10.0,
    up: str = "+z",
    seed: int = 0,
    *,
    folder: Path,
    progress: Callable[[str], None],
) -> dict[str, Any]:
    """The strength of a folded model with one of `BONDINGS`.

    Takes a key of `PATH_METHODS` as `path`, or "growth". What is a millionth of a number is
    rounded away, since that is what the solver of the forces is good for.
    """
    progress("voxelize")
    solid = solid_of(model, voxels)
    progress(path)
    shape = made(solid, path, seed)
    progress("strength")
    result = strength(shape, solid, pitch_mm, bonding=bonding, up=up)
    borne = summary(result)
    row = {name: _rounded(borne[name]) for name in ("mass_kg", *_BORNE)}
    return {
        "source": source_of(solid),
        "n_voxels": solid.size,
        "length": len(result.voxels),
        **row,
    }


def _rounded(value: Any) -> Any:
    return float(f"{value:.6g}") if isinstance(value, float) else value
