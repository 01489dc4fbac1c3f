"""From a chain to files for a printer: nothing overlaps, all is there, slicers can read it."""

from collections import Counter

import numpy as np
import pandas as pd
import pytest
import trimesh
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st
from manifold3d import Manifold, OpType
from walks import walks

import lineup as lu
from lineup.block import BLOCKS, Block, scaled, solids
from lineup.fabrication import export, pieces_on, placed, plates
from lineup.fabrication.coupon import coupon
from lineup.fabrication.layout import boustrophedon
from lineup.kinematics import Move

PAPER = Block()
CORNER = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (1, 1, 1), (0, 1, 1), (0, 0, 1)])


def path_of(n):
    return lu.VoxelPath(boustrophedon(n, 39, 39))


def body(piece, block):
    matrix = np.hstack([piece.rotation, piece.offset_mm[:, None]])
    return solids(block)[piece.part].transform(matrix)


def boxes(pieces, block):
    """Corners (n, 2, 3) of the boxes that hold pieces."""
    found = [np.reshape(body(piece, block).bounding_box(), (2, 3)) for piece in pieces]
    return np.array(found)


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A chain of 6 blocks on two plates, with everything written."""
    folder = tmp_path_factory.mktemp("small")
    made = lu.export_print(path_of(12), folder, bed_mm=(45.0, 25.0), whole_stl=True)
    return folder, made


# Where pieces lie.


@given(walks(min_bars=3, max_bars=11), st.sampled_from(sorted(BLOCKS)))
@examples(40)
def test_no_piece_runs_into_another_in_any_lattice_pose(voxels, name):
    block = BLOCKS[name]
    pieces = placed(voxels[: len(voxels) // 2 * 2], block)
    bodies = [body(piece, block) for piece in pieces]
    union = Manifold.batch_boolean(bodies, OpType.Add)
    assert union.volume() == pytest.approx(sum(b.volume() for b in bodies), rel=1e-9)
    assert union.num_tri() == sum(b.num_tri() for b in bodies)


def test_a_piece_in_the_way_would_be_seen():
    pieces = placed(CORNER, PAPER)
    bodies = [body(piece, PAPER) for piece in pieces]
    bodies[1] = bodies[1].translate([1, 0, 0])
    union = Manifold.batch_boolean(bodies, OpType.Add)
    assert union.volume() < sum(b.volume() for b in bodies) - 0.1


@given(walks(min_bars=1, max_bars=11))
def test_balls_and_sockets_lie_on_the_voxels_of_the_path(voxels):
    voxels = voxels[: len(voxels) // 2 * 2]
    pieces = placed(voxels, PAPER)
    counts = Counter(piece.part for piece in pieces)
    n = len(voxels) // 2
    assert counts == Counter({"hinge": n, "middle": n - 1, "end": 2}) + Counter()
    for piece in pieces:
        assert round(np.linalg.det(piece.rotation)) == 1
        if piece.part != "end":
            ends = np.array([(0, 0, 0), (10, 0, 0)]) @ piece.rotation.T + piece.offset_mm
            assert np.array_equal(ends, 10 * voxels[piece.bar : piece.bar + 2])
    first, last = pieces[0], pieces[-1]
    assert np.array_equal(first.rotation[:, 0], voxels[1] - voxels[0])
    assert np.array_equal(last.rotation[:, 0], voxels[-2] - voxels[-1])


@given(st.integers(1, 300), st.integers(1, 9), st.integers(1, 9))
def test_a_boustrophedon_is_a_simple_path_within_its_columns_and_rows(n, columns, rows):
    voxels = boustrophedon(n, columns, rows)
    assert (np.abs(np.diff(voxels, axis=0)).sum(axis=1) == 1).all()
    assert len(np.unique(voxels, axis=0)) == n
    assert (voxels.min(axis=0) >= 0).all()
    assert (voxels.max(axis=0)[:2] < (columns, rows)).all()
    assert voxels[:, 2].max() == (n - 1) // (columns * rows)


@given(st.integers(1, 40), st.floats(36.0, 90.0), st.floats(24.0, 70.0), st.integers(1, 3))
@settings(max_examples=30)
def test_plates_hold_every_block_once_and_fit_on_the_bed(n_blocks, x, y, layers):
    made = plates(n_blocks, PAPER, (x, y), layers)
    assert [p.start for p in made] == [0, *(p.stop for p in made[:-1])]
    assert made[-1].stop == n_blocks
    sizes = [p.stop - p.start for p in made]
    assert max(sizes) - min(sizes) <= 1
    assert [p.first for p in made] == ["end"] + ["groove"] * (len(made) - 1)
    assert [p.last for p in made] == ["tongue"] * (len(made) - 1) + ["end"]
    parts = Counter()
    for plate in made:
        pieces = pieces_on(plate, PAPER)
        parts.update(piece.part for piece in pieces)
        box = boxes(pieces, PAPER)
        size = box[:, 1].max(axis=0) - box[:, 0].min(axis=0)
        assert (size[:2] <= (x, y)).all()
        assert size[2] <= layers * 10
        bars = [piece.bar for piece in pieces if piece.part == "hinge"]
        assert bars == list(range(2 * plate.start, 2 * plate.stop, 2))
    assert parts["hinge"] == n_blocks
    assert parts["middle"] + parts["tongue"] == n_blocks - 1
    assert parts["tongue"] == parts["groove"] == len(made) - 1


def test_one_plate_where_one_will_do():
    assert len(plates(754, PAPER, (390.0, 390.0))) == 1
    assert len(plates(754, PAPER, (389.0, 389.0))) == 2
    assert len(plates(754, PAPER, (389.0, 389.0), layers=2)) == 1


def test_a_tongue_lies_where_the_next_plate_has_its_groove():
    first, second = plates(6, PAPER, (45.0, 25.0))
    tongue, groove = pieces_on(first, PAPER)[-1], pieces_on(second, PAPER)[0]
    assert (tongue.part, groove.part) == ("tongue", "groove")
    middle, hinge, *_ = (body(piece, PAPER) for piece in pieces_on(first, PAPER)[2:])
    at_groove, next_hinge = (body(piece, PAPER) for piece in pieces_on(second, PAPER)[:2])
    gap = middle.min_gap(hinge, 5)
    assert gap > 0
    assert at_groove.min_gap(next_hinge, 5) == pytest.approx(gap)
    # Put together in the frame of the middle, they are it, but for the seam.
    fitted = [
        body(piece, PAPER)
        .translate((-piece.offset_mm).tolist())
        .transform(np.hstack([piece.rotation.T, np.zeros((3, 1))]))
        for piece in (tongue, groove)
    ]
    assert (fitted[0] ^ fitted[1]).volume() == pytest.approx(0, abs=1e-9)
    assert ((fitted[0] + fitted[1]) - solids(PAPER)["middle"]).volume() < 1e-6


# What it takes.


def test_the_bill_counts_weighs_and_sums(small):
    folder, made = small
    bill = made.bill.set_index("part")
    assert bill["count"].to_dict() == {
        "end": 2,
        "groove": 1,
        "hinge": 6,
        "middle": 4,
        "tongue": 1,
        "all": 14,
    }
    stl = sum(trimesh.load(folder / f"chain-{k}.stl").volume for k in (1, 2))
    assert bill["grams"]["all"] == pytest.approx(1.13e-3 * stl, rel=1e-3)
    assert bill["hours"]["all"] == pytest.approx(stl / 15e3, rel=0.01)
    assert bill["velcro_cm2"]["hinge"] == 0
    band = np.pi * 9.7 * (10 - 3.1) / 100
    assert bill["velcro_cm2"]["middle"] == pytest.approx(4 * band, abs=1e-3)
    assert bill["velcro_cm2"]["tongue"] == pytest.approx(band / 2, abs=1e-3)
    written = pd.read_csv(folder / "parts.csv")
    pd.testing.assert_frame_equal(written, made.bill)


def test_assumptions_are_stated_and_can_be_changed(tmp_path, small):
    other = lu.export_print(
        path_of(12), tmp_path, bed_mm=(45.0, 25.0), density_g_cm3=2.26, rate_cm3_h=30.0
    )
    total, before = other.bill.iloc[-1], small[1].bill.iloc[-1]
    assert total["grams"] == pytest.approx(2 * before["grams"], rel=1e-3)
    assert total["hours"] == pytest.approx(before["hours"] / 2, rel=0.02)
    page = (tmp_path / "parts.md").read_text()
    for text in ("2.26 g/cm³", "30 cm³ an hour", "Slide the tongue", "printable, in 25 poses"):
        assert text in page
    assert "nan" not in page


def test_a_coupon_sweeps_clearance_and_snap_and_its_ends_are_told_apart():
    test = coupon(PAPER)
    assert test.table["clearance_mm"].tolist() == [0.15, 0.15, 0.25, 0.25, 0.35, 0.35]
    assert test.table["snap_mm"].tolist() == [0.05, 0.2] * 3
    assert Counter(piece.part for piece in test.places)["hinge"] == 3
    ends = {name: part.volume_mm3 for name, part in test.parts.items() if "end" in name}
    assert len(ends) == len({round(v, 2) for v in ends.values()}) == 6
    for part in test.parts.values():
        mesh = trimesh.Trimesh(part.vertices, part.faces)
        assert mesh.is_watertight
        assert mesh.body_count == 1
    # Marks are only cut away, and a ring cuts away more than pips.
    for (pips, ring), rows in test.table.groupby(["pips", "ring"]):
        block = Block(
            gap_mm=max(0.3, rows["clearance_mm"].iloc[0]),
            clearance_mm=rows["clearance_mm"].iloc[0],
            snap_mm=rows["snap_mm"].iloc[0],
        )
        name = f"end-{pips}" + ("-ring" if ring == "yes" else "")
        cut = solids(block)["end"].volume() - ends[name]
        assert (cut > 2) == (ring == "yes")
        assert cut > 0.05 * pips


def test_a_coupon_of_a_swivel_has_swivels():
    test = coupon(BLOCKS["pull"])
    assert sorted({piece.part for piece in test.places} - {"hinge"}) == sorted(
        f"{part}-{k}" for part in ("end", "pin", "sleeve") for k in (1, 2, 3)
    )


# What is printed, and what is not.


def two_shapes():
    line = np.stack([np.arange(6), np.zeros(6), np.zeros(6)], axis=1).astype(int)
    none = np.empty((0, 4), int)
    foldings = tuple(
        lu.Folding(lu.VoxelPath(v), lu.Motion(v, none, 0.999, 90.0, False, "none"))
        for v in (CORNER, line)
    )
    models = tuple(lu.VoxelSolid(np.ones((6, 1, 1), bool), name=n) for n in ("crank", "rod"))
    return lu.Design(models, foldings, (), pd.DataFrame())


def test_a_design_is_one_chain_with_all_its_shapes_listed(tmp_path):
    made = lu.export_print(two_shapes(), tmp_path)
    assert made.bill["count"].iloc[-1] == 7
    page = (tmp_path / "parts.md").read_text()
    assert "crank" in page
    assert "20 x 20 x 20" in page
    assert "rod" in page
    assert "60 x 10 x 10" in page


def test_a_folded_pose_is_printed_as_it_lies(tmp_path):
    made = lu.export_print(lu.VoxelPath(CORNER + 7), tmp_path, pose="folded")
    assert made.files[0].name == "folded.3mf"
    (plate,) = made.plates
    assert np.array_equal(plate.voxels, CORNER)
    assert made.bill["count"].iloc[-1] == 7


def test_a_folded_pose_is_turned_where_that_makes_it_fit(tmp_path):
    bar = lu.VoxelPath(boustrophedon(12, 6, 2))
    (plate,) = lu.export_print(bar, tmp_path, pose="folded", bed_mm=(25.0, 65.0)).plates
    assert np.ptp(plate.voxels, axis=0).tolist() == [1, 5, 0]
    before, after = (np.diff(v, axis=0) for v in (bar.voxels, plate.voxels))
    turn = np.linalg.lstsq(before.astype(float), after.astype(float), rcond=None)[0]
    assert np.array_equal(turn[:2, :2].round(6), [[0, 1], [-1, 0]])  # and not mirrored


def a_pull():
    moves = np.array([(Move.PULL, 5, 0, 2)])
    motion = lu.Motion(CORNER, moves, 0.914, 90.0, False, "pulled")
    return lu.Folding(lu.VoxelPath(CORNER), motion)


def test_what_a_motion_asks_of_a_block_is_noted(tmp_path):
    notes = lu.export_print(a_pull(), tmp_path).notes
    assert "the motion is for capsules of 0.914 of the pitch, and these are 0.97" in notes
    assert "pulls bend joints in any plane, and these capsules do not swivel" in notes
    assert f"**{notes[0]}**" in (tmp_path / "parts.md").read_text()
    assert export._notes(a_pull(), BLOCKS["pull"]) == ()
    us = lu.Folding(
        lu.VoxelPath(CORNER), lu.Motion(CORNER, a_pull().motion.moves, 0.866, 120.0, False, "")
    )
    assert any("slots end at 90" in note for note in export._notes(us, BLOCKS["pull"]))
    assert export._notes(us, BLOCKS["pull120"]) == export._notes(two_shapes(), PAPER) == ()


@pytest.mark.parametrize(
    ("chain", "options", "says"),
    [
        (path_of(11), {}, "even number of voxels, got 11; lineup.trim makes it one less"),
        (lu.VoxelPath(CORNER[[0, 1, 2, 1]]), {"pose": "folded"}, "a voxel comes twice"),
        (lu.VoxelPath(CORNER[[0, 1, 2, 4]]), {"pose": "folded"}, "do not share a face"),
        (path_of(4), {"block": "thin"}, r"unknown block 'thin'; known: \['pull', 'pull120'"),
        (path_of(4), {"block": scaled(PAPER, 12.0)}, "pitch is 12 mm, and pitch_mm is 10"),
        (path_of(4), {"pitch_mm": 5.0}, "larger pitch_mm"),
        (path_of(4), {"pose": "straight"}, r"unknown pose 'straight'; known: \['flat', 'folded'\]"),
        (
            path_of(4),
            {"bed_mm": (15.0, 9.0)},
            "not one block of pitch 10 mm fits on the bed 15 x 9",
        ),
        (path_of(4), {"bed_mm": (float("nan"), 9.0)}, "two positive numbers"),
        (path_of(4), {"layers": 0}, "at least 1 block, and 1 layer, got 2 and 0"),
        (path_of(40), {"block": "pull", "bed_mm": (50.0, 50.0)}, "capsules that swivel cannot be"),
        (path_of(40), {"pose": "folded", "bed_mm": (50.0, 50.0)}, "chain is 390 x 20 mm"),
        (path_of(4), {"density_g_cm3": 0.0}, "density_g_cm3 must be a positive number, got 0"),
        (two_shapes(), {"pose": "folded"}, "2 folded poses; give one of its foldings"),
        (lu.Design((), (), (), pd.DataFrame()), {}, r"one chain, got lengths \[\]"),
        (CORNER, {}, "VoxelPath, Folding or Design, got ndarray"),
    ],
)
def test_what_cannot_be_printed_is_refused_with_a_reason(tmp_path, chain, options, says):
    folder = tmp_path / "out"
    with pytest.raises(ValueError, match=says) as error:
        lu.export_print(chain, folder, **options)
    assert "\n" not in str(error.value)
    assert not folder.exists()


def test_a_block_that_fails_a_check_is_not_printed(tmp_path, monkeypatch):
    from lineup.block import BlockReport

    bad = BlockReport(False, "a ball leaves its socket", 25, 0.0, 0.25, np.inf, 0.0)
    monkeypatch.setattr(export, "check_block", lambda block: bad)
    with pytest.raises(ValueError, match="not printable: a ball leaves its socket"):
        lu.export_print(path_of(4), tmp_path)
