"""Pages of the workbench in a real browser: numbers of the task, by mouse, keys and touch, in every state."""

import json
import re
from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path
from typing import Any
from urllib.parse import quote

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, expect, sync_playwright
from tests.browser.workbench import Served, served
from tests.chromium import CHROMIUM, FLAGS

import sonolube as sl
from sonolube.cli import main
from sonolube.report.results.prediction import HEADS, quantity_rows
from sonolube.rig import read_rig

EXAMPLES = Path(__file__).parents[2] / "examples"
RIGS = EXAMPLES / "rigs"
VOLTS, SPEED, LOAD = "drive.voltage_peak_to_peak", "sliding.sliding_speed", "contact.normal_load"
PREDICTED: tuple[tuple[str, dict[str, str]], ...] = (
    ("tribometer", {}),
    ("tribometer", {VOLTS: "14 V", SPEED: "1 in/s"}),
    ("tribometer", {LOAD: "5 N", SPEED: "0.2 m/s"}),
    ("power_map", {}),
    ("power_map", {VOLTS: "5 V"}),
    ("coated_plate", {SPEED: "60 mm/s"}),
    ("welder_round", {}),
)
SIZES = {"wide": (1280, 800), "middle": (820, 1180), "narrow": (390, 844), "least": (320, 640)}

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium"),
]


@pytest.fixture(scope="module")
def workbench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    with served(tmp_path_factory.mktemp("pages")) as found:
        yield found


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture
def page(browser: Browser, workbench: Served) -> Iterator[Page]:
    yield from opened(browser.new_context(viewport={"width": 1280, "height": 800}), workbench)


def opened(context: BrowserContext, workbench: Served) -> Iterator[Page]:
    """Page of a context that was let in; nothing may be asked of another host, and the console stays empty."""
    foreign: list[str] = []
    said: list[str] = []
    page = context.new_page()
    page.on("request", lambda request: foreign.append(request.url) if not own(request.url, workbench) else None)
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.goto(workbench.link)
    at_rest(page)
    yield page
    assert foreign == []
    assert said == []
    context.close()


def own(url: str, workbench: Served) -> bool:
    return url.startswith((workbench.address, "data:", "blob:"))


def at_rest(page: Page) -> None:
    """Wait until the answer is that of the state on screen."""
    page.get_by_test_id("statement").or_(page.get_by_test_id("refused")).first.wait_for(timeout=120_000)
    page.wait_for_function("() => !document.querySelector('.body > [aria-busy=true]')", timeout=120_000)


def show(page: Page, workbench: Served, name: str, changes: dict[str, str], *, where: str = "predict") -> None:
    """Show a rig with changes, as a link does."""
    entries = "".join(f"&set={quote(f'{key}:{value}', safe='')}" for key, value in changes.items())
    page.goto(f"{workbench.address}#/{where}?rig={name}{entries}")
    page.wait_for_timeout(50)


def numbers(page: Page) -> list[list[str]]:
    """Label, median and interval of 80 % of each number on screen."""
    rows: list[list[str]] = (
        page.get_by_test_id("numbers")
        .locator(".number")
        .evaluate_all("rows => rows.map(row => [...row.children].map(cell => cell.textContent.trim()))")
    )
    return rows


def predicted(name: str, changes: dict[str, str]) -> list[list[str]]:
    """The same by the task."""
    rig = read_rig(RIGS / f"{name}.toml", changes=[f"{key}={value}" for key, value in changes.items()])
    at = HEADS.index("80 %")
    return [[row[0], row[1], row[at]] for row in quantity_rows(sl.predict(rig).prediction)]


@pytest.fixture(autouse=True, scope="module")
def names_of_elements() -> None:
    with sync_playwright() as playwright:
        playwright.selectors.set_test_id_attribute("data-test")


@pytest.mark.parametrize(("name", "changes"), PREDICTED)
def test_numbers_on_screen_are_those_of_the_command(
    name: str, changes: dict[str, str], page: Page, workbench: Served
) -> None:
    expected = predicted(name, changes)
    show(page, workbench, name, changes)
    expect(page.get_by_test_id("numbers").locator(".median").first).to_have_text(expected[0][1], timeout=60_000)
    at_rest(page)
    assert numbers(page)[: len(expected)] == expected


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
    at_rest(page)
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
    field.fill(text)
    page.keyboard.press("Enter")
    refusal = page.get_by_test_id(f"refusal:{LOAD}")
    expect(refusal).to_be_visible(timeout=30_000)
    assert (refusal.get_attribute("id") or "-") in (field.get_attribute("aria-describedby") or "")
    assert field.input_value() == text
    assert "/" not in (refusal.text_content() or "").replace("m/s", "")
    other = page.get_by_test_id(f"field:{SPEED}")
    other.fill("40 mm/s")
    page.keyboard.press("Enter")
    at_rest(page)
    expect(page.get_by_test_id("numbers").locator(".median").first).to_have_text(
        predicted("tribometer", {SPEED: "40 mm/s"})[0][1], timeout=30_000
    )


def test_dragging_the_operating_point_moves_the_speed(page: Page) -> None:
    slider = page.get_by_test_id("drag:1")
    slider.focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Tab")
    at_rest(page)
    assert page.get_by_test_id(f"field:{SPEED}").input_value() != "20.3 mm/s"


def test_a_slider_is_moved_by_touch_on_a_phone(browser: Browser, workbench: Served) -> None:
    context = browser.new_context(viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True)
    for page in opened(context, workbench):
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
    context = browser.new_context(
        viewport={"width": width, "height": height}, color_scheme=scheme, bypass_csp=True, reduced_motion="reduce"
    )
    for page in opened(context, workbench):
        for where in ("predict", "explore", "jobs", "new"):
            show(page, workbench, "tribometer", {}, where=where)
            page.wait_for_function("() => !document.querySelector('[aria-busy=true]')", timeout=60_000)
            assert faults_of_access(page) == [], where
            widths = page.evaluate("[document.documentElement.scrollWidth, innerWidth]")
            assert widths[0] <= widths[1], where


def test_a_refused_rig_has_no_fault_of_access(browser: Browser, workbench: Served) -> None:
    context = browser.new_context(bypass_csp=True)
    for page in opened(context, workbench):
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


def test_what_is_taken_away_gives_the_numbers_on_screen(
    page: Page, workbench: Served, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    changes = {VOLTS: "21 V", SPEED: "30 mm/s"}
    show(page, workbench, "tribometer", changes)
    at_rest(page)
    rig = read_rig(RIGS / "tribometer.toml", changes=[f"{key}={value}" for key, value in changes.items()])
    expected = json.loads(sl.predict(rig).to_json())
    page.get_by_test_id("take").click()
    taken = {}
    for form in ("command", "python"):
        page.get_by_test_id(f"take:{form}").click()
        text = page.get_by_test_id("taken")
        expect(text).to_have_value(re.compile("^sonolube" if form == "command" else "^import"), timeout=30_000)
        taken[form] = text.input_value()
    with page.expect_download() as download:
        page.get_by_test_id("take:toml").click()
    taken["toml"] = Path(download.value.path()).read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tribometer.toml").write_text((RIGS / "tribometer.toml").read_text(encoding="utf-8"), encoding="utf-8")
    scope: dict[str, Any] = {}
    exec(compile(taken["python"], "answer.py", "exec"), scope)
    assert json.loads(scope["answer"].to_json())["friction_ratio"] == expected["friction_ratio"]
    capsys.readouterr()
    (tmp_path / "tribometer.toml").write_text(taken["toml"], encoding="utf-8")
    with pytest.raises(SystemExit):
        main(["predict", "tribometer.toml", "--json"])
    assert json.loads(capsys.readouterr().out)["friction_ratio"] == expected["friction_ratio"]
    assert taken["command"].split()[:2] == ["sonolube", "predict"]


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


def test_a_study_is_explored_and_a_click_sets_the_rig(page: Page, workbench: Served) -> None:
    page.get_by_test_id("page:explore").click()
    plot = page.get_by_test_id("plot:0").first
    plot.wait_for(timeout=120_000)
    page.wait_for_function("() => !document.querySelector('[aria-busy=true]')", timeout=120_000)
    box = plot.bounding_box()
    assert box is not None
    assert box["width"] > 200


def test_jobs_are_listed_and_deleted(page: Page) -> None:
    page.evaluate(
        """async () => fetch('api/jobs', {method: 'POST', body: JSON.stringify(
        {task: 'contact', arguments: {rig: {name: 'tribometer'}}, label: 'contact of the tribometer'})})"""
    )
    page.get_by_test_id("page:jobs").click()
    expect(page.get_by_text("contact of the tribometer").first).to_be_visible(timeout=30_000)
