"""Every figure: solids and chains, Reeb graphs and layers, unfoldings, contact sheets, numbers.

Each function returns a matplotlib figure; `save` writes it.
"""

from .animation import animation
from .apart import layer, nodes, storeys
from .decomposition import decomposition
from .dots import dots
from .ends import overlap, shared_links
from .files import save
from .interactive import explore
from .linkages import depths, projection, two_stages
from .moments import unfolding
from .orientations import orientations
from .plans import layers, reeb
from .plates import plate
from .printed import block, slots
from .regions import checkerboard, contraction, merge, planar_steps
from .scenarios import run
from .scenes import chain, contact_sheet, layering, solid, solids
from .shares import assumptions
from .silhouettes import silhouettes
from .spread import spread
from .strength import standing, strength

__all__ = [
    "animation",
    "assumptions",
    "block",
    "chain",
    "checkerboard",
    "contact_sheet",
    "contraction",
    "decomposition",
    "depths",
    "dots",
    "explore",
    "layer",
    "layering",
    "layers",
    "merge",
    "nodes",
    "orientations",
    "overlap",
    "planar_steps",
    "plate",
    "projection",
    "reeb",
    "run",
    "save",
    "shared_links",
    "silhouettes",
    "slots",
    "solid",
    "solids",
    "spread",
    "standing",
    "storeys",
    "strength",
    "two_stages",
    "unfolding",
]
