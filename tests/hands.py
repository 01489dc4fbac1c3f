"""A hand that folds by the rows of a manual alone, and foldings for it."""

import numpy as np

import lineup as lu
from lineup import grid
from lineup.kinematics import Move

BOXES = [
    *[((5, 4, 2), 0), ((4, 4, 4), 0), ((3, 3, 5), 0), ((2, 2, 1), 0), ((5, 3, 4), 9)],
    *[((4, 4, 4), 0, "slotted"), ((3, 3, 5), 0, "slotted"), ((5, 3, 4), 9, "slotted")],
]


def folded(shape, seed, joints="free"):
    solid = lu.VoxelSolid(np.ones(shape, bool))
    return lu.fold(solid, seed=seed, rounds=60, trial_rounds=10, slot_rounds=5, joints=joints)


def named(box):
    """The name of a test's box."""
    return "-".join(["x".join(map(str, box[0])), *box[2:]])


def hand(document):
    """The motion of a hand that knows nothing but the rows, and the base, as they are on the card.

    It holds a straight line whose base is in its place, and bends one joint after the other, hinges
    in the manner that is asked for.
    """
    rows = document["rows"]
    (a, b), events = events_of(rows)
    first, second = map(np.array, document["base"])
    along = second - first
    line = first + np.outer(np.arange(2 * len(rows)) - a, along)
    loose = {"head": letter(-along), "tail": letter(along)}
    manners = {row["block"]: row["manner"] for row in rows}
    moves, last = [], dict(loose)
    for at in range(1, max(events, default=0) + 1):
        what, way = events[at]
        if isinstance(what, str):
            assert loose[what] == way[0]
            k, beyond = (a, a - 1) if what == "head" else (b, b + 1)
            moves.append((Move.SWING, k, beyond, grid.LETTERS.index(way[1])))
            loose[what] = way[1]
            continue
        end, before = ("head", a) if what < a else ("tail", b)
        assert abs(what - before) == 1
        manner = manners[what // 2 + 1] if what // 2 == before // 2 else ""
        bend = (Move.PEEL, before, what, grid.LETTERS.index(way))
        if manner == "hinge first":
            piece = moves.pop()
            assert piece[2] == before
            moves += [bend, piece]
        elif manner == "straighten":
            moves += [(*bend[:3], grid.LETTERS.index(last[end])), bend]
        elif way != loose[end]:
            moves.append(bend)
        last[end] = way
        a, b = min(a, what), max(b, what)
    return lu.Motion(line, np.array(moves, int).reshape(-1, 4), 0.999, 90.0, False, "by hand")


def events_of(rows):
    """The base, and by its number each action: (joint, bend) or (end, from and to where)."""
    base, events = [], {}
    for row in rows:
        pair = ((row["at1"], 2 * row["block"] - 2), (row["at2"], 2 * row["block"] - 1))
        base += [joint for at, joint in pair if not at]
        laid = sorted((at, joint) for at, joint in pair if at)
        events |= {at: (joint, bend) for (at, joint), bend in zip(laid, row["bends"], strict=True)}
        for text in row["swings"].split():
            at, end, ways = text.split(":")
            events[int(at)] = (end, ways)
    return sorted(base), events


def letter(step):
    """The letter of a lattice step."""
    return grid.LETTERS[grid.DIRECTIONS.tolist().index(list(step))]
