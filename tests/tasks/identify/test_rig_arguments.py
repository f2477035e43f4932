"""Arguments of `identify rig`: the dissertation's facts by default, those of a file for a rig, and the seed of both."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from pytest import MonkeyPatch, raises
from tests.names import names_of

from sonolube.errors import InvalidInput
from sonolube.report.blocks import Table
from sonolube.tasks.identify import rig_of_facts as module
from sonolube.tasks.identify.rig_of_facts import IdentificationAnswer, rig

NAMES = names_of(module)


@pytest.fixture
def base(monkeypatch: MonkeyPatch, tmp_path: Path) -> Path:
    """A rig's file, with identifications that are words of what they are of."""
    monkeypatch.setattr(module, "read_rig", lambda path: None)
    monkeypatch.setattr(module, "tribometer_identification", lambda *, seed: f"dissertation {seed}")
    monkeypatch.setattr(module, "tribometer_stack", lambda: "its stack")
    monkeypatch.setattr(module, "rig_tables", lambda found, stack: f"tables of {found}, {stack}")
    monkeypatch.setattr(
        module,
        "identify_from_facts",
        lambda path, facts, *, seed: (f"{path.name} by {facts.name} {seed}", "own stack", "own tables"),
    )
    monkeypatch.setattr(module, "with_tables", lambda text, tables: f"{text} + {tables}")
    path = tmp_path / "rig.toml"
    path.write_text("text", encoding="utf-8")
    (tmp_path / "facts.toml").write_text("facts", encoding="utf-8")
    return path


def told(answer: IdentificationAnswer) -> tuple[Any, Any, str]:
    return answer.identification, answer.stack, answer.rig_text


def test_without_facts_those_of_the_dissertation_are_taken_for_a_rig_or_alone(base: Path) -> None:
    tables = "tables of dissertation 3, its stack"
    assert told(rig(seed=3)) == ("dissertation 3", "its stack", tables)
    assert told(rig(base, seed=3)) == ("dissertation 3", "its stack", f"text + {tables}")
    assert told(rig())[0] == "dissertation 0"


def test_facts_of_a_rig_replace_its_tables_and_need_it(base: Path) -> None:
    facts = base.with_name("facts.toml")
    found = told(rig(base, facts=facts, seed=5))
    assert found == ("rig.toml by facts.toml 5", "own stack", "text + own tables")
    with raises(InvalidInput, match=r"^facts needs the rig they are of"):
        rig(facts=facts)


def test_findings_stand_as_comments_before_the_rig(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(NAMES.results, "parameter_rows", lambda found: [("mass", "1 kg", "0.5 kg", "2 kg")])
    monkeypatch.setattr(NAMES.results, "fact_lines", lambda found: ["holds", ""])
    monkeypatch.setattr(NAMES.results, "identification_object", lambda found, stack: {"of": (found, stack)})
    found: Any = "found"
    stack: Any = SimpleNamespace()
    answer = IdentificationAnswer(identification=found, stack=stack, rig_text="[rig]")
    table, *lines = answer.blocks()
    assert isinstance(table, Table)
    assert lines == ["holds", ""]
    *comments, last = answer.file_text().splitlines()
    assert last == "[rig]"
    assert all(line.startswith("#") and line == line.rstrip() for line in comments)
    assert any("holds" in line for line in comments)
    assert answer.object() == {"of": ("found", stack)}
    assert answer.files() == {}
    target = IdentificationAnswer(identification=found, stack=stack, rig_text="[rig]", target=Path("a/my.toml"))
    assert target.files() == {"my.toml": "[rig]"}
