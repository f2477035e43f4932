"""A scan and a spectrum on the page Data, by mouse and by keyboard: from the file to the rig."""

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect
from tests.browser.pages import at_rest, opened, show
from tests.browser.scans import CIRCUIT, GROOVE_DEPTH, write_groove, write_spectrum, write_stack_spectrum
from tests.browser.test_pages import faults_of_access
from tests.browser.walks import HANDS, Keyboard, Mouse
from tests.browser.workbench import Served
from tests.chromium import CHROMIUM

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium"),
]


def lengths(page: Page) -> dict[str, float]:
    """Ends of the section in um, from their fields."""
    names = ("from_x", "from_y", "to_x", "to_y")
    return {name: float(page.get_by_test_id(f"set:{name}").input_value().split()[0]) for name in names}


def answered(page: Page, test: str, name: str) -> str:
    """Text of a row of a table."""
    return page.get_by_test_id(test).locator("tr", has_text=name).first.locator("td").first.inner_text()


def move_end(walk: Mouse, page: Page) -> None:
    """Move the end of the section by 20 % of the height of the map, upwards."""
    if isinstance(walk, Keyboard):
        walk.reach("end:End")
        for _ in range(4):
            page.keyboard.press("Shift+ArrowUp")
        return
    end, plot = page.get_by_test_id("end:End"), page.locator(".chart-over")
    box, area = end.bounding_box(), plot.bounding_box()
    assert box is not None
    assert area is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x, y - 0.1 * area["height"])
    page.mouse.move(x, y - 0.2 * area["height"])
    page.mouse.up()


@pytest.mark.parametrize("hand", HANDS)
def test_a_groove_is_cut_measured_and_taken_away(
    hand: type[Mouse], page: Page, workbench: Served, tmp_path: Path
) -> None:
    show(page, workbench, "tribometer", {}, where="data")
    walk = hand(page, "scan")
    walk.give("choose-files", write_groove(tmp_path))
    expect(page.get_by_test_id("set:spacing")).to_be_visible()
    expect(page.locator("#set-spacing-refusal")).to_contain_text("the distance of pixels is not in the file")
    walk.write("set:spacing", "5 um", rests=False)
    page.get_by_test_id("scan").wait_for()
    at_rest(page)
    before = lengths(page)
    move_end(walk, page)
    at_rest(page)
    after = lengths(page)
    assert after["to_y"] == pytest.approx(before["to_y"] - 0.2 * 800, abs=8)  # um of 160 rows
    assert {**after, "to_y": 0} == {**before, "to_y": 0}
    walk.picture("section")
    walk.press("undo")
    at_rest(page)
    assert lengths(page) == before
    walk.write("set:to_x", "9 mm")
    expect(page.get_by_test_id("refused")).to_contain_text("x = 9000 um is outside the field")
    walk.write("set:to_x", "1 mm")
    expect(page.get_by_test_id("section")).to_contain_text("1 mm")
    with page.expect_download() as download:
        walk.press("take-section")
    note, heads, *rows = Path(download.value.path()).read_text(encoding="utf-8").splitlines()
    assert re.match(r"# sonolube [\d.]+: section of groove\.npy, sha256 \w{64}, from_x 0 µm", note)
    assert heads == "Distance [µm],Height [µm]"
    assert float(rows[-1].split(",")[0]) == pytest.approx(1000)
    walk.press("use-in-rig")
    height = answered(page, "measured", "contact.roughness.rms_height")
    assert float(height.split()[0]) == pytest.approx(
        float(answered(page, "measured", "Standard deviation of summit").split()[0])
    )
    walk.choose("set:measure", "groove")
    expect(page.get_by_test_id("measured")).to_contain_text("Greatest depth of the mean section")
    at_rest(page)
    depth = answered(page, "measured", "Greatest depth")
    assert float(depth.split()[0]) == pytest.approx(1e6 * GROOVE_DEPTH, rel=0.05)
    assert re.fullmatch(r"[\d.]+ um \([\d.]+ to [\d.]+\)", depth)
    walk.picture("groove")
    walk.choose("set:seen", "relief")
    expect(page.get_by_test_id("surface-canvas")).to_be_visible()
    walk.choose("set:stretch", "50")
    expect(page.get_by_test_id("surface-canvas")).to_have_attribute("aria-label", re.compile("50 times as high"))
    walk.picture("relief")
    walk.press("take")
    walk.press("take:command")
    expect(page.get_by_test_id("taken")).to_have_value("sonolube measure groove groove.npy --spacing '5 um'")
    walk.press("page:predict")
    at_rest(page)
    expect(page.get_by_test_id("field:contact.roughness.rms_height")).to_have_value(height)


@pytest.mark.parametrize("hand", HANDS)
def test_a_spectrum_gives_its_circuit_and_the_stack_of_a_rig(
    hand: type[Mouse], page: Page, workbench: Served, tmp_path: Path
) -> None:
    show(page, workbench, "tribometer", {}, where="data")
    walk = hand(page, "spectrum")
    walk.give("choose-files", write_spectrum(tmp_path))
    page.get_by_test_id("measured").wait_for()
    at_rest(page)
    known = CIRCUIT.branches[0]
    resistance = answered(page, "measured", "Electrical resistance, branch 1")
    assert float(resistance.split()[0]) == pytest.approx(known.resistance, rel=0.02)
    expect(page.locator('[data-test^="chart:"]')).to_have_count(2)
    walk.picture("circuit")
    walk.write("set:series_resistance", "5 V")
    expect(page.locator("#set-series_resistance-refusal")).to_contain_text("5 V is a voltage; expected a value in ohm")
    walk.write("set:series_resistance", "0 ohm")
    walk.choose("set:branches", "1")
    walk.choose("set:residual", "linear-magnitude")
    at_rest(page)
    walk.press("take")
    walk.press("take:python")
    expect(page.get_by_test_id("taken")).to_have_value(re.compile(r"residual='linear-magnitude', branches=1, series"))
    page.keyboard.press("Escape")
    walk.press("fit-stack")
    expect(page.get_by_test_id("measured")).to_contain_text("the stiffness is hardly determined")
    expect(page.get_by_test_id("use-in-rig")).to_have_count(0)
    walk.give("choose-files", write_stack_spectrum(tmp_path))
    walk.press("fit-stack")
    walk.press("use-in-rig")
    walk.picture("stack")
    entries = dict(re.findall(r"stack\.(\w+)\s+([\d.]+) ", page.get_by_test_id("measured").inner_text()))
    assert float(entries["free_capacitance"]) == pytest.approx(360, rel=0.02)  # nF
    assert float(entries["stack_stiffness"]) == pytest.approx(2, rel=0.02)  # GN/m
    assert set(entries) == {"free_capacitance", "free_stroke_per_volt", "stack_stiffness", "stack_damping"}


def test_scan_and_spectrum_can_be_read_and_reached_in_either_theme_and_on_a_phone(
    browser: Browser, workbench: Served, tmp_path: Path
) -> None:
    with opened(browser, workbench, bypass_csp=True, color_scheme="dark") as page:
        show(page, workbench, "tribometer", {}, where="data")
        walk = Mouse(page, "scan-shades")
        walk.give("choose-files", write_groove(tmp_path))
        walk.write("set:spacing", "5 um", rests=False)
        page.get_by_test_id("measured").wait_for()
        for seen, width, scheme in (("map", 1280, "dark"), ("relief", 320, "dark"), ("map", 390, "light")):
            page.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
            page.set_viewport_size({"width": width, "height": 800})
            walk.choose("set:seen", seen)
            at_rest(page)
            assert faults_of_access(page) == [], (seen, width)
            assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), (seen, width)
            walk.picture(f"{seen}-{width}")
        walk.give("choose-files", write_spectrum(tmp_path))
        page.get_by_test_id("set:residual").wait_for()
        page.get_by_test_id("measured").wait_for()
        at_rest(page)
        assert faults_of_access(page) == []
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        walk.picture("spectrum-390")
