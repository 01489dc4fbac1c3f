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
# # Reeb graphs (Section 4)
#
# In which order should one chain visit the layers of a solid, so that it comes by everywhere? And
# which parts of that tour are a way through, which are there-and-back?

# %%
import os
from itertools import pairwise

import lineup as lu
from lineup import draw, worked

# %%
# %matplotlib inline
# %config InlineBackend.figure_formats = ["jpeg"]
# %config InlineBackend.print_figure_kwargs = {"dpi": 80, "pil_kwargs": {"quality": 88}}

# %% [markdown]
# ## Pieces of layers become nodes
#
# Take a solid apart, layer by layer. A layer may fall into several connected pieces, such as the
# two ears of a bunny. Each piece is a *node* of the *Reeb graph*; two nodes are joined by an *edge*
# where a voxel of one lies right above a voxel of the other.

# %%
bunny = lu.model("bunny", voxels=300 if os.environ.get("LINEUP_QUICK") else 1000)
graph = lu.reeb_graph(bunny)
walk = lu.traverse(graph)
assert ((graph.node_of >= 0) == bunny.occupancy).all()
assert (graph.layer_of[graph.edges[:, 1]] == graph.layer_of[graph.edges[:, 0]] + 1).all()
print(f"{bunny.occupancy.shape[2]} layers, {len(graph)} nodes, {len(graph.edges)} edges")
draw.nodes(graph, walk)

# %% [markdown]
# Left the pieces, right the graph; equal numbers and colours belong together. Body and head are
# one string of nodes, and ears and feet are branches. What the colours say comes below.

# %% [markdown]
# ## Pick a layer
#
# A slider in JupyterLab, a still picture elsewhere.

# %%
assert set(graph.layer_of.tolist()) == set(range(bunny.occupancy.shape[2]))
draw.explore(lambda z: draw.layer(graph, z), z=range(bunny.occupancy.shape[2]))

# %% [markdown]
# ## A walk through all nodes (Figure 4)
#
# A *spanning tree* keeps just enough edges to join all nodes, one fewer than there are nodes.
# Depth-first search finds one, and walking along it gives the *traversing path* p(G): it starts
# at the top, goes into every branch and back, and ends at the bottom. No edge is walked twice in
# the same direction.

# %%
steps = list(pairwise(walk.walk))
assert set(walk.walk) == set(range(len(graph)))
assert len({frozenset(step) for step in steps}) == len(graph) - 1
assert len(set(steps)) == len(steps)
print(" ".join(map(str, walk.walk)))

# %% [markdown]
# ## MSP and MSCs (Section 4.3, Figure 8)
#
# Some nodes are passed once on the way from start to end: they make the *maximal sub-path*, MSP.
# A branch that is walked there and back, and begins and ends at the same node o(C), is a *maximal
# sub-cycle*, MSC. Here is a solid with the very graph of Figure 8, and the numbers of the paper.

# %%
solid = worked.figure_8()
graph = lu.reeb_graph(solid)
found = lu.traverse(graph, root=14, end=0)
name = {node: k for k, node in enumerate(dict.fromkeys(found.walk), 1)}
walked = [1, 2, 3, 4, 5, 4, 3, 2, *range(6, 14), 12, 11, 10, *range(14, 19)]
assert [name[node] for node in found.walk] == walked
assert [name[node] for node in found.msp] == [1, 2, *range(6, 11), *range(14, 19)]
cycles = [[name[node] for node in cycle] for cycle in found.mscs]
assert cycles == [[2, 3, 4, 5, 4, 3, 2], [10, 11, 12, 13, 12, 11, 10]]
draw.decomposition(graph, found, name)

# %% [markdown]
# And the solid itself, taken apart, with our own numbers, which count from the lowest layer up.
# A horn and an arm are the two MSCs.

# %%
assert len(graph) == 18 and len(found.mscs) == 2
draw.nodes(graph, found)

# %% [markdown]
# ## Two cycles at one node (Figure 9)
#
# Both horns hang off node 2. One could take both as one big cycle, 2, 3, 4, 5, 4, 3, 2, 6, 7, 8,
# 7, 6, 2; but it passes 2 three times, and an MSC may pass its node twice only, at its start and
# its end. So there are two.

# %%
graph = lu.reeb_graph(worked.figure_9())
found = lu.traverse(graph, root=3, end=0)
name = {node: k for k, node in enumerate(dict.fromkeys(found.walk), 1)}
cycles = [[name[node] for node in cycle] for cycle in found.mscs]
assert cycles == [[2, 3, 4, 5, 4, 3, 2], [2, 6, 7, 8, 7, 6, 2]]
assert all(cycle.count(2) == 2 for cycle in cycles)
assert [name[node] for node in found.msp] == [1, 2, 9, 10]
draw.decomposition(graph, found, name)

# %% [markdown]
# ## Handles
#
# A graph with a loop has more edges than a tree needs. Those left over are not walked: the chain
# goes round only one side of a hole, and visits the other as a branch.

# %%
graph = lu.reeb_graph(lu.model("two_holed_torus", voxels=300))
walk = lu.traverse(graph)
n_spare = len(graph.edges) - (len(graph) - 1)
assert n_spare == 2
print(f"{n_spare} edges are not walked, one for each hole")
draw.reeb(graph, walk)

# %% [markdown]
# ## Where this differs from the paper
#
# - The paper leaves open where the walk starts and ends. Ours goes from the highest node to the
#   lowest unless told otherwise; `lu.layered_path` tries many trees and ends.
# - Its numbers count nodes along the walk, ours from the lowest layer up.
#
# Next: `03_planar_paths` looks for a long path inside one node.
