"""The player in JupyterLab: run in a cell, led by hand and from Python, and in a saved notebook."""

from importlib.util import find_spec

import numpy as np
import pytest
from browser import BROWSER, colourful, seen

import lineup as lu

for package in ("playwright.sync_api", "anywidget"):
    pytest.importorskip(package)

from laboratory import opener, run  # noqa: E402

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed"),
    pytest.mark.skipif(find_spec("jupyterlab") is None, reason="no JupyterLab is installed"),
]

PLAYER = "document.querySelector('.lineup-player')?.player"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Two equal notebooks, of which `saved` was run by nbclient, as `make notebooks` does."""
    nbclient, nbformat = map(pytest.importorskip, ("nbclient", "nbformat"))
    folder = tmp_path_factory.mktemp("lab")
    folding = lu.fold(lu.VoxelSolid(np.ones((4, 3, 3), bool)), rounds=50, trial_rounds=10)
    file = lu.save(folding, folder / "block.folding.json")
    cells = [
        f"import lineup as lu\nfilm = lu.player(lu.load({str(file)!r}), name='block')\nfilm",
        "print('told', film.time, film.picked, film.playing)",
        "film.time, film.picked = 20, 8",
    ]
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(c) for c in cells])
    notebook.metadata.kernelspec = {
        "name": "python3",
        "display_name": "Python 3",
        "language": "python",
    }
    nbformat.write(notebook, folder / "fresh.ipynb")
    notebook.cells = notebook.cells[:1]
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
    nbformat.write(notebook, folder / "saved.ipynb")
    return folder


@pytest.fixture(scope="module")
def notebook(folder):
    """Open a notebook by its name."""
    with opener(folder) as opened:
        yield opened


def test_a_player_in_a_cell_plays_and_is_in_step_with_python(notebook):
    page = notebook("fresh.ipynb")
    run(page, 0, f"{PLAYER}?.frames > 0")
    assert colourful(seen(page, ".lineup-player canvas.view")) > 0.03
    assert page.inner_text(".lineup-player .badge") == "not judged"
    assert page.get_by_role("button", name="Link to this moment").is_hidden()

    page.locator(".lineup-player .play").click()
    page.wait_for_function(f"{PLAYER}.state.time > 1")
    page.locator(".lineup-player .play").click()
    n_cells = page.locator(".jp-Cell").count()
    page.locator(".lineup-player canvas.view").focus()
    for key in ("Home", "ArrowRight", "ArrowRight", "Space", "Space", "Home", "ArrowRight"):
        page.keyboard.press(key)  # keys that JupyterLab has uses for as well
    assert page.evaluate(f"{PLAYER}.state.time") == 1
    assert page.locator(".jp-Cell").count() == n_cells
    page.locator(".lineup-player .block").fill("3")

    outputs = "[...document.querySelectorAll('.jp-OutputArea-output')]"
    run(page, 1, f"{outputs}.some((output) => output.innerText.includes('told 1.0 4 False'))")
    run(page, 2, f"{PLAYER}.state.time === 20 && {PLAYER}.state.picked === 8")
    page.close()


def test_a_saved_notebook_shows_a_still_picture_without_running(notebook):
    page = notebook("saved.ipynb")
    still = page.locator(".jp-OutputArea-output img")
    still.wait_for()
    assert still.evaluate("(image) => image.naturalWidth") > 600
    assert page.evaluate(PLAYER) is None
    page.close()
