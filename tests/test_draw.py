"""Pictures: where things land on them, what they say, and that equal pictures are equal bytes."""

import subprocess
import warnings
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from PIL import Image
from polycubes import polycubes

import lineup as lu
from lineup import draw
from lineup.contraction import contraction_pairs
from lineup.draw import moments, plans, render, story
from lineup.draw.bodies import chain_body, left_out_body, solid_body
from lineup.draw.page import DPI
from lineup.draw.view import Capsules, Cubes, colours, view_of
from lineup.planar import paper_path

RED, BLUE = (220, 30, 30), (30, 30, 220)


@pytest.fixture(scope="module")
def solid():
    return lu.VoxelSolid(np.ones((5, 4, 4), bool))


@pytest.fixture(scope="module")
def path(solid):
    return lu.layered_path(solid, starts=1, sweeps=20)


@pytest.fixture(scope="module")
def folding(solid):
    return lu.fold(solid, rounds=50, trial_rounds=10)


@pytest.fixture(params=["vtk", "matplotlib"])
def any_renderer(request, monkeypatch):
    """Each test that asks for it runs with both ways to draw, and with smooth edges."""
    if request.param == "vtk" and vtk_is_missing():
        pytest.skip("VTK cannot draw off screen here")
    monkeypatch.setattr(render, "renderer", lambda: request.param)
    monkeypatch.setattr(render, "_OVERSAMPLING", 2)


@pytest.fixture
def plain(monkeypatch):
    """Pictures by matplotlib, which is quick for small ones."""
    monkeypatch.setattr(render, "renderer", lambda: "matplotlib")


def vtk_is_missing():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return render.renderer() != "vtk"


def cube(at, rgb, edge=1.0):
    return Cubes(np.array([at], float), np.array([rgb], np.uint8), edge)


def pixel(view, point, width, height):
    right, up, _ = view.seen([point])[0]
    unit = 2 * view.half_height / height
    return int(height / 2 - up / unit), int(width / 2 + right / unit)


def reddish(picture):
    return picture[..., 0].astype(int) - picture[..., 2] > 60


points = arrays(float, st.tuples(st.integers(1, 20), st.just(3)), elements=st.integers(-50, 50))


@given(points, st.floats(0.3, 3), st.floats(-180, 180), st.floats(-80, 80))
def test_a_view_just_holds_its_points(points, aspect, azimuth, elevation):
    view = view_of(points, aspect, azimuth, elevation)
    assert np.allclose(view.axes @ view.axes.T, np.eye(3))
    assert np.linalg.det(view.axes) == pytest.approx(1)
    half = np.array([aspect, 1]) * view.half_height
    room = half - np.abs(view.seen(points)[:, :2]).max(axis=0)
    assert room.min() == pytest.approx(1)
    wider = view.widened(0.5)
    assert (np.abs(wider.seen(points)[:, :2]) < half * 2).all()


def test_the_wider_side_is_seen():
    plate = np.argwhere(np.ones((9, 1, 9)))
    across = [np.ptp(view_of(p).seen(p)[:, 0]) for p in (plate, plate[:, [1, 0, 2]])]
    assert min(across) > 6


def test_colours_are_told_apart_from_first_to_last():
    rgb = colours(1000).astype(int)
    first, last = rgb[0], rgb[-1]
    assert first[2] > 2 * first[0]
    assert last[0] > 2 * last[2]
    assert rgb.max(axis=1).min() > 150  # none is near black
    assert len({tuple(c) for c in colours(40).tolist()}) == 40


@pytest.mark.usefixtures("any_renderer")
def test_a_cube_lands_where_the_view_has_it():
    view = view_of([[0, 0, 0], [9, 9, 9]], aspect=1.5)
    at = (2, 7, 3)
    picture = render.rendered([cube(at, RED)], view, 150, 100)
    assert picture.shape == (100, 150, 3)
    rows, columns = np.nonzero(reddish(picture))
    row, column = pixel(view, at, 150, 100)
    assert rows.mean() == pytest.approx(row, abs=1.5)
    assert columns.mean() == pytest.approx(column, abs=1.5)


@pytest.mark.usefixtures("any_renderer")
def test_the_near_hides_the_far():
    view = view_of([[-5, -5, -5], [5, 5, 5]])
    far, near = -4 * view.back, 4 * view.back
    both = Cubes(np.array([near, far]), np.array([RED, BLUE], np.uint8), 2.0)
    picture = render.rendered([both], view, 80, 80)
    row, column = pixel(view, near, 80, 80)
    assert reddish(picture)[row, column]


@pytest.mark.usefixtures("any_renderer")
def test_rods_are_as_thick_as_they_say():
    start, stop = np.array([[0.0, 0, 0]]), np.array([[1.0, 0, 0]])
    view = view_of(np.concatenate([start, stop]), elevation_deg=0, azimuth_deg=-90)
    seen = []
    for radius in (0.2, 0.4):
        rod = Capsules(start, stop, np.array([RED], np.uint8), np.array([radius]))
        picture = render.rendered([rod], view, 100, 100)
        seen.append((picture[:, 50].min(axis=1) < 250).sum() * 2 * view.half_height / 100)
    assert seen == pytest.approx([0.4, 0.8], abs=0.08)


@pytest.mark.parametrize("elevation", [90, -90, float("nan")])
def test_a_view_straight_down_is_refused(elevation):
    with pytest.raises(ValueError, match="from -89 to 89"):
        view_of([[0, 0, 0]], elevation_deg=elevation)


@pytest.mark.usefixtures("any_renderer")
def test_a_body_out_of_sight_leaves_the_picture_white():
    view = view_of([[0, 0, 0]])
    assert (render.rendered([cube((0, 0, 99), RED)], view, 20, 20) == 255).all()


def test_the_floor_is_darker_under_a_body():
    view = view_of(np.argwhere(np.ones((6, 6, 6)))).widened(0.5)
    slab = np.argwhere(np.ones((4, 4, 1))).astype(float)
    grey = render._shadow([Cubes(slab, np.full(slab.shape, 9, np.uint8), 1.0)], view, 90, 90)
    under = pixel(view, (2, 2, -0.5), 90, 90)
    beside = pixel(view, (-4, 2, -0.5), 90, 90)
    assert grey[under] < grey[beside] - 50
    assert grey[0, 0] == 255


def test_a_chain_is_blocks_and_hinges(folding):
    body = chain_body(folding.path.voxels)
    assert np.array_equal(body.stop[:-1], body.start[1:])
    assert len(np.unique(body.radius)) == 2
    fat = body.radius == body.radius.max()
    blocks = np.stack([body.start[fat], body.stop[fat]], axis=1)
    assert np.array_equal(blocks.reshape(-1, 3), folding.path.voxels)


@given(polycubes(30))
@settings(max_examples=20)
def test_grey_cubes_are_the_dropped_voxels(occupancy):
    solid = lu.VoxelSolid(occupancy)
    if solid.size < 2:
        return
    path = lu.layered_path(solid, starts=1, sweeps=2)
    assert np.array_equal(left_out_body(solid, path.voxels.astype(float)).centre, path.dropped)


def test_a_solid_is_drawn_in_the_colours_of_a_checkerboard(solid):
    body = solid_body(solid)
    shade = {tuple(v): tuple(c) for v, c in zip(body.centre.tolist(), body.rgb, strict=True)}
    assert len(set(shade.values())) == 2
    assert all(shade[v] != shade[(v[0] + 1, *v[1:])] for v in shade if (v[0] + 1, *v[1:]) in shade)


@pytest.mark.parametrize(
    ("chain", "shape"), [(np.zeros((1, 3)), "(1, 3)"), (np.full((4, 3), np.nan), "(4, 3)")]
)
def test_what_is_no_chain_is_refused(chain, shape):
    with pytest.raises(ValueError, match="two or more finite points") as error:
        draw.chain(chain)
    assert shape in str(error.value)


@pytest.mark.usefixtures("any_renderer")
def test_equal_pictures_are_equal_bytes(folding, solid, tmp_path):
    files = [tmp_path / "a.png", tmp_path / "b.png"]
    for file in files:
        assert draw.save(draw.chain(folding, solid), file) == file
    assert files[0].read_bytes() == files[1].read_bytes()
    with Image.open(files[0]) as image:
        assert set(image.info) == {"dpi"}
        assert image.size == (6 * DPI, 6 * DPI)
        grey = np.asarray(image.convert("L"))
    assert (grey < 200).mean() > 0.2


def test_save_leaves_no_half_written_file(tmp_path):
    file = tmp_path / "deep" / "a.png"
    draw.save(Figure(), file)
    before = file.read_bytes()
    broken = SimpleNamespace(savefig=lambda half, **_: half.write_bytes(b"half") and 1 / 0)
    with pytest.raises(ZeroDivisionError):
        draw.save(broken, file)
    assert [f.name for f in file.parent.iterdir()] == ["a.png"]
    assert file.read_bytes() == before


def test_save_writes_png_only(tmp_path):
    with pytest.raises(ValueError, match=r"as \.png, got 'a\.pdf'"):
        draw.save(Figure(), tmp_path / "a.pdf")


@pytest.mark.usefixtures("plain")
def test_a_sheet_has_a_caption_for_each_chain(path):
    sheet = draw.contact_sheet([path] * 6, [f"name {k}\nmore" for k in range(6)])
    pictures = sheet.axes[:6]
    assert [axes.get_title() for axes in pictures] == [f"name {k}" for k in range(6)]
    boxes = [axes.get_position() for axes in pictures]
    assert len({round(box.y0, 6) for box in boxes}) == 2
    corners = {(round(box.x0, 6), round(box.y0, 6)) for box in boxes}
    assert len(corners) == 6
    assert {round(box.width, 6) for box in boxes} == {0.2}
    with pytest.raises(ValueError, match="got 1 chains and 2 captions"):
        draw.contact_sheet([path], ["a", "b"])


@pytest.mark.usefixtures("plain")
def test_an_unfolding_says_how_far_it_is(folding):
    page = draw.unfolding(folding, moments=4)
    titles = [axes.get_title(loc="left") for axes in page.axes[::2]]
    assert titles[0] == "folded"
    assert titles[-1] == "straight"
    shares = [int(title.split()[0]) for title in titles[1:-1]]
    assert shares == sorted(shares, reverse=True)
    assert page.axes[-1].get_title().endswith(f"{len(folding.path)} voxels across")


@pytest.mark.usefixtures("plain")
def test_an_unfinished_motion_is_not_called_straight(folding):
    motion = folding.motion
    short = lu.Motion(motion.start, motion.moves[:-1], 0.999, 90.0, False, "stopped", motion.poses)
    page = draw.unfolding(short, moments=2)
    assert page.axes[2].get_title(loc="left").endswith("still folded")
    with pytest.raises(ValueError, match="at least 2, got 1"):
        draw.unfolding(short, moments=1)


def test_bends_are_corners(path):
    bars = np.diff(path.voxels, axis=0)
    corners = sum(tuple(a) != tuple(b) for a, b in pairwise(bars))
    assert story.bends(path.voxels) == corners > 0
    assert story.bends(np.arange(5)[:, None] * [0, 1, 0]) == 0


def test_a_pose_that_left_the_view_is_brought_back():
    view = view_of([[0, 0, 0], [4, 0, 4]])
    pose = np.arange(5.0)[:, None] * [0, 0, 1]
    assert moments._in_sight(pose, view) is pose
    moved = moments._in_sight(pose + np.array([0, 0, 500]), view)
    assert np.allclose(moved - moved[0], pose)
    assert np.allclose(moved[0], view.centre)


def test_plans_show_every_step_of_the_path(path, solid):
    n_layers = solid.occupancy.shape[2]
    figure = draw.layers(path, solid, layers=range(n_layers))
    in_layers, up, down = 0, [], []
    for axes in figure.axes:
        lines, *marks = axes.collections[2:]
        in_layers += len(lines.get_segments())
        up.append(len(marks[0].get_offsets()))
        down.append(len(marks[1].get_offsets()))
    z = path.voxels[:, 2]
    climbs = np.bincount(np.minimum(z[:-1], z[1:])[z[:-1] != z[1:]], minlength=n_layers - 1)
    assert in_layers + climbs.sum() == len(path) - 1
    assert up == [*climbs, 0]
    assert down == [0, *climbs]


def test_plans_show_each_voxel_as_visited_or_left_out(solid, path):
    cut = lu.VoxelPath(path.voxels[:-6])
    figure = draw.layers(cut, solid, layers=range(4))
    numbers = [[len(c.get_paths()) for c in axes.collections[:2]] for axes in figure.axes]
    assert np.sum(numbers, axis=0).tolist() == [len(cut), 6]


def test_plans_of_a_refined_path_and_of_missing_layers(solid):
    slab = lu.VoxelSolid(np.ones((1, 1, 1), bool))
    ring = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 0, 1), (0, 0, 1)]
    refined = lu.VoxelPath(np.array(ring), refinement=2)
    assert len(draw.layers(refined, slab).axes) == 2
    with pytest.raises(ValueError, match=r"some of 0\.\.1, got \[2\]"):
        draw.layers(refined, slab, layers=[2])


@given(polycubes(60))
@settings(max_examples=30)
def test_nodes_stand_at_their_layer_and_apart(occupancy):
    graph = lu.reeb_graph(lu.VoxelSolid(occupancy))
    place = plans.places(graph)
    assert np.array_equal(place[:, 1], graph.layer_of)
    for layer in np.unique(graph.layer_of):
        across = np.sort(place[graph.layer_of == layer, 0])
        assert (np.diff(across) >= 1.2 - 1e-9).all()


def test_the_reeb_graph_shows_msp_and_mscs():
    comb = np.zeros((7, 1, 3), bool)
    comb[::2] = comb[:, :, 1] = True
    graph = lu.reeb_graph(lu.VoxelSolid(comb))
    traversal = lu.traverse(graph)
    figure = draw.reeb(graph, traversal)
    words = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert words[0] == f"MSP, {len(traversal.msp)} nodes"
    assert words[1] == f"{len(traversal.mscs)} MSCs, a colour each"
    drawn = [len(c.get_segments()) for c in figure.axes[0].collections[:-1]]
    steps = [len(nodes) - 1 for nodes in (*traversal.mscs, traversal.msp)]
    assert drawn == [len(graph.edges), *steps]


def test_the_decomposition_draws_every_step_and_the_largest_mscs_apart():
    table = np.zeros((15, 1, 4), bool)
    table[:, :, 1] = True
    for k in range(8):
        table[2 * k, 0, 0] = True
    table[4, 0, 2:] = table[0, 0, 2] = True
    graph = lu.reeb_graph(lu.VoxelSolid(table))
    traversal = lu.traverse(graph)
    whole, *parts = draw.decomposition(graph, traversal).axes
    assert len(traversal.mscs) == 8
    assert whole.get_title().endswith("\n3 more MSCs not drawn apart")
    assert [axes.get_title() for axes in parts[1:]] == [
        f"MSC $C_{{{k}}}$, 2 nodes at {traversal.mscs[k - 1][0]}" for k in range(1, 6)
    ]

    def n_arrows(axes):
        return sum(text.arrow_patch is not None for text in axes.texts if hasattr(text, "xyann"))

    assert n_arrows(whole) == len(traversal.walk) - 1
    shown = [traversal.msp, *traversal.mscs[:5]]
    assert list(map(n_arrows, parts)) == [len(nodes) - 1 for nodes in shown]


def test_one_warning_where_vtk_cannot_draw(monkeypatch):
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: SimpleNamespace(returncode=-11))
    render.renderer.cache_clear()
    try:
        with pytest.warns(UserWarning, match="apt-get install libegl1") as caught:
            assert [render.renderer(), render.renderer()] == ["matplotlib", "matplotlib"]
        assert len(caught) == 1
    finally:
        render.renderer.cache_clear()


SLAB = np.ones((8, 9), bool)
STEPS = paper_path(SLAB, (2, 2), (5, 3))


def lines_of(axes):
    """Cells along each line of some axes."""
    return [np.stack(line.get_data(), axis=1).astype(int).tolist() for line in axes.lines]


def test_planar_steps_show_what_algorithm_2_did():
    _, cycle, interior, merged = draw.planar_steps(SLAB, STEPS).axes
    assert lines_of(cycle)[0] == [*STEPS.boundary.tolist(), STEPS.boundary[0].tolist()]
    assert STEPS.interior.tolist() in lines_of(interior)
    assert STEPS.cells.tolist() in lines_of(merged)


def test_planar_steps_tell_why_there_is_none():
    cross = np.zeros((5, 5), bool)
    cross[2] = cross[:, 2] = True
    figure = draw.planar_steps(cross, paper_path(cross, (2, 0), (0, 2)))
    assert "dangling" in figure.axes[3].texts[0].get_text()
    with pytest.raises(ValueError, match="nothing merged"):
        draw.merge(paper_path(cross, (2, 0), (0, 2)))


def test_the_merge_square_holds_the_links_that_differ():
    """Two links of cycle and interior path are not in the merged path: sides of one square."""
    before, _ = draw.merge(STEPS).axes
    (frame,) = (patch for patch in before.patches if isinstance(patch, Rectangle))
    x, y = np.rint(np.array(frame.get_xy()) + 0.5).astype(int)
    square = {(x + a, y + b) for a in (0, 1) for b in (0, 1)}
    merged = {frozenset(map(tuple, link)) for link in pairwise(STEPS.cells.tolist())}
    old = [*pairwise(STEPS.boundary.tolist()), *pairwise(STEPS.interior.tolist())]
    gone = {frozenset(map(tuple, link)) for link in old} - merged
    assert all(link <= square for link in gone)
    assert 1 <= len(gone) <= 2  # the cycle may be cut where its list of cells begins


def test_the_board_marks_every_cell_of_the_cycle():
    _, board = draw.checkerboard(SLAB, STEPS).axes
    assert lines_of(board)[1] == STEPS.boundary.tolist()


def test_a_contraction_shows_its_pair():
    path = lu.layered_path(lu.VoxelSolid(np.ones((6, 6, 3), bool)))
    pairs = contraction_pairs(path, keep=np.zeros((6, 6, 3), bool)).tolist()
    before, after = draw.contraction(path, tuple(pairs[0])).axes
    assert lines_of(before)[0] == path.voxels[pairs[0], :2].tolist()
    assert len(after.collections) == len(before.collections) + 1
    with pytest.raises(ValueError, match="form a contraction pair"):
        draw.contraction(path, (0, 1))


def test_layering_needs_a_layered_path():
    solid = lu.VoxelSolid(np.ones((3, 3, 3), bool))
    with pytest.raises(ValueError, match="has no visits"):
        draw.layering(lu.layered_path(solid, "free3d", sweeps=10), solid)
