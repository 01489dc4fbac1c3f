"""Which source files a function depends on, so that a stored result can tell when it is stale."""

import ast
import hashlib
import importlib.util
from collections.abc import Iterable, Iterator
from pathlib import Path

PACKAGE = __package__ or "lineup"


def source_files(module: str) -> list[Path]:
    """The file of a module and of every module of this package that it imports, sorted.

    Imports are read from the source and followed; nothing is run. The package's own
    ``__init__`` imports lazily and is left out.
    """
    files: dict[str, Path] = {}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        if name in files or name == PACKAGE:
            continue
        file = _file(name)
        if file is not None:
            files[name] = file
            waiting += _imported(name, file)
    return sorted(set(files.values()))


def source_digest(module: str) -> str:
    """Hash of what `source_files` lists."""
    return digest(file.read_bytes() for file in source_files(module))


def digest(parts: Iterable[bytes]) -> str:
    """Hash of a row of byte strings."""
    whole = hashlib.sha256()
    for part in parts:
        whole.update(hashlib.sha256(part).digest())
    return whole.hexdigest()[:16]


def _file(name: str) -> Path | None:
    try:
        spec = importlib.util.find_spec(name)
    except ModuleNotFoundError:
        return None
    return Path(spec.origin) if spec is not None and spec.origin else None


def _imported(module: str, file: Path) -> Iterator[str]:
    """Names that may be modules of this package, from the import statements of one file."""
    home = module if file.name == "__init__.py" else module.rpartition(".")[0]
    for node in ast.walk(ast.parse(file.read_bytes())):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = importlib.util.resolve_name("." * node.level + (node.module or ""), home)
            names = [base, *(f"{base}.{alias.name}" for alias in node.names)]
        yield from (name for name in names if name.split(".")[0] == PACKAGE)
