"""The operation manual: how to fold the straight chain into a model by hand (Section 7)."""

from .reading import read_manual
from .standing import standing_by_step
from .writing import ManualFiles, write_manual

__all__ = ["ManualFiles", "read_manual", "standing_by_step", "write_manual"]
