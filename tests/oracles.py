"""Slow plain twins and brute-force oracles, shared by the tests."""

import itertools

import numpy as np
from scipy import optimize

import lineup as lu
from lineup import grid, kinematics
from lineup.kinematics import Move


def segment_distances(a0, a1, b0, b1):
    """Distance of each segment a0-a1 to each segment b0-b1, arrays (n, 3)."""

    def to_segment(p, q0, q1):
        along = q1 - q0
        t = ((p - q0) * along).sum(axis=1) / (along * along).sum(axis=1)
        return np.linalg.norm(p - q0 - np.clip(t, 0, 1)[:, None] * along, axis=1)

    best = np.minimum.reduce(
        [
            to_segment(a0, b0, b1),
            to_segment(a1, b0, b1),
            to_segment(b0, a0, a1),
            to_segment(b1, a0, a1),
        ]
    )
    a, b, gap = a1 - a0, b1 - b0, a0 - b0
    aa, ab, bb = (a * a).sum(axis=1), (a * b).sum(axis=1), (b * b).sum(axis=1)
    ag, bg = (a * gap).sum(axis=1), (b * gap).sum(axis=1)
    det = aa * bb - ab * ab
    skew = det > 1e-9
    det = np.where(skew, det, 1.0)
    s, t = (ab * bg - bb * ag) / det, (aa * bg - ab * ag) / det
    inside = skew & (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    across = np.linalg.norm(gap + s[:, None] * a - t[:, None] * b, axis=1)
    return np.where(inside, np.minimum(best, across), best)


def pose_clearance(pose):
    """Smallest distance of bars two or more apart, all pairs."""
    k, m = np.triu_indices(len(pose) - 1, 2)
    return segment_distances(pose[k], pose[k + 1], pose[m], pose[m + 1]).min(initial=np.inf)


def pose_bend_deg(pose):
    """Largest bend between consecutive bars."""
    bars = np.diff(pose, axis=0)
    sines = np.linalg.norm(np.cross(bars[1:], bars[:-1]), axis=1)
    cosines = (bars[1:] * bars[:-1]).sum(axis=1)
    return float(np.degrees(np.arctan2(sines, cosines)).max(initial=0.0))


def sampled_move(motion, pose, move, samples=129):
    """Clearance and largest bend of one move by sampling, the lowest samples refined locally.

    The true clearance is at most the one returned, and lower only where it dips between samples.
    """
    times = np.linspace(0, 1, samples)
    poses = [kinematics.moved(pose, move, motion, t) for t in times]
    distances = np.array([pose_clearance(p) for p in poses])
    lowest = distances.min()
    for k in np.argsort(distances, kind="stable")[:3]:
        bracket = (times[max(k - 1, 0)], times[min(k + 1, samples - 1)])
        found = optimize.minimize_scalar(
            lambda t: pose_clearance(kinematics.moved(pose, move, motion, t)),
            bounds=bracket,
            method="bounded",
            options={"xatol": 1e-10},
        )
        lowest = min(lowest, found.fun)
    return lowest, max(pose_bend_deg(p) for p in poses)


def reversed_motion(motion):
    """The motion played backwards, from the poses alone."""
    poses = [np.rint(p).astype(int) for p in kinematics.frames(motion)]
    rows, targets = [], []
    for pose, (kind, joint, other, value) in zip(poses, motion.moves.tolist(), strict=False):
        if kind == Move.DOOR:
            rows.append((kind, joint, other, -value))
        elif kind == Move.TILT:
            rows.append((kind, joint, other, len(targets)))
            targets.append(grid.bar_directions(pose))
        else:
            bar = pose[[joint, other]]
            rows.append((kind, joint, other, int(grid.bar_directions(bar)[0])))
    return lu.Motion(
        poses[-1],
        np.array(rows[::-1], int).reshape(-1, 4),
        motion.diameter,
        motion.max_bend_deg,
        pose_bend_deg(poses[0].astype(float)) == 0,
        "reversed",
        np.array(targets, np.int8).reshape(len(targets), len(poses[0]) - 1 if targets else 0),
    )


def layer_runs(voxels, occupancy):
    """Maximal runs of a path in one layer component: rows (start, stop, component), by flooding."""
    component = {}
    for seed in map(tuple, np.argwhere(occupancy).tolist()):
        if seed in component:
            continue
        component[seed], todo = len(component), [seed]
        while todo:
            x, y, z = todo.pop()
            for near in ((x + 1, y, z), (x - 1, y, z), (x, y + 1, z), (x, y - 1, z)):
                inside = all(0 <= c < n for c, n in zip(near, occupancy.shape, strict=True))
                if inside and occupancy[near] and near not in component:
                    component[near] = component[seed]
                    todo.append(near)
    names = [component[tuple(v)] for v in np.asarray(voxels).tolist()]
    starts = [k for k in range(len(names)) if k == 0 or names[k] != names[k - 1]]
    return [(a, b, names[a]) for a, b in zip(starts, [*starts[1:], len(names)], strict=True)]


def alternates(names):
    """Whether a list holds a, b, a, b in this order for some a != b, by trying all four places."""
    return any(a == c and b == d and a != b for a, b, c, d in itertools.combinations(names, 4))


def enclosing(names, k):
    """How many names other than ``names[k]`` stand both before and after place k."""
    return len((set(names[:k]) & set(names[k + 1 :])) - {names[k]})
