"""Slow plain twins and brute-force oracles, shared by the tests."""

import itertools

import networkx as nx
import numpy as np
from scipy import ndimage, optimize

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


def pose_clearance(pose, pairs=None):
    """Smallest distance of bars two or more apart: all pairs, or those given as two arrays."""
    k, m = np.triu_indices(len(pose) - 1, 2) if pairs is None else pairs
    return segment_distances(pose[k], pose[k + 1], pose[m], pose[m + 1]).min(initial=np.inf)


def pose_bend_deg(pose):
    """Largest bend between consecutive bars."""
    bars = np.diff(pose, axis=0)
    sines = np.linalg.norm(np.cross(bars[1:], bars[:-1]), axis=1)
    cosines = (bars[1:] * bars[:-1]).sum(axis=1)
    return float(np.degrees(np.arctan2(sines, cosines)).max(initial=0.0))


def sampled_move(motion, pose, move, samples=129, pairs=None):
    """Clearance and largest bend of one move by sampling, the lowest samples refined locally.

    The true clearance is at most the one returned, and lower only where it dips between samples.
    That of some `pairs` of bars alone, two arrays, is found in the same way.
    """
    times = np.linspace(0, 1, samples)
    poses = [kinematics.moved(pose, move, motion, t) for t in times]
    distances = np.array([pose_clearance(p, pairs) for p in poses])
    lowest = distances.min()
    for k in np.argsort(distances, kind="stable")[:3]:
        bracket = (times[max(k - 1, 0)], times[min(k + 1, samples - 1)])
        found = optimize.minimize_scalar(
            lambda t: pose_clearance(kinematics.moved(pose, move, motion, t), pairs),
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
        elif kind == Move.PULL:
            tail_bar = pose[[abs(other - 1), other]]
            rows.append((kind, other, joint, int(grid.bar_directions(tail_bar)[0])))
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


def n_us(voxels):
    """How often three edges of a lattice path in a row are sides of a unit square."""
    a, b, c, d = voxels[:-3], voxels[1:-2], voxels[2:-1], voxels[3:]
    return int((a - b + c == d).all(axis=1).sum())


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


def euler_by_cells(occupancy: np.ndarray) -> int:
    """Euler number of the solid whose voxels join through faces, cell by cell.

    Voxels are the corners of a complex that has an edge, a square or a cube wherever all its
    corners are taken.
    """
    taken = {tuple(v) for v in np.argwhere(occupancy).tolist()}
    number = 0
    for x, y, z in taken:
        for a, b, c in np.ndindex(2, 2, 2):
            block = {
                (x + i, y + j, z + k)
                for i in range(a + 1)
                for j in range(b + 1)
                for k in range(c + 1)
            }
            number += (-1) ** (a + b + c) * (block <= taken)
    return number


def voxel_graph(occupancy, in_layer=False):
    """networkx graph of the voxels of a grid, joined where they share a face (of one layer)."""
    graph = nx.Graph()
    graph.add_nodes_from(map(tuple, np.argwhere(occupancy).tolist()))
    for x, y, z in list(graph):
        others = [(x + 1, y, z), (x, y + 1, z)] + ([] if in_layer else [(x, y, z + 1)])
        graph.add_edges_from(((x, y, z), other) for other in others if other in graph)
    return graph


def simple_paths_from(graph, start):
    """Every simple path of a graph that begins at `start`, as tuples of nodes."""
    stack = [(start,)]
    while stack:
        path = stack.pop()
        yield path
        stack.extend((*path, near) for near in graph[path[-1]] if near not in path)


def longest_path(graph):
    """Number of nodes of the longest simple path, by trying them all."""
    return max(len(path) for start in graph for path in simple_paths_from(graph, start))


def heaviest_path_between(graph, start, end, weight):
    """Greatest sum of node weights of a simple path between two nodes, by trying them all."""
    ending = (path for path in simple_paths_from(graph, start) if path[-1] == end)
    return max(sum(weight[node] for node in path) for path in ending)


def two_matching(graph, colour):
    """Edges of the largest simple 2-matching of a bipartite graph, by networkx flow."""
    network = nx.DiGraph()
    for node in graph:
        if colour(node) == 0:
            network.add_edge("source", node, capacity=2)
            network.add_edges_from(((node, near) for near in graph[node]), capacity=1)
        else:
            network.add_edge(node, "sink", capacity=2)
    if not {"source", "sink"} <= set(network):
        return 0
    return nx.maximum_flow_value(network, "source", "sink")


def lattice_ray(p, d, reach):
    """Lattice points p, p + d, ... as a set of tuples; `reach` steps stand for infinity."""
    (x, y, z), (dx, dy, dz) = p, grid.DIRECTIONS[d].tolist()
    return {(x + t * dx, y + t * dy, z + t * dz) for t in range(reach + 1)}


def lattice_quadrant(p, d, f, reach):
    """Lattice points of the closed quadrant at p between directions d and f, as a set."""
    return set().union(*(lattice_ray(q, f, reach) for q in lattice_ray(p, d, reach)))


def rod_rule(voxels, old, new):
    """Which infinite-rod rule forbids this step of a peel plan; "" if none does.

    One end lets go of one joint or turns its rod by 90 degrees. A rod's whole ray holds no folded
    joint and no point of the other rod's ray; neither does the whole quadrant of a swing, nor the
    ray that the first rod of an end takes at the end of the chain.
    """
    points = [tuple(v) for v in np.asarray(voxels).tolist()]
    last, old, new = len(points) - 1, [int(x) for x in old], [int(x) for x in new]
    reach = int(np.ptp(points, axis=0).max()) + 1
    ends = [end for end in range(2) if old[end::2] != new[end::2]]
    if len(ends) != 1:
        return f"{len(ends)} ends change"
    (end,) = ends
    joint, other, d, f = old[end], old[1 - end], old[2 + end], new[2 + end]

    has_rod, other_has_rod = joint != last * end, other != last * (1 - end)
    other_rod = lattice_ray(points[other], old[3 - end], reach) if other_has_rod else set()

    def clear(region, state, k):
        folded = set(points[state[0] : state[1] + 1]) - {points[k]}
        return region.isdisjoint(folded | other_rod)

    if new[end] == joint + (1, -1)[end] and d == f and new[0] < new[1]:
        if not has_rod and not clear(lattice_ray(points[joint], d, reach), old, joint):
            return f"the first ray of end {end} is blocked"
        blocked = not clear(lattice_ray(points[new[end]], d, reach), new, new[end])
        return f"the ray after a peel of end {end} is blocked" if blocked else ""
    if new[end] == joint and d % 3 != f % 3 and has_rod:
        blocked = not clear(lattice_quadrant(points[joint], d, f, reach), old, joint)
        return f"the quadrant of a swing of end {end} is blocked" if blocked else ""
    return "neither a peel nor a swing"


def rod_fault(voxels, states):
    """What breaks the infinite-rod rules in a peel plan, step by step; "" if nothing does."""
    if states[0][0] != 0 or states[0][1] != len(voxels) - 1:
        return "the first state has let go of joints"
    for k, (old, new) in enumerate(itertools.pairwise(np.asarray(states).tolist())):
        fault = rod_rule(voxels, old, new)
        if fault:
            return f"step {k}: {fault}"
    return ""


def swept_points(voxels, states, before, reach):
    """Lattice points that the steps 0..before-1 of a plan sweep; a pivot is not swept itself.

    An end's first peel sweeps the ray of its first rod as well.
    """
    points = [tuple(v) for v in np.asarray(voxels).tolist()]
    last, states = len(points) - 1, np.asarray(states).tolist()
    swept = set()
    for end in range(2):
        for old, new in itertools.pairwise(states[: before + 1]):
            pivot, d, f = points[new[end]], old[2 + end], new[2 + end]
            if new[end] != old[end]:
                swept |= lattice_ray(pivot, f, reach) - {pivot}
                if old[end] == last * end:
                    first = points[last * end]
                    swept |= lattice_ray(first, d, reach) - {first}
            elif d != f:
                swept |= lattice_quadrant(pivot, d, f, reach) - {pivot}
    return swept


def outermost_boundary(mask):
    """Boundary voxels of a layer by definition: an 8-neighbour is missing and not in a hole."""
    box = np.ones((3, 3), bool)
    padded = np.pad(mask, 1)
    outside = ~ndimage.binary_fill_holes(padded, structure=box)
    return (ndimage.binary_dilation(outside, box) & padded)[1:-1, 1:-1]


def without_dangling(mask):
    """A layer without its dangling voxels, removed one by one, and the removed ones."""
    mask, removed = mask.copy(), []
    while True:
        boundary = outermost_boundary(mask)
        padded = np.pad(boundary, 1).astype(int)
        near = padded[2:, 1:-1] + padded[:-2, 1:-1] + padded[1:-1, 2:] + padded[1:-1, :-2]
        dangling = np.argwhere(boundary & (near < 2))
        if not len(dangling):
            return mask, removed
        mask[tuple(dangling[-1])] = False
        removed.append(dangling[-1])


def two_factors(graph):
    """All edge sets that give every node of a graph degree two, by trying all."""

    def complete(chosen, left, lacking):
        if not lacking:
            yield chosen
            return
        node = min(lacking)
        open_edges = [edge for edge in left if node in edge]
        for picked in itertools.combinations(open_edges, lacking[node]):
            rest = dict(lacking)
            for end in itertools.chain(*picked):
                rest[end] = rest.get(end, 0) - 1
            if min(rest.values()) >= 0:
                rest = {other: n for other, n in rest.items() if n}
                yield from complete([*chosen, *picked], left - set(open_edges), rest)

    edges = {tuple(sorted(edge)) for edge in graph.edges}
    yield from complete([], edges, dict.fromkeys(graph, 2))


def edges_on_squares(edges):
    """How many of these lattice edges lie on each unit square: 4 squares contain an edge.

    An edge is a frozenset of two positions; a square is its lowest corner and its normal axis.
    """
    count = {}
    for edge in edges:
        low, high = sorted(edge)
        along = next(axis for axis in range(3) if low[axis] != high[axis])
        for other in {0, 1, 2} - {along}:
            below = tuple(c - (axis == other) for axis, c in enumerate(low))
            for corner in (low, below):
                square = corner, 3 - along - other
                count[square] = count.get(square, 0) + 1
    return count


def disjoint_subsets(pairs):
    """All sets of pairs (i, j) of which each begins where the one before it ends, or later."""
    subsets = [()]
    for pair in sorted(map(tuple, pairs), key=lambda p: p[1]):
        subsets += [(*s, pair) for s in subsets if not s or s[-1][1] <= pair[0]]
    return subsets


def contraction_outcomes(voxels, keep, piece=None):
    """Every path that sequences of contractions lead to: {path: (voxels to keep lost, excursions)}.

    One contraction at a time, each found anew on the path as it is then. `piece` names the planar
    piece of each voxel of a layered path: a contraction begins and ends in one piece, and an
    excursion from it goes only if nothing of it was to be kept.
    """
    start = tuple(map(tuple, np.asarray(voxels).tolist()))
    best, todo = {start: (0, 0)}, [start]
    while todo:
        path = max(todo, key=len)
        todo.remove(path)
        for i, j in itertools.combinations(range(len(path)), 2):
            apart = np.abs(np.subtract(path[i], path[j]))
            flat = len({v[2] for v in path[i : j + 1]}) == 1
            n_kept = sum(bool(keep[v]) for v in path[i + 1 : j])
            if j < i + 2 or apart.sum() != 1:
                continue
            if piece:
                whole = start[start.index(path[i]) : start.index(path[j]) + 1]
                away = [v for v in whole if piece[v] != piece[path[i]]]
                if piece[path[i]] != piece[path[j]] or any(keep[v] for v in away):
                    continue
            lost, n_excursions = best[path]
            cost = (lost + n_kept, n_excursions + (piece is not None and not flat))
            after = path[: i + 1] + path[j:]
            if after not in best:
                todo.append(after)
            best[after] = min(cost, best.get(after, cost))
    return best


def least_losses(voxels, keep, piece=None):
    """{length: least (voxels to keep lost, voxels off the ends, excursions)}: all ways tried."""
    n, best = len(voxels), {}
    for a, b in itertools.product(range(0, n, 2), range(0, n, 2)):
        middle = voxels[a : n - b]
        if len(middle) < 2:
            continue
        off = int(keep[tuple(np.concatenate([voxels[:a], voxels[n - b :]]).T)].sum())
        for path, (lost, n_excursions) in contraction_outcomes(middle, keep, piece).items():
            cost = (off + lost, a + b, n_excursions)
            best[len(path)] = min(cost, best.get(len(path), cost))
    return best
