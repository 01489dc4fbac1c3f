"""Settings of every test run."""

import os
import sys

from hypothesis import HealthCheck, settings

# Kernels compile inside the first example that needs them, so a time limit would be about that.
patient = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
# The same examples at every run, so that a change is never blamed for what luck turned up;
# `pytest --hypothesis-profile=search` looks for new ones.
settings.register_profile("lineup", patient, derandomize=True)
settings.register_profile("search", patient, print_blob=True)
settings.load_profile("lineup")

# No figure may wait for a screen, and VTK crashes where it looks for one in vain.
os.environ.setdefault("MPLBACKEND", "agg")
if sys.platform == "linux" and not os.environ.get("DISPLAY"):
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
