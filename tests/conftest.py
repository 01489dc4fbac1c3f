"""Settings of every test run."""

import os
import signal
import sys

from examples import THOROUGH
from hypothesis import HealthCheck, settings

# Kernels compile inside the first example that needs them, so a time limit would be about that.
patient = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
# The same examples at every run, so that a change is never blamed for what luck turned up;
# `pytest --hypothesis-profile=search` looks for new ones, and for four times as many.
settings.register_profile("lineup", patient, derandomize=True, max_examples=THOROUGH // 4)
settings.register_profile("search", patient, print_blob=True, max_examples=THOROUGH)
settings.load_profile("lineup")

# No figure may wait for a screen, and VTK crashes where it looks for one in vain.
os.environ.setdefault("MPLBACKEND", "agg")
if sys.platform == "linux" and not os.environ.get("DISPLAY"):
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")

# Where the tests run in the background interrupts may be ignored, and some of them interrupt.
signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_finish():
    """Draw without smooth edges, in half of the time; here, so that doctests do so, too."""
    if render := sys.modules.get("lineup.draw.render"):  # slow to import where nothing is drawn
        render._OVERSAMPLING = 1
