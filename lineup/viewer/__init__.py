"""The motion player: one HTML file that works offline, and the same in JupyterLab."""

from .page import write_player
from .widget import player

__all__ = ["player", "write_player"]
