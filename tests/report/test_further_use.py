"""Numbers, runs and rig entries of results in JSON, by hand, and of results that hold something else."""

from typing import Any

import pytest
from pytest import approx

from sonolube.report.measured.further_use import result_numbers, result_rig_entries, result_run_rows

STEPS = [
    {"voltage_peak_to_peak": 0.0, "friction_force": 1.2, "friction_reduction": None},
    {"voltage_peak_to_peak": 28.0, "friction_force": 0.3, "friction_reduction": 0.75, "sliding_speed": 0.05},
    {"voltage_peak_to_peak": 40.0, "friction_force": -0.1, "friction_reduction": 1.1},
    {"voltage_peak_to_peak": 20.0, "friction_force": None, "friction_reduction": 0.5},
]
STEPPED = {"title": "a.csv", "values": {}, "tables": {"steps": {"units": {"friction_force": "N"}, "rows": STEPS}}}


def of(**values: Any) -> dict[str, Any]:
    return {"title": "a.csv", "values": {name: {"value": value, "unit": "N"} for name, value in values.items()}}


def test_each_number_stands_with_its_part_uncertainty_and_unit() -> None:
    result = {
        "values": {"force": {"value": 3.0, "uncertainty": 0.1, "unit": "N"}, "other": 5},
        "tables": {
            "steps": {"units": {"a": "V"}, "rows": [{"a": 1.0, "b": None}, 7, {"a": 2.0, "b": 4.0}]},
            "empty": {"rows": None},
            "text": "x",
        },
    }
    assert list(result_numbers(result)) == [
        ["", "force", 3.0, 0.1, "N"],
        ["steps 1", "a", 1.0, None, "V"],
        ["steps 3", "a", 2.0, None, "V"],
        ["steps 3", "b", 4.0, None, None],
    ]
    assert list(result_numbers({})) == []


def test_each_step_with_vibration_is_a_run_with_the_friction_without() -> None:
    (row,) = result_run_rows(STEPPED, {"normal_load": 3.0, "sliding_speed": 0.02})
    assert row["run"] == "a.csv step 2"
    assert row["normal_load"] == 3.0
    assert row["friction_force"] == 0.3
    assert row["intrinsic_friction_force"] == approx(1.2)  # 0.3 over a quarter
    assert row["voltage_peak_to_peak"] == 28.0
    assert row["sliding_speed"] == 0.05  # its own


def test_a_recording_without_steps_is_one_run_by_its_best_level() -> None:
    (row,) = result_run_rows(of(mean_force=3.0, friction_force=2.0, steady_friction_force=1.0), {"normal_load": 4.0})
    assert row == {"run": "a.csv", "normal_load": 4.0, "friction_force": 1.0}
    (row,) = result_run_rows(of(mean_force=3.0, friction_force=2.0), {})
    assert row["friction_force"] == 2.0
    assert list(result_run_rows(of(other=3.0), {})) == []
    assert list(result_run_rows(of(mean_force=float("nan")), {})) == []
    assert list(result_run_rows(of(mean_force=True), {})) == []
    long = next(result_run_rows({**of(mean_force=1.0), "title": "x" * 200}, {}))
    assert long["run"] == "x" * 120


def test_a_coefficient_gives_runs_and_an_entry_without_a_load() -> None:
    steps = [
        {"voltage_peak_to_peak": 0.0, "friction_coefficient": 0.3, "friction_reduction": None},
        {"voltage_peak_to_peak": 20.0, "friction_coefficient": 0.12, "friction_reduction": 0.6},
    ]
    result = {"title": "a.csv", "values": {}, "tables": {"steps": {"rows": steps}}}
    (row,) = result_run_rows(result, {})
    assert (row["friction_coefficient"], row["voltage_peak_to_peak"]) == (0.12, 20.0)
    assert row["intrinsic_friction_coefficient"] == approx(0.3)
    assert "friction_force" not in row
    assert result_rig_entries(result, {}) == {"friction.friction_coefficient": "0.3"}


def test_a_rig_takes_measured_quantities_with_their_units_and_the_coefficient() -> None:
    result = of(vibration_amplitude=2.5e-6, amplitude_per_volt=8.92e-8, mean_force=0.6, frequency=-1.0)
    entries = result_rig_entries(result, {"normal_load": 3.0, "frequency": 22000.0})
    assert entries == {
        "contact.normal_load": "3 N",
        "drive.frequency": "22 kHz",
        "vibration.vibration_amplitude": "2.5 um",
        "actuator.amplitude_per_volt": "89.2 nm/V",
        "friction.friction_coefficient": "0.2",
    }


@pytest.mark.parametrize(
    ("result", "conditions", "coefficient"),
    [
        (of(mean_coefficient=0.31, mean_force=9.0), {"normal_load": 3.0}, "0.31"),
        (of(mean_force=0.9), {"normal_load": 3.0}, "0.3"),
        (of(mean_force=0.9), {"normal_load": 3.0, "vibration_amplitude": 1e-6}, None),  # of vibrated friction
        (of(mean_force=0.9), {"normal_load": 3.0, "voltage_peak_to_peak": 0.0}, "0.3"),
        (of(mean_force=0.9), {"normal_load": 3.0, "voltage_peak_to_peak": 9.0}, None),
        (of(mean_force=0.9), {}, None),
        (of(mean_force=0.9), {"normal_load": 0.0}, None),
        (STEPPED, {"normal_load": 3.0, "voltage_peak_to_peak": 9.0}, "0.4"),  # the step without voltage
        ({"tables": {"steps": {"rows": STEPS[1:]}}}, {"normal_load": 3.0}, None),
    ],
)
def test_the_coefficient_is_that_of_dry_friction(
    result: dict[str, Any], conditions: dict[str, float], coefficient: str | None
) -> None:
    assert result_rig_entries(result, conditions).get("friction.friction_coefficient") == coefficient


@pytest.mark.parametrize("result", [{"values": 3}, {"tables": {"steps": 4}}, {"values": {"mean_force": 2}}, {}])
def test_a_result_of_another_form_has_nothing(result: dict[str, Any]) -> None:
    assert list(result_run_rows(result, {})) == []
    assert result_rig_entries(result, {"normal_load": 1.0}) == {"contact.normal_load": "1 N"}
