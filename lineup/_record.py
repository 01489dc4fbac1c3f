"""Immutable records that hold NumPy arrays, and asking for one of a kind."""

from collections.abc import Collection
from dataclasses import dataclass, fields
from os import PathLike
from typing import Any, TypeVar, dataclass_transform

import numpy as np

T = TypeVar("T")

_GOT_BY = {
    ("VoxelSolid", "ndarray"): "lineup.VoxelSolid(occupancy) makes one of a bool array",
    ("VoxelSolid", "str"): "lineup.model(name) and lineup.voxelize(file) make one",
    ("VoxelSolid", "Trimesh"): "lineup.voxelize(mesh) makes one",
    ("VoxelPath", "ndarray"): "lineup.VoxelPath(voxels) makes one of an integer array",
    ("VoxelPath", "VoxelSolid"): "lineup.layered_path(solid) makes one",
    ("VoxelPath", "Folding"): "folding.path is one",
    ("Motion", "Folding"): "folding.motion is one",
    ("Motion", "VoxelPath"): "lineup.unfold(path) plans one",
    ("Motion", "VoxelSolid"): "lineup.fold(solid).motion is one",
    ("Folding", "VoxelSolid"): "lineup.fold(solid) is one",
    ("ReebGraph", "VoxelSolid"): "lineup.reeb_graph(solid) is one",
}
"""What makes a record of the first kind, for those who have an object of the second."""


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


def of_kind(value: object, *kinds: type) -> None:
    """Raise a ValueError if `value` is of none of these kinds, and say how to come by one."""
    if isinstance(value, kinds):
        return
    needed, got = [kind.__name__ for kind in kinds], type(value).__name__
    ways = [_GOT_BY[kind, got] for kind in needed if (kind, got) in _GOT_BY]
    raise ValueError("; ".join([f"a {' or '.join(needed)} is needed, got {got}", *ways]))


def listed(value: object, name: str) -> None:
    """Raise a ValueError if the argument `name` is not a list or the like."""
    if not isinstance(value, Collection) or isinstance(value, str):
        got = repr(value) if isinstance(value, str | PathLike) else f"{type(value).__name__}"
        raise ValueError(f"{name} must be a list, got {got} alone; put it in brackets")


def _freeze(self: Any) -> None:
    for value in self.__dict__.values():
        if isinstance(value, np.ndarray):
            value.flags.writeable = False
