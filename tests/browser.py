"""Pages in a real browser, for the tests of the player."""

import os
import shutil
from io import BytesIO

import numpy as np
from PIL import Image

BROWSER = next(
    (
        found
        for name in ("chromium", "chromium-browser", "google-chrome")
        if (found := shutil.which(name))
    ),
    None,
)

SOFTWARE = [
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
]
NO_WEBGL = ["--disable-gpu", "--disable-3d-apis"]


def launched(engine, kind):
    sandbox = ["--no-sandbox"] if hasattr(os, "geteuid") and os.geteuid() == 0 else []
    drawn_by = SOFTWARE if kind == "webgl" else NO_WEBGL
    return engine.chromium.launch(executable_path=BROWSER, args=sandbox + drawn_by)


def opened(page, address):
    page.goto(address)
    until(page, "p?.frames > 0")
    return page


def ask(page, expression):
    player = "document.getElementById('player').player"
    return page.evaluate(f"(() => {{ const p = {player}; return {expression}; }})()")


def until(page, expression):
    """Wait until something holds; the page's policy keeps Playwright's own way to wait out."""
    for _ in range(400):
        if ask(page, expression):
            return
        page.wait_for_timeout(50)
    raise TimeoutError(expression)


def shot(page, selector="canvas.view"):
    until(page, "!p.waiting")
    return seen(page, selector)


def seen(page, selector):
    pixels = Image.open(BytesIO(page.locator(selector).screenshot())).convert("RGB")
    return np.asarray(pixels).astype(int)


def alike(a, b):
    """Whether two pictures are the same, but for the last bits of smoothed edges."""
    return np.abs(a - b).max() <= 4


def colourful(pixels):
    """Share of the pixels that are neither ground nor grey."""
    return float((np.ptp(pixels, axis=-1) > 60).mean())
