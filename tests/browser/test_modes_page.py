"""Page Modes: a horn designer's task by mouse and by keyboard, and the picture of a mode that turns and moves."""

import io
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from PIL import Image, ImageChops
from playwright.sync_api import Browser, Page, expect
from tests.browser.pages import opened, show
from tests.browser.test_pages import faults_of_access
from tests.browser.walks import HANDS, Mouse
from tests.browser.workbench import Served
from tests.chromium import CHROMIUM

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium"),
]
_SEEN, _LINES = 16, 0.003  # of 255 shades, and of all pixels, where two pictures differ
FREQUENCIES = {"mouse": "20 kHz", "keyboard": "25 kHz"}


@pytest.fixture(autouse=True)
def mesher() -> None:
    """Skip without the mesher."""
    pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")


@pytest.mark.parametrize("hand", HANDS)
def test_a_horn_is_tuned_and_its_drawing_taken_away(hand: type[Mouse], browser: Browser, workbench: Served) -> None:
    with opened(browser, workbench, reduced_motion="reduce", bypass_csp=True) as page:
        walk = hand(page, "horn-designer")
        walk.press("page:modes")
        walk.pick("work:tune")
        walk.choose("modes:part", "cylinder")
        walk.choose("modes:material", "titanium_6al4v")
        walk.write("modes:tune.frequency", FREQUENCIES[hand.name])
        walk.write("modes:tune.amplitude", "20 um")
        walk.write("modes:tune.tolerance", "0.1")
        walk.picture("asked")
        walk.press("start-job")
        expect(page.get_by_test_id("shapes")).to_be_visible()
        walk.pick("mode:bending 1")
        walk.pick("mode:axial 1")
        walk.choose("colour", "stress")
        walk.picture("tuned")
        assert faults_of_access(page) == []
        length = re.search(r"length([\d.]+) mm", page.get_by_test_id("modes-result").text_content() or "")
        assert length is not None
        with page.expect_download() as download:
            walk.press("file:cylinder-drawing.svg")
        assert f">{length[1]}<" in Path(download.value.path()).read_text(encoding="utf-8")


@pytest.fixture
def block(page: Page, workbench: Served) -> Page:
    """Page with the modes of a block."""
    page.emulate_media(reduced_motion="reduce")
    page.goto(f"{workbench.address}#/modes?part=block&modes.count=2&modes.tolerance=0.1")
    page.reload()
    expect(page.get_by_test_id("modes:part")).to_have_value("block")
    expect(page.get_by_test_id("start-job").or_(page.get_by_test_id("shapes"))).to_be_visible()
    # the button goes where a test before has left these modes, also between a look and a click
    page.evaluate("document.querySelector('[data-test=start-job]')?.click()")
    expect(page.get_by_test_id("shapes")).to_be_visible()
    return page


def picture(page: Page) -> bytes:
    """The canvas as it is seen."""
    return page.get_by_test_id("surface-canvas").screenshot()


def differ(one: bytes, other: bytes) -> bool:
    """Whether two pictures differ in more than the pixels of lines."""
    first, second = (Image.open(io.BytesIO(each)).convert("L") for each in (one, other))
    changed = sum(ImageChops.difference(first, second).histogram()[_SEEN:])
    return changed > _LINES * first.width * first.height


def changed_by(page: Page, deed: Callable[[], Any]) -> bool:
    """Whether something changes what the canvas shows."""
    before = picture(page)
    deed()
    return differ(before, picture(page))


def test_the_picture_turns_and_moves_by_keys_pointer_and_buttons(block: Page) -> None:
    canvas = block.get_by_test_id("surface-canvas")
    assert not changed_by(block, lambda: block.mouse.wheel(0, -200))  # the page scrolls instead
    canvas.focus()
    block.keyboard.press("Home")  # which shows the focus too
    first = picture(block)
    for key in ("ArrowLeft", "ArrowUp", "+"):
        assert changed_by(block, lambda key=key: block.keyboard.press(key)), key  # type: ignore[misc]
    block.keyboard.press("Home")
    assert not differ(picture(block), first)
    box = canvas.bounding_box()
    assert box is not None
    block.mouse.move(box["x"] + 60, box["y"] + 60)
    assert changed_by(block, lambda: block.mouse.wheel(0, -200))
    block.mouse.down()
    assert changed_by(block, lambda: block.mouse.move(box["x"] + 160, box["y"] + 90))
    block.mouse.up()
    assert changed_by(block, lambda: block.get_by_test_id("surface:ArrowRight").click())
    assert changed_by(block, lambda: block.get_by_test_id("phase").fill("270"))
    block.get_by_test_id("play").click()
    expect(block.get_by_test_id("phase")).not_to_have_value("270")
    block.get_by_test_id("play").click()


def test_the_table_stays_where_the_picture_is_lost(block: Page) -> None:
    block.get_by_test_id("surface-canvas").evaluate(
        "(each) => { window.lost = each.getContext('webgl2').getExtension('WEBGL_lose_context'); lost.loseContext(); }"
    )
    expect(block.get_by_test_id("no-webgl")).to_be_visible()
    expect(block.get_by_test_id("mode-table")).to_contain_text("bending 1")
    block.evaluate("lost.restoreContext()")
    expect(block.get_by_test_id("surface-canvas")).to_be_visible()


def test_what_is_refused_is_said_below_its_field_and_kept(page: Page, workbench: Served) -> None:
    show(page, workbench, "tribometer", {}, where="modes")
    page.get_by_test_id("work:tune").check()
    page.get_by_test_id("modes:part").select_option("cylinder")
    page.get_by_test_id("modes:tune.frequency").fill("20 kg")
    page.keyboard.press("Enter")
    page.get_by_test_id("start-job").click()
    field = page.get_by_test_id("modes:tune.frequency")
    expect(field).to_have_attribute("aria-invalid", "true")
    expect(page.locator(f"#{field.get_attribute('aria-describedby')}")).to_contain_text("kg is a mass")
    expect(field).to_have_value("20 kg")
