"""Every figure: solids and chains, Reeb graphs and layers, unfoldings, contact sheets, numbers.

Each function returns a matplotlib figure; `save` writes it.
"""

from .animation import animation
from .decomposition import decomposition
from .dots import dots
from .files import save
from .linkages import depths, projection, two_stages
from .moments import unfolding
from .plans import layers, reeb
from .plates import plate
from .printed import block, slots
from .regions import checkerboard, contraction, merge, planar_steps
from .scenarios import run
from .scenes import chain, contact_sheet, layering, solid
from .spread import spread
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
    "dots",
    "layering",
    "layers",
    "merge",
    "planar_steps",
    "plate",
    "projection",
    "reeb",
    "run",
    "save",
    "slots",
    "solid",
    "spread",
    "standing",
    "strength",
    "two_stages",
    "unfolding",
]
