"""Figures as files."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from matplotlib.figure import Figure

from .. import _files


def save(figure: Figure, file: str | os.PathLike[str]) -> Path:
    """Write a figure as PNG; equal figures give equal bytes, and no half-written file is left.

    Returns
    -------
    Path
        Of the file.

    Raises
    ------
    ValueError
        If the name of the file does not end in .png.

    Examples
    --------
    >>> import tempfile
    >>> from lineup import draw
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     draw.save(Figure(), f"{folder}/empty.png").name
    'empty.png'
    """
    with whole(file, ".png") as half:
        figure.savefig(half, format="png", metadata={"Software": None})
    return Path(file)


@contextmanager
def whole(file: str | os.PathLike[str], ending: str) -> Iterator[Path]:
    """Where to write a file that takes its place only once it is whole; folders are made."""
    path = Path(file)
    if path.suffix.lower() != ending:
        raise ValueError(f"a picture of this kind is written as {ending}, got {path.name!r}")
    path.parent.mkdir(parents=True, exist_ok=True)
    with _files.whole(path) as half:
        yield half
