"""The accordion: one move that straightens a monotone path, for any bar diameter it starts with."""

import numpy as np

from ..grid import LETTERS, bar_directions
from ..kinematics import Move
from ..solid import Motion, VoxelPath
from .plan import DIAMETER, MAX_BEND_DEG


def accordion(path: VoxelPath, seed: int) -> Motion:
    """Tilt all bars at once towards a direction that the path never steps against.

    For two points of the chain with horizontal offset d, horizontal arc length N >= |d| between
    them and vertical offset h of the sign of the tilt, the squared distance at angle a is
    cos(a)^2 d^2 + (|h| + N sin(a))^2 >= d^2 + h^2: no distance ever shrinks.
    """
    del seed  # nothing is drawn
    bars = bar_directions(path.voxels)
    against = [d for d in range(6) if not (bars == d).any()]
    if not against:
        reason = f"the path steps in all six directions {LETTERS}, so it is not monotone"
        return Motion(
            path.voxels, np.empty((0, 4), np.int32), DIAMETER, MAX_BEND_DEG, False, reason
        )
    target = max(((d + 3) % 6 for d in against), key=lambda d: (int((bars == d).sum()), -d))
    tilt = [] if (bars == target).all() else [(Move.TILT, 0, len(bars), 0)]
    return Motion(
        path.voxels,
        np.array(tilt, np.int32).reshape(-1, 4),
        DIAMETER,
        MAX_BEND_DEG,
        True,
        "straight",
        np.full((len(tilt), len(bars)), target, np.int8),
    )
