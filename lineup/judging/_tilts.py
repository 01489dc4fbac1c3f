"""The accordion lemma: when a TILT, all bars turning at once, brings no two points nearer."""

import numpy as np
from numpy.typing import NDArray

from ..solid import Motion

_MIXED = "its bars neither turn all to one direction nor all from one"


def malformed_tilt(motion: Motion, joint: int, other: int, value: int) -> str:
    n_joints, poses = len(motion.start), motion.poses
    if (joint, other) != (0, n_joints - 1):
        return f"must name the joints 0 and {n_joints - 1}"
    if poses.ndim != 2 or poses.shape[1] != n_joints - 1 or not 0 <= value < len(poses):
        return f"has no row in poses of shape {poses.shape}"
    if not ((poses[value] >= 0) & (poses[value] < 6)).all():
        return "leads to a direction outside 0..5"
    return ""


def not_monotone(
    bars: NDArray[np.int64], targets: NDArray[np.int64], turning: NDArray[np.bool_]
) -> str:
    """Why the accordion lemma holds neither forwards nor backwards; "" if it does."""
    reasons = [
        _not_accordion(bars, targets, turning),
        _not_accordion(targets, bars, turning),
    ]
    if "" in reasons:
        return ""
    return next((reason for reason in reasons if reason != _MIXED), _MIXED)


def _not_accordion(
    folded: NDArray[np.int64], unfolded: NDArray[np.int64], turning: NDArray[np.bool_]
) -> str:
    """Why the accordion lemma does not hold from `folded` to `unfolded`; "" if it does.

    Between two points of the chain let the turning bars make a displacement d over an arc of
    length N >= |d|, and the resting ones r across and h >= 0 along the one direction. At angle a
    from the folded pose the squared distance is cos(a)^2 d^2 + r^2 + (h + N sin(a))^2, because r
    is perpendicular to d, and that is at least d^2 + r^2 + h^2. Neighbours that both turn have
    the cosine (their first) cos(a)^2 + sin(a)^2, so that every bend is largest at an end.
    """
    along = unfolded[turning][0]
    if (unfolded[turning] != along).any():
        return _MIXED
    against = (folded == -along).all(axis=1)
    if against.any():
        return f"bar {int(np.flatnonzero(against)[0])} steps against the others' direction"
    axes = np.abs(folded[turning]).any(axis=0)
    rests_beside = ~turning & np.abs(folded)[:, axes].any(axis=1)
    if rests_beside.any():
        return f"bar {int(np.flatnonzero(rests_beside)[0])} rests on an axis of bars that turn"
    return ""


def tilt_box(
    first: NDArray[np.int64],
    bars: NDArray[np.int64],
    targets: NDArray[np.int64],
    turning: NDArray[np.bool_],
) -> NDArray[np.float64]:
    """Lowest and highest positions, (2, 3), of the joints over a tilt that leaves joint 0 at rest.

    At angle a from the pose before it a joint is at r + cos(a) u + sin(a) v. Over a quarter turn
    each coordinate is monotone, unless those of u and v have one sign: then it bulges.
    """
    moves = turning[:, None]
    parts = np.where(moves, 0, bars), np.where(moves, bars, 0), np.where(moves, targets, 0)
    r, u, v = (np.vstack([np.zeros(3), part.cumsum(axis=0)]) for part in parts)
    bulge = np.hypot(u, v)
    low = first + r + np.where((u < 0) & (v < 0), -bulge, np.minimum(u, v))
    high = first + r + np.where((u > 0) & (v > 0), bulge, np.maximum(u, v))
    return np.stack([low.min(axis=0), high.max(axis=0)])
