"""From one model to a folder with all that it takes, and chains that printed blocks can be."""

import json

import numpy as np
import pandas as pd
import pytest

import lineup as lu
from lineup import cli, draw
from lineup.grid import DIRECTIONS, LETTERS
from lineup.manual.turns import with_few_turns


@pytest.fixture(scope="module")
def kit(tmp_path_factory):
    """A folder that `lineup kit` filled, and what it said at the end."""
    folder = tmp_path_factory.mktemp("kit")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(draw.render, "renderer", lambda: "matplotlib")  # quick for small pictures
        code = cli.run(["kit", "duck", "--blocks", "20", "--out", str(folder)])
    return folder, code


def test_everything_is_there(kit):
    folder, code = kit
    assert code == 0
    for name in (
        *("duck.solid.json", "duck.folding.json", "chains.png", "print/chain.3mf"),
        *("print/parts.md", "duck.manual.pdf", "duck.manual.csv", "duck.strength.md"),
        *("duck.strength.png", "duck.standing.csv", "duck.html"),
    ):
        assert (folder / name).stat().st_size > 0, name


def test_the_chain_is_one_that_printed_blocks_can_be(kit):
    folding = lu.load(kit[0] / "duck.folding.json")
    assert lu.certify(folding.motion, joints="slotted").ok
    assert "certified" in (kit[0] / "duck.html").read_text()


@pytest.mark.parametrize("kind", ["json", "csv"])
def test_its_manual_read_back_is_its_motion_and_certified_for_slots(kit, kind):
    folding = lu.load(kit[0] / "duck.folding.json")
    again = lu.read_manual(kit[0] / f"duck.manual.{kind}")
    assert np.array_equal(again.path.voxels, folding.path.voxels)
    assert np.array_equal(again.motion.moves, with_few_turns(folding.motion).moves)
    verdict = lu.certify(again.motion, joints="slotted")
    assert (verdict.ok, verdict.violations) == (True, 0)
    rows = pd.read_csv(kit[0] / "duck.manual.csv", keep_default_na=False)
    assert set(rows["manner"]) > {"hinge first"}
    assert json.loads((kit[0] / "duck.manual.json").read_text())["verdict"]["joints"] == "slotted"


@pytest.mark.parametrize("manner", ["straighten", "hinge first"])
def test_a_manual_that_lost_a_manner_is_refused(kit, tmp_path, manner):
    lines = (kit[0] / "duck.manual.csv").read_text().splitlines(keepends=True)
    lost = next(k for k, line in enumerate(lines) if f",{manner}," in line)
    lines[lost] = lines[lost].replace(f",{manner},", ",,")
    (tmp_path / "lost.csv").write_text("".join(lines))
    with pytest.raises(ValueError, match=f"row {lost}: (twists|manner) is "):
        lu.read_manual(tmp_path / "lost.csv")


def test_what_cannot_be_folded_ends_it(tmp_path, capsys):
    code = cli.run(["kit", "no-such-model", "--out", str(tmp_path)])
    assert code == 2
    assert "no file and no model" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_design_for_slots_is_judged_for_slots():
    design = lu.lineup(["duck"], blocks=30, joints="slotted")
    assert [c.ok and c.violations == 0 for c in design.certificates] == [True]
    free = lu.lineup(["duck"], blocks=30)
    assert lu.certify(free.foldings[0].motion, joints="slotted").violations > 0


def test_joints_of_no_known_kind_are_refused():
    with pytest.raises(ValueError, match="joints must be one of"):
        lu.lineup(["duck"], blocks=30, joints="rubber")


def test_whether_it_stands_is_told_for_each_step_of_the_manual(kit):
    steps = lu.standing_by_step(kit[0] / "duck.manual.json")
    told = pd.read_csv(kit[0] / "duck.standing.csv")
    assert told["step"].tolist() == list(range(1, len(steps) + 1))
    assert told["folded"].iloc[-1] == 40
    assert told["folded"].is_monotonic_increasing
    assert told["stands"].tolist() == steps["stands"].tolist()
    down = json.loads((kit[0] / "duck.manual.json").read_text())["build"]["down"]
    up = tuple(-DIRECTIONS[LETTERS.index(down)])
    whole = lu.strength(lu.load(kit[0] / "duck.folding.json"), up=up)
    assert told["margin_mm"].iloc[-1] == pytest.approx(whole.margin_mm, abs=1e-3)
    with pytest.raises(ValueError, match=r"has no steps; give the NAME\.manual\.json"):
        lu.standing_by_step(kit[0] / "duck.manual.csv")
