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
# # Voxels (Section 3)
#
# How does a smooth shape become something that a chain of blocks can fill? And what must hold of
# it before any path is looked for?

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
# ## A shape becomes equal cubes
#
# A *voxel* is a cube of a regular grid. A *solid* is a set of voxels; its size n is their number.
# We ask for a number and get a solid near it: the edge of a voxel and the place of the grid are
# searched for.

# %%
n = 400 if os.environ.get("LINEUP_QUICK") else 1600
bunny = lu.model("bunny", voxels=n)
assert abs(bunny.size - n) <= 0.02 * n
print(f"asked for {n}, got {bunny.size}, in a box of {bunny.occupancy.shape}")
draw.solid(bunny)

# %% [markdown]
# The two tones are a checkerboard, there only so that single voxels can be seen. They come back
# in Section 4, where they prove that lengths are even.

# %% [markdown]
# ## More voxels look more like the shape
#
# How much more? The *IoU*, intersection over union, measures it: what the shape and its voxels
# share, divided by what the two fill together. It is 1 for a perfect fit.

# %%
counts = [200, 800] if os.environ.get("LINEUP_QUICK") else [200, 800, 3200]
row = [lu.model("bunny", voxels=count) for count in counts]
fit = [solid.source["iou"] for solid in row]
assert fit == sorted(fit)
words = [
    f"{s.size} voxels\nin {s.occupancy.shape[2]} layers, IoU {s.source['iou']:.2f}" for s in row
]
draw.solids(row, words)

# %% [markdown]
# The paper's chains of 754 blocks make shapes of 1,508 voxels, those of 2,945 blocks shapes of
# 5,890: two voxels are one block.

# %% [markdown]
# ## Which way is up?
#
# All voxels of one height are a *layer*, and the chain will go through the solid layer by layer.
# So somebody must say which way is up; the paper leaves it to the user. Laid on its side, the
# same bunny has other layers.

# %%
ways = {up: lu.model("bunny", voxels=n, up=up) for up in ("+z", "+x", "+y")}
n_layers = {up: solid.occupancy.shape[2] for up, solid in ways.items()}
assert len(set(n_layers.values())) > 1
draw.solids(list(ways.values()), [f"{up} is up\n{k} layers" for up, k in n_layers.items()])

# %% [markdown]
# ## Try it
#
# In JupyterLab two sliders appear here once you run the cell; a page that nobody runs shows one
# still picture.

# %%
counts = [200, 400, 800, 1600, 3200]
assert counts[len(counts) // 2] == 800  # the still picture is of the middle values
draw.explore(
    lambda up, voxels: draw.solid(lu.model("bunny", voxels=voxels, up=up)),
    up=["-x", "+x", "+z", "-z", "+y"],
    voxels=counts,
)

# %% [markdown]
# ## No voids, one piece
#
# The paper asks for *void-free* solids: no empty voxel may be shut in, for the chain could never
# look into it. `mend` fills what is hollow, keeps the largest piece, and says what it did.

# %%
hollow = np.ones((5, 5, 5), bool)
hollow[1:4, 1:4, 1:4] = False
mended = lu.mend(hollow)
assert mended.size == 125
assert mended.source["mended"]["voids_filled"] == 27
print(mended.source["mended"])

# %% [markdown]
# And whatever is called a solid is one: a `VoxelSolid` with a void in it is refused, in one line
# that says what would do.

# %%
refusal = ""
try:
    lu.VoxelSolid(hollow)
except ValueError as error:
    refusal = str(error)
assert "void-free" in refusal
print(refusal)

# %% [markdown]
# ## Handles are kept
#
# A cup has a hole through its handle, and a chain of blocks can have one too. The *Euler number*
# counts: 1 for a ball, one less for each handle. The two-holed torus has -1, as a mesh and as
# voxels.

# %%
torus = lu.model("two_holed_torus", voxels=n)
assert torus.source["euler_mesh"] == torus.source["euler_solid"] == -1
print(f"{torus.size} voxels, Euler number {torus.source['euler_solid']}")
draw.solid(torus)

# %% [markdown]
# ## The task (Algorithm 1, Figure 1)
#
# Section 3 states it: given such solids, find for each a solid of equally many voxels that still
# looks like it, so that one chain of blocks forms them all and folds from each into each. One
# call does it for two small ones, and the rest of these notebooks takes that call apart.

# %%
design = lu.lineup(["bunny", "duck"], blocks=40)
bunny, duck = design.foldings
assert len(bunny.path) == len(duck.path) == 80
assert all(verdict.ok for verdict in design.certificates)
draw.contact_sheet(design.foldings, ["bunny\n40 blocks", "duck\nthe same 40 blocks"])

# %% [markdown]
# ## Where this differs from the paper
#
# - The paper voxelizes by Zhou et al. (2014), whose objective is not public. Ours: the target
#   count, agreement with a finer sampling of the shape, few thin parts, the right Euler number.
# - Nothing is thickened, filled or dropped without a word in `solid.source`.
# - Unless `lineup models --fetch` has brought the meshes, models are stand-ins of smooth blobs.
#
# Next: `02_reeb_graphs` turns the layers into a graph and walks through it.
