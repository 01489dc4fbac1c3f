"""What a user would otherwise write for a bound, a verdict, a print file or stresses."""

from __future__ import annotations

from typing import Any

import networkx as nx
import numpy as np
from numpy.typing import NDArray
from peers import voxel_graph
from scipy.spatial import cKDTree

import lineup as lu
from lineup.block import Block, block_parts
from lineup.fabrication.placing import placed
from lineup.stress.network import POISSON
from lineup.stress.results import DENSITY, GRAVITY, YOUNG_PA


def flow_bound(solid: lu.VoxelSolid) -> int:
    """networkx: the bound of `lu.path_bound` by its maximum flow."""
    voxels = np.argwhere(solid.occupancy)
    network = nx.DiGraph()
    network.add_nodes_from(["source", "sink"])
    for k, colour in enumerate((voxels.sum(axis=1) % 2).tolist()):
        ends = ("source", k) if colour == 0 else (k, "sink")
        network.add_edge(*ends, capacity=2)
    for a, b in voxel_graph(voxels).edges:
        even, odd = (a, b) if voxels[a].sum() % 2 == 0 else (b, a)
        network.add_edge(even, odd, capacity=1)
    return min(len(voxels), int(nx.maximum_flow_value(network, "source", "sink")) + 1)


def sampled_clearance(pose: NDArray[Any], points: int = 8) -> float:
    """Least distance of points on bars two or more apart, 1.05 if none is nearer."""
    along = np.linspace(0, 1, points)[:, None, None]
    cloud = (pose[:-1] + along * (pose[1:] - pose[:-1])).reshape(-1, 3)
    pairs = cKDTree(cloud).query_pairs(1.05, output_type="ndarray")
    bars = pairs % (len(pose) - 1)
    first, second = pairs[np.abs(bars[:, 0] - bars[:, 1]) >= 2].T
    return float(np.linalg.norm(cloud[first] - cloud[second], axis=1).min(initial=1.05))


def ccd_finds_contact(before: NDArray[Any], after: NDArray[Any], distance: float) -> bool:
    """ipctk: whether bars come that near on a straight step from pose to pose."""
    import ipctk

    bars = np.column_stack([np.arange(len(before) - 1), np.arange(1, len(before))])
    mesh = ipctk.CollisionMesh(np.asfortranarray(before), bars.astype(np.int32))
    ends = np.asfortranarray(before), np.asfortranarray(after)
    free = ipctk.is_step_collision_free(
        mesh, *ends, distance, broad_phase=ipctk.HashGrid(), narrow_phase_ccd=ipctk.AdditiveCCD()
    )
    return not free


def scene_of_chain(path: lu.VoxelPath, pitch_mm: float) -> Any:
    """trimesh: a scene of the parts of a chain, each mesh placed many times."""
    import trimesh

    block = Block(pitch_mm=pitch_mm)
    scene = trimesh.Scene()
    parts = block_parts(block)
    pieces = placed(path.voxels, block)
    for name in dict.fromkeys(piece.part for piece in pieces):
        part = parts[name]
        scene.geometry[name] = trimesh.Trimesh(part.vertices, part.faces, process=False)
    for k, piece in enumerate(pieces):
        at = np.eye(4)
        at[:3, :3], at[:3, 3] = piece.rotation, piece.offset_mm
        scene.graph.update(frame_to=f"{piece.part} {k}", matrix=at, geometry=piece.part)
    return scene


def by_elements(voxels: NDArray[Any], pitch_mm: float) -> float:
    """scikit-fem: how far voxels of resin sag, mm, where they are held at their lowest faces."""
    import skfem
    from skfem.helpers import sym_grad, trace

    mesh = mesh_of(voxels, pitch_mm / 1e3)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementHex1()))
    lame = YOUNG_PA * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    shear = YOUNG_PA / (2 * (1 + POISSON))

    @skfem.BilinearForm
    def elasticity(u: Any, v: Any, _: Any) -> Any:
        strain = sym_grad(u)
        inner = np.einsum("ij...,ij...", strain, sym_grad(v))
        return lame * trace(strain) * trace(sym_grad(v)) + 2 * shear * inner

    @skfem.LinearForm
    def weight(v: Any, _: Any) -> Any:
        return -DENSITY * GRAVITY * np.asarray(v)[2]

    low = basis.get_dofs(lambda x: np.isclose(x[2], mesh.p[2].min()))
    found = skfem.solve(*skfem.condense(elasticity.assemble(basis), weight.assemble(basis), D=low))
    return float(np.abs(found).max()) * 1e3


def mesh_of(voxels: NDArray[Any], edge: float) -> Any:
    """Voxels as elements of eight nodes, in the order of scikit-fem."""
    import skfem

    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    nodes, number = np.unique(
        (voxels[:, None] + corners).reshape(-1, 3), axis=0, return_inverse=True
    )
    grid = skfem.MeshHex.init_tensor(*[np.array([0.0, 1.0])] * 3)
    order = [int(np.flatnonzero((corners == p).all(axis=1))[0]) for p in grid.p[:, grid.t[:, 0]].T]
    elements = number.reshape(-1, 8)[:, order].T
    return skfem.MeshHex(nodes.T * edge, np.ascontiguousarray(elements))
