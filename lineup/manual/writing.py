"""The operation manual of a folding, as JSON, CSV and a booklet to print (Section 7)."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NamedTuple

from ..judging import certify
from ..solid import Folding
from ..storage import write_whole
from .assembly import assembly_of
from .documents import csv_text, document_of, json_text
from .sheets import check_sheet


class ManualFiles(NamedTuple):
    """The files of a manual."""

    json: Path
    csv: Path
    pdf: Path


def write_manual(
    folding: Folding,
    folder: str | os.PathLike[str],
    *,
    name: str = "model",
    paper: str = "a4",
    pitch_mm: float = 10.0,
) -> ManualFiles:
    """Write how to fold the chain by hand: for programs, and for people to print (Section 7).

    The steps are the motion played backwards, from the straight line to the body, so that who
    follows them is never blocked, as far as the motion is certified; the manual says whether it
    is. If the chain's two ends take turns, their moves are put in the order that changes ends
    least often, and that motion is the one that is judged, and that `read_manual` returns.

    Parameters
    ----------
    folding : Folding
        Of an even number of voxels. Its motion peels and swings the two straight ends of the
        chain until it is a line, as those of ``lu.fold`` by growth do.
    folder : path
        Made if it does not exist.
    name : str
        Of the model; the files are NAME.manual.json, NAME.manual.csv and NAME.manual.pdf.
    paper : str
        "a4" or "letter".
    pitch_mm : float
        Edge of a voxel as printed: for the base card, which is drawn to size if the paper is
        large enough, and the length of the chain.

    Returns
    -------
    ManualFiles
        Paths ``json``, ``csv`` and ``pdf``; docs/formats.md describes the first two.

    Raises
    ------
    ValueError
        If `paper` is unknown, `pitch_mm` is not positive, `name` is no name of a file, the number
        of voxels is odd, or the motion does not end straight or moves in other ways.

    Examples
    --------
    >>> import numpy as np, tempfile, lineup as lu
    >>> folding = lu.fold(lu.VoxelSolid(np.ones((2, 2, 1), bool)), rounds=20, trial_rounds=5)
    >>> lu.write_manual(folding, tempfile.mkdtemp(), name="square").pdf.name
    'square.manual.pdf'
    """
    from .booklet import write_booklet

    check_sheet(paper, pitch_mm)
    if not name or name != Path(name).name:
        raise ValueError(f"name must be that of a file without folders, got {name!r}")
    assembly = assembly_of(folding)
    motion = assembly.folding.motion
    document = document_of(assembly, certify(motion, motion.diameter, motion.max_bend_deg), name)
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    files = ManualFiles(*(place / f"{name}.manual.{kind}" for kind in ("json", "csv", "pdf")))
    write_whole(files.json, json_text(document))
    write_whole(files.csv, csv_text(document.rows))
    write_booklet(assembly, document, files.pdf, paper, pitch_mm)
    return files
