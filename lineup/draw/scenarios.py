"""Runs past obstacles in a row of moments, the wall or shell cut open (Section 8)."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from ..grid import FloatArray, IntArray, surface
from ..kinematics import frames
from ..scenarios import Scenario
from .bodies import chain_body
from .page import caption, page, picture
from .view import Cubes, View, view_of

_STONE = np.array([(232, 228, 220), (186, 178, 166)], np.uint8)
"""Colours of the obstacles, and of them at the cut."""
_HEIGHT, _HEAD = 3.9, 0.7  # inches: of a picture, and of that what the caption takes
_WIDTHS = (2.0, 3.9)  # the least and the most of a picture
_AROUND = 6  # voxels of a straight chain outside that the pictures show
_ASIDE_DEG, _ELEVATION_DEG = 20.0, 16.0  # where the camera stands, from straight before the cut


def run(scenario: Scenario, moments: int = 4) -> Figure:
    """Moments of a run past obstacles, at equal numbers of pulls, the obstacles cut open.

    What is in front of the axis of the tube or capsule is cut off, and the cut is dark. A voxel is
    in place where the goal has one.

    Parameters
    ----------
    moments : int
        Pictures in the row, the start and the end among them.

    Raises
    ------
    ValueError
        If `moments` is less than 2, or the motion has no goal.

    Examples
    --------
    >>> import lineup as lu
    >>> from lineup import draw
    >>> figure = draw.run(lu.into_capsule(2.9, 7.0), moments=2)
    >>> [axes.get_title() for axes in figure.axes][1::2]
    ['0 % in place', '100 % in place']
    """
    motion = scenario.motion
    if moments < 2 or not len(motion.goal):
        raise ValueError(f"a run has a goal and at least 2 moments, got {moments} moments")
    axis, side = _cut(scenario)
    body = _cut_open(scenario, axis, side)
    view, aspect = _view(scenario, body, axis, side)
    width = float(np.clip(aspect * (_HEIGHT - _HEAD), *_WIDTHS))
    figure = page(width * moments, _HEIGHT)
    below = (_HEIGHT - _HEAD) / _HEIGHT
    when = np.rint(np.linspace(0, len(motion), moments)).astype(int).tolist()
    wanted, panel = set(when), 0
    for k, pose in enumerate(frames(motion)):
        if k not in wanted:
            continue
        left, share = panel / moments, 1 / moments
        picture(figure, (left, 0, share, below), [body, chain_body(pose)], view)
        text = f"{_in_place(pose, motion.goal):.0%} in place".replace("%", " %")
        head = figure.add_axes((left, below, share, 1 - below))
        head.axis("off")
        caption(head, f"{text}\nafter pull {k:,} of {len(motion):,}")
        panel += 1
    return figure


def _in_place(pose: FloatArray, goal: IntArray) -> float:
    """Share of the joints of a lattice pose that lie in voxels of the goal."""
    both = np.vstack([np.rint(pose).astype(int), goal])
    return 2 - len(np.unique(both, axis=0)) / len(goal)


def _cut(scenario: Scenario) -> tuple[int, int]:
    """The level axis across which to cut, and the side of the cut that stays, 1 or -1."""
    start = scenario.motion.start.mean(axis=0)
    way = np.abs(scenario.motion.goal.mean(axis=0) - start)
    axis = 1 if way[0] >= way[1] else 0
    return axis, -1 if start[axis] < scenario.centre_line[:, axis].mean() - 1 else 1


def _cut_open(scenario: Scenario, axis: int, side: int) -> Cubes:
    """The obstacles behind the cut, those right behind it in a darker tone."""
    obstacles = scenario.obstacles
    apart = side * (np.arange(obstacles.occupancy.shape[axis]) + obstacles.origin[axis])
    apart = apart - side * scenario.centre_line[:, axis].mean()
    layer = np.moveaxis(obstacles.occupancy, axis, 0)
    kept = np.moveaxis(layer & (apart > 0)[:, None, None], 0, axis)
    voxels = np.argwhere(surface(kept))
    at_cut = apart[voxels[:, axis]] <= 1
    return Cubes((voxels + obstacles.origin).astype(float), _STONE[at_cut.astype(int)], 1.0)


def _view(scenario: Scenario, body: Cubes, axis: int, side: int) -> tuple[View, float]:
    """The view of the obstacles and the chain, and the width of that relative to its height."""
    start, goal = scenario.motion.start, scenario.motion.goal
    points = np.vstack([body.centre, goal])
    near = np.abs(start - np.clip(start, points.min(axis=0), points.max(axis=0))).max(axis=1)
    straight = not np.diff(start, n=2, axis=0).any()
    points = np.vstack([points, start[near <= _AROUND] if straight else start])
    straight_on = {(1, 1): -90.0, (1, -1): 90.0, (0, 1): 180.0, (0, -1): 0.0}[axis, side]
    azimuth = straight_on + _ASIDE_DEG
    seen = view_of(points, 1.0, azimuth, _ELEVATION_DEG).seen(points)[:, :2]
    wide, high = np.ptp(seen, axis=0) + 2
    least, most = (width / (_HEIGHT - _HEAD) for width in _WIDTHS)
    aspect = float(np.clip(wide / high, least, most))
    return view_of(points, aspect, azimuth, _ELEVATION_DEG), aspect
