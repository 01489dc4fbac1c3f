"""The table of symbols: complete, true on the arch, and the one of PAPER.md."""

import re
from pathlib import Path

import pytest

import lineup as lu
from lineup import draw, worked
from lineup.symbols import SYMBOLS, Example, symbols

PAGE = (Path(__file__).parents[1] / "PAPER.md").read_text()
TABLE_1 = [
    "S̃",
    "S",
    "𝒢",
    "p(𝒢)",
    "P̃",
    "P",
    "o",
    "Ω",
    "∂Ω",
    "Ω°",
    "p(o)",
    "v_s",
    "v_e",
    "C",
    "(a, b)",
]


@pytest.fixture(scope="module")
def table():
    return symbols(worked.arch()).set_index("paper")


def test_every_symbol_of_table_1_is_there():
    written = {part for symbol in SYMBOLS for part in symbol.paper.split(", ")}
    written |= {symbol.paper for symbol in SYMBOLS}
    assert set(TABLE_1) <= written


def test_the_page_has_the_same_table():
    rows = re.findall(r"^\| (.*) \| (.*) \| (.*) \|$", PAGE.split("## Map")[0], re.M)
    assert rows[1:] == [(s.paper, s.meaning, s.here) for s in SYMBOLS]


def test_what_is_named_exists():
    spelled = {name for s in SYMBOLS for name in re.findall(r"`draw\.(\w+)", s.here)}
    assert spelled
    assert spelled <= set(draw.__all__)
    public = {name for s in SYMBOLS for name in re.findall(r"`([A-Z]\w+)`", s.here)}
    assert public
    assert public <= {*lu.__all__, "Traversal", "ReebGraph"}


def test_values_of_the_arch(table):
    """By hand: five layers of a 9 x 4 arch, two legs of 4 x 4 and 3 high."""
    values = table["example"]
    assert values["n"] == f"{2 * 36 + 3 * 2 * 16} voxels"
    assert values["𝒢"] == "8 nodes, 7 edges"
    assert values["∂Ω, Ω°"] == f"{2 * 9 + 2 * 2}, {7 * 2} voxels"
    assert values["I_i"] == f"{7 * 2} voxels"
    assert values["MSP, C"] == "7-6-4-2-0; 6-5-3-1-3-5-6"
    assert values["block"] == "84 blocks"


def test_ends_are_those_of_the_first_run():
    example = Example(worked.arch())
    first, last = example.ends()
    assert first == example.path.voxels[0].tolist()
    assert last[2] == first[2]
