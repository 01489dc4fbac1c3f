"""Rows of a sweep as tables beside the paper's Table 2: CSV, Markdown, LaTeX, terminal."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd
from rich.table import Table

from .storage import write_whole
from .styled import html

TITLE = "Table 2 of the paper, and ours"


@dataclass(frozen=True)
class PaperRow:
    """One row of Table 2 as printed; times in seconds."""

    voxels: int
    seconds_voxelize: float
    path: int
    seconds_path: float
    length: int
    seconds_trim: float
    seconds_per_step: float
    steps: int

    @property
    def hours(self) -> float:
        """Hours of motion planning: time a step times steps."""
        return self.seconds_per_step * self.steps / 3600


PAPER = {
    "bunny": PaperRow(1643, 0.19, 1536, 1.40, 1508, 0.03, 0.72, 240_000),
    "decocube": PaperRow(1868, 0.43, 1504, 0.68, 1508, 0.03, 0.12, 240_000),
    "cannon": PaperRow(2105, 0.59, 1508, 0.74, 1508, 0.04, 0.15, 240_000),
    "two_holed_torus": PaperRow(1520, 0.42, 1512, 0.38, 1508, 0.06, 0.09, 80_000),
    "duck": PaperRow(1586, 0.40, 1484, 0.70, 1508, 0.02, 0.36, 240_000),
    "armadillo": PaperRow(6280, 0.48, 5898, 11.86, 5890, 0.12, 1.80, 70_000),
    "dinosaur": PaperRow(6522, 0.34, 5966, 11.50, 5890, 0.14, 1.10, 150_000),
    "aircraft": PaperRow(7088, 0.99, 6482, 27.47, 5890, 0.19, 0.90, 180_000),
    "elephant": PaperRow(6478, 0.55, 5892, 11.94, 5890, 0.01, 1.32, 180_000),
    "elk": PaperRow(6425, 0.42, 5890, 20.42, 5890, 0.13, 2.04, 180_000),
}
"""The paper's Table 2, by the names of our catalogue."""


def _count(value: Any) -> str:
    return f"{int(value):,}"


def _share(value: Any) -> str:
    return f"{value:.3f}"


def _seconds(value: Any) -> str:
    return f"{value:.1f}"


def _yes(value: Any) -> str:
    return "yes" if value else "no"


COLUMNS: dict[str, tuple[str, Callable[[Any], str]]] = {
    "model": ("model", str),
    "source": ("source", str),
    "voxels": ("voxels", _count),
    "paper_voxels": ("voxels (paper)", _count),
    "iou": ("IoU", _share),
    "layered_coverage": ("layered coverage", _share),
    "folded_coverage": ("folded coverage", _share),
    "paper_coverage": ("coverage (paper)", _share),
    "bound": ("bound", _count),
    "gap": ("gap", _count),
    "surface_kept": ("surface kept", _share),
    "length": ("length", _count),
    "paper_length": ("length (paper)", _count),
    "moves": ("moves", _count),
    "paper_steps": ("steps (paper)", _count),
    "straight": ("straight", _yes),
    "certified": ("certified", _yes),
    "diameter": ("diameter", str),
    "max_bend_deg": ("max bend", "{:g}°".format),
    "clearance": ("min clearance", "{:.4f}".format),
    "seconds_voxelize": ("voxelize, s", _seconds),
    "seconds_layered": ("layered, s", _seconds),
    "seconds_fold": ("fold, s", _seconds),
    "seconds_trim": ("trim, s", _seconds),
    "seconds_certify": ("certify, s", _seconds),
    "paper_hours": ("motion planning (paper), h", _seconds),
    "failure": ("falls short", str),
}
"""Columns of Table 2 in order: heading, and how a value is printed (experiments/FORMAT.md)."""

TERMINAL = {
    "model": "model",
    "source": "source",
    "voxels": "voxels",
    "paper_voxels": "paper",
    "layered_coverage": "layered",
    "folded_coverage": "folded",
    "paper_coverage": "paper",
    "surface_kept": "kept",
    "length": "length",
    "moves": "moves",
    "certified": "certified",
    "seconds": "s",
    "paper_hours": "paper h",
}


def table2(rows: pd.DataFrame) -> pd.DataFrame:
    """The rows of the task `table2` beside the paper's, one for each model (Table 2).

    Parameters
    ----------
    rows : DataFrame
        What `run_sweep` returned. Columns that are missing, because every task failed, are empty.

    Returns
    -------
    DataFrame
        The columns of `COLUMNS`; ``failure`` says how a row falls short of a certified
        unfolding of the length asked for, and is "" where it does not.
    """
    table = rows.copy()
    paper = [PAPER.get(name) for name in rows["model"]]
    for name in ("voxels", "length", "steps", "hours"):
        table[f"paper_{name}"] = [getattr(p, name) if p else None for p in paper]
    table["paper_coverage"] = [p.path / p.voxels if p else None for p in paper]
    table = table.reindex(columns=[*COLUMNS, "blocks", "reason"])
    table["failure"] = [_shortfall(row) for row in table.to_dict("records")]
    return table[list(COLUMNS)]


def _shortfall(row: dict[Any, Any]) -> str:
    if isinstance(row["failure"], str) and row["failure"]:
        return row["failure"]
    missed = []
    if pd.notna(row["blocks"]) and row["length"] != 2 * row["blocks"]:
        missed.append(f"length {row['length']:g} instead of {2 * row['blocks']:g}")
    for name, fault in (("straight", "not straightened"), ("certified", "not certified")):
        if pd.isna(row[name]) or not row[name]:
            missed.append(fault)
    if not missed:
        return ""
    reason = f": {row['reason']}" if isinstance(row["reason"], str) else ""
    return ", ".join(missed) + reason


def write_table(table: pd.DataFrame, folder: Path, name: str = "table2") -> list[Path]:
    """Write NAME.csv (every number, one row a model), NAME.md, .tex and .html (with totals)."""
    printed = _printed(table)
    printed.columns = pd.Index([heading for heading, _ in COLUMNS.values()])
    latex = printed.to_latex(index=False, escape=True)
    markdown = printed.apply(lambda column: column.str.replace("|", "\\|")).to_markdown(
        index=False, disable_numparse=True
    )
    page = html(printed, TITLE, [], n_left=2)
    texts = {"csv": table.to_csv(index=False), "md": f"{markdown}\n", "tex": latex, "html": page}
    return [write_whole(folder / f"{name}.{kind}", text) for kind, text in texts.items()]


def terminal_table(table: pd.DataFrame) -> Table:
    """The columns that matter most, for a terminal of 110 columns; `seconds` sums the stages."""
    stages = [c for c in table if str(c).startswith("seconds_")]
    printed = _printed(table)
    total = table[stages].sum(axis=1)
    printed["seconds"] = [*(_seconds(s) for s in total), _seconds(total.sum())]
    view = Table(box=None, padding=(0, 1, 0, 0), pad_edge=False)
    for name, heading in TERMINAL.items():
        text = name in ("model", "source")
        view.add_column(heading, justify="left" if text else "right", no_wrap=True)
    rows = printed[list(TERMINAL)].to_dict("records")
    for k, row in enumerate(rows):
        view.add_row(*row.values(), style="bold" if k == len(rows) - 1 else None)
    return view


def _printed(table: pd.DataFrame) -> pd.DataFrame:
    """Every cell as text, and a last line with the totals."""
    columns = {
        name: ["–" if pd.isna(value) else how(value) for value in table[name]]
        for name, (_, how) in COLUMNS.items()
    }
    total = dict.fromkeys(COLUMNS, "")
    n_good = int((table["failure"] == "").sum())
    total |= {"model": "total", "certified": f"{n_good} of {len(table)}"}
    for name in [c for c in COLUMNS if c.startswith("seconds_")] + ["paper_hours"]:
        total[name] = _seconds(table[name].sum())
    return pd.DataFrame({name: [*cells, total[name]] for name, cells in columns.items()})
