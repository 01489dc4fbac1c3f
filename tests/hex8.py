"""Finite elements for voxel solids under their own weight: hex8 with Wilson's incompatible modes.

An oracle for `lineup.stress` that shares nothing with it. Each voxel is split into s x s x s
cubes of eight nodes. Plain ones lock: a beam one element thick bends by two thirds of what it
should. The modes 1 - xi^2 in each direction, condensed out, let an element bend. Pitch, Young's
modulus and the weight of a voxel are 1.
"""

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

CORNERS = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], float)
GAUSS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / np.sqrt(3)


def elasticity(poisson):
    """(6, 6) stresses xx, yy, zz, xy, yz, zx of strains, shear strains being engineers'."""
    lame = poisson / ((1 + poisson) * (1 - 2 * poisson))
    shear = 1 / (2 * (1 + poisson))
    matrix = np.diag([2 * shear] * 3 + [shear] * 3)
    matrix[:3, :3] += lame
    return matrix


def strain(gradients):
    """(6, 3k): strains of k functions times vectors, from their (k, 3) gradients."""
    rows = np.zeros((6, 3 * len(gradients)))
    for k, (x, y, z) in enumerate(gradients):
        rows[:, 3 * k : 3 * k + 3] = [
            [x, 0, 0],
            [0, y, 0],
            [0, 0, z],
            [y, x, 0],
            [0, z, y],
            [z, 0, x],
        ]
    return rows


def strains(point, edge):
    """Strains at a point of (-1, 1)^3: of the eight nodes (6, 24), of the modes (6, 9)."""
    factors = 1 + CORNERS * point
    others = np.stack([factors[:, [1, 2]], factors[:, [0, 2]], factors[:, [0, 1]]], axis=1)
    nodes = CORNERS * others.prod(axis=2) / 8
    return strain(nodes * 2 / edge), strain(np.diag(-2 * np.asarray(point)) * 2 / edge)


def element(edge, poisson, modes):
    """Stiffness (24, 24), and the amplitudes (9, 24) of the modes for given nodes."""
    law, volume = elasticity(poisson), (edge / 2) ** 3
    at = [strains(point, edge) for point in GAUSS]
    nodes = sum(b.T @ law @ b for b, _ in at) * volume
    mixed = sum(b.T @ law @ m for b, m in at) * volume
    own = sum(m.T @ law @ m for _, m in at) * volume
    amplitudes = -np.linalg.solve(own, mixed.T) if modes else np.zeros((9, 24))
    return nodes + mixed @ amplitudes, amplitudes


def solved(voxels, s, held, up=(0, 0, 1), poisson=0.35, modes=True):
    """Displacements (nodes, 3) and their places; the face of side `held` = (axis, sign) is fixed.

    Returns
    -------
    dict
        ``u`` (E, 24) displacements of the nodes of each element; ``of`` the voxel and ``cell``
        the place in it of each element; ``sag`` the largest displacement; ``edge`` and
        ``amplitudes`` for `face_tractions`.
    """
    cells = np.argwhere(np.ones((s, s, s)))
    place = (np.asarray(voxels)[:, None] * s + cells).reshape(-1, 3)
    corner = (place[:, None] + (CORNERS + 1) / 2).astype(int)
    nodes, index = np.unique(corner.reshape(-1, 3), axis=0, return_inverse=True)
    index = index.reshape(-1, 8)
    stiffness, amplitudes = element(1 / s, poisson, modes)
    dof = (3 * index[:, :, None] + np.arange(3)).reshape(-1, 24)
    rows, columns = np.repeat(dof, 24, axis=1).ravel(), np.tile(dof, 24).ravel()
    values = np.tile(stiffness.ravel(), len(dof))
    matrix = sparse.coo_matrix((values, (rows, columns)), shape=(3 * len(nodes),) * 2).tocsc()
    load = np.zeros((len(nodes), 3))
    np.add.at(load, index.ravel(), -np.asarray(up, float) / (8 * s**3))
    axis, sign = held
    fixed = nodes[:, axis] == (nodes[:, axis].max() if sign > 0 else nodes[:, axis].min())
    free = np.flatnonzero(np.repeat(~fixed, 3))
    u = np.zeros(3 * len(nodes))
    u[free] = splu(matrix[free][:, free], permc_spec="MMD_AT_PLUS_A").solve(load.ravel()[free])
    return {
        "u": u[dof],
        "of": np.repeat(np.arange(len(voxels)), s**3),
        "cell": np.tile(cells, (len(voxels), 1)),
        "sag": np.linalg.norm(u.reshape(-1, 3), axis=1).max(),
        "split": s,
        "poisson": poisson,
        "amplitudes": amplitudes,
    }


def face_tractions(found, pairs, normals):
    """Normal stress, mean over the face of each pair of voxels and over its two sides."""
    s, law = found["split"], elasticity(found["poisson"])
    means = {}
    for axis in range(3):
        for side in (-1, 1):
            skin = found["cell"][:, axis] == (0 if side < 0 else s - 1)
            stress = np.zeros(skin.sum())
            for point in np.array([(a, b) for a in (-1, 1) for b in (-1, 1)]) / np.sqrt(3):
                at = np.insert(point, axis, side)
                nodes, own = strains(at, 1 / s)
                stress += (found["u"][skin] @ (law @ (nodes + own @ found["amplitudes"])).T)[
                    :, axis
                ]
            n = found["of"].max() + 1
            means[axis, side] = np.bincount(found["of"][skin], stress / 4, n) / s**2
    axes, signs = np.abs(normals).argmax(axis=1), np.sign(normals.sum(axis=1)).astype(int)
    rows = zip(pairs.tolist(), axes.tolist(), signs.tolist(), strict=True)
    return np.array([(means[k, d][i] + means[k, -d][j]) / 2 for (i, j), k, d in rows])
