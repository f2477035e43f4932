"""A page of the workbench in a browser, for tests: shown, waited for, read."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import quote

from playwright.sync_api import Browser, Page, expect, sync_playwright
from tests.browser.workbench import Served
from tests.chromium import CHROMIUM, FLAGS

EXAMPLES = Path(__file__).parents[2] / "examples"
RIGS = EXAMPLES / "rigs"
VOLTS, SPEED, LOAD = "drive.voltage_peak_to_peak", "sliding.sliding_speed", "contact.normal_load"
AMPLITUDE = "vibration.vibration_amplitude"
PROXIED = "lab.example"
"""Name of a host that the browser finds on this computer, as if a proxy had it."""

_OUTSIDE = (
    "Cross-Origin-Opener-Policy header has been ignored",  # of a name without TLS, behind a proxy of a test
    "GL Driver Message",  # of WebGL without a graphics card
)
_PATIENCE = 120_000  # ms; a limit for what never comes, on a slow machine too
_SETTLED = """() => document.querySelector('#main #answer')
    && ![...document.querySelectorAll('#main .loading, #main .skeleton, #main [aria-busy=true]')]
      .some((element) => element.checkVisibility())"""


expect.set_options(timeout=_PATIENCE)


@contextmanager
def started_browser() -> Iterator[Browser]:
    """Chromium, in which elements are found by `data-test`."""
    with sync_playwright() as playwright:
        playwright.selectors.set_test_id_attribute("data-test")
        flags = [*FLAGS, f"--host-resolver-rules=MAP {PROXIED} 127.0.0.1"]
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=flags)
        yield browser
        browser.close()


@contextmanager
def opened(browser: Browser, workbench: Served, **options: Any) -> Iterator[Page]:
    """Page that was let in, at rest; it may ask nothing of another host, and its console stays empty."""
    context = browser.new_context(**({"viewport": {"width": 1280, "height": 800}} | options))
    context.set_default_timeout(_PATIENCE)
    foreign: list[str] = []
    said: list[str] = []
    page = context.new_page()
    page.on("request", lambda request: foreign.append(request.url) if not own(request.url, workbench) else None)
    page.on(
        "console", lambda message: None if any(each in message.text for each in _OUTSIDE) else said.append(message.text)
    )
    page.on("pageerror", lambda error: said.append(str(error)))
    page.goto(workbench.link)
    at_rest(page)
    yield page
    assert (foreign, said) == ([], []), (foreign, said)
    context.close()


def own(url: str, workbench: Served) -> bool:
    """Whether an address is of the workbench."""
    return url.startswith((workbench.address, "data:", "blob:"))


def at_rest(page: Page) -> None:
    """Wait until nothing is read or computed: what is shown is of the state."""
    page.wait_for_function(_SETTLED, timeout=_PATIENCE)


def show(page: Page, workbench: Served, name: str, changes: Mapping[str, str], *, where: str = "predict") -> None:
    """Show a page of a rig with changes, as a link does, and wait until it is at rest."""
    entries = "".join(f"&set={_quoted(f'{key}:{value}')}" for key, value in changes.items())
    query = f"?rig={name}{entries}"
    page.goto(f"{workbench.address}#/{where}{query}")
    page.locator(f'[data-test="home"][href="#/predict{query}"]').wait_for()  # the state is that of the address
    page.locator(f'[data-test="page:{where}"][aria-current=page]').wait_for()
    at_rest(page)


def go(page: Page, where: str) -> None:
    """Go to a page by its door, or by the menu of the others."""
    door = page.get_by_test_id(f"page:{where}")
    if not door.is_visible():
        page.get_by_test_id("more").click()
    door.click()


def _quoted(text: str) -> str:
    """Text as the page writes it in its address."""
    return quote(text, safe="!'()*-._~:/").replace("%20", "+")


def numbers(page: Page) -> list[list[str]]:
    """Label, median and interval of 80 % of each number on screen."""
    rows: list[list[str]] = (
        page.get_by_test_id("numbers")
        .locator(".number")
        .evaluate_all("rows => rows.map(row => [...row.children].map(cell => cell.textContent.trim()))")
    )
    return rows


def enter(page: Page, key: str, text: str) -> None:
    """Type a value into its field, opened where it is folded, and wait for the answer."""
    if not page.get_by_test_id(f"field:{key}").is_visible():
        page.get_by_test_id("all-entries").locator("summary").click()
    page.get_by_test_id(f"field:{key}").fill(text)
    page.keyboard.press("Enter")
    at_rest(page)


def in_use(page: Page) -> str:
    """`data-test` of the element that has the focus."""
    found: str = page.evaluate("document.activeElement?.closest('[data-test]')?.dataset.test ?? ''")
    return found


def reach(page: Page, test: str, *, back: bool = False) -> None:
    """Go by the tab key to an element once it is there; the whole page has fewer stops than are tried."""
    expect(page.get_by_test_id(test).first).to_be_enabled()
    for _ in range(400):
        if in_use(page) == test:
            return
        page.keyboard.press("Shift+Tab" if back else "Tab")
    raise AssertionError(f"no stop of the tab key at {test}")


def saved(page: Page, form: str) -> str:
    """Text of a file that is taken away, from the open menu."""
    with page.expect_download() as download:
        page.get_by_test_id(f"take:{form}").click()
    return Path(download.value.path()).read_text(encoding="utf-8")
