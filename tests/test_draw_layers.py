"""Pictures of layers: pulled apart, laid over each other, led by a slider."""

import base64
from itertools import pairwise

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

import lineup as lu
from lineup import draw, worked
from lineup.assumptions import anatomy, mask_of
from lineup.draw import apart, interactive
from lineup.draw.ends import links_inside
from lineup.planar import paper_path

ARCH = worked.arch()
GRAPH = lu.reeb_graph(ARCH)


@pytest.fixture(autouse=True)
def drawn(monkeypatch):
    """Pictures by matplotlib, which is quick for small ones; what is in each, and its view."""
    shown = []

    def rendered(bodies, view, width, height):
        shown.append((bodies, view))
        return np.full((height, width, 3), 255, np.uint8)

    monkeypatch.setattr("lineup.draw.page.rendered", rendered)
    return shown


def test_layers_pulled_apart_keep_every_voxel_in_its_column(drawn):
    draw.nodes(GRAPH, lu.traverse(GRAPH))
    (((cubes,), _),) = drawn
    voxels = np.argwhere(ARCH.occupancy)
    assert np.array_equal(cubes.centre[:, :2], voxels[:, :2])
    gaps = np.diff(np.unique(cubes.centre[:, 2]))
    assert (gaps > 1).all()
    assert len(gaps) == ARCH.occupancy.shape[2] - 1


def test_nodes_have_the_colours_and_numbers_of_the_graph(drawn):
    walk = lu.traverse(GRAPH)
    left, right = draw.nodes(GRAPH, walk).axes
    frames = {text.get_text(): text.get_bbox_patch().get_edgecolor() for text in left.texts}
    assert set(frames) == set(map(str, range(len(GRAPH))))
    edges = right.collections[-1].get_edgecolors()
    assert all(to_hex(frames[str(k)]) == to_hex(edges[k]) for k in range(len(GRAPH)))


def test_a_layer_shows_its_pieces_and_only_these_are_coloured(drawn):
    _, plan = draw.layer(GRAPH, 1).axes
    assert [text.get_text() for text in plan.texts] == ["2", "3"]
    (((cubes,), _),) = drawn
    coloured = np.ptp(cubes.rgb.astype(int), axis=1) > 20
    assert np.array_equal(coloured, np.argwhere(ARCH.occupancy)[:, 2] == 1)
    with pytest.raises(ValueError, match=r"a layer 0\.\.4, got 5"):
        draw.layer(GRAPH, 5)


@pytest.mark.parametrize(
    "voxels",
    [
        lu.algorithm3(ARCH).path.voxels,
        np.argwhere(np.ones((1, 4, 1))),
        np.argwhere(np.ones((1, 1, 4))),
    ],
    ids=["arch", "level", "upright"],
)
def test_storeys_draw_every_step_of_the_path(voxels):
    rods = apart._rods(voxels)
    assert np.allclose(np.abs(rods.stop - rods.start).sum(axis=1), 1)
    assert np.array_equal(rods.stop[:-1], rods.start[1:])
    level = (np.diff(voxels[:, 2]) == 0).sum()
    assert (rods.radius == apart._ROD).sum() == level
    assert (rods.radius == apart._LINK).sum() == apart._APART * (len(voxels) - 1 - level)


def test_storeys_show_what_is_left_out(drawn):
    path = lu.algorithm3(ARCH).path
    cut = lu.VoxelPath(path.voxels[:-6])
    draw.storeys(cut, ARCH)
    (((boxes, _), _),) = drawn
    assert len(boxes) == 6
    with pytest.raises(ValueError, match="refined 2 times"):
        draw.storeys(lu.VoxelPath(path.voxels, refinement=2), ARCH)


def cells_of(axes, collection):
    """The cells that a collection of squares covers."""
    corners = [path.vertices.min(axis=0) for path in axes.collections[collection].get_paths()]
    return {tuple(np.rint(corner + 0.5).astype(int)) for corner in corners}


def test_the_overlap_shows_what_both_interiors_have():
    first, second = worked.leaf(), np.zeros((15, 8), bool)
    second[3:12, 1:7] = True
    both = anatomy(first).interior & anatomy(second).interior
    *_, axes = draw.overlap(first, second, (6, 3)).axes
    assert cells_of(axes, 1) == set(map(tuple, np.argwhere(both)))
    assert cells_of(axes, 2) == {c for c in map(tuple, np.argwhere(both)) if sum(c) % 2 == 0}
    with pytest.raises(ValueError, match="one shape"):
        draw.overlap(first, second[:-1], (6, 3))


def test_shared_links_lie_in_the_interior_and_touch_no_end():
    bridge, leg = mask_of(GRAPH, 6), mask_of(GRAPH, 5)
    cells = paper_path(bridge, (1, 1), (1, 2)).cells
    interior = anatomy(leg).interior
    ends = {tuple(cells[0]), tuple(cells[-1])}
    wanted = [
        {tuple(a), tuple(b)}
        for a, b in pairwise(cells)
        if interior[tuple(a)] and interior[tuple(b)] and not {tuple(a), tuple(b)} & ends
    ]
    *_, axes = draw.shared_links(cells, bridge, leg).axes
    segments = axes.collections[-1].get_segments()
    assert [set(map(tuple, segment.astype(int))) for segment in segments] == wanted
    assert len(links_inside(cells, interior)) == len(wanted) == 3


def test_links_at_the_ends_are_not_shared():
    line = np.array([(0, 0), (1, 0), (2, 0), (3, 0)])
    assert links_inside(line, np.ones((4, 1), bool)).tolist() == [1]


def test_bars_are_the_means_over_the_models():
    flat = lu.VoxelSolid(np.ones((2, 5, 1), bool), name="flat")
    summary = lu.audit_summary([ARCH, flat])
    (axes,) = draw.assumptions(summary).axes
    by_name = dict(zip((t.get_text() for t in axes.texts[1::2]), axes.patches, strict=True))
    assert by_name["has an interior"].get_width() == 50
    assert by_name["no hole"].get_width() == 100
    assert len(axes.lines) == 8
    with pytest.raises(ValueError, match="no row"):
        draw.assumptions(summary[:0])


def test_solids_have_a_caption_each():
    row = draw.solids([ARCH, ARCH], ["one\nfirst", "two"])
    assert [axes.get_title() for axes in row.axes] == ["one", "two"]
    with pytest.raises(ValueError, match="got 2 solids and 1 captions"):
        draw.solids([ARCH, ARCH], ["one"])


def numbered(n):
    """A figure whose size tells which it is."""
    return Figure(figsize=(n, 1))


def test_a_picture_that_nobody_leads_is_that_of_the_middle_value():
    assert draw.explore(numbered, n=[1, 2, 3]).get_size_inches().tolist() == [2, 1]
    with pytest.raises(ValueError, match="needs values"):
        draw.explore(numbered, n=[])
    with pytest.raises(ValueError, match="needs values"):
        draw.explore(numbered)


def test_a_slider_draws_its_picture_and_leaves_a_still_one(monkeypatch):
    pytest.importorskip("ipywidgets")
    monkeypatch.setattr(interactive, "live", lambda: True)
    widget = draw.explore(numbered, n=[1, 2, 3])
    row, image = widget.children
    before = image.value
    (slider,) = row.children
    assert (slider.value, slider.options) == (2, (("1", 1), ("2", 2), ("3", 3)))
    bundle = widget._repr_mimebundle_()
    assert base64.b64encode(bundle["image/png"]) == base64.b64encode(before)
    assert "application/vnd.jupyter.widget-view+json" in bundle
    slider.value = 3
    assert image.value != before
    assert image.value == interactive._png(numbered(3))


@pytest.mark.parametrize("asked", [True, False])
def test_a_front_end_that_can_ask_is_live(monkeypatch, asked):
    pytest.importorskip("ipywidgets")
    ipython = pytest.importorskip("IPython")

    class Shell:
        class kernel:
            @staticmethod
            def get_parent(channel):
                return {"content": {"allow_stdin": asked}}

    monkeypatch.delenv(interactive.QUICK, raising=False)
    monkeypatch.setattr(ipython, "get_ipython", Shell)
    assert interactive.live() is asked
    monkeypatch.setenv(interactive.QUICK, "1")
    assert not interactive.live()


def test_names_take_the_place_of_numbers():
    graph = lu.reeb_graph(worked.figure_9())
    walk = lu.traverse(graph, root=3, end=0)
    names = {node: f"o{node}" for node in range(len(graph))}
    figure = draw.decomposition(graph, walk, names)
    seen = {text.get_text() for text in figure.axes[0].texts} - {""}
    assert seen == set(names.values())
    assert figure.axes[2].get_title().endswith("at o2")
