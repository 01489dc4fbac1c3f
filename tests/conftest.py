"""Settings of every test run."""

import os

from hypothesis import HealthCheck, settings

# Kernels compile inside the first example that needs them, so a time limit would be about that.
settings.register_profile("lineup", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("lineup")

# No figure may wait for a screen.
os.environ.setdefault("MPLBACKEND", "agg")
