"""From planar paths to a layered path: which voxels link the layers (Sections 4.2 and 4.3)."""

from .build import Effort, assembled, linked
from .promise import promising_plan
from .shape import Layers, layers

__all__ = ["Effort", "Layers", "assembled", "layers", "linked", "promising_plan"]
