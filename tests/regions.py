"""Random planar regions for tests, as masks (X, Y)."""

import networkx as nx
import numpy as np
from hypothesis import assume
from hypothesis import strategies as st
from scipy import ndimage

SIDES = ((1, 0), (0, 1), (-1, 0), (0, -1))


def grown(rng, n_cells):
    """A region grown cell by cell, of random compactness from scattered to nearly convex."""
    pull = 6 * rng.random()
    cells = {(0, 0)}
    while len(cells) < n_cells:
        rim = sorted({(x + dx, y + dy) for x, y in cells for dx, dy in SIDES} - cells)
        near = [sum((x + dx, y + dy) in cells for dx, dy in SIDES) for x, y in rim]
        weight = np.array(near, float) ** pull
        cells.add(rim[rng.choice(len(rim), p=weight / weight.sum())])
    points = np.array(sorted(cells))
    points -= points.min(axis=0)
    mask = np.zeros(points.max(axis=0) + 1, bool)
    mask[tuple(points.T)] = True
    return mask


def smooth(rng, side=24):
    """A large part of thresholded noise, two cells wide everywhere, with holes now and then."""
    noise = ndimage.gaussian_filter(rng.random((side, side)), rng.uniform(0.8, 2.5))
    mask = ndimage.binary_opening(
        noise > np.quantile(noise, rng.uniform(0.2, 0.6)), np.ones((2, 2))
    )
    if rng.random() < 0.5:
        mask = np.kron(mask[::2, ::2], np.ones((2, 2), bool))
    label, _ = ndimage.label(mask)
    return label == np.argmax(np.bincount(label.ravel())[1:]) + 1


def comb(n_teeth, length):
    """A spine and teeth, all three cells wide, with gaps of one cell: its interior is a tree."""
    mask = np.zeros((4 * n_teeth - 1, 3 + length), bool)
    mask[:, :3] = True
    for k in range(n_teeth):
        mask[4 * k : 4 * k + 3] = True
    return mask


@st.composite
def grown_regions(draw, max_cells=40):
    """`grown`, from hypothesis."""
    return grown(np.random.default_rng(draw(seeds)), draw(st.integers(2, max_cells)))


@st.composite
def smooth_regions(draw):
    """`smooth`, from hypothesis."""
    return smooth(np.random.default_rng(draw(seeds)), draw(st.integers(10, 24)))


seeds = st.integers(0, 2**32)


def cells_of(mask):
    """Cells (x, y) of a mask as tuples, in order."""
    return list(map(tuple, np.argwhere(mask).tolist()))


def draw_ends(data, mask):
    """Two different cells of a mask."""
    cells = cells_of(mask)
    assume(len(cells) > 1)
    return data.draw(st.lists(st.sampled_from(cells), min_size=2, max_size=2, unique=True))


def graph_of(mask):
    """The cells of a mask, with edges between 4-neighbours."""
    graph = nx.grid_2d_graph(*mask.shape)
    return graph.subgraph(cells_of(mask))
