"""Answers for pages: the numbers of the task, refusals with their keys, and no file of this computer but by upload."""

import base64
import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, strategies as st
from tests.same import same
from tests.tiers import examples

import sonolube as sl
from sonolube.browser.answers import answered, offered_tasks
from sonolube.browser.requests import KINDS, Places
from sonolube.browser.rig_view import rig_view
from sonolube.browser.take_away import changed_text
from sonolube.browser.worker import reply
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.facts.materials import material_classes
from sonolube.rig import read_rig
from sonolube.tasks.table import task_named

EXAMPLES = Path(__file__).parents[2] / "examples"
TRIBOMETER = EXAMPLES / "rigs" / "tribometer.toml"
NOWHERE = Places(rigs={})
CHANGES = {"drive.voltage_peak_to_peak": "21 V", "sliding.sliding_speed": "1 in/s"}


def rig(**more: Any) -> dict[str, Any]:
    return {"name": "tribometer", "changes": CHANGES} | more


@pytest.mark.parametrize("task", ["friction", "wear", "contact", "simulate", "predict"])
def test_the_numbers_are_those_of_the_task(task: str) -> None:
    own = read_rig(TRIBOMETER, changes=[f"{key}={value}" for key, value in CHANGES.items()])
    found = answered(task_named(task), {"rig": rig()}, NOWHERE)
    same(found["answer"], getattr(sl, task)(own).json_object())
    assert found["caveats"] == list(getattr(sl, task)(own).caveats())


def test_a_rig_by_its_text_is_the_same_rig() -> None:
    by_name = answered(task_named("friction"), {"rig": rig()}, NOWHERE)
    by_text = answered(task_named("friction"), {"rig": rig(text=TRIBOMETER.read_text(encoding="utf-8"))}, NOWHERE)
    same(by_text["answer"], by_name["answer"])


def test_the_rig_that_was_opened_stands_before_the_examples(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(TRIBOMETER.read_text(encoding="utf-8").replace('"3 N"', '"4 N"', 1), encoding="utf-8")
    view = rig_view({"rig": {"name": "mine"}}, Places(rigs={"mine": str(path)}))
    assert view["rigs"][0] == "mine"
    assert {field["key"]: field["text"] for field in view["fields"]}["contact.normal_load"] == "4 N"


def test_charts_come_with_their_tables() -> None:
    (chart,) = answered(task_named("predict"), {"rig": rig(), "draws": 200}, NOWHERE)["charts"]
    assert [panel["x"]["text"] for panel in chart["chart"]["panels"]] == [
        "Vibration amplitude [µm]",
        "Sliding speed [mm/s]",
    ]
    assert chart["tables"][0]["heads"][0] == "Vibration amplitude [µm]"


def test_a_moving_slider_may_leave_out_the_tables() -> None:
    asked = {"task": "predict", "arguments": {"rig": rig(), "draws": 200}}
    (whole, less) = (KINDS["task"](asked | more, NOWHERE) for more in ({}, {"tables": False}))
    (chart,) = whole["charts"]
    same(less, whole | {"charts": [{name: value for name, value in chart.items() if name != "tables"}]})


@pytest.mark.parametrize(
    ("changes", "key", "words"),
    [
        ({"drive.voltage_peak_to_peak": "3 kg"}, "drive.voltage_peak_to_peak", "is a mass; expected a voltage"),
        ({"contact.normal_load": "5 kg"}, "contact.normal_load", "is a mass"),
        ({"contact.normal_load": "1e999 N"}, "contact.normal_load", "1e999"),
        ({"contact.normal_load": ""}, "contact.normal_load", ""),
        ({"contact.normal_load": "NaN N"}, "contact.normal_load", ""),
        ({"contact.normal_load": "-1 N"}, "contact.normal_load", "-1"),
        ({"no.such": "1 N"}, "no", ""),
    ],
)
def test_a_refusal_names_its_field_and_no_folder(changes: dict[str, str], key: str, words: str) -> None:
    status, body = reply(
        "task", {"task": "friction", "arguments": {"rig": {"name": "tribometer", "changes": changes}}}, NOWHERE
    )
    assert status == 422
    (fault,) = json.loads(body)["faults"]
    assert key in (fault["key"] or fault["text"])
    assert words in fault["text"]
    assert "/" not in fault["text"].replace("in/s", "").replace("mm/s", "")


ODD = ["-0", "1e999 V", "\u202e28 V", "<img onerror=x>", "9" * 10_000, "../../x"]


@given(text=st.one_of(st.text(max_size=40), st.sampled_from(ODD)))
@examples(60)
def test_whatever_is_typed_is_answered_or_refused_in_one_line(text: str) -> None:
    changes = {"drive.voltage_peak_to_peak": text}
    status, body = reply("rig", {"rig": {"name": "tribometer", "changes": changes}}, NOWHERE)
    content = json.loads(body)
    assert status in (200, 422)
    assert status == 200 or all("\n" not in fault["text"] for fault in content["faults"])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"runs": str(EXAMPLES / "tribometer-runs.csv")}, "give an object"),
        ({"runs": {"name": "runs.csv", "upload": "../../etc/passwd"}}, "no longer here"),
        ({"runs": {"name": "runs.csv", "content": "!!"}}, "not base64"),
        ({"pin": "/etc/passwd"}, "is a file of this computer"),
        ({"laboratory": {"a.toml": "b.csv"}}, "not offered"),
        ({"nonsense": 1}, "no such argument"),
    ],
)
def test_files_of_this_computer_are_not_read(arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(InvalidInput, match=words):
        answered(task_named("predict"), {"rig": rig()} | arguments, NOWHERE)


@pytest.mark.parametrize("file", ["/etc/passwd", "../../modes.csv", "modes.csv"])
def test_a_rig_names_no_file_of_this_computer(file: str) -> None:
    text = TRIBOMETER.read_text(encoding="utf-8").replace(
        "[structure]", f'[structure]\nkind = "modes"\nfile = "{file}"'
    )
    for source in ({"name": "own", "text": text}, {"name": "tribometer", "changes": {"structure.file": file}}):
        with pytest.raises(InvalidInput, match=r"structure\.file: a page reads no file"):
            answered(task_named("friction"), {"rig": source}, NOWHERE)
        with pytest.raises(InvalidInput, match=r"structure\.file: a page reads no file"):
            rig_view({"rig": source}, NOWHERE)


def test_a_rig_without_name_or_text_and_a_call_without_a_rig_are_refused() -> None:
    cases: tuple[dict[str, Any], ...] = ({}, {"rig": "tribometer"}, {"rig": {}}, {"rig": {"name": "../secret"}})
    for arguments in cases:
        with pytest.raises(SonolubeError):
            answered(task_named("friction"), arguments, NOWHERE)


def test_uploaded_runs_and_content_in_the_request_are_the_same(tmp_path: Path) -> None:
    runs = (EXAMPLES / "tribometer-runs.csv").read_bytes()
    (tmp_path / "abc").write_bytes(runs)
    by_upload = {"runs": {"name": "own.csv", "upload": "abc"}}
    by_content = {"runs": {"name": "own.csv", "content": base64.b64encode(runs).decode()}}
    found = [
        answered(task_named("predict"), {"rig": rig(), "draws": 400} | given, Places(rigs={}, uploads=str(tmp_path)))
        for given in (by_upload, by_content)
    ]
    same(found[0]["answer"], found[1]["answer"])
    assert found[0]["answer"]["runs"] == 4


def test_materials_are_chosen_by_the_titles_of_their_task() -> None:
    titles = KINDS["materials"]({}, NOWHERE)
    known = {name: each["title"] for name, each in sl.materials().json_object().items()}
    classes = {name: title for name, title in titles.items() if name in material_classes()}
    assert {name: classes.get(name, title) for name, title in known.items()} == titles
    assert classes["brass"] == "Brass, any"
    assert all(title.endswith(", any") for title in classes.values())


def test_no_task_that_opens_a_device_is_offered() -> None:
    names = {task.name for task in offered_tasks()}
    assert {"predict", "sweep", "map", "measure friction", "materials"} <= names
    assert not {"lab run", "lab hold", "lab check"} & names
    paths = KINDS["description"]({}, NOWHERE)["paths"]
    assert {path.removeprefix("/api/tasks/").replace("/", " ") for path in paths} == names


def test_comments_of_a_rig_file_are_kept_where_entries_are_replaced() -> None:
    text = '# my rig\n[drive] # of the stack\nfrequency = "22 kHz" # tuned\n'
    changed = changed_text(text, {"drive.frequency": "23 kHz", "contact.normal_load": "4 N"})
    assert "# my rig" in changed
    assert 'frequency = "23 kHz" # tuned' in changed
    assert 'normal_load = "4 N"' in changed
