"""The procedural models: closed surfaces of the topology their shapes have."""

import numpy as np
import pytest
import trimesh

from lineup import implicit, shapes

GENUS = {"decocube": 13, "two_holed_torus": 2, "chair": 2, "mug": 1}


@pytest.mark.parametrize("name", sorted(shapes.MODELS))
def test_surface_is_closed_outward_and_standing(name: str) -> None:
    mesh = trimesh.Trimesh(*shapes.triangulated(name))
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0
    assert mesh.body_count == 1
    assert mesh.euler_number == 2 - 2 * GENUS.get(name, 0)


@pytest.mark.parametrize("name", sorted(set(shapes.MODELS) - {"mug"}))  # its rims are sharp
def test_surface_lies_on_the_formula(name: str) -> None:
    vertices, _ = shapes.triangulated(name)
    assert np.abs(shapes.MODELS[name](vertices)).max() < 0.03


@pytest.mark.parametrize("name", sorted(set(shapes.MODELS) - {"two_holed_torus", "decocube"}))
def test_models_are_mirror_symmetric(name: str) -> None:
    points = np.random.default_rng(0).uniform(-2, 2, (500, 3))
    np.testing.assert_allclose(
        shapes.MODELS[name](points), shapes.MODELS[name](points * [1, -1, 1]), atol=1e-12
    )


def test_unknown_shape_is_refused() -> None:
    with pytest.raises(ValueError, match="no procedural model 'unicorn'"):
        shapes.triangulated("unicorn")


@pytest.mark.parametrize(
    ("solid", "volume"),
    [
        (lambda p: implicit.ball(p, (0.1, 0, 0), 0.8), 4 / 3 * np.pi * 0.8**3),
        (lambda p: implicit.ellipsoid(p, (0, 0, 0), (0.9, 0.6, 0.4)), 4 / 3 * np.pi * 0.216),
        (lambda p: implicit.box(p, (0, 0.1, 0), (0.8, 0.5, 0.3)), 8 * 0.12),
        (lambda p: implicit.torus(p, (0, 0, 0), 2, 0.6, 0.25), 2 * np.pi**2 * 0.6 * 0.25**2),
        (lambda p: implicit.limb(p, [(-0.5, 0, 0), (0.5, 0, 0)], [0.3, 0.3]),
         np.pi * 0.09 + 4 / 3 * np.pi * 0.027),
        (lambda p: implicit.cylinder(p, (0, 0, -0.5), (0, 0, 0.5), 0.6, 0.3),
         np.pi / 3 * (0.36 + 0.18 + 0.09)),
        (lambda p: implicit.plate(p, [(-0.5, -0.5), (0.5, -0.5), (0, 0.5)], 1, 0.2, 0.3), 0.3),
        (lambda p: implicit.cut(implicit.ball(p, (0, 0, 0), 0.9), p[..., 2]),
         2 / 3 * np.pi * 0.9**3),
        (lambda p: implicit.union(implicit.ball(p, (0.5, 0, 0), 0.4),
                                  implicit.ball(p, (-0.5, 0, 0), 0.4)), 8 / 3 * np.pi * 0.064),
    ],
)  # fmt: skip
def test_volumes_in_closed_form(solid: implicit.Implicit, volume: float) -> None:
    line = (np.arange(100) + 0.5) / 50 - 1
    points = np.stack(np.meshgrid(line, line, line, indexing="ij"), axis=-1)
    assert (solid(points) < 0).sum() / 50**3 == pytest.approx(volume, rel=0.02)


def test_blend_contains_the_union_and_little_more() -> None:
    points = np.random.default_rng(1).uniform(-1, 1, (5000, 3))
    a, b = implicit.ball(points, (0.3, 0, 0), 0.4), implicit.ball(points, (-0.3, 0, 0), 0.4)
    blended, union = implicit.blend(0.1, a, b), implicit.union(a, b)
    assert (blended <= union + 1e-12).all()
    assert (union - blended).max() <= 0.1 / 4 + 1e-12
