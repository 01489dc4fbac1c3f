"""What a folded model bears under its own weight, whole or partly folded (Section 7, Figure 17)."""

from .faces import BONDINGS, Bonding
from .measured import strength
from .results import Strength
from .through import standing

__all__ = ["BONDINGS", "Bonding", "Strength", "standing", "strength"]
