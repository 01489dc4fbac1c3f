"""Planners and judges broken on purpose, and whether the tests find it: `make mutants`.

Each mutant of mutants.yaml is one change to one file. It is made in a copy of the package, never
here, and only the tests named with it are run there. Kernels are plain Python in that copy, which
spares compiling them; where the tests take too long that way, the mutant is marked `compiled`.
"""

from __future__ import annotations

import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import pandas as pd
import typer
import yaml

from lineup.storage import write_whole

ROOT = Path(__file__).parents[1]
LIST = Path(__file__).with_name("mutants.yaml")
PLAIN = "def kernel(function):\n    return function\n\n\npart = kernel\n"
SECONDS = 300
"""Of one core; a run that takes more is stopped and has found nothing."""

CAUGHT, SURVIVED, NOT_RUN = "caught", "survived", "did not run"
VERDICTS = {0: SURVIVED, 1: CAUGHT}
"""By pytest's exit code; any other one says nothing of the mutant, nor does a file that fails."""


@dataclass(frozen=True)
class Mutant:
    """One fault: `old` in a file, which has it once, becomes `new`, and one of `tests` must fail.

    `breaks` says what is wrong then, in the paper's words.
    """

    id: str
    breaks: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]
    compiled: bool = False


def listed() -> list[Mutant]:
    """The mutants, in the order of the paper."""
    rows = yaml.safe_load(LIST.read_text(encoding="utf-8"))
    return [Mutant(**row | {"tests": tuple(row["tests"])}) for row in rows]


def broken(mutant: Mutant, root: Path = ROOT) -> str:
    """The text of its file with the fault; a ValueError where the list is out of date."""
    text = (root / mutant.file).read_text(encoding="utf-8")
    found = text.count(mutant.old)
    if found != 1:
        raise ValueError(f"{mutant.id}: {mutant.file} has {mutant.old!r} {found} times, not once")
    return text.replace(mutant.old, mutant.new)


def copied(folder: Path, compiled: bool) -> Path:
    """A copy of what the tests need, in a new folder."""
    for name in ("lineup", "tests", "data", "proofs", "experiments"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy2(ROOT / "pyproject.toml", folder)
    if not compiled:
        (folder / "lineup" / "_jit.py").write_text(PLAIN, encoding="utf-8")
    return folder


def tested(folder: Path, tests: tuple[str, ...]) -> subprocess.CompletedProcess[str]:
    """Run tests of a copy."""
    options = ("-q", "-x", "-p", "no:cacheprovider", "--disable-warnings")
    return run(folder, "-m", "pytest", *options, *tests)


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run Python in a copy, by its own package, and with no trace outside of the copy."""
    apart = {"PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
    apart["XDG_CACHE_HOME"] = str(folder.parent / "cache")
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        env=os.environ | apart,
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS)),
    )


def verdict(mutant: Mutant, folder: Path) -> str:
    """What the tests say of a mutant, which is made in a copy and taken out again."""
    file = folder / mutant.file
    file.write_text(broken(mutant), encoding="utf-8")
    try:
        module = mutant.file.removesuffix(".py").replace("/", ".").removesuffix(".__init__")
        if run(folder, "-c", f"import {module}").returncode:
            return NOT_RUN
        return VERDICTS.get(tested(folder, mutant.tests).returncode, NOT_RUN)
    finally:
        shutil.copy2(ROOT / mutant.file, file)  # with its date, by which kernels are kept


def verdicts(mutants: list[Mutant]) -> Iterator[tuple[Mutant, str]]:
    """Each mutant and its verdict, once its tests are known to pass without it.

    Raises
    ------
    ValueError
        If one of the tests does not pass on the package as it is.
    """
    with tempfile.TemporaryDirectory() as folder:
        for compiled in (False, True):
            chosen = [mutant for mutant in mutants if mutant.compiled == compiled]
            tests = tuple(dict.fromkeys(test for mutant in chosen for test in mutant.tests))
            if not tests:
                continue
            copy = copied(Path(folder) / ("compiled" if compiled else "plain"), compiled)
            sound = tested(copy, tests)
            if sound.returncode or re.search(r"\d+ skipped", sound.stdout):
                raise ValueError(f"without a mutant its tests do not all pass:\n{sound.stdout}")
            for mutant in chosen:
                yield mutant, verdict(mutant, copy)


def main(
    only: Annotated[list[str] | None, typer.Option(help="A mutant's id; without it, all.")] = None,
    out: Annotated[Path, typer.Option(help="Folder of the table.")] = Path("results"),
) -> None:
    """Run the mutants: OUT/mutants.md. Exit code 1 if one of them is not caught."""
    mutants = [mutant for mutant in listed() if not only or mutant.id in only]
    rows = {}
    for mutant, said in verdicts(mutants):
        rows[mutant.id] = {
            "mutant": mutant.id,
            "what it breaks": mutant.breaks,
            "file": mutant.file,
            "test": ", ".join(test.removeprefix("tests/") for test in mutant.tests),
            "verdict": said,
        }
        typer.echo(f"{mutant.id}: {said}")
    table = pd.DataFrame([rows[mutant.id] for mutant in mutants])
    out.mkdir(parents=True, exist_ok=True)
    write_whole(out / "mutants.md", table.to_markdown(index=False) + "\n")
    raise typer.Exit(int((table["verdict"] != CAUGHT).any()))


if __name__ == "__main__":
    typer.run(main)
