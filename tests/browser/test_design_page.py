"""Page Design: from a rig to a controller in C and as units, designs of a front, and a plan, by mouse and keyboard."""

import json
import re
import zipfile
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect
from tests.browser.pages import LOAD, RIGS, at_rest, opened, show
from tests.browser.test_answer_files import plain
from tests.browser.test_pages import faults_of_access
from tests.browser.walks import HANDS, Mouse
from tests.browser.workbench import Served
from tests.chromium import CHROMIUM
from tests.same import same_text

from sonolube.cli import main

VARIED = "20kHz:24kHz", "90g:130g"  # frequency and mass of the tip

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium"),
]


@pytest.fixture
def terminal(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Any:
    """The program as a function of its words: its object, with its files in `tmp_path`."""

    def run(*words: str) -> dict[str, Any]:
        capsys.readouterr()
        with pytest.raises(SystemExit) as end:
            main([*words, "--json", "--out", str(tmp_path)])
        assert not end.value.code
        content: dict[str, Any] = json.loads(capsys.readouterr().out)
        return content

    return run


def downloaded(walk: Mouse, test: str) -> bytes:
    """Content of a file that is saved by a button or a link."""
    with walk.page.expect_download() as download:
        walk.press(test)
    return Path(download.value.path()).read_bytes()


@pytest.mark.parametrize("hand", HANDS)
def test_a_controller_in_c_and_as_units(hand: type[Mouse], page: Page, tmp_path: Path, terminal: Any) -> None:
    walk = hand(page, "control-engineer")
    walk.press("page:design")
    at_rest(page)
    walk.pick("part:control")
    at_rest(page)
    walk.write("control.friction", "0.5N")
    walk.write("control.delay", "2ms")
    walk.picture("controller")
    content = terminal("control", str(RIGS / "tribometer.toml"), "--friction", "0.5N", "--delay", "2ms")
    shown = page.get_by_test_id("numbers").locator("dd").all_text_contents()
    assert shown == [each["text"] for each in content["summary"]]
    told = {each["key"]: each["text"] for each in content["summary"]}
    expect(page.get_by_text(f"Gain margin {told['gain_margin']}, phase margin {told['phase_margin']}")).to_be_visible()
    for ending in (".c", ".csv"):
        written = (tmp_path / f"tribometer-control{ending}").read_text(encoding="utf-8")
        same_text(plain(downloaded(walk, f"save:{ending}")), written)
    if hand is Mouse:
        walk.press("start-job")  # the other hand finds what was made
    page.get_by_test_id("job-files").wait_for()
    walk.picture("units")
    unit = tmp_path / "controller.fmu"
    unit.write_bytes(downloaded(walk, "file:tribometer-controller.fmu"))
    assert "modelDescription.xml" in zipfile.ZipFile(unit).namelist()


@pytest.fixture(scope="module")
def front(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Front of the task in Python, as JSON."""
    import sonolube as sl

    over = dict(zip(("drive.frequency", "structure.tip_mass"), VARIED, strict=True))
    found = sl.optimise(RIGS / "tribometer.toml", target_friction="0.15", pareto="heat", samples=2, over=over)
    content: dict[str, Any] = json.loads(found.to_json())
    return content


@pytest.mark.parametrize("hand", HANDS)
def test_a_design_of_the_front_is_set_into_the_rig(
    hand: type[Mouse], page: Page, workbench: Served, front: dict[str, Any]
) -> None:
    show(page, workbench, "tribometer", {}, where="design")
    walk = hand(page, "designer")
    expect(page.get_by_test_id("start-job")).to_be_disabled()
    walk.write("optimise.target_friction", "0.15", rests=False)
    walk.choose("optimise.pareto", "heat")
    for key, ends in zip(("drive.frequency", "structure.tip_mass"), VARIED, strict=True):
        walk.write(f"over.{key}", ends, rests=False)
    page.locator("summary").get_by_text("Limits and tolerances").press("Enter")
    walk.write("optimise.samples", "2", rests=False)
    if hand is Mouse:
        walk.press("start-job")
    page.get_by_test_id("designs").wait_for()
    table = page.get_by_test_id("designs-table").locator("tbody tr")
    assert table.count() == len(front["front"])
    last = len(front["front"]) - 1
    walk.pick(f"design:{last}")
    expect(page.get_by_test_id(f"row:{last}")).to_have_class(re.compile("is-chosen"))
    walk.picture("front")
    plot = page.get_by_test_id("designs").get_by_test_id("plot:0").first
    page.mouse.move(2, 2)
    plot.focus()
    expect(page.locator(".design.is-read")).to_have_count(0)
    page.keyboard.press("ArrowDown")
    expect(page.locator(".design.is-read")).to_have_count(1)
    page.keyboard.press("Enter")
    read = page.locator(".design.is-read")
    expect(read).to_have_class(re.compile("is-chosen"))
    number = int((read.get_attribute("data-test") or "").removeprefix("row:"))
    walk.press("use-design")
    expect(page.get_by_test_id("used")).to_contain_text(f"Design {number + 1} is set into the rig.")
    changes = front["front"][number]["changes"]
    for key in ("drive.frequency", "drive.voltage_peak_to_peak"):
        expect(page.get_by_test_id(f"field:{key}")).to_have_value(changes[key])
    assert f"structure.tip_mass:{changes['structure.tip_mass'].replace(' ', '+')}" in page.url


def test_a_plan_is_reached_from_what_would_sharpen_a_prediction(
    page: Page, workbench: Served, terminal: Any, tmp_path: Path
) -> None:
    show(page, workbench, "tribometer", {LOAD: "4 N"})
    page.get_by_test_id("plan-tests").click()
    page.get_by_test_id("plan").wait_for()
    page.get_by_test_id("plan.points").fill("2")
    page.keyboard.press("Enter")
    expect(page.get_by_test_id("plan-points").locator("tbody tr")).to_have_count(2)
    at_rest(page)
    content = terminal("plan", str(RIGS / "tribometer.toml"), "--set", f"{LOAD}=4 N", "--points", "2")
    assert page.get_by_test_id("plan-runs").locator("tbody tr").count() == len(content["runs"])
    walk = Mouse(page, "plan")
    runs = (tmp_path / "tribometer-plan-runs.csv").read_text(encoding="utf-8")
    same_text(plain(downloaded(walk, "save:-runs.csv")), runs)
    sheet = downloaded(walk, "save:report").decode()
    assert "To be reported, in the order of ASTM G99" in sheet


REFUSED = (
    ("control", "control.rate", "-1 Hz", "control-rate-refusal"),
    ("control", "control.friction", "5N", ""),
    ("plan", "plan.points", "many", "plan-points-refusal"),
    ("plan", "plan.speed", "3 kg", "plan-speed-refusal"),
    ("designs", "optimise.target_friction", "2N", "optimise-target_friction-refusal"),
)


def test_what_a_task_refuses_stands_below_its_field(page: Page, workbench: Served) -> None:
    for part, entry, text, refusal in REFUSED:
        page.goto(f"{workbench.address}#/design?rig=tribometer&part={part}")
        page.get_by_test_id(f"part:{part}").and_(page.locator(":checked")).wait_for()
        page.get_by_test_id(entry).fill(text)
        page.keyboard.press("Enter")
        if part == "designs":
            page.get_by_test_id("start-job").click()
        said = page.locator(f"#{refusal}") if refusal else page.get_by_test_id("refused")
        expect(said.first).to_be_visible()
        assert page.get_by_test_id(entry).input_value() == text


@pytest.mark.parametrize(
    ("part", "rig", "said"),
    [
        ("plan", "finger_on_glass", "this rests on tests of hard bodies"),
        ("designs", "cutter_head", "stack and structure"),
    ],
)
def test_a_study_that_a_rig_has_not_is_said_in_one_line(
    part: str, rig: str, said: str, page: Page, workbench: Served
) -> None:
    page.goto(f"{workbench.address}#/design?rig={rig}&part={part}&optimise.target_reduction=20+%25")
    if part == "designs":
        page.get_by_test_id("start-job").click()
    expect(page.get_by_test_id("refused")).to_contain_text(said)


def test_no_part_has_a_fault_of_access_or_scrolls_sideways_on_a_phone(browser: Browser, workbench: Served) -> None:
    phone: dict[str, Any] = {"viewport": {"width": 320, "height": 640}, "color_scheme": "dark", "bypass_csp": True}
    with opened(browser, workbench, **phone, reduced_motion="reduce") as page:
        for part in ("plan", "control"):
            page.goto(f"{workbench.address}#/design?rig=tribometer&part={part}")
            page.get_by_test_id(part).wait_for()
            at_rest(page)
            assert faults_of_access(page) == [], part
            assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), part
