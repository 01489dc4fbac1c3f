"""Motions as moving pictures."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image

from ..solid import Folding, Motion
from .files import whole
from .moments import PANEL, moment_panel
from .page import page
from .story import Moment, scenes_of
from .view import View

GIF_RATE, MP4_RATE = 6, 24
"""Pictures a second, where their number is not given."""

_DPI = 80
_LINGER = 1.0  # seconds longer that the first and the last picture stay


def animation(
    motion: Folding | Motion,
    file: str | os.PathLike[str],
    pictures: int | None = None,
    seconds: float = 10.0,
) -> Path:
    """Write a motion as a film: the body near by, and the whole chain beside it.

    The camera stays where it sees the folded start. A motion from shape to shape is turned as a
    whole on the straight line, so that either shape stands upright; one that never makes the line
    is seen from where all of it is in sight.

    Parameters
    ----------
    file : path
        ``.gif``, or ``.mp4`` where the package `imageio-ffmpeg` is installed (extra `video`).
    pictures : int, optional
        How many, at equal numbers of moves; moves are shown in between if there are few. By
        default 6 for each second of a GIF and 24 of an MP4.
    seconds : float
        How long it runs; the first and the last picture stay a second longer.

    Raises
    ------
    ValueError
        If `pictures` is less than 2, `seconds` is not positive, the file is of another kind, or
        an MP4 is asked for and cannot be made.

    Examples
    --------
    >>> import numpy as np, tempfile, lineup as lu
    >>> from lineup import draw
    >>> folding = lu.fold(lu.VoxelSolid(np.ones((3, 2, 1), bool)), rounds=2, trial_rounds=2)
    >>> draw.animation(folding, tempfile.mkdtemp() + "/unfolds.gif", pictures=3).name
    'unfolds.gif'
    """
    ending = Path(file).suffix.lower()
    if ending not in (".gif", ".mp4"):
        raise ValueError(f"a film is written as .gif or .mp4, got {Path(file).name!r}")
    if pictures is None:
        pictures = max(2, round(seconds * (GIF_RATE if ending == ".gif" else MP4_RATE)))
    if pictures < 2 or not seconds > 0:
        raise ValueError(f"a film needs 2 pictures and some time, got {pictures} and {seconds} s")
    write = _gif if ending == ".gif" else _mp4()
    motion = motion.motion if isinstance(motion, Folding) else motion
    film = (_picture(moment, view) for moment, view in scenes_of(motion, pictures))
    with whole(file, ending) as part:
        write(part, film, seconds / pictures)
    return Path(file)


def _picture(moment: Moment, view: View) -> Image.Image:
    figure = page(*PANEL)
    moment_panel(figure, moment.pose, view, moment.title, moment.where)
    drawn = BytesIO()
    figure.savefig(drawn, format="png", dpi=_DPI)
    return Image.open(drawn).convert("RGB")


def _gif(part: Path, film: Iterator[Image.Image], pause: float) -> None:
    few = [picture.quantize(96, dither=Image.Dither.NONE) for picture in film]
    lasting = [round(1000 * pause)] * len(few)
    lasting[0] += round(1000 * _LINGER)
    lasting[-1] += round(1000 * _LINGER)
    few[0].save(part, "GIF", save_all=True, append_images=few[1:], duration=lasting, loop=0)


def _mp4() -> Callable[[Path, Iterator[Image.Image], float], None]:
    """A writer of MP4 files, once it is clear that there can be one."""
    try:
        from imageio_ffmpeg import write_frames
    except ImportError:
        raise ValueError(
            "an MP4 takes the package imageio-ffmpeg (pip install 'lineup-workbench[video]'); "
            "a .gif can be written without it"
        ) from None

    def write(part: Path, film: Iterator[Image.Image], pause: float) -> None:
        sink, last = None, b""
        for picture in film:
            size = (picture.width - picture.width % 2, picture.height - picture.height % 2)
            last = np.asarray(picture.crop((0, 0, *size))).tobytes()
            if sink is None:
                options = ["-f", "mp4", "-movflags", "+faststart", "-fflags", "+bitexact"]
                sink = write_frames(
                    str(part), size, fps=1 / pause, output_params=options, macro_block_size=2
                )
                sink.send(None)
                for _ in range(round(_LINGER / pause)):
                    sink.send(last)
            sink.send(last)
        assert sink is not None  # a film has two pictures or more
        for _ in range(round(_LINGER / pause)):
            sink.send(last)
        sink.close()

    return write
