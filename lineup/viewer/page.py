"""What the player shows, and the page that holds it: one file without anything outside it."""

from __future__ import annotations

import hashlib
import html
import json
import os
import re
from collections.abc import Mapping
from dataclasses import asdict
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..solid import Certificate, Folding, Motion
from ..storage import document, plain, text, write_whole

_POLICY = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:"

_ICON = (
    "data:image/svg+xml,%3Csvg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 16 16'%3E"
    "%3Cpath d='M2 13V3h6v6h6' fill='none' stroke='%230b63b5' stroke-width='3.5' "
    "stroke-linecap='round' stroke-linejoin='round'/%3E%3C/svg%3E"
)

_PAGE = """\
<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<link rel="icon" href="{icon}">
<title>{title}</title>
<style>
html, body {{ margin: 0; height: 100%; background: #fff; }}
#player {{ height: 100vh; height: 100dvh; border: 0; border-radius: 0; }}
{css}</style>
</head>
<body>
<div id="player"></div>
<noscript>This page shows a moving chain, and needs JavaScript for it.</noscript>
<script type="application/json" id="shown">{shown}</script>
<script type="module">
{script}
openPage(document.getElementById("player"), document.getElementById("shown").textContent);
</script>
</body>
</html>
"""

_IMPORT = re.compile(r'^import \{[^}]*\} from "\./(\w+)\.js";\n', re.M)
_EXPORT = re.compile(r"^export (?=const |function |async function |class )", re.M)


def write_player(
    item: Motion | Folding,
    file: str | os.PathLike[str],
    *,
    certificate: Certificate | None = None,
    name: str | None = None,
    colours: Mapping[str, ArrayLike] | None = None,
) -> Path:
    """Write the motion player: one HTML file that plays a motion, offline, in any browser.

    It can be played at any speed and in both directions, stepped move by move and layer by layer,
    and looked at from everywhere; a click on a block tells its number and its joints.

    Parameters
    ----------
    item : Motion or Folding
        Of a folding the visits of its path are shown, too.
    file : path
        Name of the page. An existing file is replaced.
    certificate : Certificate, optional
        What `certify` says of this motion. Without one the page says that it is not judged.
    name : str, optional
        What the page calls the motion; the name of the file without its ending if not given.
        ``"A to B"`` names the two shapes of a motion that has a goal.
    colours : mapping, optional
        Numbers by which the bars can be coloured, (P - 1,) each, by name, such as
        ``{"stress, MPa": stress}``; nan where nothing is known.

    Returns
    -------
    Path
        Of the file.

    Raises
    ------
    ValueError
        If `item` is something else or has less than two joints, the certificate is of another
        motion, there is not one number for each bar, or the file is not named .html.
    FileNotFoundError
        If the folder to write into does not exist.

    Examples
    --------
    >>> import numpy as np, tempfile, lineup as lu
    >>> folding = lu.fold(lu.VoxelSolid(np.ones((3, 2, 1), bool)), rounds=2, trial_rounds=2)
    >>> verdict = lu.certify(folding.motion)
    >>> page = lu.write_player(folding, tempfile.mkdtemp() + "/bar.html", certificate=verdict)
    >>> page.name, "certified" in page.read_text()
    ('bar.html', True)
    """
    path = Path(file)
    if path.suffix.lower() != ".html":
        raise ValueError(f"a player is written as .html, got {path.name!r}")
    content = shown(item, certificate, path.stem if name is None else name, colours)
    # Nothing in a JSON text can end the element it stands in if it has no "<".
    data = json.dumps(content, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    page = _PAGE.format(
        policy=_POLICY,
        icon=_ICON,
        title=html.escape(f"{content['name']}: motion"),
        css=source("player.css"),
        shown=data,
        script=script("player"),
    )
    return write_whole(path, page)


def shown(
    item: Motion | Folding,
    certificate: Certificate | None,
    name: str,
    colours: Mapping[str, ArrayLike] | None,
) -> dict[str, Any]:
    """What the player is given, in JSON's own types (docs/formats.md); errors as `write_player`."""
    if not isinstance(item, (Motion, Folding)):
        raise ValueError(f"the player shows a Motion or a Folding, got a {type(item).__name__}")
    motion = item.motion if isinstance(item, Folding) else item
    if len(motion.start) < 2:
        raise ValueError(f"the player shows two joints or more, got {len(motion.start)}")
    if certificate is not None and certificate.ok and certificate.moves_checked != len(motion):
        raise ValueError(
            f"the certificate is of another motion: {certificate.moves_checked} moves were "
            f"judged, and this one has {len(motion)}"
        )
    return {
        "name": name,
        "sha256": hashlib.sha256(text(motion).encode()).hexdigest(),
        "certificate": None if certificate is None else plain(asdict(certificate)),
        "visits": item.path.visits.tolist() if isinstance(item, Folding) else [],
        "colours": {
            str(key): _numbers(key, values, len(motion.start) - 1)
            for key, values in (colours or {}).items()
        },
        "motion": plain(document(motion)),
    }


def script(module: str) -> str:
    """A module of the player and all that it imports, as the text of one module.

    Imports are replaced by the modules themselves, each before those that need it; their names
    must differ, which the tests see to.
    """
    order: list[str] = []

    def visit(name: str) -> None:
        for needed in _IMPORT.findall(source(f"{name}.js")):
            if needed not in order:
                visit(needed)
        order.append(name)

    visit(module)
    parts = (_EXPORT.sub("", _IMPORT.sub("", source(f"{name}.js"))) for name in order)
    return "\n".join(part.strip() + "\n" for part in parts)


def source(name: str) -> str:
    """The text of a file of the player."""
    return resources.files(__package__).joinpath(name).read_text(encoding="utf-8")


def _numbers(key: str, values: ArrayLike, n_bars: int) -> list[float | None]:
    array = np.asarray(values, np.float64)
    if array.shape != (n_bars,):
        raise ValueError(
            f"colours {key!r} must be {n_bars} numbers, one for each bar, got shape {array.shape}"
        )
    return [float(f"{value:.5g}") if np.isfinite(value) else None for value in array]
