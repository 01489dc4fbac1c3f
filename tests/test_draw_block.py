"""Figures 2 and 16: meshes in pictures, and what the pictures of a block say."""

from itertools import product

import numpy as np
import pytest

import lineup as lu
from lineup import draw
from lineup.block import BLOCKS, Block
from lineup.draw import plates, printed, render
from lineup.draw.view import Triangles, view_of
from lineup.fabrication import placed

RED = (220, 30, 30)
CUBE = np.array(list(product((-1.0, 1.0), repeat=3)))
FACES = np.reshape(
    [
        *((0, 1, 3, 0, 3, 2), (4, 6, 7, 4, 7, 5), (0, 4, 5, 0, 5, 1)),  # two triangles a side
        *((2, 3, 7, 2, 7, 6), (0, 2, 6, 0, 6, 4), (1, 5, 7, 1, 7, 3)),
    ],
    (12, 3),
)


@pytest.fixture(params=["vtk", "matplotlib"])
def any_renderer(request, monkeypatch):
    if request.param == "vtk" and render.renderer() != "vtk":
        pytest.skip("VTK cannot draw off screen here")
    monkeypatch.setattr(render, "renderer", lambda: request.param)


@pytest.fixture
def plain(monkeypatch):
    """Pictures by matplotlib, without their pixels: what is written on them is looked at."""
    monkeypatch.setattr(
        render, "_by_matplotlib", lambda bodies, view, w, h: np.zeros((h, w, 4), np.uint8)
    )
    monkeypatch.setattr(render, "renderer", lambda: "matplotlib")


def box(centre, half, rgb=RED):
    return Triangles(
        np.asarray(centre) + half * CUBE, FACES, np.tile(np.array(rgb, np.uint8), (8, 1))
    )


def reddish(picture):
    return picture[..., 0].astype(int) - picture[..., 2] > 60


@pytest.mark.usefixtures("any_renderer")
def test_a_mesh_lands_where_the_view_has_it():
    view = view_of([[0, 0, 0], [9, 9, 9]], aspect=1.5)
    at = np.array([2.0, 7, 3])
    picture = render.rendered([box(at, 0.6)], view, 150, 100)
    rows, columns = np.nonzero(reddish(picture))
    right, up, _ = view.seen([at])[0]
    unit = 2 * view.half_height / 100
    assert rows.mean() == pytest.approx(50 - up / unit, abs=1.5)
    assert columns.mean() == pytest.approx(75 + right / unit, abs=1.5)


@pytest.mark.usefixtures("any_renderer")
def test_the_near_faces_of_a_mesh_hide_the_far():
    view = view_of([[-5, -5, -5], [5, 5, 5]])
    far, near = box(-4 * view.back, 1.5), box(4 * view.back, 1.5, (30, 30, 220))
    both = Triangles(
        np.vstack([near.vertices, far.vertices]),
        np.vstack([near.faces, far.faces + 8]),
        np.vstack([near.rgb, far.rgb]),
    )
    picture = render.rendered([both], view, 81, 81)
    assert not reddish(picture)[40, 40]
    assert picture[40, 40, 2] > picture[40, 40, 0] + 60


def said(axes):
    return [text.get_text() for text in axes.texts if text.get_text()]


def test_a_block_is_shown_with_its_axes_its_parts_and_its_joint_states(plain):
    figure = draw.block(Block())
    assert {f"${axis}_{k}$" for axis in "xyz" for k in (1, 2)} < set(said(figure.axes[0]))
    assert [t.split("\n")[0] for t in said(figure.axes[1])] == [
        "$B_i(w_1)$",
        "hinge",
        "$B_i(w_2) = B_j(w_1)$",
        "hinge",
        "$B_j(w_2)$",
    ]
    titles = [axes.get_title() for axes in figure.axes[2:]]
    assert titles[:3] == ["straight", "$z_1$ = 45°, in the neck", "$z_1$ = 90°"]
    assert len(titles) == 6


def test_a_swivel_is_taken_apart_too_and_bends_as_far_as_it_can(plain):
    figure = draw.block(BLOCKS["pull120"])
    assert "$B_j(w_1)$\nthey swivel" in said(figure.axes[1])
    assert figure.axes[4].get_title() == "$z_1$ = 120°"


def test_the_slots_are_shown_with_their_measures(plain):
    figure = draw.slots(Block())
    cut, end_on, width = figure.axes
    assert set(said(cut)) == {
        "ball 5 mm",
        "bar 2.6 mm",
        "clearance 0.25 mm",
        "pitch 10 mm",
        "capsule\n9.7 mm",
    }
    assert said(end_on) == ["neck 2.4 mm", "hole 3.1 mm"]
    (curve,) = [line for line in width.lines if len(line.get_xdata()) > 2]
    assert curve.get_ydata()[[0, 90, 180]] == pytest.approx([3.1, 2.4, 3.1])
    assert "snaps: 0.1 mm\non each side" in said(width)
    assert not any("snaps" in text for text in said(draw.slots(BLOCKS["pull"]).axes[2]))


def test_arrows_start_at_the_balls_and_lie_along_the_axes(plain):
    figure = draw.block(Block())
    arrows = [text for text in figure.axes[0].texts if not text.get_text()]
    starts = np.array([text.xyann for text in arrows])
    tips = np.array([text.xy for text in arrows])
    assert np.allclose(starts[:3], starts[0])
    assert np.allclose(starts[3:], starts[3])
    along = starts[3] - starts[0]  # from ball to ball is the x axis
    for k, way in ((0, -1), (3, 1)):
        arrow = tips[k] - starts[k]
        assert abs(along[0] * arrow[1] - along[1] * arrow[0]) < 1e-6 * np.hypot(*along) ** 2
        assert np.sign(arrow @ along) == way
        upwards = tips[k + 2] - starts[k + 2]
        assert abs(upwards[0]) < 1e-9
        assert upwards[1] < 0  # rows count downwards


def test_a_bent_block_in_pictures_is_a_joint_state_of_the_checks():
    """The hinge keeps its place, and neither end runs into it or into the other."""
    for first, second in product([(0, 0), (0, 1), (1, 0), (-1, 0)], repeat=2):
        _, pieces = printed._bent(Block(), first, second)
        (before, _), (hinge, _), (after, _) = pieces
        for a, b in ((before, hinge), (hinge, after), (before, after)):
            assert (a ^ b).volume() == 0
        assert before.min_gap(hinge, 1.0) > 0.24


@pytest.mark.slow
def test_pictures_of_a_block_have_its_colours_and_are_equal_bytes(tmp_path):
    for k in (1, 2):
        draw.save(draw.block(lu.Block()), tmp_path / f"block{k}.png")
    assert (tmp_path / "block1.png").read_bytes() == (tmp_path / "block2.png").read_bytes()
    figure = draw.block(lu.Block())
    picture = figure.axes[0].images[0].get_array()
    warm = picture[..., 0].astype(int) - picture[..., 2] > 80
    cold = picture[..., 2].astype(int) - picture[..., 0] > 80
    assert warm.mean() > 0.05
    assert cold.mean() > 0.05
    assert np.nonzero(warm)[1].mean() < np.nonzero(cold)[1].mean() - 50


@pytest.mark.usefixtures("plain")
def test_a_plate_shows_every_piece_above_its_bed(monkeypatch):
    seen = []
    monkeypatch.setattr(plates, "picture", lambda figure, place, bodies, view: seen.extend(bodies))
    path = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
    draw.plate(placed(path, Block()), Block())
    bed, body = seen
    away = np.abs(body.points[:, None] - path).max(axis=2)
    assert away.min(axis=1).max() <= 0.5
    assert set(away.argmin(axis=1)) == {0, 1, 2, 3}
    assert body.points[:, 2].min() == pytest.approx(bed.points[:, 2].max() + bed.edge / 2)
    assert (bed.points.min(axis=0)[:2] <= body.points.min(axis=0)[:2]).all()
    assert (bed.points.max(axis=0)[:2] >= body.points.max(axis=0)[:2]).all()


def test_a_plate_without_a_piece_is_refused():
    with pytest.raises(ValueError, match="one piece"):
        draw.plate([], Block())
