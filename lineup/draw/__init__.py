"""Every figure: solids and chains, Reeb graphs and layers, unfoldings and contact sheets.

Each function returns a matplotlib figure; `save` writes it.
"""

from .files import save
from .moments import unfolding
from .plans import layers, reeb
from .scenes import chain, contact_sheet, solid

__all__ = ["chain", "contact_sheet", "layers", "reeb", "save", "solid", "unfolding"]
