"""One browser and one workbench a file of tests."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page
from tests.browser.pages import opened, started_browser
from tests.browser.workbench import Served, served


@pytest.fixture(scope="module")
def workbench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    with served(tmp_path_factory.mktemp("workbench")) as found:
        yield found


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with started_browser() as found:
        yield found


@pytest.fixture(scope="module")
def shown(browser: Browser, workbench: Served) -> Iterator[Page]:
    """One page for tests that show what they need by `show`."""
    with opened(browser, workbench) as found:
        yield found


@pytest.fixture
def page(browser: Browser, workbench: Served) -> Iterator[Page]:
    with opened(browser, workbench) as found:
        yield found
