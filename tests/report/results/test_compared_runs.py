"""Levels of several runs in one table: numbers from cells, uncertainties in one unit, a dash for what is not known."""

import numpy as np
from pytest import approx

from sonolube.charts import Points
from sonolube.report.results.compared_runs import level_objects, level_table, levels_chart, levels_csv

HEADINGS = [
    "run", "block", "normal_load [N]", "sliding_speed [m/s]", "voltage_peak_to_peak [V]", "frequency [Hz]",
    "friction_force [N]", "friction_force_uncertainty [N]", "friction_reduction", "friction_reduction_uncertainty",
    "study", "source", "note",
]  # fmt: skip
ROWS = [
    HEADINGS,
    ["7", "1", "3", "0.02", "28", "22000", "1.5", "0.015", "0.654", "0.021", "S", "own", "1 of 2"],
    ["7", "1", "3", "0.02", "", "", "4.25", "", "", "", "S", "own", ""],
    ["12", "2", "3", "0.02", "14", "22000", "2.5", "0.05", "0.4", "", "S", "own", ""],
]


def test_words_stay_words_even_where_they_are_digits_and_empty_cells_are_unknown() -> None:
    first, second, _ = level_objects(ROWS)
    assert [first[name] for name in ("run", "block", "study", "source", "note")] == ["7", "1", "S", "own", "1 of 2"]
    assert first["voltage_peak_to_peak"] == approx(28.0)
    assert first["friction_reduction_uncertainty"] == approx(0.021)
    assert second["voltage_peak_to_peak"] is None
    assert (second["note"], second["friction_reduction"]) == ("", None)


def test_a_direction_is_a_word_or_an_angle() -> None:
    rows = [["run", "vibration_direction [rad]"], ["1", "normal"], ["2", "0.5"], ["3", ""]]
    assert [each["vibration_direction"] for each in level_objects(rows)] == ["normal", 0.5, None]


def test_a_level_has_its_uncertainty_beside_it_and_a_dash_for_what_is_not_known() -> None:
    table = level_table(level_objects(ROWS))
    assert list(table.heads) == ["run", "load", "speed", "voltage", "frequency", "friction", "reduction"]
    assert list(map(list, table.rows)) == [
        ["7", "3 N", "20 mm/s", "28 V", "22 kHz", "1.5 N +- 15 mN", "65.4 % +- 2.1 %"],
        ["7", "3 N", "20 mm/s", "-", "-", "4.25 N", "-"],
        ["12", "3 N", "20 mm/s", "14 V", "22 kHz", "2.5 N +- 50 mN", "40.0 %"],
    ]
    # an uncertainty without its value says nothing
    (lone,) = level_table([{**level_objects(ROWS)[1], "friction_force": None, "friction_force_uncertainty": 0.1,
                            "friction_reduction_uncertainty": 0.1}]).rows  # fmt: skip
    assert (lone[5], lone[6]) == ("-", "-")


def test_the_table_as_text_ends_every_row_with_one_line_feed() -> None:
    assert levels_csv([["a", "b, c"], ["1", ""]]) == 'a,"b, c"\n1,\n'
    rows = [["source", "friction_force [N]", "friction_force_uncertainty [N]"], ["/runs/0715", "1.5", "0.1"]]
    assert levels_csv(rows) == "source,friction_force [N]\n0715,1.5\n"


def test_the_chart_has_a_marker_for_each_run_at_known_voltages_and_bars_of_two_uncertainties() -> None:
    chart = levels_chart(level_objects(ROWS))
    (panel,) = chart.panels
    assert [(axis.text, axis.unit) for axis in (panel.x, panel.y)] == [
        ("Voltage, peak to peak [V]", "V"), ("Friction force [N]", "N"),
    ]  # fmt: skip
    first, second = panel.parts
    assert isinstance(first, Points)
    assert isinstance(second, Points)
    assert (first.label, second.label) == ("7", "12")
    assert first.x == approx(np.array([28.0]))
    assert first.y == approx(np.array([1.5]))
    assert first.y_error == approx(np.array([0.03]))
    assert second.y_error == approx(np.array([0.1]))
    assert (first.colour, first.marker) != (second.colour, second.marker)
