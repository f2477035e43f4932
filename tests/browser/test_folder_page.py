"""The folder of a rig in a real browser: its runs in the table, each change in its file, and none of others lost."""

from collections.abc import Iterator
from pathlib import Path
from shutil import copy

import pytest
from playwright.sync_api import Browser, Page, expect
from tests.browser.pages import at_rest, go, opened
from tests.browser.workbench import Served, served
from tests.chromium import CHROMIUM

import sonolube as sl

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium"),
]

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Path:
    (place := tmp_path_factory.mktemp("rigs") / "bench").mkdir()
    copy(EXAMPLES / "rigs" / "tribometer.toml", place / "rig.toml")
    copy(EXAMPLES / "tribometer-runs.csv", place / "runs.csv")
    return place


@pytest.fixture(scope="module")
def workbench(tmp_path_factory: pytest.TempPathFactory, bench: Path) -> Iterator[Served]:
    with served(tmp_path_factory.mktemp("workbench"), str(bench)) as found:
        yield found


@pytest.fixture
def page(browser: Browser, workbench: Served) -> Iterator[Page]:
    with opened(browser, workbench) as found:
        yield found


def used(bench: Path) -> list[bool]:
    return [run["is_used"] for run in sl.runs(bench).object()["runs"]]


def test_the_table_is_that_of_the_folder_and_every_change_is_in_its_file(page: Page, bench: Path) -> None:
    note = page.get_by_test_id("runs-note")
    expect(note).to_contain_text("4 own runs.")
    before = page.get_by_test_id("statement").inner_text()
    page.get_by_test_id("use-run").nth(1).uncheck()
    expect(note).to_contain_text("4 own runs, 1 of them switched off.")
    at_rest(page)
    assert page.get_by_test_id("statement").inner_text() != before
    assert used(bench) == [True, False, True, True]

    page.get_by_test_id("statement").click()
    page.keyboard.press("Control+z")
    expect(note).to_have_text("4 own runs.")
    at_rest(page)
    assert used(bench) == [True] * 4

    go(page, "explore")
    at_rest(page)
    page.get_by_test_id("page:predict").click()
    page.get_by_test_id("remove-run").nth(3).click()
    expect(note).to_have_text("3 own runs.")
    page.reload()
    expect(note).to_have_text("3 own runs.")
    assert used(bench) == [True] * 3


def test_a_change_by_another_program_is_noticed_and_read(page: Page, bench: Path) -> None:
    note = page.get_by_test_id("runs-note")
    expect(note).to_contain_text("own runs.")
    other = sl.runs(bench).add({"friction_force": 0.6, "intrinsic_friction_force": 1.2, "run": "other"}).save()
    page.get_by_test_id("use-run").nth(0).uncheck()
    expect(note).to_contain_text("another program changed it since it was read")
    assert used(bench) == [True] * len(other.sheet.rows)
    page.get_by_test_id("read-folder").click()
    expect(note).to_have_text(f"{len(other.sheet.rows)} own runs.")
    page.get_by_test_id("use-run").nth(0).uncheck()
    expect(note).to_contain_text("1 of them switched off")
    at_rest(page)
    assert used(bench) == [False] + [True] * (len(other.sheet.rows) - 1)


def test_a_file_of_runs_is_added_to_the_folder_and_another_rig_leaves_it_alone(
    page: Page, bench: Path, tmp_path: Path
) -> None:
    count = len(sl.runs(bench).sheet.rows)
    (tmp_path / "more.csv").write_text("voltage_peak_to_peak [V],sliding_speed [mm/s],friction_ratio\n20,60,0.8\n")
    page.get_by_test_id("runs-file").set_input_files(tmp_path / "more.csv")
    expect(page.get_by_test_id("runs-note")).to_contain_text(f"{count + 1} own runs")
    at_rest(page)
    added = sl.runs(bench).object()["runs"][-1]
    assert added["source"] == "more.csv"
    page.get_by_test_id("rig").select_option("power_map")
    at_rest(page)
    expect(page.get_by_test_id("runs-note")).to_have_text("Type a run, or paste rows of a spreadsheet.")
    page.get_by_test_id("paste-runs").fill("Speed [mm/s]\tfriction_ratio\n20\t0.5")
    expect(page.get_by_test_id("runs-note")).to_have_text("1 own run.")
    assert len(sl.runs(bench).sheet.rows) == count + 1
