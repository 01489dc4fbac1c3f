"""The printable block: its measures, its parts, and that the checks see what is wrong."""

import re
from dataclasses import replace
from itertools import product
from types import SimpleNamespace

import igl
import numpy as np
import pytest
import trimesh
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from manifold3d import Manifold
from oracles import segment_distances
from scipy.spatial.transform import Rotation

import lineup as lu
from lineup.block import BLOCKS, Block, block_parts, check_parts, scaled, solids
from lineup.block import checks as judge
from lineup.block.parameters import swivel
from lineup.block.parts import part_of, slot_half_width_mm
from lineup.block.strength import opening_mm

PAPER = Block()
DRAFT = Block(segments=24)


@pytest.fixture(scope="module")
def reports():
    return {name: lu.check_block(replace(b, segments=24)) for name, b in BLOCKS.items()}


def mesh_of(part):
    return trimesh.Trimesh(part.vertices, part.faces, process=False)


# Measures.


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"pitch_mm": 4.0}, "pitch_mm must be from 5 to 200 mm here, got 4; print larger voxels"),
        ({"pitch_mm": float("nan")}, "pitch_mm must be from 5 to 200 mm here, got nan"),
        ({"gap_mm": 0.0}, "gap_mm must be from 0.25 to 2.5 mm here, got 0"),
        ({"clearance_mm": 0.01}, "clearance_mm must be from 0.05 to 0.5 mm here"),
        ({"bar_mm": 5.0}, "bar_mm must be from 0.8 to 4.6"),
        ({"ball_mm": 4.5}, "ball_mm must be from 4.623 to 7.6 mm here, got 4.5; a smaller ball"),
        ({"ball_mm": 8.0}, "a larger one breaks through its shell"),
        ({"snap_mm": 0.6}, "snap_mm must be from -0.25 to 0.4333 mm here"),
        ({"bend_deg": 130.0}, "bend_deg must be from 90 to 120 deg here"),
        ({"bend_deg": 120.0}, "gap_mm must be from 1.34 to 2.5 mm here, got 0.3"),
        ({"segments": 12}, "segments must be from 24 to 256 sides here"),
        ({"segments": 30}, "multiple of 4"),
        ({"swivel": True, "ball_mm": 6.0}, "a swivel needs more room between two sockets"),
    ],
)
def test_a_measure_out_of_its_range_is_refused_with_a_reason(wrong, says):
    with pytest.raises(ValueError, match=re.escape(says)) as error:
        Block(**wrong)
    assert "\n" not in str(error.value)


def test_the_ends_of_a_range_are_in_it():
    Block(ball_mm=7.6)
    Block(snap_mm=-0.25)
    Block(snap_mm=2.6 / 6)


def test_a_block_grows_with_the_pitch_but_for_clearance():
    large = scaled(PAPER, 20.0)
    assert large == Block(20.0, 0.6, 10.0, 5.2, 0.25, 0.2)
    assert scaled(large, 10.0) == PAPER
    assert large.diameter == PAPER.diameter
    assert scaled(BLOCKS["pull"], 20.0).snap_mm == -0.25
    small = scaled(PAPER, 6.0)
    assert small.gap_mm == 0.25
    assert small.ball_mm > 0.5 * 6
    with pytest.raises(ValueError, match="positive number, got -1"):
        scaled(PAPER, -1.0)
    with pytest.raises(ValueError, match="larger pitch_mm"):
        scaled(PAPER, 5.0)


@st.composite
def blocks(draw):
    """Blocks anywhere in the ranges: each measure is drawn from what those before it leave."""
    share = st.floats(0.02, 0.98)
    pitch = draw(st.floats(6.0, 30.0))
    bend = draw(st.sampled_from([90.0, 90.0, 105.0, 120.0]))
    clearance = 0.05 + draw(share) * min(pitch / 20 - 0.05, 0.4)
    least = max(clearance, pitch * (1 - np.sin(np.deg2rad(bend))))
    gap = least + draw(share) * (pitch / 4 - least)
    radius = (pitch - gap) / 2
    largest = 2 * (radius - 0.8 - clearance)
    thickest = (0.97 * largest - 0.1) / np.sqrt(2) - 2 * clearance
    assume(thickest > 0.8)
    bar = 0.8 + draw(share) * (thickest - 0.8)
    least = (np.sqrt(2) * (bar + 2 * clearance) + 0.1) / 0.97
    ball = least + draw(share) * (largest - least)
    snap = -clearance + draw(share) * (bar / 6 + clearance)
    try:
        return Block(pitch, gap, ball, bar, clearance, snap, bend, draw(st.booleans()), 24)
    except ValueError as error:
        assume("swivel" not in str(error))  # it is the only range that is not drawn from
        raise


@given(blocks())
@settings(max_examples=3)
def test_every_block_within_the_ranges_is_printable(block):
    assert lu.check_block(block).reason == "printable"


@pytest.mark.slow
@given(blocks())
@settings(max_examples=150)
def test_every_block_within_the_ranges_is_printable_at_length(block):
    assert lu.check_block(block).reason == "printable"


# The blocks as they are.


@pytest.mark.parametrize("name", sorted(BLOCKS))
def test_the_blocks_pass(reports, name):
    report = reports[name]
    assert report.reason == "printable"
    assert report.overlap_mm3 == 0
    assert report.gap_mm == pytest.approx(0.25, abs=0.002)
    assert report.play_mm < BLOCKS[name].ball_mm / 4
    assert report.poses == (40 if BLOCKS[name].swivel else 25)


def test_only_the_papers_block_snaps(reports):
    assert reports["standard"].snap_mm3 > 0.1
    assert reports["pull"].snap_mm3 == reports["pull120"].snap_mm3 == 0
    harder = replace(PAPER, snap_mm=0.2)
    snap = judge._overlap(judge._ways(solids(harder), harder))
    assert snap > 2 * reports["standard"].snap_mm3


def test_the_other_blocks_are_thin_and_bend_as_pulls_ask():
    assert BLOCKS["pull"].diameter <= np.sqrt(2) - 0.5
    assert BLOCKS["pull120"].diameter <= np.sqrt(3) / 2
    assert BLOCKS["pull120"].bend_deg == 120


@pytest.mark.parametrize("name", sorted(BLOCKS))
def test_every_part_is_one_closed_body_without_handles(name):
    for part in block_parts(BLOCKS[name]).values():
        mesh = mesh_of(part)
        assert mesh.is_watertight
        assert mesh.is_winding_consistent
        assert mesh.euler_number == 2
        assert mesh.body_count == 1
        assert mesh.volume == pytest.approx(part.volume_mm3)


def test_a_hinge_has_the_volume_of_two_balls_and_a_bar():
    r, b, a = 2.5, 1.3, 10.0
    cap = r - np.sqrt(r**2 - b**2)  # of each ball, inside the bar's cylinder
    lens = np.pi * cap**2 * (3 * r - cap) / 3
    exact = 2 * (4 / 3 * np.pi * r**3 - lens) + np.pi * b**2 * (a - 2 * (r - cap))
    (smooth,) = [block_parts(Block(segments=64))["hinge"].volume_mm3]
    assert smooth == pytest.approx(exact, rel=6e-3)
    assert block_parts(PAPER)["hinge"].volume_mm3 < exact


def test_tongue_and_groove_are_the_middle_but_for_the_seam():
    parts = solids(PAPER)
    both = parts["tongue"] + parts["groove"]
    assert (both - parts["middle"]).volume() == pytest.approx(0, abs=1e-6)
    assert both.volume() > 0.97 * parts["middle"].volume()


@pytest.mark.parametrize("way", [-1, 1])
def test_a_tongue_slides_into_its_groove_from_either_side(way):
    parts = solids(PAPER)
    for t in np.linspace(0, 2 * PAPER.radius_mm, 12):
        assert (parts["tongue"].translate([0, way * t, 0]) ^ parts["groove"]).volume() < 1e-9
    assert parts["tongue"].min_gap(parts["groove"], 1.0) == pytest.approx(0.1, abs=0.01)


# Figure 16.


def test_the_sides_of_a_slot_are_arcs_of_one_circle_narrowest_half_way():
    polar = np.linspace(0, np.pi / 2, 31)
    half = slot_half_width_mm(PAPER, polar)
    assert 2 * half[[0, 15, -1]] == pytest.approx([3.1, 2.4, 3.1])
    assert half.argmin() == 15
    points = np.stack([polar * PAPER.radius_mm, half], axis=1)
    # The perpendicular bisectors of all chords meet in the centre of the circle.
    chords, middles = np.diff(points, axis=0), (points[1:] + points[:-1]) / 2
    rhs = (chords * middles).sum(axis=1)
    centre, residual, *_ = np.linalg.lstsq(chords, rhs, rcond=None)
    assert residual == pytest.approx(0, abs=1e-12)
    assert centre[1] > 5 * PAPER.radius_mm / 2  # a large radius


def surface_points(part, n=4000):
    points, _ = trimesh.sample.sample_surface(mesh_of(part), n, seed=1)
    return np.asarray(points)


def n_inside(points, part):
    winding = igl.fast_winding_number(part.vertices, part.faces.astype(np.int64), points)
    return int((winding > 0.5).sum())


TURNS = {"straight": (0, 0), "+y": (90, "z"), "-y": (-90, "z"), "+z": (-90, "y"), "-z": (90, "y")}


@pytest.mark.parametrize("turn", TURNS.values(), ids=TURNS)
def test_no_point_of_a_hinge_in_a_joint_state_is_inside_its_capsule(turn):
    parts = block_parts(PAPER)
    deg, axis = turn
    rotation = Rotation.from_euler(axis or "x", deg, degrees=True)
    bar = surface_points(parts["hinge"])
    assert n_inside(np.array([10, 0, 0]) + rotation.apply(bar), parts["middle"]) == 0
    # Half way it is in the neck; off the planes of the slots it is in the petals.
    half = Rotation.from_euler(axis or "y", deg / 2 if deg else 30, degrees=True)
    off = Rotation.from_euler("x", 45, degrees=True) * Rotation.from_euler("z", 40, degrees=True)
    for pose in (half, off):
        assert n_inside(np.array([10, 0, 0]) + pose.apply(bar), parts["middle"])


@given(st.floats(0, 360), st.floats(0, 1))
@settings(max_examples=25)
def test_a_swivel_lets_a_hinge_bend_in_any_plane(azimuth, share):
    for name in ("pull", "pull120"):
        block = BLOCKS[name]
        pin = solids(block)["pin"].rotate([azimuth, 0, 0])
        hinge = solids(block)["hinge"].rotate([0, 0, share * block.bend_deg])
        hinge = hinge.rotate([azimuth, 0, 0]).translate([10, 0, 0])
        assert (pin ^ hinge).volume() < 1e-9
        assert (pin ^ solids(block)["sleeve"]).volume() < 1e-9
        assert (solids(block)["sleeve"] ^ hinge).volume() < 1e-9


def test_the_slots_of_the_papers_block_make_the_bends_a_cross():
    free = Block(snap_mm=-0.25)
    hinge, socket = solids(free)["hinge"], solids(free)["end"]
    for polar, azimuth in product((20, 45, 70, 90), (20, 45, 70)):
        oblique = hinge.rotate([0, 0, polar]).rotate([azimuth, 0, 0])
        assert (oblique ^ socket).volume() > 0.01
        assert (hinge.rotate([0, 0, polar]) ^ socket).volume() < 1e-9


# Neighbours.

bends = st.tuples(st.floats(0, 90), st.floats(0, 360))


def turned(bend):
    deg, azimuth = bend
    return Rotation.from_euler("xz", [azimuth, deg], degrees=True)


@given(bends, bends)
def test_the_axes_of_consecutive_capsules_stay_a_pitch_apart(first, second):
    """The hinge along x from 0 to 1; capsules of length 1 before and after it."""
    before = -turned(first).apply([1.0, 0, 0])
    after = turned(second).apply([1.0, 0, 0])
    one = np.array([1.0, 0, 0])
    distance = segment_distances(np.zeros((1, 3)), before[None], one[None], (one + after)[None])
    assert distance[0] > 1 - 1e-9


def test_bends_beyond_a_right_angle_bring_capsules_nearer():
    far = np.deg2rad(100)
    ends = np.array([(-np.cos(far), np.sin(far), 0), (1 + np.cos(far), np.sin(far), 0)])
    starts = np.array([(0.0, 0, 0), (1.0, 0, 0)])
    distance = segment_distances(starts[:1], ends[:1], starts[1:], ends[1:])
    assert distance[0] < 0.97


@given(bends, bends)
@settings(max_examples=15)
def test_consecutive_capsules_keep_their_gap(first, second):
    middle = solids(DRAFT)["middle"]
    before = middle.translate([-10, 0, 0]).rotate([0, 0, -first[0]]).rotate([first[1], 0, 0])
    after = middle.rotate([0, 0, second[0]]).rotate([second[1], 0, 0]).translate([10, 0, 0])
    assert before.min_gap(after, 0.5) >= DRAFT.gap_mm - 1e-6


# What the checks must see.


def faulty(**parts):
    """What is said of the parts of a block some of which are others; halves are left out."""
    whole = {name: solids(DRAFT)[name] for name in ("hinge", "end", "middle")}
    return check_parts({**whole, **parts}, DRAFT).reason


def from_another(**measures):
    return solids(replace(DRAFT, **measures))


def test_the_parts_themselves_pass():
    assert faulty() == lu.check_block(DRAFT).reason == "printable"


def test_a_bar_too_thick_is_seen():
    assert "parts overlap by" in faulty(
        hinge=from_another(bar_mm=3.3, ball_mm=5.1, clearance_mm=0.05)["hinge"]
    )


@pytest.mark.parametrize("name", ["end", "middle", "tongue"])
def test_a_slot_that_is_shut_is_seen(name):
    plug = Manifold.cube([4, 1.4, 4], True).translate([0, 3.7, 0])
    assert "parts overlap by" in faulty(**{name: solids(DRAFT)[name] + plug})


def test_a_ball_too_small_is_seen():
    small = Manifold.sphere(1.6, 32)
    bar = Manifold.cylinder(10, 0.8).rotate([0, 90, 0])
    assert faulty(hinge=small + small.translate([10, 0, 0]) + bar) == "a ball leaves its socket"


def test_the_smaller_of_two_balls_counts():
    ball = Manifold.sphere(1.6, 32)
    cut = solids(DRAFT)["hinge"].trim_by_plane([-1, 0, 0], -5) + ball.translate([10, 0, 0])
    bar = Manifold.cylinder(6, 0.8).rotate([0, 90, 0]).translate([4, 0, 0])
    assert judge.ball_radius(cut + bar, DRAFT) == pytest.approx(1.6, abs=0.03)
    assert judge.ball_radius(solids(DRAFT)["hinge"], DRAFT) == pytest.approx(2.5, abs=0.05)


def test_a_socket_too_open_is_seen():
    funnel = Manifold.cylinder(5, 2.75, 2.75, 32).rotate([0, 90, 0])
    assert faulty(end=solids(DRAFT)["end"] - funnel) == "a ball leaves its socket"


def test_missing_clearance_is_seen():
    tight = from_another(clearance_mm=0.12)
    assert "parts come within 0.12" in faulty(middle=tight["middle"])


def test_a_missing_gap_is_seen():
    wide = from_another(gap_mm=0.25)["middle"].scale([1, 1.02, 1.02]).rotate([45, 0, 0])
    assert "slots" not in faulty(middle=wide)
    assert faulty(middle=wide) != "printable"


def test_a_snap_that_was_not_asked_for_is_seen():
    free = replace(DRAFT, snap_mm=-0.1)
    assert check_parts(solids(free), free).reason == "printable"
    assert "meets the sides of a slot" in check_parts(solids(DRAFT), free).reason


def test_a_part_beyond_its_voxels_is_seen():
    longer = solids(DRAFT)["end"] + Manifold.cube([1, 1, 1], True).translate([-4.6, 0, 0])
    assert faulty(end=longer) == "end: it leaves its own voxels, less half the gap"


def test_a_part_in_two_pieces_is_seen():
    hinge = solids(DRAFT)["hinge"] - Manifold.cube([0.5, 9, 9], True).translate([5, 0, 0])
    assert faulty(hinge=hinge) == "hinge: it is in 2 pieces"


def test_a_part_with_a_handle_is_seen():
    drill = Manifold.cylinder(20, 0.3, center=True).translate([5, 0, 0])
    assert faulty(middle=solids(DRAFT)["middle"] - drill) == "middle: it has 1 handles"


def test_a_surface_that_is_open_or_missing_is_seen(monkeypatch):
    assert faulty(tongue=Manifold()) == "tongue: its surface is not closed"
    whole = part_of(solids(DRAFT)["end"])
    torn = SimpleNamespace(vertices=whole.vertices, faces=whole.faces[1:])
    monkeypatch.setattr(judge, "part_of", lambda solid: torn)
    assert list(judge._faults("end", solids(DRAFT), DRAFT)) == ["its surface is not closed"]


def test_halves_that_do_not_hold_are_seen():
    groove = solids(DRAFT)["groove"]
    plain = groove - Manifold.cube([1.5, 20, 6], True).translate([5.7, 0, 0])
    assert faulty(tongue=solids(DRAFT)["tongue"], groove=plain) == "tongue and groove come apart"
    shut = {
        **solids(DRAFT),
        "groove": groove + Manifold.cube([1, 4, 4], True).translate([5.6, 0, 0]),
    }
    assert list(judge._loose(shut, DRAFT)) == [("tongue", "groove")]
    assert not list(judge._loose(solids(DRAFT), DRAFT))


def test_a_pin_that_slips_out_is_seen():
    block = replace(BLOCKS["pull"], segments=24)
    s = swivel(block)
    length = s.face - s.chamber + 1
    drill = Manifold.cylinder(length, s.head_radius + 0.2).rotate([0, 90, 0])
    parts = dict(solids(block))
    parts["sleeve"] -= drill.translate([s.chamber, 0, 0])
    assert check_parts(parts, block).reason == "pin and sleeve come apart"


def test_a_missing_part_is_refused():
    with pytest.raises(ValueError, match="needs a part 'end'"):
        check_parts({"hinge": solids(DRAFT)["hinge"], "middle": solids(DRAFT)["middle"]}, DRAFT)


def test_the_play_of_a_ball_is_at_least_what_it_can_be_shifted_by(reports):
    """Along axes and diagonals, until the ball meets the socket: by intersecting solids."""
    socket, ball = solids(DRAFT)["end"], Manifold.sphere(DRAFT.ball_mm / 2, 48)

    def free(way, t):
        shift = t * np.array(way) / np.linalg.norm(way)
        return (ball.translate(shift.tolist()) ^ socket).volume() < 1e-6

    ways = [way for way in product((-1, 0, 1), repeat=3) if any(way)]
    farthest = max(t for way in ways for t in np.arange(0.1, 1.5, 0.1) if free(way, t))
    assert 0.2 < farthest < 1.2
    assert farthest <= reports["standard"].play_mm


def test_the_opening_is_that_of_the_largest_ball_that_slips_out():
    """Along the axis, by intersecting solids."""
    socket = solids(PAPER)["end"]

    def slips(diameter):
        ball = Manifold.sphere(diameter / 2, 64)
        return all(
            (ball.translate([t, 0, 0]) ^ socket).volume() < 1e-3 for t in np.arange(0, 7.5, 0.5)
        )

    assert slips(opening_mm(PAPER) - 0.05)
    assert not slips(opening_mm(PAPER) + 0.15)
