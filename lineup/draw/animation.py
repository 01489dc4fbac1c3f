"""Motions as moving pictures."""

from __future__ import annotations

import os
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image

from ..grid import FloatArray
from ..kinematics import frames
from ..solid import Folding, Motion
from .files import whole
from .moments import PANEL, moment_panel, told
from .page import page
from .view import View, view_of

_DPI = 80


def animation(
    motion: Folding | Motion,
    file: str | os.PathLike[str],
    pictures: int = 64,
    seconds: float = 10.0,
) -> Path:
    """Write a motion as a GIF: the body near by, and the whole chain beside it.

    The camera stays where it sees the folded start, or, past half of a motion that has a goal,
    the folded end. The first and the last picture stay a second longer.

    Parameters
    ----------
    pictures : int
        How many, at equal numbers of moves; moves are shown in between if there are few.
    seconds : float
        How long it runs, before it starts again.

    Raises
    ------
    ValueError
        If `pictures` is less than 2, `seconds` is not positive, or the file is no .gif.

    Examples
    --------
    >>> import numpy as np, tempfile, lineup as lu
    >>> from lineup import draw
    >>> folding = lu.fold(lu.VoxelSolid(np.ones((3, 2, 1), bool)), rounds=2, trial_rounds=2)
    >>> draw.animation(folding, tempfile.mkdtemp() + "/unfolds.gif", pictures=3).name
    'unfolds.gif'
    """
    if pictures < 2 or not seconds > 0:
        raise ValueError(f"a film needs 2 pictures and some time, got {pictures} and {seconds} s")
    motion = motion.motion if isinstance(motion, Folding) else motion
    shown = _moments(motion, pictures)
    near = view_of(motion.start).widened(0.8)
    far = view_of(shown[-1][1]).widened(0.8) if len(motion.goal) else near
    film = [
        _picture(motion, move, pose, near if k < len(shown) / 2 else far)
        for k, (move, pose) in enumerate(shown)
    ]
    pause = round(1000 * seconds / len(film))
    lasting = [pause] * len(film)
    lasting[0] += 1000
    lasting[-1] += 1000
    with whole(file, ".gif") as part:
        film[0].save(part, "GIF", save_all=True, append_images=film[1:], duration=lasting, loop=0)
    return Path(file)


def _moments(motion: Motion, pictures: int) -> list[tuple[int, FloatArray]]:
    """Poses to show, each after how many moves: the first, the last, equally spaced between."""
    substeps = max(1, (pictures - 1) // max(len(motion), 1))
    wanted = set(np.linspace(0, substeps * len(motion), pictures).astype(int).tolist())
    poses = enumerate(frames(motion, substeps=substeps))
    return [(k // substeps, pose) for k, pose in poses if k in wanted]


def _picture(motion: Motion, move: int, pose: FloatArray, view: View) -> Image.Image:
    figure = page(*PANEL)
    moment_panel(figure, pose, view, *told(motion, move, pose))
    drawn = BytesIO()
    figure.savefig(drawn, format="png", dpi=_DPI)
    return Image.open(drawn).convert("RGB").quantize(96, dither=Image.Dither.NONE)
