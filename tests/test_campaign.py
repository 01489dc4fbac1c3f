"""The campaign of random polycubes: its families, its rows, and what it would find."""

import sys
from dataclasses import replace
from pathlib import Path

import networkx as nx
import numpy as np
import pandas as pd
import pytest
from oracles import voxel_graph
from typer.testing import CliRunner

import lineup as lu

sys.path.append(str(Path(__file__).parents[1] / "benchmarks"))

import campaign
import families


def run(*arguments, code=0):
    result = CliRunner().invoke(campaign.app, [str(a) for a in arguments])
    assert result.exit_code == code, result.output
    return result.output


@pytest.mark.parametrize("family", families.FAMILIES)
def test_a_family_has_the_voxels_asked_for_and_the_same_ones_again(family):
    for voxels in (2, 9, 60, 200):
        solid, again = (
            families.polycube(family, voxels, np.random.default_rng(voxels)) for _ in range(2)
        )
        assert np.array_equal(solid.occupancy, again.occupancy)
        assert voxels <= solid.size <= 1.1 * voxels  # voids are filled


def test_families_are_what_they_are_called():
    def made(family):
        return [families.polycube(family, 60, np.random.default_rng(k)).occupancy for k in range(9)]

    assert all(nx.is_tree(voxel_graph(tree)) for tree in made("tree"))
    assert all(nx.cycle_basis(voxel_graph(rings)) for rings in made("ringed"))
    assert {min(plate.shape) for plate in made("plate")} == {1, 2}
    for comb in made("comb"):
        lines = [comb.sum(axis=axes).max() for axes in ((0, 1), (0, 2), (1, 2))]
        assert max(lines) > 60 / 4  # the spine, or teeth side by side, lie in one layer


def test_a_run_goes_on_where_it_was_and_ends_as_one_that_was_not_stopped(tmp_path):
    for count in (4, 9):
        run("run", "--count", count, "--out", tmp_path / "stopped")
    run("run", "--count", 9, "--out", tmp_path / "whole")
    tables = [
        pd.read_csv(tmp_path / name / "campaign_cases.csv", keep_default_na=False)
        for name in ("stopped", "whole")
    ]
    pd.testing.assert_frame_equal(*(table.drop(columns="seconds") for table in tables))
    rows = tables[1]
    assert rows["family"].tolist() == [*families.FAMILIES, *families.FAMILIES][:9]
    assert (rows[["crash", "invalid"]] == "").all(axis=None)
    assert rows["straight_growth"].all()
    assert (rows["path"] <= rows["folded"]).all()
    assert (rows["folded"] <= rows["bound"]).all()
    assert "another seed" in run("run", "--seed", 1, "--out", tmp_path / "whole", code=2)
    table = pd.read_csv(tmp_path / "whole" / "campaign.csv").set_index(["family", "voxels"])
    assert table.loc[("all", "all"), "count"] == 9
    coverage = rows["folded"] / rows["voxels"]
    assert table.loc[("all", "all"), "coverage_growth"] == pytest.approx(coverage.median())


def test_a_case_is_made_again(tmp_path):
    told = run("again", 3, "--out", tmp_path)
    solid = lu.load(tmp_path / "case_3.solid.json")
    assert f"voxels: {solid.size}" in told
    assert "family: ringed" in told
    assert np.array_equal(solid.occupancy, campaign.solid_of(3, 0).occupancy)


def test_a_crash_is_a_row_and_a_failure(tmp_path, monkeypatch):
    def fails(*_, **__):
        raise ZeroDivisionError("no way")

    monkeypatch.setattr(lu, "fold", fails)
    run("run", "--count", 2, "--out", tmp_path)
    told = pd.read_csv(tmp_path / "campaign_failures.csv")
    assert told["crash"].tolist() == ["ZeroDivisionError: no way"] * 2
    table = pd.read_csv(tmp_path / "campaign.csv")
    assert (table["crashed"] == table["count"]).all()
    assert (table["straight_layered"] == 0).all()


def test_what_does_not_straighten_is_told_and_trimmed_as_a_path(monkeypatch):
    def gives_up(path, *_):
        straight = len(np.unique(np.diff(path.voxels, axis=0), axis=0)) == 1
        reason, nothing = "straight" if straight else "gave up", np.empty((0, 4), int)
        return lu.Motion(path.voxels, nothing, 0.999, 90.0, straight, reason)

    monkeypatch.setattr(lu, "unfold", gives_up)
    row = campaign.measured(lu.VoxelSolid(np.ones((4, 4, 2), bool)), 0, 1)
    assert row["stuck"].startswith("layered: gave up")
    assert (row["straight_layered"], row["straight_growth"]) == (False, True)
    assert row["invalid"] == ""


@pytest.fixture(scope="module")
def solid():
    return lu.VoxelSolid(np.ones((4, 3, 2), bool))


@pytest.fixture(scope="module")
def folding(solid):
    return lu.fold(solid, rounds=50, trial_rounds=50)


def test_nothing_is_found_where_nothing_is_wrong(folding, solid):
    assert campaign.faults_of(folding, folding, solid, 24) == []


def without_a_move(folding):
    return replace(folding, motion=replace(folding.motion, moves=folding.motion.moves[1:]))


def with_a_voxel_dropped(folding):
    return replace(folding, path=replace(folding.path, dropped=folding.path.voxels[:1]))


def without_a_line(folding):
    nothing = replace(folding.motion, moves=folding.motion.moves[:0])
    return replace(folding, motion=nothing)


@pytest.mark.parametrize("fault", [without_a_move, with_a_voxel_dropped, without_a_line])
def test_what_is_wrong_is_found(fault, folding, solid):
    wrong = fault(folding)
    found = campaign.faults_of(wrong, wrong, solid, 24)
    assert found
    assert "it reads back otherwise" not in found
    assert "it reads back otherwise" in campaign.faults_of(folding, wrong, solid, 24)


def test_a_path_beyond_the_bound_is_found(folding, solid):
    n = len(folding.path)
    found = campaign.faults_of(folding, folding, solid, n - 1)
    assert found == [f"{n} voxels, more than the bound of {n - 1}"]
