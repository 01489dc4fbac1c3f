"""The chain as a robot: its description, its motion in joint angles, and what that asks for."""

import json
import os
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from .._record import of_kind, record
from ..grid import FloatArray, IntArray
from ..joints import JOINTS, slot_violations
from ..solid import Folding, Motion
from ..storage import write_whole
from .actuators import ACTUATORS, Actuator, comparison
from .bodies import Bodies, bodies_of
from .mjcf import mjcf
from .survey import Survey, surveyed
from .torques import GRAVITY
from .tree import Placed, checked_base, joint_name, number
from .urdf import urdf


@record
class Robot:
    """A chain as a robot, and what its motion asks of its joints.

    Attributes
    ----------
    files : tuple of Path
        What was written.
    survey : Survey
        The motion in joint angles, and torques (`robot.survey`).
    bodies : Bodies
    base : int
        The piece that is clamped.
    actuators : DataFrame
        What actuators give and what is needed (`robot.actuators.comparison`).
    """

    files: tuple[Path, ...]
    survey: Survey
    bodies: Bodies
    base: int
    actuators: pd.DataFrame


def export_robot(
    folding: Folding | Motion,
    folder: str | os.PathLike[str],
    *,
    pitch_mm: float = 10.0,
    gap_mm: float = 0.3,
    density: float = 1130.0,
    base: int | None = None,
    joints: str = "free",
    gravity: float = GRAVITY,
    substeps: int = 32,
    move_seconds: float = 1.0,
    actuator_share: float = 0.5,
    actuators: Sequence[Actuator] = ACTUATORS,
) -> Robot:
    """Write a chain and its motion for robot simulators (Section 8, Figures 2 and 19).

    Into `folder` go ``robot.urdf``, ``robot.xml`` (MuJoCo), ``trajectory.csv``, ``joints.csv`` and
    ``robot.json``, see docs/formats.md.

    Parameters
    ----------
    folding : Folding or Motion
        What it does is not judged here: see `certify`.
    pitch_mm, gap_mm, density : float
        Distance of neighbouring joints, gap between blocks that touch, kg a cubic metre.
    base : int, optional
        The piece that is clamped, 0 to the number of blocks; the middle one by default.
    joints : str
        With ``"slotted"`` the motion must keep to the slots of the printed block.
    gravity : float
        In m/s^2, downward along axis 2 of the start.
    substeps : int
        Even steps of moves that evenly changing angles do not do (PULL, most of TILT).
    move_seconds : float
        How long a quarter turn takes; limits of speed are twice that.
    actuator_share : float
        Five actuators' share of a block's mass, for the comparison with `actuators`.

    Returns
    -------
    Robot

    Raises
    ------
    ValueError
        If a number is out of range, the chain is none of whole blocks, or `joints` are slotted
        and a move is against the slots.

    Notes
    -----
    Torques are those of rest: nothing touches the ground or holds but the joints and the clamp.
    They are the largest of five moments of each move, which may miss a few per cent.

    Examples
    --------
    >>> import numpy as np, tempfile, lineup as lu
    >>> folding = lu.fold(lu.VoxelSolid(np.ones((3, 3, 2), bool)), rounds=20)
    >>> robot = lu.export_robot(folding, tempfile.mkdtemp(), pitch_mm=60.0)
    >>> [file.name for file in robot.files]
    ['robot.urdf', 'robot.xml', 'trajectory.csv', 'joints.csv', 'robot.json']
    >>> bool(robot.survey.held_nm.max() >= robot.survey.moved_nm.max() > 0)
    True
    """
    motion = _checked(folding, joints)
    _check(gravity=gravity, move_seconds=move_seconds, actuator_share=actuator_share)
    bodies = bodies_of(pitch_mm, gap_mm, density)
    base = checked_base(base, len(motion.start) // 2)
    survey = surveyed(motion, bodies, base, gravity, substeps)
    placed = Placed("robot", base, survey.origin, survey.frame, survey.trajectory.start_deg)
    told: dict[str, Any] = {
        "joints": joints,
        "limit_deg": max(90.0, motion.max_bend_deg),
        "pitch_mm": pitch_mm,
        "gap_mm": gap_mm,
        "density": density,
        "gravity": gravity,
        "move_seconds": move_seconds,
        "actuator_share": actuator_share,
    }
    needs = _needs(survey, bodies, told, actuators)
    texts = _described(survey, bodies, placed, told)
    texts["robot.json"] = _summary(motion, survey, bodies, placed, told, needs)
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    files = tuple(write_whole(place / name, text) for name, text in texts.items())
    return Robot(files, survey, bodies, base, needs)


def _checked(folding: Folding | Motion, joints: str) -> Motion:
    """The motion, once it is clear that the joints let it be made."""
    of_kind(folding, Folding, Motion)
    motion = folding.motion if isinstance(folding, Folding) else folding
    if joints not in JOINTS:
        raise ValueError(f"unknown joints {joints!r}; known: {', '.join(JOINTS)}")
    rows = slot_violations(motion).tolist() if joints == "slotted" else []
    if rows:
        move, bar = rows[0]
        raise ValueError(
            f"move {move} would twist bar {bar} in its slots; "
            "lineup.fold(solid, joints='slotted') makes no such moves"
        )
    return motion


def _needs(
    survey: Survey, bodies: Bodies, told: dict[str, Any], actuators: Sequence[Actuator]
) -> pd.DataFrame:
    """What actuators give and what is needed; notes the arms that tell."""
    gravity, share, seconds = told["gravity"], told["actuator_share"], told["move_seconds"]
    weight = bodies.block_kg * gravity * bodies.pitch_m
    held, moved = (float(most.max()) / weight for most in (survey.held_nm, survey.moved_nm))
    told["largest_held_block_pitches"], told["largest_moved_block_pitches"] = held, moved
    return comparison(held, moved, bodies.pitch_m, gravity, share, seconds, actuators)


def _described(
    survey: Survey, bodies: Bodies, placed: Placed, told: dict[str, Any]
) -> dict[str, str]:
    """The chain and its motion, by file name; speeds may be twice those of even moves."""
    most, speed = float(survey.held_nm.max()), 2 * 90 / told["move_seconds"]
    return {
        "robot.urdf": urdf(placed, bodies, told["limit_deg"], most, speed),
        **mjcf(placed, bodies, told["limit_deg"], told["gravity"]),
        "trajectory.csv": _trajectory_table(survey),
        "joints.csv": _joint_table(survey),
    }


def _check(**positive: float) -> None:
    for name, value in positive.items():
        if not (np.isfinite(value) and value > 0):
            raise ValueError(f"{name} must be a positive number, got {value}")
    if positive["actuator_share"] > 1:
        raise ValueError(f"actuator_share must be at most 1, got {positive['actuator_share']}")


def _trajectory_table(survey: Survey) -> str:
    lines = ["move,from_share,to_share,joint,from_deg,to_deg,torque_nm"]
    trajectory = survey.trajectory
    for (move, *joint), span, angles, torque in zip(
        trajectory.joints.tolist(),
        trajectory.spans.tolist(),
        trajectory.angles_deg.tolist(),
        survey.leg_nm.tolist(),
        strict=True,
    ):
        numbers = [*map(number, span), joint_name(*joint), *map(number, angles), number(torque)]
        lines.append(",".join([str(move), *numbers]))
    return "\n".join([*lines, ""])


def _joint_table(survey: Survey) -> str:
    lines = ["joint,start_deg,least_deg,most_deg,held_nm,held_move,moved_nm,moved_move"]
    columns = (
        survey.trajectory.start_deg,
        survey.least_deg,
        survey.most_deg,
        survey.held_nm,
        survey.held_at,
        survey.moved_nm,
        survey.moved_at,
    )
    for at in np.ndindex(survey.held_nm.shape):
        numbers = (number(float(column[at])) for column in columns)
        lines.append(",".join([joint_name(*at), *numbers]))
    return "\n".join([*lines, ""])


def _summary(
    motion: Motion,
    survey: Survey,
    bodies: Bodies,
    placed: Placed,
    told: dict[str, Any],
    needs: pd.DataFrame,
) -> str:
    """robot.json: the chain, the motion, and where the largest torques are."""
    n = placed.n_blocks
    content = {
        "format": "lineup-robot",
        "version": 1,
        "blocks": n,
        "base": placed.base,
        "base_position": survey.origin.tolist(),
        "base_frame": survey.frame.tolist(),
        **told,
        "chain_kg": n * bodies.block_kg,
        "bodies": asdict(bodies),
        "moves": len(motion),
        "changes": len(survey.trajectory),
        "flips": survey.trajectory.n_flips,
        "deviation": survey.deviation,
        "largest_held": _largest(survey.held_nm, survey.held_at),
        "largest_moved": _largest(survey.moved_nm, survey.moved_at),
        "actuators": needs.to_dict("records"),
    }
    return json.dumps(_short(content), indent=1) + "\n"


def _short(value: Any) -> Any:
    """Plain JSON values with numbers as in the other files."""
    if isinstance(value, dict):
        return {name: _short(part) for name, part in value.items()}
    if isinstance(value, list | tuple):
        return [_short(part) for part in value]
    if isinstance(value, float):
        return float(number(value)) if np.isfinite(value) else number(value)
    return value


def _largest(torques: FloatArray, at: IntArray) -> dict[str, Any]:
    block, axis = (int(k) for k in np.unravel_index(torques.argmax(), torques.shape))
    move = int(at[block, axis])
    return {"nm": float(torques.max()), "joint": joint_name(block, axis), "move": move}
