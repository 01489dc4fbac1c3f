"""The documentation site: README, PAPER, docs, notebooks and every public name (`make site`)."""

import importlib.metadata

from sphinx.application import Sphinx

project = "LineUp workbench"
author = "the LineUp workbench contributors"
release = importlib.metadata.version("lineup-workbench")

# The sources are the repository itself, so that a link works there and on the site alike.
root_doc = "docs/index"
include_patterns = [
    "*.md",
    "docs/*.md",
    "notebooks/*.ipynb",
    "benchmarks/README.md",
    "data/README.md",
    "experiments/FORMAT.md",
    "experiments/results/*.md",
    "experiments/results/sweeps/*.md",
]
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.viewcode"]

# Notebooks are shown as committed; executing them is for their own tests.
nb_execution_mode = "off"
myst_heading_anchors = 3
autodoc_typehints = "none"
napoleon_google_docstring = False
add_module_names = False
default_role = "py:obj"

html_theme = "furo"
html_title = project
html_static_path: list[str] = []


def titled(_app: Sphinx, page: str, source: list[str]) -> None:
    """Give the tables of results, which are bare, the title that a page must have."""
    folder, _, name = page.rpartition("/")
    if folder.startswith("experiments/results") and not source[0].startswith("#"):
        source[0] = f"# {name.replace('_', ' ').capitalize()}\n\n{source[0]}"


def setup(app: Sphinx) -> None:
    app.connect("source-read", titled)
