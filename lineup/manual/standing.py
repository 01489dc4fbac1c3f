"""Whether the body stands after each step of a manual, and how much room the chain then needs."""

from __future__ import annotations

import os
from pathlib import Path

import pandas as pd

from .._files import content
from ..stress import Bonding, standing
from ..stress.results import DENSITY
from .documents import Document
from .reading import read_manual

_UP = {"D": "+z", "U": "-z", "N": "-y", "S": "+y", "E": "-x", "W": "+x"}
"""Which direction of the model is up, by the side of it that is on the table."""


def standing_by_step(
    file: str | os.PathLike[str],
    pitch_mm: float = 10.0,
    *,
    density: float = DENSITY,
    bonding: Bonding | str = "velcro",
) -> pd.DataFrame:
    """Whether the partly folded body stands after each step of a manual (Section 7).

    The body lies on the table as the manual has it, and hands carry the loose ends.

    Parameters
    ----------
    file : path
        NAME.manual.json.
    pitch_mm, density, bonding
        As `strength`.

    Returns
    -------
    DataFrame
        A row for each step, in the columns of `standing` after `step`; boxes are along the axes of
        the model.

    Raises
    ------
    FileNotFoundError, ValueError
        As `read_manual`; a ValueError if the file is the CSV form, which has no steps.

    Examples
    --------
    >>> import numpy as np, tempfile, lineup as lu
    >>> folding = lu.fold(lu.VoxelSolid(np.ones((4, 3, 2), bool)), rounds=20, trial_rounds=5)
    >>> manual = lu.write_manual(folding, tempfile.mkdtemp(), name="brick")
    >>> table = lu.standing_by_step(manual.json)
    >>> int(table["folded"].iloc[-1]), bool(table["stands"].iloc[-1])
    (24, True)
    """
    file = Path(file)
    if file.suffix != ".json":
        raise ValueError(f"{file} has no steps; give the NAME.manual.json written with it")
    folding = read_manual(file)
    document = Document.model_validate_json(content(file))
    moves = [step.moves for step in document.steps]
    table = standing(
        folding, moves, pitch_mm, density=density, bonding=bonding, up=_UP[document.build.down]
    )
    table.insert(0, "step", [step.step for step in document.steps])
    return table
