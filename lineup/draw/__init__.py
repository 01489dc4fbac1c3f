"""Every figure: solids and chains, Reeb graphs and layers, unfoldings, rows of experiments.

Each function returns a matplotlib figure; `save` writes it.
"""

from .animation import animation
from .decomposition import decomposition
from .experiments import experiment
from .files import save
from .linkages import depths, projection, two_stages
from .moments import unfolding
from .plans import layers, reeb
from .printed import block, slots
from .regions import checkerboard, contraction, merge, planar_steps
from .scenarios import run
from .scenes import chain, contact_sheet, layering, solid
from .strength import standing, strength

__all__ = [
    "animation",
    "block",
    "chain",
    "checkerboard",
    "contact_sheet",
    "contraction",
    "decomposition",
    "depths",
    "experiment",
    "layering",
    "layers",
    "merge",
    "planar_steps",
    "projection",
    "reeb",
    "run",
    "save",
    "slots",
    "solid",
    "standing",
    "strength",
    "two_stages",
    "unfolding",
]
