"""The page Data: a tribologist goes from recordings to a prediction with own runs, by mouse and by keyboard."""

import json
import re
from pathlib import Path
from typing import Literal

import pytest
from playwright.sync_api import Browser, Page, expect
from tests.browser.pages import at_rest, opened, show
from tests.browser.recordings import write_recordings
from tests.browser.test_pages import faults_of_access
from tests.browser.walks import HANDS, Keyboard, Mouse
from tests.browser.workbench import Served
from tests.chromium import CHROMIUM

import sonolube as sl

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium"),
]


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    return write_recordings(tmp_path_factory.mktemp("recordings"))


@pytest.mark.parametrize("hand", HANDS)
def test_recordings_lead_to_a_prediction_with_own_runs(hand: type[Mouse], page: Page, files: tuple[Path, Path]) -> None:
    walk = hand(page, "tribologist")
    walk.press("page:data")
    expect(page.get_by_test_id("choose-files")).to_be_visible()
    walk.picture("empty")
    walk.give("choose-files", *files)
    expect(page.get_by_test_id("measured")).to_contain_text("Reduction")
    at_rest(page)
    walk.picture("files")

    walk.write("set:sliding_speed", "20.3 mm/s")
    walk.write("set:normal_load", "3 N")
    before = page.get_by_test_id("measured").inner_text()
    drag_end(walk, "handle:step2:to", -40)
    expect(page.get_by_test_id("voltage:step2")).to_have_value("14 V")
    expect(page.get_by_test_id("measured")).not_to_have_text(before, use_inner_text=True)
    at_rest(page)
    walk.picture("steps")
    walk.press("add-to-runs")
    expect(page.get_by_test_id("use-note")).to_contain_text("2 added: 2 own runs.")
    walk.press("use-in-rig")
    expect(page.get_by_test_id("use-note")).to_contain_text("friction.friction_coefficient 0.33")

    walk.press("file:cell.csv")
    expect(page.get_by_test_id("columns")).to_contain_text("asked")
    walk.write("column:Zeit", "time ms", rests=False)
    walk.write("column:Zelle", "friction_force N", rests=False)
    walk.picture("columns")
    walk.press("use-columns")
    expect(page.get_by_test_id("measured")).to_contain_text("Mean force")
    at_rest(page)
    walk.press("add:rest")
    walk.press("add:step")
    expect(page.get_by_test_id("voltage:step1")).to_have_value("0 V")
    at_rest(page)
    walk.picture("stated")
    expect(page.get_by_test_id("results")).to_contain_text("cell.csv")
    with page.expect_download() as download:
        walk.press("take-results")
    text = Path(download.value.path()).read_text(encoding="utf-8")
    assert text.startswith(f"# sonolube {sl.__version__}: measure friction\nfile,part,quantity,")
    assert {line.split(",")[0] for line in text.splitlines()[2:]} == {"stairs.csv", "cell.csv"}

    walk.press("predict-with-runs")
    expect(page.get_by_test_id("own-runs")).to_contain_text("own-runs.csv")
    at_rest(page)
    walk.picture("predicted")


def drag_end(walk: Mouse, test: str, pixels: float) -> None:
    """Drag the end of a part, or move it by the arrow keys."""
    handle = walk.page.get_by_test_id(test)
    if isinstance(walk, Keyboard):
        walk.press(test, "Shift+ArrowLeft")
        walk.page.keyboard.press("Tab")
        return
    handle.scroll_into_view_if_needed()
    box = handle.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    walk.page.mouse.move(x, y)
    walk.page.mouse.down()
    walk.page.mouse.move(x + pixels, y, steps=4)
    walk.page.mouse.up()


def test_a_recording_is_moved_and_zoomed_and_the_window_is_kept(
    page: Page, workbench: Served, files: tuple[Path, Path]
) -> None:
    show(page, workbench, "tribometer", {}, where="data")
    page.get_by_test_id("data-files").set_input_files(files[0])
    shown = page.get_by_test_id("trace-shown")
    expect(shown).to_contain_text("0 to 59.99 s, 100 Hz, 6000 samples")
    at_rest(page)
    figure = page.get_by_test_id("trace-figure")
    figure.focus()
    page.keyboard.press("+")
    expect(shown).to_contain_text("5.999 to 53.991 s")
    page.keyboard.press("Home")
    expect(shown).to_contain_text("0 to 47.992 s")
    figure.hover(position={"x": 200, "y": 60})
    page.mouse.wheel(0, -100)
    expect(shown).not_to_contain_text("to 47.992 s")
    page.keyboard.press("0")
    expect(shown).to_contain_text("0 to 59.99 s")
    page.get_by_test_id("trace-bar").focus()
    page.keyboard.press("+")
    expect(page).to_have_url(re.compile("%22range%22"))
    page.reload()
    expect(shown).to_contain_text("5.999 to 53.991 s")
    at_rest(page)
    own = page.evaluate("new URLSearchParams(location.hash.split('?')[1]).get('own')")
    assert list(json.loads(own).values()) == [{"range": [pytest.approx(5.999), pytest.approx(53.991)]}]


def test_the_page_has_no_fault_of_access_and_does_not_scroll_sideways(
    browser: Browser, workbench: Served, files: tuple[Path, Path]
) -> None:
    with opened(browser, workbench, bypass_csp=True, reduced_motion="reduce") as page:
        show(page, workbench, "tribometer", {}, where="data")
        page.get_by_test_id("data-files").set_input_files(files)
        expect(page.get_by_test_id("measured")).to_contain_text("Reduction")
        at_rest(page)
        for width in (1280, 390, 320):
            page.set_viewport_size({"width": width, "height": 844})
            page.wait_for_function("document.documentElement.scrollWidth <= innerWidth")  # figures follow the width
        schemes: tuple[Literal["light", "dark"], ...] = ("light", "dark")
        for scheme in schemes:
            page.emulate_media(color_scheme=scheme)
            assert faults_of_access(page) == []
