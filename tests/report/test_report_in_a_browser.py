"""The reproduction report in a real browser: it shows, it filters, it asks the network for nothing."""

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page, sync_playwright

from sonolube.report import write_report
from sonolube.reproduce import reproduction

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium"),
]


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder: Path = tmp_path_factory.mktemp("browsed")
    return write_report(reproduction(chapter=3), folder=folder)[0].as_uri()


@pytest.fixture(scope="module")
def page(address: str) -> Iterator[Page]:
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.goto(address)
        yield page
        browser.close()


def test_unticking_a_verdict_hides_its_rows_and_ticking_shows_them_again(page: Page) -> None:
    rows = page.locator('table[data-chapter="3"] tr[data-verdict="reproduced"]')
    box = page.locator('input[data-chapter="3"][data-verdict="reproduced"]')
    assert rows.first.is_visible()
    box.uncheck()
    assert not rows.first.is_visible()
    assert page.locator('table[data-chapter="3"] tr[data-verdict="misprint"]').first.is_visible()
    box.check()
    assert rows.first.is_visible()


def test_every_picture_is_drawn(page: Page) -> None:
    sizes = page.evaluate("[...document.images].map(image => [image.naturalWidth, image.alt])")
    assert sizes
    assert all(width > 0 and alt for width, alt in sizes)


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
