"""The operation manual: how to fold the straight chain into a model by hand (Section 7)."""

from .reading import read_manual
from .writing import ManualFiles, write_manual

__all__ = ["ManualFiles", "read_manual", "write_manual"]
