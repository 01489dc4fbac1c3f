"""Joint words: poses come back exactly, and turn with the chain."""

import itertools

import numpy as np
import pytest
from chains import walk
from examples import examples
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_array_equal
from walks import paths

import lineup as lu
from lineup import grid
from lineup.words import LETTERS, bar_frames, block_angles

ROTATIONS = [
    frame
    for order in itertools.permutations(np.eye(3, dtype=int))
    for signs in itertools.product((1, -1), repeat=3)
    if np.linalg.det(frame := np.stack(order) * np.array(signs)) > 0
]


def even(voxels):
    return voxels[: len(voxels) - len(voxels) % 2]


@st.composite
def words(draw, max_blocks=12):
    n = draw(st.integers(1, max_blocks))
    letters = "".join(
        draw(st.lists(st.sampled_from(LETTERS), min_size=2 * n - 2, max_size=2 * n - 2))
    )
    origin = draw(st.lists(st.integers(-99, 99), min_size=3, max_size=3))
    return lu.JointWord(np.array(origin), draw(st.sampled_from(ROTATIONS)), letters)


def told(voxels):
    """Letters by where each bar leads, from coordinates alone: an independent reading.

    The direction of y is followed from bar to bar: it stays unless the bend is in its plane.
    """
    bars = np.diff(voxels, axis=0)
    across = [bar for bar in bars if bar @ bars[0] == 0]
    y = across[0] if across else None
    letters = ""
    for before, after in itertools.pairwise(bars):
        if (before == after).all():
            letters += "S"
        elif after @ y:
            letters += "y" if after @ y > 0 else "Y"
            y = -before * (after @ y)
        else:
            letters += "z" if np.cross(before, y) @ after > 0 else "Z"
    return letters


@given(paths())
@examples(140)
def test_a_path_comes_back(voxels):
    voxels = even(voxels)
    word = lu.joint_word(voxels)
    back = lu.forward(word)
    assert back.dtype == np.int32
    assert_array_equal(back, voxels)
    assert word.letters == told(voxels)
    assert len(word) == len(voxels)


@examples(400)
@given(words())
def test_a_word_comes_back_but_for_the_roll_of_its_frame(word):
    again = lu.joint_word(lu.forward(word))
    assert_array_equal(lu.forward(again), lu.forward(word))
    bends = word.letters.lstrip("S")
    if bends[:1] in ("", "y"):
        assert again.letters == word.letters


@given(paths(), st.sampled_from(ROTATIONS), st.lists(st.integers(-50, 50), min_size=3, max_size=3))
@examples(160)
def test_a_pose_turned_as_a_whole_has_the_same_letters(voxels, turn, shift):
    voxels = even(voxels)
    word, turned = lu.joint_word(voxels), lu.joint_word(voxels @ turn.T + shift)
    assert turned.letters == word.letters
    if set(word.letters) != {"S"}:
        assert_array_equal(turned.frame, turn @ word.frame)


@given(paths())
@examples(160)
def test_a_mirrored_pose_swaps_z_and_nothing_else(voxels):
    voxels = even(voxels)
    letters = lu.joint_word(voxels * (1, -1, 1)).letters
    assert letters == lu.joint_word(voxels).letters.translate(str.maketrans("zZ", "Zz"))


@given(words())
def test_frames_are_right_handed_and_lead_along_the_bars(word):
    frames = bar_frames(word)
    assert_array_equal(np.linalg.det(frames).round(9), 1)
    assert_array_equal(frames[:, :, 0], np.diff(lu.forward(word), axis=0))


@given(words())
def test_angles_of_the_blocks_lead_to_the_frames(word):
    """The frames again, by rotation matrices of the five angles in the order of Figure 2."""

    def about(axis, deg):
        c, s = np.cos(np.radians(deg)), np.sin(np.radians(deg))
        matrix, (u, v) = np.eye(3), ((axis + 1) % 3, (axis + 2) % 3)
        matrix[[u, v, u, v], [u, v, v, u]] = c, c, -s, s
        return matrix

    frame, frames = word.frame.astype(float), []
    for y1, z1, x, y2, z2 in block_angles(word).tolist():
        frame = frame @ about(1, y1) @ about(2, z1)
        frames.append(frame)
        frame = frame @ about(0, x) @ about(1, y2) @ about(2, z2)
        frames.append(frame)
    np.testing.assert_allclose(frames[:-1], bar_frames(word), atol=1e-12)
    angles = block_angles(word)
    assert not angles[:, 2].any()
    assert not (angles[:, [0, 3]] * angles[:, [1, 4]]).any()


def test_every_letter_by_hand():
    """From a bar east whose y is north and z is up."""
    ways = {"S": "E", "y": "N", "Y": "S", "z": "U", "Z": "D"}
    for letter, way in ways.items():
        word = lu.JointWord(np.zeros(3, int), np.eye(3, dtype=int), letter + "S")
        assert_array_equal(lu.forward(word), walk(f"E{way}{way}"))


def test_a_worked_path():
    """East, up, west, north: the first bend is y by definition, and so is the U's second."""
    word = lu.joint_word(walk("EUWNN"))
    assert (word.letters, word.origin.tolist()) == ("yyZS", [0, 0, 0])
    assert word.frame.T.tolist() == [[1, 0, 0], [0, 0, 1], [0, -1, 0]]
    assert block_angles(word).tolist() == [[0, 0, 0, 0, 90], [0, 90, 0, 90, 0], [0, 0, 0, 0, 0]]


def test_a_path_and_a_folding_are_read_alike():
    folding = lu.fold(lu.VoxelSolid(np.ones((2, 2, 2), bool)), rounds=1)
    words = [lu.joint_word(x) for x in (folding, folding.path, folding.path.voxels)]
    assert len({(w.letters, w.frame.tobytes(), w.origin.tobytes()) for w in words}) == 1


def test_one_block_has_no_letters():
    word = lu.joint_word(walk("D"))
    assert (word.letters, len(word)) == ("", 2)
    assert_array_equal(lu.forward(word), walk("D"))


@pytest.mark.parametrize(
    ("path", "reason"),
    [
        (walk("ENWWE"), "straight back at voxel 4"),
        (walk("EW" + "N"), "straight back at voxel 1"),
        (walk("EN"), "even number of them, got 3"),
        (np.empty((0, 3), int), "even number of them, got 0"),
        (np.array([(0, 0, 0), (2, 0, 0)]), "voxels 0 and 1 of the path do not share a face"),
        (walk("E") + 0.5, "integer array"),
        (walk("E")[:, :2], r"shape \(n, 3\)"),
    ],
)
def test_what_is_no_pose_of_blocks_is_refused(path, reason):
    with pytest.raises(ValueError, match=reason):
        lu.joint_word(path)


EYE = np.eye(3, dtype=int)


@pytest.mark.parametrize(
    ("origin", "frame", "letters", "reason"),
    [
        (np.zeros(3), EYE, "SS", "origin must be integers"),
        (np.zeros(2, int), EYE, "SS", r"origin must be integers of shape \(3,\)"),
        (np.array([0, 0, 2**40]), EYE, "SS", "origin must be from -2147483648"),
        (np.zeros(3, int), EYE[[1, 0, 2]], "SS", "right-handed"),
        (np.zeros(3, int), EYE * 2, "SS", "three lattice directions"),
        (np.zeros(3, int), np.ones((3, 3), int), "SS", "three lattice directions"),
        (np.zeros(3, int), EYE, "Sx", "unknown letter 'x'"),
        (np.zeros(3, int), EYE, "SyY", "3 letters are of no chain of blocks"),
    ],
)
def test_what_is_no_word_is_refused(origin, frame, letters, reason):
    with pytest.raises(ValueError, match=reason):
        lu.JointWord(origin, frame, letters)


@given(paths(), st.data())
@examples(80)
def test_a_letter_changed_is_another_pose(voxels, data):
    """No two words share a pose, so that a fault in one letter shows."""
    voxels = even(voxels)
    word = lu.joint_word(voxels)
    k = data.draw(st.integers(0, len(word.letters) - 1))
    other = data.draw(st.sampled_from([c for c in LETTERS if c != word.letters[k]]))
    changed = lu.JointWord(
        word.origin, word.frame, word.letters[:k] + other + word.letters[k + 1 :]
    )
    differs = (lu.forward(changed) != voxels).any(axis=1)
    assert int(np.argmax(differs)) == k + 2


def test_words_are_records():
    word = lu.joint_word(walk("ENU"))
    with pytest.raises(ValueError, match="read-only"):
        word.origin[0] = 1
    assert grid.bar_directions(lu.forward(word)).tolist() == [0, 1, 2]
