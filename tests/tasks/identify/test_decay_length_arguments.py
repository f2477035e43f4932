"""Arguments of `identify decay-length` in SI, recordings and tables apart, and what its answer passes on."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from pytest import MonkeyPatch, approx, raises
from tests.names import names_of

from sonolube.errors import InvalidInput
from sonolube.tasks.identify import decay_length_of_run as module
from sonolube.tasks.identify.decay_length_of_run import DecayLengthAnswer, decay_length

NAMES = names_of(module)
Asked = dict[str, Any]


@pytest.fixture
def asked(monkeypatch: MonkeyPatch) -> Asked:
    """What the analysis was called with, of files that are none of a table."""
    seen: Asked = {}

    def seeing(name: str, result: Any = None) -> Callable[..., Any]:
        def call(*given: Any, **named: Any) -> Any:
            seen[name] = (given, named)
            return name if result is None else result

        return call

    for name in ("switched_recording", "read_recording", "read_runs"):
        monkeypatch.setattr(module, name, seeing(name))
    monkeypatch.setattr(module, "is_switch_table", lambda path, mapping: path.suffix == ".table")
    for name in ("switch_table", "recorded_switches", "decide_decay_length"):
        monkeypatch.setattr(NAMES.identification, name, seeing(name))
    return seen


def test_conditions_of_a_run_are_in_si_with_those_of_the_command_by_default(asked: Asked, tmp_path: Path) -> None:
    (tmp_path / "run.table").touch()
    answer = decay_length(tmp_path / "run.table")
    known = answer.conditions
    assert (known.normal_load, known.vibration_amplitude, known.frequency) == approx((5.0, 2.3e-6, 22e3))
    assert known.sliding_speed == approx(0.065)
    assert (known.large_drive_amplitude, known.natural_frequency, known.modal_mass) == (None, None, None)
    assert asked["decide_decay_length"] == (("switch_table", known), {"seed": 0})
    assert asked["switch_table"] == (("read_runs",), {})
    assert answer.name == "run-decay-length"
    own = decay_length(
        tmp_path / "run.table",
        vibration="1um",
        frequency="20kHz",
        sliding_speed="10mm/s",
        load="2N",
        free_frequency="40Hz",
        modal_mass="600g",
        large_amplitude="3um",
        seed=7,
    ).conditions
    assert (own.vibration_amplitude, own.frequency, own.sliding_speed) == approx((1e-6, 20e3, 0.01))
    assert (own.normal_load, own.natural_frequency, own.modal_mass) == approx((2.0, 40.0, 0.6))
    assert own.large_drive_amplitude == approx(3e-6)
    assert asked["decide_decay_length"][1] == {"seed": 7}


def test_a_folder_is_a_run_and_a_file_without_switches_a_recording(asked: Asked, tmp_path: Path) -> None:
    found: Any = decay_length(tmp_path, sliding_speed="10mm/s", rotation_speed="2 1/s")
    assert asked["switched_recording"][0] == (tmp_path,)
    assert "read_recording" not in asked
    given, named = asked["recorded_switches"]
    assert given == ("switched_recording",)
    assert (named["sliding_speed"], named["rotation_speed"]) == approx((0.01, 2.0))
    assert found.table == "recorded_switches"
    (tmp_path / "run.csv").touch()
    decay_length(tmp_path / "run.csv")
    assert asked["read_recording"][0] == (tmp_path / "run.csv",)
    assert asked["recorded_switches"][1]["rotation_speed"] is None


def test_what_has_no_use_is_refused(asked: Asked, tmp_path: Path) -> None:
    (tmp_path / "run.table").touch()
    with raises(
        InvalidInput, match=r"^load has no meaning without modal_mass, which makes shifts contact stiffnesses$"
    ):
        decay_length(tmp_path / "run.table", load="2N")
    with raises(InvalidInput, match=r"^modal_mass needs free_frequency, the natural frequency of that mode with"):
        decay_length(tmp_path / "run.table", modal_mass="1kg")
    with raises(InvalidInput, match=r"^rotation_speed has no meaning for a table of switches; it is for recordings$"):
        decay_length(tmp_path / "run.table", rotation_speed="2 1/s")


def test_the_verdict_comes_before_the_advice_the_run_and_the_probabilities(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(NAMES.results, "run_line", lambda table, conditions: f"{table} at {conditions}")
    monkeypatch.setattr(NAMES.results, "rows", lambda found: [("sliding", found.verdict)])
    monkeypatch.setattr(NAMES.results, "decision_object", lambda found, table: {"of": (found.verdict, table)})
    monkeypatch.setattr(NAMES.results, "decision_caveats", lambda *given: given)
    monkeypatch.setattr(NAMES.identification, "decision_chart", lambda *given: given)
    monkeypatch.setattr(NAMES.identification, "decision_dataset", lambda *given: given)
    found: Any = SimpleNamespace(verdict="it slid", advice="")
    table: Any = "table"
    conditions: Any = "5 N"
    answer = DecayLengthAnswer(table=table, conditions=conditions, decision=found, name="run-decay-length")
    verdict, run, rows = answer.blocks()
    assert (verdict, run) == ("it slid", "table at 5 N")
    assert getattr(rows, "rows", rows) is not None
    found.advice = "slide further"
    assert answer.blocks()[1] == "repeat: slide further"
    assert answer.object() == {"of": ("it slid", "table")}
    assert answer.caveats() == ("table", "5 N", found)
    (drawing,) = answer.figures().values()
    assert drawing.chart is not None
    assert drawing.chart() == ("table", found)  # type: ignore[comparison-overlap]
    assert answer.files() == {"run-decay-length.nc": ("table", found)}
