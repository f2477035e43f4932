"""Mappings of columns and example files: what each column is, what is asked for, and what is written and kept."""

from pathlib import Path
from typing import Any

from pytest import MonkeyPatch, raises
from tests.names import names_of

from sonolube.errors import InvalidInput
from sonolube.report.blocks import Rows, Table, Verbatim
from sonolube.tasks.identify import decay_length_of_run as decay, rig_of_facts as facts
from sonolube.tasks.lookup import example as examples
from sonolube.tasks.lookup.example import ExampleAnswer, example
from sonolube.tasks.lookup.mapping import mapping

TABLE = "v [mm/s];F;note\n20;1,5;a\n40;2,5;b\n"


def table(tmp_path: Path, text: str = TABLE) -> Path:
    path = tmp_path / "own.csv"
    path.write_text(text, encoding="utf-8")
    return path


STATED = {"v [mm/s]": "sliding_speed mm/s", "F": "friction_force N", "note": "-"}


def test_every_column_has_its_quantity_and_first_cells_or_is_left_out(tmp_path: Path) -> None:
    answer = mapping(table(tmp_path), column=STATED)
    head, found = answer.blocks()
    assert head == "3 columns, 2 rows"
    assert isinstance(found, Table)
    assert list(found.heads) == ["column", "quantity", "unit", "cells", "read as"]
    assert found.rows[0] == ("v [mm/s]", "sliding_speed", "mm/s", "20; 40", "")
    assert found.rows[2] == ("note", "left out", "", "a; b", "")
    assert answer.object()["columns"] == {
        "v [mm/s]": {"quantity": "sliding_speed", "unit": "mm/s"}, "F": {"quantity": "friction_force", "unit": "N"},
        "note": None,
    }  # fmt: skip
    (name,) = answer.files()
    assert name == "own-mapping.toml"
    assert answer.keeps(name, answer.files()[name]) is False
    assert answer.keeps(name, "changed") is True


def test_a_column_that_nobody_states_and_two_of_one_quantity_are_refused_with_the_remedy(tmp_path: Path) -> None:
    path = table(tmp_path)
    without = {name: text for name, text in STATED.items() if name != "F"}
    with raises(InvalidInput, match=r"line 1: column 'F' needs a quantity and its unit; state it by column, such as"):
        mapping(path, column=without)
    twice = STATED | {"note": "friction_force N"}
    with raises(
        InvalidInput, match=r"columns 'F' and 'note' are both friction_force; leave one out by column 'note=-'"
    ):
        mapping(table(tmp_path, TABLE.replace(";a", ";3").replace(";b", ";4")), column=twice)


def test_examples_are_listed_by_kind_and_one_with_the_commands_that_use_it() -> None:
    every = example()
    first, rigs, second, others = every.blocks()
    assert (first, second) == ("Rigs among the example files, by name", "Other example files")
    assert isinstance(rigs, Rows)
    assert isinstance(others, Rows)
    assert "tribometer" in dict(rigs.rows)
    assert not set(dict(rigs.rows)) & set(dict(others.rows))
    assert len(rigs.rows) + len(others.rows) == len(every.examples)
    assert every.files() == {}
    assert set(example("all").files()) >= {each.path for each in every.examples}
    one = example("tribometer")
    title, *commands = one.blocks()
    assert str(title).startswith("tribometer: ")
    swept = "  try: sonolube sweep examples/rigs/tribometer.toml --over drive.voltage_peak_to_peak=2V:28V:27"
    assert Verbatim(swept) in commands
    assert all(isinstance(each, Verbatim) and "examples/rigs/tribometer.toml" in each.text for each in commands)
    assert one.object()["examples"][0]["path"] == "examples/rigs/tribometer.toml"
    (path,) = one.files()
    assert one.keeps(path, one.files()[path]) is False
    assert one.keeps(path, "changed") is True
    assert every.dataset()["path"].sel(example="tribometer").item() == "examples/rigs/tribometer.toml"


def test_a_script_is_run_by_python(monkeypatch: MonkeyPatch) -> None:
    class Script:
        name, path, title, is_script, is_rig, text = "s", "examples/s.py", "S", True, False, ""

        def companions(self) -> tuple[Any, ...]:
            return ()

    script: Any = Script()
    assert examples._commands(script) == ["python examples/s.py"]
    assert ExampleAnswer(examples=(script,), is_written=True).files() == {"examples/s.py": ""}


def test_facts_need_the_rig_that_they_are_of_and_a_modal_mass_its_free_frequency(tmp_path: Path) -> None:
    with raises(InvalidInput, match=r"^facts needs the rig they are of: sonolube identify rig RIG\.toml --facts"):
        facts.rig(facts=tmp_path / "facts.toml")
    with raises(InvalidInput, match=r"^modal_mass needs free_frequency, the natural frequency of that mode with the"):
        decay.decay_length("x.csv", modal_mass="2kg")
    with raises(InvalidInput, match=r"^load has no meaning without modal_mass, which makes shifts contact stiffnesses"):
        decay.decay_length("x.csv", load="3N")


def test_a_rig_of_facts_begins_with_its_findings_as_comments_and_is_written_where_asked(
    monkeypatch: MonkeyPatch,
) -> None:
    monkeypatch.setattr(names_of(facts).results, "parameter_rows", lambda found: [["tip_mass", "50 g", "40 g", "60 g"]])
    monkeypatch.setattr(names_of(facts).results, "fact_lines", lambda found: ["  facts that hold: a"])
    nothing: Any = None
    answer = facts.IdentificationAnswer(identification=nothing, stack=nothing, rig_text="[stack]\n")
    assert answer.file_text() == (
        "#   parameter  estimate  lowest  highest\n"
        "#   tip_mass   50 g      40 g    60 g\n"
        "#   facts that hold: a\n"
        "[stack]\n"
    )
    assert answer.files() == {}
    targeted = facts.IdentificationAnswer(
        identification=nothing, stack=nothing, rig_text="[stack]\n", target=Path("out/my.toml")
    )
    assert targeted.files() == {"my.toml": "[stack]\n"}


def test_a_decision_has_its_advice_where_there_is_one(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(names_of(decay).results, "run_line", lambda table, conditions: "the run")
    monkeypatch.setattr(names_of(decay).results, "rows", lambda found: [("a", "b")])

    class Decision:
        verdict, advice = "it grows", "twice"

    decision, nothing = Decision(), None
    values: Any = {"table": nothing, "conditions": nothing, "decision": decision, "name": "own-decay-length"}
    answer = decay.DecayLengthAnswer(**values)
    assert answer.blocks() == ["it grows", "repeat: twice", "the run", Rows([("a", "b")])]
    decision.advice = ""
    assert answer.blocks() == ["it grows", "the run", Rows([("a", "b")])]
    assert list(answer.figures()) == ["own-decay-length"]
