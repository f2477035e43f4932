"""Page Lab: a protocol edited along time, run on the virtual tribometer, watched, stopped, and fitted."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect
from tests.browser.pages import at_rest, in_use, opened, reach, show
from tests.browser.test_pages import faults_of_access
from tests.browser.walks import HANDS, Mouse
from tests.browser.workbench import Served, served
from tests.chromium import CHROMIUM

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium"),
]

HEAD = """
title = "Friction at three voltages"
source = "own test"

[limits]
voltage_maximum = "30 V"
duration_maximum = "30 min"

[[steps]]
kind = "prompt"
task = "load"
text = "Hang the weight for 3 N."
normal_load = "3 N"
"""
SHORT = f"""{HEAD}
[[steps]]
kind = "acquire"
channels = ["friction_force", "voltage"]
sample_rate = "400 Hz"
duration = "8.5 s"

[[steps]]
kind = "wait"
duration = "1 s"
reason = "zero of the force"

[[steps]]
kind = "motor_speed"
sliding_speed = "20 mm/s"

[[steps]]
kind = "wait"
duration = "1.5 s"

[[steps]]
kind = "voltage_steps"
voltages = ["10 V", "20 V"]
step_duration = "2 s"
frequency = "22 kHz"
"""
LONG = f"""{HEAD}
[[steps]]
kind = "drive"
voltage_peak_to_peak = "56 V"
frequency = "22 kHz"

[[steps]]
kind = "wait"
duration = "20 min"
"""
STATE = "fetch('api/lab').then((reply) => reply.json())"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in {"short": SHORT, "long": LONG}.items():
        (tmp_path / f"{name}.toml").write_text(text, encoding="utf-8")
    return tmp_path


def begin(page: Page, protocol: Path) -> None:
    """Open a protocol on the page Lab and start it; the prompt is then on screen."""
    page.get_by_test_id("protocol-file").set_input_files(str(protocol))
    expect(page.get_by_test_id("plan")).to_contain_text("own test")
    page.get_by_test_id("start").click()
    page.get_by_test_id("confirm").wait_for()


@pytest.mark.parametrize("hand", HANDS)
def test_a_protocol_is_edited_run_compared_and_fitted(hand: type[Mouse], page: Page, folder: Path) -> None:
    walk = hand(page, "operator")
    walk.press("page:lab")
    at_rest(page)
    walk.give("open-protocol", folder / "short.toml")
    expect(page.get_by_test_id("step:6")).to_contain_text("10 V")
    at_rest(page)
    walk.press("step:1")
    page.keyboard.press("End")
    walk.write("entry:steps.6.voltages", "10 V, 20 V, 28 V")
    expect(page.get_by_test_id("dry-run")).to_contain_text("28 V pp")
    walk.write("start:tags", hand.name)
    walk.picture("planned")
    walk.press("start")
    page.get_by_test_id("prompt").wait_for()
    walk.picture("asked")
    walk.press("confirm")
    expect(page.get_by_test_id("run-step")).to_contain_text("step 6")
    expect(page.get_by_test_id("chart:live")).to_contain_text("Friction force 0.")
    walk.picture("running")
    expect(page.get_by_test_id("run-state")).to_have_text("✓ completed")
    expect(page.get_by_test_id("stop")).to_be_hidden()
    expect(page.get_by_test_id("a-run").first).to_contain_text(hand.name)
    walk.press("tick")
    walk.press("compare")
    expect(page.get_by_test_id("compared")).to_contain_text("4 levels of 1 runs")
    walk.press("fit")
    expect(page.get_by_test_id("fitted")).to_contain_text("3 runs under 3 conditions")
    walk.picture("fitted")
    walk.press("to-data")
    expect(page.get_by_test_id("page:data")).to_have_attribute("aria-current", "page")
    expect(page.locator("[data-test^='file:']")).to_contain_text("Recording")
    page.go_back()
    expect(page.get_by_test_id("fitted")).to_be_visible()
    walk.press("hold")  # for the next user
    expect(page.get_by_test_id("holder")).to_have_text("Nobody holds the laboratory.")
    walk.press("predict-runs")
    at_rest(page)
    expect(page.get_by_test_id("remove-runs")).to_be_visible()


def test_steps_are_chosen_inserted_moved_and_removed_by_keys_and_refusals_keep_what_was_typed(
    page: Page, folder: Path, workbench: Served
) -> None:
    show(page, workbench, "tribometer", {}, where="lab")
    page.get_by_test_id("protocol-file").set_input_files(str(folder / "short.toml"))
    expect(page.get_by_test_id("plan")).to_contain_text("own test")
    at_rest(page)
    reach(page, "step:1")
    for _ in range(2):
        page.keyboard.press("ArrowRight")
    assert in_use(page) == "step:3"
    entry, refusal = page.get_by_test_id("entry:steps.3.duration"), page.locator("#entry-steps-3-duration-refusal")
    entry.fill("3 kg")
    page.keyboard.press("Enter")
    expect(refusal).to_contain_text("duration")
    expect(entry).to_have_value("3 kg")
    assert (refusal.get_attribute("id") or "-") == entry.get_attribute("aria-describedby")
    entry.fill("2")
    page.keyboard.press("Enter")
    expect(entry).to_have_value("2 s")
    expect(refusal).to_be_hidden()
    page.get_by_test_id("insert").click()
    expect(page.get_by_test_id("step:7")).to_be_visible()
    expect(page.get_by_test_id("step:4")).to_have_attribute("aria-selected", "true")
    page.get_by_test_id("step:4").focus()
    page.keyboard.press("Alt+ArrowLeft")
    expect(page.get_by_test_id("step:3")).to_have_attribute("aria-selected", "true")
    expect(page.get_by_test_id("entry:steps.4.duration")).to_be_hidden()
    page.get_by_test_id("remove").click()
    expect(page.get_by_test_id("step:7")).to_be_hidden()
    expect(entry).to_have_value("2 s")
    page.get_by_test_id("undo").click()
    expect(page.get_by_test_id("step:7")).to_be_visible()
    page.reload()
    expect(page.get_by_test_id("step:7")).to_be_visible()


def test_what_a_dry_run_finds_impossible_starts_only_anyway(page: Page, folder: Path, workbench: Served) -> None:
    show(page, workbench, "tribometer", {}, where="lab")
    page.get_by_test_id("protocol-file").set_input_files(str(folder / "long.toml"))
    expect(page.get_by_test_id("plan")).to_contain_text("own test")
    at_rest(page)
    page.get_by_test_id("entry:limits.current_maximum").fill("1 mA")
    page.keyboard.press("Enter")
    expect(page.get_by_test_id("impossible")).to_contain_text("current")
    expect(page.get_by_test_id("start")).to_be_disabled()
    page.get_by_test_id("anyway").check()
    expect(page.get_by_test_id("start")).to_be_enabled()


@pytest.fixture
def own_workbench(tmp_path: Path) -> Iterator[Served]:
    (tmp_path / "state").mkdir()
    with served(tmp_path / "state") as found:
        yield found


def test_a_run_outlives_its_page_is_watched_by_another_tab_and_stopped_there(
    browser: Browser, own_workbench: Served, folder: Path
) -> None:
    with opened(browser, own_workbench, bypass_csp=True) as page:
        show(page, own_workbench, "tribometer", {}, where="lab")
        begin(page, folder / "long.toml")
        assert in_use(page) == "prompt"
        assert faults_of_access(page) == []
        context = page.context
        watcher = context.new_page()
        watcher.goto(f"{own_workbench.address}#/lab")
        expect(watcher.get_by_test_id("holder")).to_contain_text("held by another tab")
        expect(watcher.get_by_test_id("prompt")).to_contain_text("Hang the weight for 3 N.")
        expect(watcher.get_by_test_id("confirm")).to_be_hidden()
        expect(watcher.get_by_test_id("start")).to_be_disabled()
        page.get_by_test_id("confirm").click()
        expect(page.get_by_test_id("run-state")).to_have_text("▶ running")
        page.get_by_test_id("pause").click()
        expect(page.get_by_test_id("run-state")).to_have_text("❚❚ paused")
        page.get_by_test_id("resume").click()
        expect(page.get_by_test_id("run-state")).to_have_text("▶ running")
        expect(page.get_by_test_id("limits").locator(".is-near").first).to_contain_text("near the limit")
        assert faults_of_access(page) == []
        page.goto("about:blank")  # the page is lost, not its run
        expect(watcher.get_by_test_id("run-state")).to_have_text("▶ running")
        page.goto(f"{own_workbench.address}#/explore")
        expect(page.get_by_test_id("stop")).to_be_in_viewport()
        assert faults_of_access(page) == []
        page.get_by_test_id("to-lab").click()
        expect(page.get_by_test_id("pause")).to_be_visible()  # the tab holds the laboratory as before
        watcher.bring_to_front()
        watcher.keyboard.press("Control+.")
        for each in (page, watcher):
            expect(each.get_by_test_id("run-state")).to_have_text("◼ stopped")
            expect(each.get_by_test_id("stop")).to_be_hidden()


def test_without_its_workbench_a_run_is_stopped_on_its_own_page(
    browser: Browser, own_workbench: Served, folder: Path
) -> None:
    context = browser.new_context()
    page = context.new_page()
    page.goto(f"{own_workbench.link}#/lab")
    at_rest(page)
    begin(page, folder / "long.toml")
    page.get_by_test_id("confirm").click()
    expect(page.get_by_test_id("run-state")).to_have_text("▶ running")
    own_workbench.process.kill()
    own_workbench.process.wait()
    expect(page.get_by_test_id("stop-text")).to_contain_text("this button stops nothing")
    expect(page.get_by_test_id("run-state")).to_contain_text("when last seen")
    with context.expect_page() as other:
        page.get_by_test_id("stop-page").click()
    other.value.get_by_role("button", name="Stop").click()
    expect(other.value.locator("body")).to_contain_text("stopped")
    context.close()


def test_a_killed_runner_is_said_first_and_recovered_before_the_next_run(
    browser: Browser, own_workbench: Served, folder: Path
) -> None:
    with opened(browser, own_workbench, bypass_csp=True) as page:
        show(page, own_workbench, "tribometer", {}, where="lab")
        begin(page, folder / "long.toml")
        os.kill(page.evaluate(f"{STATE}.then(({{run}}) => run.process)"), signal.SIGKILL)
        expect(page.get_by_test_id("lost-run")).to_contain_text("Cut the power")
        expect(page.get_by_test_id("start")).to_be_disabled()
        expect(page.get_by_test_id("run-state")).to_have_text("✕ lost")
        assert faults_of_access(page) == []
        page.get_by_test_id("recover").click()
        expect(page.get_by_test_id("lost-run")).to_be_hidden()
        expect(page.get_by_test_id("start")).to_be_enabled()
