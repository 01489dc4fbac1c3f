"""The booklet: all pages in a PDF file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure

from ..draw.files import whole
from .assembly import Assembly
from .documents import Document
from .front_pages import CHECKLIST, card_page, checklist_page, cover, last_page
from .guide import guide_page
from .sheets import Sheet
from .step_pages import step_page

_STYLE: Any = {"pdf.fonttype": 42, "font.family": "DejaVu Sans", "text.parse_math": False}


def write_booklet(
    assembly: Assembly, document: Document, file: Path, paper: str, pitch_mm: float
) -> None:
    """Write the pages; equal manuals give equal bytes, and no half-written file is left."""
    about = {"Title": f"{document.model}: operation manual", "CreationDate": None, "ModDate": None}
    with (
        matplotlib.rc_context(_STYLE),
        whole(file, ".pdf") as half,
        PdfPages(half, metadata=about) as pdf,
    ):
        for draw in _pages(assembly, document, paper, pitch_mm):
            pdf.savefig(draw().figure)


def pages_of(
    assembly: Assembly, document: Document, wanted: Sequence[int], paper: str, pitch_mm: float
) -> list[Figure]:
    """The pages of these numbers, from 1, as figures.

    Raises
    ------
    ValueError
        If there is no page of such a number.
    """
    pages = _pages(assembly, document, paper, pitch_mm)
    wrong = [number for number in wanted if not 1 <= number <= len(pages)]
    if wrong:
        raise ValueError(f"this manual has pages 1 to {len(pages)}, got {wrong[0]}")
    with matplotlib.rc_context(_STYLE):
        return [pages[number - 1]().figure for number in wanted]


def _pages(
    assembly: Assembly, document: Document, paper: str, pitch_mm: float
) -> list[Callable[[], Sheet]]:
    """What draws each page, in order."""
    name, n_steps = document.model, len(document.steps)
    first = 4 + -(-n_steps // CHECKLIST)
    n_pages = first + n_steps
    return [
        partial(cover, assembly, document, paper, pitch_mm, n_pages),
        partial(guide_page, name, document.blocks, paper, 2, n_pages),
        partial(card_page, assembly, document, paper, pitch_mm, 3, n_pages),
        *(partial(checklist_page, document, paper, page, 4, n_pages) for page in range(4, first)),
        *(
            partial(step_page, assembly, row, name, paper, first + row.step - 1, n_pages)
            for row in document.steps
        ),
        partial(last_page, assembly, document, paper, n_pages),
    ]
