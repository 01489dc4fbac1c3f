"""Animations: as many pictures as asked for, whole files, the right moments."""

import itertools
import sys

import numpy as np
import pytest
from PIL import Image

import lineup as lu
from lineup import draw
from lineup.draw.story import scenes_of
from lineup.kinematics import Move

CORNER = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (1, 2, 0)])
UNFOLDS = lu.Motion(CORNER, np.array([(Move.SWING, 1, 2, 0)]), 1.0, 90.0, True, "straight")


@pytest.fixture(autouse=True)
def plain(monkeypatch):
    """Pictures by matplotlib, which is quick for small ones."""
    monkeypatch.setattr(draw.render, "renderer", lambda: "matplotlib")


def pictures_of(file):
    with Image.open(file) as film:
        return [np.asarray((film.seek(k), film.convert("RGB"))[1]) for k in range(film.n_frames)]


def test_few_moves_are_shown_in_between(tmp_path):
    film = pictures_of(draw.animation(UNFOLDS, tmp_path / "a.gif", pictures=5))
    assert len(film) == 5
    for one, next_one in itertools.pairwise(film):
        assert (one != next_one).any()


def test_many_moves_are_sampled(tmp_path):
    there_and_back = np.array([(Move.SWING, 1, 2, 0), (Move.SWING, 1, 2, 1)] * 6)
    motion = lu.Motion(CORNER, there_and_back, 1.0, 90.0, False, "", goal=CORNER)
    film = pictures_of(draw.animation(motion, tmp_path / "b.gif", pictures=4, seconds=1))
    assert len(film) == 4


def test_equal_motions_give_equal_bytes(tmp_path):
    files = [draw.animation(UNFOLDS, tmp_path / name, pictures=3) for name in ("c.gif", "d.gif")]
    assert files[0].read_bytes() == files[1].read_bytes()
    assert [file.name for file in tmp_path.iterdir() if file.suffix != ".gif"] == []


def folded(shape, ends=2):
    solid = lu.VoxelSolid(np.ones(shape, bool))
    return lu.fold(solid, rounds=50, trial_rounds=10, ends=ends)


def test_either_shape_stands_upright_on_the_way_from_one_to_the_other():
    a, b = folded((4, 2, 1)), folded((2, 2, 2))
    scenes = list(scenes_of(lu.transform(a, b), 9))
    assert np.array_equal(scenes[0][0].pose, a.path.voxels)
    np.testing.assert_allclose(scenes[-1][0].pose, b.path.voxels, atol=1e-9)
    titles = [moment.title for moment, _ in scenes]
    assert (titles[0], titles[-1]) == ("folded", "folded anew")
    assert any("still folded" in title for title in titles)
    assert all(
        "still folded" not in t for t in itertools.dropwhile(lambda t: "anew" not in t, titles)
    )
    assert scenes[-1][1] is not scenes[0][1]


def test_a_way_without_the_line_is_all_in_sight():
    a, b = folded((4, 3, 2), ends=1), folded((2, 3, 4), ends=1)
    motion = lu.transform(a, b, within=(18, 18, 18))
    assert lu.certify(motion, within=(18, 18, 18)).ok
    scenes = list(scenes_of(motion, 12))
    assert [moment.title for moment, _ in scenes][1:-1] == ["from shape to shape"] * 10
    for moment, view in scenes:
        assert (np.abs(view.seen(moment.pose)[:, :2]) <= view.half_height).all()


def test_a_film_for_other_players(tmp_path):
    ffmpeg = pytest.importorskip("imageio_ffmpeg", reason="the extra 'video' is not installed")
    film = draw.animation(UNFOLDS, tmp_path / "g.mp4", pictures=6, seconds=1)
    pictures, seconds = ffmpeg.count_frames_and_secs(str(film))
    assert pictures == 6 + 2 * 6  # the first and the last stay a second longer
    assert seconds == pytest.approx(3, abs=0.2)


def test_without_its_package_no_film_for_other_players(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(ValueError, match=r"imageio-ffmpeg.*\.gif"):
        draw.animation(UNFOLDS, tmp_path / "h.mp4", pictures=2)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("options", "words"),
    [({"pictures": 1}, "2 pictures"), ({"seconds": 0}, "some time")],
)
def test_no_film_without_pictures_or_time(tmp_path, options, words):
    with pytest.raises(ValueError, match=words):
        draw.animation(UNFOLDS, tmp_path / "e.gif", **options)


def test_other_kinds_of_file_are_refused(tmp_path):
    with pytest.raises(ValueError, match=r"\.gif or \.mp4, got 'f\.png'"):
        draw.animation(UNFOLDS, tmp_path / "f.png", pictures=2)
