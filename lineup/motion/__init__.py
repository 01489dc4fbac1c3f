"""Unfolding a given path into a straight line (Sections 6 and 7)."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from .._options import checked
from .._record import of_kind
from ..joints import slot_violations
from ..solid import Motion, VoxelPath
from .algorithm4 import energy
from .peeling import check_efforts, peel
from .pulling import pull
from .thick import barrier
from .tilting import accordion


def unfold(path: VoxelPath, method: str = "auto", seed: int = 0, **options: Any) -> Motion:
    """A motion that unfolds `path`, as far as the method gets (Section 6).

    Parameters
    ----------
    method : str
        A key of `MOTION_METHODS`. ``"accordion"`` straightens a monotone path in one move;
        ``"peel"`` searches for an order in which the two ends let go of bar after bar, after
        limbs have moved out of the way if need be; its options are `tries`, `patience`, `rounds`
        and `joints`: ``"slotted"`` leaves out what the slots of the printed block do not let the
        chain do, ``"sparing"`` does it where nothing else helps. ``"pull"`` draws the chain out
        along its own track, for thinner bars, see `Motion.diameter` and `max_bend_deg`.
        ``"energy"`` is the paper's Algorithm 4, with options `axis` of projection and `steps`: it
        keeps no width and stops at `stationary` points or the step limit; ``"barrier"`` unfolds
        the same projection with bars of a given `diameter`, over the `axes` in turn, each for at
        most so many `steps`. ``"auto"`` peels where the accordion cannot, and pulls where peeling
        cannot if its option `thin` allows thinner bars.
    seed : int
        The same path, seed and options give the same motion.

    Returns
    -------
    Motion
        Its `straight` and `reason` tell how it ended; only `certify` says that it is free of
        collisions.

    Raises
    ------
    ValueError
        If the method or an option is unknown, or the path has less than two voxels or voxels
        in a row that are not adjacent.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> path = lu.layered_path(lu.VoxelSolid(np.ones((4, 4, 1), bool)))
    >>> lu.unfold(path).reason
    'straight: accordion, since the path is monotone'
    """
    of_kind(path, VoxelPath)
    checked(MOTION_METHODS, method, options, "motion method")
    if len(path) < 2:
        raise ValueError(f"a motion needs a path of at least two voxels, got {len(path)}")
    return MOTION_METHODS[method](path, seed, **options)


def _auto(
    path: VoxelPath,
    seed: int,
    *,
    tries: int = 4,
    patience: int = 5_000,
    rounds: int = 100,
    thin: bool = False,
    joints: str = "free",
) -> Motion:
    """The first method of accordion, peel and, if bars may be `thin`, pull that ends straight.

    Unless `joints` are free the accordion, which turns all bars at once, counts where it twists no
    capsule, and nothing is pulled.
    """
    check_efforts(tries, patience, rounds, joints)
    tilted = accordion(path, seed)
    if tilted.straight and (joints == "free" or not len(slot_violations(tilted))):
        return replace(tilted, reason="straight: accordion, since the path is monotone")
    peeled = peel(path, seed, tries=tries, patience=patience, rounds=rounds, joints=joints)
    if peeled.straight:
        why = "one tilt would twist blocks" if tilted.straight else "the path is not monotone"
        return replace(peeled, reason=f"{peeled.reason}: peel, since {why}")
    why = f"peel is {peeled.reason}"
    if thin and joints == "free":
        pulled = pull(path, seed)
        if pulled.straight:
            return replace(pulled, reason=f"straight: pull, since {why}")
        why += f"; pull: {pulled.reason}"
    return replace(peeled, reason=f"{tilted.reason}; {why}")


MOTION_METHODS: dict[str, Callable[..., Motion]] = {
    "accordion": accordion,
    "peel": peel,
    "pull": pull,
    "energy": energy,
    "barrier": barrier,
    "auto": _auto,
}
"""The planners of a motion by name: functions of a path, a seed and keyword-only options."""
