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
# # Merging paths between layers (Section 4.2)
#
# Every node has its planar path. How do they become one path through the whole solid?

# %%
import os
from itertools import pairwise

import numpy as np

import lineup as lu
from lineup import draw, worked

# %%
# %matplotlib inline
# %config InlineBackend.figure_formats = ["jpeg"]
# %config InlineBackend.print_figure_kwargs = {"dpi": 80, "pil_kwargs": {"quality": 88}}

# %% [markdown]
# ## One path for an arch (Algorithm 3)
#
# Algorithm 3 walks the Reeb graph: first the nodes of the MSP, then each MSC, and links every
# planar path to the ones before. Here the layers of an arch are pulled apart. Blue is where the
# chain begins, red where it ends; thin rods are the links between layers.

# %%
arch = worked.arch()
found = lu.algorithm3(arch)
path = found.path
assert lu.certify_path(path, arch).ok
assert (found.nodes["how"] == "Algorithm 2").all() and (found.nodes["reasons"] == "").all()
assert len(path) == arch.size
draw.storeys(path, arch)

# %% [markdown]
# One rod between two storeys: the chain moves on and does not come back. Two rods side by side:
# it goes down a leg, and returns by the way it came. These are the two cases.

# %% [markdown]
# ## Case 1: moving on
#
# Along the MSP there is one directed edge from a node to the next. The path of the one ends right
# above (or below) the start of the other: the ends have the same x and y. One link joins them.

# %%
msp = [k for k, visit in enumerate(path.visits) if visit[3] == 0]
on = [(a, b) for a, b in pairwise(msp) if path.visits[a, 2] != path.visits[b, 2]]
leaving = path.voxels[[path.visits[a, 1] - 1 for a, _ in on]]
entered = path.voxels[[path.visits[b, 0] for _, b in on]]
assert (leaving[:, :2] == entered[:, :2]).all()
assert (np.abs(leaving[:, 2] - entered[:, 2]) == 1).all()
print(f"{len(on)} links along the MSP")

# %% [markdown]
# ## Case 2: there and back
#
# A node of an MSC is entered and left from the same node. A link (v1, v2) of that node's path is
# opened; from v1 the chain goes over to the voxel beside it, through the whole hanging path, and
# comes back to v2. So the path stops in v1, is away, and goes on in v2, next to v1.

# %%
away = [k for k in range(1, len(path.visits) - 1) if path.visits[k, 3] > path.visits[k - 1, 3]]
v1 = path.voxels[[path.visits[k, 0] - 1 for k in away]]
back = [k + 1 + np.argmax(path.visits[k + 1 :, 3] < path.visits[k, 3]) for k in away]
v2 = path.voxels[[path.visits[k, 0] for k in back]]
assert [path.visits[k - 1, 2] for k in away] == [path.visits[k, 2] for k in back]
assert (np.abs(v1 - v2).sum(axis=1) == 1).all() and (v1[:, 2] == v2[:, 2]).all()
print(f"{len(away)} times away and back, in {len(found.traversal.mscs)} MSC")

# %% [markdown]
# From above one sees the same. Triangles mark where the chain leaves a layer; in layers 0 to 2
# the leg of the MSC has two of them side by side.

# %%
assert len(found.traversal.mscs) == 1
draw.layers(path, arch, layers=[1, 2, 3, 4])

# %% [markdown]
# ## From a solid to a layered path (Figure 4)
#
# The whole of Section 4 at once, on a bunny: its voxels, its Reeb graph with the walk, its path.
# The path is by our solver, which covers more than Algorithm 3 does; the next two notebooks say
# why.

# %%
n = 300 if os.environ.get("LINEUP_QUICK") else 800
bunny = lu.model("bunny", voxels=n)
ours, papers = lu.layered_path(bunny), lu.layered_path(bunny, "paper")
assert lu.certify_path(ours, bunny).ok and lu.certify_path(papers, bunny).ok
assert len(papers) < len(ours) <= lu.path_bound(bunny)
print(f"of {bunny.size} voxels: {len(papers)} as the paper says, {len(ours)} by our solver")
draw.layering(ours, bunny)

# %% [markdown]
# ## What cannot be linked
#
# A node that offers no place to link to is dropped, with all that hangs off it, and reported.
# Here a single voxel sits on a plate: a detour needs two voxels side by side, one to go out by
# and one to come back.

# %%
pimple = np.ones((4, 4, 2), bool)
pimple[:, :, 1] = False
pimple[1, 1, 1] = True
solid = lu.VoxelSolid(np.concatenate([pimple, pimple], axis=0))
left = lu.layered_path(solid).dropped
assert (left[:, 2] == 1).any()
print("left out:", left.tolist())

# %% [markdown]
# ## Where this differs from the paper
#
# - The paper takes for granted that every link can be made. Here links that cannot be are dropped
#   and stand in `path.dropped`.
# - `layered_path` by default is our solver; `lu.algorithm3` and `method="paper"` are as written.
#
# Next: `05_feasible_ends` chooses where each planar path begins and ends.
