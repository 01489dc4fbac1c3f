"""Rows of any task as tables and pictures: nothing lost, nothing made up, the same bytes."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.collections import PathCollection

from lineup import draw, styled
from lineup.experiment import Experiment, Layout, Plot

ROWS = pd.DataFrame(
    {
        "model": ["b", "b", "a", "a", "c"],
        "voxels": [1000, 500, 500, 1000, 500],
        "coverage": [0.9, 0.7, 0.8, 1.0, np.nan],
        "certified": [True, True, False, True, None],
        "steps": [np.nan, 10, 10, 100, 10],
        "failure": ["", "", "", "", "no | such <mesh> & 5 %"],
    }
)


def whole(**more):
    return Experiment(title="T <1>", task="path", grids=[{"model": "a"}], **more)


def test_values_in_words():
    found = [
        styled.printed("coverage", 1.0),
        styled.printed("length", 1234),
        styled.printed("safety", 0.0643887),
        styled.printed("certified", np.False_),
        styled.printed("steps", np.nan),
        styled.printed("steps", None),
        styled.printed("reason", "stuck"),
    ]
    assert found == ["1.000", "1,234", "0.06439", "no", "–", "–", "stuck"]


def test_a_layout_spreads_a_column_and_leaves_out_what_failed():
    layout = Layout(index="model", columns="voxels", values="coverage")
    assert styled.laid_out(ROWS, layout).to_dict("records") == [
        {"model": "b", "500": "0.700", "1,000": "0.900"},
        {"model": "a", "500": "0.800", "1,000": "1.000"},
    ]


@pytest.mark.parametrize(
    ("aggregate", "value"), [("median", 0.8), ("mean", 0.8), ("min", 0.7), ("max", 0.9)]
)
def test_rows_are_put_together(aggregate, value):
    layout = Layout(index="model", values=["coverage", "certified"], aggregate=aggregate)
    found = styled.laid_out(ROWS, layout).to_dict("records")
    assert found[0] == {"model": "b", "coverage": f"{value:.3f}", "certified": "yes"}
    assert found[1]["certified"] == "1 of 2"


def test_numbers_are_sorted_and_the_missing_come_last():
    layout = Layout(index="steps", values="coverage")
    assert styled.laid_out(ROWS, layout)["steps"].tolist() == ["10", "100", "–"]


def test_files_hold_every_row_and_say_what_fell_short(tmp_path):
    experiment = whole(table={"index": "model", "values": "coverage"}, about="What it is.")
    csv, md, tex, html = styled.write_rows(ROWS, tmp_path, "t", experiment)
    again = pd.read_csv(csv, keep_default_na=False, na_values={"coverage": [""], "steps": [""]})
    assert again["coverage"].equals(ROWS["coverage"])
    assert again["failure"].tolist() == ROWS["failure"].tolist()
    lines = md.read_text().splitlines()
    assert lines[0] == "# T <1>"
    assert "| a       |      0.900 |" in lines
    assert lines[-3:] == ["What it is.", "", "c falls short: no | such <mesh> & 5 %"]
    page = html.read_text()
    assert "T &lt;1&gt;" in page
    assert "no | such &lt;mesh&gt; &amp; 5 %" in page
    assert "0.900" in page
    assert "\\begin{tabular}{lr}" in tex.read_text()
    first = [file.read_bytes() for file in (csv, md, tex, html)]
    assert first == [
        file.read_bytes() for file in styled.write_rows(ROWS.copy(), tmp_path, "t", experiment)
    ]


def test_without_a_layout_every_row_is_a_line(tmp_path):
    table = styled.laid_out(ROWS, None)
    assert len(table) == 5
    assert table["falls short"].tolist() == ROWS["failure"].tolist()
    assert table["certified"].tolist() == ["yes", "yes", "no", "yes", "–"]
    assert styled.terminal(ROWS, whole()).row_count == 5


def test_all_failed(tmp_path):
    rows = pd.DataFrame({"model": ["c"], "failure": ["no"]})
    experiment = whole(table={"index": "model", "values": "model"})
    assert all(f.stat().st_size for f in styled.write_rows(rows, tmp_path, "t", experiment))


def test_lines_run_through_medians():
    rows = pd.concat([ROWS, ROWS.assign(coverage=ROWS["coverage"] + 0.05)], ignore_index=True)
    figure = draw.experiment(rows, Plot(x="voxels", y="coverage", by="model", log="x"))
    axes = figure.axes[0]
    assert axes.get_xscale() == "log"
    lines = {line.get_label(): line.get_xydata().tolist() for line in axes.lines}
    assert set(lines) == {"a", "b"}
    assert lines["b"] == [[500, pytest.approx(0.725)], [1000, pytest.approx(0.925)]]
    assert axes.texts[0].get_text().endswith("; 2 of the rows have no value here")


def test_a_row_without_x_is_a_level_line():
    axes = draw.experiment(ROWS, Plot(x="steps", y="coverage")).axes[0]
    level = [line for line in axes.lines if list(line.get_xdata()) == [0, 1]]  # from side to side
    assert [line.get_ydata()[0] for line in level] == [0.9]


def test_texts_are_dots_side_by_side_with_their_median():
    axes = draw.experiment(ROWS, Plot(x="model", y="coverage", by="voxels")).axes[0]
    assert [label.get_text() for label in axes.get_xticklabels()] == ["b", "a"]
    dots = [c.get_offsets() for c in axes.collections if isinstance(c, PathCollection)]
    shown = np.vstack(dots)
    assert sorted(shown[:, 1].tolist()) == [0.7, 0.8, 0.9, 1.0]
    assert len(set(shown[:, 0].tolist())) == 4


def test_equal_rows_give_equal_pictures(tmp_path):
    plot = Plot(x="voxels", y="coverage", by=["model"])
    files = [
        draw.save(draw.experiment(ROWS, plot, "t"), tmp_path / f"{k}.png").read_bytes()
        for k in range(2)
    ]
    assert files[0] == files[1]


@pytest.mark.parametrize(
    ("plot", "message"),
    [
        ({"x": "size", "y": "coverage"}, "no column 'size' in the rows; there are: model, "),
        ({"x": "voxels", "y": "model"}, "y of a plot must be a column of numbers, and 'model'"),
    ],
)
def test_a_plot_that_cannot_be_is_refused(plot, message):
    with pytest.raises(ValueError, match=message):
        draw.experiment(ROWS, Plot(**plot))
