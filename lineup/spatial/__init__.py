"""Long paths by annealing on the voxel graph as a whole: without layers, without Us, nested."""

from .nesting import nested
from .without_layers import free3d
from .without_us import ufree

__all__ = ["free3d", "nested", "ufree"]
