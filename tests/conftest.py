"""Settings of every test run."""

import os
import sys

from hypothesis import HealthCheck, settings

# Kernels compile inside the first example that needs them, so a time limit would be about that.
settings.register_profile("lineup", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("lineup")

# No figure may wait for a screen, and VTK crashes where it looks for one in vain.
os.environ.setdefault("MPLBACKEND", "agg")
if sys.platform == "linux" and not os.environ.get("DISPLAY"):
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
