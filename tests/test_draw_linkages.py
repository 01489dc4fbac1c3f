"""Figures 12 to 14: projections as linkages."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection

import lineup as lu
from lineup import draw

SCREW = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1), (1, 0, 1)])


def lines_of(axes):
    return [c for c in axes.collections if isinstance(c, LineCollection)]


def test_a_projection_counts_its_composite_squares():
    axes = draw.projection(SCREW).axes[0]
    assert axes.get_title() == "3 composite squares"
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x", "z")
    assert len(lines_of(axes)[0].get_segments()) == len(SCREW) - 1


def test_every_bar_across_the_axis_is_in_the_panel_of_its_depth():
    panels = draw.depths(SCREW).axes
    assert [axes.get_title() for axes in panels] == ["y = 0: 4 joints", "y = 1: 3 joints"]
    assert [len(lines_of(axes)[1].get_segments()) for axes in panels] == [2, 2]


def test_the_depths_with_most_joints_are_shown():
    assert [a.get_title() for a in draw.depths(SCREW, most=1).axes] == ["y = 0: 4 joints"]


@pytest.mark.parametrize("figure", [draw.projection, draw.depths])
def test_there_are_three_axes(figure):
    with pytest.raises(ValueError, match="axis must be 0, 1 or 2, got 3"):
        figure(SCREW, axis=3)


def test_two_stages_of_a_straight_motion():
    path = lu.layered_path(lu.VoxelSolid(np.ones((4, 3, 2), bool)))
    motion = lu.unfold(path, "energy")
    assert motion.straight
    last = draw.two_stages(motion).axes[-1]
    assert last.get_title(loc="left").endswith("one tilt to go")
    ends = lines_of(last)[0].get_segments()
    assert len(ends) == len(path) - 1


def test_two_stages_need_bends():
    path = lu.layered_path(lu.VoxelSolid(np.ones((4, 3, 2), bool)))
    with pytest.raises(ValueError, match="no BEND|has none"):
        draw.two_stages(lu.unfold(path, "peel"))
