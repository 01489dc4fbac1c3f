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
# # Overview: from a mesh to a line
#
# Can a bunny be one long chain of small blocks, and can that chain be pulled straight without
# two blocks ever colliding? This notebook goes once through the whole method, Figure 3 of the
# paper, on one model.

# %%
import os

import numpy as np

import lineup as lu
from lineup import draw

# %%
# %matplotlib inline
# %config InlineBackend.figure_formats = ["jpeg"]
# %config InlineBackend.print_figure_kwargs = {"dpi": 80, "pil_kwargs": {"quality": 88}}

# %% [markdown]
# ## A mesh becomes voxels (Section 3)
#
# The mesh is filled with equal cubes, about as many as we ask for. Nothing floats and nothing is
# hollow, so that one chain can hope to reach every voxel.

# %%
wanted = 300 if os.environ.get("LINEUP_QUICK") else 1500
solid = lu.model("bunny", voxels=wanted)
assert abs(solid.size - wanted) <= 0.02 * wanted
print(f"{solid.size} voxels, from the {solid.source['kind']} model")
draw.solid(solid)

# %% [markdown]
# ## Layers become a graph (Section 4)
#
# Every connected piece of a layer is a node; pieces that touch from one layer to the next are
# joined. A walk through all nodes, here from the tip of one ear down to the feet, says in which
# order the chain visits the layers. Its trunk is the MSP; each detour that comes back is an MSC.

# %%
graph = lu.reeb_graph(solid)
walk = lu.traverse(graph)
assert set(walk.walk) == set(range(len(graph)))
draw.reeb(graph, walk)

# %% [markdown]
# ## A path in every layer, linked into one (Sections 4.1 to 4.3)
#
# Seen from above, the path winds through a layer and leaves it where a neighbour above or below
# takes it on. It never visits a voxel twice, and its length is even, for a block is two voxels.

# %%
path = lu.layered_path(solid)
bound = lu.path_bound(solid)
assert lu.certify_path(path, solid).ok
assert len(path) % 2 == 0 and len(path) <= bound
print(f"{len(path)} of {solid.size} voxels, {path.coverage(solid):.1%}; no path has over {bound}")
draw.layers(path, solid)

# %% [markdown]
# ## A path that can be unfolded (Section 6)
#
# A long path is not enough, for blocks may get in each other's way when it is pulled straight.
# `fold` changes path and motion together, so that a way to unfold exists all the time. Small
# grey cubes are the voxels it leaves out.

# %%
folding = lu.fold(solid)
assert lu.certify_path(folding.path, solid).ok
assert len(folding.path) % 2 == 0 and folding.path.coverage(solid) >= 0.85
print(f"{len(folding.path)} of {solid.size} voxels, {folding.path.coverage(solid):.1%}")
draw.chain(folding, solid)

# %% [markdown]
# Blue is the first block of the chain and red is the last. Fat pieces are blocks, thin ones the
# hinges between them.

# %% [markdown]
# ## The chain unfolds
#
# A judge that shares no code with the planner follows every block through every move, in between
# too. Bars of .999 voxels do not meet, and no joint bends by more than 90 degrees.

# %%
verdict = lu.certify(folding.motion, diameter=0.999, max_bend_deg=90)
assert verdict.ok and verdict.moves_checked == len(folding.motion)
print(f"{len(folding.motion)} moves: {verdict.reason}, clearance {verdict.clearance:.3f}")
draw.unfolding(folding)

# %% [markdown]
# ## It ends as a line
#
# All bars point the same way in the last pose, and any other solid whose chain is as long ends as
# the same line. Played backwards, its unfolding turns the line into that solid: this is how a
# bunny becomes a duck.

# %%
*_, line = lu.frames(folding.motion)
extent = np.ptp(line, axis=0)
assert sorted(extent.round(9)) == [0, 0, len(folding.path) - 1]
print(f"the line is {extent.max() + 1:.0f} voxels long and one wide")

# %% [markdown]
# ## Where this differs from the paper
#
# - The path is no longer layered once `fold` has changed it; the layered path is where it starts.
# - Joints move one at a time, by 90 degrees, where the paper follows the flow of an energy.
# - 'Certified' is the word of a judge about the very motion that is stored.
# - Unless you have fetched the paper's mesh (`lineup models --fetch`), the bunny is a stand-in
#   made of smooth blobs.
#
# `PAPER.md` lists all deviations, and which notebook shows what. To do this with ten models, run
# `lineup table2`.
#
# Next: `01_voxels`, and then section by section.
