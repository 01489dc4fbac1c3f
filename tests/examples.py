"""How many examples a dear property is tried on."""

from hypothesis import settings

THOROUGH = 400
"""Examples in the profile `search`, where a property says nothing else."""


def examples(n, **more):
    """Settings of a property, with `n` examples in the profile `search`, a quarter by default.

    At least ten: fewer would seldom be anything but boxes and bars.
    """
    return settings(max_examples=max(10, n * settings.default.max_examples // THOROUGH), **more)
