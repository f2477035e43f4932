"""Measurement reports by hand-made sheets: JSON of values and tables, items of ASTM G99, quotients, refusals."""

from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from matplotlib.figure import Figure as Drawn
from pytest import approx, mark, raises

from sonolube import __version__
from sonolube.errors import InvalidInput
from sonolube.report.measured.sheet import Column, Figure, Sheet, Table, Value
from sonolube.report.measurement import (
    MeasurementReport,
    PinOnDiscSheet,
    measurement_caveats,
    measurement_object,
    measurement_page,
    pin_on_disc_checklist,
    pin_on_disc_rows,
    read_pin_on_disc_sheet,
)
from sonolube.report.page import Drawing

NAN = float("nan")


def picture() -> Drawn:
    return Drawn()


FRICTION = Sheet(
    title="trace.csv",
    source=MappingProxyType({"file": "trace.csv"}),
    values=(
        Value("friction_force", "Friction", 1.5, "N", uncertainty=0.3),
        Value("steady_friction_force", "Steady friction", 1.2, "N"),
        Value("rms_height", "Sq", 1e-6, "m"),
        Value("friction_reduction", "Reduction", NAN, "", uncertainty=np.inf, interval=(0.1, NAN)),
    ),
    tables=(
        Table("steps", "Steps", (Column("time", "Time", "s"), Column("word", "Word")), ((1.0, "on"), (NAN, "off"))),
    ),
    figures=(Figure(title="Force", drawing=Drawing(draw=picture)), Figure(title="More", drawing=Drawing(draw=picture))),
    caveats=("drifts",),
    not_found=("stick-slip: none",),
)  # fmt: skip
GROOVE = Sheet(
    title="groove.npy",
    values=(Value("ring_volume", "Volume", 6e-11, "m3", uncertainty=3e-12),
            Value("groove_depth", "Depth", 1e-6, "m")),
    figures=(Figure(title="Map", drawing=Drawing(draw=picture)),),
    rig_entries=MappingProxyType({"contact.normal_load": "3 N"}),
    caveats=("tilted",),
)  # fmt: skip


def report(*sheets: Sheet, test: PinOnDiscSheet | None = None) -> MeasurementReport:
    return MeasurementReport(
        title="friction", settings=MappingProxyType({"level": "95 %"}), sheets=sheets,
        refused=MappingProxyType({"bad.csv": "is empty"}), test=test,
    )  # fmt: skip


def conditions(**parameters: str) -> PinOnDiscSheet:
    return PinOnDiscSheet(entries={"parameters": parameters, "pin": {"material": "steel"}, "test": {"operator": "Ann"}})


def test_a_report_in_json_has_null_for_numbers_that_json_lacks() -> None:
    found = measurement_object(report(FRICTION, GROOVE))
    assert (found["measured"], found["version"], found["settings"]) == ("friction", __version__, {"level": "95 %"})
    assert found["refused"] == [{"file": "bad.csv", "reason": "is empty"}]
    assert "test_sheet" not in found
    friction, groove = found["results"]
    assert friction["values"]["friction_force"] == {"value": 1.5, "unit": "N", "uncertainty": 0.3}
    assert friction["values"]["rms_height"] == {"value": 1e-6, "unit": "m"}
    assert friction["values"]["friction_reduction"] == {
        "value": None, "unit": "", "uncertainty": None, "lower": 0.1, "upper": None,
    }  # fmt: skip
    assert friction["tables"]["steps"] == {
        "units": {"time": "s", "word": ""}, "rows": [{"time": 1.0, "word": "on"}, {"time": None, "word": "off"}],
    }  # fmt: skip
    assert (friction["source"], friction["caveats"], friction["not_found"]) == (
        {"file": "trace.csv"}, ["drifts"], ["stick-slip: none"],
    )  # fmt: skip
    assert "rig_entries" not in friction
    assert groove["rig_entries"] == {"contact.normal_load": "3 N"}


def test_caveats_name_their_sheet_where_there_are_several() -> None:
    assert measurement_caveats(report(FRICTION)) == ["drifts"]
    assert measurement_caveats(report(FRICTION, GROOVE)) == ["trace.csv: drifts", "groove.npy: tilted"]


def test_friction_over_load_and_volume_over_load_and_distance_are_in_the_report() -> None:
    rows = pin_on_disc_rows(conditions(normal_load="3N", sliding_distance="100m"), [FRICTION, GROOVE])
    assert rows["Friction"] == [
        ("Friction, trace.csv", "1.5 ± 0.3 N"),
        ("Steady friction, trace.csv", "1.2 N"),
        ("Reduction, trace.csv", FRICTION.values[3].text),
        ("Coefficient of friction at 3 N, trace.csv", "0.5 ± 0.1"),
        ("Coefficient of friction at 3 N, trace.csv", "0.4"),
    ]
    # 6e-11 m3 over 300 N m: 2e-13 m2/N, with 1e-14 m2/N
    (wear,) = [text for name, text in rows["Wear"] if name.startswith("Wear volume per")]
    expected = Value("specific_wear_rate", "", 2e-13, "m2/N", uncertainty=1e-14)
    assert wear == expected.text
    assert ("Depth, groove.npy", GROOVE.values[1].text) in rows["Wear"]
    assert ("Pin, material", "steel") in rows["Materials and specimens"]
    assert ("Disc, material", "not stated") in rows["Materials and specimens"]
    assert ("Operator", "Ann") in rows["Apparatus and procedure"]


@mark.parametrize("stated", [{}, {"normal_load": "3N"}, {"sliding_distance": "100m"}])
def test_quotients_need_what_they_are_divided_by(stated: dict[str, str]) -> None:
    rows = pin_on_disc_rows(conditions(**stated), [FRICTION, GROOVE])
    assert not any(name.startswith("Wear volume per") for name, _ in rows["Wear"])
    has_load = any(name.startswith("Coefficient") for name, _ in rows["Friction"])
    assert has_load == ("normal_load" in stated)
    bare = pin_on_disc_rows(conditions(), [])
    assert bare["Wear"] == bare["Friction"] == [("Measured here", "no")]


def test_the_test_sheet_in_json_names_part_item_and_value() -> None:
    found = measurement_object(report(FRICTION, test=conditions(normal_load="3N")))["test_sheet"]
    assert found[0] == {"part": "Test parameters", "what": "Load", "value": "3N"}


def test_the_page_has_every_figure_and_progress_counts_them_over_all_sheets() -> None:
    told: list[tuple[str, int, int]] = []
    text = measurement_page(
        report(FRICTION, GROOVE, test=conditions(normal_load="3N")), advance=lambda *e: told.append(e)
    )
    assert told == [("Force", 1, 3), ("More", 2, 3), ("Map", 3, 3)]
    assert text.count("data:image/png;base64,") == 3
    assert '<li class="caveat">is empty</li>' in text
    assert "<td>Load</td><td>3N</td>" in text
    assert "Test sheet" not in measurement_page(report(GROOVE))


def test_the_checklist_has_what_is_known_before_a_test_and_ends_with_the_statement() -> None:
    found = pin_on_disc_checklist({"parameters": {"normal_load": "3 N"}, "disc": {"material": "steel"}})
    assert found[0] == ("Test parameters", "Load", "3 N")
    assert ("Disc", "material", "steel") in found
    assert ("Pin", "material", "") in found
    assert list(dict.fromkeys(part for part, _, _ in found)) == [
        "Test parameters", "Pin", "Disc", "Apparatus and procedure", "Wear", "Friction", "Statement",
    ]  # fmt: skip
    assert found[-1] == ("Statement", "Procedure of ASTM G99 followed, with the parameters above", "")


@mark.parametrize(
    ("text", "line"),
    [
        ("parameter = 1", "parameter: unknown key; did you mean parameters"),
        ("pin = 1", "pin must be a table, got 1"),
        ("[pin]\nqqqqqqqqq = 'x'", "pin.qqqqqqqqq: unknown key; known: material, form, processing"),
        ("[parameters]\nsliding_distance = '3 N'", "parameters.sliding_distance"),
        ("[parameters]\nnormal_load = '3 m'", "parameters.normal_load"),
        ("= =", ""),
    ],
)
def test_a_sheet_of_conditions_is_refused_with_its_file_and_key(text: str, line: str, tmp_path: Path) -> None:
    path = tmp_path / "test.toml"
    path.write_text(text, encoding="utf-8")
    with raises(InvalidInput) as refused:
        read_pin_on_disc_sheet(path)
    assert str(refused.value).startswith(f"{path}: {line}")


def test_conditions_are_texts_whatever_they_were_and_quantities_are_in_si(tmp_path: Path) -> None:
    path = tmp_path / "test.toml"
    path.write_text("[parameters]\nnormal_load = '2 kN'\n[test]\ndate = 2026\n", encoding="utf-8")
    found: Any = read_pin_on_disc_sheet(path)
    assert found.entries["test"] == {"date": "2026"}
    assert found.quantity("normal_load") == approx(2000.0)
    assert found.quantity("sliding_speed") is None
