"""The pages around the steps: cover, base card, checklist, and the finished model."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

import numpy as np

from ..draw.page import GREY, INK
from .assembly import Assembly
from .build import LYING
from .documents import Document, StepRow
from .grade import SECONDS_A_BEND, SECONDS_A_STEP, SECONDS_A_SWING, WORDS
from .pictures import body_picture, model_picture
from .plans import Plan, base_bar, ground
from .scene import loose_ends
from .sheets import MARGIN, POINT, Sheet, blank, box, compass, foot, line, say, show, title
from .step_pages import WAYS, hanging

_DOTS = 6.5  # of a picture, to the millimetre
CHECKLIST = 44
"""Steps on a page of the checklist."""


def cover(
    assembly: Assembly, document: Document, paper: str, pitch_mm: float, n_pages: int
) -> Sheet:
    """Title, picture, what it takes, and what the judge says."""
    sheet = blank(paper)
    say(sheet, MARGIN, 16, document.model, 34, fontweight="bold")
    say(sheet, MARGIN, 33, "Operation manual: from the straight chain to the model", 13, color=GREY)
    width, height = sheet.width - 2 * MARGIN, 118.0
    image = model_picture(assembly.folding.path.voxels, round(_DOTS * width), round(_DOTS * height))
    show(sheet, MARGIN, 42, width, height, image)
    _facts(sheet, document, pitch_mm, 166)
    _difficulty(sheet, document, 208)
    _verdict(sheet, document, sheet.height - 50)
    foot(sheet, f"{document.model} · page 1 of {n_pages}")
    return sheet


def _facts(sheet: Sheet, document: Document, pitch_mm: float, top: float) -> None:
    sides = " × ".join(f"{side * pitch_mm:g}" for side in _upright_size(document))
    facts = (
        (
            "Chain",
            f"{document.blocks} blocks, {document.voxels} voxels of {pitch_mm:g} mm, "
            f"{document.voxels * pitch_mm / 1000:.2f} m long",
        ),
        ("Model", f"{sides} mm"),
        ("Steps", f"{len(document.steps)}, a page each"),
        (
            "Time",
            f"about {_hours(document.grade['minutes'])}, if a bend takes {SECONDS_A_BEND} s, "
            f"a page {SECONDS_A_STEP} s and a swing of a loose end {SECONDS_A_SWING} s (assumed)",
        ),
    )
    for k, (name, text) in enumerate(facts):
        say(sheet, MARGIN, top + 8.5 * k, name, 11, fontweight="bold")
        say(sheet, MARGIN + 30, top + 8.5 * k, textwrap.fill(text, 72), 11)


def _upright_size(document: Document) -> tuple[int, int, int]:
    voxels = np.array([voxel for row in document.rows for voxel in row.voxels])
    x, y, z = (np.ptp(voxels, axis=0) + 1).tolist()
    return x, y, z


def _hours(minutes: int) -> str:
    return f"{minutes} min" if minutes < 60 else f"{minutes // 60} h {minutes % 60:02d} min"


def _difficulty(sheet: Sheet, document: Document, top: float) -> None:
    grade = document.grade
    say(sheet, MARGIN, top, "Difficulty", 11, fontweight="bold")
    for k in range(5):
        x = MARGIN + 33 + 7 * k
        full = k < grade["grade"]
        # Where pixels are drawn a line without length is no dot, nor one that is snapped to them.
        dot = [(x, top + 2.2), (x + 0.01, top + 2.2)]
        line(sheet, dot, 5, INK, snap=False)
        if not full:
            line(sheet, dot, 4, "white", zorder=3, snap=False)
    word = WORDS[grade["grade"] - 1]
    say(sheet, MARGIN + 30 + 40, top, f"{word}: {grade['points']} points", 11)
    how = (
        f"{grade['blocks']} blocks + 4 × {grade['visits']} layer visits "
        f"+ 10 × {grade['limbs'] - 1} limbs beside the first + 6 × {grade['swings']} swings "
        f"+ 2 × {grade['turns']} hinges with a sign + 2 × {grade['covered']} voxels that go "
        "below others; from 100, 300, 900 and 2700 points on a model is a grade harder"
    )
    say(sheet, MARGIN + 30, top + 6.5, textwrap.fill(how, 88), 8.5, color=GREY)


def _verdict(sheet: Sheet, document: Document, top: float) -> None:
    """What the judge says of the motion, in a frame: a double one if it is certified."""
    verdict = document.verdict
    width = sheet.width - 2 * MARGIN
    box(sheet, MARGIN, top, width, 32, linewidth=1.4)
    blocks = f"blocks {document.diameter:g} voxels thick and bends up to {document.max_bend_deg:g}°"
    if verdict.ok:
        head = "CERTIFIED"
        text = (
            f"From the straight chain to the model no block meets another, for {blocks} "
            f"({verdict.moves_checked} moves checked at every instant, the shortest distance kept "
            f"is {verdict.clearance:.4g})."
        )
    else:
        head = "NOT CERTIFIED"
        text = f"{verdict.reason}; judged for {blocks}. Some steps may not be possible."
    say(sheet, MARGIN + 4, top + 3.5, head, 13, fontweight="bold")
    say(sheet, MARGIN + 4, top + 11, textwrap.fill(f"{text} {_slots(document)}", 98), 9.5)


def _slots(document: Document) -> str:
    """What the certificate says of printed slots."""
    twists = sum(row.twists for row in document.rows)
    signs = document.grade["turns"]
    if twists:
        return (
            f"Joints may bend in any plane there. In printed slots, {twists} hinges (marked *) "
            "have to be straightened first, which the certificate does not cover."
        )
    if signs:
        return f"No piece is twisted in its slots if the {signs} hinges marked * or + bend as told."
    return "No piece is twisted in its slots."


def card_page(
    assembly: Assembly, document: Document, paper: str, pitch_mm: float, page: int, n_pages: int
) -> Sheet:
    """The base card, to size if it fits, with the base on it."""
    sheet = blank(paper)
    title(sheet, "Base card", "Lay this page flat on the table, its foot towards you.")
    columns, rows = assembly.places[:, :2].max(axis=0).tolist()
    room = (sheet.width - 2 * MARGIN - 8) / columns, (sheet.height - 150) / rows
    cell = min(pitch_mm, *room)
    plan = Plan((sheet.width - columns * cell) / 2, 40, cell, (columns, rows))
    layer = int(assembly.places[list(assembly.base), 2].min())
    ground(sheet, plan, assembly.places[:0], layer)
    base_bar(sheet, plan, assembly, layer)
    x, y = plan.at(assembly.places[list(assembly.base)]).mean(axis=0).tolist()
    say(sheet, x, y - 0.55 * cell, "base", 0.3 * cell * POINT, ha="center", va="center", zorder=5)
    compass(sheet, plan.left + columns * cell + 5, plan.top + 5)
    y = plan.top + rows * cell + 10
    size = "to size" if cell == pitch_mm else f"at {cell / pitch_mm:.0%} of its size"
    say(sheet, MARGIN, y, f"A square is a voxel of {pitch_mm:g} mm, drawn {size}.", 9, color=GREY)
    _base_text(sheet, assembly, y + 8)
    _lying(sheet, assembly, sheet.height - 16 - 74)
    foot(sheet, f"{document.model} · page {page} of {n_pages}")
    return sheet


def _base_text(sheet: Sheet, assembly: Assembly, top: float) -> None:
    a, b = assembly.base
    kind = (
        f"the hinge of block {a // 2 + 1}"
        if a % 2 == 0
        else (f"the piece between hinges {a // 2 + 1} and {b // 2 + 1}")
    )
    ends = [
        f"The {end.name} end of the chain then points {WAYS['ENUWSD'[end.direction]]}."
        for end in loose_ends(assembly, 0)
    ]
    ends += [hanging(end) for end in loose_ends(assembly, 0) if end.hangs]
    (column, row, layer), (column2, row2, layer2) = assembly.places[[a, b]].tolist()
    raised = min(layer, layer2)
    upright = (column, row) == (column2, row2)
    texts = [
        "1.  Lay the chain out straight. Mark its head, its tail, and every tenth hinge.",
        f"2.  Find the base: {kind}.",
        f"3.  Put it on the card as drawn: on column {column}, row {row}"
        + (", upright." if upright else f", and on column {column2}, row {row2}."),
        *(f"     {text}" for text in [*_raised(raised), *ends]),
    ]
    say(sheet, MARGIN, top, "\n".join(texts), 10.5, linespacing=1.6)


def _raised(layer: int) -> list[str]:
    """What to do about a base that is not on the table."""
    if layer == 1:
        return []
    many = f"{layer - 1} voxel" + ("s" if layer > 2 else "")
    return [f"It is in layer {layer}: put something as high as {many} under it."]


def _lying(sheet: Sheet, assembly: Assembly, top: float) -> None:
    """How the model lies while it is folded."""
    width, height = 88.0, 72.0
    dots = round(_DOTS * width), round(_DOTS * height)
    picture = body_picture(assembly.places, assembly.places[:0], [], *dots)
    show(sheet, sheet.right - width, top, width, height, picture.image)
    how = LYING[assembly.build.down]
    turn = "" if assembly.build.down == "D" else " At the end you turn it over."
    text = f"The model is folded {how}, as you see it here.{turn}"
    say(sheet, MARGIN, top + 20, textwrap.fill(text, 40), 11)


def checklist_page(document: Document, paper: str, page: int, first: int, n_pages: int) -> Sheet:
    """A page of the table of all steps, to tick; `first` is the first of these pages."""
    sheet = blank(paper)
    title(sheet, "Steps", "Tick each when its check is right.")
    start = (page - first) * CHECKLIST
    _table(sheet, document.steps[start : start + CHECKLIST])
    foot(sheet, f"{document.model} · page {page} of {n_pages}")
    return sheet


_COLUMNS = (
    ("step", 10),
    ("end", 26),
    ("layers", 52),
    ("blocks", 80),
    ("new voxels", 142),
    ("in place", 166),
)


def _table(sheet: Sheet, rows: Sequence[StepRow]) -> None:
    top, pitch = 38.0, (sheet.height - 62) / CHECKLIST
    for name, x in _COLUMNS:
        say(sheet, MARGIN + x, top - 5.5, name, 8.5, color=GREY)
    for k, row in enumerate(rows):
        y = top + pitch * k
        box(sheet, MARGIN, y + 0.4, 3.4, 3.4)
        blocks = ", ".join(f"{s.first_block}-{s.last_block}" for s in row.stretches)
        entries = (
            str(row.step),
            " + ".join(dict.fromkeys(s.end for s in row.stretches)),
            ", ".join(map(str, row.layers)),
            textwrap.shorten(blocks, 36, placeholder=" ..."),
            str(row.voxels),
            str(row.voxels_in_place),
        )
        for (_, x), entry in zip(_COLUMNS, entries, strict=True):
            say(sheet, MARGIN + x, y + 0.4, entry, 8.5)


def last_page(assembly: Assembly, document: Document, paper: str, n_pages: int) -> Sheet:
    """The finished model."""
    sheet = blank(paper)
    title(sheet, "Done", f"{document.blocks} blocks, {document.voxels} voxels.")
    width = sheet.width - 2 * MARGIN
    image = model_picture(assembly.folding.path.voxels, round(_DOTS * width), round(_DOTS * 130))
    texts = []
    if assembly.build.down != "D":
        texts.append(
            f"Turn the model over: it was folded {LYING[assembly.build.down]}. "
            "It now stands as in the picture."
        )
    texts += [
        "To unfold it, follow the pages from the last to the first: take off the blocks of each "
        "step in the opposite order, and swing the loose ends back.",
    ]
    say(sheet, MARGIN, 34, "\n\n".join(textwrap.fill(text, 92) for text in texts), 11)
    show(sheet, MARGIN, 70, width, 130, image)
    foot(sheet, f"{document.model} · page {n_pages} of {n_pages}")
    return sheet
