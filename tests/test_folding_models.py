"""Every model of the catalogue, folded at about 1600 voxels (minutes long)."""

import itertools
import os
import time

import numpy as np
import pandas as pd
import pytest
from contracts import check_folding
from hostile import KINDS, hostile

import lineup as lu
from lineup import grid


def folded(name):
    """One row of the table: how well a model folds."""
    solid = lu.model(name, voxels=1600)
    begun = time.perf_counter()
    folding = lu.fold(solid)
    seconds = time.perf_counter() - begun
    check_folding(folding, solid)
    surface = grid.surface(solid.occupancy)
    return {
        "model": name,
        "source": solid.source["kind"],
        "voxels": solid.size,
        "layered": lu.layered_path(solid).coverage(solid),
        "coverage": folding.path.coverage(solid),
        "surface_kept": surface[tuple(folding.path.voxels.T)].sum() / surface.sum(),
        "moves": len(folding.motion),
        "seconds": seconds,
    }


@pytest.mark.slow
@pytest.mark.parametrize("meshes", [False, True], ids=["procedural", "meshes"])
def test_every_model_is_straightened_and_well_covered(meshes, monkeypatch):
    if meshes and not os.environ.get("LINEUP_MODELS"):
        pytest.skip("set LINEUP_MODELS to a folder of meshes")
    if not meshes:
        monkeypatch.delenv("LINEUP_MODELS", raising=False)
    table = pd.DataFrame([folded(name) for name in lu.models()["name"]])
    report = table.to_string(float_format="%.3f")
    print(report)
    assert table["coverage"].min() >= 0.85, report
    assert np.median(table["coverage"]) >= 0.96, report


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_every_hostile_solid_is_straightened(kind):
    for seed, n in itertools.product(range(6), (100, 500, 2000)):
        solid = hostile(kind, seed, n)
        folding = lu.fold(solid, seed=seed)
        check_folding(folding, solid)
        print(kind, seed, solid.size, f"{folding.path.coverage(solid):.3f}")
