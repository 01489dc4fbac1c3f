"""Bodies while they are folded, the pictures of what they bear, and the command."""

import re

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from strands import LEANING, boustrophedon, path

import lineup as lu
from lineup import cli, draw
from lineup.draw import render
from lineup.kinematics import QUARTER, Move
from lineup.solid import Motion
from lineup.stress.through import COLUMNS, body_of


@pytest.fixture(scope="module")
def solid():
    return lu.VoxelSolid(np.ones((4, 3, 4), bool), name="box")


@pytest.fixture(scope="module")
def folding(solid):
    return lu.fold(solid, rounds=30, trial_rounds=5)


@pytest.fixture
def plain(monkeypatch):
    """Pictures by matplotlib, which is quick for small ones."""
    monkeypatch.setattr(render, "renderer", lambda: "matplotlib")


def motion(voxels, *moves, **more):
    return Motion(np.asarray(voxels), np.array(moves), 0.999, 90.0, False, "by hand", **more)


HOOK = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1), (1, 0, 1), (1, 1, 1)]


def test_a_row_is_the_strength_of_the_body_at_that_moment(folding):
    n = len(folding.motion)
    moves = [n // 2, 0, 2, n]
    table = lu.standing(folding, moves, 8.0, density=900)
    assert table["move"].tolist() == moves
    assert table.columns.tolist() == COLUMNS
    poses = list(lu.frames(folding.motion))
    for row in table.to_dict("records"):
        pose = np.rint(poses[row["move"]]).astype(int)
        sides = [row[f"box_{axis}_mm"] for axis in "xyz"]
        assert sides == ((np.ptp(pose, axis=0) + 1) * 8.0).tolist()
        if row["move"] == n:
            assert (row["folded"], row["reason"]) == (0, "nothing is folded")
            assert np.isnan(row["safety"])
            continue
        body = pose[row["first"] : row["last"] + 1]
        assert row["folded"] == len(body)
        alone = lu.strength(path(body), None, 8.0, density=900)
        assert (row["stands"], row["reason"]) == (alone.stands, alone.reason)
        assert row["margin_mm"] == pytest.approx(alone.margin_mm)
        below = (body[:, 2].min() - pose[:, 2].min()) * 8.0
        assert row["below_mm"] == below
        if row["first"] % 2 == 0:  # else hinges and printed pieces change places
            assert row["safety"] == pytest.approx(alone.safety)


def test_the_whole_is_folded_at_first_and_less_later(folding):
    table = lu.standing(folding, 7)
    assert table["folded"].iloc[0] == len(folding.path)
    assert table["folded"].is_monotonic_decreasing
    assert table["move"].tolist()[::6] == [0, len(folding.motion)]
    whole = lu.strength(folding)
    assert table["safety"].iloc[0] == whole.safety
    assert table["worst"].iloc[0] == whole.worst_face


def test_an_odd_body_starts_with_a_printed_piece():
    """A peel of the first bar leaves a body from joint 1 on."""
    peeled = motion(HOOK, (Move.PEEL, 1, 0, 5))
    row = lu.standing(peeled, [1]).iloc[0]
    assert (row["first"], row["last"]) == (1, 7)
    pose = [(1, 0, -1), *HOOK[1:]]
    shifted = lu.strength(path([(2, 0, 0), *pose[1:]]))  # its first voxel makes no difference
    kinds = shifted.table.set_index(["first", "second"])["kind"]
    assert kinds.loc[(1, 2)] == "printed"
    assert re.search(r"(\d+)–(\d+)|under", row["worst"])


def test_rods_that_nobody_carries_weigh_on_the_body():
    """A block of eight voxels with a rod of four: carried, it stands; free, it tips."""
    rod = [(x, 1, 1) for x in range(2, 7)]
    pose = HOOK + rod
    still = motion(pose, (Move.SWING, 7, 8, 1), (Move.SWING, 7, 8, 0))
    carried, free = (lu.standing(still, [0], rods=rods).iloc[0] for rods in ("carried", "free"))
    assert carried["folded"] == len(pose)  # at first every joint is in its place
    turned = [lu.standing(still, [1], rods=rods).iloc[0] for rods in ("carried", "free")]
    assert [row["folded"] for row in turned] == [8, 8]
    assert [row["stands"] for row in turned] == [True, False]
    assert turned[0]["margin_mm"] == pytest.approx(10.0)
    centre = (8 * 0.5 + sum(range(2, 7))) / 13
    assert turned[1]["margin_mm"] == pytest.approx(10 * (1.5 - centre))
    assert free["margin_mm"] == turned[1]["margin_mm"]


def test_a_rod_that_hangs_lower_is_told():
    down = motion(HOOK, (Move.PEEL, 1, 0, 5))
    assert lu.standing(down, [0, 1])["below_mm"].tolist() == [0.0, 10.0]


def test_what_is_the_body():
    folded = np.array(HOOK)
    assert body_of(folded, folded) == (0, 7)
    line = np.array([(x, 0, 0) for x in range(8)])
    assert body_of(line, folded) == (-1, -1)
    away = folded + np.array([0, 0, 3])  # nothing is in its place, so the end bars count as rods
    assert body_of(away, folded) == (1, 6)
    one_corner = np.array([(0, 0, 0), (1, 0, 0), (2, 0, 0), (2, 1, 0), (2, 2, 0)])
    assert body_of(one_corner, one_corner + 9) == (2, 3)


def test_what_cannot_be_looked_at_is_refused():
    hook = motion(HOOK, (Move.PEEL, 1, 0, 5))
    with pytest.raises(ValueError, match="from 0 to 1, got 2"):
        lu.standing(hook, [0, 2])
    with pytest.raises(ValueError, match="at least 2 poses"):
        lu.standing(hook, 1)
    with pytest.raises(ValueError, match=r"rods must be one of .* got 'held'"):
        lu.standing(hook, rods="held")
    angles = np.array([[0, QUARTER], [0, QUARTER // 2]])
    bent = motion([(0, 0, 0), (1, 0, 0), (1, 1, 0)], (Move.BEND, 2, 0, 1), angles=angles)
    with pytest.raises(ValueError, match="after move 1 lies between lattice poses"):
        lu.standing(bent, [1])


# Pictures


def reddish(picture):
    red, blue = picture[..., 0].astype(int), picture[..., 2].astype(int)
    return (red - blue > 60).mean()


@pytest.mark.usefixtures("plain")
def test_the_picture_shows_what_is_borne():
    result = lu.strength(path(boustrophedon(6, 2, 2)), held="-x")
    figure = draw.strength(result)
    head, whole, cut, bar = figure.axes
    text = " ".join(t.get_text() for t in head.texts)
    assert "held at -x" in text
    assert result.worst_face in text
    assert bar.get_xlim() == pytest.approx((0, result.table["tension_pa"].max() / 1e3))
    assert len(cut.lines) == 1
    assert not whole.lines
    calm = draw.strength(lu.strength(path(boustrophedon(6, 2, 2))))
    assert reddish(whole.get_images()[0].get_array()) > 0
    assert "feet" in calm.axes[0].texts[1].get_text()


@pytest.mark.usefixtures("plain")
def test_the_ring_is_round_the_worst_face():
    """Where the ring is, the picture has the colour of the largest tension."""
    result = lu.strength(path([(x, 0, 0) for x in range(9)]), held="-x")
    cut = draw.strength(result).axes[2]
    (x,), (y,) = cut.lines[0].get_data()
    image = np.asarray(cut.get_images()[0].get_array())
    near = image[int(y) - 3 : int(y) + 4, int(x) + 2 : int(x) + 9].reshape(-1, 3).mean(axis=0)
    assert near[0] < 170  # the dark end of the colours, on a light page
    assert near[0] > near[1] + 20


@pytest.mark.usefixtures("plain")
def test_equal_pictures_are_equal_bytes(tmp_path):
    files = [
        draw.save(draw.strength(lu.strength(LEANING)), tmp_path / f"{k}.png") for k in range(2)
    ]
    assert files[0].read_bytes() == files[1].read_bytes()


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize("up", ["-y", "+x", (1.0, 1.0, 1.0)])
def test_any_way_up_is_drawn(up):
    result = lu.strength(path(boustrophedon(2, 2, 2)), up=up)
    if result.stands:
        assert isinstance(draw.strength(result), Figure)
    else:
        with pytest.raises(ValueError, match="no balance to draw: the body tips over"):
            draw.strength(result)


def test_the_curve_counts_what_stands(folding):
    table = lu.standing(folding, 6)
    figure = draw.standing(table)
    some = table[table["folded"] > 0]
    title = figure.axes[0].get_title()
    assert title.endswith(f"at {some['stands'].sum()} of {len(some)} moments")


# The command


@pytest.fixture
def stored(folding, solid, tmp_path):
    lu.save(solid, tmp_path / "box.solid.json")
    return lu.save(folding, tmp_path / "box.folding.json")


@pytest.mark.usefixtures("plain")
def test_the_command_writes_what_it_found(stored, tmp_path, capsys):
    out = tmp_path / "out"
    assert cli.run(["strength", str(stored), "--out", str(out), "--through", "3"]) == 0
    said = capsys.readouterr().out
    assert "model: box" in said
    assert "while folded: stands at" in said
    names = sorted(file.name for file in out.iterdir())
    kinds = ("standing", "strength")
    assert names == sorted(f"box.{k}.{e}" for k in kinds for e in ("csv", "md", "png"))
    table = pd.read_csv(out / "box.strength.csv")
    result = lu.strength(lu.load(stored))
    assert table["safety"].min() == pytest.approx(result.safety, rel=1e-3)
    assert len(table) == len(result.table)
    assert f"| {result.worst_face}" in (out / "box.strength.md").read_text()
    first = {file.name: file.read_bytes() for file in out.iterdir()}
    assert cli.run(["strength", str(stored), "--out", str(out), "--through", "3"]) == 0
    assert first == {file.name: file.read_bytes() for file in out.iterdir()}


@pytest.mark.usefixtures("plain")
def test_the_command_says_what_falls_short(stored, tmp_path, capsys):
    assert cli.run(["strength", str(stored), "--out", str(tmp_path), "--density", "9e7"]) == 1
    assert "gives way, at a safety factor of 0." in capsys.readouterr().err
    hook = path([(0, 0, 0), (0, 0, 1), (0, 0, 2), *((x, 0, 2) for x in range(1, 6))])
    file = lu.save(hook, tmp_path / "hook.path.json")
    assert cli.run(["strength", str(file), "--out", str(tmp_path)]) == 1
    assert "hook: tips over" in capsys.readouterr().err
    assert (tmp_path / "hook.strength.csv").is_file()
    assert not (tmp_path / "hook.strength.png").exists()
    assert (
        cli.run(["strength", str(file), "--out", str(tmp_path), "--up=-z"]) == 0
    )  # it lies on its arm


def test_bad_use_of_the_command(stored, tmp_path, capsys):
    solid = tmp_path / "box.solid.json"
    line = lu.save(path([(0, 0, 0), (1, 0, 0)]), tmp_path / "line.path.json")
    cases = {
        ("strength", str(solid)): "holds a VoxelSolid, and a folding or path is needed",
        ("strength", str(line), "--through", "3"): "--through needs a folding",
        ("strength", str(stored), "--bonding", "glue"): "unknown bonding 'glue'",
        ("strength", str(stored), "--pitch-mm", "-1"): "pitch_mm must be positive",
        ("strength", str(tmp_path / "none.path.json")): "no file",
    }
    for arguments, words in cases.items():
        assert cli.run([*arguments, "--out", str(tmp_path)]) == 2
        assert words in capsys.readouterr().err
