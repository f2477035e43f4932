"""Page Lab shows a kind of step that was added by one class in the lane of what it sets, and inserts it."""

from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect
from pytest import MonkeyPatch
from tests.browser.pages import at_rest, opened
from tests.browser.workbench import served
from tests.chromium import CHROMIUM
from tests.facts.protocol.test_added_step import with_ramp
from tests.test_additions import RIG


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium")
def test_the_time_line_in_the_browser_has_an_added_step_in_the_lane_of_the_drive(
    copied_package: Path, browser: Browser, monkeypatch: MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = with_ramp(copied_package)
    monkeypatch.setenv("PYTHONPATH", str(folder))
    with served(tmp_path_factory.mktemp("workbench"), str(RIG)) as workbench, opened(browser, workbench) as page:
        page.get_by_test_id("page:lab").click()
        at_rest(page)
        page.get_by_test_id("protocol-file").set_input_files(str(folder / "ramp.toml"))
        block = page.get_by_test_id("step:3")
        expect(block).to_have_class("block is-drive")
        lane = page.locator(".lane", has_text="Drive")
        assert block.evaluate("each => each.style.gridRowStart") == lane.evaluate("each => each.style.gridRowStart")
        page.get_by_test_id("new-step").select_option("voltage_ramp")
        page.get_by_test_id("insert").click()
        expect(page.get_by_test_id("step:2")).to_have_class("block is-drive is-chosen")
