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
# # Unfolding (Section 6)
#
# Does the paper's Algorithm 4 straighten every layered path, as Section 6 says? And if it does not,
# what does? This notebook runs it, shows where it fails, and what takes its place.

# %%
import numpy as np

import lineup as lu
from lineup import draw

# %%
# %matplotlib inline
# %config InlineBackend.figure_formats = ["jpeg"]
# %config InlineBackend.print_figure_kwargs = {"dpi": 80, "pil_kwargs": {"quality": 88}}

# %% [markdown]
# ## Two projections (Figure 12)
#
# Seen along y, a layered path is a planar linkage. An energy that repels bars of equal depth
# straightens it; then the path, seen along x, is a linkage that never steps down, and one tilt of
# all bars at once does the rest. Squares that several joints fall on, the *composite* ones, are
# red.

# %%
block = lu.VoxelSolid(np.ones((5, 3, 4), bool))
path = lu.layered_path(block)
motion = lu.unfold(path, method="energy")
assert motion.straight
assert lu.certify(motion).ok
draw.two_stages(motion)

# %% [markdown]
# ## Depth by depth (Figures 13 and 14)
#
# Bars of other depths may cross in the projection, so the energy counts only pairs of one depth.
# Within a depth nothing crosses.

# %%
_, n_joints = np.unique(path.voxels[:, [0, 2]], axis=0, return_counts=True)
assert n_joints.max() > 1  # composite squares, as in Figure 13
draw.projection(path)

# %%
assert len(np.unique(path.voxels[:, 1])) == block.occupancy.shape[1] == 3
draw.depths(path)

# %% [markdown]
# ## Four voxels that it does not move
#
# The two bars along x have one projection and different depths. No pair is left to repel: energy
# and gradient are zero, and the chain is not straight.

# %%
four = lu.VoxelPath(np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]))
stuck = lu.unfold(four, method="energy")
assert not stuck.straight
print(stuck.reason)

# %% [markdown]
# ## A true minimum of the energy
#
# Fourteen voxels whose flow comes to rest far from straight, with no force left in it. A chain of
# touching blocks has no trouble: its ends can let go of bar after bar.

# %%
letters = "DDWUUSSDNEDSU"
steps = lu.grid.DIRECTIONS[["ENUWSD".index(letter) for letter in letters]]
trapped = lu.VoxelPath(np.vstack([np.zeros((1, 3), int), steps.cumsum(axis=0)]))
rests = lu.unfold(trapped, method="energy")
assert rests.reason.startswith("stationary")
assert lu.certify(lu.unfold(trapped)).ok
print(rests.reason)

# %% [markdown]
# ## A spiral that bends too far
#
# In the plane theory is on its side, and it ends straight. But the flow takes no notice of the
# width of blocks: on the way bars come nearer than a block is wide, and bend by more than 90
# degrees. The judge refuses it.

# %%
sides = np.repeat(np.arange(21) % 4, np.arange(2, 23) // 2)[:120]
steps = np.array([(1, 0, 0), (0, 0, 1), (-1, 0, 0), (0, 0, -1)])[sides]
spiral = lu.VoxelPath(np.vstack([np.zeros((1, 3), int), steps.cumsum(axis=0)]))
flow = lu.unfold(spiral, method="energy")
assert flow.straight
assert flow.diameter < 0.99
assert not lu.certify(flow).ok
print(f"comes within {flow.diameter:.3f}, bends by {flow.max_bend_deg:.1f} degrees")

# %% [markdown]
# ## One tilt instead
#
# The spiral never steps along y. Tilting all its bars that way at once straightens it in one
# move that brings no two points nearer (Lemma 3 of docs/motion.md).

# %%
tilt = lu.unfold(spiral)
assert lu.certify(tilt).ok
assert len(tilt) == 1
print(tilt.reason)

# %% [markdown]
# ## Any path, with thinner blocks
#
# Pulled out by one end, a chain glides along its own track. Bars cut corners on the way, so they
# have to be thinner than touching blocks; in return there is nothing to search for.

# %%
pulled = lu.unfold(trapped, method="pull")
assert pulled.straight
assert lu.certify(pulled, diameter=pulled.diameter, max_bend_deg=pulled.max_bend_deg).ok
print(
    f"{len(pulled)} pulls, bars of {pulled.diameter}, joints of {pulled.max_bend_deg:.0f} degrees"
)

# %% [markdown]
# ## From shape to shape
#
# A motion backwards is a motion, so the line leads on to any other shape of the same length. In a
# box the line is never made: what has been let go is folded away, and unfolded again as the other
# shape.

# %%
shapes = [lu.VoxelSolid(np.ones(shape, bool)) for shape in ((4, 4, 6), (8, 12, 1))]
a, b = (lu.fold(shape, ends=1, length=96) for shape in shapes)
far = lu.certify(lu.transform(a, b))
near = lu.certify(lu.transform(a, b, within=(60, 60, 60)))
assert far.ok
assert near.ok
assert max(near.extent) < max(far.extent) / 2
print([round(side) for side in far.extent], [round(side) for side in near.extent])

# %% [markdown]
# ## Where this differs from the paper
#
# - Algorithm 4 is run as published, apart from the second stage: the method of Biedl et al. is made
#   for bars without width, and one tilt does the same.
# - It is not what unfolds our chains: `lu.fold` designs path and motion together.
# - 'Certified' is the word of a judge about the motion that is stored, at a stated width and bend.
#
# Next: `09_table2` does all this for the ten models of the paper.
