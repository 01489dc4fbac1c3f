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
# # Path trimming (Section 5)
#
# One chain forms all shapes, so all paths need one length, and they come out different. Which
# voxels can a path do without?

# %%
import os

import numpy as np

import lineup as lu
from lineup import draw, grid
from lineup.contraction import contraction_pairs

# %%
# %matplotlib inline
# %config InlineBackend.figure_formats = ["jpeg"]
# %config InlineBackend.print_figure_kwargs = {"dpi": 80, "pil_kwargs": {"quality": 88}}

# %% [markdown]
# ## Contraction pairs (Figure 11)
#
# Somewhere the path leaves a voxel, makes a detour, and comes by next door. These two neighbours
# in one layer are a *contraction pair*; its *index* is the number of voxels between them. Join the
# two directly, and the path is shorter by the index.

# %%
block = lu.VoxelSolid(np.ones((7, 6, 4), bool))
path = lu.layered_path(block)
keep = grid.surface(block.occupancy)
pairs = contraction_pairs(path, keep)
index = pairs[:, 1] - pairs[:, 0] - 1
assert (index % 2 == 0).all() and index.min() == 2
for value, count in zip(*np.unique(index, return_counts=True), strict=True):
    print(f"{count} pairs of index {value}")
draw.contraction(path)

# %% [markdown]
# Every index is even, for neighbours differ in colour (notebook 5). And the detour must consist of
# *unnecessary* voxels: none of the surface, so that the shape looks the same.

# %%
shorter = lu.trim([path], length=len(path) - 2)[0]
assert lu.certify_path(shorter, block).ok
gone = set(map(tuple, path.voxels.tolist())) - set(map(tuple, shorter.voxels.tolist()))
assert len(gone) == 2 and not any(keep[voxel] for voxel in gone)
print("gone:", sorted(gone))

# %% [markdown]
# ## Two paths, one length
#
# The paper's way: take pairs of index 2 from the longer path until both are of one length.

# %%
n = 300 if os.environ.get("LINEUP_QUICK") else 1000
bunny, duck = (lu.model(name, voxels=k) for name, k in (("bunny", n), ("duck", n + 24)))
paths = [lu.layered_path(solid) for solid in (bunny, duck)]
trimmed = lu.trim(paths, method="paper")
assert trimmed.reason == "trimmed"
assert len({len(one) for one in trimmed}) == 1
assert all(lu.certify_path(a, s).ok for a, s in zip(trimmed, (bunny, duck), strict=True))
print([len(one) for one in paths], "become", [len(one) for one in trimmed])
print(max(trimmed, key=lambda one: len(one.method)).method)

# %% [markdown]
# ## Where pairs of index 2 are too few
#
# This small path has one pair of index 2, nested in one of index 4: only one of the two can be
# carried out. To lose four voxels, *some* set of pairs must add up to four: a subset sum, found by
# dynamic programming.

# %%
tooth = [(0, 0), (1, 0), (1, 1), (1, 2), (2, 2), (2, 1), (2, 0), (3, 0)]
deep = lu.VoxelPath(np.array([(x, y, 0) for x, y in tooth]), method="typed")
found = contraction_pairs(deep, np.zeros((4, 3, 1), bool))
assert [j - i - 1 for i, j in found.tolist()] == [4, 2]
result = lu.trim([deep], length=4, method="paper", keep="none")
assert result[0].voxels[:, 0].tolist() == [0, 1, 2, 3]
print(result[0].method)
draw.contraction(deep, (1, 6))

# %% [markdown]
# ## And where no subset will do
#
# A ring has one pair, of index 6. Four voxels less cannot be had, and that is a result with a
# reason, not an error.

# %%
ring = [(1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1), (0, 0)]
round_path = lu.VoxelPath(np.array([(x, y, 0) for x, y in ring]))
none = lu.trim([round_path], length=4, method="paper", keep="none")
assert none.reason != "trimmed" and len(none[0]) == 8
print(none.reason)

# %% [markdown]
# ## "In most cases there are enough"
#
# Are there? It depends on how much must go. Without touching the surface, on five models:

# %%
names = ["bunny", "cannon", "duck", "elephant", "two_holed_torus"]
some = [lu.layered_path(lu.model(name, voxels=n)) for name in names]
shares = (0.02, 0.1, 0.3)
goals = {share: [2 * round(len(p) * (1 - share) / 2) for p in some] for share in shares}
enough = {
    share: sum(
        lu.trim([p], g, method="paper").reason == "trimmed" for p, g in zip(some, each, strict=True)
    )
    for share, each in goals.items()
}
assert enough[0.3] < enough[0.02] == len(some)
print({f"{share:.0%} less": f"{k} of {len(some)}" for share, k in enough.items()})

# %% [markdown]
# ## Always to the length
#
# Our own way, `method="exact"`, comes to any even length. Pairs of any index go first; where they
# do not do, whole excursions, blocks off the ends, and as few voxels of the surface as possible.
# Here a fifth of a duck goes; small grey cubes are what the path leaves out.

# %%
goal = 2 * round(0.4 * len(paths[1]))
fifth = lu.trim([paths[1]], goal)[0]
assert len(fifth) == goal and lu.certify_path(fifth, duck).ok
outside = grid.surface(duck.occupancy)
kept = outside[tuple(fifth.voxels.T)].sum() / outside.sum()
print(fifth.method, f"- {kept:.1%} of the surface kept")
draw.chain(fifth, duck)

# %% [markdown]
# ## Where this differs from the paper
#
# - It does not say what happens to pairs that overlap. Only disjoint ones are taken: every sequence
#   of contractions is one set of disjoint pairs of the first scan.
# - In `lu.lineup` each model gets as many voxels as its path needs to be just long enough, so that
#   little is left to trim.
#
# Next: `08_unfolding` pulls a path straight.
