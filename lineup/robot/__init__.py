"""The chain as a robot of modules: joints, motion, masses and torques (Sections 7 and 8)."""

from .export import Robot, export_robot
from .trajectory import Trajectory, angles_at, chain_pose, joint_trajectory

__all__ = [
    "Robot",
    "Trajectory",
    "angles_at",
    "chain_pose",
    "export_robot",
    "joint_trajectory",
]
