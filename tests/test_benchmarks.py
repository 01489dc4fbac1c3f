"""The benchmarks run, on tiny solids, and what they tell is true."""

import sys
import time
from pathlib import Path

import networkx as nx
import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from oracles import longest_path, voxel_graph
from polycubes import polycubes
from typer.testing import CliRunner

import lineup as lu

sys.path.append(str(Path(__file__).parents[1] / "benchmarks"))

import appearance
import boxes
import folding
import joining
import motion
import orientation
import others
import paths
import peers
import ratios
import shell
import slots
import stages
import strength


def run(*arguments, app=paths.app):
    result = CliRunner().invoke(app, [str(a) for a in arguments])
    assert result.exit_code == 0, result.output
    return result.output


def test_peers_on_tiny_solids(tmp_path):
    methods = ["layered", "refined", *peers.PEERS]
    chosen = [word for method in methods for word in ("--method", method)]
    run("peers", "--solid", "ball", "--voxels", 40, "--out", tmp_path, *chosen)
    table = pd.read_csv(tmp_path / "paths.csv").set_index("method")
    assert sorted(table.index) == sorted(methods)
    assert not table["note"].fillna("").str.contains("refused").any()
    ran = table[table["path"] > 0]
    assert {"layered", "refined", "networkx depth-first", "networkx tour"} <= set(ran.index)
    assert (ran["coverage"] <= ran["bound"]).all()
    assert ran.loc["refined", ["coverage", "surface"]].tolist() == [1, 1]
    assert ran.loc["layered", "seconds_to_layered"] == 1
    assert "| networkx tour" in (tmp_path / "paths.md").read_text()


def test_growth_on_tiny_solids(tmp_path):
    run("growth", "--voxels", 8, "--voxels", 40, "--method", "refined", "--out", tmp_path)
    table = pd.read_csv(tmp_path / "growth.csv")
    assert (table["visited"] == 8 * table["voxels"]).all()
    assert len(table) == 2
    assert (tmp_path / "growth.png").stat().st_size > 1000
    assert pd.read_csv(tmp_path / "exponents.csv")["method"].tolist() == ["refined"]


def test_coverage_on_a_tiny_solid(tmp_path):
    methods = ["--method", "layered", "--method", "ufree"]
    run("coverage", "--solid", "ball", "--voxels", 16, "--voxels", 24, *methods, "--out", tmp_path)
    table = pd.read_csv(tmp_path / "coverage.csv")
    ball = paths.solid_of("ball", 16)
    bound = lu.path_bound(ball, u_free=True) / ball.size
    row = table[(table["method"] == "ufree") & (table["target"] == 16)].iloc[0]
    assert (row["bound"], row["gap"]) == (bound, bound - row["coverage"])
    medians = pd.read_csv(tmp_path / "medians.csv")
    assert medians["models"].tolist() == [1] * 4
    assert medians["refused"].tolist() == [0] * 4
    assert medians["median_coverage"].tolist() == table["coverage"].tolist()


def test_motions_on_a_tiny_solid(tmp_path):
    run("--solid", "duck", "--voxels", 30, "--steps", 20, "--out", tmp_path, app=motion.app)
    table = pd.read_csv(tmp_path / "motion.csv").set_index("method")
    assert table.index.tolist() == ["energy", "barrier", "peel", "growth"]
    assert table.loc["growth", ["certified", "end"]].tolist() == [True, "straight"]
    assert (table["paper_hours"] == 24).all()
    assert (table["seconds_per_step"] * table["steps"].clip(1)).tolist() == pytest.approx(
        table["seconds"].tolist()
    )
    assert (tmp_path / "motion.png").stat().st_size > 1000


def test_folding_on_a_tiny_solid(tmp_path):
    chosen = ["--solid", "ball", "--voxels", 40, "--voxels", 60]
    run("coverage", *chosen, "--out", tmp_path, app=folding.app)
    table = pd.read_csv(tmp_path / "folding.csv")
    assert table["certified"].all()
    assert (table["coverage"] <= table["bound"]).all()
    assert np.allclose(table["gap"], table["bound"] - table["coverage"])
    ball = paths.solid_of("ball", 40)
    again = lu.fold(ball).path
    assert table["coverage"][0] == again.coverage(ball)
    medians = pd.read_csv(tmp_path / "folding_medians.csv")
    assert medians["certified"].tolist() == medians["models"].tolist() == [1, 1]
    assert medians["median_coverage"].tolist() == table["coverage"].tolist()


def test_layered_paths_peeled_on_a_tiny_solid(tmp_path):
    run("layered", "--solid", "ball", "--voxels", 40, "--out", tmp_path, app=folding.app)
    table = pd.read_csv(tmp_path / "layered.csv")
    assert table["limbs"].tolist() == [False, True]
    path = lu.layered_path(paths.solid_of("ball", 40))
    alone = lu.unfold(path, "peel", rounds=0)
    assert table["straight"][0] == table["certified"][0] == alone.straight
    assert table["straight"][1] >= table["straight"][0]


def test_strength_on_a_tiny_solid(tmp_path):
    chosen = ["--model", "duck", "--voxels", 40, "--moments", 3]
    run(*chosen, "--out", tmp_path, "--pictures", tmp_path, app=strength.app)
    table = pd.read_csv(tmp_path / "strength.csv")
    assert table["how"].tolist() == list(strength.HOW) * 2
    assert table["path"].tolist() == ["layered"] * 3 + ["growth"] * 3
    assert (table["paper_kpa"] == 3.314).all()
    path = lu.layered_path(lu.model("duck", voxels=40))
    held = lu.strength(path, bonding="solid", held="-z")
    assert table["tension_pa"][0] == pytest.approx(held.table["traction_pa"].max(), rel=1e-5)
    assert "What the paper does not give" in (tmp_path / "strength.md").read_text()
    assert pd.read_csv(tmp_path / "standing.csv")["move"].min() == 0
    assert (tmp_path / "strength.png").stat().st_size > 1000


def test_a_slow_method_ends(tmp_path):
    sizes = ["--voxels", 8, "--voxels", 40, "--voxels", 60]
    run("growth", *sizes, "--method", "refined", "--limit", 0, "--out", tmp_path)
    assert len(pd.read_csv(tmp_path / "growth.csv")) == 1


def test_exponents_of_known_powers():
    n = np.array([100, 1000, 10_000])
    runs = [
        pd.DataFrame({"method": f"n^{b}", "voxels": n, "seconds": 0.02 * (n / 100.0) ** b})
        for b in (1, 2)
    ]
    fits = paths.exponents(pd.concat([*runs, pd.DataFrame({"method": ["quick"], "seconds": 1e-4})]))
    assert fits["runs"].tolist() == [3, 3, 0]
    np.testing.assert_allclose(fits["exponent"], [1, 2, np.nan], atol=1e-9)


def test_unknown_methods_are_refused():
    result = CliRunner().invoke(paths.app, ["growth", "--method", "LKH"])
    assert result.exit_code == 2
    assert "unknown method 'LKH'" in result.output


@pytest.mark.parametrize("seed", range(20))
def test_the_longest_unbroken_part_of_a_tour(seed):
    """Against a plain walk around a tour of random breaks."""
    rng = np.random.default_rng(seed)
    gaps = rng.random(12) < rng.random()
    tour = np.zeros((12, 3), int)
    tour[1:, 0] = np.cumsum(1 + gaps)[:-1]
    part, _ = peers.unbroken(tour)
    n = len(tour)
    apart = [np.abs(tour[(k + 1) % n] - tour[k]).sum() > 1 for k in range(n)]
    longest = max(next((m + 1 for m in range(n) if apart[(k + m) % n]), n) for k in range(n))
    assert len(part) == longest
    assert (np.abs(np.diff(part, axis=0)).sum(axis=1) == 1).all()


def test_peers_find_paths_and_cp_sat_the_longest():
    pytest.importorskip("ortools")
    occupancy = np.ones((3, 3, 2), bool)
    occupancy[[0, 2], [0, 0], 1] = False
    occupancy[1, 1] = False
    solid = lu.VoxelSolid(occupancy)
    graph = voxel_graph(occupancy)
    longest, note = peers.cp_sat(solid)
    assert note == "proved longest"
    assert len(longest) == longest_path(graph)
    for peer in (peers.cp_sat, peers.depth_first, peers.tour_search):
        found = [tuple(v) for v in peer(solid)[0].tolist()]
        assert nx.is_simple_path(graph, found)
        assert len(found) <= len(longest)


@pytest.mark.parametrize("voxels", [8, 40, 1000, 30_000])
def test_balls_have_about_the_size_asked_for(voxels):
    assert 0.7 * voxels <= paths.solid_of("ball", voxels).size <= voxels


def test_slots_on_a_tiny_solid(tmp_path):
    run("--solid", "ball", "--voxels", 60, "--out", tmp_path, app=slots.app)
    table = pd.read_csv(tmp_path / "slots.csv").set_index("plan")
    assert table["certified"].all()
    assert (table["certified_slotted"] == (table["against"] == 0)).all()
    free, anew, slotted = (
        table.loc[p] for p in ("growth", "its path planned anew", "slotted growth")
    )
    assert free["against"] > 0
    assert slotted["against"] == 0
    assert anew["path"] == free["path"]
    assert anew["share"] == anew["against"] / anew["moves"]
    assert "| slotted growth" in (tmp_path / "slots.md").read_text()


def test_boxes_on_a_tiny_one(tmp_path, monkeypatch):
    monkeypatch.setattr(boxes, "BOXES", ((3, 2, 2),))
    run("--solid", "duck", "--solid", "nothing", "--out", tmp_path, app=boxes.app)
    duck, nothing = pd.read_csv(tmp_path / "boxes.csv").to_dict("records")
    assert (duck["voxels"], duck["blocks"], duck["certified"]) == (12, 6, True)
    assert duck["solid_voxels"] >= 12
    assert duck["moves"] > 0
    assert duck["clearance"] >= 0.999
    assert not nothing["certified"]
    assert "nothing" in nothing["reason"]


@pytest.mark.slow
def test_orientations_on_a_tiny_solid(tmp_path):
    chosen = ["--model", "duck", "--voxels", 60, "--evaluations", 7, "--finalists", 2]
    run(*chosen, "--out", tmp_path, app=orientation.app)
    row = pd.read_csv(tmp_path / "orientations_gain.csv").iloc[0]
    table = pd.read_csv(tmp_path / "orientations.csv")
    assert row["evaluations"] == len(table) == 7
    assert row["kind"] == table["kind"][0]
    solid = lu.model("duck", 60)
    assert row["layered_upright"] == pytest.approx(orientation.layered(solid), abs=1e-6)
    assert row["gain_folded"] == pytest.approx(
        row["folded_chosen"] - row["folded_upright"], abs=2e-6
    )
    assert not {orientation.CHOSEN_ON} & {*orientation.REPORTED_ON, *orientation.FOLDED_ON}


@pytest.mark.slow
def test_shells_and_appearance_on_a_tiny_solid(tmp_path):
    for app in (shell.app, appearance.app):
        run("--model", "duck", "--voxels", 120, "--out", tmp_path, app=app)
    shells = pd.read_csv(tmp_path / "shell.csv").set_index("what")
    assert (shells["saved"].dropna() >= 0).all()
    assert "no thinner than the solid" in shells.loc["shell of 2", "reason"]
    looks = pd.read_csv(tmp_path / "appearance.csv")
    assert looks["stage"].tolist() == ["solid", "layered", "folded", "trimmed"]


def test_tables_grow_model_by_model(tmp_path):
    file = tmp_path / "grown.csv"
    for name, value in (("a", 1), ("b", 2), ("a", 3)):
        table = joining.joined(pd.DataFrame([{"model": name, "value": value}]), file)
    assert table["model"].tolist() == ["b", "a"]
    pd.testing.assert_frame_equal(table, pd.read_csv(file))
    assert table["value"].tolist() == [2, 3]


ALL = list(dict.fromkeys(contest.stage for contest in ratios.CONTESTS))


@pytest.mark.parametrize(
    "stages", [["bound", "certification"], pytest.param(ALL, marks=pytest.mark.slow)]
)
def test_ratios_on_tiny_solids(stages, tmp_path):
    chosen = [word for stage in stages for word in ("--stage", stage)]
    run("--scale", 0.02, "--repeats", 2, "--out", tmp_path, *chosen, app=ratios.app)
    table = pd.read_csv(tmp_path / "benchmarks.csv")
    assert len(table) == sum(contest.stage in stages for contest in ratios.CONTESTS)
    ran = table[table["runs"] > 0]
    assert set(table["peer"]) - set(ran["peer"]) <= {"LKH"}  # of another licence
    assert (ran["least"] <= ran["most"]).all()
    assert ran["theirs"].str.len().gt(0).all()
    bound = ran[ran["stage"] == "bound"].iloc[0]
    assert bound["ours"] == bound["theirs"]
    page = (tmp_path / "benchmarks.md").read_text()
    assert "numpy 2" in page
    assert (tmp_path / "benchmarks.png").stat().st_size > 1000


def test_a_side_that_does_a_share_of_the_job_is_scaled():
    _, seconds = ratios.timed(ratios.Side(lambda: str(time.sleep(0.02)), share=0.1))
    assert seconds >= 0.2


def test_stages_on_tiny_solids_stop_where_they_are_told(tmp_path):
    run("--voxels", 40, "--voxels", 80, "--limit", 1e-9, "--out", tmp_path, app=stages.app)
    table = pd.read_csv(tmp_path / "stages.csv")
    assert set(table["voxels"]) == {40}
    assert {"voxelize", "layered path", "fold", "certify", "strength"} <= set(table["method"])
    assert (tmp_path / "stages.png").stat().st_size > 1000


@given(polycubes())
def test_the_flow_of_networkx_is_the_bound(occupancy):
    solid = lu.VoxelSolid(occupancy)
    assert others.flow_bound(solid) == lu.path_bound(solid)


def test_elements_shorten_a_column_under_its_own_weight():
    column = np.array([(x, y, z) for x in range(2) for y in range(2) for z in range(12)])
    sag = others.by_elements(column, 10.0)
    assert sag == pytest.approx(1e3 * 1130 * 9.81 * 0.12**2 / 2 / 2.6e9, rel=0.05)


def test_peers_of_the_judge_see_bars_that_meet():
    apart = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float)
    near = apart.copy()
    near[3] = (0.5, 0.5, 0)
    assert others.sampled_clearance(apart) == pytest.approx(1)
    assert others.sampled_clearance(near) == pytest.approx(0.5, abs=0.01)
    assert not others.ccd_finds_contact(apart, apart, 0.98)
    assert others.ccd_finds_contact(apart, near, 0.98)
