"""Animations: as many pictures as asked for, whole files, the right moments."""

import itertools

import numpy as np
import pytest
from PIL import Image

import lineup as lu
from lineup import draw
from lineup.kinematics import Move

CORNER = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (1, 2, 0)])
UNFOLDS = lu.Motion(CORNER, np.array([(Move.SWING, 1, 2, 0)]), 1.0, 90.0, True, "straight")


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


@pytest.mark.parametrize(
    ("options", "words"),
    [({"pictures": 1}, "2 pictures"), ({"seconds": 0}, "some time")],
)
def test_no_film_without_pictures_or_time(tmp_path, options, words):
    with pytest.raises(ValueError, match=words):
        draw.animation(UNFOLDS, tmp_path / "e.gif", **options)


def test_other_kinds_of_file_are_refused(tmp_path):
    with pytest.raises(ValueError, match=r"\.gif, got 'f\.png'"):
        draw.animation(UNFOLDS, tmp_path / "f.png", pictures=2)
