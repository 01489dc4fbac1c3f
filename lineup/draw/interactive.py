"""Pictures with sliders in a live notebook, and the same picture, still, everywhere else."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from io import BytesIO
from typing import Any

from matplotlib.figure import Figure

QUICK = "LINEUP_QUICK"
"""Environment variable that asks for still pictures, and for small models in notebooks."""


def explore(picture: Callable[..., Figure], **choices: Sequence[Any]) -> Any:
    """A picture with a slider for each of its arguments, or a still one where nobody can slide.

    Parameters
    ----------
    picture : function
        Takes the names of `choices` as keywords and returns a figure.
    choices : sequences
        The values of each argument, in the order of the slider; the middle one is shown first.

    Returns
    -------
    Figure or widget
        A widget if a person runs the cell in a notebook; else the figure of the middle values.
        A saved notebook has a still picture beside the widget.

    Raises
    ------
    ValueError
        If there are no choices, or one has no values.

    Notes
    -----
    A front end with a person before it offers the kernel to ask for input; nbconvert, nbclient
    and papermill do not, and neither does Python without a notebook.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup import draw
    >>> slabs = {n: lu.VoxelSolid(np.ones((4, 3, n), bool)) for n in (1, 2, 3)}
    >>> figure = draw.explore(lambda high: draw.solid(slabs[high]), high=[1, 2, 3])
    >>> figure.get_size_inches().tolist()
    [6.0, 6.0]
    """
    if not choices or not all(len(values) for values in choices.values()):
        raise ValueError(f"every argument of the picture needs values, got {choices}")
    first = {name: values[len(values) // 2] for name, values in choices.items()}
    if not live():
        return picture(**first)
    return _widget(picture, choices, first)


def live() -> bool:
    """Whether a person runs this, in a notebook whose front end can ask for input.

    Examples
    --------
    >>> live()
    False
    """
    if os.environ.get(QUICK) or find_spec("ipywidgets") is None:
        return False
    shell = sys.modules.get("IPython")
    running: Any = shell and shell.get_ipython()
    kernel = getattr(running, "kernel", None)
    if kernel is None:
        return False
    request = kernel.get_parent("shell") or {}
    return bool(request.get("content", {}).get("allow_stdin", False))


def _widget(
    picture: Callable[..., Figure], choices: dict[str, Sequence[Any]], first: dict[str, Any]
) -> Any:
    import ipywidgets  # an extra

    class Explorer(ipywidgets.VBox):  # type: ignore[misc]
        """Sliders over a picture, which also stands for them in a saved notebook."""

        def _repr_mimebundle_(self, **options: Any) -> Any:
            return {**super()._repr_mimebundle_(**options), "image/png": image.value}

    sliders = {
        name: ipywidgets.SelectionSlider(
            options=[(str(value), value) for value in values],
            value=first[name],
            description=name,
            continuous_update=False,
        )
        for name, values in choices.items()
    }
    image = ipywidgets.Image(value=_png(picture(**first)), format="png")
    image.layout.max_width = "100%"

    def redraw(_: object) -> None:
        image.value = _png(picture(**{name: slider.value for name, slider in sliders.items()}))

    for slider in sliders.values():
        slider.observe(redraw, "value")
    return Explorer([ipywidgets.HBox(list(sliders.values())), image])


def _png(figure: Figure) -> bytes:
    drawn = BytesIO()
    figure.savefig(drawn, format="png", dpi=80, metadata={"Software": None})
    return drawn.getvalue()
