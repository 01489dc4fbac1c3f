"""Dots where the numbers are, and pages side by side."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from lineup import draw

TABLE = pd.DataFrame({"paper": [0.9, np.nan], "ours": [0.95, 0.99]}, ["bunny", "duck"])


def placed(figure):
    """(column, row, value) of every dot that is seen."""
    axes = figure.axes[0]
    return {
        (dots.get_label(), round(y), float(x))
        for dots in axes.collections
        for x, y in np.ma.getdata(dots.get_offsets())
        if np.isfinite(x)
    }


def test_every_number_is_a_dot_on_the_line_of_its_row():
    seen = placed(draw.dots(TABLE, "coverage", "how much", mark=0.5))
    assert seen == {("paper", 0, 0.9), ("ours", 0, 0.95), ("ours", 1, 0.99)}


def test_equal_numbers_are_all_seen():
    equal = pd.DataFrame(np.ones((1, 8)), ["all"], list("abcdefgh"))
    heights = [dots.get_offsets()[0, 1] for dots in draw.dots(equal, "").axes[0].collections]
    assert np.diff(heights).min() > 0.05
    assert np.abs(heights).max() < 0.5


def test_the_first_row_is_on_top():
    low, high = draw.dots(TABLE, "coverage").axes[0].get_ylim()
    assert low > high


@pytest.mark.parametrize("log", [False, True])
def test_a_line_joins_the_least_and_the_most_of_a_row(log):
    lines = draw.dots(TABLE, "coverage", log=log).axes[0].lines
    assert [line.get_xdata().tolist() for line in lines] == [[0.9, 0.95], [0.99, 0.99]]


@pytest.mark.parametrize(
    ("table", "log"),
    [
        (TABLE.iloc[:0], False),
        (TABLE[[]], False),
        (pd.DataFrame(np.ones((1, 9))), False),
        (TABLE.replace(0.99, np.inf), False),
        (TABLE.replace(0.99, 0.0), True),
    ],
)
def test_what_cannot_be_placed_is_refused(table, log):
    with pytest.raises(ValueError, match="got"):
        draw.dots(table, "coverage", log=log)


def test_pages_lie_side_by_side_in_their_order():
    shades = ("#ff0000", "#00ff00", "#0000ff")
    figure = draw.spread([Figure(figsize=(2, 3), facecolor=shade) for shade in shades])
    middles = [axes.get_images()[0].get_array()[100, 100] for axes in figure.axes]
    assert [int(np.argmax(middle)) for middle in middles] == [0, 1, 2]
    lefts = [axes.get_position().x0 for axes in figure.axes]
    assert lefts == sorted(lefts)


def test_pages_keep_their_shape():
    figure = draw.spread([Figure(figsize=(2, 3)), Figure(figsize=(4, 3))])
    sides = [axes.get_window_extent() for axes in figure.axes]
    assert [side.width / side.height for side in sides] == pytest.approx([2 / 3, 4 / 3], rel=0.01)


def test_no_page_is_refused():
    with pytest.raises(ValueError, match="one page"):
        draw.spread([])
