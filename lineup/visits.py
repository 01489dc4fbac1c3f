"""The layer visits of a path, once the planar piece of every step is known (Section 4.2)."""

from __future__ import annotations

import numpy as np

from .grid import IntArray


def visits_of(voxels: IntArray, pieces: IntArray) -> IntArray:
    """The runs of a path within its layers, with how the pieces nest.

    Parameters
    ----------
    voxels : (P, 3) int32
        A simple path of face-adjacent voxels.
    pieces : (P,) int32
        The planar piece of each step; it is told by the planner, for a path alone does not say
        whether it comes back to a piece or begins another one beside it.

    Returns
    -------
    (V, 4) int32
        Rows as in `VoxelPath.visits`.

    Examples
    --------
    >>> import numpy as np
    >>> from lineup.visits import visits_of
    >>> arch = np.array([(0, 0, 0), (1, 0, 0), (1, 0, 1), (2, 0, 1), (2, 0, 0), (3, 0, 0)])
    >>> visits_of(arch, np.array([4, 4, 7, 7, 4, 4])).tolist()
    [[0, 2, 4, 0], [2, 4, 7, 1], [4, 6, 4, 0]]
    """
    climbs = np.flatnonzero(np.diff(voxels[:, 2])) + 1
    starts, stops = np.append(0, climbs), np.append(climbs, len(voxels))
    runs = pieces[starts]
    return np.stack([starts, stops, runs, _depths(runs.tolist())], axis=1).astype(np.int32)


def _depths(runs: list[int]) -> list[int]:
    """How many pieces are visited both before and after each run, if the pieces nest."""
    last = {piece: k for k, piece in enumerate(runs)}
    enclosing: list[int] = []
    depths = []
    for k, piece in enumerate(runs):
        while enclosing and (enclosing[-1] == piece or last[enclosing[-1]] < k):
            enclosing.pop()
        depths.append(len(enclosing))
        enclosing.append(piece)
    return depths
