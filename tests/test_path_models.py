"""What the path methods reach on real meshes."""

import os
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import lineup as lu
from lineup import grid

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        "LINEUP_MODELS" not in os.environ, reason="LINEUP_MODELS names no folder of meshes"
    ),
]


@cache
def solids(voxels):
    """Every mesh of the folder, some of which the catalogue does not name."""
    known = set(lu.models()["name"])
    files = sorted(Path(os.environ["LINEUP_MODELS"]).glob("*.ply"))
    return [
        lu.model(file.stem, voxels=voxels)
        if file.stem in known
        else lu.voxelize(file, voxels=voxels)
        for file in files
    ]


@pytest.mark.parametrize(
    ("method", "voxels", "median", "least", "mean_gap"),
    [
        ("layered", 1600, 0.95, 0.88, 0.04),
        ("layered", 6500, 0.97, 0.92, 0.03),
        ("nested", 1600, 0.96, 0.90, 0.035),
        ("free3d", 1600, 0.98, 0.96, 0.012),
        ("ufree", 1600, 0.97, 0.92, 0.025),
    ],
)
def test_coverage_of_real_models(method, voxels, median, least, mean_gap):
    coverage, kept, gap = [], [], []
    u_free = method == "ufree"
    for solid in solids(voxels):
        path = lu.layered_path(solid, method)
        assert lu.certify_path(path, solid, u_free=u_free).reason == "certified"
        coverage.append(path.coverage(solid))
        gap.append(lu.path_bound(solid, u_free=u_free) / solid.size - coverage[-1])
        surface = grid.surface(solid.occupancy)
        kept.append(surface[tuple(path.voxels.T)].sum() / surface.sum())
    assert np.median(coverage) >= median, coverage
    assert min(coverage) >= least, coverage
    assert 0 <= np.mean(gap) <= mean_gap, gap
    assert np.median(kept) >= 0.95, kept
