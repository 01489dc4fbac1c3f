"""Choosing a planner by name, and refusing options it does not have."""

from collections.abc import Callable, Mapping
from inspect import Parameter, signature
from typing import Any


def checked(
    methods: Mapping[str, Callable[..., Any]], method: str, options: Mapping[str, Any], what: str
) -> None:
    """Raise a ValueError if `method` is not in `methods` or does not take all of `options`."""
    if method not in methods:
        raise ValueError(f"unknown {what} {method!r}; known: {sorted(methods)}")
    parameters = signature(methods[method]).parameters.values()
    known = sorted(p.name for p in parameters if p.kind is Parameter.KEYWORD_ONLY)
    unknown = sorted(set(options) - set(known))
    if unknown:
        raise ValueError(f"{what} {method!r} has no option {unknown[0]!r}; known: {known}")
