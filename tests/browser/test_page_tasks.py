"""The task of each page by keyboard alone and by touch."""

import re
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect
from tests.browser.pages import AMPLITUDE, LOAD, SPEED, VOLTS, at_rest, go, numbers, opened, reach, show
from tests.browser.pictures import NEW
from tests.browser.workbench import Served
from tests.chromium import CHROMIUM

PHONE: dict[str, Any] = {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True}

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium"),
]


@pytest.fixture(scope="module")
def phone(browser: Browser, workbench: Served) -> Iterator[Page]:
    with opened(browser, workbench, **PHONE) as found:
        yield found


def press(page: Page, test: str, key: str = "Enter") -> None:
    """Reach an element by the tab key, and press a key on it."""
    if test.startswith("page:") and not page.get_by_test_id(test).is_visible():
        press(page, "more")
    reach(page, test)
    page.keyboard.press(key)


def test_predict_by_keyboard_alone(page: Page) -> None:
    before = numbers(page)
    reach(page, f"field:{VOLTS}")
    page.keyboard.press("Control+A")
    page.keyboard.type("14 V")
    page.keyboard.press("Enter")
    at_rest(page)
    assert numbers(page) != before
    reach(page, "drag:1")
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("Tab")
    at_rest(page)
    expect(page.get_by_test_id(f"field:{SPEED}")).not_to_have_value("20.3 mm/s")
    page.locator("#answer").focus()
    press(page, "keep")
    expect(page.get_by_test_id("differences")).to_be_visible()
    reach(page, "take", back=True)
    page.keyboard.press("Enter")
    press(page, "take:command")
    expect(page.get_by_test_id("taken")).to_have_value(re.compile(f"^sonolube predict .*--set '{VOLTS}=14 V'"))


def test_explore_by_keyboard_alone(page: Page) -> None:
    press(page, "page:explore")
    at_rest(page)
    page.locator("#answer").focus()
    reach(page, "study:voltage")
    page.keyboard.press("ArrowRight")
    expect(page.get_by_test_id("study:speed")).to_be_checked()
    at_rest(page)
    reach(page, "plot:0")
    page.keyboard.press("ArrowRight")
    expect(page.get_by_test_id("tip").first).to_be_visible()
    page.keyboard.press("Enter")
    expect(page.get_by_test_id("picked")).to_contain_text("Sliding speed")
    at_rest(page)
    expect(page.get_by_test_id(f"field:{SPEED}")).not_to_have_value("20.3 mm/s")


def test_jobs_by_keyboard_alone(page: Page) -> None:
    press(page, "page:explore")
    at_rest(page)
    press(page, "study:voltage", "ArrowLeft")  # to the last study, then on to that of a job
    while not page.get_by_test_id("study:start").is_checked():
        page.keyboard.press("ArrowLeft")
    page.get_by_test_id("start-job").wait_for()
    press(page, "start-job")
    page.get_by_test_id("study").wait_for()
    press(page, "page:jobs")
    at_rest(page)
    press(page, "open-job")
    page.get_by_test_id("job-result").wait_for()
    press(page, "delete-job")
    page.keyboard.press("Enter")
    expect(page.get_by_test_id("no-jobs")).to_be_visible()


def test_the_figures_of_the_dissertation_are_started_and_cancelled_by_keyboard_alone(page: Page) -> None:
    press(page, "page:dissertation")
    at_rest(page)
    press(page, "start-job")
    press(page, "cancel-job")
    expect(page.get_by_test_id("start-job")).to_be_visible()
    press(page, "page:jobs")
    expect(page.get_by_test_id("job-state").first).to_have_text("cancelled")
    press(page, "delete-job")
    page.keyboard.press("Enter")
    expect(page.get_by_test_id("no-jobs")).to_be_visible()


def test_a_new_rig_by_keyboard_alone(page: Page) -> None:
    press(page, "page:new")
    at_rest(page)
    for name, text in NEW.items():
        reach(page, f"new:{name}")
        page.keyboard.type(text)
    page.keyboard.press("Tab")
    press(page, "use-rig")
    page.locator('[data-test="page:predict"][aria-current=page]').wait_for()
    at_rest(page)
    expect(page.get_by_test_id(f"field:{LOAD}")).to_have_value("5 N")
    assert len(numbers(page)) >= 5


BARE = {"pin": "brass", "disc": "steel", "load": "5", "speed": "0,1", "frequency": "20", "amplitude": "2,5"}
READ = {"load": "5 N", "speed": "0.1 m/s", "frequency": "20 kHz", "amplitude": "2.5 µm"}


def test_bare_numbers_of_a_new_rig_take_the_customary_unit_which_is_shown_while_typing(page: Page) -> None:
    go(page, "new")
    for name, text in BARE.items():
        reach(page, f"new:{name}")
        page.keyboard.type(text)
        if name in READ:
            expect(page.get_by_test_id(f"read:{name}")).to_have_text(READ[name])
    page.keyboard.press("Tab")
    expect(page.get_by_test_id("made").locator("h2")).to_have_text("Brass pin on steel disc")
    page.get_by_test_id("new:amplitude").fill("2 µm")
    page.get_by_test_id("use-rig").click()  # while the rig with this amplitude is being made
    page.locator('[data-test="page:predict"][aria-current=page]').wait_for()
    at_rest(page)
    expect(page.get_by_test_id(f"field:{AMPLITUDE}")).to_have_value("2 µm")


def test_a_refused_answer_of_a_new_rig_leaves_no_rig_to_predict_with(page: Page, workbench: Served) -> None:
    page.goto(f"{workbench.address}#/new?" + "&".join(f"{name}={text}" for name, text in NEW.items()))
    expect(page.get_by_test_id("use-rig")).to_be_enabled()
    page.get_by_test_id("new:load").fill("5 kg")
    page.keyboard.press("Tab")
    expect(page.get_by_test_id("refusal:load")).to_be_visible()
    expect(page.get_by_test_id("read:load")).to_be_hidden()
    expect(page.get_by_test_id("use-rig")).to_be_disabled()
    page.get_by_test_id("new:load").fill("6")
    page.get_by_test_id("use-rig").click()
    page.locator('[data-test="page:predict"][aria-current=page]').wait_for()
    expect(page.get_by_test_id(f"field:{LOAD}")).to_have_value("6 N")


def test_predict_by_touch(phone: Page, workbench: Served) -> None:
    show(phone, workbench, "tribometer", {})
    slider = phone.get_by_test_id(f"slider:{VOLTS}")
    slider.scroll_into_view_if_needed()
    box = slider.bounding_box()
    assert box is not None
    phone.touchscreen.tap(box["x"] + 0.9 * box["width"], box["y"] + box["height"] / 2)
    expect(phone.get_by_test_id(f"field:{VOLTS}")).not_to_have_value("28 V")
    at_rest(phone)
    phone.get_by_test_id("keep").tap()
    expect(phone.get_by_test_id("differences")).to_be_visible()
    phone.get_by_test_id("take").tap()
    phone.get_by_test_id("take:command").tap()
    expect(phone.get_by_test_id("taken")).to_be_visible()


def test_explore_by_touch(phone: Page, workbench: Served) -> None:
    show(phone, workbench, "tribometer", {}, where="explore")
    phone.get_by_test_id("study:speed").tap()
    at_rest(phone)
    plot = phone.get_by_test_id("plot:0").first
    plot.scroll_into_view_if_needed()
    plot.tap()
    expect(phone.get_by_test_id("picked")).to_contain_text("Sliding speed")


def test_a_new_rig_by_touch(phone: Page, workbench: Served) -> None:
    show(phone, workbench, "tribometer", {}, where="new")
    for name, text in NEW.items():
        phone.get_by_test_id(f"new:{name}").tap()
        phone.get_by_test_id(f"new:{name}").fill(text)
    phone.keyboard.press("Tab")
    phone.get_by_test_id("use-rig").tap()
    phone.locator('[data-test="page:predict"][aria-current=page]').wait_for()
    at_rest(phone)
    assert len(numbers(phone)) >= 5


def test_jobs_by_touch(phone: Page, workbench: Served) -> None:
    show(phone, workbench, "tribometer", {}, where="dissertation")
    phone.get_by_test_id("start-job").tap()
    phone.get_by_test_id("cancel-job").tap()
    show(phone, workbench, "tribometer", {}, where="jobs")
    expect(phone.get_by_test_id("job-state").first).to_have_text("cancelled")
    phone.get_by_test_id("delete-job").first.tap()
    phone.get_by_test_id("delete-job").first.tap()
    expect(phone.get_by_test_id("no-jobs")).to_be_visible()
