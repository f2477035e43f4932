"""The calibration of a drive in the form of the rig: added to a rig without one, changed, and refused in one line."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect
from tests.browser.pages import at_rest, enter, opened
from tests.browser.workbench import served
from tests.chromium import CHROMIUM

import sonolube as sl

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium"),
]
KNOWN = {"pin": "brass", "disc": "304", "load": "5 N", "speed": "0.2 m/s", "frequency": "20 kHz", "amplitude": "2 um"}


@pytest.fixture
def page(browser: Browser, tmp_path: Path) -> Iterator[Page]:
    folder = sl.new(**KNOWN).write_folder(tmp_path / "brass")
    (tmp_path / "state").mkdir()
    with served(tmp_path / "state", str(folder)) as workbench, opened(browser, workbench) as found:
        yield found


def test_a_calibration_is_added_changed_and_scales_runs_by_their_voltage(page: Page) -> None:
    field = page.get_by_test_id("field:vibration.calibration")
    enter(page, "vibration.calibration", "25 V = 2 um")
    expect(field).to_have_value("25 V = 2 um")
    page.get_by_test_id("paste-runs").fill(
        "voltage_peak_to_peak [V]\tsliding_speed [mm/s]\tfriction_ratio\n25\t200\t0.8"
    )
    expect(page.get_by_test_id("runs-note")).to_contain_text("1 own run.")
    at_rest(page)
    by_own = page.get_by_test_id("statement").inner_text()
    enter(page, "vibration.calibration", "5 V = 2 um")
    expect(field).to_have_value("5 V = 2 um")
    assert page.get_by_test_id("statement").inner_text() != by_own
    enter(page, "vibration.calibration", "25 V")
    expect(page.locator("#field-vibration-calibration-refusal")).to_contain_text("25 V")
