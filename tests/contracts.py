"""What every planner of a kind must keep, whatever it is; one check for each kind."""

import numpy as np

import lineup as lu

DIAMETER, MAX_BEND_DEG = 0.999, 90.0
NOT_STRAIGHT = "ends not straight, and is straight nowhere before"


def check_path(path, solid):
    """A path of a solid: simple, adjacent, even, inside; `dropped` is exactly the rest."""
    verdict = lu.certify_path(path, solid)
    assert verdict.ok, verdict.reason
    assert len(path) % 2 == 0
    assert 0 < path.coverage(solid) <= 1


def check_motion(motion):
    """A motion does what it says: straight and certified, or free of collisions up to its end."""
    verdict = lu.certify(motion, diameter=DIAMETER, max_bend_deg=MAX_BEND_DEG)
    assert verdict.moves_checked == len(motion), verdict.reason
    assert verdict.reason == ("certified" if motion.straight else NOT_STRAIGHT)
    assert motion.reason.startswith("straight") == motion.straight
    assert (motion.diameter, motion.max_bend_deg) == (DIAMETER, MAX_BEND_DEG)


def check_folding(folding, solid):
    """A folding ends straight, and its motion unfolds exactly its path."""
    check_path(folding.path, solid)
    assert np.array_equal(folding.motion.start, folding.path.voxels)
    assert folding.motion.straight, folding.motion.reason
    check_motion(folding.motion)
