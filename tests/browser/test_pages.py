"""Pages of the workbench in a real browser: by mouse and touch, in every state."""

import random
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect
from tests.browser.pages import (
    EXAMPLES,
    LOAD,
    RIGS,
    SPEED,
    VOLTS,
    at_rest,
    enter,
    go,
    in_use,
    numbers,
    opened,
    reach,
    show,
)
from tests.browser.workbench import Served, served
from tests.chromium import CHROMIUM

import sonolube as sl
from sonolube.report.results.prediction import HEADS, quantity_rows
from sonolube.rig import read_rig

SHADES: tuple[tuple[int, int, Any], ...] = (
    *((1280, 800, "light"), (820, 1180, "dark"), (390, 844, "light"), (390, 844, "dark"), (320, 640, "light")),
)

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
    go(page, "explore")
    expect(page.get_by_test_id("page:explore")).to_have_attribute("aria-current", "page")
    page.go_back()
    expect(page.get_by_test_id("page:predict")).to_have_attribute("aria-current", "page")
    page.go_forward()
    expect(page.get_by_test_id("page:explore")).to_have_attribute("aria-current", "page")


def test_four_doors_are_always_seen_and_the_other_pages_stand_in_a_menu(page: Page) -> None:
    for width in (1280, 390):
        page.set_viewport_size({"width": width, "height": 844})
        page.get_by_test_id("page:predict").click()
        expect(page.locator(".doors a")).to_have_text(["Predict", "Measure", "Design", "Run"])
        go(page, "modes")
        expect(page.locator(".doors [aria-current=page]")).to_have_text("Modes")
        expect(page.get_by_label("More pages")).to_be_hidden()


def test_the_menu_of_pages_is_opened_and_closed_by_keys(page: Page) -> None:
    reach(page, "more")
    page.keyboard.press("Enter")
    expect(page.get_by_label("More pages").get_by_role("link")).to_have_count(5)
    reach(page, "page:jobs")
    page.keyboard.press("Escape")
    expect(page.get_by_label("More pages")).to_be_hidden()
    assert in_use(page) == "more"
    page.keyboard.press("Enter")
    reach(page, "page:jobs")
    page.keyboard.press("Enter")
    expect(page.locator(".doors [aria-current=page]")).to_have_text("Jobs")


def test_the_sentence_on_the_contact_is_its_form_by_keys_and_on_a_phone(page: Page) -> None:
    assert sentence(page) == (
        "A steel pin on an aluminium disc, pressed with 3 N, sliding at 20.3 mm/s, vibrates along the normal at 22 kHz"
        " with 2.5 µm, driven by 28 V. Without vibration its coefficient of friction is 0.341."
    )
    reach(page, f"field:{LOAD}")
    page.keyboard.press("ArrowUp")
    expect(page.get_by_test_id(f"drawn:{LOAD}")).to_have_text("3.1 N")
    reach(page, f"spread-button:{LOAD}")  # past the other fields, which are not in use by that
    page.set_viewport_size({"width": 390, "height": 844})
    page.get_by_test_id(f"drawn:{LOAD}").click()
    assert in_use(page) == f"field:{LOAD}"
    page.keyboard.type("4,5")
    page.keyboard.press("Enter")
    at_rest(page)
    assert numbers(page)[0][1] == predicted("tribometer", {LOAD: "4.5 N"})[0][1]
    assert "pressed with 4.5 N," in sentence(page)


def sentence(page: Page) -> str:
    """Sentence on the contact with the values in its fields."""
    found: str = page.get_by_test_id("sentence").evaluate(
        "(each) => [...each.children].map((part) => part.querySelector('input')?.value ?? part.textContent).join('')"
    )
    return found


def test_the_body_that_vibrates_is_that_of_the_rig(page: Page, workbench: Served) -> None:
    expect(page.get_by_test_id("moves:pin")).to_be_visible()
    show(page, workbench, "vibrating_base", {})
    assert "; the base vibrates along the sliding at 3 kHz" in sentence(page)
    expect(page.get_by_test_id("moves:disc")).to_be_visible()


def test_an_example_is_taken_from_the_gallery_by_keys_and_on_a_phone(browser: Browser, workbench: Served) -> None:
    with opened(browser, workbench, bypass_csp=True, reduced_motion="reduce") as page:
        reach(page, "examples")
        page.keyboard.press("Enter")
        expect(page.get_by_test_id("example:tribometer")).to_have_attribute("aria-current", "true")
        assert faults_of_access(page) == []
        reach(page, "example:coated_plate")
        page.keyboard.press("Enter")
        expect(page.get_by_test_id("gallery")).to_be_hidden()
        expect(page.get_by_test_id("rig")).to_have_value("coated_plate")
        at_rest(page)
        page.set_viewport_size({"width": 390, "height": 844})
        page.get_by_test_id("examples").click()
        picture = page.get_by_test_id("example:collar").locator("img")
        picture.scroll_into_view_if_needed()
        page.wait_for_function("(each) => each.complete && each.naturalWidth > 0", arg=picture.element_handle())
        assert page.evaluate("document.querySelector('dialog').scrollWidth <= innerWidth")
        assert faults_of_access(page) == []
        page.keyboard.press("Escape")
        expect(page.get_by_test_id("gallery")).to_be_hidden()


UNPREDICTED = {"cutter_head": "kinematic", "finger_on_glass": "squeeze film", "pom_on_steel": "soft layer"}


@pytest.mark.parametrize("name", UNPREDICTED)
def test_a_rig_without_a_prediction_shows_its_model_and_the_reason_and_no_number_of_another(
    shown: Page, workbench: Served, name: str
) -> None:
    show(shown, workbench, "tribometer", {})
    shown.set_viewport_size({"width": 390, "height": 844})
    shown.get_by_test_id("examples").click()
    shown.get_by_test_id(f"example:{name}").press("Enter")
    ratio = float(sl.friction(read_rig(RIGS / f"{name}.toml"))["friction_ratio"])
    expect(shown.get_by_test_id("statement")).to_have_text(
        f"By its model alone ({UNPREDICTED[name]}), friction falls by {100 * (1 - ratio):.0f} %."
    )
    expect(shown.get_by_test_id("reason")).to_contain_text(
        "all published tests behind a prediction are of hard bodies."
    )
    expect(shown.get_by_test_id("numbers")).to_have_count(0)
    expect(shown.get_by_test_id("changes")).to_have_count(0)
    shown.set_viewport_size({"width": 1280, "height": 800})


TYPED = ("", "3 kg", "5 V", "1e999 N", "-1 N", "NaN", "\u202e3 N", "<img onerror=alert(1)>", "9" * 10_000)


def test_what_is_refused_is_said_below_its_field_and_the_others_stay_live(shown: Page, workbench: Served) -> None:
    show(shown, workbench, "tribometer", {})
    field, refusal = (shown.get_by_test_id(f"{each}:{LOAD}") for each in ("field", "refusal"))
    for at, text in enumerate(TYPED):
        enter(shown, LOAD, text)
        expect(refusal).to_be_visible(timeout=30_000)
        assert (refusal.get_attribute("id") or "-") in (field.get_attribute("aria-describedby") or ""), text
        assert field.input_value() == text
        assert "/" not in (refusal.text_content() or "").replace("m/s", ""), text
        speed = f"{30 + at} mm/s"
        enter(shown, SPEED, speed)
        median = shown.get_by_test_id("numbers").locator(".median").first
        expect(median).to_have_text(predicted("tribometer", {SPEED: speed})[0][1])


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


def test_no_page_has_a_fault_of_access_or_is_cut_off(browser: Browser, workbench: Served) -> None:
    with opened(browser, workbench, bypass_csp=True, reduced_motion="reduce") as page:
        for where in ("predict", "explore", "data", "modes", "design", "lab", "jobs", "new", "dissertation"):
            show(page, workbench, "tribometer", {}, where=where)
            for width, height, scheme in SHADES:
                page.set_viewport_size({"width": width, "height": height})
                page.emulate_media(color_scheme=scheme)
                at_rest(page)
                assert faults_of_access(page) == [], (where, width)
                assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), (where, width)
                assert page.evaluate(_CUT_OFF) == [], (where, width)
                shade = page.evaluate("getComputedStyle(document.body).backgroundColor.match(/\\d+/g).map(Number)")
                assert (sum(shade) < 3 * 128) is (scheme == "dark")


_CUT_OFF = """() => {
  const scrolls = (each) => each && (['auto', 'scroll'].includes(getComputedStyle(each).overflowX) || scrolls(each.parentElement));
  return [...document.querySelectorAll('button, select, input:not([type=range]), h1, label')]
    .filter((element) => element.checkVisibility() && !element.closest('.hidden, .skip') && !scrolls(element.parentElement))
    .map((element) => [element, element.getBoundingClientRect()])
    .filter(([, box]) => box.width && (box.right > innerWidth + 1 || box.left < -1))
    .map(([element]) => element.outerHTML.slice(0, 120));
}"""  # noqa: E501


def test_the_rig_stands_beside_the_answer_where_there_is_room(page: Page) -> None:
    for width, height, _ in SHADES:
        page.set_viewport_size({"width": width, "height": height})
        panel, lead = (page.locator(place).bounding_box() for place in (".rig", ".lead"))
        assert panel is not None
        assert lead is not None
        is_beside = panel["x"] + panel["width"] <= lead["x"]
        assert is_beside if width > 1000 else is_beside or lead["y"] <= panel["y"]


def test_a_refused_rig_has_no_fault_of_access(browser: Browser, workbench: Served) -> None:
    with opened(browser, workbench, bypass_csp=True) as page:
        show(page, workbench, "tribometer", {LOAD: "3 kg"})
        expect(page.get_by_test_id(f"refusal:{LOAD}")).to_be_visible(timeout=30_000)
        assert faults_of_access(page) == []


def faults_of_access(page: Page) -> list[str]:
    """What axe finds against the guidelines of access."""
    if page.evaluate("!('axe' in window)"):
        page.evaluate(files("axe_playwright_python").joinpath("axe.min.js").read_text(encoding="utf-8"))
    # preloaded, styles that styles import would be sought beside the page
    found = page.evaluate("axe.run(document, {resultTypes: ['violations'], preload: false})")
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


RUN: dict[str, Any] = {"id": "20200101-120000", "title": "Sweep", "state": "completed", "device": "virtual"}
RUN |= {"created": 1577880000.0, "protocol": "resonance", "seed": 3, "recordings": 2, "version": "1.2.3"}
RECORD = {"answer": {}, "charts": [], "blocks": [{"kind": "rows", "rows": [["outcome", "completed"]]}]}


def test_jobs_and_runs_stand_in_one_list(page: Page) -> None:
    page.route("**/api/lab/runs", lambda route: route.fulfill(json={"runs": [RUN], "folder": "runs"}))
    page.route("**/api/lab/runs/*", lambda route: route.fulfill(json=RECORD))
    page.evaluate(
        """async (rig) => fetch('api/jobs', {method: 'POST', body: JSON.stringify(
        {task: 'contact', arguments: {rig}, label: 'contact of the tribometer'})})""",
        {"name": "tribometer", "changes": {LOAD: "4 N"}},
    )
    go(page, "jobs")
    expect(page.locator("#main h2")).to_have_text(["contact of the tribometer", "Sweep"])  # the latest first
    expect(page.get_by_test_id("of")).to_have_count(2)  # once the job runs
    of_job, of_run = page.get_by_test_id("of").all()
    expect(of_job).to_contain_text(f"sonolube {sl.__version__}: sonolube contact tribometer.toml --set '{LOAD}=4 N'")
    expect(of_run).to_have_text("sonolube 1.2.3, virtual, resonance, seed 3, 2 recordings")
    expect(page.locator("#main")).to_contain_text("run 20200101-120000, Jan 1, 2020")
    page.get_by_test_id("job-search").fill("seed 3")
    expect(page.locator("#main h2")).to_have_text(["Sweep"])
    page.get_by_test_id("open-run").click()
    expect(page.get_by_test_id("run-result")).to_contain_text("outcome")
    page.get_by_test_id("job-search").fill("")
    page.get_by_test_id("job-kind").select_option("job")
    page.get_by_test_id("open-job").click()
    expect(page.get_by_test_id("job-result")).to_contain_text("asperities")
    page.get_by_test_id("delete-job").click()
    page.get_by_test_id("delete-job").click()
    expect(page.get_by_test_id("job-count")).to_have_text("0 of 1")


def test_a_page_is_found_as_it_was_left_with_the_runs_of_its_rig(page: Page) -> None:
    page.get_by_test_id("runs-file").set_input_files(str(EXAMPLES / "tribometer-runs.csv"))
    page.get_by_test_id("remove-runs").wait_for()
    at_rest(page)
    page.get_by_test_id("keep").click()
    go(page, "explore")
    page.get_by_test_id("study:map").check()
    at_rest(page)
    expect(page.get_by_test_id("remove-runs")).to_be_visible()
    go(page, "jobs")
    page.reload()
    go(page, "explore")
    expect(page.get_by_test_id("study:map")).to_be_checked()
    page.get_by_test_id("page:predict").click()
    expect(page.get_by_test_id("differences")).to_be_visible()
    expect(page.get_by_test_id("remove-runs")).to_be_visible()


def test_a_rig_too_long_for_a_link_stays_through_reloads_and_a_rig_is_dropped(page: Page) -> None:
    draw = random.Random(1)
    text = (RIGS / "collar.toml").read_text(encoding="utf-8") + "".join(f"# {draw.random()}\n" for _ in range(2000))
    for _ in range(2):
        page.evaluate(_DROP, ["long.toml", text])
        expect(page.get_by_test_id("of-tab")).to_be_visible()
        page.reload()
    at_rest(page)
    expect(page.get_by_test_id("rig")).to_contain_text("long (own file)")
    expect(page.get_by_test_id("of-tab")).to_be_visible()


_DROP = """([name, text]) => {
  const dataTransfer = new DataTransfer();
  dataTransfer.items.add(new File([text], name));
  for (const kind of ['dragover', 'drop']) dispatchEvent(new DragEvent(kind, {dataTransfer, bubbles: true, cancelable: true}));
}"""  # noqa: E501


def test_every_page_is_led_to_in_a_low_head(page: Page) -> None:
    for width in (320, 390, 768, 1000, 1200, 1600):
        page.set_viewport_size({"width": width, "height": 800})
        page.get_by_test_id("page:predict").click()
        go(page, "new")
        page.locator('[data-test="page:new"][aria-current=page]').wait_for()
        links, last, head = (page.locator(place).bounding_box() for place in (".pages", ".is-more", ".head"))
        assert links is not None
        assert last is not None
        assert head is not None
        assert links["x"] <= last["x"] <= last["x"] + last["width"] <= links["x"] + links["width"] + 1, width
        assert head["height"] <= (96 if width < 700 else 84 if width < 861 else 57), width
