"""Files: written whole or not at all, and what a killed writer left is cleared away."""

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_HALF = re.compile(r".+\.(\d+)\.tmp")


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
