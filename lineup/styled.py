"""Rows of any task as a table to read: Markdown, LaTeX, HTML, terminal; and all of them as CSV."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from rich.table import Table

from .experiment import Experiment, Layout
from .storage import write_whole

HEADINGS = {
    "model": "model",
    "voxels": "voxels wanted",
    "n_voxels": "voxels",
    "iou": "IoU",
    "item": "what is trimmed",
    "loss": "loss allowed",
    "lean_deg": "lean, °",
    "tilt_deg": "tilt, °",
    "azimuth_deg": "azimuth, °",
    "max_bend_deg": "max bend, °",
    "mscs": "MSCs",
    "mass_kg": "mass, kg",
    "pitch_mm": "pitch, mm",
    "margin_mm": "margin, mm",
    "sag_mm": "sag, mm",
    "safety": "safety factor",
    "tension_pa": "tension, Pa",
    "corner_tension_pa": "tension at a corner, Pa",
    "compression_pa": "compression, Pa",
    "compression_n": "compression, N",
    "failure": "falls short",
}
"""Headings of columns whose name does not say it; the others are their names with spaces."""

SHARES = {"coverage", "bound", "gap", "surface", "layered", "folded", "iou", "straightness"} | {
    *("removable", "surface_lost"),
}
"""Columns that are shares, and printed to three digits after the point."""

DIGITS = "%.10g"
"""Digits of a number in the CSV: all that mean anything, not the last bits of a sum."""

_STYLES: Any = [
    {"selector": "", "props": "border-collapse: collapse; font: 14px/1.4 system-ui, sans-serif;"},
    {"selector": "caption", "props": "text-align: left; font-weight: bold; padding: 8px 0;"},
    {"selector": "th", "props": "border-bottom: 2px solid #222; padding: 4px 10px;"},
    {"selector": "td", "props": "border-bottom: 1px solid #ddd; padding: 3px 10px;"},
    {"selector": "tr:hover td", "props": "background: #f2f5f8;"},
]
_PAGE = """<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<title>{title}</title>
<body style="margin: 24px; color: #222;">
{table}
{notes}
</body>
</html>
"""


def heading(name: str) -> str:
    """What a column is called in a table and on an axis.

    Examples
    --------
    >>> heading("n_voxels"), heading("surface_lost")
    ('voxels', 'surface lost')
    """
    return HEADINGS.get(name, name.replace("_", " "))


def printed(name: str, value: Any) -> str:
    """One value of a column in words; "–" if there is none.

    Examples
    --------
    >>> printed("coverage", 0.98765), printed("voxels", 50000), printed("stands", True)
    ('0.988', '50,000', 'yes')
    """
    if value is None or (not isinstance(value, str) and pd.isna(value)):
        return "–"
    if isinstance(value, str):
        return value
    if isinstance(value, (bool, np.bool_)):
        return "yes" if value else "no"
    if name in SHARES:
        return f"{value:.3f}"
    return f"{int(value):,}" if float(value).is_integer() else f"{value:.4g}"


def laid_out(rows: pd.DataFrame, layout: Layout | None) -> pd.DataFrame:
    """The rows as they are printed: one line each, or put together as `layout` says.

    Numbers of several rows are put together by the aggregate of the layout, true and false are
    counted, texts are listed; rows that failed are left out, since they have no numbers.

    Returns
    -------
    DataFrame
        Of texts, under headings.

    Raises
    ------
    ValueError
        If the layout names a column that is not there.

    Examples
    --------
    >>> rows = pd.DataFrame({"model": ["a", "a"], "gap": [0.1, 0.3], "failure": ["", ""]})
    >>> laid_out(rows, Layout(index="model", values="gap")).to_dict("records")
    [{'model': 'a', 'gap': '0.200'}]
    """
    if layout is None:
        cells = {heading(n): [printed(n, v) for v in _cells(rows[n])] for n in map(str, rows)}
        return pd.DataFrame(cells)
    check_names(rows, layout.names)
    good = rows[rows["failure"] == ""]
    if good.empty:
        return pd.DataFrame(columns=[heading(name) for name in layout.index])
    good = good.sort_values(layout.index, key=_order, kind="stable")
    lines: dict[tuple[str, ...], dict[str, str]] = {}
    for key, group in good.groupby(layout.index, sort=False, dropna=False):
        index = tuple(printed(n, v) for n, v in zip(layout.index, _tuple(key), strict=True))
        lines[index] = dict(zip(map(heading, layout.index), index, strict=True))
        for name in layout.values:
            for column, part in _parts(good, group, layout.columns):
                title = f"{heading(name)}{f', {column}' if column else ''}"
                only = column if len(layout.values) == 1 and column else title
                lines[index][only] = _together(name, part[name], layout.aggregate)
    return pd.DataFrame(list(lines.values()))


def check_names(rows: pd.DataFrame, names: Iterable[str]) -> None:
    """Refuse a column that the rows do not have."""
    for name in names:
        if name not in rows:
            raise ValueError(
                f"no column {name!r} in the rows; there are: {', '.join(map(str, rows))}"
            )


def _order(column: pd.Series[Any]) -> pd.Series[Any]:
    """What to sort by: numbers, the missing last; or the first place of each text."""
    if pd.api.types.is_numeric_dtype(column):
        return column.astype(float).fillna(np.inf)
    first = {value: k for k, value in reversed(list(enumerate(_cells(column))))}
    return pd.Series([first[value] for value in _cells(column)], index=column.index)


def _tuple(key: Any) -> tuple[Any, ...]:
    return key if isinstance(key, tuple) else (key,)


def _cells(column: pd.Series[Any]) -> list[Any]:
    return column.astype(object).where(column.notna(), None).tolist()


def _parts(
    good: pd.DataFrame, group: pd.DataFrame, columns: str | None
) -> list[tuple[str, pd.DataFrame]]:
    """The rows of a group for each value of the column that is spread, by its printed value."""
    if columns is None:
        return [("", group)]
    ordered = good[columns].iloc[_order(good[columns]).argsort(kind="stable")]
    values = list(dict.fromkeys(printed(columns, v) for v in _cells(ordered)))
    own = [printed(columns, v) for v in _cells(group[columns])]
    return [(value, group[[o == value for o in own]]) for value in values]


def _together(name: str, column: pd.Series[Any], aggregate: str) -> str:
    values = [v for v in _cells(column) if v is not None]
    if not values:
        return "–"
    if all(isinstance(v, (bool, np.bool_)) for v in values):
        same = len(set(values)) == 1
        return printed(name, values[0]) if same else f"{sum(values)} of {len(values)}"
    if any(isinstance(v, str) for v in values):
        return "; ".join(dict.fromkeys(map(str, values)))
    return printed(name, float(pd.Series(values, dtype=float).agg(aggregate)))


def write_rows(rows: pd.DataFrame, folder: Path, name: str, experiment: Experiment) -> list[Path]:
    """Write NAME.csv (every row, every number) and NAME.md, .tex and .html, laid out to read.

    Equal rows give equal bytes.
    """
    table = laid_out(rows, experiment.table)
    fallen = _fallen(rows)
    notes = [line for line in (experiment.about, *fallen) if line]
    texts = {
        "csv": rows.to_csv(index=False, float_format=DIGITS, lineterminator="\n"),
        "md": _markdown(table, experiment.title, notes, _n_left(experiment)),
        "tex": _latex(table, notes, _n_left(experiment)),
        "html": html(table, experiment.title, notes, _n_left(experiment)),
    }
    return [write_whole(folder / f"{name}.{kind}", text) for kind, text in texts.items()]


def _n_left(experiment: Experiment) -> int:
    """How many columns, from the left, are texts rather than numbers."""
    return len(experiment.table.index) if experiment.table else 1


def _fallen(rows: pd.DataFrame) -> list[str]:
    """A line for each row that failed: its settings that are texts, and why."""
    lines = []
    for row in rows[rows["failure"] != ""].to_dict("records"):
        names = [v for k, v in row.items() if isinstance(v, str) and k not in ("failure", "reason")]
        lines.append(f"{' '.join(names) or 'A task'} falls short: {row['failure']}")
    return lines


def _markdown(table: pd.DataFrame, title: str, notes: list[str], n_left: int) -> str:
    cells = table.apply(lambda column: column.str.replace("|", "\\|"))
    sides = ["left"] * n_left + ["right"] * (len(table.columns) - n_left)
    body = cells.to_markdown(index=False, disable_numparse=True, colalign=sides[: cells.shape[1]])
    return "\n\n".join([f"# {title}", body, *notes]) + "\n"


def _latex(table: pd.DataFrame, notes: list[str], n_left: int) -> str:
    sides = "l" * n_left + "r" * (len(table.columns) - n_left)
    body: str = table.to_latex(index=False, escape=True, column_format=sides)
    return body + "".join(f"% {line}\n" for line in notes)


def html(table: pd.DataFrame, title: str, notes: list[str], n_left: int = 1) -> str:
    """A whole page with a styled table, the columns from `n_left` on flush right."""
    import html as escape

    left: Any = list(table.columns[:n_left])
    right: Any = list(table.columns[n_left:])
    styler = (
        table.style.format(escape="html")
        .format_index(escape="html", axis=1)
        .set_caption(escape.escape(title))
        .set_table_styles(_STYLES)
        .set_properties(subset=left, **{"text-align": "left"})
        .set_properties(subset=right, **{"text-align": "right"})
        .hide(axis="index")
        .set_uuid("lineup")
    )
    said = "\n".join(f"<p>{escape.escape(line)}</p>" for line in notes)
    page = _PAGE.format(title=escape.escape(title), table=styler.to_html(), notes=said)
    return "\n".join(line.rstrip() for line in page.splitlines()) + "\n"


def terminal(rows: pd.DataFrame, experiment: Experiment) -> Table:
    """The table for a terminal."""
    table, n_left = laid_out(rows, experiment.table), _n_left(experiment)
    view = Table(box=None, padding=(0, 2, 0, 0), pad_edge=False, title=experiment.title)
    for k, name in enumerate(table.columns):
        view.add_column(str(name), justify="left" if k < n_left else "right")
    for row in table.itertuples(index=False):
        view.add_row(*map(str, row))
    return view
