"""Reports of the design commands in a real browser: whole, narrow enough for a phone, silent towards the network."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page, sync_playwright

from sonolube.cli import main

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-sync", "--no-first-run"]
RIGS = Path(__file__).parents[2] / "examples" / "rigs"
VOLTS = "drive.voltage_peak_to_peak"
CALLS = {
    "sweep": ("tribometer", "--over", f"{VOLTS}=14V:28V:5", "--set", "contact.normal_load=4N"),
    "map": ("power_map", "--over", f"{VOLTS}=5V:25V:3", "--over", "contact.normal_load=3N,5N"),
    "uncertainty": ("tribometer_uncertain", "--samples", "32", "--sobol"),
    "optimise": ("tribometer", "--target-friction", "0.15", "--samples", "2", "--voltage-limit", "100V"),
    "control": ("collar", "--friction", "1.5N", "--duration", "40ms"),
}

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium"),
]


@pytest.fixture(scope="module", params=CALLS)
def address(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> str:
    command = str(request.param)
    folder = tmp_path_factory.mktemp(command)
    rig, *options = CALLS[command]
    with pytest.raises(SystemExit) as end:
        main([command, str(RIGS / f"{rig}.toml"), *options, "--out", str(folder)])
    assert end.value.code == 0
    return (folder / f"{command}.html").as_uri()


@pytest.fixture(scope="module")
def page(address: str) -> Iterator[Page]:
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.goto(address)
        yield page
        browser.close()


def test_settings_results_figures_caveats_and_versions_are_on_the_page(page: Page) -> None:
    for part in ("settings", "results", "figures", "caveats"):
        assert page.locator(f"#{part}").is_visible()
    assert page.locator("table.pairs").first.locator("th", has_text="--").count() > 0
    assert "sonolube" in page.locator("footer").inner_text()
    assert "numpy" in page.locator("footer").inner_text()


def test_every_picture_is_drawn_named_and_captioned(page: Page) -> None:
    sizes = page.evaluate("[...document.images].map(image => [image.naturalWidth, image.alt])")
    assert sizes
    assert all(width > 0 and alt for width, alt in sizes)
    assert len(page.locator("figcaption").all()) == len(sizes)


def test_its_tables_hold_as_many_cells_to_a_row_as_heads(page: Page) -> None:
    tables = page.evaluate(
        "[...document.querySelectorAll('table:not(.pairs)')].map(table => [...table.rows].map(row => row.cells.length))"
    )
    assert tables
    assert all(len(set(cells)) == 1 and len(cells) > 1 for cells in tables)


def test_a_phone_shows_the_page_without_sideways_scrolling(page: Page) -> None:
    page.set_viewport_size({"width": 390, "height": 844})
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.set_viewport_size({"width": 1280, "height": 900})


def test_nothing_is_asked_of_the_network_and_nothing_complains(address: str, page: Page) -> None:
    asked: list[str] = []
    complaints: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(address)
    assert [url for url in asked if not url.startswith(("file:", "data:"))] == []
    assert complaints == []
