"""Comparison, fit and earlier studies by stand-ins of their results: what is shown, with which caveats and files."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from pytest import MonkeyPatch, approx
from tests.names import names_of
from tests.tasks.running import RigStandIn

from sonolube.report.blocks import Table
from sonolube.tasks.compare import compare, literature
from sonolube.tasks.compare.compare import ComparisonAnswer, FitAnswer
from sonolube.tasks.compare.literature import LiteratureAnswer
from sonolube.tasks.files import NamedBytes
from sonolube.validation.previous_study_map import StudyPoint

RIG: Any = RigStandIn(title="Own rig", assumptions={})
OWN: Any = SimpleNamespace(caveats=("of the rig",))
TABLE: Any = SimpleNamespace(caveats=("of the runs",), title="Own runs", runs=6, conditions=(1, 2), scatter=0.03449)


@pytest.fixture(autouse=True)
def words(monkeypatch: MonkeyPatch) -> None:
    """Let each part of the results be one word."""
    for name in ("fit_blocks", "rig_blocks", "runs_blocks", "parameter_lines", "inapplicable_lines", "error_rows"):
        monkeypatch.setattr(names_of(compare).results, name, lambda *each, name=name: [name])
    for name in ("runs_object", "rig_object", "model_object", "fit_object"):
        monkeypatch.setattr(names_of(compare).results, name, lambda *each, name=name: {name: 1})
    monkeypatch.setattr(names_of(compare).results, "next_line", lambda one, volts: f"next {one} at {volts}")


def comparison(**more: Any) -> ComparisonAnswer:
    fits: Any = (SimpleNamespace(assessment=None),)
    return ComparisonAnswer(**({"fits": fits, "rig": None, "own": None, "predictions": ()} | more))


def test_a_comparison_shows_the_rig_and_the_runs_that_it_has() -> None:
    assert comparison().blocks() == ["fit_blocks"]
    assert comparison(rig=RIG).blocks() == ["fit_blocks"]
    assert comparison(rig=RIG, own=OWN).blocks() == ["fit_blocks", "rig_blocks"]
    assert comparison(table=TABLE).blocks() == ["fit_blocks", "runs_blocks"]
    both = comparison(rig=RIG, own=OWN, table=TABLE)
    assert both.blocks() == ["fit_blocks", "rig_blocks", "runs_blocks"]
    assert (both.object()["rig"], both.object()["runs"]) == ({"rig_object": 1}, {"runs_object": 1})
    bare = comparison().object()
    assert bare["models"] == [{"model_object": 1}]
    assert not {"rig", "runs"} & set(bare)
    assert comparison().caveats() == ()
    assert comparison(own=OWN).caveats() == ("of the rig",)
    assert both.caveats() == ("of the rig", "of the runs")


def test_a_comparison_draws_what_was_assessed_and_predicted(monkeypatch: MonkeyPatch) -> None:
    figure = SimpleNamespace(name="models-measured", chart=None, caption="c")
    monkeypatch.setattr(compare, "comparison_figures", lambda fits: [figure])
    assessed: Any = (SimpleNamespace(assessment=object()), SimpleNamespace(assessment=None))
    ratio, nothing = SimpleNamespace(friction_ratio=0.0), SimpleNamespace(friction_ratio=None)
    rms, without = SimpleNamespace(rms=0.0), SimpleNamespace(rms=None)
    assert comparison().figures() == {}
    assert list(comparison(fits=assessed).figures()) == ["models-measured"]
    assert list(comparison(rig=RIG, predictions=(nothing, ratio)).figures()) == ["models-on-the-rig"]
    assert comparison(rig=RIG, predictions=(nothing,)).figures() == {}
    assert comparison(predictions=(ratio,)).figures() == {}
    assert list(comparison(table=TABLE, of_runs=(without, rms)).figures()) == ["models-on-own-runs"]
    assert comparison(table=TABLE, of_runs=(without,)).figures() == {}
    assert comparison(of_runs=(rms,)).figures() == {}


def fitted(
    *, directions: tuple[float | None, ...] = (None, None), models: tuple[Any, ...] = ("m",), **more: Any
) -> Any:
    conditions = tuple(SimpleNamespace(vibration_direction=each) for each in directions)
    table = SimpleNamespace(**(vars(TABLE) | {"conditions": conditions} | more))
    return SimpleNamespace(table=table, models=models, verdict="not decided", next_conditions=("a",), inapplicable={})


def test_a_fit_has_its_runs_scatter_verdict_and_next_condition_in_words() -> None:
    answer = FitAnswer(fit=fitted(), rig=None, volts_per_amplitude=7.0, name="own-fit")
    head, table, *lines = answer.blocks()
    assert head == "Own runs: 6 runs under 2 conditions, repeats scatter by 0.034; errors of the ratio"
    assert table == Table(("model", "k", "unseen", "fit", "AICc", ""), ["error_rows"])
    assert lines == ["parameter_lines", "  not decided", "next a at 7.0", "inapplicable_lines"]
    bare = FitAnswer(fit=fitted(scatter=None), rig=None, volts_per_amplitude=None, name="own-fit")
    assert bare.blocks()[0] == "Own runs: 6 runs under 2 conditions; errors of the ratio"


def test_a_fit_says_what_direction_it_takes_where_no_run_states_one(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(compare, "runs_fit_dataset", lambda fit: "data")
    taken = "the vibration is taken to be along the normal; vibration_direction [deg] says otherwise"
    answer = FitAnswer(fit=fitted(), rig=None, volts_per_amplitude=None, name="own-fit")
    assert answer.caveats() == ("of the runs", taken)
    stated = FitAnswer(fit=fitted(directions=(None, 0.5)), rig=None, volts_per_amplitude=None, name="n")
    assert stated.caveats() == ("of the runs",)
    files: Any = answer.files()
    assert (list(answer.figures()), files) == (["own-fit"], {"own-fit.nc": "data"})
    assert "of 6 runs" in answer.figures()["own-fit"].caption
    none = FitAnswer(fit=fitted(models=()), rig=None, volts_per_amplitude=None, name="own-fit")
    assert (none.figures(), none.files()) == ({}, {})


def point(label: str = "own", pressure: float | None = 2e6) -> StudyPoint:
    return StudyPoint(
        label=label, direction="perpendicular", friction_reduction=0.654, sliding_speed=(0.02, 0.04),
        nominal_pressure=pressure,
    )  # fmt: skip


def study(**more: Any) -> LiteratureAnswer:
    return LiteratureAnswer(**({"studies": (), "rig": None, "point": None, "outside": None} | more))


def test_a_rig_among_studies_has_its_reduction_or_why_it_has_none() -> None:
    assert study().blocks() == []
    assert study(point=point()).blocks() == ["own: 20 mm/s, 2 MPa, computed friction reduction 65 %"]
    assert study(point=point(), outside="lost contact").blocks() == ["own: 20 mm/s, 2 MPa, lost contact"]
    found = study(point=point()).object()["rig"]
    assert found["friction_reduction"] == {"value": approx(0.654), "unit": ""}
    assert (found["reason"], found["nominal_pressure"]["value"]) == (None, 2e6)
    outside = study(point=point(), outside="lost contact").object()["rig"]
    assert (outside["friction_reduction"]["value"], outside["reason"]) == (None, "lost contact")
    assert "rig" not in study().object()


def test_points_of_an_own_table_are_listed_and_what_was_left_out_is_a_caveat(monkeypatch: MonkeyPatch) -> None:
    drawn: list[Any] = []
    monkeypatch.setattr(literature, "study_chart", lambda own, *, others: drawn.append((own, others)))
    answer = study(others=(point("x"),), skipped=("row 3: no speed",), point=point())
    assert answer.object()["table"][0]["label"] == "x"
    assert answer.blocks()[0].startswith("x, own table: friction reduction 65 %")  # type: ignore[union-attr]
    assert answer.caveats() == ("row 3: no speed",)
    chart = answer.figures()["map-of-studies"].chart
    assert chart is not None
    chart()
    outside = study(point=point(), outside="lost").figures()["map-of-studies"].chart
    assert outside is not None
    outside()
    assert drawn == [(point(), (point("x"),)), (None, ())]
    assert list(answer.files()) == ["studies.csv"]


def test_a_table_of_studies_is_called_by_its_name_or_path_and_a_rig_is_placed_among_them(
    monkeypatch: MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(literature, "runs_of", lambda table, mapping: None if table is None else (table, mapping))
    monkeypatch.setattr(literature, "studies_of_runs", lambda runs, *, title: ((point(title),), (f"of {title}",)))
    monkeypatch.setattr(literature, "optional_rig", lambda rig: rig)
    monkeypatch.setattr(names_of(literature).results, "point_of_rig", lambda rig: (point(rig.title), "outside"))
    plain = literature.literature()
    assert (plain.rig, plain.point, plain.outside, plain.others, plain.skipped) == (None, None, None, (), ())
    assert plain.studies
    by_bytes = literature.literature(table=NamedBytes("mine.csv", b""))
    assert [each.label for each in by_bytes.others] == ["mine.csv"]
    assert by_bytes.skipped == ("of mine.csv",)
    by_path = literature.literature(RIG, table=tmp_path / "mine.csv")
    assert [each.label for each in by_path.others] == [str(tmp_path / "mine.csv")]
    assert by_path.point is not None
    assert (by_path.rig, by_path.point.label, by_path.outside) == (RIG, "Own rig", "outside")
