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
# # Symbols (Table 1)
#
# What does each symbol of the paper mean, and what is it called in this library? Each is shown here
# on one small solid, an arch of 168 voxels.

# %%
from IPython.display import Markdown

import lineup as lu
from lineup import draw, planar, worked
from lineup.assumptions import anatomy, mask_of
from lineup.symbols import SYMBOLS, symbols

# %%
# %matplotlib inline
# %config InlineBackend.figure_formats = ["jpeg"]
# %config InlineBackend.print_figure_kwargs = {"dpi": 80, "pil_kwargs": {"quality": 88}}

# %% [markdown]
# ## The whole table
#
# The last column is worked out from the arch, now.

# %%
arch = worked.arch()
table = symbols(arch).set_index("paper")
assert len(table) == len(SYMBOLS) and (table["example"].str.len() > 0).all()
Markdown(table[["section", "meaning", "example"]].to_markdown())

# %% [markdown]
# And where to find it:

# %%
assert table["here"].str.contains("`|voxels|node").all()
Markdown(table[["here"]].to_markdown())

# %% [markdown]
# ## S̃, n: the solid and its size (Section 3)

# %%
assert table.loc["n", "example"] == f"{arch.size} voxels" == "168 voxels"
draw.solid(arch)

# %% [markdown]
# ## 𝒢, o, p(𝒢), MSP, C: graph and walk (Sections 4 and 4.3)
#
# A node o is one connected piece of one layer. The walk p(𝒢) goes from node 7 to node 0; its MSP
# is red, its one MSC, C, is blue and hangs off o(C) = 6.

# %%
graph = lu.reeb_graph(arch)
walk = lu.traverse(graph)
assert walk.walk == (7, 6, 5, 3, 1, 3, 5, 6, 4, 2, 0)
assert walk.msp == (7, 6, 4, 2, 0) and walk.mscs == ((6, 5, 3, 1, 3, 5, 6),)
draw.nodes(graph, walk)

# %% [markdown]
# ## Ω, ∂Ω, Ω°, p(o), v_s, v_e: one node (Section 4.1)
#
# Ω, all squares, are the voxels of node 7. Blue is its boundary ∂Ω, yellow its interior Ω°. The
# stars are v_s and v_e, and the black line is p(o).

# %%
region = mask_of(graph, 7)
parts = anatomy(region)
path = planar.paper_path(region, (1, 1), (7, 2))
assert region.sum() == len(parts.boundary) + parts.interior.sum() == 22 + 14
assert tuple(path.cells[0]) == (1, 1) and tuple(path.cells[-1]) == (7, 2)
draw.planar_steps(region, path)

# %% [markdown]
# ## I_i and Ĩ_i: where to go on (Section 4.3)
#
# I_i: what the interiors of nodes 7 and 6 of the MSP share; a dark voxel becomes v_e.

# %%
start = (1, 1)
common = parts.interior & anatomy(mask_of(graph, 6)).interior
assert table.loc["I_i", "example"] == f"{common.sum()} voxels"
draw.overlap(region, mask_of(graph, 6), start)

# %% [markdown]
# Ĩ_i: links of the path of node 6 that lie over the interior of node 5, which hangs off it.

# %%
cells = planar.paper_path(mask_of(graph, 6), (1, 1), (1, 2)).cells
assert (graph.layer_of[[6, 5]] == [3, 2]).all()
draw.shared_links(cells, mask_of(graph, 6), mask_of(graph, 5))

# %% [markdown]
# ## P̃: the layered path (Section 4.2)

# %%
layered = lu.algorithm3(arch).path
assert lu.certify_path(layered, arch).ok
assert table.loc["P̄, P̃", "example"].startswith(f"{len(layered)} voxels")
draw.storeys(layered, arch)

# %% [markdown]
# ## P, S, contraction pair: the trimmed path (Section 5)

# %%
(trimmed,) = lu.trim([layered], len(layered) - 2)
assert len(trimmed) == len(layered) - 2
assert table.loc["P", "example"] == table.loc["S", "example"] == f"{len(trimmed)} voxels"
draw.contraction(layered)

# %% [markdown]
# ## Υ, block: the motion of the chain (Sections 6 and 7)
#
# Fat pieces are blocks, two voxels each; thin ones are hinges.

# %%
folding = lu.fold(arch)
assert folding.motion.straight and lu.certify(folding.motion).ok
assert len(folding.path) % 2 == 0
draw.unfolding(folding, moments=3)

# %% [markdown]
# ## Where this differs from the paper
#
# - Table 1 has fewer symbols; the others are from the text. It writes P̃ for the layered path,
#   Section 5 and Table 2 also P̄.
# - Its Ĩ_i is a set of voxels; what is used of it are links, so we count these.
#
# Next: back to `00_overview`, or to PAPER.md with all findings.
