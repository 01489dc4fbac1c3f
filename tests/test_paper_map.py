"""The map of PAPER.md: nothing of the paper is left out, and what it names is there."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
NOTEBOOKS = ROOT / "notebooks"
MAP = re.search(r"^## Map\n(.*?)^## ", (ROOT / "PAPER.md").read_text(), re.M | re.S)[1]
ROWS = [
    (what, re.findall(r"`(\w+)`", notebooks), re.findall(r"`tests/(\w+)\.py::(\w+)`", tests))
    for what, notebooks, tests in re.findall(r"^\| (.*?) \| (.*?) \| (.*?) \|$", MAP, re.M)[1:]
]
NAMED = sorted({name for _, notebooks, _ in ROWS for name in notebooks})
TESTS = sorted({test for _, _, tests in ROWS for test in tests})
SECTIONS = ["3", "4", "4.1", "4.2", "4.3", "4.3.1", "4.3.2", "4.4", "5", "6", "7", "8", "9"]
WANTED = [
    *(f"Section {number}" for number in SECTIONS),
    *(f"Figure {number}" for number in range(1, 21)),
    *(f"Table {number}" for number in (1, 2)),
    *(f"Algorithm {number}" for number in range(1, 5)),
    "Lemma 4.1",
    *(f"Theorem 4.{number}" for number in (2, 3, 4)),
]


def test_all_of_the_paper_is_on_the_map_once():
    assert sorted(what for what, _, _ in ROWS) == sorted(WANTED)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[0])
def test_a_row_has_a_notebook_and_a_test(row):
    _, notebooks, tests = row
    assert notebooks
    assert tests


@pytest.mark.parametrize("name", NAMED)
def test_a_notebook_is_there(name):
    assert (NOTEBOOKS / f"{name}.ipynb").is_file()


def test_every_notebook_is_on_the_map():
    assert {file.stem for file in NOTEBOOKS.glob("*.py")} <= set(NAMED)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[0])
def test_the_notebook_says_what_it_shows(row):
    """A figure, table, algorithm or theorem is named in its notebook, beside an assertion."""
    what, notebooks, _ = row
    there = [NOTEBOOKS / f"{name}.py" for name in notebooks]
    kind, number = what.split()
    words = rf"{kind}s?\b[^\n]{{0,30}}?\b{re.escape(number)}\b(?!\.\d)"
    texts = [re.sub(r"\n# ?", " ", file.read_text()) for file in there if file.is_file()]
    assert not texts or any(re.search(words, text) and "assert " in text for text in texts)


def is_skipped(function):
    marks = " ".join(ast.unparse(decorator) for decorator in function.decorator_list)
    return "skip" in marks or "xfail" in marks


@pytest.mark.parametrize(("file", "name"), TESTS, ids=lambda part: part)
def test_a_test_is_there_and_not_skipped(file, name):
    tree = ast.parse((ROOT / "tests" / f"{file}.py").read_text())
    found = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
    assert name in found
    assert not is_skipped(found[name])
    module_marks = [ast.unparse(node) for node in tree.body if "pytestmark" in ast.unparse(node)]
    assert not any("skip" in mark for mark in module_marks)
