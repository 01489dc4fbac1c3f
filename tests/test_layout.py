"""Rules of the house, checked rather than remembered."""

import ast
import inspect
import json
import re
import subprocess
from collections.abc import Iterator
from importlib.util import resolve_name
from pathlib import Path

import pytest

import lineup as lu

ROOT = Path(__file__).parents[1]

# A module imports only from those before it; the files of a folder share its place.
ORDER = [
    *(
        "_record",
        "_files",
        "_options",
        "_jit",
        "grid",
        "solid",
        "kinematics",
        "joints",
        "words",
        "notation",
        "judging",
    ),
    *("mesh_files", "meshes", "implicit", "shapes", "sampling", "shells", "voxelization"),
    *("catalog", "worked"),
    "looks",
    *("visits", "reeb", "planar", "linking", "assumptions", "paper", "spatial", "refinement"),
    *("layered", "bounds", "subset_sums", "contraction"),
    *("motion", "folding", "trimming", "symbols", "transformation", "scenarios"),
    *("stress", "storage", "robot", "verification", "pipeline", "tasks"),
    *("headings", "orientation"),
    *("_sources", "engines", "cluster", "experiment", "sweep", "styled", "tables"),
    *("block", "draw", "viewer", "fabrication", "manual"),
    *("_progress", "cli"),
]

MODULES = sorted((ROOT / "lineup").rglob("*.py"))
SOURCES = [*MODULES, *sorted((ROOT / "tests").glob("*.py"))]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))


def place(file: Path) -> str:
    return file.relative_to(ROOT / "lineup").parts[0].removesuffix(".py")


def imported(file: Path) -> Iterator[str]:
    """Names in ORDER that a file of the package imports from, its own folder left out."""
    home = ".".join(file.relative_to(ROOT).parent.parts)
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.ImportFrom):
            base = resolve_name("." * node.level + (node.module or ""), home)
            names = [f"{base}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            continue
        yield from {n.split(".")[1] for n in names if n.startswith("lineup.")} - {place(file)}


def code_lines(function: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """Lines of a function without its docstring, which is the longer the better."""
    first = function.body[0]
    documented = isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant)
    docstring = first.end_lineno - first.lineno + 1 if documented else 0
    return function.end_lineno - function.lineno + 1 - docstring


@pytest.mark.parametrize("file", MODULES, ids=lambda f: str(f.relative_to(ROOT)))
def test_imports_point_backwards(file):
    if file == ROOT / "lineup" / "__init__.py":
        return
    assert place(file) in ORDER, "a new module needs a place in ORDER"
    wrong = [n for n in imported(file) if ORDER.index(n) > ORDER.index(place(file))]
    assert not wrong


def test_no_module_has_the_name_of_a_public_function():
    homes = set(lu._HOME.values())
    assert not {place(file) for file in MODULES} & (set(lu.__all__) - homes)


def test_files_and_functions_are_short():
    long = []
    for file in SOURCES:
        text = file.read_text()
        if len(text.splitlines()) > 450:
            long.append(f"{file.name} has {len(text.splitlines())} lines")
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and code_lines(node) > 40:
                long.append(f"{file.name}: {node.name} has {code_lines(node)} lines")
    assert not long


def test_nothing_unfinished_or_of_one_machine():
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        check=True,
        text=True,
    ).stdout
    pattern = re.compile(
        r"\b(TO" + r"DO|FIX" + r"ME|XX" + r"X)\b|NotImplemented" + r"Error"
        r"|(?<![\w.])/(wo" + r"rk|ro" + r"ot|ho" + r"me|t" + r"mp)/"
    )
    found = []
    for name in filter(None, listed.split("\0")):
        file = ROOT / name
        if file.suffix in {".py", ".md", ".yaml", ".yml", ".toml", ".txt", ".ipynb", ".cff", ""}:
            found += [f"{name}: {m[0]}" for m in pattern.finditer(file.read_text())]
    assert not found


@pytest.mark.parametrize("name", lu.__all__)
def test_every_public_name_is_explained_by_an_example(name):
    value = getattr(lu, name)
    if not (inspect.isroutine(value) or inspect.isclass(value)):
        return
    assert value.__doc__, name
    # A record whose fields are all there is to it is explained by the function that returns it.
    if inspect.isroutine(value):
        assert ">>>" in value.__doc__, name


def test_the_readme_example_runs(capsys):
    (example,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.S)
    smaller = re.sub(r"\b(voxels|blocks)=(\d+)", lambda m: f"{m[1]}={int(m[2]) // 5}", example)
    exec(compile(smaller, "README.md", "exec"), {})
    assert "moves: certified" in capsys.readouterr().out


PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("[a-z]*/*.md")])


@pytest.mark.parametrize("page", PAGES, ids=lambda f: f.name)
def test_links_between_pages_lead_somewhere(page):
    links = re.findall(r"\]\((?!https?:)([^)#]+)", page.read_text())
    assert not [link for link in links if not (page.parent / link).exists()]


def code_cells(notebook: Path) -> list[dict]:
    cells = json.loads(notebook.read_text())["cells"]
    return [cell for cell in cells if cell["cell_type"] == "code"]


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda f: f.stem)
def test_notebooks_are_thin(notebook):
    assert notebook.stat().st_size <= 500_000
    for cell in code_cells(notebook):
        source = re.sub(r"^%.*$", "", "".join(cell["source"]), flags=re.M)
        assert len(source.splitlines()) <= 12
        kinds = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.While)
        assert not [n for n in ast.walk(ast.parse(source)) if isinstance(n, kinds)]


def sections(notebook: Path) -> Iterator[tuple[str, str, str]]:
    """Title, words and code of each part of a notebook that begins with a heading."""
    title, words, code = "", "", ""
    for cell in json.loads(notebook.read_text())["cells"]:
        source = "".join(cell["source"])
        if cell["cell_type"] == "code":
            code += source + "\n"
        elif source.startswith("#"):
            if title:
                yield title, words, code
            title, _, words = source.partition("\n")
            code = ""
        else:
            words += "\n\n" + source
    yield title, words, code


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda f: f.stem)
def test_notebooks_are_built_alike(notebook):
    (title, question, set_up), *parts = sections(notebook)
    assert title.startswith("# ")
    assert "?" in question
    assert len(re.findall(r"^(import|from) ", set_up, re.M)) <= 5
    assert [title for title, _, _ in parts if not title.startswith("## ")] == []
    assert [code for _, _, code in parts if re.search(r"^(import|from) ", code, re.M)] == []
    *claims, (closing, last_words, _) = parts
    assert closing == "## Where this differs from the paper"
    assert re.search(r"\bNext\b", last_words), "the last lines say what comes next"
    assert [title for title, _, code in claims if code and "assert" not in code] == []


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda f: f.stem)
def test_a_figure_of_a_notebook_is_one_call(notebook):
    for cell in code_cells(notebook):
        source = re.sub(r"^%.*$", "", "".join(cell["source"]), flags=re.M)
        assert "plt." not in source
        assert len(re.findall(r"^draw\.", source, re.M)) <= 1
        pictures = [o for o in cell["outputs"] if "image/jpeg" in o.get("data", {})]
        assert len(pictures) == len(re.findall(r"^draw\.", source, re.M))


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda f: f.stem)
def test_no_state_of_widgets_is_committed(notebook):
    assert "application/vnd.jupyter" not in notebook.read_text()


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda f: f.stem)
def test_notebooks_are_executed_from_top_to_bottom(notebook):
    cells = code_cells(notebook)
    assert [cell["execution_count"] for cell in cells] == list(range(1, len(cells) + 1))
    assert not [o for cell in cells for o in cell["outputs"] if o["output_type"] == "error"]


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda f: f.stem)
def test_both_halves_of_a_notebook_agree(notebook):
    jupytext = pytest.importorskip("jupytext")
    halves = [jupytext.read(notebook), jupytext.read(notebook.with_suffix(".py"))]
    first, second = ([(c.cell_type, c.source) for c in half.cells] for half in halves)
    assert first == second


def test_every_notebook_has_both_halves():
    scripts = {file.stem for file in (ROOT / "notebooks").glob("*.py")}
    assert scripts == {notebook.stem for notebook in NOTEBOOKS}
