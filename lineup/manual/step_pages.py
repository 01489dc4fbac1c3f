"""A page for each step: plans, the body so far, the letters, and a check."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

import numpy as np

from .. import grid
from ..draw.page import GREY, INK
from ..grid import IntArray
from .actions import ENDS, TAIL, Action
from .assembly import Assembly
from .build import covered
from .documents import StepRow
from .pictures import LooseEnd, body_picture
from .plans import Plan, base_bar, draw_plan
from .scene import in_place, loose_ends
from .sheets import MARGIN, Sheet, blank, box, compass, foot, say, show
from .stretches import Stretch, lines, sign, stretches

WAYS = {
    "E": "E (east, to the right)",
    "N": "N (north, to the back)",
    "U": "U (up)",
    "W": "W (west, to the left)",
    "S": "S (south, to the front)",
    "D": "D (down)",
}
"""Directions in words, by letter."""

SAID = {
    "*": "straighten the hinge out of its piece first, then press it into the slot of its letter.",
    "+": "bend the hinge first, its piece still in line with the loose end; then bend the piece.",
}
"""What the signs ask for, in words."""

MONO, MONO_WIDTH = "DejaVu Sans Mono", 0.2125
"""A typeface all of whose letters are so many millimetres wide, for each point of its size."""

_CHECK, _LOWER = 27.0, 84.0  # millimetres: height of the check, and of what stands above it
_LARGEST_CELL = 20.0
_GAP, _NAME, _FOOT = 14.0, 7.0, 5.0  # for a plan's row numbers and compass, name, column numbers
_PICTURE = 84.0
_AROUND = 2  # cells around what is new, where the plan is not of the whole card
_DOTS = 6.5  # of a picture, to the millimetre


def step_page(
    assembly: Assembly, row: StepRow, name: str, paper: str, page: int, n_pages: int
) -> Sheet:
    """The page of one step."""
    sheet = blank(paper)
    span = assembly.steps[row.step - 1]
    actions = list(assembly.actions[span.start : span.stop])
    old = in_place(assembly, span.start)
    check = sheet.height - 16 - _CHECK
    lower = check - _LOWER
    parts = stretches(actions)
    below = _head(sheet, assembly, row, actions)
    _plans(sheet, assembly, actions, old, below + 3, lower - 3)
    _thumbnail(sheet, assembly, span, old, lower, check - 2)
    _letters(sheet, assembly, parts, lower)
    _check(sheet, assembly, row, check)
    foot(sheet, f"{name} · page {page} of {n_pages}")
    return sheet


def _head(sheet: Sheet, assembly: Assembly, row: StepRow, actions: Sequence[Action]) -> float:
    """What to do in words; where it ends."""
    say(sheet, MARGIN, 11, f"Step {row.step}", 24, fontweight="bold")
    say(sheet, MARGIN + 44, 12.5, f"of {len(assembly.steps)}", 11, color=GREY)
    parts = stretches(actions)
    for k, end in enumerate(dict.fromkeys(part.end for part in reversed(parts))):
        _badge(sheet, sheet.right - 26 - 29 * k, 11, end)
    say(sheet, MARGIN, 22.5, _summary(assembly, row, actions), 11)
    y = 30.0
    for text in _instructions(assembly, parts, actions, assembly.steps[row.step - 1].stop):
        say(sheet, MARGIN, y, text, 9.5)
        y += 5.2 * (1 + text.count("\n"))
    return y


def _badge(sheet: Sheet, left: float, top: float, end: int) -> None:
    """Which end of the chain to work with: black for the tail, white for the head."""
    paper, ink = (INK, "white") if end == TAIL else ("white", INK)
    box(sheet, left, top, 26, 9, facecolor=paper, linewidth=1.5)
    say(
        sheet,
        left + 13,
        top + 4.5,
        ENDS[end].upper(),
        12,
        ha="center",
        va="center",
        color=ink,
        fontweight="bold",
    )


def _summary(assembly: Assembly, row: StepRow, actions: Sequence[Action]) -> str:
    shown = sorted(drawn_layers(assembly.places[_laid(actions)]))
    layers = ", ".join(str(layer) for layer in shown)
    spans: dict[str, list[int]] = {}
    for part in row.stretches:
        spans.setdefault(part.end, [part.first_block])[1:] = [part.last_block]
    blocks = " and ".join(
        f"{first} to {last}" if first != last else f"{first}" for first, last in spans.values()
    )
    many = "s" if len(shown) > 1 else ""
    return f"layer{many} {layers}   ·   blocks {blocks}   ·   {row.voxels} voxels"


def _instructions(
    assembly: Assembly, parts: Sequence[Stretch], actions: Sequence[Action], n_actions: int
) -> list[str]:
    """What to do before the first voxel is laid, and what is out of the common; a line each."""
    texts = ["The base is white on the plan."] if actions[0] is assembly.actions[0] else []
    for k, part in enumerate(parts):
        what = "hinge" if part.laid[0].lays_hinge else "piece"
        when = f"Before the {what} of block {part.blocks[0]}, swing" if k else "Swing"
        texts += [f"{when} the loose {text}." for text in _swings(assembly, part)]
        if part.end not in {before.end for before in parts[:k]}:
            loose = WAYS[assembly.build.letters[part.laid[0].loose]]
            texts.append(
                f"Let the loose {ENDS[part.end]} point {loose}: blocks come in from there."
            )
    places = assembly.places[_laid(actions)]
    if places[-1, 2] not in drawn_layers(places):
        texts.append(f"The hinge of block {parts[-1].blocks[1]} stands upright at the end.")
    texts += [hanging(end) for end in loose_ends(assembly, n_actions) if end.hangs]
    below = covered(assembly.places, assembly.base, assembly.actions)
    hidden = len(set(_laid(actions)) & set(below))
    if hidden:
        texts.append(
            f"{hidden} voxels go below others (hatched): lift the body, or lay them from the side."
        )
    return texts + [
        _signed(one, what, marked)
        for one, what in SAID.items()
        if (marked := [action for action in actions if sign(assembly, action) == one])
    ]


def _signed(one: str, what: str, marked: Sequence[Action]) -> str:
    """What a sign asks for, and where."""
    blocks = [str(action.joint // 2 + 1) for action in marked if not action.swings]
    where = [f"block{'s' if len(blocks) > 1 else ''} {', '.join(blocks)}"] if blocks else []
    where += ["the swing with this sign"] if len(blocks) < len(marked) else []
    text = f"{' and '.join(where).capitalize()}: {what}"
    return textwrap.fill(text, 110, initial_indent=f"{one}  ", subsequent_indent=" " * 5)


def hanging(end: LooseEnd) -> str:
    """What to do about a loose end that points down."""
    return (
        f"The loose {end.name} hangs down ({end.n_voxels} voxels): keep it over the edge of the "
        "table."
    )


def _laid(actions: Sequence[Action]) -> list[int]:
    return [action.joint for action in actions if not action.swings]


def _swings(assembly: Assembly, part: Stretch) -> list[str]:
    letters = assembly.build.letters
    return [
        f"{ENDS[swing.end]} from {letters[swing.was]} to {letters[swing.loose]}"
        + sign(assembly, swing)
        for swing in part.swings
    ]


def _plans(
    sheet: Sheet,
    assembly: Assembly,
    actions: Sequence[Action],
    old: IntArray,
    top: float,
    bottom: float,
) -> None:
    """A plan for each layer, side by side or one above the other, whichever is larger."""
    laid = [action for action in actions if not action.swings]
    new = assembly.places[_laid(actions)]
    layers = drawn_layers(new)
    corner, (columns, rows) = _window(assembly.places, new, len(layers))
    name = _NAME if len(layers) > 1 else 0.0
    across, down, cell = _tiling(
        len(layers), columns, rows, sheet.width - 2 * MARGIN, bottom - top, name
    )
    wide, high = (sheet.width - 2 * MARGIN) / across, (bottom - top) / down
    for k, layer in enumerate(layers):
        row, column = divmod(k, across)
        left = MARGIN + wide * column + _GAP / 2 + (wide - _GAP / 2 - columns * cell) / 2
        up = top + high * row + name + (high - name - _FOOT - rows * cell) / 2
        plan = Plan(left, up, cell, (columns, rows), corner)
        if name:
            say(sheet, left, up - 1.5, f"layer {layer}", 10, va="bottom", fontweight="bold")
        draw_plan(sheet, plan, assembly, old, laid, layer)
        if len(old) == len(assembly.base):
            base_bar(sheet, plan, assembly, layer)
        compass(sheet, left + columns * cell + 4, up + 4)


def drawn_layers(new: IntArray) -> list[int]:
    """Layers of a step that need a plan, in the order in which it comes to them.

    One that only the upper half of the last hinge stands in needs none.
    """
    layers = new[:, 2].tolist()
    if layers.count(layers[-1]) == 1 and len(layers) > 1:
        layers.pop()
    return list(dict.fromkeys(layers))


def _window(
    places: IntArray, new: IntArray, n_plans: int
) -> tuple[tuple[int, int], tuple[int, int]]:
    """First column and row, and how many: all, or around what is new if there are several plans."""
    low, high = np.ones(2, int), places[:, :2].max(axis=0)
    if n_plans > 1:
        low = np.maximum(low, new[:, :2].min(axis=0) - _AROUND)
        high = np.minimum(high, new[:, :2].max(axis=0) + _AROUND)
    (column, row), (columns, rows) = low.tolist(), (high - low + 1).tolist()
    return (column, row), (columns, rows)


def _tiling(
    n: int, columns: int, rows: int, width: float, height: float, name: float
) -> tuple[int, int, float]:
    """Plans across and down, and the largest cell that n plans of so many cells then have."""
    best = (1, n, 0.0)
    for across in range(1, n + 1):
        down = -(-n // across)
        cell = min(
            (width / across - _GAP) / columns, (height / down - name - _FOOT) / rows, _LARGEST_CELL
        )
        best = max(best, (across, down, cell), key=lambda tiling: tiling[2])
    return best


def _thumbnail(
    sheet: Sheet, assembly: Assembly, span: range, old: IntArray, top: float, bottom: float
) -> None:
    """The body with what is new in it, at the left."""
    new = in_place(assembly, span.stop)[len(old) :]
    width, height = _PICTURE, bottom - top
    picture = body_picture(
        assembly.places[old],
        assembly.places[new],
        loose_ends(assembly, span.stop),
        round(_DOTS * width),
        round(_DOTS * height),
    )
    show(sheet, MARGIN, top, width, height, picture.image)
    for name, x, y in picture.names:
        say(sheet, MARGIN + x * width, top + y * height, name, 8.5, ha="center", va="center")


def _letters(sheet: Sheet, assembly: Assembly, parts: Sequence[Stretch], top: float) -> None:
    """Two letters a block, ten blocks a line."""
    left = MARGIN + _PICTURE + 4
    say(sheet, left, top, "To check by: piece and hinge of each block", 8.5, color=GREY)
    texts = []
    several = len({part.end for part in parts}) > 1
    for k, part in enumerate(parts):
        texts += [f"swing the loose {text}" for text in _swings(assembly, part) if k]
        for n, (first, last, words) in enumerate(lines(assembly, part)):
            end = f"{ENDS[part.end] if not n else '':<5}" if several else ""
            blocks = f"{first}-{last}" if first != last else f"{first}"
            texts.append(f"{end}{blocks:>7}  {' '.join(words)}")
    width = sheet.right - left
    size = min(9.5, 128 / len(texts), width / (MONO_WIDTH * max(map(len, texts))))
    say(sheet, left, top + 6, "\n".join(texts), size, family=MONO, linespacing=1.6)


def _check(sheet: Sheet, assembly: Assembly, row: StepRow, top: float) -> None:
    """Where the last block sits, how much is in place, how large the body is."""
    number = assembly.number
    done = assembly.steps[row.step - 1].stop
    whole = int((number.reshape(-1, 2).max(axis=1) <= done).sum())
    column, line, layer = row.last_place
    columns, rows, layers = row.size
    here = assembly.places[number <= done]
    in_layer = int((here[:, 2] == layer).sum())
    box(sheet, MARGIN, top, sheet.width - 2 * MARGIN, _CHECK - 3, linewidth=1.2)
    box(sheet, MARGIN + 4, top + 4, 5, 5, linewidth=1.2)
    say(sheet, MARGIN + 12, top + 3.2, "CHECK", 12, fontweight="bold")
    ends = " ".join(
        f"The loose {end.name} points to {grid.LETTERS[end.direction]}."
        for end in loose_ends(assembly, done)
    )
    text = (
        f"Block {row.last_block} ends in column {column}, row {line}, layer {layer}.",
        f"Voxels in layer {layer} so far: {in_layer}. Blocks in place: {whole} of "
        f"{assembly.n_blocks}.",
        f"Size of the body: {columns} columns, {rows} rows, {layers} layers high.",
        ends,
    )
    say(sheet, MARGIN + 34, top + 3, "\n".join(text), 9.5)
