"""The judge of paths and motions: it proves what planners claim, and shares no code with them.

Only the records, the grid's constants and the move format are common ground.
"""

from .motions import certify, check_limits
from .paths import certify_path

__all__ = ["certify", "certify_path", "check_limits"]
