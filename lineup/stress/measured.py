"""Forces on the faces of a folded chain under its own weight, and how safe they are (Figure 17)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy import sparse

from ..grid import BoolArray, FloatArray, IntArray
from ..solid import Folding, VoxelPath, VoxelSolid
from .contacts import Points, all_points, no_points, table_points, touch_points
from .faces import (
    TOUCH,
    Bonding,
    Faces,
    bonding_of,
    checked_chain,
    chosen,
    inner_faces,
    joined,
    outer_faces,
)
from .network import Matrix, face_forces, opening, springs, stretch, unbalanced, weights
from .results import DENSITY, STANDS, UNBALANCED, YOUNG_PA, Setting, Strength
from .solving import balanced
from .support import level_axes, tip_margin, upward
from .table import borne_by_faces, borne_by_points, table_of, together

_LEAST_MARGIN = 1e-9  # voxels; right over the edge of the base is no balance


def strength(
    shape: Folding | VoxelPath,
    solid: VoxelSolid | None = None,
    pitch_mm: float = 10.0,
    *,
    density: float = DENSITY,
    bonding: Bonding | str = "velcro",
    up: str | tuple[float, float, float] = "+z",
    held: str | None = None,
    young_pa: float = YOUNG_PA,
) -> Strength:
    """What each face of a folded chain bears under its own weight (Section 7, Figure 17).

    Voxels are rigid and faces are springs (`stress.network`): those inside printed pieces, at
    hinges, and, with velcro, wherever two strands touch. Voxels that the path leaves out bear
    nothing and weigh nothing.

    Parameters
    ----------
    shape : Folding or VoxelPath
    solid : VoxelSolid, optional
        The solid that it is a path of; gives the name, and the path must lie in it.
    pitch_mm : float
        Edge length of a voxel of the path. Stresses grow in proportion to it and to `density`.
    density : float
        In kg / m^3, of a block that fills its two voxels.
    bonding : Bonding or str
        How stiff faces are, by name or as one likes: "velcro"; "none", without velcro, where
        strands only push each other; "chain", where they do not even that; "solid".
    up : str or three numbers
        The direction against gravity, "+x" ... "-z" or any vector. The body rests on its lowest
        faces, edges or corners, on a smooth level table, which only pushes.
    held : str, optional
        Instead of a table: the side, "+x" ... "-z", whose outermost faces are held as by a wall.
    young_pa : float
        Of solid resin; it sets `sag_mm` alone.

    Returns
    -------
    Strength
        A face is safe by the factor by which all loads may grow until the first of these: the
        tension at a corner of a hinge or velcro face comes to `TENSION_PA`, the compressive force
        on a face to `BUCKLING_N`, the compression at a corner, in a printed piece also the
        tension, to `RESIN_PA`.

    Raises
    ------
    ValueError
        If the path is not a simple lattice path of two or more voxels in `solid`, or an option is
        out of range.
    ArithmeticError
        If the system cannot be solved to `UNBALANCED`.

    Notes
    -----
    Stresses are those of whole voxel faces: what a face bears, over a^2, as the paper's limits
    are for whole blocks. What happens within a block, in the neck of a hinge, is in the limits
    that the paper measured, not in the model. Shear and torsion are told and not judged, for the
    paper measured no limit of them. Shifts are taken to be small, and what only pushes to be
    smooth.

    Chains one voxel thick are as statics and beam theory have them. The stress at the edge of a
    beam three voxels high is within 1.3 % of theory, four high 2.2 %. Beside finite elements, of
    one lump of resin without Poisson's ratio, face-mean tractions differ (root mean square) by
    1.5 % in beams, 6 % in arches, 15 % in plates that stick out, the largest one by 3 %; with
    Poisson's ratio the largest one by 8 %.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> tower = lu.VoxelPath(np.array([(0, 0, z) for z in range(4)]))
    >>> result = lu.strength(tower, held="+z")
    >>> result.table["normal_n"].round(4).tolist()  # it hangs: each face bears what is below
    [0.0111, 0.0222, 0.0333, 0.0443]
    >>> lu.strength(tower).reason
    'stands'
    """
    path = shape.path if isinstance(shape, Folding) else shape
    if solid is not None:
        _check_inside(path, solid)
    setting = Setting(pitch_mm, density, bonding, up, held, young_pa)
    return measured(path.voxels, setting, "" if solid is None else solid.name)


def measured(voxels: IntArray, setting: Setting, name: str = "", start: int = 0) -> Strength:
    """`strength` of the voxels of a chain whose first is joint `start`."""
    voxels = checked_chain(voxels)
    faces = inner_faces(voxels, bonding_of(setting.bonding), odd=start % 2 == 1)
    if setting.held is not None:
        faces = joined(faces, outer_faces(voxels, setting.held))
    unknown = np.full((len(faces), 3), np.nan)
    margin_mm, reason = _support(voxels, setting)
    result = Strength(
        name=name,
        setting=setting,
        voxels=voxels,
        table=table_of(borne_by_faces(voxels, faces, unknown, unknown), setting, start),
        force_n=unknown,
        torque_nmm=unknown,
        stands=margin_mm > _LEAST_MARGIN,
        reason=reason,
        margin_mm=margin_mm,
        centre=voxels.mean(axis=0),
        safety=0.0,
        worst=-1,
        sag_mm=float("nan"),
        residual=float("nan"),
    )
    return _loaded(result, faces, start) if result.stands else result


def _support(voxels: IntArray, setting: Setting) -> tuple[float, str]:
    """The margin in mm and the reason of a `Strength`."""
    if setting.held is not None:
        return float("inf"), f"held at {setting.held}"
    up = upward(setting.up)
    table, axes = table_points(voxels, up), level_axes(up)
    touched = (voxels[table.first] + table.arm) @ axes.T
    margin_mm = tip_margin(touched, voxels.mean(axis=0) @ axes.T) * setting.pitch_mm
    if margin_mm > _LEAST_MARGIN:
        return margin_mm, STANDS
    where = f"{-margin_mm:.1f} mm outside of" if margin_mm < -_LEAST_MARGIN else "on the edge of"
    return margin_mm, f"tips over: its centre of mass is {where} what it rests on"


def _loaded(result: Strength, faces: Faces, start: int) -> Strength:
    """The result with what its faces bear."""
    setting, voxels, n = result.setting, result.voxels, len(result.voxels)
    up = upward(setting.up)
    touch = faces.kind == TOUCH
    points = all_points(
        table_points(voxels, up) if setting.held is None else no_points(),
        touch_points(chosen(faces, touch)),
    )
    springy = chosen(faces, ~touch)
    u, pushed = _balance(springy, points, up, voxels)
    force, moment = face_forces(springy, u)
    left = unbalanced(springy, force, moment, points, pushed, up, n)
    residual = left / max(n, float(np.abs(force).max()), float(np.abs(moment).max()))
    if residual > UNBALANCED:
        raise ArithmeticError(f"{left:.1e} voxel weights are not balanced on one voxel")
    borne = borne_by_faces(voxels, springy, force, moment)
    if len(points):
        borne = together(borne, borne_by_points(voxels, points, pushed))
    table = table_of(borne, setting, start)
    worst = int(table["safety"].argmin())
    sag = float(np.linalg.norm(u.reshape(n, 6)[:, :3], axis=1).max())
    sag_mm = sag * setting.pitch_mm * setting.pascal / setting.young_pa
    reason = result.reason
    if sag_mm > setting.pitch_mm:
        reason += f", but sags by {sag_mm:.0f} mm, for which the model is not made"
    return replace(
        result,
        reason=reason,
        table=table,
        force_n=borne.force * setting.newton,
        torque_nmm=borne.moment * setting.newton * setting.pitch_mm,
        safety=float(table["safety"].iloc[worst]),
        worst=worst,
        sag_mm=sag_mm,
        residual=residual,
    )


def _balance(
    faces: Faces, points: Points, up: FloatArray, voxels: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Displacements and the push at each point."""
    n = len(voxels)
    part = stretch(faces, n)
    stiffness = part.T @ sparse.diags(springs(faces)) @ part
    if len(points) and points.second[0] < 0:
        # A smooth table leaves the body free to glide and turn; three bars that bear nothing pin
        # it, for neither the weight nor the pushes have anything to set against them.
        pins = np.zeros((3, 6))
        pins[:2, :3], pins[2, 3:] = level_axes(up), up
        stiffness += _block(pins.T @ pins, 6 * int(points.first[0]), 6 * n)
    return balanced(stiffness, weights(n, up), opening(points, n), points.share, voxels)


def _block(values: FloatArray, at: int, size: int) -> Matrix:
    """A matrix that is 0 but for a square block on its diagonal."""
    rows, columns = np.indices(values.shape).reshape(2, -1) + at
    return sparse.csr_matrix((values.ravel(), (rows, columns)), shape=(size, size))


def _check_inside(path: VoxelPath, solid: VoxelSolid) -> None:
    cells = path.voxels // path.refinement
    inside: BoolArray = np.all((cells >= 0) & (cells < solid.occupancy.shape), axis=1)
    inside[inside] = solid.occupancy[tuple(cells[inside].T)]
    if not inside.all():
        step = int(inside.argmin())
        raise ValueError(
            f"voxel {step} of the path, {tuple(path.voxels[step].tolist())}, is not in the solid"
        )
