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
# # Feasible starting and ending voxels (Section 4.3)
#
# Planar paths can only be linked if they end in the right places. Where are these, and why does
# every path then have an even number of voxels?

# %%
import numpy as np

import lineup as lu
from lineup import draw, grid, planar, worked
from lineup.assumptions import anatomy, mask_of
from lineup.draw.ends import links_inside

# %%
# %matplotlib inline
# %config InlineBackend.figure_formats = ["jpeg"]
# %config InlineBackend.print_figure_kwargs = {"dpi": 80, "pil_kwargs": {"quality": 88}}

# %% [markdown]
# ## Two colours (Figure 10)
#
# Colour voxels like a checkerboard. Neighbours differ in colour, so a path changes colour with
# every step. A closed one comes back to the colour it began with: it has an even number of voxels.

# %%
region = worked.leaf()
start, end = (6, 3), (9, 3)
path = planar.paper_path(region, start, end)
colours = grid.colour(path.boundary)
assert (colours != np.roll(colours, 1)).all()
assert len(path.boundary) % 2 == 0
draw.checkerboard(region, path)

# %% [markdown]
# Why care? A block of the chain is two voxels, so a chain has an even number of them.

# %% [markdown]
# ## Along the MSP (Section 4.3.1)
#
# The path of node o_i must end where the path of o_(i+1) can start, right above or below. Both
# ends must be interior voxels, for Algorithm 2 needs them there. So look at the interiors of both,
# one laid over the other: I_i is what they share. Of it, take a voxel of the other colour than
# the start.

# %%
following = np.zeros_like(region)
following[3:12, 1:7] = True
both = anatomy(region).interior & anatomy(following).interior
other = [c for c in np.argwhere(both).tolist() if sum(c) % 2 != sum(start) % 2]
assert both[start] and len(other) > 0
assert all(len(planar.paper_path(region, start, tuple(c))) % 2 == 0 for c in other)
draw.overlap(region, following, start)

# %% [markdown]
# ## Theorem 4.2: every node of the MSP gets an even path
#
# The ends differ in colour, so any path between them is even. The cell above has just tried all
# ends that may be drawn in this layer; here are all nodes of an arch.

# %%
arch = worked.arch()
found = lu.algorithm3(arch)
nodes = found.nodes
assert (nodes["reasons"] == "").all()
on_msp = nodes[nodes["part"] == "MSP"]
assert len(on_msp) and (on_msp["covered"] % 2 == 0).all()
print(on_msp[["node", "layer", "voxels", "covered"]].to_string(index=False))

# %% [markdown]
# With ends of one colour the path is odd, whatever one does.

# %%
odd = planar.paper_path(region, start, (8, 3))
assert sum(start) % 2 == sum((8, 3)) % 2
assert len(odd) % 2 == 1
print(f"{len(odd)} voxels")

# %% [markdown]
# ## Into an MSC (Section 4.3.2)
#
# A node that hangs off another is entered and left over one link of the other's path. The link
# must lie over (or under) the hanging node's interior, and not touch the ends of the path. The
# arch has such a place: left the path of the bridge, then the leg, then the links to choose from.

# %%
graph = lu.reeb_graph(arch)
node = int(found.traversal.mscs[0][1])
bridge, leg = mask_of(graph, found.traversal.mscs[0][0]), mask_of(graph, node)
cells = planar.paper_path(bridge, (1, 1), (1, 2)).cells
choice = links_inside(cells, anatomy(leg).interior)
assert len(choice) > 0
draw.shared_links(cells, bridge, leg)

# %% [markdown]
# ## Theorem 4.3: every node of an MSC gets an even path
#
# Its ends are neighbours, so they differ in colour.

# %%
off = nodes[nodes["part"] == "MSC"]
assert len(off) and (off["covered"] % 2 == 0).all()
assert len(found.path) % 2 == 0
print(off[["node", "layer", "voxels", "covered"]].to_string(index=False))

# %% [markdown]
# ## On a real shape
#
# How often does it go as written? A node needs an interior, a common one with the next layer, a
# voxel of the right colour there, and an interior that Zhang and Liu's algorithm can take. Where
# one is missing, this node alone gets other ends or another path, and the table says why.

# %%
duck = lu.algorithm3(lu.model("duck", voxels=600))
reasons = duck.nodes["reasons"].str.split(", ").explode().value_counts()
written = (duck.nodes["reasons"] == "").sum()
assert written < len(duck.nodes)
print(f"{written} of {len(duck.nodes)} nodes as written; the others lack:")
print(reasons[reasons.index != ""].to_string())

# %% [markdown]
# ## Where this differs from the paper
#
# - Only the whole length must be even. The paper asks it of every layer, which costs voxels; our
#   own solver, `lu.layered_path`, asks it of the whole.
# - 'Randomly pick' is a seeded draw: `lu.algorithm3(solid, seed)`.
# - Where no voxel fits, the paper is silent; here another end is taken and the reason recorded.
#
# Next: `06_guarantees` asks what all this promises.
