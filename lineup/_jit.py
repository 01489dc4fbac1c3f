"""The one way a hot loop is compiled here: once, kept on disk, with no Python fallback."""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., object])


def kernel(function: F) -> F:
    """Compile `function` with numba and keep the machine code for the next run."""
    return cast(F, numba.njit(cache=True)(function))


def _cache_folder() -> Path:
    """A folder named after the source of all kernels.

    Numba compiles a called kernel into its caller, but looks at the caller's file alone when it
    asks whether stored machine code is still good.
    """
    package = Path(__file__).parent
    digest = hashlib.sha256()
    for file in sorted(package.rglob("*.py")):
        source = file.read_bytes()
        if b"@kernel" in source:
            digest.update(source)
    root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return root / "lineup" / f"kernels-{digest.hexdigest()[:16]}"


if not os.environ.get("NUMBA_CACHE_DIR"):
    setattr(numba.config, "CACHE_DIR", str(_cache_folder()))
