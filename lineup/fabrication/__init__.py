"""From a path to files that are printed: plates, parts, a coupon, a bill of materials."""

from .export import Print, export_print
from .layout import Plate, pieces_on, plates
from .placing import Placed, placed

__all__ = ["Placed", "Plate", "Print", "export_print", "pieces_on", "placed", "plates"]
