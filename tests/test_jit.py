"""Compiled kernels, and the folder that keeps their machine code."""

import ast
import importlib
from pathlib import Path

import pytest
from numba.core.dispatcher import Dispatcher

import lineup
from lineup import _jit

PACKAGE = Path(lineup.__file__).parent
KERNEL_FILES = [f for f in sorted(PACKAGE.rglob("*.py")) if "@kernel" in f.read_text()]
KERNEL_FILES.remove(PACKAGE / "_jit.py")


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A package of two kernel files, one deep inside, and a file without kernels."""
    monkeypatch.setattr(_jit, "__file__", str(tmp_path / "_jit.py"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (tmp_path / "deep").mkdir()
    (tmp_path / "loops.py").write_text("@kernel\ndef f(x):\n    return x\n")
    (tmp_path / "deep" / "loops.py").write_text("@kernel\ndef g(x):\n    return x\n")
    (tmp_path / "plain.py").write_text("def h(x):\n    return x\n")
    return tmp_path


@pytest.mark.parametrize("file", ["loops.py", "deep/loops.py"])
def test_the_cache_folder_is_another_when_a_kernel_changes(package, file):
    before = _jit._cache_folder()
    assert before == _jit._cache_folder()
    source = (package / file).read_text()
    (package / file).write_text(source.replace("return x", "return -x"))
    assert _jit._cache_folder() != before
    (package / file).write_text(source)
    assert _jit._cache_folder() == before


def test_the_cache_folder_is_another_when_a_kernel_file_comes_or_goes(package):
    before = _jit._cache_folder()
    (package / "more.py").write_text("@kernel\ndef k(x):\n    return x\n")
    assert _jit._cache_folder() != before


def test_the_cache_folder_stays_when_other_code_changes(package):
    before = _jit._cache_folder()
    (package / "plain.py").write_text("def h(x):\n    return -x\n")
    assert _jit._cache_folder() == before


def test_the_cache_folder_stands_in_the_users_cache(package, monkeypatch):
    assert _jit._cache_folder().parent == package / "cache" / "lineup"
    monkeypatch.setenv("XDG_CACHE_HOME", "")
    monkeypatch.setattr(Path, "home", lambda: package / "me")
    assert _jit._cache_folder().parent == package / "me" / ".cache" / "lineup"


def test_a_kernel_has_no_python_fallback():
    doubled = _jit.kernel(lambda x: x + x)
    assert isinstance(doubled, Dispatcher)
    assert doubled(21) == 42
    assert doubled.nopython_signatures


def imported(file):
    """The names that a file of the package imports from others of its files, and those files."""
    home = ".".join(("lineup", *file.relative_to(PACKAGE).parent.parts))
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level:
            module = importlib.import_module("." * node.level + (node.module or ""), home)
            yield from ((alias.asname or alias.name, Path(module.__file__)) for alias in node.names)


@pytest.mark.parametrize("file", KERNEL_FILES, ids=lambda f: str(f.relative_to(PACKAGE)))
def test_kernels_use_nothing_of_files_that_the_folder_is_not_named_after(file):
    name = ".".join(("lineup", *file.relative_to(PACKAGE).with_suffix("").parts))
    kernels = [k for k in vars(importlib.import_module(name)).values() if isinstance(k, Dispatcher)]
    assert kernels
    used = {name for kernel in kernels for name in kernel.py_func.__code__.co_names}
    assert not {n for n, source in imported(file) if n in used and source not in KERNEL_FILES}
