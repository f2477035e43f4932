"""The page of measurements in a real browser: drawn, narrow enough for a phone, silent towards the network."""

import shutil
from collections.abc import Iterator
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest
from playwright.sync_api import Page, sync_playwright

from sonolube.report import MeasurementReport, PinOnDiscSheet, write_measurement_report
from sonolube.report.measured.surface import SurfaceSettings, surface_sheet

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-sync", "--no-first-run"]

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium"),
]


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder: Path = tmp_path_factory.mktemp("measured")
    np.save(folder / "plate.npy", 1e-6 * np.random.default_rng(1).standard_normal((64, 80)))
    sheet = surface_sheet(folder / "plate.npy", settings=SurfaceSettings(spacing_x=1e-6, spacing_y=1e-6))
    report = MeasurementReport(
        title="surfaces",
        settings=MappingProxyType({"spacing": "1um"}),
        sheets=(sheet, sheet),
        refused=MappingProxyType({"bad.npy": "bad.npy: byte 0: the file is empty"}),
        test=PinOnDiscSheet(entries={"parameters": {"normal_load": "3N"}}),
    )
    return write_measurement_report(report, path=folder / "page.html").as_uri()


@pytest.fixture(scope="module")
def page(address: str) -> Iterator[Page]:
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.goto(address)
        yield page
        browser.close()


def test_every_picture_is_drawn_and_named(page: Page) -> None:
    sizes = page.evaluate("[...document.images].map(image => [image.naturalWidth, image.alt])")
    assert len(sizes) == 8
    assert all(width > 0 and alt for width, alt in sizes)


def test_the_list_of_files_leads_to_their_sheets(page: Page) -> None:
    page.locator("nav a").nth(1).click()
    assert page.url.endswith("#sheet-2")
    assert page.locator("#sheet-2").bounding_box() is not None


def test_the_test_sheet_and_the_refused_file_are_on_the_page(page: Page) -> None:
    assert page.get_by_text("bad.npy: byte 0: the file is empty").is_visible()
    assert page.locator("#test-sheet").is_visible()
    assert page.get_by_text("3N", exact=True).is_visible()


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
