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
# # From a path to an object in the hand (Section 7, Figures 2, 15 and 16)
#
# A chain of blocks is a drawing until someone prints it and folds it. What is a block, does it hold
# together and move, what comes off the printer, and how does a child know where the next block
# goes?

# %%
import os
import tempfile

import pandas as pd

import lineup as lu
from lineup import draw

# %%
# %matplotlib inline
# %config InlineBackend.figure_formats = ["jpeg"]
# %config InlineBackend.print_figure_kwargs = {"dpi": 80, "pil_kwargs": {"quality": 80}}

# %% [markdown]
# ## One block is two voxels (Figure 2)
#
# A *block* is a hinge, a bar with a ball at each end, between two round *capsules*. Each ball sits
# in the middle of a voxel, so a block covers two voxels. The capsule between two hinges is one
# printed piece: it is the second half of one block and the first half of the next. Each ball turns
# about a y axis and a z axis of its capsule, and a capsule may twist about the bar: five axes in
# all.

# %%
block = lu.Block(pitch_mm=10)
assert 2 * block.radius_mm + block.gap_mm == block.pitch_mm
assert block.bend_deg == 90
draw.block(block)

# %% [markdown]
# The panels in the lower row are *joint states*: in the corners of a folded chain every joint is
# straight or bent by 90°, one of five states for a ball.

# %% [markdown]
# ## A slot that holds its state (Figure 16)
#
# The bar leaves its capsule through one of four slots. A slot is narrower half way than the bar is
# thick, so the hinge snaps from one state into the next and stays there. "A certain force is needed
# to drive the hinge to go through the slot", says the paper; ours is an estimate by beam formulas,
# for a resin whose stiffness we assume.

# %%
assert block.neck_mm < block.bar_mm < block.hole_mm
force = lu.block.snap_force_n(block)
assert force > 0
print(f"neck {block.neck_mm:g} mm, bar {block.bar_mm:g} mm, hole {block.hole_mm:g} mm")
print(f"about {force:.0f} N to snap through")
draw.slots(block)

# %% [markdown]
# ## A judge for the block
#
# Two capsules and the hinge between them have 5 × 5 states. In each of them no two parts may
# overlap, the least gap has to be the clearance that the printer needs, and no ball may find a way
# out of its socket. The check looks at the solids alone, not at how they were made.

# %%
report = lu.check_block(block)
assert report.ok
assert report.poses >= 25
assert report.overlap_mm3 < 1e-6
assert report.gap_mm >= block.clearance_mm - 1e-6
print(f"{report.reason}: least gap {report.gap_mm:.2f} mm in {report.poses} poses")

# %% [markdown]
# ## The slots say no to some moves
#
# Figure 16's slots lie crosswise, so both ends of one capsule can only bend in planes that fit one
# cross. A capsule whose both ends are bent cannot twist, and Section 7's "full rotation" has a
# limit there. We counted in ten unfoldings how many moves ask for just that, and planned again
# without them.

# %%
slots = pd.read_csv("../experiments/results/slots.csv")
share = slots.pivot(index="solid", columns="plan", values="share")
assert share["growth"].between(0.15, 0.3).all()
assert (share["slotted growth"] == 0).all()
assert slots.query("plan == 'slotted growth'")["certified_slotted"].all()
draw.dots(100 * share, "moves against the slots, % of all moves", "What printed slots refuse")

# %% [markdown]
# A fifth to a quarter of the moves of plans made for free joints is against the slots. Growth that
# knows of the slots, `lu.fold(solid, joints="slotted")`, asks for none. The table is from `python
# benchmarks/slots.py`.

# %% [markdown]
# ## The print kit (Figure 15)
#
# We take a small duck of 40 blocks for what follows, folded so that the slots let its blocks make
# every move. The chain is laid to and fro on the bed of the printer, in colours that change along
# it, and comes off as one loose chain. No piece touches another.

# %%
blocks = 16 if os.environ.get("LINEUP_QUICK") else 40
design = lu.lineup(["duck"], blocks=blocks, joints="slotted")
(duck,) = design.foldings
kit = lu.export_print(duck, tempfile.mkdtemp(), block.pitch_mm, bed_mm=(150, 150))
(plate,) = kit.plates
assert (plate.start, plate.stop) == (0, blocks)
assert len(plate.voxels) == 2 * blocks
print(", ".join(file.name for file in kit.files))
draw.plate(lu.fabrication.pieces_on(plate, block), block)

# %% [markdown]
# Grey hinges sit in coloured capsules. The same chain, folded, is what it is for; blue is the first
# block and red the last, on the bed and here.

# %%
assert len(duck.path) == len(plate.voxels)
assert design.certificates[0].ok
draw.chain(duck)

# %% [markdown]
# `coupon.3mf` are three short chains with different clearances: print these first and keep the
# measures that move well. The bill of materials counts the pieces. n blocks are n hinges, n − 1
# capsules and two ends:

# %%
count = kit.bill.set_index("part")["count"]
assert count["hinge"] == blocks
assert count["middle"] == blocks - 1
assert count["end"] == 2
kit.bill[["part", "count"]]

# %% [markdown]
# The paper's chain of 754 blocks is a straight line of 1,508 voxels: 15 m of 10 mm voxels. It fits
# a usual bed in three runs, which are joined by a tongue and a groove.

# %%
beds = lu.fabrication.plates(754, block, bed_mm=(250.0, 250.0))
assert len(beds) == 3
assert beds[-1].stop == 754
assert [bed.last for bed in beds] == ["tongue", "tongue", "end"]
print([f"blocks {bed.start + 1} to {bed.stop}" for bed in beds])

# %% [markdown]
# ## The operation manual (Section 7)
#
# "It is challenging for novice users, especially children", to fold the line into a shape, so the
# paper gives them a manual: for each block, the direction in which it goes. Ours is the certified
# unfolding read backwards, so that no step is blocked by an earlier one. It begins with a cover and
# a card on which the first blocks, the base, are laid.

# %%
files = lu.write_manual(duck, tempfile.mkdtemp(), name="duck")
again = lu.read_manual(files.json)
assert (again.path.voxels == duck.path.voxels).all()
assert lu.certify(again.motion, joints="slotted").ok
draw.spread(lu.manual_pages(duck, [1, 3], name="duck"))

# %% [markdown]
# Then a page for each step: a plan of the layer as seen from above, new blocks in colour on what is
# there already in grey; a picture of the body so far; the directions in letters (E, N, U are east,
# north and up, W, S, D the opposite ways), and a check at the foot, so that a mistake is found on
# its own page. A plus is at a block whose hinge bends before its piece, and a star at one whose
# hinge is straightened out of its piece first, for the slots let neither bend at once.

# %%
draw.spread(lu.manual_pages(duck, [5, 6], name="duck"))

# %% [markdown]
# ## The same as a table, for programs
#
# The paper's manual gives "the global orientation" of each next cylinder. Here are the rows:
# `hinge` and `piece` are the directions of the two bars of a block, and `frame` are its axes.
# Nothing more is needed to build the shape: walk along the letters, and every voxel of the path is
# there.

# %%
rows = pd.read_csv(files.csv).sort_values("block")
assert rows["block"].tolist() == list(range(1, blocks + 1))
ways = "".join(rows["hinge"] + rows["piece"].fillna(""))
steps = [lu.grid.DIRECTIONS["ENUWSD".index(letter)] for letter in ways]
walked = duck.path.voxels[0] + pd.DataFrame(steps).cumsum().to_numpy()
assert (walked == duck.path.voxels[1:]).all()
rows[["block", "end", "step", "hinge", "piece", "frame"]].head(6)

# %% [markdown]
# ## Where this differs from the paper
#
# - The paper does not give the size of its block, nor of its slots. Ours are numbers that a judge
#   accepts, and a coupon tells which your printer likes.
#
# - We have printed nothing, and nobody has folded anything by hand for us: the checks are on solids
#   and on motions. The paper folded five models (Figure 15).
#
# - Its manual numbers the 754 blocks B₀ to B₇₅₄, which are 755; ours counts from 1.
#
# - It has one direction after another, from the first block on. Our steps follow the certified
#   motion, from the inside of the shape out to both ends.
#
# - It has directions alone. In slots, some hinges also need an order of their own, and ours says
#   which: a column of the rows, and the signs * and + of the booklet.
#
# - Velcro and thermosol, the paper's glue between neighbours, are no part of the kit.
#
# - Next, in 11: what velcro has to bear, and what breaks without it.
