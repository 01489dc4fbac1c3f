"""Tasks for the tests of sweeps: quick ones that succeed, fail or take their process down."""

import ctypes
import os
import time
from pathlib import Path

import numpy as np

import lineup as lu

CALLS = "LINEUP_TEST_CALLS"
"""Environment variable naming the file that every call is noted in."""

PAUSE = 0.3
"""Seconds that a slow call takes, so that others come and go, or an end comes, meanwhile."""


def work(model: str, blocks: int, seed: int = 0, *, folder: Path, progress) -> dict:
    with open(os.environ[CALLS], "a") as calls:
        calls.write(f"{model}-{blocks}\n")
    progress("folding")
    if model == "refused":
        raise ValueError("blocks must\nbe positive")
    if model == "broken":
        raise RuntimeError("no good")
    if model == "crash":
        ctypes.string_at(0)  # reads where nothing is
    if model == "abort":
        os.abort()
    if model == "gone":
        os._exit(3)
    if model == "interrupt":
        raise KeyboardInterrupt
    if model == "slow":
        time.sleep(PAUSE)
    if model == "endless":
        time.sleep(3600)
    (folder / f"{model}.txt").write_text("saved")
    return {"voxels": blocks * 2, "length": 2 * blocks + seed}


def table2_task(model: str, blocks: int, seed: int, *, folder: Path, progress) -> dict:
    from lineup.kinematics import Move  # slow to import, and the other task has no use for it

    progress("fold")
    if model == "cannon":
        raise ValueError("no such mesh")
    path = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (1, 2, 0)])
    motion = lu.Motion(path, np.array([(Move.SWING, 1, 2, 0)]), 0.999, 90.0, True, "straight")
    lu.save(lu.Folding(lu.VoxelPath(path), motion), folder / f"{model}.folding.json")
    return {
        "voxels": 4,
        "source": "procedural",
        "length": 2 * blocks - 2 * (model == "duck"),
        "straight": True,
        "certified": True,
        "seconds_fold": 0.5,
    }
