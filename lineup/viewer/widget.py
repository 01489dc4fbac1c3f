"""The player in JupyterLab."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from io import BytesIO
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike
from PIL import Image

from ..solid import Certificate, Folding, Motion
from .page import script, shown, source

if TYPE_CHECKING:
    import anywidget


def player(
    item: Motion | Folding,
    *,
    certificate: Certificate | None = None,
    name: str = "motion",
    colours: Mapping[str, ArrayLike] | None = None,
    height: int = 560,
) -> anywidget.AnyWidget:
    """The motion player as a widget for JupyterLab, the last expression of a cell.

    Where nothing runs it, on a page that shows a saved notebook, a still picture is in its place.
    JupyterLab shows that in a notebook which it does not trust; in one that it does, it needs the
    cell to be run again, or the state of widgets to be saved with the notebook.

    Parameters
    ----------
    item, certificate, name, colours
        As for `write_player`.
    height : int
        Of the widget, in pixels, at least 420.

    Returns
    -------
    anywidget.AnyWidget
        With traits that follow the player and lead it: `time` (in moves, 0 to their number),
        `playing`, and `picked`, the number of a bar or -1.

    Raises
    ------
    ValueError
        As `write_player`, or if `height` is less than 420.
    ImportError
        If anywidget is not installed; `write_player` does without it.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> folding = lu.fold(lu.VoxelSolid(np.ones((3, 2, 1), bool)), rounds=2, trial_rounds=2)
    >>> film = lu.player(folding)
    >>> film.time = len(folding.motion)
    >>> film.playing, film.picked
    (False, -1)
    """
    if height < 420:
        raise ValueError(f"height must be at least 420 pixels, got {height}")
    content = shown(item, certificate, name, colours)
    return _widget_class()(item, shown=content, height=height)


@cache
def _widget_class() -> type[anywidget.AnyWidget]:
    """The class of the widget; anywidget is an extra, and slow to import."""
    try:
        import anywidget
        import traitlets
    except ImportError as error:
        raise ImportError(
            "lineup.player needs anywidget (pip install 'lineup-workbench[notebooks]'); "
            "lineup.write_player makes a page without it"
        ) from error

    class Player(anywidget.AnyWidget):
        _esm = script("widget")
        _css = source("player.css")
        shown = traitlets.Dict().tag(sync=True)
        time = traitlets.Float(0.0).tag(sync=True)
        playing = traitlets.Bool(False).tag(sync=True)
        picked = traitlets.Int(-1).tag(sync=True)
        height = traitlets.Int(560).tag(sync=True)

        def __init__(self, item: Motion | Folding, **traits: Any) -> None:
            super().__init__(**traits)
            self._item = item
            self._picture: bytes | None = None

        def __repr__(self) -> str:
            return "player of a motion"

        def _repr_mimebundle_(self, **options: Any) -> Any:
            bundle = super()._repr_mimebundle_(**options)
            if bundle is None:
                return None
            data, *rest = bundle if isinstance(bundle, tuple) else (bundle,)
            if self._picture is None:
                self._picture = _still(self._item)
            data = {**data, "image/png": self._picture}
            return (data, *rest) if rest else data

    return Player


def _still(item: Motion | Folding) -> bytes:
    """Three moments of a motion as PNG, for where the widget cannot run."""
    from ..draw import unfolding

    drawn, few = BytesIO(), BytesIO()
    unfolding(item, moments=3).savefig(drawn, format="png", dpi=72)
    # With 128 colours it is a third as large, and so is what it adds to a notebook.
    picture = Image.open(drawn).convert("RGB").quantize(128, dither=Image.Dither.NONE)
    picture.save(few, "PNG", optimize=True)
    return few.getvalue()
