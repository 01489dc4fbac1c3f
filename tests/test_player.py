"""The player in a real browser: what is drawn, pressed and picked, with WebGL and without.

By default a browser only shows that the page comes up and obeys; `test_viewer.py` has the rest of
what needs none.
"""

import dataclasses
import functools
import http.server
import threading

import numpy as np
import pytest
from browser import BROWSER, alike, ask, colourful, launched, opened, shot, until
from PIL import Image

import lineup as lu

api = pytest.importorskip("playwright.sync_api")

SIZE = {"width": 720, "height": 560}

pytestmark = pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")


@pytest.fixture(scope="module")
def folding():
    return lu.fold(lu.VoxelSolid(np.ones((4, 3, 3), bool)), rounds=50, trial_rounds=10)


@pytest.fixture(scope="module")
def file(folding, tmp_path_factory):
    folder = tmp_path_factory.mktemp("player")
    colours = {"number": range(len(folding.path) - 1)}
    verdict = lu.certify(folding.motion)
    return lu.write_player(folding, folder / "block.html", certificate=verdict, colours=colours)


@pytest.fixture(scope="module")
def engine():
    with api.sync_playwright() as found:
        yield found


@pytest.fixture(scope="module")
def browser(engine):
    with launched(engine, "webgl") as running:
        yield running


@pytest.fixture(scope="module")
def pages(engine, browser, file):
    """The page of the folding, once its first picture is there: with WebGL, and without."""
    made = {}

    def page_of(kind):
        if kind not in made:
            running = browser if kind == "webgl" else launched(engine, kind)
            made[kind] = page = running.new_page(viewport=SIZE)
            page.wrong, page.asked = [], []
            page.on("pageerror", lambda error: page.wrong.append(str(error)))
            page.on("console", lambda said: said.type == "error" and page.wrong.append(said.text))
            page.on("request", lambda request: page.asked.append(request.url))
            opened(page, file.as_uri())
        return made[kind]

    yield page_of
    for kind, page in made.items():
        page.close() if kind == "webgl" else page.context.browser.close()


@pytest.fixture(params=["webgl", pytest.param("flat", marks=pytest.mark.slow)])
def kind(request):
    return request.param


@pytest.fixture
def view(kind, pages):
    """The page as it is at first, drawn by both kinds; no errors may come up."""
    yield as_at_first(pages(kind))
    assert not pages(kind).wrong


@pytest.fixture
def one(pages):
    """The same by WebGL alone, for what has nothing to do with drawing."""
    yield as_at_first(pages("webgl"))
    assert not pages("webgl").wrong


def as_at_first(page):
    ask(page, "[p.pause(), p.show(0), p.pick(-1), p.resetView(), p.openDetails(false)].length")
    ask(page, "[p.setDirection(1), p.setStyle('blocks'), p.setMode('chain')].length")
    page.evaluate("document.activeElement.blur()")
    return page


def pose(page):
    return np.array(ask(page, "Array.from(p.pose)")).reshape(-1, 3)


def test_the_first_picture_is_there_and_nothing_else_is_asked_for(view, file, kind, folding):
    assert ask(view, "p.scene.kind") == kind
    assert colourful(shot(view)) > 0.05
    assert colourful(shot(view, ".inset canvas")) > 0.03
    assert view.asked == [file.as_uri()]
    assert view.inner_text(".badge") == "certified"
    assert view.inner_text(".where") == "Folded: one chain of 18 blocks, 36 voxels"
    np.testing.assert_array_equal(pose(view), folding.path.voxels)


@pytest.mark.slow
def test_pictures_change_with_time_and_not_otherwise(view):
    first = shot(view)
    ask(view, "p.show(12.5)")
    second = shot(view)
    assert (first != second).any(axis=-1).mean() > 0.02
    ask(view, "p.show(0)")
    assert alike(shot(view), first)


@pytest.mark.slow
def test_the_picture_keeps_its_size_whatever_is_said(view):
    for width in (360, 720, 1000):
        view.set_viewport_size({"width": width, "height": 640})
        heights = ask(
            view,
            """Array.from({ length: 65 }, (_, k) => {
              p.show(k / 2);
              return p.ui.stage.clientHeight;
            })""",
        )
        assert len(set(heights)) == 1, width
    view.set_viewport_size(SIZE)


def test_keys_lead_through_the_motion_to_the_straight_line(view, folding):
    time = lambda: ask(view, "p.state.time")  # noqa: E731
    ticks = ask(view, "p.story.ticks")
    for key, expected in [
        ("ArrowRight", 1),
        ("ArrowRight", 2),
        ("ArrowLeft", 1),
        ("Home", 0),
        ("PageDown", ticks[0]),
        ("PageDown", ticks[1]),
        ("PageUp", ticks[0]),
        ("End", len(folding.motion)),
    ]:
        view.keyboard.press(key)
        assert time() == expected, key
    assert (np.ptp(pose(view), axis=0) > 1e-3).sum() == 1
    assert np.ptp(pose(view)) == pytest.approx(len(folding.path) - 1, abs=40)
    assert view.inner_text(".where").startswith("Straight after 32 moves")


@pytest.mark.slow
def test_the_slider_leads_too(one):
    slider = one.locator("input.time")
    box = slider.bounding_box()
    one.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    assert ask(one, "p.state.time") == pytest.approx(16, abs=0.5)
    slider.press("ArrowRight")  # a move, not the step of a slider
    assert ask(one, "p.state.time") == 17
    assert slider.get_attribute("aria-valuetext").startswith("Move 18 of 32")


@pytest.mark.slow
def test_play_runs_to_the_end_and_back(one):
    ask(one, "p.setSpeed(80)")
    one.get_by_role("button", name="Play").click()
    until(one, "p.state.time > 1")
    assert one.inner_text(".play") == "Pause"
    until(one, "p.state.time === 32")
    assert one.inner_text(".play") == "Play"
    one.get_by_role("button", name="Fold", exact=True).click()
    one.keyboard.press("Space")  # presses the button that has the focus, which is pressed already
    one.locator("canvas.view").focus()
    one.keyboard.press("Space")
    until(one, "p.state.time === 0")


@pytest.mark.slow
def test_a_film_is_one_picture_a_frame_and_then_rests(view):
    ask(view, "p.setSpeed(60)")
    drawn, shown = view.evaluate("""async () => {
      const p = document.getElementById('player').player;
      const before = p.frames;
      let shown = 0;
      const count = () => { shown += 1; if (p.state.playing) requestAnimationFrame(count); };
      p.play();
      await new Promise((done) => {
        p.on((name, value) => name === 'playing' && !value && done());
        requestAnimationFrame(count);
      });
      return [p.frames - before, shown];
    }""")
    assert shown > 3
    assert drawn <= shown + 1
    until(view, "!p.waiting")
    still = ask(view, "p.frames")
    view.wait_for_timeout(200)
    assert ask(view, "p.frames") == still


def nearest_block(page):
    """The bar of the block that is nearest to the eye, and where its middle is on the page."""
    matrix, target, box = ask(
        page,
        "[Array.from(p.frame().camera.matrix), p.frame().camera.target, "
        "p.ui.view.getBoundingClientRect().toJSON()]",
    )
    joints = pose(page)
    middles = (joints[:-1:2] + joints[1::2]) / 2 - target
    x, y, _, depth = (
        np.reshape(matrix, (4, 4)).T @ np.column_stack([middles, np.ones(len(middles))]).T
    )
    block = int(depth.argmin())
    across, down = 0.5 + x / depth / 2, 0.5 - y / depth / 2
    left, top = box["x"] + box["width"] * across[block], box["y"] + box["height"] * down[block]
    return 2 * block, float(left), float(top)


@pytest.mark.slow
def test_a_click_picks_the_block_under_it(view, folding):
    bar, x, y = nearest_block(view)
    before = shot(view)
    view.mouse.click(x, y)
    assert ask(view, "p.state.picked") == bar
    card = view.inner_text(".card")
    assert f"Block {bar // 2 + 1} of 18" in card
    voxel = ", ".join(str(c) for c in folding.path.voxels[bar])
    assert f"bar {bar}, voxels ({voxel}) and" in card
    assert f"number: {bar}" in card
    assert (shot(view) != before).any(axis=-1).mean() > 0.003
    view.mouse.click(30, 300)
    assert ask(view, "p.state.picked") == -1
    view.locator("input.block").fill("7")
    assert ask(view, "p.state.picked") == 12
    view.keyboard.press("Escape")
    assert view.locator(".card").is_hidden()


@pytest.mark.slow
def test_dragging_turns_the_picture_and_picks_nothing(view):
    before = shot(view)
    view.mouse.move(360, 200)
    view.mouse.down()
    view.mouse.move(420, 230, steps=4)
    view.mouse.up()
    assert ask(view, "p.state.picked") == -1
    assert (shot(view) != before).any(axis=-1).mean() > 0.02
    view.keyboard.press("0")
    view.evaluate("document.activeElement.blur()")  # no ring of the focus in the picture
    assert alike(shot(view), before)


@pytest.mark.slow
def test_details_say_what_the_judge_said(one):
    one.get_by_role("button", name="Details").click()
    drawer = one.inner_text(".drawer")
    assert "free of collisions" in drawer
    assert "bars of diameter 0.999 voxels and bends up to 90°" in drawer
    assert "Nearest: bars" in drawer
    for style in ("printed", "bars", "lines", "blocks"):
        before = shot(one)
        one.select_option("select.style", style)
        assert (shot(one) != before).any() or style == "blocks"
    one.select_option("select.colour", "number")
    assert one.inner_text(".legend").split() == ["0", "34"]


@pytest.mark.slow
def test_a_picture_can_be_kept(one):
    one.get_by_role("button", name="Details").click()
    with one.expect_download() as coming:
        one.get_by_role("button", name="Save this picture").click()
    assert coming.value.suggested_filename == "block-0.png"
    kept = np.asarray(Image.open(coming.value.path()).convert("RGB")).astype(int)
    assert colourful(kept) > 0.05


@pytest.mark.slow
def test_a_link_leads_to_its_moment(fresh, file):
    ask(fresh, "p.show(7.25)")
    fresh.get_by_role("button", name="Details").click()
    fresh.get_by_role("button", name="Link to this moment").click()
    assert fresh.url == f"{file.as_uri()}#t=7.25"
    fresh.reload()
    until(fresh, "p?.frames > 0")
    assert ask(fresh, "p.state.time") == 7.25


@pytest.mark.slow
def test_a_lost_picture_comes_back(one):
    before = shot(one)
    one.evaluate("""async () => {
      const player = document.getElementById('player').player;
      const lost = player.ui.view.getContext('webgl2').getExtension('WEBGL_lose_context');
      lost.loseContext();
      await new Promise((done) => setTimeout(done, 50));
      lost.restoreContext();
      await new Promise((done) => setTimeout(done, 200));
    }""")
    assert alike(shot(one), before)


@pytest.fixture
def fresh(browser, file):
    """A page of its own, for what cannot be undone."""
    page = opened(browser.new_page(viewport=SIZE), file.as_uri())
    yield page
    page.close()


@pytest.mark.slow
def test_slow_machines_get_coarser_pictures_and_then_flat_ones(fresh):
    sides = []
    for _ in range(4):
        sides.append(ask(fresh, "(p.draw(), [p.ui.view.width, p.scene.kind])"))
        ask(fresh, "Array.from({ length: 10 }, () => p.watch(80)).length")
    assert sides[:3] == [[720, "webgl"], [504, "webgl"], [360, "webgl"]]
    assert sides[3][1] == "flat"
    assert colourful(shot(fresh)) > 0.03
    bar, x, y = nearest_block(fresh)
    fresh.mouse.click(x, y)
    assert ask(fresh, "p.state.picked") == bar


@pytest.mark.slow
def test_on_a_phone_nothing_sticks_out(browser, file):
    page = browser.new_page(viewport={"width": 360, "height": 640})
    page.goto(file.as_uri())
    until(page, "p?.frames > 0")
    sizes = page.evaluate("""() => [...document.querySelectorAll('#player :is(button, input, p)')]
      .filter((part) => part.offsetParent).map((part) => part.getBoundingClientRect())
      .map((box) => [box.left, box.right, box.top, box.bottom])""")
    left, right, top, bottom = np.array(sizes).T
    assert left.min() >= 0
    assert right.max() <= 360
    assert top.min() >= 0
    assert bottom.max() <= 640
    assert colourful(shot(page)) > 0.03
    page.close()


@pytest.mark.slow
def test_where_less_motion_is_wanted_it_goes_by_steps(browser, file):
    page = browser.new_page(reduced_motion="reduce")
    page.goto(file.as_uri())
    until(page, "p?.frames > 0")
    ask(page, "p.setSpeed(16)")
    page.evaluate("""() => { const p = document.getElementById('player').player;
      window.times = new Set(); p.on((name, time) => name === 'time' && window.times.add(time));
      p.play(); }""")
    until(page, "p.state.time === 32")
    assert set(page.evaluate("[...window.times]")) == {16, 32}
    page.close()


@pytest.mark.slow
def test_over_the_web_it_is_one_request_too(browser, file):
    class Quiet(http.server.SimpleHTTPRequestHandler):
        asked = []

        def log_message(self, *_):
            self.asked.append(self.path)

    handler = functools.partial(Quiet, directory=str(file.parent))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        page = browser.new_page()
        page.goto(f"http://127.0.0.1:{server.server_port}/{file.name}")
        until(page, "p?.frames > 0")
        page.wait_for_timeout(300)
        page.close()
        server.shutdown()
    assert Quiet.asked == [f"/{file.name}"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('"moves":"', '"moves":"hop ', "move 0 reads 'hop', which is not a move"),
        (
            '"format":"lineup-motion","version":2',
            '"format":"lineup-motion","version":9',
            "version 9",
        ),
        ('"motion":{', '"motion":{{', "this is not a motion"),
    ],
)
def test_a_page_that_was_damaged_says_what_is_wrong(browser, file, tmp_path, old, new, says):
    text = file.read_text()
    assert text.count(old) == 1
    (tmp_path / "bad.html").write_text(text.replace(old, new))
    page = browser.new_page()
    page.goto((tmp_path / "bad.html").as_uri())
    message = page.get_by_role("alert")
    message.wait_for()
    assert says in message.inner_text()
    page.close()


@pytest.mark.slow
def test_a_name_is_text_and_nothing_else(browser, folding, tmp_path):
    name = "</script><script>window.hurt=1</script><img src=x onerror=window.hurt=1>&amp;"
    refused = dataclasses.replace(
        lu.certify(folding.motion), ok=False, reason="<b>bars collide</b>", where=3
    )
    made = lu.write_player(
        folding,
        tmp_path / "x.html",
        name=name,
        certificate=refused,
        colours={name: np.zeros(len(folding.path) - 1)},
    )
    page = browser.new_page()
    page.goto(made.as_uri())
    until(page, "p?.frames > 0")
    assert page.inner_text(".name") == name
    assert page.title() == f"{name}: motion"
    assert page.evaluate("window.hurt") is None
    assert page.inner_text(".badge") == "refused"
    page.click(".badge")
    assert "Why: <b>bars collide</b>." in page.inner_text(".verdict")
    page.get_by_role("button", name="Show where it fails").click()
    assert ask(page, "p.state.time") == 3.5
    page.close()
