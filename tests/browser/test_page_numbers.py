"""Numbers on screen against the command's JSON, for rigs and drawn changes; and of what is taken away."""

import csv
import io
import json
import math
import random
import re
import shlex
from collections.abc import Iterator
from html.parser import HTMLParser
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from nbclient import NotebookClient
from playwright.sync_api import Page, expect
from tests.browser.pages import RIGS, SPEED, VOLTS, enter, numbers, saved, show
from tests.browser.workbench import Served
from tests.chromium import CHROMIUM
from tests.same import same_text

import sonolube as sl
from sonolube.browser.requests import Places
from sonolube.browser.rig_view import rig_view
from sonolube.charts import chart_tables
from sonolube.cli import main
from sonolube.figure import render_figure
from sonolube.rig import read_rig
from sonolube.text.units import to_si
from sonolube.vocabulary import quantity

PREDICTED = (
    *("tribometer", "tribometer_uncertain", "power_map", "coated_plate", "coated_temperature", "collar"),
    *("flextensional", "poisson_al_steel", "welder_flat", "welder_round"),
)
NOTEBOOK: Any = import_module("nbformat")  # which has no types
CHANGED, DRAWN, TOGETHER = "tribometer", 20, 4
_NAME_OF_PART = re.compile(r"\b[a-z][0-9a-f]{10}\b")  # by the digest of its numbers

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium"),
]


class Command:
    """The command `predict` with `--json`, run in this process."""

    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self._capsys = capsys

    def __call__(self, rig: Path, *changes: str) -> tuple[dict[str, Any], str]:
        """Object that it writes, and what it says where it refuses."""
        self._capsys.readouterr()
        with pytest.raises(SystemExit) as end:
            main(["predict", str(rig), *(word for change in changes for word in ("--set", change)), "--json"])
        out, err = self._capsys.readouterr()
        return (json.loads(out), "") if end.value.code in (0, None) else ({}, err)


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Command:
    return Command(capsys)


def agrees(shown: str, value: float, unit: str) -> bool:
    """Whether a text is a value in SI, to the two digits or the whole percent that are shown."""
    number = to_si(shown.replace(" %", "e-2"), unit=unit, name="shown")
    if "%" in shown:
        return abs(number - value) <= 0.5001e-2
    last = 10.0 ** (math.floor(math.log10(abs(value))) - 1) if value else 0.0
    return abs(number - value) <= 0.5001 * last


def expect_numbers(rows: list[list[str]], content: dict[str, Any]) -> None:
    """Compare numbers on screen with the object of the command: all of it that the screen has."""
    known = {quantity(name).meaning: each for name, each in content.items() if _is_predicted(each)}
    predicted = {label: (median, interval) for label, median, interval in rows[: len(known)]}
    assert set(predicted) == set(known)
    for label, (median, interval) in predicted.items():
        each = known[label]
        assert agrees(median, each["median"], each["unit"]), (label, median, each)
        for text, end in zip(interval.split(" to "), each["interval_80"], strict=True):
            assert agrees(text, end, each["unit"]), (label, interval, each)
    point = [[one["label"], *re.split(" (?=within )", one["text"])] for one in content["operating_point"]]
    assert rows[len(known) :] == point


def _is_predicted(value: Any) -> bool:
    return isinstance(value, dict) and "interval_80" in value


@pytest.mark.parametrize("name", PREDICTED)
def test_numbers_of_a_rig_are_those_of_the_command(name: str, shown: Page, workbench: Served, command: Command) -> None:
    content, _ = command(RIGS / f"{name}.toml")
    show(shown, workbench, name, {})
    expect_numbers(numbers(shown), content)
    expect(shown.get_by_test_id("statement")).to_contain_text(content["statement"][0].split(". ")[0])


def test_numbers_of_drawn_changes_are_those_of_the_command(shown: Page, workbench: Served, command: Command) -> None:
    fields = rig_view({"rig": {"name": CHANGED}}, Places(rigs={}))["fields"]
    numeric = [field for field in fields if field["lowest"] is not None]
    draw = random.Random(1)
    compared = 0
    changes: dict[str, str] = {}
    show(shown, workbench, CHANGED, {})
    while compared < DRAWN:
        field = draw.choice(numeric)
        value = field["lowest"] * (field["highest"] / field["lowest"]) ** draw.random()
        text = f"{value:.3g} {field['unit']}".strip()
        changes[field["key"]] = text
        content, refusal = command(RIGS / f"{CHANGED}.toml", *(f"{key}={text}" for key, text in changes.items()))
        enter(shown, field["key"], text)
        if content:
            expect_numbers(numbers(shown), content)
            compared += 1
        else:
            reason = shown.get_by_test_id(f"refusal:{field['key']}").or_(shown.get_by_test_id("refused")).first
            expect(reason).to_be_visible()
            assert refusal
        if refusal or len(changes) == TOGETHER:
            shown.get_by_test_id("reset-all").click()
            changes.clear()


@pytest.fixture
def changed(shown: Page, workbench: Served) -> Iterator[Page]:
    """Page with two changes, which is to be taken away."""
    show(shown, workbench, "tribometer", {VOLTS: "21 V", SPEED: "30 mm/s"})
    shown.get_by_test_id("take").click()
    yield shown
    shown.get_by_test_id("statement").click()  # which closes the menu


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Folder with the rig's file, in which what was taken away is run."""
    (tmp_path / "tribometer.toml").write_bytes((RIGS / "tribometer.toml").read_bytes())
    monkeypatch.chdir(tmp_path)
    return tmp_path


def copied(page: Page, form: str, beginning: str) -> str:
    """Text that is taken away by copying."""
    page.get_by_test_id(f"take:{form}").click()
    text = page.get_by_test_id("taken")
    expect(text).to_have_value(re.compile(f"^{beginning}"))
    return text.input_value()


def task() -> Any:
    """The answer on screen, by the task."""
    return sl.predict(read_rig(RIGS / "tribometer.toml", changes=[f"{VOLTS}=21 V", f"{SPEED}=30 mm/s"]))


def test_the_command_taken_away_gives_the_numbers(changed: Page, folder: Path, command: Command) -> None:
    words = shlex.split(copied(changed, "command", "sonolube"), comments=True)
    assert words[:3] == ["sonolube", "predict", "tribometer.toml"]
    content, _ = command(folder / words[2], *words[4::2])
    assert set(words[3::2]) == {"--set"}
    expect_numbers(numbers(changed), content)


def test_the_program_taken_away_gives_the_numbers(changed: Page, folder: Path) -> None:
    scope: dict[str, Any] = {}
    exec(compile(copied(changed, "python", "# Made by sonolube"), "answer.py", "exec"), scope)
    expect_numbers(numbers(changed), json.loads(scope["answer"].to_json()))


def test_the_rig_taken_away_gives_the_numbers(changed: Page, folder: Path, command: Command) -> None:
    text = saved(changed, "toml")
    assert [line for line in text.splitlines() if line.startswith("#")]  # comments are kept
    (folder / "tribometer.toml").write_text(text, encoding="utf-8")
    expect_numbers(numbers(changed), command(folder / "tribometer.toml")[0])


def test_the_notebook_taken_away_gives_the_numbers(changed: Page, folder: Path) -> None:
    notebook = NOTEBOOK.reads(saved(changed, "notebook"), as_version=4)
    NOTEBOOK.validate(notebook)
    notebook.cells.append(NOTEBOOK.v4.new_code_cell("print(answer.to_json())"))
    NotebookClient(notebook, timeout=None, kernel_name="python3", resources={"metadata": {"path": folder}}).execute()
    printed = "".join(each.text for each in notebook.cells[-1].outputs if each.output_type == "stream")
    expect_numbers(numbers(changed), json.loads(printed[printed.index("{") :]))
    assert any("image/png" in each.get("data", {}) for cell in notebook.cells for each in cell.get("outputs", []))


def test_the_table_taken_away_has_the_numbers_of_the_figure(changed: Page, folder: Path) -> None:
    predicted = numbers(changed)[: -len(task().object()["operating_point"])]
    text = saved(changed, "csv")
    (drawing,) = task().figures().values()
    tables = chart_tables(drawing.chart())
    expected = [line for each in tables for line in ([each["title"]], each["heads"], *each["rows"], [])]
    rows = list(csv.reader(io.StringIO(text)))
    assert rows[-len(expected) :] == expected
    quantities = {row[0]: row[1] for row in rows[: -len(expected)] if len(row) > 1}
    assert {label: quantities.get(label) for label, *_ in predicted} == {
        label: median for label, median, _ in predicted
    }
    changed.keyboard.press("Escape")
    changed.locator("[data-test^='numbers:'] summary").first.click()
    cells = changed.locator("[data-test^='numbers:'] tbody tr").first.locator("td")
    expect(cells).to_have_text(expected[2])


def test_the_figure_taken_away_is_that_of_the_task(changed: Page, folder: Path) -> None:
    (drawing,) = task().figures().values()
    text, about = re.subn(r"\n <desc>[^<]*</desc>", "", saved(changed, "svg"))
    assert about == 1
    here = render_figure(drawing.figure(), "svg").decode()
    same_text(*(_NAME_OF_PART.sub("part", each) for each in (text, here)), relative=1e-4)  # six decimals of a point


class _Texts(HTMLParser):
    """Texts of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_data(self, data: str) -> None:
        self.found.append(" ".join(data.split()))


def test_the_report_taken_away_has_the_numbers(changed: Page, folder: Path) -> None:
    texts = _Texts()
    texts.feed(saved(changed, "report"))
    found = [text for text in texts.found if text]
    for label, value, *_ in numbers(changed):
        assert found[found.index(label) + 1].replace("µ", "u").startswith(value), label
