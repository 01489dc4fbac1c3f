"""The printed manual: what its pages say and show, in colour and in grey, on either paper."""

import json
import re

import numpy as np
import pypdf
import pytest
from hands import folded

import lineup as lu
from lineup import cli, draw, grid
from lineup.kinematics import Move
from lineup.manual import booklet, pictures, plans, scene, sheets, step_pages
from lineup.manual.assembly import assembly_of
from lineup.manual.documents import document_of

MM = 72 / 25.4
LINE = re.compile(r"(head|tail)? +(\d+)(?:-(\d+))?  ([ENUWSD*+\- ]+)")


@pytest.fixture(scope="module", autouse=True)
def plain():
    """Pictures by matplotlib, which is quick for small ones."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(draw.render, "renderer", lambda: "matplotlib")
        yield


@pytest.fixture(scope="module")
def folding():
    """Folded upside down, with both ends, in some steps of several layers."""
    return lu.fold(lu.VoxelSolid(np.ones((4, 4, 4), bool)), rounds=100, trial_rounds=10)


@pytest.fixture(scope="module")
def files(folding, tmp_path_factory):
    return lu.write_manual(folding, tmp_path_factory.mktemp("manual") / "new", name="cube")


@pytest.fixture(scope="module")
def document(files):
    return json.loads(files.json.read_text())


@pytest.fixture(scope="module")
def pages(files):
    return [page.extract_text() for page in pypdf.PdfReader(files.pdf).pages]


def corner():
    path = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (1, 2, 0)])
    return path, np.array([(Move.SWING, 1, 2, 0)])


def a_folding(diameter=0.999):
    path, moves = corner()
    return lu.Folding(lu.VoxelPath(path), lu.Motion(path, moves, diameter, 90.0, True, "straight"))


def test_the_letters_on_the_pages_alone_lead_to_the_body(folding, document, pages):
    places = dict(zip(base_joints(document), map(np.array, document["base"]), strict=True))
    for page in (page for page in pages if page.startswith("Step ")):
        end = "head" if "HEAD" in page.splitlines()[0] else "tail"
        for label, first, last, words in LINE.findall(page[page.index("To check by") :]):
            end = label or end
            first, last = int(first), int(last or first)
            blocks = range(first, last + (1 if last >= first else -1), 1 if last >= first else -1)
            for block, word in zip(blocks, words.replace("*", "").split(), strict=True):
                outward = 1 if end == "tail" else -1
                joints = [2 * block - 2, 2 * block - 1][::outward]
                for joint, letter in zip(joints, word, strict=True):
                    if letter != "-":
                        assert joint not in places
                        step = grid.DIRECTIONS[grid.LETTERS.index(letter)]
                        places[joint] = places[joint - outward] + step
    body = np.array([places[joint] for joint in range(len(folding.path))])
    assert np.array_equal(body, assembly_of(folding).places)


def base_joints(document):
    return [
        joint
        for row in sorted(document["rows"], key=lambda row: row["block"])
        for joint, at in ((2 * row["block"] - 2, row["at1"]), (2 * row["block"] - 1, row["at2"]))
        if at == 0
    ]


def test_pages_are_there_and_numbered(document, pages):
    assert len(pages) == 5 + len(document["steps"])
    assert all(f"page {k} of {len(pages)}" in page for k, page in enumerate(pages, start=1))
    assert [page.split("\n")[0].split(" of ")[0] for page in pages[4:-1]] == [
        f"Step {k}" for k in range(1, len(document["steps"]) + 1)
    ]


def test_each_step_is_checked_by_place_and_number(document, pages):
    for row, page in zip(document["steps"], pages[4:-1], strict=True):
        column, line, layer = row["last_place"]
        assert (
            f"Block {row['last_block']} ends in column {column}, row {line}, layer {layer}" in page
        )
        assert f"{row['size'][2]} layers high" in page
        for stretch in row["stretches"]:
            for swing in stretch["swings"]:
                end, (was, loose) = swing.split(":")
                assert f"wing the loose {end} from {was} to {loose}" in page


def test_the_cover_says_how_hard_it_is_and_what_the_judge_says(document, pages):
    assert "CERTIFIED" in pages[0]
    assert "NOT" not in pages[0]
    grade = document["grade"]
    assert f"{grade['points']} points" in pages[0]
    assert f"about {grade['minutes']} min" in pages[0]
    assert "32 blocks, 64 voxels of 10 mm, 0.64 m long" in pages[0]


def test_what_lies_upside_down_is_turned_over_at_the_end(document, pages):
    assert document["build"]["down"] == "U"
    assert "folded upside down" in pages[2].replace("\n", " ")
    assert "Turn the model over" in pages[-1]


def test_a_loose_end_that_hangs_down_is_told_of():
    assembly = assembly_of(folded((4, 4, 4), 5))
    document = document_of(assembly, lu.Certificate(True, ""), "cube")
    told = []
    for row in document.steps:
        ends = scene.loose_ends(assembly, assembly.steps[row.step - 1].stop)
        sheet = step_pages.step_page(assembly, row, "cube", "letter", 1, 1)
        said = " ".join(text.get_text() for text in sheet.axes.texts)
        for end in ends:
            hangs = f"The loose {end.name} hangs down ({end.n_voxels} voxels)" in said
            assert hangs == (grid.LETTERS[end.direction] == "D")
            told.append(hangs)
        numbers = {text.get_text() for text in sheet.axes.texts if text.get_bbox_patch()}
        assert {str(row.stretches[0].first_block), str(row.last_block)} <= numbers
    assert any(told)
    assert not all(told)


def test_hinges_that_bend_in_a_manner_of_their_own_are_told_of_on_plan_and_in_words():
    made = folded((4, 4, 4), 0, "slotted")
    assembly = assembly_of(made)
    document = document_of(assembly, lu.certify(made.motion, joints="slotted"), "cube")
    told = {"straighten": [], "hinge first": []}
    for row in document.steps:
        sheet = step_pages.step_page(assembly, row, "cube", "letter", 1, 1)
        texts = [text.get_text() for text in sheet.axes.texts]
        said = " ".join(" ".join(texts).split())
        letters = next(text for text in texts if re.search(r"\d  [ENUWSD-]", text))
        for sign, manner, what in (
            ("*", "straighten", "straighten the hinge"),
            ("+", "hinge first", "bend the hinge first"),
        ):
            blocks = [r.block for r in document.rows if (r.step, r.manner) == (row.step, manner)]
            listed = re.findall(rf"Blocks? ([\d, ]+): {what}", said)
            listed = [int(block) for block in ", ".join(listed).split(", ") if block]
            assert sorted(listed) == sorted(blocks)
            assert letters.count(sign) == texts.count(sign) == len(blocks)
            told[manner] += listed
    assert all(told.values())


def test_the_cover_says_for_which_joints_it_is_certified():
    told = []
    for joints in ("free", "slotted"):
        made = folded((3, 3, 4), 0, joints)
        cover = lu.manual_pages(made, [1])[0].axes[0].texts
        told.append(" ".join(" ".join(text.get_text() for text in cover).split()))
    assert "which the certificate does not cover" in told[0]
    assert "No piece is twisted in its slots if the 2 hinges marked * or + bend as told" in told[1]
    assert all("CERTIFIED From" in text for text in told)


def test_a_motion_that_the_judge_refuses_is_told_on_the_cover(tmp_path):
    files = lu.write_manual(a_folding(diameter=1.5), tmp_path)
    cover = pypdf.PdfReader(files.pdf).pages[0].extract_text()
    verdict = json.loads(files.json.read_text())["verdict"]
    assert not verdict["ok"]
    assert "NOT CERTIFIED" in cover
    assert verdict["reason"][:20] in cover


def test_papers_and_equal_bytes(files, tmp_path):
    one, two = (
        lu.write_manual(a_folding(), tmp_path / folder, name="it", paper="letter")
        for folder in "ab"
    )
    for first, second in zip(one, two, strict=True):
        assert first.read_bytes() == second.read_bytes()
    for written, size in ((one, (215.9, 279.4)), (files, (210, 297))):
        pdf = pypdf.PdfReader(written.pdf)
        for page in pdf.pages:
            sides = float(page.mediabox.width) / MM, float(page.mediabox.height) / MM
            assert sides == pytest.approx(size, abs=0.1)
        assert {"/CreationDate", "/ModDate"}.isdisjoint(pdf.metadata)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"paper": "a5"}, "a4, letter"),
        ({"pitch_mm": 0.0}, "pitch_mm"),
        ({"pitch_mm": float("nan")}, "pitch_mm"),
        ({"name": ""}, "name"),
        ({"name": "a/b"}, "name"),
    ],
)
def test_bad_options_are_refused_before_anything_is_written(tmp_path, options, said):
    with pytest.raises(ValueError, match=said):
        lu.write_manual(a_folding(), tmp_path / "out", **options)
    assert not (tmp_path / "out").exists()


def test_a_half_written_booklet_is_not_left(tmp_path, monkeypatch):
    def stop(*_):
        raise RuntimeError("stopped")
        yield

    monkeypatch.setattr(booklet, "_pages", stop)
    with pytest.raises(RuntimeError, match="stopped"):
        lu.write_manual(a_folding(), tmp_path)
    assert not list(tmp_path.glob("*.pdf*"))


# In grey, and where things are


def luminance(rgb):
    return np.asarray(rgb)[..., :3] @ (0.299, 0.587, 0.114)


def test_colours_are_told_apart_in_grey():
    ramp = luminance(sheets.RAMP(np.linspace(0, 1, 256)))
    assert (np.diff(ramp[::8]) > 0).all()
    assert np.ptp(ramp) > 0.5
    old, new, rod = (
        luminance(np.array(c) / 255) for c in (pictures.OLD, pictures.NEW, pictures.ROD)
    )
    assert old - new > 0.2
    assert new - rod > 0.1


def test_on_a_plan_north_is_up_and_cells_are_where_they_are_counted():
    plan = plans.Plan(10.0, 20.0, 5.0, (4, 3))
    assert plan.at(np.array([1, 1, 7])).tolist() == [12.5, 32.5]
    assert plan.at(np.array([4, 3, 1])).tolist() == [27.5, 22.5]
    part = plans.Plan(10.0, 20.0, 5.0, (2, 2), (3, 2))
    assert part.at(np.array([3, 2, 1])).tolist() == [12.5, 27.5]
    places = np.array([(3, 2, 1), (4, 3, 2), (2, 2, 1), (5, 3, 1)])
    assert part.inside(places).tolist() == places[:2].tolist()


def test_cells_show_what_is_in_the_layer_below_it_and_above():
    sheet = sheets.blank("a4")
    there = np.array([(1, 1, 1), (1, 2, 1), (1, 2, 2), (2, 2, 2), (3, 3, 3), (2, 2, 4), (9, 9, 2)])
    plans.ground(sheet, plans.Plan(20, 20, 10, (3, 3)), there, 2)
    cells, below, here, above = (len(c.get_paths()) for c in sheet.axes.collections)
    assert (cells, below, here, above) == (9, 2, 2, 2)


def test_plans_are_drawn_as_large_as_they_fit():
    for n in (1, 2, 3, 4):
        across, down, cell = step_pages._tiling(n, 10, 6, 180.0, 120.0, 7.0)
        assert across * down >= n
        assert across * 10 * cell <= 180
        assert down * 6 * cell <= 120


def test_what_is_new_is_shown_dark_and_where_it_is():
    old = np.array([(x, y, 1) for x in range(1, 5) for y in range(1, 4)])
    new = np.array([(x, y, 2) for x in range(1, 5) for y in range(1, 4)])
    ends = [pictures.LooseEnd("tail", new[0], 2)]
    picture = pictures.body_picture(old, new, ends, 200, 160)
    image = picture.image.astype(int)
    red = (image[..., 0] - image[..., 2] > 60).nonzero()[0]
    grey = ((np.ptp(image, axis=2) < 12) & (image[..., 0] > 60) & (image[..., 0] < 200)).nonzero()[
        0
    ]
    assert 0 < red.mean() < grey.mean()
    ((name, x, y),) = picture.names
    assert name == "tail"
    assert 0 < x < 1
    assert 0 < y < 0.5
    assert len(np.unique(image.reshape(-1, 3), axis=0)) <= 128


def test_inner_voxels_are_not_drawn():
    cube = np.argwhere(np.ones((4, 4, 4), bool))
    assert len(pictures.outside(cube.astype(np.int32))) == 64 - 8


# The command


def test_the_command_writes_and_tells(tmp_path, capsys):
    file = lu.save(a_folding(), tmp_path / "hook.folding.json")
    assert cli.run(["manual", str(file), "--out", str(tmp_path / "out"), "--paper", "letter"]) == 0
    said = capsys.readouterr().out
    assert "2 blocks in 1 steps, difficulty 1 of 5" in said
    assert [f"hook.manual.{kind}" in said for kind in ("json", "csv", "pdf")] == [True] * 3
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == [
        f"hook.manual.{kind}" for kind in ("csv", "json", "pdf")
    ]
    motion = lu.save(a_folding(diameter=1.5).motion, tmp_path / "hook.motion.json")
    assert cli.run(["manual", str(motion), "--out", str(tmp_path)]) == 1
    assert "falls short: not certified" in capsys.readouterr().err
    path = lu.save(a_folding().path, tmp_path / "hook.path.json")
    assert cli.run(["manual", str(path)]) == 2
    assert cli.run(["manual", str(file), "--paper", "a5"]) == 2


def test_a_document_of_nothing_certified_still_says_why():
    assembly = assembly_of(a_folding())
    verdict = lu.Certificate(False, "for a reason", 3)
    assert document_of(assembly, verdict, "x").verdict.model_dump() == {
        "ok": False,
        "joints": "slotted",
        "reason": "for a reason",
        "where": 3,
        "clearance": None,
        "bend_deg": None,
        "moves_checked": 0,
    }


@pytest.mark.slow
def test_a_manual_of_754_blocks_is_small_and_comes_back(tmp_path):
    made = lu.fold(lu.model("bunny", voxels=1600), length=1508)
    files = lu.write_manual(made, tmp_path, name="bunny")
    assert files.pdf.stat().st_size < 5_000_000
    for file in (files.json, files.csv):
        again = lu.read_manual(file)
        assert np.array_equal(again.path.voxels, made.path.voxels)
        assert lu.certify(again.motion).ok


def test_pages_by_number_are_those_of_the_booklet(folding, pages):
    for number, figure in zip(
        (1, len(pages)), lu.manual_pages(folding, [1, len(pages)], name="cube"), strict=True
    ):
        shown = [text.get_text() for text in figure.axes[0].texts]
        assert f"cube · page {number} of {len(pages)}" in shown
        assert all(line in pages[number - 1] for text in shown for line in text.splitlines()[:1])


@pytest.mark.parametrize("number", [0, 1000])
def test_a_page_that_is_not_there_is_refused(folding, number):
    with pytest.raises(ValueError, match=f"got {number}"):
        lu.manual_pages(folding, [number])
