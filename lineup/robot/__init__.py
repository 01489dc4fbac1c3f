"""The chain as a robot of modules: joints, motion, masses and torques (Sections 7 and 8)."""

from .trajectory import Trajectory, angles_at, chain_pose, joint_trajectory

__all__ = ["Trajectory", "angles_at", "chain_pose", "joint_trajectory"]
