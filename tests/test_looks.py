"""Appearance, measured against closed forms, brute force and the voxelizer's own IoU."""

import numpy as np
import pytest
import trimesh
from matplotlib.figure import Figure

import lineup as lu
from lineup import draw, looks


@pytest.fixture(scope="module")
def duck():
    solid = lu.model("duck", voxels=200)
    return solid, lu.layered_path(solid, starts=1)


def test_a_box_is_its_voxels():
    box = trimesh.creation.box((4, 3, 2))
    solid = lu.voxelize(box, 24)
    path = lu.layered_path(solid)
    assert len(path) == 24
    for row in lu.appearance(path, solid, box).to_dict("records"):
        assert row["iou"] == pytest.approx(1)
        assert row["distance_max"] == pytest.approx(0, abs=1e-9)
        assert row["silhouette"] > 0.98
        assert row["surface_kept"] == 1


def test_a_missing_slab_has_a_known_distance():
    """Of a 4 x 4 x 4 cube the upper half is left out: its top is 2 voxels away from any face."""
    solid = lu.VoxelSolid(np.ones((4, 4, 4), bool))
    half = lu.VoxelPath(lu.layered_path(lu.VoxelSolid(np.ones((4, 4, 2), bool))).voxels)
    whole, left = lu.appearance(half, solid).to_dict("records")
    assert whole["distance_max"] == pytest.approx(0, abs=1e-12)
    assert left["iou"] == 0.5
    assert left["surface_kept"] == pytest.approx((16 + 12) / 56)
    assert left["distance_max"] == pytest.approx(2, abs=0.01)
    assert [left[f"silhouette_{view}"] for view in "xyz"] == [0.5, 0.5, 1]


def test_the_iou_is_that_of_the_voxelizer(duck):
    solid, path = duck
    table = lu.appearance({"layered": path}, solid, "duck")
    assert table["iou"][0] == pytest.approx(solid.source["iou"], abs=1e-6)
    assert table["stage"].tolist() == ["solid", "layered"]
    assert table["iou"][1] <= table["iou"][0]


@pytest.mark.parametrize("up", ["+z", (1.0, 2.0, 3.0)])
def test_iou_against_winding_numbers(up):
    """Brute force: the winding number at 64 points in each voxel, on a grid twice as wide."""
    solid = lu.model("elk", voxels=60, up=up)
    surface, _ = lu.catalog.surface_for("elk", up)
    margin = 4
    corner = np.array(solid.source["origin"]) - margin * solid.pitch
    shape = np.array(solid.occupancy.shape) + 2 * margin
    at = corner + solid.pitch * (np.indices(4 * shape).reshape(3, -1).T + 0.5) / 4
    x, y, z = shape
    inside = (surface.winding(at) > 0.5).reshape(x, 4, y, 4, z, 4).mean(axis=(1, 3, 5))
    mine = inside[np.pad(solid.occupancy, margin)].sum()
    iou = mine / (solid.size + inside.sum() - mine)
    assert solid.source["iou"] == pytest.approx(iou, abs=0.02)


def test_silhouettes_of_a_mesh_against_points_inside():
    ball = trimesh.creation.icosphere(subdivisions=3)
    solid = lu.voxelize(ball, 200)
    reference = looks.reference_of(solid, ball)
    for seen in reference.seen:
        area = seen.sum() * (solid.pitch / 32) ** 2
        assert area == pytest.approx(np.pi, rel=0.03)


def test_enclosed_holes_are_not_seen():
    whole = np.pad(np.ones((3, 3, 3), bool), 1)
    hollow = whole.copy()
    hollow[2, 2, 2] = False
    for ours, theirs in zip(looks.boundary(hollow), looks.boundary(whole), strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_the_faces_of_voxels_lie_on_them():
    solid = lu.model("duck", voxels=60)
    vertices, faces = looks.boundary(np.pad(solid.occupancy, 1))
    mesh = trimesh.Trimesh(vertices, faces)
    around = np.pad(solid.occupancy, 1)
    n_bare = sum(
        (around & ~np.roll(around, -step, axis=(0, 1, 2))).sum() for step in lu.grid.DIRECTIONS
    )
    assert mesh.area == pytest.approx(n_bare)
    np.testing.assert_allclose(mesh.bounds[1], np.array(solid.occupancy.shape) + 1)


def test_what_is_no_path_of_the_solid_is_refused(duck):
    solid, path = duck
    small = lu.VoxelSolid(np.ones((2, 2, 2), bool))
    with pytest.raises(ValueError, match="no path in the solid"):
        lu.appearance(path, small)
    with pytest.raises(ValueError, match="split 2-fold"):
        lu.appearance(lu.layered_path(small, "refined"), small)
    with pytest.raises(ValueError, match="at least one path"):
        lu.appearance({}, small)
    with pytest.raises(ValueError, match="where in a mesh"):
        lu.appearance(lu.layered_path(small), small, trimesh.creation.box())
    with pytest.raises(ValueError, match="not the one that the solid was made of"):
        lu.appearance(path, solid, trimesh.creation.box())


def test_the_picture(duck):
    solid, path = duck
    figure = draw.silhouettes({"layered": path}, solid, "duck")
    assert isinstance(figure, Figure)
    table = lu.appearance({"layered": path}, solid, "duck")
    wanted = [f"{table[f'silhouette_{v}'][k]:.3f}" for k in (0, 1) for v in "xyz"]
    assert [axes.get_title() for axes in figure.axes] == wanted
