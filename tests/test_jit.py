"""Compiled kernels, and the folder that keeps their machine code."""

import ast
import importlib
import re
import typing
from pathlib import Path

import numba
import numpy as np
import pytest
from numba import TypingError
from numba.core.dispatcher import Dispatcher

import lineup
from lineup import _jit
from lineup.folding._fold import Fold
from lineup.grid import IntArray

PACKAGE = Path(lineup.__file__).parent
KERNEL_FILES = [
    f for f in sorted(PACKAGE.rglob("*.py")) if re.search("@(kernel|part)", f.read_text())
]
KERNEL_FILES.remove(PACKAGE / "_jit.py")


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A package of three kernel files, one deep inside, and a file without kernels."""
    monkeypatch.setattr(_jit, "__file__", str(tmp_path / "_jit.py"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (tmp_path / "deep").mkdir()
    (tmp_path / "loops.py").write_text("@kernel\ndef f(x):\n    return x\n")
    (tmp_path / "deep" / "loops.py").write_text("@kernel\ndef g(x):\n    return x\n")
    (tmp_path / "parts.py").write_text("@part\ndef p(x):\n    return x\n")
    (tmp_path / "plain.py").write_text("def h(x):\n    return x\n")
    return tmp_path


@pytest.mark.parametrize("file", ["loops.py", "deep/loops.py", "parts.py"])
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


def test_a_kernel_is_compiled_once_for_all_constants():
    called = _jit.kernel(lambda x, y: x + y)
    caller = _jit.kernel(lambda x: called(x, 1) + called(2, x) + called(3, 4))
    assert caller(5) == 20
    assert len(called.signatures) == 1


def test_a_part_is_called_by_kernels_only():
    doubled = _jit.part(lambda x: x + x)
    caller = _jit.kernel(lambda x: doubled(x) + 1)
    for _ in range(2):  # before there is machine code, and after
        with pytest.raises(TypeError, match="is a part of kernels, and Python cannot call it"):
            doubled(20)
        assert caller(20) == 41


def test_a_part_that_makes_an_array_is_refused():
    sum_of = _jit.part(lambda n: np.zeros(n).sum())
    with pytest.raises(TypingError, match="NRT required but not enabled"):
        _jit.kernel(lambda n: sum_of(n))(3)


def doubled(x):
    return x + x


@pytest.fixture
def kept(tmp_path, monkeypatch):
    """Calls a fresh kernel that keeps its code in a folder here: what it returns, and whether
    the code was read; with the files kept so far."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "kernels"))

    def call():
        kernel = _jit.kernel(doubled)
        return kernel(21), bool(kernel.stats.cache_hits)

    return call, lambda ending: sorted(tmp_path.glob(f"kernels/*/*.{ending}"))


def flipped(content):
    spoilt = bytearray(content)
    spoilt[len(spoilt) // 2] ^= 1
    return bytes(spoilt)


DAMAGES = {
    "cut": lambda content: content[: len(content) // 2],
    "empty": lambda content: b"",
    "zeros": lambda content: bytes(len(content)),
    "one bit": flipped,
}


@pytest.mark.parametrize("damage", DAMAGES)
@pytest.mark.parametrize("ending", ["nbi", "nbc"])
def test_spoilt_machine_code_is_compiled_anew_and_this_is_told(kept, ending, damage):
    call, files = kept
    assert [call(), call()] == [(42, False), (42, True)]
    (file,) = files(ending)
    file.write_bytes(DAMAGES[damage](file.read_bytes()))
    if (ending, damage) == ("nbi", "one bit"):  # may be a good index of something else
        assert call()[0] == 42
    else:
        with pytest.warns(RuntimeWarning, match="kernels cannot be read, and is compiled anew"):
            assert call() == (42, False)
    assert call() == (42, True)


def test_where_no_machine_code_can_be_kept_a_kernel_runs_and_this_is_told(kept, tmp_path):
    call, _ = kept
    (tmp_path / "kernels").touch()
    with pytest.warns(
        RuntimeWarning, match="kernels cannot be kept.* NUMBA_CACHE_DIR can name"
    ) as told:
        assert [call(), call()] == [(42, False)] * 2
    assert len(told) == 1
    assert not list(tmp_path.rglob("*.nb?"))


def test_on_a_full_disk_a_kernel_runs_and_the_next_keeps_its_code(kept):
    call, files = kept
    resource = pytest.importorskip("resource")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
    try:
        with pytest.warns(RuntimeWarning, match="cannot be kept.*File too large"):
            assert call() == (42, False)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert not files("nbc")
    assert [call(), call()] == [(42, False), (42, True)]


def is_counted(kind):
    """Whether a type is an array or holds one."""
    inner = typing.get_args(kind)
    if typing.get_origin(kind) is np.ndarray or kind is np.ndarray:
        return True
    if isinstance(kind, type) and issubclass(kind, tuple):
        inner = typing.get_type_hints(kind).values()
    return any(is_counted(k) for k in inner)


def parts():
    for file in KERNEL_FILES:
        name = ".".join(("lineup", *file.relative_to(PACKAGE).with_suffix("").parts))
        for kernel in vars(importlib.import_module(name)).values():
            if isinstance(kernel, Dispatcher) and not kernel.targetoptions.get("_nrt", True):
                yield kernel.py_func


def test_no_part_hands_an_array_back():
    """Its caller would let go of an array that nobody counted."""
    found = set(parts())
    assert len(found) > 50
    hints = {f"{f.__module__}.{f.__name__}": typing.get_type_hints(f)["return"] for f in found}
    assert not [name for name, kind in hints.items() if is_counted(kind)]
    assert is_counted(tuple[int, IntArray])
    assert is_counted(Fold)


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
