"""Notebooks run from top to bottom, and what is committed says nothing about who ran it."""

import json
import re
from pathlib import Path

import pytest

nbclient = pytest.importorskip("nbclient")
jupytext = pytest.importorskip("jupytext")

FOLDER = Path(__file__).parents[1] / "notebooks"
NAMES = sorted(file.stem for file in FOLDER.glob("*.py"))


@pytest.mark.parametrize("name", NAMES)
def test_a_notebook_runs(name, monkeypatch):
    monkeypatch.setenv("LINEUP_QUICK", "1")
    notebook = jupytext.read(FOLDER / f"{name}.py")
    nbclient.NotebookClient(notebook, timeout=60, kernel_name="python3").execute(cwd=str(FOLDER))
    pictures = [
        output["data"]["image/jpeg"]
        for cell in notebook.cells
        for output in cell.get("outputs", ())
        if "image/jpeg" in output.get("data", {})
    ]
    calls = sum(len(re.findall(r"^draw\.", cell.source, re.M)) for cell in notebook.cells)
    assert len(pictures) == calls > 0


@pytest.mark.parametrize("name", NAMES)
def test_what_is_committed_is_without_times_and_machine(name):
    notebook = json.loads((FOLDER / f"{name}.ipynb").read_text())
    assert set(notebook["metadata"]) == {"jupytext", "kernelspec", "language_info"}
    assert notebook["metadata"]["kernelspec"]["name"] == "python3"
    assert not [cell["metadata"] for cell in notebook["cells"] if cell["metadata"]]


@pytest.mark.parametrize("name", NAMES)
def test_no_warning_is_committed(name):
    notebook = json.loads((FOLDER / f"{name}.ipynb").read_text())
    outputs = [o for cell in notebook["cells"] for o in cell.get("outputs", ())]
    assert not [o for o in outputs if o.get("name") == "stderr"]


def test_the_overview_shows_a_model_that_is_ours():
    text = (FOLDER / "00_overview.ipynb").read_text()
    assert "from the procedural model" in text
