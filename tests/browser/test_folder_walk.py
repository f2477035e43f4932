"""One walk through the folder of a rig by terminal, Python and browser, whose numbers agree.

An export is dropped, the interval narrows, tests are planned, one is run on the virtual rig and another stopped, each
with its verdict, and the prediction follows.
"""

import json
from collections.abc import Iterator
from pathlib import Path
from shutil import copy
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect
from pytest import approx
from tests.browser.pages import at_rest, opened
from tests.browser.recordings import write_recordings
from tests.browser.test_lab_page import LONG, SHORT, begin
from tests.browser.workbench import served
from tests.chromium import CHROMIUM
from tests.same import same

import sonolube as sl
from sonolube.cli import main
from sonolube.laboratory import RunControl
from sonolube.tasks.measure.own_runs import OwnRunsAnswer

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium"),
]

EXAMPLES = Path(__file__).parents[2] / "examples"
SETTINGS = {"speed": "20.3 mm/s", "load": "3 N"}
VERDICTS = "measured off", "confirmed off", "cut the power"
AGREEMENT = 1e-9


def bench(folder: Path) -> Path:
    """Folder of a rig without runs."""
    (place := folder / "bench").mkdir(parents=True)
    copy(EXAMPLES / "rigs" / "tribometer.toml", place / "rig.toml")
    (place / "runs.csv").write_text("run,sliding_speed [mm/s],normal_load [N],friction_force [N]\n")
    return place


def interval(content: dict[str, Any]) -> list[float]:
    """Interval of 80 % of the friction reduction, of the JSON of a prediction."""
    return list(content["friction_reduction"]["interval_80"])


def numbers(table: OwnRunsAnswer) -> list[dict[str, float]]:
    """Quantities of the runs of a table, in SI."""
    return [
        {name: cell["value"] for name, cell in run.items() if isinstance(cell, dict)} for run in table.object()["runs"]
    ]


def agree(one: OwnRunsAnswer, other: OwnRunsAnswer) -> None:
    """Hold two tables of runs to each other."""
    assert len(numbers(one)) == len(numbers(other))
    for mine, theirs in zip(numbers(one), numbers(other), strict=True):
        assert mine == approx(theirs, rel=AGREEMENT)


@pytest.fixture
def on_terminal(capsys: pytest.CaptureFixture[str]) -> Any:
    """Run of the program in this process, with the object that it prints."""

    def run(*words: object) -> dict[str, Any]:
        capsys.readouterr()
        with pytest.raises(SystemExit) as end:
            main([*map(str, words), "--json"])
        captured = capsys.readouterr()
        assert (end.value.code or 0) == 0, captured.err
        found: dict[str, Any] = json.loads(captured.out)
        return found

    return run


def test_terminal_and_python_go_the_same_way(tmp_path: Path, on_terminal: Any) -> None:
    typed, called = bench(tmp_path / "typed"), bench(tmp_path / "called")
    export, _ = write_recordings(tmp_path)
    protocol = tmp_path / "short.toml"
    protocol.write_text(SHORT)

    alone = interval(on_terminal("predict", typed))
    on_terminal("runs", typed, "--add", export, "--speed", "20.3mm/s", "--load", "3N")
    sl.runs(called).add(export, **SETTINGS).save()
    agree(sl.runs(typed), sl.runs(called))
    narrowed = interval(on_terminal("predict", typed))
    assert narrowed[1] - narrowed[0] < alone[1] - alone[0]
    assert interval(sl.predict(called).json_object()) == approx(narrowed, rel=AGREEMENT)

    plan = on_terminal("plan", typed, "--points", "1")
    same(plan["points"], sl.plan(called, points=1).json_object()["points"], relative=AGREEMENT)
    assert list((typed / "answers" / "bench-plan").glob("*.toml"))
    assert (typed / "answers" / "bench-plan.html").is_file()

    run = on_terminal("lab", "run", protocol, "--rig", typed, "--seed", "3")
    assert run["outcome"] == "completed"
    assert any(each in run["outputs"] for each in VERDICTS)
    done = sl.lab.run(protocol, rig=called, seed=3)
    records = [next((place / "records").glob("2*")) for place in (typed, called)]
    assert done.object()["folder"] == str(records[1])
    control = RunControl()
    stopped = sl.lab.run(
        protocol,
        rig=called,
        control=control,
        progress=lambda _, done, of: control.stop("seen enough") if done == of - 1 else None,
    )
    assert stopped.object()["outcome"] == "stopped"
    assert any(each in stopped.object()["outputs"] for each in VERDICTS)

    on_terminal("runs", typed, "--add", records[0])
    sl.runs(called).add(records[1]).save()
    agree(sl.runs(typed), sl.runs(called))
    updated = interval(on_terminal("predict", typed))
    assert updated != approx(narrowed, rel=1e-3)
    assert interval(sl.predict(called).json_object()) == approx(updated, rel=AGREEMENT)
    report = typed / "answers" / "friction.html"
    on_terminal("measure", "friction", export, "--report", report)
    assert "<html" in report.read_text(encoding="utf-8")


@pytest.fixture
def place(tmp_path: Path) -> Path:
    return bench(tmp_path)


@pytest.fixture
def page(browser: Browser, tmp_path: Path, place: Path) -> Iterator[Page]:
    (tmp_path / "state").mkdir()
    with served(tmp_path / "state", str(place)) as workbench, opened(browser, workbench) as found:
        yield found


def predicted(page: Page, place: Path) -> list[float]:
    """Interval that the page has from the server, held to that of Python for the folder."""
    found: dict[str, Any] = page.evaluate(
        """() => fetch('api/tasks/predict', {method: 'POST', headers: {'content-type': 'application/json'},
             body: JSON.stringify({rig: {name: 'bench', changes: {}}})}).then((reply) => reply.json())"""
    )
    here = interval(found["answer"])
    assert here == approx(interval(sl.predict(place).json_object()), rel=AGREEMENT)
    return here


def test_the_browser_goes_the_same_way(page: Page, place: Path, tmp_path: Path) -> None:
    export, _ = write_recordings(tmp_path)
    for name, text in (("short", SHORT), ("long", LONG)):
        (tmp_path / f"{name}.toml").write_text(text)
    alone = predicted(page, place)
    page.get_by_test_id("page:data").click()
    page.get_by_test_id("data-files").set_input_files(export)
    expect(page.get_by_test_id("measured")).to_contain_text("Reduction")
    for name, text in (("sliding_speed", "20.3 mm/s"), ("normal_load", "3 N")):
        page.get_by_test_id(f"set:{name}").fill(text)
        page.get_by_test_id(f"set:{name}").press("Tab")
        at_rest(page)
    page.get_by_test_id("add-to-runs").click()
    expect(page.get_by_test_id("use-note")).to_contain_text("2 added: 2 own runs.")
    agree(sl.runs(place), sl.runs().add(export, **SETTINGS))
    narrowed = predicted(page, place)
    assert narrowed[1] - narrowed[0] < alone[1] - alone[0]

    page.get_by_test_id("page:lab").click()
    at_rest(page)
    begin(page, tmp_path / "short.toml")
    page.get_by_test_id("confirm").click()
    expect(page.get_by_test_id("run-state")).to_have_text("✓ completed")
    (record,) = (place / "records").glob("2*")
    page.get_by_test_id("tick").first.check()
    page.get_by_test_id("compare").click()
    page.get_by_test_id("predict-runs").click()
    expect(page.get_by_test_id("page:predict")).to_have_attribute("aria-current", "page")
    at_rest(page)
    agree(sl.runs(place), sl.runs().add(export, **SETTINGS).add(record))
    assert predicted(page, place) != approx(narrowed, rel=1e-3)

    page.get_by_test_id("page:lab").click()
    begin(page, tmp_path / "long.toml")
    page.get_by_test_id("confirm").click()
    expect(page.get_by_test_id("run-step")).to_contain_text("step")
    page.get_by_test_id("stop").click()
    expect(page.get_by_test_id("run-state")).to_contain_text("stopped")
    last = max((place / "records").glob("2*"))
    assert any(each in sl.lab.show(last).text() for each in VERDICTS)
