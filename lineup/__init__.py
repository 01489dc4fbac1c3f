"""LineUp: computing chain-based physical transformation, step by step.

Every public name is here; each is imported when it is first used.
"""

from importlib import import_module
from typing import Any

_HOME = {
    "VoxelSolid": "solid",
    "VoxelPath": "solid",
    "Motion": "solid",
    "Obstacles": "solid",
    "Folding": "solid",
    "Certificate": "solid",
    "Design": "solid",
    "frames": "kinematics",
    "JointWord": "words",
    "joint_word": "words",
    "forward": "words",
    "certify": "judging",
    "certify_path": "judging",
    "voxelize": "voxelization",
    "mend": "voxelization",
    "models": "catalog",
    "model": "catalog",
    "reeb_graph": "reeb",
    "traverse": "reeb",
    "refine": "refinement",
    "audit": "assumptions",
    "audit_summary": "assumptions",
    "algorithm3": "paper",
    "layered_path": "layered",
    "PATH_METHODS": "layered",
    "planar_path": "planar",
    "PLANAR_METHODS": "planar",
    "PlanarPath": "planar",
    "path_bound": "bounds",
    "unfold": "motion",
    "MOTION_METHODS": "motion",
    "fold": "folding",
    "FOLD_METHODS": "folding",
    "trim": "trimming",
    "TRIM_METHODS": "trimming",
    "transform": "transformation",
    "through_tube": "scenarios",
    "into_capsule": "scenarios",
    "strength": "stress",
    "standing": "stress",
    "Strength": "stress",
    "Bonding": "stress",
    "Block": "block",
    "BLOCKS": "block",
    "check_block": "block",
    "export_print": "fabrication",
    "write_manual": "manual",
    "manual_pages": "manual",
    "read_manual": "manual",
    "standing_by_step": "manual",
    "export_robot": "robot",
    "Robot": "robot",
    "save": "storage",
    "load": "storage",
    "write_player": "viewer",
    "player": "viewer",
    "rank_orientations": "orientation",
    "appearance": "looks",
    "shell": "shells",
    "lineup": "pipeline",
    "add": "pipeline",
}

__all__ = sorted(_HOME)


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'lineup' has no attribute {name!r}")
    value = getattr(import_module(f".{_HOME[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
