"""Section 8's uses as runs: through a tube and fold beyond it, and into a capsule through a port.

The chain glides along its own track, as in `transformation.gliding`, past obstacles that are unit
voxels; the judge says whether it meets one.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree

from ._record import of_kind, record
from .folding import fold
from .grid import DIRECTIONS, BoolArray, FloatArray, IntArray, bar_directions
from .judging import certify
from .kinematics import Move
from .motion.pulling import MARGIN
from .solid import Certificate, Folding, Motion, Obstacles, VoxelPath, VoxelSolid
from .transformation.gliding import NO_WAY, glide

LEAD = 3
"""Voxels between the wall and the shapes on its two sides, and of straight tube at its mouths."""

TURN_DEG = 60.0
"""By how much the tube turns aside, and back again."""

_STEP = 0.05  # between points of a centre line

_CROOK = np.sqrt(0.5)


@record
class Scenario:
    """A run past obstacles: what moves, past what, and what the judge says.

    Attributes
    ----------
    motion : Motion
        Without moves where there is no way; its `reason` says why.
    obstacles : Obstacles
    certificate : Certificate
        The verdict on the motion beside the obstacles, at its own diameter and bend.
    centre_line : (K, 3) float64
        Points of the axis of the tube or capsule.
    radius : float
        Of the tube or capsule, in voxel units.
    """

    motion: Motion
    obstacles: Obstacles
    certificate: Certificate
    centre_line: FloatArray
    radius: float


def through_tube(
    a: Folding | VoxelPath | None,
    b: Folding | VoxelPath,
    radius: float = 2.2,
    bend_radius: float = 12.0,
) -> Scenario:
    """Through a curved tube in a wall, to fold into shape B beyond it (Section 8, endoscopy).

    The tube turns aside by 60 degrees and back again, on two arcs. Free of the wall are the unit
    voxels that lie wholly in a ball of the tube's radius about a point of its centre line.

    Parameters
    ----------
    a : Folding, VoxelPath or None
        The shape before the wall; None is the straight chain, its end at the tube's mouth.
    b : Folding or VoxelPath
        The shape beyond the wall, of as many joints.
    radius : float
        Of the tube, in voxel units.
    bend_radius : float
        Of the centre line's two arcs; not less than `radius`.

    Returns
    -------
    Scenario
        If the tube is too narrow, the motion has no moves, and a `reason`.

    Raises
    ------
    ValueError
        If the chains differ in length, or the radii are not positive and in this order.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> path = lu.layered_path(lu.VoxelSolid(np.ones((3, 3, 2), bool)))
    >>> scenario = lu.through_tube(None, path, radius=2.0, bend_radius=5.0)
    >>> scenario.motion.reason, scenario.certificate.reason
    ('glides into its goal', 'certified')
    """
    if not 0 < radius <= bend_radius < np.inf:
        raise ValueError(
            f"radius and bend_radius must be positive, the first not larger, "
            f"got {radius} and {bend_radius}"
        )
    after = _path(b)
    before = None if a is None else _path(a)
    if before is not None and len(before) != len(after):
        raise ValueError(
            f"the chains have {len(before)} and {len(after)} joints; trim them to one length"
        )
    line = _s_curve(bend_radius)
    wall = _wall_round(line, radius, [after] if before is None else [before, after])
    mouths = np.rint(line[[0, -1]]).astype(np.int32)
    after = _placed(after, mouths[1] + (LEAD + 1, 0, 0), 0)
    if before is None:
        far = mouths[0] - np.outer(np.arange(len(after), 0, -1), (1, 0, 0)).astype(np.int32)
        found = [glide(far, after, wall, (1,)), glide(far[::-1], after, wall, (0,))]
    else:
        found = [glide(_placed(before, mouths[0] - (LEAD + 1, 0, 0), -1), after, wall)]
    motion = min(found, key=lambda m: (not len(m), -m.diameter, len(m)))
    if motion.reason == NO_WAY:
        reason = f"no way leads through a tube of radius {radius:g} and into shape B"
        motion = replace(motion, reason=reason)
    return _judged(motion, wall, line, radius)


def into_capsule(
    radius: float = 7.0, length: float = 20.0, seed: int = 0, **options: Any
) -> Scenario:
    """Into a capsule through a port in its shell, to fill it (Section 8, aerospace).

    The chain comes in as a straight line. Its path inside is that of ``lu.fold(method="pull")``,
    in the unit voxels wholly inside a capsule that is thinner by half a voxel's diagonal: so the
    voxels in the crooks of the path's corners lie inside, too.

    Parameters
    ----------
    radius, length : float
        Of the inside, in voxel units: a cylinder between two hemispheres, and all three.
    seed : int
    **options
        Those of the fold method ``"pull"``.

    Returns
    -------
    Scenario
        Its obstacles are the shell but for the port: what the track and the crooks of its
        corners take of it.

    Raises
    ------
    ValueError
        If the capsule holds less than two voxels, or is shorter than wide.

    Examples
    --------
    >>> import lineup as lu
    >>> scenario = lu.into_capsule(2.9, 7.0)
    >>> len(scenario.motion.start) % 2, scenario.certificate.reason
    (0, 'certified')
    """
    if not 2 * radius <= length < np.inf:
        raise ValueError(f"length must be twice the radius at least, got {length} and {radius}")
    axis = np.array([(0, 0, radius - length / 2), (0, 0, length / 2 - radius)]) - 0.5
    low = np.floor(axis[0] - radius).astype(np.int32) - 2
    shape = tuple((np.ceil(axis[1] + radius).astype(int) + 3 - low).tolist())
    filled = _in_capsule(axis, radius - _CROOK, low, shape)
    if filled.sum() < 2:
        raise ValueError(f"a capsule of radius {radius} and length {length} has no room for a path")
    folding = fold(VoxelSolid(filled), "pull", None, seed, **options)
    pulled_out = folding.motion
    if not pulled_out.straight:
        motion = replace(pulled_out, goal=pulled_out.start)
        return _judged(motion, Obstacles(~filled, low), axis, radius)
    track = _track_out(pulled_out, shape) + low
    room = _in_capsule(axis, radius, low, shape)
    shell = ndimage.binary_dilation(room, np.ones((3, 3, 3), bool)) & ~room
    corners = track[:-2] + track[2:] - track[1:-1]  # the crooks; on a straight line, its middle
    port = np.vstack([track, corners]) - low
    port = port[((port >= 0) & (port < shape)).all(axis=1)]
    shell[tuple(port.T)] = False
    motion = _drawn_in(track, pulled_out, low)
    return _judged(motion, Obstacles(shell, low), axis, radius)


def _drawn_in(track: IntArray, out: Motion, shift: IntArray) -> Motion:
    """The motion back along the track on which `out`, shifted, pulls a chain out."""
    last = len(out.start) - 1
    by_first = not len(out) or out.moves[0, 1] == last  # that motion is led by the last joint
    lead = 0 if by_first else last
    line = track[-last - 1 :]
    values = bar_directions(track[::-1])[last:].tolist()
    return Motion(
        line if by_first else line[::-1],
        np.array([(Move.PULL, lead, last - lead, value) for value in values], np.int32),
        out.diameter,
        out.max_bend_deg,
        False,
        "glides into its goal",
        goal=out.start + shift,
    )


def _track_out(motion: Motion, shape: tuple[int, ...]) -> IntArray:
    """The track of a motion that pulls a chain out, led by its last vertex.

    It goes on until all of the chain is outside of a grid of this shape.
    """
    last = len(motion.start) - 1
    head = int(motion.moves[0, 1]) if len(motion) else last
    folded = motion.start if head else motion.start[::-1]
    steps = motion.moves[:, 3].tolist()
    onward = steps[-1] if steps else int(bar_directions(folded)[-1])
    out = DIRECTIONS[steps + [onward] * (max(shape) + last)].cumsum(axis=0)
    track: IntArray = np.vstack([folded, folded[-1] + out])
    inside = ((track >= 0) & (track < shape)).all(axis=1)
    return track[: max(int(np.flatnonzero(inside)[-1]) + 1, len(steps)) + len(folded)]


def _path(shape: Folding | VoxelPath) -> IntArray:
    of_kind(shape, Folding, VoxelPath)
    return (shape.path if isinstance(shape, Folding) else shape).voxels


def _s_curve(bend_radius: float) -> FloatArray:
    """Points of a line along x that turns aside towards z and back, its straight ends included."""
    turn = np.deg2rad(TURN_DEG)
    n = int(np.ceil(2 * (LEAD + bend_radius * turn) / _STEP))
    along = np.linspace(-LEAD, bend_radius * turn, n // 2 + 1)
    angle = np.maximum(along, 0) / bend_radius
    first = bend_radius * np.stack([np.sin(angle), 0 * angle, 1 - np.cos(angle)], axis=1)
    first[:, 0] += np.minimum(along, 0)
    first -= first[0]
    second = 2 * first[-1] - first[-2::-1]  # turned by half a turn about the middle
    line: FloatArray = np.concatenate([first, second])
    return line


def _wall_round(line: FloatArray, radius: float, shapes: list[IntArray]) -> Obstacles:
    """A wall with a tube in it, wide enough that no way leads round it between the shapes."""
    reach = max(int(np.ptp(path, axis=0).max()) for path in shapes) // 2 + MARGIN + 2
    mouths = np.rint(line[[0, -1]]).astype(np.int32)
    reach = max(reach, int(radius) + 2)
    low, high = mouths[0] - (0, reach, reach), mouths[1] + (0, reach, reach)
    shape = tuple((high - low + 1).tolist())
    centre = np.moveaxis(np.indices(shape), 0, -1).reshape(-1, 3) + low
    _, nearest = cKDTree(line).query(centre)
    farthest_corner = np.linalg.norm(np.abs(centre - line[nearest]) + 0.5, axis=1)
    return Obstacles((farthest_corner > radius).reshape(shape), low)


def _placed(path: IntArray, at: IntArray, face: int) -> IntArray:
    """The path with one face of its box across x (0 the lower, -1 the upper) about a voxel."""
    low, high = path.min(axis=0), path.max(axis=0)
    anchor = (low + high) // 2
    anchor[0] = (low, high)[face][0]
    placed: IntArray = path + (at - anchor)
    return placed


def _in_capsule(
    axis: FloatArray, radius: float, low: IntArray, shape: tuple[int, ...]
) -> BoolArray:
    """The unit voxels of a grid that lie wholly in a capsule about an axis along z.

    A capsule is convex, so those whose corners do.
    """
    centre = np.moveaxis(np.indices(shape), 0, -1) + low
    across = np.abs(centre[..., :2] - axis[0, :2]) + 0.5
    along = np.abs(centre[..., 2] - axis[:, 2].mean()) + 0.5 - np.ptp(axis[:, 2]) / 2
    inside: BoolArray = (across**2).sum(axis=-1) + np.maximum(along, 0) ** 2 <= radius**2
    return inside


def _judged(motion: Motion, around: Obstacles, line: FloatArray, radius: float) -> Scenario:
    certificate = certify(motion, motion.diameter, motion.max_bend_deg, obstacles=around)
    return Scenario(motion, around, certificate, line, radius)
