"""Pages of the workbench in a real browser: by mouse and touch, in every state."""

from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect
from tests.browser.pages import LOAD, RIGS, SPEED, VOLTS, at_rest, enter, numbers, opened, show
from tests.browser.workbench import Served, served
from tests.chromium import CHROMIUM

import sonolube as sl
from sonolube.report.results.prediction import HEADS, quantity_rows
from sonolube.rig import read_rig

SIZES = {"wide": (1280, 800), "middle": (820, 1180), "narrow": (390, 844), "least": (320, 640)}

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium"),
]


def predicted(name: str, changes: dict[str, str]) -> list[list[str]]:
    """Label, median and interval of 80 % of each number, by the task."""
    rig = read_rig(RIGS / f"{name}.toml", changes=[f"{key}={value}" for key, value in changes.items()])
    at = HEADS.index("80 %")
    return [[row[0], row[1], row[at]] for row in quantity_rows(sl.predict(rig).prediction)]


def test_the_voltage_is_moved_by_keys_and_undone(page: Page) -> None:
    field = page.get_by_test_id(f"field:{VOLTS}")
    field.focus()
    page.keyboard.press("ArrowUp")
    page.keyboard.press("Shift+ArrowUp")
    expect(field).to_have_value("39 V")
    page.keyboard.press("Tab")
    at_rest(page)
    assert numbers(page)[0][1] == predicted("tribometer", {VOLTS: "39 V"})[0][1]
    page.get_by_test_id("undo").click()
    expect(field).not_to_have_value("39 V")
    page.get_by_test_id("redo").click()
    expect(field).to_have_value("39 V")


def test_a_link_and_a_reload_show_the_same_screen(page: Page, browser: Browser, workbench: Served) -> None:
    show(page, workbench, "tribometer", {VOLTS: "21 V"})
    expect(page.get_by_test_id(f"field:{VOLTS}")).to_have_value("21 V")
    before = numbers(page)
    page.reload()
    at_rest(page)
    assert numbers(page) == before
    other = browser.new_context()
    second = other.new_page()
    second.goto(workbench.link + page.url[page.url.index("#") :])
    at_rest(second)
    expect(second.get_by_test_id(f"field:{VOLTS}")).to_have_value("21 V")
    other.close()


def test_back_and_forward_lead_through_the_pages(page: Page) -> None:
    page.get_by_test_id("page:explore").click()
    expect(page.get_by_test_id("page:explore")).to_have_attribute("aria-current", "page")
    page.go_back()
    expect(page.get_by_test_id("page:predict")).to_have_attribute("aria-current", "page")
    page.go_forward()
    expect(page.get_by_test_id("page:explore")).to_have_attribute("aria-current", "page")


TYPED = ("", "3 kg", "5 V", "1e999 N", "-1 N", "NaN", "\u202e3 N", "<img onerror=alert(1)>", "9" * 10_000)


@pytest.mark.parametrize("text", TYPED)
def test_what_is_refused_is_said_below_its_field_and_the_others_stay_live(text: str, page: Page) -> None:
    field = page.get_by_test_id(f"field:{LOAD}")
    enter(page, LOAD, text)
    refusal = page.get_by_test_id(f"refusal:{LOAD}")
    expect(refusal).to_be_visible(timeout=30_000)
    assert (refusal.get_attribute("id") or "-") in (field.get_attribute("aria-describedby") or "")
    assert field.input_value() == text
    assert "/" not in (refusal.text_content() or "").replace("m/s", "")
    enter(page, SPEED, "40 mm/s")
    expect(page.get_by_test_id("numbers").locator(".median").first).to_have_text(
        predicted("tribometer", {SPEED: "40 mm/s"})[0][1]
    )


def test_dragging_the_operating_point_moves_the_speed(page: Page) -> None:
    slider = page.get_by_test_id("drag:1")
    slider.focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Tab")
    at_rest(page)
    assert page.get_by_test_id(f"field:{SPEED}").input_value() != "20.3 mm/s"


def test_a_slider_is_moved_by_touch_on_a_phone(browser: Browser, workbench: Served) -> None:
    phone: dict[str, Any] = {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True}
    with opened(browser, workbench, **phone) as page:
        slider = page.get_by_test_id(f"slider:{VOLTS}")
        slider.scroll_into_view_if_needed()
        box = slider.bounding_box()
        assert box is not None
        page.touchscreen.tap(box["x"] + 0.9 * box["width"], box["y"] + box["height"] / 2)
        at_rest(page)
        assert page.get_by_test_id(f"field:{VOLTS}").input_value() != "28 V"


@pytest.mark.parametrize(
    ("size", "scheme"),
    [("wide", "light"), ("middle", "dark"), ("narrow", "light"), ("narrow", "dark"), ("least", "light")],
)
def test_no_page_has_a_fault_of_access_or_scrolls_sideways(
    size: str, scheme: Any, browser: Browser, workbench: Served
) -> None:
    width, height = SIZES[size]
    shown: dict[str, Any] = {"viewport": {"width": width, "height": height}, "color_scheme": scheme}
    with opened(browser, workbench, **shown, bypass_csp=True, reduced_motion="reduce") as page:
        for where in ("predict", "explore", "design", "jobs", "new"):
            show(page, workbench, "tribometer", {}, where=where)
            assert faults_of_access(page) == [], where
            widths = page.evaluate("[document.documentElement.scrollWidth, innerWidth]")
            assert widths[0] <= widths[1], where


def test_a_refused_rig_has_no_fault_of_access(browser: Browser, workbench: Served) -> None:
    with opened(browser, workbench, bypass_csp=True) as page:
        show(page, workbench, "tribometer", {LOAD: "3 kg"})
        expect(page.get_by_test_id(f"refusal:{LOAD}")).to_be_visible(timeout=30_000)
        assert faults_of_access(page) == []


def faults_of_access(page: Page) -> list[str]:
    """What axe finds against the guidelines of access."""
    page.evaluate(files("axe_playwright_python").joinpath("axe.min.js").read_text(encoding="utf-8"))
    found = page.evaluate("axe.run(document, {resultTypes: ['violations']})")
    return [f"{each['id']}: {[node['target'] for node in each['nodes']][:3]}" for each in found["violations"]]


def test_every_figure_has_a_name_and_a_table_of_its_numbers(page: Page) -> None:
    chart = page.locator("[data-test^='chart:']").first
    assert chart.get_attribute("aria-label") or chart.get_attribute("aria-labelledby")
    chart.locator("summary").first.click()
    expect(chart.get_by_role("table").first).to_be_visible()


def test_without_a_connection_the_last_numbers_stay(browser: Browser, tmp_path: Path) -> None:
    with served(tmp_path) as workbench:
        context = browser.new_context()
        page = context.new_page()
        page.goto(workbench.link)
        at_rest(page)
        before = numbers(page)
        workbench.process.terminate()
        workbench.process.wait(60)
        page.get_by_test_id(f"field:{VOLTS}").fill("14 V")
        page.keyboard.press("Enter")
        expect(page.get_by_test_id("offline")).to_be_visible(timeout=30_000)
        assert numbers(page) == before
        assert page.get_by_test_id(f"field:{VOLTS}").input_value() == "14 V"
        context.close()


def offered(page: Page) -> list[str]:
    """Studies that the page Explore offers."""
    names: list[str] = page.locator("[data-test^='study:']").evaluate_all("all => all.map((each) => each.dataset.test)")
    return [name.removeprefix("study:") for name in names]


def test_explore_offers_what_the_rig_has(page: Page, workbench: Served) -> None:
    show(page, workbench, "cutter_head", {}, where="explore")  # without a voltage and without a structure
    assert offered(page) == ["amplitude", "speed", "load", "any", "period", "map", "heat"]
    show(page, workbench, "tribometer", {}, where="explore")
    assert offered(page)[:2] == ["voltage", "speed"]
    assert {"start", "response", "frequency"} <= set(offered(page))
    assert page.get_by_test_id("refused").count() == 0


def test_explore_marks_the_operating_point_whatever_its_unit(page: Page, workbench: Served) -> None:
    show(page, workbench, "tribometer", {SPEED: "1 in/s", VOLTS: "0.028 kV"}, where="explore")
    for study in ("voltage", "speed"):
        page.get_by_test_id(f"study:{study}").check()
        at_rest(page)
        expect(page.locator(".chart-legend").get_by_text("operating point").first).to_be_visible()


def test_a_study_that_takes_long_is_cancelled(page: Page, workbench: Served) -> None:
    page.route("**/api/tasks/response", lambda route: None)  # never answered
    show(page, workbench, "tribometer", {}, where="explore")
    page.get_by_test_id("study:response").check()
    page.get_by_test_id("cancel-study").click()
    expect(page.get_by_test_id("refused")).to_contain_text("It was cancelled.")
    page.get_by_test_id("study:speed").check()
    at_rest(page)
    expect(page.get_by_test_id("study")).to_be_visible()


def test_jobs_are_listed_and_deleted(page: Page) -> None:
    page.evaluate(
        """async () => fetch('api/jobs', {method: 'POST', body: JSON.stringify(
        {task: 'contact', arguments: {rig: {name: 'tribometer'}}, label: 'contact of the tribometer'})})"""
    )
    page.get_by_test_id("page:jobs").click()
    expect(page.get_by_text("contact of the tribometer").first).to_be_visible(timeout=30_000)
