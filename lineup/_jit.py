"""The one way a hot loop is compiled here: ahead-of-time cached, no Python fallback."""

from collections.abc import Callable
from typing import TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., object])


def kernel(function: F) -> F:
    """Compile `function` with numba and cache the machine code beside its source."""
    return cast(F, numba.njit(cache=True)(function))
