"""The one way a hot loop is compiled here: once, kept on disk, with no Python fallback."""

import hashlib
import os
import pickle
import warnings
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba import types
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.serialize import dumps

_UserFolder: Any = CompileResultCacheImpl._locator_classes[0]

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
    dispatcher = compiler(no_cfunc_wrapper=True, **options)(function)
    dispatcher._cache = _Cache(function)
    typed = dispatcher.get_call_template

    def typed_by_kind(args: Any, kws: Any) -> Any:
        # To numba each constant is a type, and it would compile a callee for one after the other.
        return typed(tuple(map(kind_of, args)), {name: kind_of(kws[name]) for name in kws})

    dispatcher.get_call_template = typed_by_kind
    return dispatcher


class _Folder(_UserFolder):  # type: ignore[misc]
    """Where machine code is kept, even if nothing new can be: what is there may be read."""

    @classmethod
    def from_function(cls, function: Any, file: str) -> Any:
        return cls(function, file) if Path(file).exists() else None


class _Code(CompileResultCacheImpl):
    """Machine code as it is kept: with a digest, since running spoilt code may do anything."""

    _locator_classes = [_Folder, *CompileResultCacheImpl._locator_classes[1:]]

    def reduce(self, compiled: Any) -> tuple[bytes, bytes]:
        code = dumps(super().reduce(compiled))
        return hashlib.sha256(code).digest(), code

    def rebuild(self, target: Any, kept: tuple[bytes, bytes]) -> Any:
        digest, code = kept
        if hashlib.sha256(code).digest() != digest:
            raise ValueError("it is not what was kept")
        return super().rebuild(target, pickle.loads(code))


class _Cache(FunctionCache):
    """Machine code on disk. Where it cannot be read or written, a run goes on without, and says so.

    Numba by itself ends the run.
    """

    _impl_class = _Code

    def load_overload(self, signature: Any, target: Any) -> Any:
        try:
            return super().load_overload(signature, target)
        except OSError:
            return None  # and what is compiled instead cannot be kept, as will be told
        except Exception as error:  # whatever it is that spoilt bytes lead to
            self._warn("cannot be read, and is compiled anew", error)
        try:
            for file in Path(self.cache_path).glob(f"{self._impl.filename_base}.*"):
                file.unlink(missing_ok=True)
        except OSError:
            self.disable()
        return None

    def save_overload(self, signature: Any, compiled: Any) -> None:
        try:
            super().save_overload(signature, compiled)
        except OSError as error:
            self._warn(
                "cannot be kept, and every run compiles it anew; "
                "NUMBA_CACHE_DIR can name another folder",
                error,
            )

    def _warn(self, fate: str, error: Exception) -> None:
        folder = Path(self.cache_path).parent  # the same for all kernels, so that it is told once
        why = getattr(error, "strerror", None) or type(error).__name__
        _warn_once(f"machine code in {folder} {fate} ({why})")


@lru_cache
def _warn_once(text: str) -> None:
    """Numba makes Python forget which warnings it has shown."""
    warnings.warn(text, RuntimeWarning, stacklevel=1)


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
