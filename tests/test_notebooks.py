"""Notebooks run from top to bottom, and what is committed says nothing about who ran it."""

import json
import os
import re
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1] / "notebooks"
NAMES = sorted(file.stem for file in FOLDER.glob("*.py"))


@pytest.fixture(scope="module")
def kernel():
    """One Jupyter kernel for all notebooks, for it takes as long to start as they take to run."""
    nbclient, nbformat = map(pytest.importorskip, ("nbclient", "nbformat"))
    client = nbclient.NotebookClient(nbformat.v4.new_notebook(), timeout=600, kernel_name="python3")
    with client.setup_kernel(cwd=str(FOLDER), env=os.environ | {"LINEUP_QUICK": "1"}):
        yield client


def run(notebook, kernel):
    """Run a notebook from top to bottom where nothing is defined."""
    import nbformat

    emptying = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell("%reset -f")])
    for kernel.nb in (emptying, notebook):
        kernel.reset_execution_trackers()
        for k, cell in enumerate(kernel.nb.cells):
            kernel.execute_cell(cell, k)


@pytest.mark.notebook
@pytest.mark.parametrize("name", NAMES)
def test_a_notebook_runs(name, kernel):
    jupytext = pytest.importorskip("jupytext")
    notebook = jupytext.read(FOLDER / f"{name}.py")
    run(notebook, kernel)
    pictures = [
        output["data"]["image/jpeg"]
        for cell in notebook.cells
        for output in cell.get("outputs", ())
        if "image/jpeg" in output.get("data", {})
    ]
    calls = sum(len(re.findall(r"^draw\.", cell.source, re.M)) for cell in notebook.cells)
    assert len(pictures) == calls > 0


@pytest.mark.notebook
def test_what_a_notebook_does_not_define_it_does_not_have(kernel):
    import nbclient
    import nbformat

    cells = [nbformat.v4.new_code_cell(source) for source in ("seen = 1", "seen")]
    run(nbformat.v4.new_notebook(cells=cells), kernel)
    with pytest.raises(nbclient.exceptions.CellExecutionError, match="NameError"):
        run(nbformat.v4.new_notebook(cells=cells[1:]), kernel)


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
