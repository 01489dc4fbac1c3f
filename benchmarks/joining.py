"""Tables that grow model by model."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from lineup.storage import write_whole


def joined(rows: pd.DataFrame, file: Path) -> pd.DataFrame:
    """The table in a CSV file with `rows` in place of what it had of the same models, written."""
    rows = rows.round(6)
    if file.is_file():
        former = pd.read_csv(file)
        former = former[~former["model"].isin(rows["model"])]
        rows = pd.concat([former, rows], ignore_index=True) if len(former) else rows
    write_whole(file, rows.to_csv(index=False))
    return rows
