"""All pages in a real browser: drawn, narrow enough for a phone, without network requests, and usable."""

from collections.abc import Iterator
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest
from playwright.sync_api import Browser, Page, sync_playwright
from tests.chromium import CHROMIUM, FLAGS

from sonolube.cli import main
from sonolube.report import MeasurementReport, PinOnDiscSheet, measurement_page
from sonolube.report.measured.surface import SurfaceSettings, surface_sheet
from sonolube.storage.files import write_atomically

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
VOLTS = "drive.voltage_peak_to_peak"
DESIGNS = {
    "sweep": ("tribometer", "--over", f"{VOLTS}=14V:28V:5", "--set", "contact.normal_load=4N"),
    "map": ("power_map", "--over", f"{VOLTS}=5V:25V:3", "--over", "contact.normal_load=3N,5N"),
    "uncertainty": ("tribometer_uncertain", "--samples", "32", "--sobol"),
    "optimise": ("tribometer", "--target-friction", "0.15", "--voltage-limit", "100V"),
    "control": ("collar", "--friction", "1.5N", "--duration", "40ms"),
}

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium"),
]


def write_design_page(command: str, folder: Path) -> Path:
    rig, *options = DESIGNS[command]
    with pytest.raises(SystemExit) as end:
        main([command, str(RIGS / f"{rig}.toml"), *options, "--out", str(folder)])
    assert end.value.code == 0
    return folder / f"{command}.html"


def write_measurement_page(folder: Path) -> Path:
    np.save(folder / "plate.npy", 1e-6 * np.random.default_rng(1).standard_normal((64, 80)))
    sheet = surface_sheet(folder / "plate.npy", settings=SurfaceSettings(spacing_x=1e-6, spacing_y=1e-6))
    report = MeasurementReport(
        title="surfaces",
        settings=MappingProxyType({"spacing": "1um"}),
        sheets=(sheet, sheet),
        refused=MappingProxyType({"bad.npy": "bad.npy: byte 0: the file is empty"}),
        test=PinOnDiscSheet(entries={"parameters": {"normal_load": "3N"}}),
    )
    return write_atomically(folder / "page.html", measurement_page(report))


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def addresses() -> dict[str, str]:
    """Addresses of pages that were written, by name."""
    return {}


@pytest.fixture(scope="module")
def pages(
    browser: Browser, addresses: dict[str, str], tmp_path_factory: pytest.TempPathFactory, chapter_3_report: Path
) -> dict[str, Page]:
    """Open pages by name, each written when it is first needed."""

    class Pages(dict[str, Page]):
        def __missing__(self, name: str) -> Page:
            folder: Path = tmp_path_factory.mktemp(name)
            if name in DESIGNS:
                path = write_design_page(name, folder)
            elif name == "measurement":
                path = write_measurement_page(folder)
            else:
                path = chapter_3_report / "reproduction.html"
            addresses[name] = path.as_uri()
            self[name] = browser.new_page(viewport={"width": 1280, "height": 900})
            self[name].goto(addresses[name])
            return self[name]

    return Pages()


every_page = pytest.mark.parametrize("name", [*DESIGNS, "measurement", "reproduction"])
every_design = pytest.mark.parametrize("name", DESIGNS)


@every_page
def test_every_picture_is_drawn_and_named(name: str, pages: dict[str, Page]) -> None:
    sizes = pages[name].evaluate("[...document.images].map(image => [image.naturalWidth, image.alt])")
    assert sizes
    assert all(width > 0 and alt for width, alt in sizes)
    assert len(sizes) == 8 or name != "measurement"


@every_page
def test_a_phone_shows_the_page_without_sideways_scrolling(name: str, pages: dict[str, Page]) -> None:
    page = pages[name]
    page.set_viewport_size({"width": 390, "height": 844})
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.set_viewport_size({"width": 1280, "height": 900})


@every_page
def test_the_page_makes_no_network_request_and_no_error(
    name: str, pages: dict[str, Page], addresses: dict[str, str]
) -> None:
    page = pages[name]
    requests: list[str] = []
    errors: list[str] = []
    page.on("request", lambda request: requests.append(request.url))
    page.on("console", lambda message: errors.append(message.text))
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.goto(addresses[name])
    assert [url for url in requests if not url.startswith(("file:", "data:"))] == []
    assert errors == []


@every_design
def test_settings_results_figures_caveats_and_versions_are_on_the_page(name: str, pages: dict[str, Page]) -> None:
    page = pages[name]
    for part in ("settings", "results", "figures", "caveats"):
        assert page.locator(f"#{part}").is_visible()
    assert page.locator("table.pairs").last.locator("th", has_text="--").count() > 0
    assert "sonolube" in page.locator("footer").inner_text()
    assert "numpy" in page.locator("footer").inner_text()


@every_design
def test_every_picture_has_a_caption(name: str, pages: dict[str, Page]) -> None:
    assert pages[name].locator("figcaption").count() == pages[name].locator("img").count() > 0


@every_design
def test_every_row_of_a_table_has_as_many_cells_as_there_are_heads(name: str, pages: dict[str, Page]) -> None:
    rows = "[...table.rows].map(row => row.cells.length)"
    tables = pages[name].evaluate(f"[...document.querySelectorAll('table:not(.pairs)')].map(table => {rows})")
    assert tables
    assert all(len(set(cells)) == 1 and len(cells) > 1 for cells in tables)


def test_the_list_of_files_leads_to_their_sheets(pages: dict[str, Page]) -> None:
    page = pages["measurement"]
    page.locator("nav a").nth(1).click()
    assert page.url.endswith("#sheet-2")
    assert page.locator("#sheet-2").bounding_box() is not None


def test_the_test_sheet_and_the_refused_file_are_on_the_page(pages: dict[str, Page]) -> None:
    page = pages["measurement"]
    assert page.get_by_text("bad.npy: byte 0: the file is empty").is_visible()
    assert page.locator("#test-sheet").is_visible()
    assert page.get_by_text("3N", exact=True).is_visible()


def test_clearing_a_verdict_hides_its_rows_and_ticking_shows_them_again(pages: dict[str, Page]) -> None:
    page = pages["reproduction"]
    rows = page.locator('table[data-chapter="3"] tr[data-verdict="reproduced"]')
    box = page.locator('input[data-chapter="3"][data-verdict="reproduced"]')
    assert rows.first.is_visible()
    box.uncheck()
    assert not rows.first.is_visible()
    assert page.locator('table[data-chapter="3"] tr[data-verdict="misprint"]').first.is_visible()
    box.check()
    assert rows.first.is_visible()
