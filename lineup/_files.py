"""Files: read within bounds, written whole or not at all, and named so that they stay in place."""

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

MOST_BYTES = 2**28
"""Of a file that is read, 256 MB: room for foldings of millions of voxels."""

_HALF = re.compile(r".+\.(\d+)\.tmp")
_NOT_IN_NAMES = re.compile(r"[/\\\x00-\x1f\x7f]")


def content(file: Path, most: int = MOST_BYTES) -> bytes:
    """All bytes of a file; a ValueError, before they are read, if there are more than `most`.

    What is no regular file, as a device that never ends, is a FileNotFoundError.
    """
    if not file.is_file():
        raise FileNotFoundError(f"no file {file}")
    size = file.stat().st_size
    if size > most:
        raise ValueError(f"it has {size:,} bytes, and files of up to {most:,} are read")
    return file.read_bytes()


def plain_name(name: str) -> str:
    """`name` itself, if what is called so lies in the folder that it is written into.

    Raises
    ------
    ValueError
        If it is empty, names a folder, or has control characters.
    """
    if name in ("", ".", "..") or _NOT_IN_NAMES.search(name):
        raise ValueError(
            f"{name!r} cannot be the name of a file; "
            "one without slashes, backslashes and control characters would do"
        )
    return name


@contextmanager
def whole(file: Path) -> Iterator[Path]:
    """Where to write a file, so that a reader meets the old file or the new one, never a part.

    Two processes may write the same file at a time. One that is killed leaves NAME.PID.tmp, which
    `clear` removes. An OSError of the writing names the file, which that of a full disk does not.
    """
    half = file.with_name(f"{file.name}.{os.getpid()}.tmp")
    try:
        yield half
        os.replace(half, file)
    except OSError as error:
        if error.filename not in (None, str(half)):
            raise
        raise OSError(error.errno, error.strerror or str(error), str(file)) from None
    finally:
        half.unlink(missing_ok=True)


def clear(folder: Path, files: str = "**/*") -> None:
    """Remove what killed processes left of `files`, a pattern, that they were about to write."""
    for half in sorted(folder.glob(f"{files}.tmp")):
        writer = _HALF.fullmatch(half.name)
        if writer and not _may_write(int(writer[1])):
            half.unlink(missing_ok=True)


def _may_write(pid: int) -> bool:
    """Whether there is another process of this number; this one writes nothing as it asks."""
    if os.name != "posix":  # where to ask a process can be to end it
        return True
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return pid != os.getpid()
