"""A report in a real browser: it loads without a word or a request, plays, and does what is clicked and typed."""

import io
import shutil
import time
from contextlib import contextmanager

import numpy as np
import pytest
from PIL import Image

from kreisel import show
from tests.show.reports import made

pytest.importorskip("bokeh", reason="bokeh is not installed: pip install kreisel[report]")
browsers = pytest.importorskip("playwright.sync_api", reason="the extra oracle brings playwright")
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
if CHROMIUM is None:
    pytest.skip("no Chromium on this machine: apt install chromium", allow_module_level=True)

BODY = ((215, 38, 61), (163, 27, 45), (110, 20, 32))  # above, at its sides and below
ORANGE = (213, 94, 0)  # whatever is x


@pytest.fixture(scope="module")
def result():
    return made(duration=20.0, rate_hz=50.0)


@pytest.fixture(scope="module")
def opened(result, tmp_path_factory):
    """The page, and all that it said, got wrong or asked for."""
    path = show.write_report(result, tmp_path_factory.mktemp("report") / "report.html")
    heard = []
    with browser() as chromium:
        page = chromium.new_page(viewport={"width": 1300, "height": 900}, color_scheme="light")
        page.on("console", lambda said: heard.append(f"{said.type}: {said.text}"))
        page.on("pageerror", lambda error: heard.append(f"error: {error}"))
        page.on("requestfailed", lambda request: heard.append(f"failed: {request.url}"))
        page.on("request", lambda request: heard.append(f"request: {request.url}"))
        page.goto(path.as_uri())
        page.wait_for_selector("[data-ready]", state="attached")
        yield page, heard, path.as_uri()


@contextmanager
def browser():
    with browsers.sync_playwright() as playwright:
        # Root may not use the sandbox, and there is no GPU to be had everywhere.
        chromium = playwright.chromium.launch(
            executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"]
        )
        yield chromium
        chromium.close()


@pytest.fixture
def page(opened):
    """The page as it was when it had just been opened, but for what it is told to keep."""
    page = opened[0]
    page.evaluate(
        "kreisel.play(false); kreisel.showAll(); kreisel.chooseAnswer(0); kreisel.seek(kreisel.data.start)"
    )
    yield page
    page.evaluate("document.querySelectorAll('[aria-pressed=false]:not(#theme)').forEach(b => b.click())")


def until(page, condition):
    """Wait for what has to become true; the page's own rules forbid the waiting that playwright offers."""
    deadline = time.monotonic() + 20.0
    while not page.evaluate(condition):
        assert time.monotonic() < deadline, f"{condition} never came true"
        page.wait_for_timeout(20)


def pixels(page, selector):
    return np.asarray(Image.open(io.BytesIO(page.locator(selector).screenshot())).convert("RGB")).astype(int)


def like(picture, colour, near=30):
    """Columns and rows (n, 2) of the pixels with nearly this colour."""
    return np.argwhere(np.abs(picture - colour).sum(axis=2) < near)[:, ::-1]


def cursor_is_off(page, now):
    """Pixels by which each chart's cursor is off where Bokeh itself would draw the time `now`."""
    return page.evaluate(
        """now => kreisel.charts.map(chart => {
             const plot = chart.element.querySelector(".plot").getBoundingClientRect();
             const line = chart.cursor.getBoundingClientRect();
             return line.left + line.width / 2 - plot.left - chart.view.frame.x_scale.compute(now);
           })""",
        now,
    )


def test_it_loads_without_a_word_or_a_request(opened, page):
    _, heard, own = opened
    page.wait_for_timeout(300)
    assert [h for h in heard if not h.startswith("console info: [bokeh") and "document idle" not in h] == [
        f"request: {own}"
    ]


def test_play_moves_the_body_and_the_cursor(page):
    before = pixels(page, "#space")
    page.click("#play")
    until(page, "kreisel.time > 0.5")
    page.click("#play")
    now = page.evaluate("kreisel.time")
    assert 0.5 < now < 19.0 and not page.evaluate("kreisel.playing")
    assert (pixels(page, "#space") != before).any()
    # The pixel that it is rounded to, and half of the line's width.
    np.testing.assert_allclose(cursor_is_off(page, now), 0.0, atol=1.0)


def test_the_body_is_drawn_where_it_was(page, result):
    for part in ("trails", "estimate", "imu"):
        page.click(f"[data-part={part}]")
    for row in (100, 400):
        page.evaluate(f"kreisel.seek({result.motion.t[row]})")
        away = (result.motion.p_NB[row] - page.evaluate("kreisel.data.space.centre")).tolist()
        expected = page.evaluate(f"kreisel.scene.seen({away})")
        seen = np.concatenate([like(pixels(page, "#space"), colour) for colour in BODY])
        seen = seen[seen[:, 1] > 60]  # below the row of buttons, one of which is as red as the body
        assert len(seen) > 500
        # The wedge is 100 pixels long; how far its middle is from its centre of mass depends on the view.
        np.testing.assert_allclose(seen.mean(axis=0), expected, atol=15.0)


def test_a_click_on_the_legend_hides_its_line_and_a_second_one_shows_it(page):
    chart = '[data-chart="gyro"]'
    shown = len(like(pixels(page, f"{chart} .plot"), ORANGE))
    page.click(f'{chart} [data-entry="x"]')
    page.wait_for_timeout(200)
    assert len(like(pixels(page, f"{chart} .plot"), ORANGE)) == 0 < shown
    assert page.get_attribute(f'{chart} [data-entry="x"]', "aria-pressed") == "false"
    page.click(f'{chart} [data-entry="x"]')
    page.wait_for_timeout(200)
    assert len(like(pixels(page, f"{chart} .plot"), ORANGE)) == shown


def test_all_truth_of_a_chart_is_one_entry(page):
    page.click('[data-chart="attitude"] [data-entry="truth"]')
    hidden = page.evaluate(
        "kreisel.charts[0].traces.filter(t => !t.renderer.visible).map(t => t.name)",
    )
    assert hidden == ["true_x", "true_y", "true_z"]


def test_a_click_in_a_chart_goes_to_that_time(page):
    box = page.locator('[data-chart="velocity"] .plot').bounding_box()
    frame = page.evaluate(
        "(({left, width}) => [left, width])(kreisel.charts.find(c => c.name === 'velocity'))"
    )
    page.locator('[data-chart="velocity"] .plot').click(position={"x": frame[0] + 0.5 * frame[1], "y": 60})
    assert box is not None
    # The middle of the axis is the middle of the run; a pixel is 0.04 s.
    assert page.evaluate("kreisel.time") == pytest.approx(10.0, abs=0.05)
    np.testing.assert_allclose(cursor_is_off(page, 10.0), 0.0, atol=1.5)


def test_a_drag_in_one_chart_zooms_all_and_a_double_click_shows_all(page):
    plot = page.locator('[data-chart="errors"] .plot')
    plot.scroll_into_view_if_needed()
    box = plot.bounding_box()
    page.mouse.move(box["x"] + 150, box["y"] + 60)
    page.mouse.down()
    page.mouse.move(box["x"] + 350, box["y"] + 80, steps=5)
    page.mouse.up()
    spans = page.evaluate("kreisel.charts.map(c => c.model.x_range.end - c.model.x_range.start)")
    assert len(set(spans)) == 1 and 4.0 < spans[0] < 10.0
    assert page.evaluate("kreisel.time") == 0.0  # a drag is no click
    plot.dblclick(position={"x": 200, "y": 60})
    assert page.evaluate("kreisel.range.end - kreisel.range.start") > 20.0


def test_numbers_are_those_of_the_samples_under_the_cursor(page, result):
    page.evaluate(f"kreisel.seek({result.motion.t[333]})")
    told = page.locator('[data-chart="accel"] output').all_inner_texts()
    found = [float(text.replace("−", "-")) for text in told]
    np.testing.assert_allclose(found, result.recordings[0].accel[333], atol=6e-3)  # two or three places shown
    speed = page.locator('[data-tile="velocity"] b').inner_text()
    assert float(speed) == pytest.approx(np.linalg.norm(result.motion.v_NB[333]), abs=6e-3)


def test_another_imu_and_filter_are_chosen_by_name(page, result):
    page.select_option("#imu", "elbow")
    page.select_option("#filter", "six")
    page.evaluate("kreisel.seek(5.0)")
    shown = page.evaluate("kreisel.charts.find(c => c.name === 'gyro').traces[1].line.y[250]")
    assert shown == pytest.approx(result.recordings[1].gyro[250, 1], abs=1e-6)
    shown = page.evaluate("kreisel.charts.find(c => c.name === 'bias').traces.at(-1).line.y[250]")
    assert shown == pytest.approx(np.rad2deg(result.estimates[3].attitude.gyro_bias[250, 2]), abs=1e-6)
    assert page.locator("#errors [data-chosen]").inner_text().startswith("elbow, six")
    page.locator("#errors tbody tr").nth(1).click()
    assert page.input_value("#imu") == "wrist" and page.input_value("#filter") == "six"


def test_keys(page):
    page.locator("#space").focus()
    page.keyboard.press("ArrowRight")
    assert page.evaluate("kreisel.time") == pytest.approx(0.2)
    page.keyboard.press("End")
    assert page.evaluate("kreisel.time") == 20.0
    page.keyboard.press("ArrowUp")
    assert page.evaluate("kreisel.speed") == 2
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Home")
    page.keyboard.press(" ")
    assert page.evaluate("kreisel.playing") and page.get_attribute("#play", "aria-label") == "pause"
    page.keyboard.press(" ")
    assert not page.evaluate("kreisel.playing")


def test_dragging_turns_the_eye_and_a_double_click_brings_it_back(page):
    box = page.locator("#space").bounding_box()
    first = page.evaluate("({...kreisel.scene.view})")
    page.mouse.move(box["x"] + 300, box["y"] + 300)
    page.mouse.down()
    page.mouse.move(box["x"] + 400, box["y"] + 300, steps=4)
    page.mouse.up()
    assert page.evaluate("kreisel.scene.view.azimuth") == pytest.approx(first["azimuth"] - 40.0)
    page.mouse.wheel(0, -300)  # the canvas has been taken hold of
    until(page, "kreisel.scene.view.zoom > 1.2")
    page.locator("#space").dblclick(position={"x": 300, "y": 300})
    assert page.evaluate("({...kreisel.scene.view})") == first


def test_the_wheel_scrolls_the_page_until_the_canvas_is_taken_hold_of(page):
    page.evaluate("document.activeElement.blur(); scrollTo(0, 0)")
    box = page.locator("#space").bounding_box()
    page.mouse.move(box["x"] + 300, box["y"] + 300)
    page.mouse.wheel(0, 200)
    until(page, "scrollY > 0")
    assert page.evaluate("kreisel.scene.view.zoom") == 1
    page.evaluate("scrollTo(0, 0)")


def test_light_and_dark(page):
    light = pixels(page, "#space").mean()
    page.click("#theme")
    assert pixels(page, "#space").mean() < 0.4 * light
    axis = page.evaluate("kreisel.charts[0].model.left[0].major_label_text_color")
    assert axis == page.evaluate("colour('faint')") == "#9AA8B6"
    page.click("#theme")
    assert page.evaluate("document.documentElement.dataset.theme") == "light"
    page.emulate_media(color_scheme="dark")
    until(page, "document.documentElement.dataset.theme === 'dark'")
    page.emulate_media(color_scheme="light")
    until(page, "document.documentElement.dataset.theme === 'light'")


def test_on_a_narrow_screen_charts_stand_in_one_column_and_nothing_sticks_out(page):
    page.set_viewport_size({"width": 400, "height": 800})
    page.wait_for_timeout(400)
    assert page.evaluate("document.documentElement.scrollWidth") <= 400
    lefts = page.evaluate("[...document.querySelectorAll('.chart')].map(c => c.getBoundingClientRect().left)")
    assert len(set(lefts)) == 1
    page.evaluate("kreisel.seek(7.0)")
    np.testing.assert_allclose(cursor_is_off(page, 7.0), 0.0, atol=1.0)
    page.set_viewport_size({"width": 1300, "height": 900})
    page.wait_for_timeout(400)


def test_playback_in_a_part_of_the_time_turns_the_charts_over(page):
    page.evaluate("kreisel.range.setv({start: 2, end: 4}); kreisel.seek(3.9); kreisel.play(true)")
    until(page, "kreisel.time > 4.1")
    page.evaluate("kreisel.play(false)")
    start, end = page.evaluate("[kreisel.range.start, kreisel.range.end]")
    assert start < page.evaluate("kreisel.time") < end and end - start == pytest.approx(2.0)
