"""The operation manual: how to fold the straight chain into a model by hand (Section 7)."""

from .reading import read_manual
from .standing import standing_by_step
from .writing import ManualFiles, manual_pages, write_manual

__all__ = ["ManualFiles", "manual_pages", "read_manual", "standing_by_step", "write_manual"]
