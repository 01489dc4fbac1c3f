"""The chain as a robot: joint angles, masses and torques, against other ways to get them."""

import itertools
import json

import numpy as np
import pytest
from chains import SOUTH, UP, chains, single, turns, walk
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from oracles import pose_bend_deg

import lineup as lu
from lineup.joints import slot_violations
from lineup.kinematics import Move
from lineup.robot import angles_at, chain_pose, joint_trajectory
from lineup.robot.actuators import ACTUATORS, Actuator, comparison
from lineup.robot.angles import stations
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
    coarse, fine = replayed(motion, 8, 16), replayed(motion, 24, 48)
    assert 1e-6 < fine < min(coarse / 2, tolerance)


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
