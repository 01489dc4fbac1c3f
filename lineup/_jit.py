"""The one way a hot loop is compiled here: once, kept on disk, with no Python fallback."""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba import types

F = TypeVar("F", bound=Callable[..., object])


def kernel(function: F) -> F:
    """Compile `function` with numba and keep the machine code for the next run."""
    return cast(F, _compiled(function))


def part(function: F) -> F:
    """A piece of kernels: only they call it, and it neither makes an array nor hands one back.

    It counts no references to the arrays that it is given. Where small kernels pass a record of
    arrays on to each other, counting takes longer than their work, and so does compiling it.
    """
    piece = _compiled(function, no_cpython_wrapper=True, _nrt=False)

    def refuse(*_: object) -> None:
        raise TypeError(f"{function.__name__} is a part of kernels, and Python cannot call it")

    # The machine code has no door to Python, and numba must not look for one.
    piece._insert, piece._compile_for_args = lambda *_: None, refuse
    return cast(F, piece)


def _compiled(function: F, **options: bool) -> Any:
    compiler: Any = numba.njit
    kind_of: Any = types.unliteral
    dispatcher = compiler(cache=True, no_cfunc_wrapper=True, **options)(function)
    typed = dispatcher.get_call_template

    def typed_by_kind(args: Any, kws: Any) -> Any:
        # To numba each constant is a type, and it would compile a callee for one after the other.
        return typed(tuple(map(kind_of, args)), {name: kind_of(kws[name]) for name in kws})

    dispatcher.get_call_template = typed_by_kind
    return dispatcher


def _cache_folder() -> Path:
    """A folder named after the source of all kernels.

    Numba compiles a called kernel into its caller, but looks at the caller's file alone when it
    asks whether stored machine code is still good.
    """
    package = Path(__file__).parent
    digest = hashlib.sha256()
    for file in sorted(package.rglob("*.py")):
        source = file.read_bytes()
        if b"@kernel" in source or b"@part" in source:
            digest.update(source)
    root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return root / "lineup" / f"kernels-{digest.hexdigest()[:16]}"


if not os.environ.get("NUMBA_CACHE_DIR"):
    setattr(numba.config, "CACHE_DIR", str(_cache_folder()))
