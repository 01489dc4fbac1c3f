"""The booklet: all pages in a PDF file."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import matplotlib
from matplotlib.backends.backend_pdf import PdfPages

from ..draw.files import whole
from .assembly import Assembly
from .documents import Document
from .front_pages import CHECKLIST, card_page, checklist_pages, cover, last_page
from .guide import guide_page
from .sheets import Sheet
from .step_pages import step_page


def write_booklet(
    assembly: Assembly, document: Document, file: Path, paper: str, pitch_mm: float
) -> None:
    """Write the pages; equal manuals give equal bytes, and no half-written file is left."""
    about = {"Title": f"{document.model}: operation manual", "CreationDate": None, "ModDate": None}
    with (
        matplotlib.rc_context({"pdf.fonttype": 42, "font.family": "DejaVu Sans"}),
        whole(file, ".pdf") as half,
        PdfPages(half, metadata=about) as pdf,
    ):
        for sheet in _pages(assembly, document, paper, pitch_mm):
            pdf.savefig(sheet.figure)


def _pages(assembly: Assembly, document: Document, paper: str, pitch_mm: float) -> Iterator[Sheet]:
    name, n_steps = document.model, len(document.steps)
    first = 4 + -(-n_steps // CHECKLIST)
    n_pages = first + n_steps
    yield cover(assembly, document, paper, pitch_mm, n_pages)
    yield guide_page(name, document.blocks, paper, 2, n_pages)
    yield card_page(assembly, document, paper, pitch_mm, 3, n_pages)
    yield from checklist_pages(document, paper, 4, n_pages)
    for row in document.steps:
        yield step_page(assembly, row, name, paper, first + row.step - 1, n_pages)
    yield last_page(assembly, document, paper, n_pages)
