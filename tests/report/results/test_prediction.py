"""Prediction of a rig in rows and JSON: medians, intervals in percent or units, and what inputs leave of them."""

from typing import Any

import numpy as np
from pytest import approx

from sonolube.prediction.hierarchy import PROBABILITIES
from sonolube.report.results import prediction as results
from sonolube.rig.datasets import LabelledArray, LabelledArrays

DRAWS = np.linspace(0.0, 1.0, 1001)  # a share p of the draws lies within (1 - p)/2 to (1 + p)/2


def over(name: str, *values: Any) -> LabelledArray:
    return LabelledArray(dims=(name,), values=np.array(values))


PREDICTION = LabelledArrays(
    variables={
        "friction_ratio": LabelledArray(dims=("draw",), values=0.8 * DRAWS),
        "friction_reduction": LabelledArray(dims=("draw",), values=1 - 0.8 * DRAWS),
        "friction_force": LabelledArray(dims=("draw",), values=2 * DRAWS),
        "input": over("input", "vibration_amplitude", "normal_load"),
        "input_label": over("input", "Amplitude", "Load"),
        "input_value": over("input", 2.5e-6, 3.0),
        "input_spread": over("input", 0.2, 0.05),
        "reason": over("input", "assumed", "stated"),
        "interval_share_left": over("input", 0.75, 0.99),
        "force_interval_share_left": over("input", 0.8, 0.5),
        "measure_label": over("measurement", "roughness", "amplitude"),
        "measure_share_left": over("measurement", 0.6, 0.7),
    },
    coordinates={},
    attrs={"vibration_amplitude": 2.5e-6, "power_to_supply": 6.25, "charging_power": 6.25, "power_is_at_least": 1},
)


def test_predicted_quantities_have_medians_and_central_intervals_and_reductions_are_in_percent() -> None:
    assert PROBABILITIES == (0.5, 0.8, 0.95)
    assert results.HEADS == ["", "median", "50 %", "80 %", "95 %"]
    rows = results.quantity_rows(PREDICTION)
    assert rows[0] == [
        "Friction force with vibration over that without", "0.4", "0.2 to 0.6", "0.08 to 0.72", "0.02 to 0.78",
    ]  # fmt: skip
    assert rows[1] == ["Friction reduction", "60 %", "40 % to 80 %", "28 % to 92 %", "22 % to 98 %"]
    assert rows[2][1:4] == ["1 N", "500 mN to 1.5 N", "200 mN to 1.8 N"]
    assert [row[1:] for row in rows[3:]] == 2 * [["not known", "", "", ""]]  # wear, of which there are no draws


def test_inputs_have_their_spread_and_what_of_ratio_and_force_they_leave() -> None:
    assert results.input_rows(PREDICTION) == [
        ["Amplitude", "2.5 um within 20 %", "75 % and 80 %", "assumed"],
        ["Load", "3 N within 5 %", "99 % and 50 %", "stated"],
    ]
    assert results.measurement_shares(PREDICTION) == {"roughness": approx(0.6), "amplitude": approx(0.7)}


def test_a_predicted_quantity_in_json_has_its_intervals_by_their_percentage() -> None:
    found = results.predicted_object(PREDICTION, "friction_force")
    assert set(found) == {"median", "interval_50", "interval_80", "interval_95", "unit"}
    assert (found["median"], found["unit"]) == (approx(1.0), "N")
    assert found["interval_80"] == approx([0.2, 1.8])


def test_the_operating_point_has_the_amplitude_with_its_spread_and_a_power_that_is_known() -> None:
    assert results.operating_texts(PREDICTION) == [
        {"name": "vibration_amplitude", "label": "Vibration amplitude, zero to peak", "text": "2.5 um within 20 %"},
        {"name": "power_to_supply", "label": "Power to supply", "text": "at least 6.25 W"},
        {"name": "charging_power", "label": "Charge of the capacitance, D 1.9", "text": "6.25 W"},
    ]
    assert results.power_object(PREDICTION) == {
        **dict.fromkeys(("power_to_supply", "charging_power", "actuator_power"), 6.25),
        "at_least": ["power_to_supply"],
    }
    undriven = LabelledArrays(variables=PREDICTION.variables, coordinates={}, attrs={})
    assert results.operating_texts(undriven) == []
    assert results.power_object(undriven) == {"actuator_power": None}
