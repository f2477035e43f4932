"""A task of a user by mouse and by keyboard: own runs, a changed rig, a study of it, and what is taken away."""

import re

import pytest
from playwright.sync_api import Page, expect
from tests.browser.pages import EXAMPLES, LOAD, SPEED, at_rest
from tests.browser.walks import HANDS, Mouse
from tests.chromium import CHROMIUM

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium"),
]


@pytest.mark.parametrize("hand", HANDS)
def test_a_rig_with_own_runs_is_predicted_and_mapped(hand: type[Mouse], page: Page) -> None:
    walk = hand(page, "predict")
    walk.choose("rig", "tribometer_uncertain")
    at_rest(page)
    walk.write(f"field:{LOAD}", "4 N")
    walk.give("choose-runs", EXAMPLES / "tribometer-runs.csv")
    expect(page.get_by_test_id("remove-runs")).to_be_visible()
    at_rest(page)
    walk.picture("predicted")
    walk.press("keep")
    walk.write(f"field:{SPEED}", "40 mm/s")
    expect(page.get_by_test_id("differences")).to_be_visible()
    walk.picture("compared")
    walk.press("page:explore")
    at_rest(page)
    walk.pick("study:map")
    at_rest(page)
    walk.picture("mapped")
    walk.press("take")
    walk.press("take:command")
    expect(page.get_by_test_id("taken")).to_have_value(re.compile("^sonolube map tribometer_uncertain.toml"))
