"""Bodies and a view turned into pixels, by VTK or, where it cannot draw, by matplotlib."""

from __future__ import annotations

import os
import subprocess
import sys
import warnings
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from scipy import ndimage

from ..grid import FloatArray
from .view import Body, Capsules, Cubes, Pixels, Triangles, View

_EDGE_DEG = 30.0  # an edge of a mesh is sharp if its faces turn by more
_OVERSAMPLING = 2  # smooths edges at a tenth of the price of VTK's multisampling in software


@cache
def renderer() -> str:
    """``"vtk"``, or ``"matplotlib"`` with one warning where VTK cannot draw off screen.

    Examples
    --------
    >>> renderer() in ("vtk", "matplotlib")
    True
    """
    if sys.platform == "linux" and not os.environ.get("DISPLAY"):
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    probe = Path(__file__).with_name("probe.py")
    if subprocess.run([sys.executable, probe], capture_output=True, check=False).returncode == 0:
        return "vtk"
    warnings.warn(
        "VTK cannot draw off screen here, so pictures are plainer, by matplotlib; "
        "on Linux, `apt-get install libegl1 libgl1-mesa-dri` would do",
        stacklevel=2,
    )
    return "matplotlib"


def rendered(bodies: Sequence[Body], view: View, width: int, height: int) -> Pixels:
    """A picture of `bodies` on white, with the shadow below them: (height, width, 3) uint8."""
    shown = [body for body in (b.inside(view, width / height) for b in bodies) if len(body)]
    if not shown:
        return np.full((height, width, 3), 255, np.uint8)
    draw = _by_vtk if renderer() == "vtk" else _by_matplotlib
    rgba = draw(shown, view, width, height).astype(np.float64)
    opacity = rgba[..., 3:] / 255
    ground = _shadow(shown, view, width, height)[..., None]
    picture: Pixels = np.rint(rgba[..., :3] * opacity + ground * (1 - opacity)).astype(np.uint8)
    return picture


def _by_vtk(bodies: Sequence[Body], view: View, width: int, height: int) -> Pixels:
    import pyvista  # slow to import, and after `renderer` has chosen the window

    s = _OVERSAMPLING
    plotter: Any = pyvista.Plotter(
        off_screen=True, window_size=[s * width, s * height], lighting="none"
    )
    plotter.render_window.SetMultiSamples(0)
    for body in bodies:
        for mesh in _meshes(body):
            plotter.add_mesh(
                mesh,
                scalars="rgb",
                rgb=True,
                smooth_shading=True,
                ambient=0.4,
                diffuse=0.8,
                specular=0.12,
                specular_power=20,
            )
    _set_up(plotter, view, np.concatenate([body.points for body in bodies]))
    plotter.enable_ssao(radius=2.0, bias=0.15, kernel_size=24)
    plotter.render()  # without it the picture may be of the scene before
    rgba = plotter.screenshot(return_img=True, transparent_background=True)
    plotter.close()
    return _shrunk(rgba, s)


def _meshes(body: Body) -> Iterator[Any]:
    import pyvista

    if isinstance(body, Triangles):
        mesh = pyvista.PolyData.from_regular_faces(body.vertices, body.faces.astype(int))
        mesh["rgb"] = body.rgb
        yield mesh.compute_normals(split_vertices=True, feature_angle=_EDGE_DEG)
        return
    if isinstance(body, Cubes):
        points = pyvista.PolyData(body.centre)
        points["rgb"] = body.rgb
        e = body.edge
        cube = pyvista.Cube(
            x_length=e, y_length=e, z_length=e, clean=False
        )  # a normal to each face
        yield points.glyph(orient=False, scale=False, geom=cube)
        return
    for radius in np.unique(body.radius):
        of = body.radius == radius
        points = pyvista.PolyData((body.start[of] + body.stop[of]) / 2)
        points["rgb"] = body.rgb[of]
        points["bar"] = body.stop[of] - body.start[of]
        rod = pyvista.Capsule(
            center=(0, 0, 0), direction=(1, 0, 0), radius=radius, cylinder_length=1, resolution=10
        )
        yield points.glyph(orient="bar", scale=False, geom=rod)


def _set_up(plotter: Any, view: View, points: FloatArray) -> None:
    """Camera and two lights, which turn with the view, so that all pictures are lit alike."""
    import pyvista

    right, up, back = view.axes
    # Near, for VTK stores positions for its shadows as 16 bit floats; but not so near that the
    # background, which counts as being at the camera, throws shadows.
    far = float(view.seen(points)[:, 2].max()) + 20
    for direction, intensity in ((back - right + 1.5 * up, 1.0), (back + right, 0.45)):
        light = pyvista.Light(
            position=tuple(view.centre + far * direction),
            focal_point=tuple(view.centre),
            intensity=intensity,
            light_type="scene light",
        )
        light.positional = False
        plotter.add_light(light)
    plotter.camera.position = tuple(view.centre + far * back)
    plotter.camera.focal_point = tuple(view.centre + (far - 1) * back)
    plotter.camera.up = (0, 0, 1)
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = view.half_height
    plotter.renderer.ResetCameraClippingRange()


def _shrunk(rgba: Pixels, s: int) -> Pixels:
    """Means of s by s pixels, colours weighted by their opacity."""
    height, width = rgba.shape[0] // s, rgba.shape[1] // s
    blocks = rgba.reshape(height, s, width, s, 4).astype(np.float64)
    weight = blocks[..., 3:]
    total = weight.sum(axis=(1, 3))
    colour = (blocks[..., :3] * weight).sum(axis=(1, 3)) / np.maximum(total, 1)
    shrunk: Pixels = np.rint(np.concatenate([colour, total / s**2], axis=2)).astype(np.uint8)
    return shrunk


def _shadow(bodies: Sequence[Body], view: View, width: int, height: int) -> FloatArray:
    """Grey values (height, width) of a white floor under the bodies, darker where they stand."""
    right, up, back = view.axes
    if back[2] < 0.05:  # no floor is seen from its side or from below
        return np.full((height, width), 255.0)
    points = np.concatenate([body.points for body in bodies])
    # The floor point of a pixel: the point (a, b) of the picture plane, and on along the view.
    unit = 2 * view.half_height / height
    a = (np.arange(width) + 0.5 - width / 2) * unit
    b = (height / 2 - 0.5 - np.arange(height)) * unit
    plane = view.centre + a[None, :, None] * right + b[:, None, None] * up
    floor = points[:, 2].min() - 0.5
    on_floor = plane - ((plane[..., 2] - floor) / back[2])[..., None] * back
    near = points[points[:, 2] < floor + 0.6 * view.half_height]
    reach = 8
    low = np.floor(near[:, :2].min(axis=0)).astype(int) - reach
    size = np.ceil(near[:, :2].max(axis=0)).astype(int) + reach + 1 - low
    stamp = np.zeros(tuple(size))
    cell = np.rint(near[:, :2]).astype(int) - low
    np.maximum.at(stamp, (cell[:, 0], cell[:, 1]), np.exp(-(near[:, 2] - floor) / 4))
    soft = ndimage.gaussian_filter(stamp, 1.5)
    at = (on_floor[..., :2] - low).transpose(2, 0, 1)
    grey: FloatArray = 255 - 110 * ndimage.map_coordinates(soft, at, order=1)
    return grey


def _by_matplotlib(bodies: Sequence[Body], view: View, width: int, height: int) -> Pixels:
    """The same by a painter: everything in one plane, the far before the near."""
    figure = Figure(figsize=(width / 100, height / 100), dpi=100)
    figure.patch.set_alpha(0)
    canvas: Any = FigureCanvasAgg(figure)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.axis("off")
    half_width = view.half_height * width / height
    axes.set_xlim(-half_width, half_width)
    axes.set_ylim(-view.half_height, view.half_height)
    points_a_voxel = 72 * height / 100 / (2 * view.half_height)
    for body in bodies:
        if isinstance(body, Triangles):
            _paint_triangles(axes, body, view)
        elif isinstance(body, Cubes):
            _paint_cubes(axes, body, view)
        else:
            _paint_capsules(axes, body, view, points_a_voxel)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba()).copy()


def _paint_capsules(axes: Any, body: Capsules, view: View, points_a_voxel: float) -> None:
    """Each rod as a wide dark line under a narrower bright one, paler with depth."""
    ends = np.stack([view.seen(body.start), view.seen(body.stop)], axis=1)
    depth = ends[..., 2].mean(axis=1)
    order = np.argsort(depth, kind="stable")
    nearness = (depth - depth.min()) / max(float(np.ptp(depth)), 1.0)
    bright = body.rgb / 255 * (0.55 + 0.45 * nearness[:, None])
    lines = np.repeat(ends[order, :, :2], 2, axis=0)
    shades = np.stack([0.45 * bright, bright], axis=1)[order].reshape(-1, 3)
    widths = np.outer(body.radius[order], [2.0, 1.5]).ravel() * points_a_voxel
    axes.add_collection(
        LineCollection(list(lines), colors=shades, linewidths=widths, capstyle="round")
    )


def _paint_cubes(axes: Any, body: Cubes, view: View) -> None:
    """The three faces of each cube that look at the camera."""
    square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) / 2
    faces = np.zeros((3, 4, 3))
    for axis in range(3):
        faces[axis][:, [k for k in range(3) if k != axis]] = square
        faces[axis][:, axis] = 0.5 * np.sign(view.back[axis])
    order = np.argsort(view.seen(body.centre)[:, 2], kind="stable")
    corners = body.centre[order, None, None] + body.edge * faces
    outlines = view.seen(corners.reshape(-1, 3))[:, :2].reshape(-1, 4, 2)
    shade = np.array([0.8, 0.65, 1.0])[None, :, None]
    colour = (body.rgb[order, None] / 255 * shade).reshape(-1, 3)
    axes.add_collection(PolyCollection(list(outlines), facecolors=colour, edgecolors=colour * 0.7))


def _paint_triangles(axes: Any, body: Triangles, view: View) -> None:
    """The faces that look at the camera, the brighter the more they look up and to it."""
    corners = view.seen(body.vertices)[body.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    order = np.argsort(corners[:, :, 2].mean(axis=1), kind="stable")
    order = order[normal[order, 2] > 0]
    light = 0.45 + 0.55 * np.clip(normal[order] @ (-0.3, 0.5, 0.81), 0, 1)
    colour = light[:, None] * body.rgb[body.faces[order, 0]] / 255
    outlines = list(corners[order, :, :2])
    axes.add_collection(PolyCollection(outlines, facecolors=colour, edgecolors=colour, lw=0.4))
