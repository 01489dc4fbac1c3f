"""A long cycle in a regular grid graph by merging the cycles of a 2-factor (Zhang and Liu 2011).

"Approximating the longest paths in grid graphs", Theoretical Computer Science 412: the algorithm
that Section 4.1 applies to the interior of a layer. F starts as the boundaries of the outer face
and of the holes and a square-free 2-factor of the rest. Cycles of F are merged over *cross
cells*, unit squares that touch two of them: type I, II, III or IV with one link of F on its
sides, two adjacent ones, two opposite ones, or none. Every step toggles the sides of a cell, or
of two cells side by side, as links:

=============  ===================================================================
operation I    a cell of type III; nothing is lost
operation II   two adjacent cells of type II, one corner of each of two cycles: the
               corners are freed, the cycles joined
operation III  two cells with one free node on their rim: it is taken, a corner is
               freed instead, two cycles are joined
EXTEND         a cell of type I whose other two nodes are free: both are taken
=============  ===================================================================

What public text leaves open is chosen here: *regular* is read as boundaries that are disjoint
simple cycles; operation III is any exchange of one free node as above; an operation always
involves a leaf of the nesting tree of cycles, and leaves are tried in the order of their cells.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Collection, Iterator
from itertools import pairwise

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array

from .._record import record
from ..grid import BoolArray, IntArray
from .faces import Cell, beside, connected_cells, face_walks, is_cycle

NOT_REGULAR = "interior-not-regular"
NO_2_FACTOR = "no-2-factor"
MERGING_STUCK = "merging-stuck"
END_OFF_CYCLE = "end-off-cycle"

REASONS: dict[str, str] = {
    NOT_REGULAR: "boundaries of the interior's outer face and holes are not disjoint cycles",
    NO_2_FACTOR: "the interior without its boundaries has no square-free 2-factor",
    MERGING_STUCK: "no operation merges the cycles that are left",
    END_OFF_CYCLE: "an end is neither on the interior cycle nor beside it",
}

INFEASIBLE = 2
"""What `scipy.optimize.milp` reports when there is no solution."""

Loop = list[Cell]

I_PATTERNS = frozenset({(1, 0, 1, 0), (0, 1, 0, 1)})
"""Links on the sides of one cell."""

# Sides 0 to 5 of two cells side by side; nodes 1 and 4 are the ends of the side they share.
II_PATTERNS = frozenset({(0, 1, 1, 0, 1, 1), (1, 0, 1, 1, 0, 1)})
III_PATTERNS = frozenset(
    tuple(np.roll(sides, k).tolist())
    for sides in ((1, 1, 0, 1, 0, 0), (1, 1, 0, 0, 1, 0))
    for k in range(6)
)


@record
class LongCycle:
    """A long cycle of a planar region, and the hypotheses the region breaks.

    Attributes
    ----------
    cells : (C, 2) int32
        (x, y) in order, the last beside the first; empty if the region is rejected.
    n_cycles : int
        Cycles of F before merging; 0 if the region is rejected.
    reasons : tuple of str
        Keys of `REASONS`; none if the region meets the hypotheses and all cycles were merged.
    """

    cells: IntArray
    n_cycles: int
    reasons: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.cells)


def zhang_liu_cycle(mask: BoolArray) -> LongCycle:
    """A long cycle in a 4-connected region, (X, Y) bool, by merging the cycles of a 2-factor.

    On a region of n cells that meets the hypotheses it has 5n/6 + 2 cells at least, unless F is
    one cycle of fewer than 12 cells.

    Raises
    ------
    ValueError
        If the mask is not one 4-connected region.

    Examples
    --------
    >>> import numpy as np
    >>> from lineup.planar import zhang_liu_cycle
    >>> cycle = zhang_liu_cycle(np.ones((5, 8), bool))
    >>> len(cycle), cycle.reasons
    (40, ())
    """
    cycle, n_cycles, reasons = _long_cycle(connected_cells(mask))
    return LongCycle(np.array(cycle, np.int32).reshape(-1, 2), n_cycles, tuple(reasons))


def interior_path(
    cells: set[Cell], start: Cell, end: Cell
) -> tuple[list[Cell], list[Cell], list[str]]:
    """A long path between two cells of a connected region, the cycle it is from, reason codes.

    Zhang and Liu's ends are not free, and the paper does not say how it gets them where it wants
    them. Here the path follows their cycle one way round and EXTEND takes what it can of the
    rest; the better of both ways counts. Where there is no such cycle, a shortest path takes
    the place of that way.
    """
    cycle, _, reasons = _long_cycle(cells)
    ways = _ways_round(cycle, start, end)
    if cycle and not ways:
        reasons.append(END_OFF_CYCLE)
    extended = [_extended(cells, way) for way in ways or [_shortest(cells, start, end)]]
    return max(extended, key=len), cycle, reasons


def _extended(cells: set[Cell], path: list[Cell]) -> list[Cell]:
    """A path with all detours over two free cells taken that EXTEND finds."""
    links: Links = {cell: set() for cell in cells}
    for a, b in pairwise(path):
        links[a].add(b)
        links[b].add(a)
    _extend(links, path)
    return _unrolled(links, path[0])


Links = dict[Cell, set[Cell]]
"""For each cell of a region the cells it is linked to: two, one at the ends of a path, or none."""


def _long_cycle(cells: set[Cell]) -> tuple[list[Cell], int, list[str]]:
    """The cycle, the number of cycles merged into it, and reason codes."""
    boundaries = face_walks(cells)
    on_boundary = {cell for walk in boundaries for cell in walk}
    if not all(map(is_cycle, boundaries)) or len(on_boundary) < sum(map(len, boundaries)):
        return [], 0, [NOT_REGULAR]
    links = square_free_factor(cells - on_boundary)
    if links is None:
        return [], 0, [NO_2_FACTOR]
    for walk in boundaries:
        for before, cell, after in zip([walk[-1], *walk], walk, [*walk[1:], walk[0]], strict=False):
            links[cell] = {before, after}
    nest = Nest(links)
    n_cycles = len(nest.members)
    while nest.merge_a_leaf():
        pass
    longest = max(nest.members.values(), key=len)
    cycle = _unrolled({c: links[c] & longest for c in longest}, min(longest))
    return cycle, n_cycles, [MERGING_STUCK] if len(nest.members) > 1 else []


def square_free_factor(cells: set[Cell]) -> Links | None:
    """Links of disjoint cycles through all cells, none of four cells; None if there are none.

    A 0-1 program: degree two at each cell, three sides at most of each unit square. Its linear
    relaxation has the optimum of the program in bipartite graphs (Frank 2003), so branching is
    seldom needed.
    """
    order = sorted(cells)
    edges = [(c, n) for c in order for n in beside(c) if c < n and n in cells]
    links: Links = {cell: set() for cell in order}
    if not order:
        return links
    number = {edge: k for k, edge in enumerate(edges)}
    rows = [[number[(min(c, n), max(c, n))] for n in beside(c) if n in cells] for c in order]
    if min(map(len, rows)) < 2:
        return None
    squares = [
        [number[(min(side), max(side))] for side in _sides(_square(cell))]
        for cell in order
        if cells.issuperset(_square(cell))
    ]
    upper = np.repeat([2, 3], [len(rows), len(squares)])
    lower = np.repeat([2, 0], [len(rows), len(squares)])
    rows += squares
    matrix = csr_array(
        (np.ones(sum(map(len, rows))), np.concatenate(rows), np.cumsum([0, *map(len, rows)])),
        shape=(len(rows), len(edges)),
    )
    found = milp(
        np.zeros(len(edges)),
        integrality=np.ones(len(edges), np.int32),
        bounds=Bounds(0, 1),
        constraints=LinearConstraint(matrix, lower, upper),
    )
    if found.status == INFEASIBLE:
        return None
    for k in np.flatnonzero(np.asarray(found.x) > 0.5):
        a, b = edges[k]
        links[a].add(b)
        links[b].add(a)
    return links


class Nest:
    """Disjoint cycles of a region, and which of them has which around it.

    No cell lies inside a unit square or two, so no operation changes what a cycle surrounds
    but by the cycle it merges with. Merged with the cycle around it or with one beside it, a
    cycle that surrounds none just leaves the tree.
    """

    def __init__(self, links: Links) -> None:
        self.links = links
        self.home: dict[Cell, int] = {}
        self.members: dict[int, set[Cell]] = {}
        for first in sorted(links):
            if links[first] and first not in self.home:
                number = len(self.members)
                self.members[number] = set(_unrolled(links, first))
                self.home.update(dict.fromkeys(self.members[number], number))
        self.around = self._around()

    def _around(self) -> dict[int, int]:
        """For each cycle but the outermost the one next around it, by a sweep along each row.

        Half a step to the right of each cell no cell is met, only links that cross that line.
        """
        rows = defaultdict(list)
        for cell in sorted(self.home):
            rows[cell[1]].append(cell)
        around: dict[int, int] = {}
        for row in rows.values():
            inside: list[int] = []
            for cell in row:
                number = self.home[cell]
                if (cell[0], cell[1] + 1) in self.links[cell]:
                    if inside and inside[-1] == number:
                        inside.pop()
                    else:
                        inside.append(number)
                others = [other for other in inside[-2:] if other != number]
                if others:
                    around[number] = others[-1]
        return around

    def merge_a_leaf(self) -> bool:
        """Merge one leaf of the tree by the first of operations I, II, III that does."""
        leaves = sorted(self.around.keys() - set(self.around.values()))
        operations = (_squares, I_PATTERNS), (_dominoes, II_PATTERNS), (_dominoes, III_PATTERNS)
        for loops, patterns in operations:
            for leaf in leaves:
                for loop in loops(sorted(self.members[leaf]), self.links):
                    if self._merges(loop, patterns):
                        self._merge(leaf, loop)
                        return True
        return False

    def _merges(self, loop: Loop, patterns: frozenset[tuple[int, ...]]) -> bool:
        """Whether toggling a loop of one of some patterns joins two cycles."""
        pattern = _pattern(self.links, loop)
        if pattern not in patterns:
            return False
        met = {self.home[cell] for k, cell in enumerate(loop) if pattern[k] or pattern[k - 1]}
        lacking = [c for k, c in enumerate(loop) if not (pattern[k] or pattern[k - 1])]
        return len(met) == 2 and not any(self.links[cell] for cell in lacking)

    def _merge(self, leaf: int, loop: Loop) -> None:
        """Toggle a loop that joins `leaf` to another cycle, and extend."""
        other = next(self.home[c] for c in loop if self.links[c] and self.home[c] != leaf)
        self.home.update(dict.fromkeys(self.members[leaf], other))
        self.members[other] |= self.members.pop(leaf)
        del self.around[leaf]
        _toggle(self.links, loop)
        for cell in loop:
            if self.links[cell]:
                self.home[cell] = other
                self.members[other].add(cell)
            else:
                self.members[other].discard(cell)
        for cell, host in _extend(self.links, loop):
            self.home[cell] = self.home[host]
            self.members[self.home[host]].add(cell)


def _sides(loop: Loop) -> Iterator[tuple[Cell, Cell]]:
    return zip(loop, [*loop[1:], loop[0]], strict=True)


def _pattern(links: Links, loop: Loop) -> tuple[int, ...]:
    """1 for each side of a loop that is a link, 0 for the others."""
    return tuple(int(b in links[a]) for a, b in _sides(loop))


def _toggle(links: Links, loop: Loop) -> None:
    """Swap which sides of a loop are links."""
    for a, b in _sides(loop):
        links[a] ^= {b}
        links[b] ^= {a}


def _extend(links: Links, near: list[Cell]) -> list[tuple[Cell, Cell]]:
    """EXTEND round the cells of `near` and round what comes of it.

    Rows (cell taken, cell of the cycle or path that took it), in order.
    """
    taken, todo = [], sorted(near)
    while todo:
        for loop in _squares([todo.pop()], links):
            pattern = _pattern(links, loop)
            if sum(pattern) != 1:
                continue
            k = pattern.index(1)
            free = [loop[(k + 2) % 4], loop[(k + 3) % 4]]
            if not any(links[cell] for cell in free):
                _toggle(links, loop)
                taken += [(cell, loop[k]) for cell in free]
                todo += loop
    return taken


def _square(corner: Cell) -> Loop:
    """The unit square with its lowest corner at a cell."""
    x, y = corner
    return [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)]


def _squares(near: list[Cell], cells: Collection[Cell]) -> Iterator[Loop]:
    """The unit squares with a corner in `near` and all corners in `cells`."""
    for x, y in near:
        for corner in ((x - 1, y - 1), (x - 1, y), (x, y - 1), (x, y)):
            loop = _square(corner)
            if all(cell in cells for cell in loop):
                yield loop


def _dominoes(near: list[Cell], cells: Collection[Cell]) -> Iterator[Loop]:
    """The two squares side by side, as loops, on a rim through `near` and within `cells`."""
    for x, y in near:
        for i in range(3):
            for j in range(2):
                for swap in (False, True):
                    a, b = (x - j, y - i) if swap else (x - i, y - j)
                    loop = [(a, b), (a + 1, b), (a + 2, b), (a + 2, b + 1), (a + 1, b + 1)]
                    loop.append((a, b + 1))
                    if swap:
                        loop = [(a + q - b, b + p - a) for p, q in loop]
                    if all(cell in cells for cell in loop):
                        yield loop


def _ways_round(cycle: list[Cell], start: Cell, end: Cell) -> list[list[Cell]]:
    """The paths from start to end that follow a cycle; each end is on it or beside it."""
    place = {cell: k for k, cell in enumerate(cycle)}
    n = len(cycle)
    ways = []
    for a in _landings(place, start):
        for b in _landings(place, end):
            for step in (1, -1):
                between = [cycle[(place[a] + step * k) % n] for k in range(n)]
                way = between[: between.index(b) + 1]
                ways.append([*[start][: start != a], *way, *[end][: end != b]])
    return ways


def _landings(place: dict[Cell, int], end: Cell) -> list[Cell]:
    """Cells of the cycle where a path from an end can begin to follow it."""
    return [end] if end in place else [cell for cell in beside(end) if cell in place]


def _shortest(cells: set[Cell], start: Cell, end: Cell) -> list[Cell]:
    """A shortest path between two cells of a connected region."""
    back, todo = {end: end}, deque([end])
    while start not in back:
        cell = todo.popleft()
        for other in beside(cell):
            if other in cells and other not in back:
                back[other] = cell
                todo.append(other)
    path = [start]
    while path[-1] != end:
        path.append(back[path[-1]])
    return path


def _unrolled(links: Links, first: Cell) -> list[Cell]:
    """The cells of the path that begins at `first`, or of the cycle through it, in order."""
    path, ahead = [first], links[first]
    while ahead and (cell := min(ahead)) != first:
        ahead = links[cell] - {path[-1]}
        path.append(cell)
    return path
