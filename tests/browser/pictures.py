"""Pictures of the workbench in each state, for its page in the docs: `python -m tests.browser.pictures FOLDER`."""

import io
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from PIL import Image
from playwright.sync_api import Browser, Page, expect
from tests.browser.pages import LOAD, VOLTS, at_rest, go, opened, show, started_browser
from tests.browser.recordings import write_recordings
from tests.browser.scans import write_groove
from tests.browser.workbench import Served, served

NEW = {"pin": "steel", "disc": "steel", "load": "5 N", "speed": "0.1 m/s", "frequency": "22 kHz", "amplitude": "2 um"}
"""Answers to the questions of a new rig."""

_COLOURS = 255  # of a picture, which keep it small
_SHADES: tuple[tuple[str, dict[str, object]], ...] = (
    ("light", {}),
    ("dark", {"color_scheme": "dark"}),
    ("narrow", {"viewport": {"width": 390, "height": 844}}),
)

Shots = Iterator[tuple[str, bytes]]


def every_picture() -> Shots:
    """Name and content of each picture, those of the page without its server last."""
    with tempfile.TemporaryDirectory() as folder, served(Path(folder)) as workbench, started_browser() as browser:
        for name, options in _SHADES:
            with opened(browser, workbench, **options) as page:
                yield f"predict-{name}", page.screenshot()
        with opened(browser, workbench) as page:
            yield from _pages(page, workbench)
            yield from _scan(page, workbench, Path(folder))
            yield from _data(page, workbench, Path(folder))
            yield from _modes(page, workbench)
            yield from laboratory(page, workbench)
        yield from _without_an_answer(browser, workbench)


def _pages(page: Page, workbench: Served) -> Shots:
    """Every page with what it shows at work."""
    show(page, workbench, "tribometer", {LOAD: "3 kg"})
    yield "refused", page.screenshot()
    show(page, workbench, "tribometer", {}, where="explore")
    page.get_by_test_id("study:map").check()
    at_rest(page)
    yield "explore", page.screenshot()
    page.get_by_test_id("study:start").check()
    page.get_by_test_id("start-job").click()
    page.get_by_test_id("study").wait_for()
    show(page, workbench, "tribometer", {}, where="design")
    page.get_by_test_id("part:control").check()
    page.get_by_test_id("control.friction").fill("0.5N")
    page.keyboard.press("Enter")
    page.get_by_test_id("control").wait_for()
    at_rest(page)
    yield "control", page.screenshot(clip={"x": 0, "y": 0, "width": 1280, "height": 1120}, full_page=True)
    show(page, workbench, "tribometer", {}, where="dissertation")
    page.get_by_test_id("start-job").click()
    page.get_by_test_id("cancel-job").wait_for()
    yield "dissertation", page.screenshot()
    go(page, "jobs")
    page.get_by_test_id("open-job").click()
    page.get_by_test_id("job-result").wait_for()
    yield "jobs", page.screenshot()
    show(page, workbench, "tribometer", {}, where="new")
    for name, text in NEW.items():
        page.get_by_test_id(f"new:{name}").fill(text)
    page.keyboard.press("Enter")
    page.get_by_test_id("use-rig").wait_for()
    at_rest(page)
    yield "new", page.screenshot()


def _data(page: Page, workbench: Served, folder: Path) -> Shots:
    """A recording with its steps, and one whose columns are asked for."""
    show(page, workbench, "tribometer", {}, where="data")
    page.get_by_test_id("data-files").set_input_files(write_recordings(folder))
    page.get_by_test_id("set:normal_load").fill("3 N")
    page.keyboard.press("Enter")
    page.get_by_test_id("measured").wait_for()
    at_rest(page)
    page.evaluate("scrollTo(0, 0)")
    yield "data", page.screenshot()
    page.get_by_test_id("file:cell.csv").click()
    page.get_by_test_id("column:Zeit").fill("time ms")
    page.get_by_test_id("column:Zelle").fill("friction_force N")
    yield "columns", page.get_by_test_id("columns").screenshot()


def _scan(page: Page, workbench: Served, folder: Path) -> Shots:
    """A scan with a groove, cut aslant, and in 3D."""
    show(page, workbench, "tribometer", {}, where="data")
    page.get_by_test_id("data-files").set_input_files(write_groove(folder))
    page.get_by_test_id("set:spacing").fill("5 um")
    page.keyboard.press("Enter")
    page.get_by_test_id("set:measure").select_option("groove")
    page.get_by_test_id("set:robust").check()
    page.get_by_test_id("set:from_y").fill("650 um")
    page.keyboard.press("Enter")
    page.get_by_test_id("measured").wait_for()
    at_rest(page)
    yield "scan", page.screenshot(full_page=True, clip={"x": 0, "y": 0, "width": 1280, "height": 1000})
    page.get_by_test_id("set:seen").select_option("relief")
    page.get_by_test_id("surface-canvas").wait_for()
    at_rest(page)
    yield "scan-relief", page.get_by_test_id("scan").screenshot()


def _modes(page: Page, workbench: Served) -> Shots:
    """A horn that was tuned to 20 kHz, with its stress."""
    page.emulate_media(reduced_motion="reduce")
    show(page, workbench, "tribometer", {}, where="modes")
    page.get_by_test_id("work:tune").check()
    page.get_by_test_id("modes:material").select_option("titanium_6al4v")
    for name, text in {"size.end_radius": "10 mm", "tune.amplitude": "20 um"}.items():
        page.get_by_test_id(f"modes:{name}").fill(text)
        page.keyboard.press("Enter")
    page.get_by_test_id("start-job").click()
    page.get_by_test_id("colour").select_option("stress")
    page.get_by_test_id("surface-canvas").hover()
    yield "modes", page.screenshot(full_page=True, clip={"x": 0, "y": 0, "width": 1280, "height": 960})


def laboratory(page: Page, workbench: Served) -> Shots:
    """The page Lab with a protocol along time, with a run at its voltages, and the page of the run itself."""
    show(page, workbench, "tribometer", {}, where="lab")
    page.get_by_test_id("step:7").click()
    page.get_by_test_id("plan").evaluate("plan => plan.scrollIntoView()")
    yield "lab-plan", page.screenshot()
    page.get_by_test_id("start").click()
    for text in ("Wipe pin and plate", "Hang the weight"):
        expect(page.get_by_test_id("prompt")).to_contain_text(text)
        page.get_by_test_id("confirm").click()
    expect(page.get_by_test_id("run-step")).to_contain_text("step 7")
    expect(page.get_by_test_id("run-time")).to_contain_text("21 s of")
    page.get_by_test_id("run").evaluate("run => run.scrollIntoView()")
    yield "lab", page.screenshot()
    own = page.context.browser.new_page(viewport={"width": 640, "height": 620})  # type: ignore[union-attr]
    own.goto(str(page.get_by_test_id("stop-page").get_attribute("href")))
    yield "stop", own.screenshot()
    own.get_by_role("button", name="Stop").click()
    own.close()
    expect(page.get_by_test_id("stop")).to_be_hidden()


def _without_an_answer(browser: Browser, workbench: Served) -> Shots:
    """The page that asks for the link, that waits for its first answer, and that has lost its server."""
    page = browser.new_page(viewport={"width": 900, "height": 440})
    page.goto(workbench.address)
    yield "link", page.screenshot()
    page.route("**/api/tasks/**", lambda route: None)  # never answered
    page.goto(workbench.link)
    page.get_by_test_id("rig-title").wait_for()
    yield "loading", page.screenshot()
    page.unroute_all()
    page.reload()
    at_rest(page)
    workbench.process.terminate()
    workbench.process.wait()
    page.get_by_test_id(f"field:{VOLTS}").fill("14 V")
    page.keyboard.press("Enter")
    page.get_by_test_id("offline").wait_for()
    yield "offline", page.screenshot()
    page.close()


def main(folder: Path) -> None:
    """Write the pictures as small PNG files."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in every_picture():
        picture = Image.open(io.BytesIO(content)).convert("RGB").quantize(_COLOURS, dither=Image.Dither.NONE)
        picture.save(folder / f"workbench-{name}.png", optimize=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
