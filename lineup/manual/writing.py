"""The operation manual of a folding, as JSON, CSV and a booklet to print (Section 7)."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from .._files import plain_name
from ..judging import certify
from ..solid import Folding
from ..storage import write_whole
from .assembly import Assembly, assembly_of
from .documents import Document, csv_text, document_of, json_text
from .sheets import check_sheet

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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
    is, for slotted joints if the motion keeps to the slots, and else for free ones. If the chain's
    two ends take turns, their moves are put in the order that changes ends least often, of orders
    that keep to the slots if it does, and that motion is the one that is judged, and that
    `read_manual` returns.

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

    assembly, document = _laid_out(folding, name, paper, pitch_mm)
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    files = ManualFiles(*(place / f"{name}.manual.{kind}" for kind in ("json", "csv", "pdf")))
    write_whole(files.json, json_text(document))
    write_whole(files.csv, csv_text(document.rows))
    write_booklet(assembly, document, files.pdf, paper, pitch_mm)
    return files


def manual_pages(
    folding: Folding,
    pages: Sequence[int] = (1,),
    *,
    name: str = "model",
    paper: str = "a4",
    pitch_mm: float = 10.0,
) -> list[Figure]:
    """Some pages of the booklet that `write_manual` writes, as figures.

    Parameters
    ----------
    pages : sequence of int
        Their numbers, from 1: the cover, how to read the others, the base card, a checklist, then
        a page for each step, and the finished model.
    folding, name, paper, pitch_mm
        As for `write_manual`.

    Raises
    ------
    ValueError
        As `write_manual`, or if the booklet has no page of such a number.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> folding = lu.fold(lu.VoxelSolid(np.ones((2, 2, 1), bool)), rounds=20, trial_rounds=5)
    >>> (cover,) = lu.manual_pages(folding, [1], name="square")
    >>> cover.get_size_inches().round(1).tolist()
    [8.3, 11.7]
    """
    from .booklet import pages_of

    return pages_of(*_laid_out(folding, name, paper, pitch_mm), pages, paper, pitch_mm)


def _laid_out(
    folding: Folding, name: str, paper: str, pitch_mm: float
) -> tuple[Assembly, Document]:
    check_sheet(paper, pitch_mm)
    plain_name(name)
    assembly = assembly_of(folding)
    motion = assembly.folding.motion
    verdict = certify(motion, motion.diameter, motion.max_bend_deg, joints=assembly.joints)
    return assembly, document_of(assembly, verdict, name)
