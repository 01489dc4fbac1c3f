# ---
# jupyter:
#   jupytext:
#     formats: ipynb,py:percent
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Long planar paths (Section 4.1)
#
# One node is one flat piece of a layer. How can a path enter it at a given voxel, leave it at
# another, and pass nearly all the others on its way?

# %%
import numpy as np

import lineup as lu
from lineup import draw, planar, worked
from lineup.assumptions import anatomy

# %%
# %matplotlib inline
# %config InlineBackend.figure_formats = ["jpeg"]
# %config InlineBackend.print_figure_kwargs = {"dpi": 80, "pil_kwargs": {"quality": 88}}

# %% [markdown]
# ## Kinds of voxels (Figure 5)
#
# From here on a node is a *region* Ω, seen from above. A *boundary* voxel misses at least one of
# the eight voxels around it; the others are the *interior*. A boundary voxel with one neighbour
# only is *dangling*: a path that goes in there does not come out again.

# %%
region = worked.leaf()
parts = anatomy(region)
n = int(region.sum())
assert [tuple(cell) for cell in parts.removed.tolist()] == [(0, 4), (1, 4), (2, 4)]
assert len(parts.boundary) + int(parts.interior.sum()) + len(parts.removed) == n
assert parts.reasons == ()
print(f"{len(parts.boundary)} boundary, {int(parts.interior.sum())} interior, 3 dangling")

# %% [markdown]
# The stem goes voxel by voxel: once the outermost is removed, the next one dangles.

# %% [markdown]
# ## Algorithm 2 (Figure 7)
#
# Remove what dangles. March once round the boundary: that is a cycle. In the interior, find a
# long path between the two given ends (the stars), by an algorithm of Zhang and Liu. Merge the two.

# %%
start, end = (6, 3), (9, 3)
path = planar.paper_path(region, start, end)
assert path.reasons == ()
assert tuple(path.cells[0]) == start and tuple(path.cells[-1]) == end
steps = np.abs(np.diff(path.cells, axis=0)).sum(axis=1)
assert (steps == 1).all() and len(np.unique(path.cells, axis=0)) == len(path)
assert {tuple(c) for c in path.boundary.tolist()} <= {tuple(c) for c in path.cells.tolist()}
draw.planar_steps(region, path)

# %% [markdown]
# It is simple (no voxel twice), every step goes to a neighbour, it has both ends, and it passes
# the whole boundary, so that the outline of the layer is kept.

# %% [markdown]
# ## How a cycle and a path become one (Figure 6)
#
# Somewhere a link of the cycle runs beside a link of the path: they face each other across a unit
# square. Take both out, put the other two sides of the square in, and there is one path. Two
# cycles are *mergeable* in the same way. Nothing is lost.

# %%
assert len(path) == len(path.boundary) + len(path.interior)
draw.merge(path)

# %% [markdown]
# ## How long is it? (Lemma 4.1)
#
# Lemma 4.1 promises at least 5n/6 + 2 voxels, for a region of n. Here the promise is kept, with
# all voxels but the stem.

# %%
n_kept = n - len(path.removed)
assert len(path) >= 5 * n_kept / 6 + 2
print(f"{len(path)} voxels, promised {5 * n_kept / 6 + 2:.1f}, there are {n_kept}")

# %% [markdown]
# ## The promise broken
#
# Put the two ends side by side into the middle of a plate four wide. All that the paper asks for
# holds, and Zhang and Liu's own cycle has the whole interior; but a *path* between these ends can
# turn to one side only, and misses half the interior. Notebook 6 says more.

# %%
plate = np.ones((22, 4), bool)
short = planar.paper_path(plate, (10, 1), (10, 2))
assert short.reasons == ()
assert len(short.cycle) == 40
assert len(short) < 5 * plate.size / 6 + 2
print(f"{len(short)} voxels, promised {5 * plate.size / 6 + 2:.1f}")
draw.planar_steps(plate, short)

# %% [markdown]
# ## When Algorithm 2 cannot run
#
# A layer two voxels wide has no interior, and there are many of those in ears, legs and tails.
# The reason is part of the result.

# %%
thin = np.ones((7, 2), bool)
none = planar.paper_path(thin, (0, 0), (0, 1))
assert len(none) == 0 and none.reasons == ("no-interior",)
print(planar.paper.REASONS["no-interior"])

# %% [markdown]
# ## Ours, and the longest there is
#
# `planar_path` has two more methods. `long` searches: it starts with a short path and improves it
# by small changes. `exact` proves that no path is longer, with a solver for such puzzles, CP-SAT.
# On thin and on plain regions alike:

# %%
ways = {name: lu.planar_path(plate, (10, 1), (10, 2), name) for name in lu.PLANAR_METHODS}
lengths = {name: len(way) for name, way in ways.items()}
assert lengths["paper"] < lengths["long"] == lengths["exact"] == ways["exact"].bound
assert len(lu.planar_path(thin, (0, 0), (0, 1))) == thin.size
print(lengths)

# %% [markdown]
# ## Where this differs from the paper
#
# - Dangling voxels are voxels of the solid: we count them in every coverage, and only the method
#   `paper` removes them.
# - The paper does not say where to merge, nor how Zhang and Liu's cycle becomes a path between
#   given ends; `lineup/planar/paper.py` and `zhang_liu.py` say what we do.
# - Holes: boundary voxels are those of the outermost boundary (the paper's footnote 2).
#
# Next: `04_merging` links the paths of neighbouring layers.
