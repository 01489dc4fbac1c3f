"""What actuators give beside what a chain asks for: Section 8's bottleneck in numbers."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd


@dataclass(frozen=True)
class Actuator:
    """A geared motor with its electronics.

    Attributes
    ----------
    name : str
    mass_kg : float
    torque_nm : float
        At stall; makers advise a fifth of it or less for steady motion.
    speed_rpm : float
        Without load.
    """

    name: str
    mass_kg: float
    torque_nm: float
    speed_rpm: float

    def __post_init__(self) -> None:
        for name in ("mass_kg", "torque_nm", "speed_rpm"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise ValueError(f"{name} of {self.name} must be a positive number, got {value}")

    @property
    def power_w(self) -> float:
        """Most mechanical power, at half the stall torque and half the speed."""
        return self.torque_nm * self.speed_rpm * 2 * np.pi / 60 / 4


ACTUATORS = (
    Actuator("Dynamixel XL-320", 0.0167, 0.39, 114),
    Actuator("Dynamixel XL330-M288-T", 0.018, 0.52, 103),
    Actuator("Dynamixel AX-12A", 0.0546, 1.5, 59),
    Actuator("Dynamixel XH430-W350", 0.082, 3.4, 30),
)
"""Servos that modular robots are built of, by their maker's data (emanual.robotis.com)."""

PER_BLOCK = 5
"""Actuators of a block (Figure 19)."""


def comparison(
    held: float,
    moved: float,
    pitch_m: float,
    gravity: float,
    share: float,
    move_seconds: float,
    actuators: Sequence[Actuator],
) -> pd.DataFrame:
    """A row for each actuator: what it gives and what is needed, for each kilogram of it.

    Parameters
    ----------
    held, moved : float
        The largest torque to hold a joint, and to move one, in weights of a block times pitch.
    share : float
        Five actuators' share of the mass of their block.
    move_seconds : float
        A quarter turn takes so long.

    Notes
    -----
    A torque to hold or move what hangs on a joint grows as weight times length, and weight for
    weight an actuator gives the same torque whatever the pitch: so what is needed falls with the
    pitch, and with gravity. `short_held`, `short_moved` and `short_power` are how many times more
    is needed than there is; with `largest_pitch_mm` or `largest_gravity`, each alone, the first
    would be 1. A straight chain of n blocks, level and clamped in the middle, asks for some n^2 / 4
    weights of a block times pitch; `level_blocks` is the longest that an actuator holds.

    Examples
    --------
    >>> from lineup.robot.actuators import ACTUATORS, comparison
    >>> table = comparison(100.0, 50.0, 0.05, 9.81, 0.5, 1.0, ACTUATORS)
    >>> table.loc[0, ["torque_per_kg", "held_per_kg"]].round(1).tolist()
    [23.4, 490.5]
    """
    turn = np.pi / 2 / move_seconds
    unit = gravity * pitch_m * PER_BLOCK / share
    needs = held * unit, moved * unit
    rows = []
    for actuator in actuators:
        per_kg = actuator.torque_nm / actuator.mass_kg
        power = actuator.power_w / actuator.mass_kg
        rows.append(
            {
                "actuator": actuator.name,
                "torque_per_kg": per_kg,
                "held_per_kg": needs[0],
                "moved_per_kg": needs[1],
                "power_per_kg": power,
                "moved_power_per_kg": needs[1] * turn,
                "short_held": needs[0] / per_kg,
                "short_moved": needs[1] / per_kg,
                "short_power": needs[1] * turn / power,
                "largest_pitch_mm": 1000 * pitch_m * per_kg / needs[0] if held else np.inf,
                "largest_gravity": gravity * per_kg / needs[0] if held else np.inf,
                "level_blocks": int(2 * np.sqrt(per_kg / unit)),
            }
        )
    return pd.DataFrame(rows)
