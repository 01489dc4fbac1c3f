"""A chain as a robot of modules."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ._common import Joints, Out, end, motion_in, told

if TYPE_CHECKING:
    from ..robot import Robot


def robot(
    file: Annotated[Path, typer.Argument(help="A stored folding or motion.")],
    out: Out = Path("robot"),
    pitch_mm: Annotated[float, typer.Option(help="Distance of neighbouring joints.")] = 10.0,
    gap_mm: Annotated[float, typer.Option(help="Gap between blocks that touch.")] = 0.3,
    density: Annotated[float, typer.Option(help="Kilograms a cubic metre.")] = 1130.0,
    base: Annotated[
        int | None, typer.Option(help="Piece to clamp; the middle one if none.")
    ] = None,
    joints: Joints = "free",
    gravity: Annotated[float, typer.Option(help="In m/s^2.")] = 9.81,
    move_seconds: Annotated[float, typer.Option(help="Seconds of a quarter turn.")] = 1.0,
) -> None:
    """Write a chain and its motion for robot simulators, and what they ask of actuators."""
    from ..judging import certify
    from ..robot import export_robot
    from ..solid import Folding

    stored = motion_in(file)
    motion = stored.motion if isinstance(stored, Folding) else stored
    verdict = certify(motion, motion.diameter, motion.max_bend_deg, joints=joints)
    made = export_robot(
        motion,
        out,
        pitch_mm=pitch_mm,
        gap_mm=gap_mm,
        density=density,
        base=base,
        joints=joints,
        gravity=gravity,
        move_seconds=move_seconds,
    )
    typer.echo(f"{len(motion)} moves, {told(verdict)}")
    for line in _summary(made):
        typer.echo(line)
    for written in made.files:
        typer.echo(f"written: {written}")
    end([] if verdict.ok else [told(verdict)])


def _summary(made: Robot) -> list[str]:
    """What the motion comes to, and what actuators lack."""
    survey = made.survey
    return [
        f"{survey.held_nm.size} joints, {len(survey.trajectory)} changes of angle, "
        f"{survey.trajectory.n_flips} flips, joints within {survey.deviation:.2g} pitches",
        f"{1000 * made.bodies.block_kg:.3g} g a block, clamped at piece {made.base}: "
        f"up to {survey.held_nm.max():.3g} N m to hold, {survey.moved_nm.max():.3g} N m to move",
        *(
            f"{row['actuator']}: {row['torque_per_kg']:.3g} N m/kg of the "
            f"{row['held_per_kg']:.3g} needed, enough for {row['level_blocks']} blocks straight "
            f"and level, for all at {row['largest_gravity']:.2g} m/s^2"
            for row in made.actuators.to_dict("records")
        ),
    ]
