"""From one shape of the chain to another (Sections 6 and 7): shape A, straight line, shape B."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain, islice

import numpy as np

from .._record import of_kind
from ..folding.pulling import is_pulled
from ..grid import IntArray, bar_directions
from ..judging import certify
from ..solid import Folding, Motion
from .gliding import NO_WAY, beside, glide
from .reversal import TURNS, joined, reversal, turned, turned_code, words
from .stowing import one_ended_plans, passed_on, stowed

DONE = "reaches its goal"
SHORTEST_STRAND = 4
PLACES = 100  # of B beside A that are tried, those of the smallest boxes
MISSES = 3  # candidates that do not fit before the search gives up; longer strands take more room


def transform(
    a: Motion | Folding,
    b: Motion | Folding,
    *,
    within: tuple[int, int, int] | None = None,
    seed: int = 0,
) -> Motion:
    """One motion of the chain from shape A to shape B (Section 6, Figure 1).

    A unfolds into the straight line, and B's unfolding is played backwards from there; B's half
    is turned so that the lines agree.

    Parameters
    ----------
    a, b : Motion or Folding
        Two unfolding motions of one chain.
    within : (X, Y, Z), optional
        Keep all blocks inside a box of this many pitches. The straight line is then not made:
        what has been let go is folded away at its far end, into layers like a folded napkin,
        with a straight strand between them and what is left of the shape. This takes motions
        of peels and swings that let go at one end of the chain (``lu.fold(..., ends=1)``), or
        paths for which such a motion is found. If both motions are pulls, B is placed beside A
        and the chain glides out of the one into the other along its own track.
    seed : int
        For the search of such motions.

    Returns
    -------
    Motion
        From ``a.start`` to its `goal`, the start of B as it is given. Where there is none, a
        motion without moves whose `reason` says why. Only `certify` says that it is free of
        collisions; with `within`, what is returned was judged so at its diameter and bend, and
        to fit.

    Raises
    ------
    ValueError
        If the two chains differ in length, or the box is not of three positive numbers.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> a, b = (lu.VoxelSolid(np.ones(shape, bool)) for shape in ((2, 2, 2), (4, 2, 1)))
    >>> motion = lu.transform(lu.fold(a), lu.fold(b))
    >>> motion.reason, lu.certify(motion).reason
    ('reaches its goal', 'certified')
    """
    a, b = _motion(a), _motion(b)
    if len(a.start) != len(b.start):
        raise ValueError(
            f"the chains have {len(a.start)} and {len(b.start)} joints; trim them to one length"
        )
    if within is not None and not (len(within) == 3 and min(within) > 0):
        raise ValueError(f"within must be three positive numbers of pitches, got {within}")
    bent = [name for name, motion in (("A", a), ("B", b)) if not motion.straight]
    if bent:
        return _refused(a, b, f"the motion of {' and '.join(bent)} does not end straight")
    through_line = replace(joined(a, _aligned(a, reversal(b)), DONE), goal=b.start)
    if within is None:
        return through_line
    misses = []
    both_pulled = is_pulled(a) and is_pulled(b)
    compact = _glides(a, b, within) if both_pulled else _compact(a, b, max(within), seed)
    for motion in chain([through_line], compact):
        certificate = certify(motion, motion.diameter, motion.max_bend_deg)
        if not certificate.ok:
            continue
        for turn in TURNS:
            if (np.abs(turn) @ certificate.extent <= within).all():
                return replace(turned(motion, turn), goal=b.start)
        misses.append(certificate.extent)
        if len(misses) > MISSES:
            break
    return _refused(a, b, _no_glide(a, b, within) if both_pulled else _why_not(misses, within))


def _why_not(misses: list[tuple[float, float, float]], within: tuple[int, int, int]) -> str:
    if len(misses) < 2:  # the way through the line is the first
        return "no motion of either shape was found that lets go at one end alone"
    sizes = " x ".join(f"{size:.1f}" for size in min(misses, key=max))
    return f"the smallest box found is {sizes} pitches, and {within} does not hold it"


def _motion(item: Motion | Folding) -> Motion:
    of_kind(item, Motion, Folding)
    return item.motion if isinstance(item, Folding) else item


def _refused(a: Motion, b: Motion, reason: str) -> Motion:
    none = np.empty((0, 4), np.int32)
    diameter, bend = min(a.diameter, b.diameter), max(a.max_bend_deg, b.max_bend_deg)
    return Motion(a.start, none, diameter, bend, False, reason, goal=b.start)


def _aligned(a: Motion, b: Motion) -> Motion:
    """`b`, turned so that it begins in the last pose of `a`."""
    *_, last = words(a)
    first = bar_directions(b.start)
    turn = next(t for t in TURNS if np.array_equal(turned_code(t)[first], last))
    return turned(b, turn)


def _compact(a: Motion, b: Motion, longest: int, seed: int) -> Iterator[Motion]:
    """Motions that fold away what A lets go and make B of it, those of short strands first."""
    plans = [one_ended_plans(motion, seed) for motion in (a, b)]
    if not all(plans):
        return
    for strand in _strands(longest):
        first, second = (
            _stowed_by(motion, of_one, strand) for motion, of_one in zip((a, b), plans, strict=True)
        )
        if first is None or second is None:
            continue
        half, end = first
        if end != second[1]:
            half = joined(half, passed_on(half.goal, end, strand), "")
        yield joined(half, _aligned(half, reversal(second[0])), DONE)


def _glides(a: Motion, b: Motion, within: tuple[int, int, int]) -> Iterator[Motion]:
    """Motions that glide out of A into B beside it, those in small boxes and without Us first."""
    places = islice(beside(a.start, b.start, within), PLACES)
    found = (glide(a.start, place) for place, _ in places)
    made = [motion for motion in found if len(motion)]
    yield from sorted(made, key=lambda motion: -motion.diameter)


def _no_glide(a: Motion, b: Motion, within: tuple[int, int, int]) -> str:
    if next(beside(a.start, b.start, within), None) is None:
        _, sides = next(beside(a.start, b.start, (np.inf,) * 3))
        size = " x ".join(str(side) for side in np.sort(sides)[::-1])
        return f"side by side the shapes take {size} pitches, and {within} does not hold them"
    return f"{NO_WAY} inside {within}"


def _strands(longest: int) -> Iterator[int]:
    strand = SHORTEST_STRAND
    while strand < longest:
        yield strand
        strand = max(strand + 1, round(1.15 * strand))


def _stowed_by(
    motion: Motion, plans: list[tuple[int, IntArray]], strand: int
) -> tuple[Motion, int] | None:
    """The first of the plans that the judge accepts with this strand, and the end it is for."""
    for end, states in plans:
        away = stowed(motion.start, end, states, strand)
        if certify(away, away.diameter, away.max_bend_deg).ok:
            return away, end
    return None
