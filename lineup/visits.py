"""Which planar piece each run of a path belongs to, and how the pieces nest (Section 4.2)."""

from __future__ import annotations

import numpy as np

from .grid import IntArray


def visits_of(voxels: IntArray) -> IntArray:
    """The layer visits of a path, read off its vertical steps.

    A vertical step that comes back beside the voxel where the layer was left goes on with the
    piece left there (Section 4.2, Case 2); any other vertical step begins a new piece (Case 1, or
    the way into an excursion).

    Parameters
    ----------
    voxels : (P, 3) int32
        A simple path of face-adjacent voxels.

    Returns
    -------
    (V, 4) int32
        Rows as in `VoxelPath.visits`, pieces numbered from 0 as they are met.

    Examples
    --------
    >>> import numpy as np
    >>> from lineup.visits import visits_of
    >>> arch = np.array([(0, 0, 0), (1, 0, 0), (1, 0, 1), (2, 0, 1), (2, 0, 0), (3, 0, 0)])
    >>> visits_of(arch)[:, 2:].tolist()
    [[0, 0], [1, 1], [0, 0]]
    """
    climbs = np.flatnonzero(np.diff(voxels[:, 2])) + 1
    starts, stops = np.append(0, climbs), np.append(climbs, len(voxels))
    last, first = voxels[climbs - 1].tolist(), voxels[climbs].tolist()
    open_pieces = [0]
    left: list[list[int]] = []  # where each open piece but the innermost was left
    pieces, n_pieces = [0], 1
    for old, new in zip(last, first, strict=True):
        if left and _beside(left[-1], new):
            left.pop()
            open_pieces.pop()
        else:
            left.append(old)
            open_pieces.append(n_pieces)
            n_pieces += 1
        pieces.append(open_pieces[-1])
    return np.stack([starts, stops, pieces, _depths(pieces)], axis=1).astype(np.int32)


def _beside(a: list[int], b: list[int]) -> bool:
    return a[2] == b[2] and abs(a[0] - b[0]) + abs(a[1] - b[1]) == 1


def _depths(pieces: list[int]) -> list[int]:
    """How many pieces are visited both before and after each run, in nested runs."""
    last = {piece: k for k, piece in enumerate(pieces)}
    enclosing: list[int] = []
    depths = []
    for k, piece in enumerate(pieces):
        while enclosing and (enclosing[-1] == piece or last[enclosing[-1]] < k):
            enclosing.pop()
        depths.append(len(enclosing))
        enclosing.append(piece)
    return depths
