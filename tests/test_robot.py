"""The chain as a robot: joint angles, masses and torques, against other ways to get them."""

import csv
import itertools
import json
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from chains import SOUTH, UP, chains, single, turns, walk
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from oracles import pose_bend_deg

import lineup as lu
from lineup.cli import run
from lineup.joints import slot_violations
from lineup.kinematics import Move
from lineup.robot import angles_at, chain_pose, joint_trajectory, mjcf
from lineup.robot.actuators import ACTUATORS, Actuator, comparison
from lineup.robot.angles import AXES, stations
from lineup.robot.bodies import BALL, BAR, bodies_of, masses
from lineup.robot.torques import gravity_torques
from lineup.robot.tree import base_joint, joint_name

Y1, Z1, X, Y2, Z2 = range(5)
ORIGIN, EYE = np.zeros(3), np.eye(3)
BODIES = bodies_of(10.0, 0.3, 1130.0)


def even(voxels):
    return voxels[: len(voxels) - len(voxels) % 2]


def congruent(pose, other):
    """Largest distance of two poses once one is turned and shifted onto the other."""
    centred, there = pose - pose.mean(axis=0), other - other.mean(axis=0)
    u, _, v = np.linalg.svd(there.T @ centred)
    turn = u @ np.diag([1, 1, np.sign(np.linalg.det(u @ v))]) @ v  # no mirroring
    return np.abs(centred @ turn.T - there).max()


def replayed(motion, substeps, looks):
    """Largest distance from the motion of what its angles do, at so many looks a move."""
    trajectory = joint_trajectory(motion, substeps)
    times = [k + s / looks for k in range(len(motion)) for s in range(looks)] + [len(motion)]
    poses = lu.frames(motion, substeps=looks)
    apart = [
        congruent(chain_pose(angles, ORIGIN, EYE)[0], pose)
        for angles, pose in zip(angles_at(trajectory, times), poses, strict=True)
    ]
    return max(apart)


@pytest.fixture(scope="module")
def foldings():
    box = lu.VoxelSolid(np.ones((3, 3, 4), bool))
    return {
        joints: lu.fold(box, joints=joints, rounds=100, trial_rounds=20)
        for joints in ("free", "slotted")
    }


MOTIONS = {
    "limbs": lu.unfold(lu.VoxelPath(walk("DWNEEUESUWWSWDEDENU")), "peel"),
    "flat tilt": lu.unfold(lu.VoxelPath(walk("ENENENE")), "accordion"),
    "bends": lu.unfold(lu.layered_path(lu.VoxelSolid(np.ones((3, 2, 2), bool))), "barrier"),
}


@pytest.mark.parametrize("name", [*MOTIONS, "free", "slotted"])
def test_angles_that_change_evenly_do_what_the_moves_do(name, foldings):
    motion = MOTIONS[name] if name in MOTIONS else foldings[name].motion
    assert motion.straight
    assert replayed(motion, 1, 3) < 1e-9
    for angles in angles_at(joint_trajectory(motion), [len(motion)]):
        assert_allclose(angles[:, [Y1, Z1, Y2, Z2]], 0, atol=1e-9)


@given(chains(), st.data())
@settings(max_examples=30)
def test_single_turns_are_exact_and_bend_in_two_planes_just_if_they_twist(start, data):
    start = even(start)
    rows = turns(start)
    assume(rows)
    trial = single(start, data.draw(st.sampled_from(rows)))
    assume(max(map(pose_bend_deg, lu.frames(trial))) < 91)
    assert replayed(trial, 1, 5) < 1e-9
    trajectory = joint_trajectory(trial)
    oblique = 0.0
    for angles in angles_at(trajectory, [0, 0.5, 1]):
        bends = np.abs(angles[:, [[Y1, Z1], [Y2, Z2]]])
        oblique = max(oblique, bends.min(axis=2).max())
        assert bends.max() <= 90
    twists = len(slot_violations(trial)) > 0
    assert (oblique > 0 or trajectory.n_flips > 0) == twists


@pytest.mark.parametrize(
    ("motion", "tolerance"),
    [
        (lu.unfold(lu.VoxelPath(walk("ENUENNUEE")), "accordion"), 2e-3),
        (lu.unfold(lu.VoxelPath(walk("EENUWSWUNEE")), "pull"), 0.1),
    ],
)
def test_other_moves_are_met_at_each_step_and_neared_between(motion, tolerance):
    assert motion.straight
    assert replayed(motion, 8, 8) < 1e-8
    assert 1e-6 < replayed(motion, 32, 64) < tolerance
    assert replayed(motion, 64, 128) < replayed(motion, 8, 16)


def test_slotted_motions_bend_each_ball_in_one_plane_and_nothing_flips(foldings):
    free, slotted = (joint_trajectory(foldings[j].motion) for j in ("free", "slotted"))
    assert free.n_flips > 0 == slotted.n_flips
    n_moves = len(foldings["slotted"].motion)
    for angles in angles_at(slotted, np.arange(0, n_moves, 0.25)):
        assert np.abs(angles[:, [[Y1, Z1], [Y2, Z2]]]).min(axis=2).max() == 0
        assert np.abs(angles[:, [Y1, Z1, Y2, Z2]]).max() <= 90


@pytest.mark.parametrize("joints", ["free", "slotted"])
def test_changes_follow_each_other(foldings, joints):
    trajectory = joint_trajectory(foldings[joints].motion)
    angles = trajectory.start_deg.copy()
    ends = trajectory.joints[:, 0] + trajectory.spans[:, 1]
    assert (np.diff(ends) >= 0).all()
    assert (trajectory.spans[:, 0] <= trajectory.spans[:, 1]).all()
    for (_, *joint), (first, last) in zip(
        trajectory.joints.tolist(), trajectory.angles_deg.tolist(), strict=True
    ):
        assert angles[tuple(joint)] == first != last
        angles[tuple(joint)] = last
    moves = foldings[joints].motion.moves[:, 0]
    moving = trajectory.spans[:, 0] < trajectory.spans[:, 1]
    per_move = np.bincount(trajectory.joints[moving, 0], minlength=len(moves))
    assert set(per_move[moves == Move.PEEL]) <= {1, 2}
    assert set(per_move[moves == Move.SWING]) <= {1}


SPUN = {
    "a straight capsule goes along, and the hinge behind it twists": ("EENNN", UP, ["b0_x"]),
    "a bent one stays, and the hinge slides round": ("NEUUU", SOUTH, ["b1_z1"]),
    "at a pole it flips before": ("NENNN", UP, ["b1_y1", "b1_x", "b1_z1"]),
}


@pytest.mark.parametrize("name", SPUN)
def test_a_hinge_turns_about_the_capsule_beside_it(name):
    word, value, expected = SPUN[name]
    swing = single(walk(word), (Move.SWING, 2, 3, value))
    trajectory = joint_trajectory(swing)
    assert [joint_name(*at) for at in trajectory.joints[:, 1:].tolist()] == expected
    assert_array_equal(np.abs(np.diff(trajectory.angles_deg, axis=1)), 90)
    assert len(slot_violations(swing)) == (len(expected) > 1 or expected == ["b1_z1"])
    assert replayed(swing, 1, 5) < 1e-9


# Masses -------------------------------------------------------------------------------------------


def moments(inside, a, r, step):
    """Volume, centre along x and moments about x and across, of points that are inside."""
    x = np.arange(-a - r + step / 2, a + r, step)
    y = np.arange(-r + step / 2, r, step)
    x, y, z = (
        c[inside(*np.meshgrid(x, y, y, indexing="ij"))] for c in np.meshgrid(x, y, y, indexing="ij")
    )
    volume, centre = len(x) * step**3, x.mean()
    along, across = (y**2 + z**2).mean(), ((x - centre) ** 2 + y**2).mean()
    return volume, centre, volume * along, volume * across


def test_masses_and_moments_are_those_of_points_inside():
    bodies = bodies_of(60.0, 4.0, 1200.0)
    a, r, step = 0.06, 0.028, 0.001
    ball, bar = BALL * a / 2, BAR * a / 2

    def capsule(x, y, z):
        return np.hypot(np.maximum(np.abs(x) - a / 2, 0), np.hypot(y, z)) < r

    def end(x, y, z):
        return (np.hypot(np.minimum(x, 0), np.hypot(y, z)) < r) & (x < a / 2)

    def hinge(x, y, z):
        from_axis = np.hypot(y, z)
        in_ball = np.hypot(np.abs(x) - a / 2, from_axis) < ball
        return in_ball | ((from_axis < bar) & (np.abs(x) < a / 2 - ball))

    volume, _, *found = moments(capsule, a, r, step)
    share = bodies.capsule_kg / (1200 * volume)
    assert bodies.block_kg == pytest.approx(1200 * volume, rel=5e-3)
    assert_allclose(bodies.capsule_kgm2, 1200 * share * np.array(found), rtol=1e-2)
    volume, centre, *found = moments(end, a, r, step)
    assert bodies.end_kg == pytest.approx(1200 * share * volume, rel=5e-3)
    assert bodies.end_com_m == pytest.approx(centre, rel=5e-3)
    assert_allclose(bodies.end_kgm2, 1200 * share * np.array(found), rtol=1e-2)
    volume, _, *found = moments(hinge, a, ball, step / 2)
    assert bodies.hinge_kg == pytest.approx(1200 * volume, rel=1e-2)
    assert_allclose(bodies.hinge_kgm2, 1200 * np.array(found), rtol=2e-2)
    assert masses(5, bodies).sum() == pytest.approx(5 * bodies.block_kg)


# Torques ------------------------------------------------------------------------------------------


def potential(angles, base, there, gravity):
    """Potential energy in J of a chain with one piece held where it is in a pose."""
    pose, pieces = chain_pose(angles, ORIGIN, EYE)
    joint = base_joint(len(angles), base)
    turn = there.pieces[base] @ pieces[base].T
    at = ((pose - pose[joint]) @ turn.T + there.pose[joint]) * BODIES.pitch_m
    first, last = turn @ pieces[0][:, 0], turn @ pieces[-1][:, 0]
    middles = (at[1:] + at[:-1]) / 2
    com = BODIES.end_com_m
    centres = np.vstack([at[0] - com * first, middles, at[-1] + com * last])
    return -(masses(len(angles), BODIES) * (centres @ gravity)).sum()


@pytest.mark.parametrize("base", [0, 1, 4, 10])
def test_torques_are_slopes_of_the_potential(base):
    gravity = np.array([1.0, -2.0, -9.0])
    for station in itertools.islice(stations(MOTIONS["limbs"], 4), 0, 60, 7):
        found = gravity_torques(station.pose, station.pieces, station.angles, BODIES, base, gravity)
        for at in np.ndindex(found.shape):
            step = np.zeros(found.shape)
            step[at] = np.degrees(1e-4)
            up, down = (
                potential(station.angles + s * step, base, station, gravity) for s in (1, -1)
            )
            assert found[at] == pytest.approx((up - down) / 2e-4, abs=1e-9)


def test_a_level_chain_asks_for_a_quarter_of_its_blocks_squared(tmp_path):
    start = walk("E" * 79)
    motion = lu.Motion(start, np.empty((0, 4), int), 1.0, 90.0, True, "straight")
    robot = lu.export_robot(motion, tmp_path)
    most = robot.survey.held_nm.max() / (BODIES.block_kg * 9.81 * BODIES.pitch_m)
    assert most == pytest.approx(40**2 / 4, rel=0.03)
    arms = [*(k + 0.5 for k in range(39)), 39 + BODIES.end_com_m / BODIES.pitch_m]
    assert most == pytest.approx(masses(20, BODIES)[1:] @ arms / BODIES.block_kg)
    assert robot.survey.moved_nm.max() == 0
    weight = BODIES.block_kg * 9.81 * BODIES.pitch_m
    held = robot.survey.held_nm / weight
    assert held[:, X].max() < 1e-9  # nothing twists a level straight chain
    assert np.minimum(held[:, Y1], held[:, Z1]).max() < 1e-9
    upright = lu.Motion(start[:, [2, 1, 0]], motion.moves, 1.0, 90.0, True, "straight")
    assert lu.export_robot(upright, tmp_path).survey.held_nm.max() == 0
    told = json.loads((tmp_path / "robot.json").read_text())
    assert told["actuators"][0]["largest_pitch_mm"] == "inf"


def test_what_is_needed_grows_with_pitch_and_gravity_and_not_with_density(foldings, tmp_path):
    def short(**options):
        made = lu.export_robot(foldings["slotted"], tmp_path, gap_mm=0.0, **options)
        return made.actuators["short_held"].to_numpy()

    one = short()
    assert_allclose(short(pitch_mm=40.0), 4 * one)
    assert_allclose(short(gravity=1.62), 1.62 / 9.81 * one)
    assert_allclose(short(density=2260.0), one)
    assert_allclose(short(actuator_share=1.0), one / 2)


def test_actuators_by_hand():
    motor = Actuator("motor", 0.1, 2.0, 60.0)
    (row,) = comparison(50.0, 25.0, 0.1, 10.0, 0.5, 2.0, [motor]).to_dict("records")
    assert row["torque_per_kg"] == 20
    assert row["held_per_kg"] == 50 * 10 * 0.1 * 5 / 0.5
    assert (row["short_held"], row["short_moved"]) == (25, 12.5)
    assert row["power_per_kg"] == pytest.approx(np.pi * 10)
    assert row["short_power"] == pytest.approx(250 * np.pi / 4 / (np.pi * 10))
    assert row["largest_pitch_mm"] == pytest.approx(4)
    assert row["largest_gravity"] == pytest.approx(0.4)
    per_block = 10 * 0.1 * 5 / 0.5
    n = row["level_blocks"]
    assert n**2 / 4 * per_block <= 20 < (n + 1) ** 2 / 4 * per_block
    assert {a.name for a in ACTUATORS} >= {"Dynamixel XL-320"}


# Files --------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def mujoco():
    return pytest.importorskip("mujoco")


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
