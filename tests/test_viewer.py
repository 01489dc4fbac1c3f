"""The player: its poses beside NumPy's, and the page that holds it."""

import dataclasses
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from test_kinematics import MOTIONS

import lineup as lu
from lineup import cli, kinematics, viewer
from lineup.grid import bar_directions
from lineup.kinematics import Move
from lineup.storage import document
from lineup.viewer import page, widget

MODULES = Path(viewer.__file__).parent
NODE = shutil.which("node")


def block(*shape):
    return lu.VoxelSolid(np.ones(shape, bool))


@pytest.fixture(scope="module")
def folding():
    return lu.fold(block(4, 3, 3), rounds=50, trial_rounds=10)


@pytest.fixture(scope="module")
def motions(folding):
    """At least one motion with each kind of move, short ones by hand and planned ones."""
    flat = lu.layered_path(block(4, 4, 1))
    other = lu.fold(block(6, 6, 1), rounds=50, trial_rounds=10)
    pulls = [lu.fold(block(*shape), method="pull") for shape in ((4, 4, 3), (6, 4, 2))]
    pulled = [f.motion for f in lu.trim(pulls)]
    return {
        **MOTIONS,
        "peel_fold": folding.motion,
        "from_shape_to_shape": lu.transform(*lu.trim([folding, other])),
        "accordion": lu.unfold(flat, method="accordion"),
        "energy": lu.unfold(lu.layered_path(block(3, 3, 2)), method="energy", steps=30),
        "bends": bends_about_all_axes(),
        "pulled": pulled[0],
        "pulled_by_the_first": lu.transform(*pulled),
    }


def bends_about_all_axes():
    """Two bends off the lattice and back on it, about each axis, and a swing before the next."""
    start, moves, angles = MOTIONS["peel"].start, [], []
    for axis in range(3):
        codes = words(start, moves, angles)
        around = [(axis + 1) % 3, (axis + 2) % 3, (axis + 1) % 3 + 3, (axis + 2) % 3 + 3]
        row = np.array(
            [kinematics.QUARTER * around.index(d) if d % 3 != axis else 0 for d in codes]
        )
        across = np.array([d % 3 != axis for d in codes])
        turned = np.arange(1, 7) * 40_000 * across
        angles += [row, row + turned, row - kinematics.QUARTER * across]
        k = len(angles) - 3
        moves += [(Move.BEND, axis, k, k + 1), (Move.BEND, axis, k + 1, k + 2)]
        bar = int(words(start, moves, angles)[2])
        moves.append((Move.SWING, 2, 3, (bar + 1) % 6))
    return bent(start, moves, angles)


def bent(start, moves, angles):
    rows = np.array(moves, np.int32).reshape(-1, 4)
    table = np.array(angles, np.int32).reshape(len(angles), len(start) - 1 if angles else 0)
    return lu.Motion(start, rows, 1.0, 90.0, False, "by hand", angles=table)


def words(start, moves, angles):
    *_, last = lu.frames(bent(start, moves, angles))
    return bar_directions(np.rint(last).astype(int))


def golden(motion, rng):
    """Poses at whole moves and between, by `frames` and `moved`, at times in random order."""
    before = list(lu.frames(motion))
    times = [0.0, float(len(motion)), *(k + float(rng.random()) for k in range(len(motion)))]
    times += rng.integers(0, len(motion) + 1, 10).tolist()
    chosen = rng.permutation(times)[:60]
    return [{"time": t, "pose": pose_at(motion, before, t).tolist()} for t in chosen.tolist()]


def pose_at(motion, before, time):
    k = int(time)
    if k == time:
        return before[k]
    return kinematics.moved(before[k], motion.moves[k], motion, time - k)


def test_every_kind_of_move_is_compared(motions):
    kinds = np.concatenate([motion.moves[:, 0] for motion in motions.values()])
    assert set(kinds.tolist()) == set(Move)
    heads = {row[1] for m in motions.values() for row in m.moves.tolist() if row[0] == Move.PULL}
    assert len(heads) > 1


@pytest.mark.skipif(NODE is None, reason="node is not installed")
def test_poses_and_words_in_node(motions, tmp_path):
    rng = np.random.default_rng(0)
    for file in MODULES.glob("*.js"):
        shutil.copy(file, tmp_path)
    (tmp_path / "package.json").write_text('{"type": "module"}')
    (tmp_path / "golden.json").write_text(
        json.dumps(
            {
                name: {
                    "motion": document(motion),
                    "poses": golden(motion, rng),
                    "ends_straight": motion.straight,
                }
                for name, motion in motions.items()
            }
        )
    )
    ran = subprocess.run(
        [NODE, "--test", Path(__file__).with_name("player.test.mjs")],
        env=os.environ | {"LINEUP_PLAYER": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert ran.returncode == 0, ran.stdout
    assert int(re.search(r"^# pass (\d+)", ran.stdout, re.M)[1]) > 6 * len(motions)


@pytest.fixture(scope="module")
def written(folding, tmp_path_factory):
    file = tmp_path_factory.mktemp("page") / "block.html"
    return lu.write_player(folding, file, certificate=lu.certify(folding.motion))


def content(file):
    """What a page carries, read as a browser does: to the end of the element, then as JSON."""
    element = re.search(
        r'<script type="application/json" id="shown">(.*?)</script', file.read_text()
    )
    return json.loads(element[1])


def test_the_page_carries_the_motion_as_it_is_stored(written, folding, tmp_path):
    carried = content(written)
    assert carried["name"] == "block"
    assert carried["visits"] == folding.path.visits.tolist()
    assert carried["certificate"]["ok"]
    stored = lu.save(folding.motion, tmp_path / "block.motion.json")
    assert carried["sha256"] == hashlib.sha256(stored.read_bytes()).hexdigest()
    (tmp_path / "carried.motion.json").write_text(json.dumps(carried["motion"]))
    again = lu.load(tmp_path / "carried.motion.json")
    np.testing.assert_array_equal(again.moves, folding.motion.moves)
    np.testing.assert_array_equal(again.start, folding.motion.start)


def test_nothing_outside_the_page_is_needed(written):
    page_text = written.read_text()
    addresses = re.findall(r"[a-z]+://[^\s'\"]+", page_text)
    assert set(addresses) <= {"http://www.w3.org/2000/svg"}  # names a language, is never fetched
    assert not re.findall(
        r"\b(import|importScripts|fetch|XMLHttpRequest|WebSocket|eval)\b *\(", page_text
    )
    assert not re.findall(r"^ *import ", page_text, re.M)
    assert set(re.findall(r'\b(?:src|href)="([^"]{0,15})', page_text)) == {"data:image/svg+"}
    assert "@import" not in page_text
    assert "url(" not in page_text
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page_text)[1]
    assert policy.startswith("default-src 'none';")
    assert "http" not in policy


def test_equal_motions_make_equal_pages(written, folding, tmp_path):
    again = lu.write_player(
        folding, tmp_path / "block.html", certificate=lu.certify(folding.motion)
    )
    assert again.read_bytes() == written.read_bytes()
    assert [file.name for file in tmp_path.iterdir()] == ["block.html"]


def test_a_motion_of_2945_blocks_stays_far_below_a_megabyte(tmp_path):
    """The longest tokens there can be, twice as many as an unfolding of such a chain takes."""
    n_joints = 5890
    zigzag = np.stack(
        [np.arange(n_joints) // 2, (np.arange(n_joints) + 1) // 2, np.zeros(n_joints)]
    )
    moves = [(Move.PEEL, k, k + 1, 2) for k in range(n_joints - 1)] * 2
    motion = lu.Motion(zigzag.T.astype(int), np.array(moves), 0.999, 90.0, False, "made up")
    colours = {"a number": np.linspace(0, 1, n_joints - 1) / 3}
    page_file = lu.write_player(motion, tmp_path / "big.html", colours=colours)
    assert page_file.stat().st_size < 400_000


def test_what_is_said_in_a_name_does_not_end_the_element(folding, tmp_path):
    name = "</script><!--<b>'\"&"
    made = lu.write_player(folding, tmp_path / "x.html", name=name, colours={name: np.zeros(35)})
    assert content(made)["name"] == name
    assert list(content(made)["colours"]) == [name]
    assert name not in made.read_text()
    assert made.read_text().count("</script>") == 2


def test_no_verdict_is_no_certificate(folding, tmp_path):
    made = lu.write_player(folding, tmp_path / "x.html")
    assert content(made)["certificate"] is None


def test_unknown_numbers_of_bars_are_left_out(folding, tmp_path):
    stress = np.full(35, 1 / 3)
    stress[7] = np.nan
    made = lu.write_player(folding.motion, tmp_path / "x.html", colours={"stress, MPa": stress})
    assert content(made)["colours"]["stress, MPa"][6:9] == [0.33333, None, 0.33333]
    assert content(made)["visits"] == []


@pytest.mark.parametrize(
    ("file", "options", "says"),
    [
        ("x.htm", {}, r"written as \.html, got 'x\.htm'"),
        ("x.html", {"colours": {"stress": [1.0] * 36}}, r"'stress' must be 35 numbers.*\(36,\)"),
        (
            "x.html",
            {"certificate": lu.Certificate(True, "certified")},
            "of another motion: 0 moves",
        ),
    ],
)
def test_bad_use_is_refused(folding, tmp_path, file, options, says):
    with pytest.raises(ValueError, match=says):
        lu.write_player(folding, tmp_path / file, **options)
    assert not list(tmp_path.iterdir())


def test_only_motions_are_shown(folding, tmp_path):
    with pytest.raises(ValueError, match="a Motion or a Folding, got a VoxelPath"):
        lu.write_player(folding.path, tmp_path / "x.html")
    still = lu.Motion(np.zeros((1, 3), int), np.empty((0, 4), int), 1.0, 90.0, True, "straight")
    with pytest.raises(ValueError, match="two joints or more, got 1"):
        lu.write_player(still, tmp_path / "x.html")
    with pytest.raises(FileNotFoundError, match="no folder"):
        lu.write_player(folding, tmp_path / "nowhere" / "x.html")


def test_modules_become_one_text():
    """What every module gives is there once, after what it needs, and nothing is imported."""
    bundle = page.script("widget")
    assert not re.search(r"^(import|export (?!default))", bundle, re.M)
    assert bundle.count("export default") == 1
    order = [
        bundle.index(f"\n{line}")
        for line in (
            "async function readMotion(",
            "function storyOf(",
            "class Player ",
            "async function render(",
        )
    ]
    assert order == sorted(order)
    for file in MODULES.glob("*.js"):
        for exported in re.findall(r"^export (.*)$", file.read_text(), re.M):
            assert bundle.count(exported.removesuffix("{")) == 1
    assert "export default" not in page.script("player")


@pytest.mark.skipif(NODE is None, reason="node is not installed")
def test_the_one_text_is_well_formed(tmp_path):
    """No name is given twice, which would be an error only when the page is opened."""
    for module in ("widget", "player"):
        file = tmp_path / f"{module}.mjs"
        file.write_text(page.script(module))
        subprocess.run([NODE, "--check", file], check=True, capture_output=True)


def test_every_file_of_the_player_is_packaged():
    settings = tomllib.loads((MODULES.parents[1] / "pyproject.toml").read_text())
    patterns = settings["tool"]["setuptools"]["package-data"]["lineup.viewer"]
    others = [file for file in MODULES.iterdir() if file.suffix not in {".py", ""}]
    assert others
    assert all(any(file.match(pattern) for pattern in patterns) for file in others)
    assert all(len(file.read_text().splitlines()) <= 450 for file in others)


def test_play_judges_and_writes(folding, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lu.save(folding, "good.folding.json")
    worse = dataclasses.replace(folding.motion, moves=folding.motion.moves[:-1])
    lu.save(worse, "bad.motion.json")
    assert cli.run(["play", "good.folding.json", "--out", "pages"]) == 0
    said = capsys.readouterr().out
    assert "32 moves, certified" in said
    assert content(tmp_path / "pages" / "good.html")["certificate"]["ok"] is True
    assert cli.run(["play", "good.folding.json", "bad.motion.json"]) == 1
    assert "falls short: bad: " in capsys.readouterr().err
    refused = content(tmp_path / "bad.html")["certificate"]
    assert refused["ok"] is False
    assert refused["reason"] == lu.certify(worse).reason
    lu.save(folding.path, "only.path.json")
    assert cli.run(["play", "only.path.json"]) == 2


def test_the_widget_carries_the_same_and_a_still_picture(folding, written):
    pytest.importorskip("anywidget")
    film = lu.player(folding, certificate=lu.certify(folding.motion), name="block")
    assert film.shown == content(written)
    assert (film.time, film.playing, film.picked, film.height) == (0, False, -1, 560)
    data, *_ = film._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in data
    picture = Image.open(BytesIO(data["image/png"]))
    assert picture.width > 600
    assert np.ptp(np.asarray(picture.convert("RGB")).astype(int), axis=-1).max() > 150
    assert film._esm == page.script("widget")
    with pytest.raises(ValueError, match="height must be at least 420 pixels, got 100"):
        lu.player(folding, height=100)


def test_without_anywidget_the_page_is_named(folding, monkeypatch):
    monkeypatch.setitem(sys.modules, "anywidget", None)
    widget._widget_class.cache_clear()
    with pytest.raises(
        ImportError, match=r"pip install 'lineup-workbench\[notebooks\]'.*write_player"
    ):
        lu.player(folding)
