"""Immutable records that hold NumPy arrays."""

from dataclasses import dataclass, fields
from typing import Any, TypeVar, dataclass_transform

import numpy as np

T = TypeVar("T")


@dataclass_transform(frozen_default=True, eq_default=False)
def record(cls: type[T]) -> type[T]:
    """Class decorator: a frozen dataclass whose arrays are private copies and read-only.

    Equality is identity, because ``==`` between arrays is elementwise and a generated
    ``__eq__`` would raise. NumPy drops the read-only flag when an array is pickled or deep
    copied, so arrays are frozen again on the way back.
    """
    check = cls.__dict__.get("__post_init__")

    def __post_init__(self: Any) -> None:
        for f in fields(self):
            value = getattr(self, f.name)
            if isinstance(value, np.ndarray) and (value.flags.writeable or value.base is not None):
                object.__setattr__(self, f.name, value.copy())
        if check is not None:
            check(self)
        _freeze(self)

    def __setstate__(self: Any, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        _freeze(self)

    setattr(cls, "__post_init__", __post_init__)
    setattr(cls, "__setstate__", __setstate__)
    return dataclass(frozen=True, eq=False)(cls)


def _freeze(self: Any) -> None:
    for value in self.__dict__.values():
        if isinstance(value, np.ndarray):
            value.flags.writeable = False
