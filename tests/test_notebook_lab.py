"""The first notebooks in JupyterLab: sliders where a person runs them, still pictures before."""

import shutil
from importlib.util import find_spec
from pathlib import Path

import pytest
from browser import BROWSER

for package in ("playwright.sync_api", "ipywidgets"):
    pytest.importorskip(package)

from laboratory import opener, run  # noqa: E402

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed"),
    pytest.mark.skipif(find_spec("jupyterlab") is None, reason="no JupyterLab is installed"),
]

NOTEBOOKS = Path(__file__).parents[1] / "notebooks"
IMAGE = "document.querySelector('.jupyter-widgets img')"


@pytest.fixture(scope="module")
def notebook(tmp_path_factory):
    """Open a notebook by its name."""
    folder = tmp_path_factory.mktemp("lab")
    for name in ("01_voxels", "02_reeb_graphs"):
        shutil.copy(NOTEBOOKS / f"{name}.ipynb", folder)
    with opener(folder) as opened:
        yield opened


def cells_before(name, what):
    """Numbers of the code cells that define what a cell needs, and of the cell itself."""
    import nbformat

    cells = nbformat.read(NOTEBOOKS / name, 4).cells
    last = next(k for k, cell in enumerate(cells) if what in cell.source)
    return [k for k in range(last + 1) if cells[k].cell_type == "code"]


@pytest.mark.parametrize(("name", "slider"), [("01_voxels.ipynb", 1), ("02_reeb_graphs.ipynb", 0)])
def test_a_slider_changes_the_picture(notebook, name, slider):
    page = notebook(name)
    *before, cell = cells_before(name, "draw.explore(")
    page.wait_for_selector(".jp-OutputArea-output img")
    assert page.locator(".jupyter-widgets").count() == 0
    indicator = "document.querySelectorAll('.jp-Cell')[{}].querySelector('.jp-InputPrompt')"
    for k in before:
        run(page, k, f"/\\d/.test({indicator.format(k)}.innerText)")
    run(page, cell, f"{IMAGE}?.naturalWidth > 300")
    first = page.evaluate(f"{IMAGE}.src")
    knob = page.locator(".jupyter-widgets .noUi-handle").nth(slider)
    knob.focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_function(f"{IMAGE}.src !== {first!r} && {IMAGE}.naturalWidth > 300")
    page.close()
