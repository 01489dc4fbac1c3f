"""What a chain is written as for robot simulators, read by MuJoCo and by hand."""

import csv
import itertools
import json
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from chains import walk
from numpy.testing import assert_allclose, assert_array_equal
from test_robot import BODIES, Z1, Z2, congruent, foldings

import lineup as lu
from lineup.cli import run
from lineup.joints import slot_violations
from lineup.robot import mjcf
from lineup.robot.actuators import Actuator
from lineup.robot.angles import AXES, stations
from lineup.robot.torques import gravity_torques
from lineup.robot.tree import base_joint, joint_name

__all__ = ["foldings"]  # the fixture


@pytest.fixture(scope="module")
def mujoco():
    """MuJoCo, whose warnings do not go to a file where the tests are run."""
    module = pytest.importorskip("mujoco")
    module.set_mju_user_warning(lambda message: None)
    yield module
    module.set_mju_user_warning(None)


class Simulated:
    """A model that MuJoCo has read, and its state."""

    def __init__(self, mujoco, file):
        self.mujoco = mujoco
        self.model = mujoco.MjModel.from_xml_path(str(file))
        self.data = mujoco.MjData(self.model)
        joints = (self.model.joint(k) for k in range(self.model.njnt))
        self.place = {joint.name: int(joint.qposadr[0]) for joint in joints}

    def put(self, angles):
        for at in np.ndindex(angles.shape):
            self.data.qpos[self.place[joint_name(*at)]] = np.radians(angles[at])
        self.mujoco.mj_kinematics(self.model, self.data)

    def joints(self, n, base, pitch):
        """Positions in pitches of all joints but the one or two of the base."""
        found = np.full((2 * n, 3), np.nan)
        for i in range(n):
            found[2 * i if i >= base else 2 * i + 1] = self.data.body(f"hinge{i}").xpos / pitch
        for i in set(range(n + 1)) - {base}:
            found[2 * i - 1 if i > base else 2 * i] = self.data.body(f"piece{i}").xpos / pitch
        return found

    def torques(self, n):
        """qfrc_bias at rest, which is gravity's, by joint."""
        self.data.qvel[:] = 0
        self.mujoco.mj_comPos(self.model, self.data)
        self.mujoco.mj_fwdVelocity(self.model, self.data)
        bias = [self.data.qfrc_bias[self.place[joint_name(*at)]] for at in np.ndindex(n, 5)]
        return np.reshape(bias, (n, 5))


@pytest.mark.parametrize("file", ["robot.xml", "robot.urdf"])
@pytest.mark.parametrize("base", [0, 2, None, 18])
@pytest.mark.parametrize("joints", ["free", "slotted"])
def test_mujoco_agrees_on_positions_and_torques(file, base, joints, foldings, mujoco, tmp_path):
    motion = foldings[joints].motion
    robot = lu.export_robot(motion, tmp_path, base=base, pitch_mm=50.0)
    n, base, pitch = len(motion.start) // 2, robot.base, robot.bodies.pitch_m
    simulated = Simulated(mujoco, tmp_path / file)
    assert simulated.model.nq == simulated.model.nv == 5 * n
    origin = base_joint(n, base)
    slivers = 1e-4 if file == "robot.urdf" else 1e-9
    for station in itertools.islice(stations(motion, 4), 0, None, 5):
        simulated.put(station.angles)
        turn = robot.survey.frame @ station.pieces[base].T  # the base is clamped
        pose = (station.pose - station.pose[origin]) @ turn.T + robot.survey.origin
        found = simulated.joints(n, base, pitch)
        seen = ~np.isnan(found[:, 0])
        assert seen.sum() >= 2 * n - 2
        assert_allclose(found[seen], pose[seen], atol=1e-6)
        ours = gravity_torques(
            station.pose,
            station.pieces,
            station.angles,
            robot.bodies,
            base,
            turn.T @ np.array((0, 0, -9.81)),
        )
        assert_allclose(simulated.torques(n), ours, atol=slivers * ours.max() + 1e-7)
        assert (np.abs(ours) <= robot.survey.held_nm + 1e-9).all()


def test_the_table_of_the_trajectory_moves_the_model_as_the_motion(foldings, mujoco, tmp_path):
    """From the files alone, and against the frames themselves."""
    motion = foldings["slotted"].motion
    poses = list(lu.frames(motion))
    base = lu.export_robot(motion, tmp_path).base
    simulated = Simulated(mujoco, tmp_path / "robot.xml")
    mujoco.mj_resetDataKeyframe(simulated.model, simulated.data, 0)
    rows = list(csv.DictReader((tmp_path / "trajectory.csv").open()))
    n = len(motion.start) // 2
    for move in range(-1, len(motion)):
        for row in (r for r in rows if int(r["move"]) == move):
            at = simulated.place[row["joint"]]
            assert simulated.data.qpos[at] == pytest.approx(np.radians(float(row["from_deg"])))
            simulated.data.qpos[at] = np.radians(float(row["to_deg"]))
        mujoco.mj_kinematics(simulated.model, simulated.data)
        found = simulated.joints(n, base, 0.01)
        seen = ~np.isnan(found[:, 0])
        assert congruent(found[seen], poses[move + 1][seen]) < 1e-6
        if move < 0:
            assert_allclose(found[seen], poses[0][seen], atol=1e-6)


def test_bodies_touch_just_where_the_chain_would(foldings, mujoco, tmp_path):
    folding = foldings["slotted"]
    lu.export_robot(folding, tmp_path)
    simulated = Simulated(mujoco, tmp_path / "robot.xml")
    mujoco.mj_resetDataKeyframe(simulated.model, simulated.data, 0)
    mujoco.mj_forward(simulated.model, simulated.data)
    assert simulated.data.ncon == 0
    angles = np.zeros((len(folding.path) // 2, 5))
    angles[3:6, Z2] = 90  # a square, closed on itself
    angles[4:6, Z1] = 90
    simulated.put(angles)
    mujoco.mj_collision(simulated.model, simulated.data)
    assert simulated.data.ncon > 0


def test_a_long_chain_is_several_files_that_make_one_model(foldings, mujoco, tmp_path, monkeypatch):
    folding = foldings["slotted"]
    lu.export_robot(folding, tmp_path / "one")
    monkeypatch.setattr(mjcf, "NESTED", 7)
    robot = lu.export_robot(folding, tmp_path / "many")
    parts = {file.name for file in robot.files if file.suffix == ".xml"}
    assert len(parts) == 1 + 2 * 2
    one, many = (Simulated(mujoco, tmp_path / k / "robot.xml") for k in ("one", "many"))
    assert one.place == many.place
    n = len(folding.path) // 2
    for simulated in (one, many):
        mujoco.mj_resetDataKeyframe(simulated.model, simulated.data, 0)
        mujoco.mj_kinematics(simulated.model, simulated.data)
    assert_array_equal(one.joints(n, robot.base, 0.01), many.joints(n, robot.base, 0.01))
    assert_array_equal(one.torques(n), many.torques(n))


def test_the_description_is_a_tree_of_five_joints_a_block(foldings, tmp_path):
    folding = foldings["free"]
    lu.export_robot(folding, tmp_path)
    root = ET.parse(tmp_path / "robot.urdf").getroot()
    n = len(folding.path) // 2
    links = {link.get("name") for link in root.findall("link")}
    joints = root.findall("joint")
    children = [joint.find("child").get("link") for joint in joints]
    assert len(set(children)) == len(children) == len(links) - 1
    assert links - set(children) == {"world"}
    assert {joint.find("parent").get("link") for joint in joints} <= links
    kinds = {joint.get("name"): joint.get("type") for joint in joints}
    assert kinds.pop("clamp") == "fixed"
    expected = {f"b{i}_{axis}" for i in range(n) for axis in AXES}
    assert set(kinds) == expected
    for joint in joints:
        limit = joint.find("limit")
        if joint.get("type") == "revolute":
            assert float(limit.get("upper")) == -float(limit.get("lower"))
            assert float(limit.get("upper")) == pytest.approx(np.pi / 2)
    assert {name.split("_")[1] for name, kind in kinds.items() if kind == "continuous"} == {"x"}
    weights = [float(m.get("value")) for m in root.iter("mass")]
    assert sum(weights) == pytest.approx(n * BODIES.block_kg, rel=1e-5)


def test_the_summary_names_the_largest_torques_and_equal_runs_give_equal_bytes(foldings, tmp_path):
    robots = [lu.export_robot(foldings["free"], tmp_path / k) for k in "ab"]
    for first, second in zip(robots[0].files, robots[1].files, strict=True):
        assert first.read_bytes() == second.read_bytes()
    survey = robots[0].survey
    told = json.loads((tmp_path / "a" / "robot.json").read_text())
    block, axis = np.unravel_index(survey.held_nm.argmax(), survey.held_nm.shape)
    assert told["largest_held"]["joint"] == joint_name(block, axis)
    assert told["largest_held"]["move"] == survey.held_at.max(
        initial=-1, where=survey.held_nm == survey.held_nm.max()
    )
    assert told["flips"] == survey.trajectory.n_flips > 0
    assert told["deviation"] == 0
    table = list(csv.DictReader((tmp_path / "a" / "joints.csv").open()))
    assert len(table) == survey.held_nm.size
    assert max(float(r["held_nm"]) for r in table) == pytest.approx(told["largest_held"]["nm"])
    rows = list(csv.DictReader((tmp_path / "a" / "trajectory.csv").open()))
    assert max(float(r["torque_nm"]) for r in rows) == pytest.approx(told["largest_moved"]["nm"])


def test_slotted_joints_are_asked_for_and_refused(foldings, tmp_path):
    lu.export_robot(foldings["slotted"], tmp_path, joints="slotted")
    move, bar = slot_violations(foldings["free"].motion)[0]
    with pytest.raises(ValueError, match=f"move {move} would twist bar {bar} in its slots"):
        lu.export_robot(foldings["free"], tmp_path, joints="slotted")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"pitch_mm": 0.0}, "pitch_mm must be a positive number, got 0.0"),
        ({"density": float("nan")}, "density must be a positive number"),
        ({"gap_mm": 5.0}, "gap_mm must be from 0 to below half of 10.0"),
        ({"base": 19}, "base must be a piece from 0 to 18, got 19"),
        ({"joints": "ball"}, "unknown joints 'ball'; known: free, slotted"),
        ({"gravity": -1.0}, "gravity must be a positive number"),
        ({"move_seconds": 0.0}, "move_seconds must be a positive number"),
        ({"actuator_share": 1.5}, "actuator_share must be at most 1"),
        ({"substeps": 0}, "substeps must be at least 1, got 0"),
    ],
)
def test_bad_options_are_refused(options, message, foldings, tmp_path):
    with pytest.raises(ValueError, match=message):
        lu.export_robot(foldings["free"], tmp_path / "out", **options)
    assert not (tmp_path / "out").exists()


def test_half_a_block_and_bad_actuators_are_refused(tmp_path):
    odd = lu.Motion(walk("EE"), np.empty((0, 4), int), 1.0, 90.0, True, "straight")
    with pytest.raises(ValueError, match="even number of them, got 3"):
        lu.export_robot(odd, tmp_path)
    with pytest.raises(ValueError, match="torque_nm of motor must be a positive number, got 0"):
        Actuator("motor", 1.0, 0, 1.0)


def test_the_command_writes_what_it_says(foldings, tmp_path, capsys):
    file = lu.save(foldings["slotted"], tmp_path / "box.folding.json")
    code = run(["robot", str(file), "--out", str(tmp_path / "out"), "--joints", "slotted"])
    told = capsys.readouterr().out
    assert code == 0
    assert "certified" in told
    assert "0 flips" in told
    assert all((tmp_path / "out" / name).is_file() for name in ("robot.urdf", "trajectory.csv"))
    free = lu.save(foldings["free"], tmp_path / "free.folding.json")
    assert run(["robot", str(free), "--out", str(tmp_path / "out"), "--joints", "slotted"]) == 2
    assert "would twist" in capsys.readouterr().err
