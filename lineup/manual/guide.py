"""The page that explains the chain, the compass, and how to read a step."""

from __future__ import annotations

import textwrap

import numpy as np

from ..draw.page import GREY, INK
from .plans import BELOW, EMPTY, GRID, HERE, HINGE, PIECE, number_mark
from .sheets import MARGIN, RAMP, Sheet, arrow, blank, box, foot, line, say, title, wedge

_CELL = 13.0


def guide_page(name: str, n_blocks: int, paper: str, page: int, n_pages: int) -> Sheet:
    """How a block works, where directions point, and what the signs on a page say."""
    sheet = blank(paper)
    title(sheet, "How it works")
    _chain(sheet, n_blocks, 28)
    _joint(sheet, 84)
    _compass(sheet, 84)
    _signs(sheet, 140)
    _reading(sheet, 205)
    foot(sheet, f"{name} · page {page} of {n_pages}")
    return sheet


def piece(sheet: Sheet, start: object, stop: object, colour: object = "#b9c4d0") -> None:
    """A printed piece, or half of one where both ends are the same."""
    line(sheet, [start, stop], _CELL * PIECE + 0.5, INK, zorder=3)
    line(sheet, [start, stop], _CELL * PIECE, colour, zorder=3)


def hinge(sheet: Sheet, start: object, stop: object) -> None:
    """A hinge with its two balls."""
    line(sheet, [start, stop], _CELL * HINGE, INK, zorder=4)
    for end in (start, stop):
        line(sheet, [end, end], _CELL * 0.26, INK, zorder=4)


def _chain(sheet: Sheet, n_blocks: int, top: float) -> None:
    say(sheet, MARGIN, top, "The chain", 12, fontweight="bold")
    y = top + 21
    xs = MARGIN + 16 + _CELL * np.arange(8)
    for k in range(0, 9, 2):
        ends = [xs[j] for j in (k - 1, k) if 0 <= j < 8]
        piece(sheet, (ends[0], y), (ends[-1], y))
    for block in range(4):
        hinge(sheet, (xs[2 * block], y), (xs[2 * block + 1], y))
        left, right = xs[2 * block] - 0.42 * _CELL, xs[2 * block + 1] + 0.42 * _CELL
        line(sheet, [(left, y + 7), (left, y + 8.5), (right, y + 8.5), (right, y + 7)], 0.3)
        middle = (left + right) / 2
        say(sheet, middle, y + 9.5, f"block {block + 1}", 8.5, ha="center")
    say(sheet, xs[0] - 6, y, "head", 9.5, ha="right", va="center", fontweight="bold")
    say(sheet, xs[7] + 7, y, "… and so on to the tail", 9.5, va="center", color=GREY)
    _callout(sheet, (xs[1] + xs[2]) / 2, y - 4, y - 9, "piece: printed, stiff")
    _callout(sheet, (xs[6] + xs[7]) / 2, y - 1.5, y - 9, "hinge: a bar with a ball at each end")
    text = (
        "A block is a hinge with half a piece at each of its ends: two voxels. The number of a "
        f"block is that of\nits hinge, from 1 at the head to {n_blocks} at the tail. Before you "
        "start, mark every tenth hinge, say with a thread."
    )
    say(sheet, MARGIN, top + 39, text, 9.5)


def _callout(sheet: Sheet, x: float, y: float, top: float, text: str) -> None:
    line(sheet, [(x, y), (x, top + 1.5)], 0.25)
    say(sheet, x, top + 0.8, text, 8.5, ha="center", va="bottom")


def _joint(sheet: Sheet, top: float) -> None:
    """The five states of a joint."""
    say(sheet, MARGIN, top, "A joint", 12, fontweight="bold")
    say(
        sheet,
        MARGIN,
        top + 7,
        "A hinge goes straight on from its piece, or is bent\nby 90° into one of four slots.",
        9.5,
    )
    states = (
        ("straight", (1, 0)),
        ("left", (0, -1)),
        ("right", (0, 1)),
        ("up", None),
        ("down", None),
    )
    for k, (name, way) in enumerate(states):
        x, y = MARGIN + 10 + 19.5 * k, top + 34
        piece(sheet, (x - 3, y), (x, y))
        if way is not None:
            hinge(sheet, (x, y), (x + 8 * way[0], y + 8 * way[1]))
        else:
            line(sheet, [(x, y), (x, y)], 4.2, INK, zorder=4)
            line(sheet, [(x, y), (x, y)], 3.2, "white", zorder=4.1)
            mark = "•" if name == "up" else "×"
            say(sheet, x, y, mark, 11, ha="center", va="center", zorder=5, fontweight="bold")
        say(sheet, x, top + 46, name, 8.5, ha="center")


def _compass(sheet: Sheet, top: float) -> None:
    """The base card as it lies on the table, and its six directions."""
    left = MARGIN + 108
    say(sheet, left, top, "Directions", 12, fontweight="bold")
    east, north, up = np.array([15.0, 0.0]), np.array([7.0, -9.0]), np.array([0.0, -16.0])
    middle = np.array([left + 26, top + 32])
    corners = [
        middle + a * east * 0.8 + b * north * 0.8 for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    x, y = np.array(corners).T
    sheet.axes.fill(x, y, facecolor="#efefef", edgecolor=GREY, linewidth=0.6)
    for way, letter in ((east, "E"), (north, "N"), (up, "U")):
        for sign, name in ((1, letter), (-1, {"E": "W", "N": "S", "U": "D"}[letter])):
            arrow(sheet, middle, middle + sign * way, 0.45)
            x, y = middle + sign * 1.24 * way
            say(sheet, x, y, name, 10.5, ha="center", va="center", fontweight="bold")
    words = "E  east, right\nW  west, left\nN  north, back\nS  south, front\nU  up\nD  down"
    say(sheet, left + 50, top + 10, words, 9.5)


def _signs(sheet: Sheet, top: float) -> None:
    say(sheet, MARGIN, top, "Signs on the plans: the layer seen from above", 12, fontweight="bold")
    entries = (
        (
            "bars",
            "Thick bar: a piece. Thin bar: a hinge. Lay them one after the other, the way that "
            "the arrows point.",
        ),
        ("ramp", "From dark to light: the first block of the step to the last."),
        (
            "numbers",
            "Numbers of blocks: the first of the step in black, the last in a black square, "
            "every tenth in a ring.",
        ),
        ("leave", "From here the chain goes up to a higher layer, or down to a lower one."),
        ("arrive", "Here the chain arrives, upwards from a lower layer or downwards."),
        (
            "cells",
            "Filled before this step: in the layer below (pale), in this layer (grey), and "
            "somewhere above (hatched).",
        ),
    )
    for k, (sign, text) in enumerate(entries):
        column, row = divmod(k, 3)
        x, y = MARGIN + 92 * column, top + 11 + 17 * row
        _sign(sheet, sign, x, y + 4)
        say(sheet, x + 26, y, textwrap.fill(text, 40), 9)


def _sign(sheet: Sheet, sign: str, x: float, y: float) -> None:
    cell = 8.0
    if sign == "bars":
        _bar(sheet, (x + 3, y), (x + 11, y), cell * HINGE, RAMP(0.4))
        _bar(sheet, (x + 11, y), (x + 19, y), cell * PIECE, RAMP(0.5))
        wedge(sheet, np.array([x + 15.0, y]), np.array([1.0, 0.0]), 2.6, "white", edgecolor="none")
    elif sign == "ramp":
        for k in range(40):
            box(sheet, x + 1 + 0.5 * k, y - 2.5, 0.55, 5, facecolor=RAMP(k / 39), edgecolor="none")
    elif sign == "numbers":
        for k, (number, kind) in enumerate(((17, "first"), (20, ""), (28, "last"))):
            number_mark(sheet, x + 3.5 + 7.5 * k, y, number, 10, kind)
    elif sign in ("leave", "arrive"):
        for k, way in enumerate(((0.0, -1.0), (0.0, 1.0))):
            face, edge = (INK, "white") if sign == "leave" else ("white", INK)
            at = np.array([x + 6.0 + 8 * k, y])
            wedge(sheet, at, np.array(way), 4, face, edgecolor=edge)
    else:
        for k, colour in enumerate((BELOW, HERE, EMPTY)):
            hatch = "////" if colour == EMPTY else ""
            box(
                sheet,
                x + 1 + 7 * k,
                y - 3,
                6,
                6,
                facecolor=colour,
                edgecolor="#8a8a8a" if hatch else GRID,
                hatch=hatch,
                linewidth=0.5,
            )


def _bar(sheet: Sheet, start: object, stop: object, width: float, colour: object) -> None:
    line(sheet, [start, stop], width + 0.35, INK, zorder=2)
    line(sheet, [start, stop], width, colour, zorder=3)


def _reading(sheet: Sheet, top: float) -> None:
    say(sheet, MARGIN, top, "A step", 12, fontweight="bold")
    texts = (
        "1.  Take the end of the chain that the page names, and let it point as it says.",
        "2.  Lay the blocks on the plan from the first number to the last: the piece, then the "
        "hinge (but see 5).",
        "3.  Compare with the picture: what is new is dark.",
        "4.  Check by letters if you like. 11-13  EN WU* SU+  says: block 11, its piece goes E and "
        "its hinge N;\n     block 12, W and U; block 13, S and U. A - stands for what another step "
        "does.",
        "5.  Signs, on plans and letters, are where the slots let a hinge not turn from side to "
        "side.\n     * Straighten it out of its piece, then press it into the slot of its letter."
        "\n     + Bend the hinge first, to its letter, while its piece is still in line "
        "with the loose end. Then bend\n        the piece; hinge and loose end go on pointing as "
        "they did.",
        "6.  Do the check at the foot of the page, and tick the step on the list.",
    )
    say(sheet, MARGIN, top + 7, "\n".join(texts), 9.5, linespacing=1.5)
