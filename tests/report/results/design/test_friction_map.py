"""Maps of friction reduction and efficiency lines in words: greatest reduction, ridge, panels, runs, and power."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pytest import MonkeyPatch, approx

from sonolube.report.blocks import Rows
from sonolube.report.results.design import friction_map as results
from sonolube.rig import power_to_supply

NAN = float("nan")
RIG: Any = SimpleNamespace(
    title="Own rig", name="own", file=None, source="", normal_load=3.0, sliding_speed=0.02, friction_coefficient=0.2,
    friction_model=SimpleNamespace(name="kinematic"),
)  # fmt: skip
REDUCTION = np.array(
    [  # over load, power and speed
        [[0.1, 0.2, 0.3], [0.4, 0.5, NAN]],
        [[0.15, 0.25, 0.35], [0.6, 0.55, 0.45]],
    ]
)
MAP = xr.Dataset(
    {
        "friction_reduction": (("normal_load", "power_to_supply", "sliding_speed"), REDUCTION),
        "status": (("normal_load", "power_to_supply", "sliding_speed"), np.isnan(REDUCTION).astype(int),
                   {"flag_meanings": "stable failed"}),
        "reason": (("normal_load", "power_to_supply", "sliding_speed"), np.where(np.isnan(REDUCTION), "too fast", "")),
        "charging_power": ("power_to_supply", [0.5, 0.75]),
        "dissipated_power": ("power_to_supply", [1.0, 2.0]),
        "saturation_power": (("normal_load", "sliding_speed"), [[NAN, NAN, NAN], [1.5, NAN, 4.0]]),
    },
    coords={"normal_load": [3.0, 5.0], "power_to_supply": [1.0, 2.0], "sliding_speed": [0.02, 0.04, 0.06]},
    attrs={"map": "velocity-power"},
)  # fmt: skip


@pytest.fixture(autouse=True)
def amplitude(monkeypatch: MonkeyPatch) -> None:
    """Let every rig have the amplitude that it states."""
    labels = {"amplitude_source": "file", "amplitude_origin": "stated"}
    monkeypatch.setattr("sonolube.rig.amplitude_labels", lambda rig: labels)


GREATEST = ("most reduction", "0.6 at 20 mm/s, 5 N, 2 W to supply")
ENERGY = power_to_supply(charging_power=0.75, dissipated_power=2.0)
assert ENERGY is not None
BALANCE = ("energy", ENERGY.energy_balance)
RIDGE = ("ridge", "1.5 W to 4 W; beyond it doubling the power buys less than 5 %")


def test_a_map_in_words_has_the_greatest_reduction_with_its_place_the_ridge_and_failures() -> None:
    head, rows = results.map_blocks(RIG, MAP)
    assert head == "Own rig, 12 points, friction model kinematic"
    assert rows == Rows([GREATEST, BALANCE, RIDGE, ("amplitude", "stated"), ("without result", "1: too fast")])
    there = ("predicted there", "0.4, 0.2 to 0.7 (80 %)")
    assert list(results.map_blocks(RIG, MAP, there[1])[1].rows)[:2] == [GREATEST, there]
    nothing = MAP.assign(
        friction_reduction=MAP["friction_reduction"] * NAN, saturation_power=MAP["saturation_power"] * NAN
    )
    bare = results.map_blocks(RIG, nothing)[1]
    assert isinstance(bare, Rows)
    assert [name for name, _ in bare.rows] == ["amplitude", "without result", "without result"]


def test_a_map_in_json_has_its_greatest_point_in_si() -> None:
    assert results.map_object(RIG, MAP) == {
        "rig": "Own rig", "map": "velocity-power", "friction_model": "kinematic", "amplitude_source": "file",
        "amplitude_origin": "stated", "same_panels": False, "points": 12, "without_result": 1,
        "most_reduction": {
            "friction_reduction": {"value": approx(0.6), "unit": ""},
            "sliding_speed": {"value": approx(0.02), "unit": "m/s"},
            "normal_load": {"value": approx(5.0), "unit": "N"},
            "power_to_supply": {"value": approx(2.0), "unit": "W"},
            "charging_power": {"value": approx(0.75), "unit": "W"},
            "dissipated_power": {"value": approx(2.0), "unit": "W"},
            "actuator_power": {"value": approx(0.75), "unit": "W"},
        },
    }  # fmt: skip


def test_the_page_of_a_map_has_the_greatest_reduction_of_each_panel() -> None:
    page = results.map_page(RIG, MAP, None, None)
    assert (page.name, page.title) == (
        "map", "Friction reduction over sliding speed and power to supply: Own rig"
    )  # fmt: skip
    assert list(page.facts) == [("points", "12"), GREATEST, BALANCE, RIDGE]
    panels, statuses, failures = page.tables
    assert panels.heads == ("Normal load", "Friction reduction", "Sliding speed", "Power to supply", "Ridge")
    assert panels.rows == (("3 N", "0.5", "40 mm/s", "2 W", ""), ("5 N", "0.6", "20 mm/s", "2 W", "1.5 W to 4 W"))
    assert statuses.rows == (("stable", "11", "91.7%"), ("failed", "1", "8.3%"))
    assert failures.rows == (("too fast", "1"),)
    flat = MAP.drop_vars("saturation_power")
    assert results.map_page(RIG, flat, None, None).tables[0].heads[-1] == "Power to supply"
    assert results.map_page(RIG, flat, None, None).tables[0].rows[0] == ("3 N", "0.5", "40 mm/s", "2 W")
    # equal panels are one, which a sentence says
    equal = flat.assign(friction_reduction=flat["friction_reduction"].isel(normal_load=1, drop=True).broadcast_like(
        flat["friction_reduction"]).transpose(*flat["friction_reduction"].dims))  # fmt: skip
    same = results.map_page(RIG, equal, None, None)
    panels_text = "the same at each normal load from 3 N to 5 N, within 0.01 percentage points"
    assert ("panels", panels_text) in same.facts
    assert same.tables[0].title == "Points by status"
    assert results.map_object(RIG, equal)["same_panels"] is True


def test_measured_runs_are_counted_with_their_scatter_once_they_make_a_map() -> None:
    runs = xr.Dataset({"friction_reduction": ("run", np.zeros(5))})
    few = results.map_page(RIG, MAP, runs, None)
    assert few.facts[-1] == ("measured runs", "5; 6 make a map of their own")
    own = xr.Dataset(attrs={"scatter": 0.0345, "leave_one_out_error": 0.0512})
    many = results.map_page(RIG, MAP, runs, own)
    assert many.facts[-1] == ("measured runs", "5; scatter 3.5 % about a smooth map, leave-one-out error 5.1 %")


def test_the_caption_names_the_dashed_line_and_the_circles_where_they_are_drawn() -> None:
    dashed = " Dashed: the power beyond which doubling it reduces friction by less than another 5 %."
    circles = " Circles: measured runs, with their reductions in percent."
    flat = MAP.drop_vars("saturation_power")
    assert results.caption(MAP, has_runs=True) == f"Friction reduction by the model.{dashed}{circles}"
    assert results.caption(flat, has_runs=False) == "Friction reduction by the model."


def test_a_map_over_amplitude_has_the_amplitude_in_its_panels() -> None:
    power = MAP.rename(power_to_supply="vibration_amplitude").drop_vars(
        ["saturation_power", "charging_power", "dissipated_power"]
    )
    panels = results.map_page(RIG, power.assign_attrs(map="velocity-amplitude"), None, None).tables[0]
    assert panels.heads[-1] == "Vibration amplitude, zero to peak"


def calibration(highest: float | None = 6.5, *, has_target: bool = True) -> Any:
    """Line of 2e-9 m2/N per m/s and 0.5e-9 m2/N."""
    fit = SimpleNamespace(
        line=SimpleNamespace(slope=2e-9, intercept=0.5e-9), slope_uncertainty=0.25e-9, intercept_uncertainty=0.1e-9,
        efficiency_deviation=0.05e-9, lowest_speed=0.02, highest_speed=0.08, runs=7,
    )  # fmt: skip
    estimate = SimpleNamespace(actuator_power=5.0, lowest_power=4.0, highest_power=highest)
    return SimpleNamespace(
        fit=fit, estimate=estimate if has_target else None, target_speed=0.0655 if has_target else None,
        friction_force=1.25 if has_target else None, confidence_level=0.95,
    )  # fmt: skip


def test_an_efficiency_line_has_the_unit_of_the_dissertation() -> None:
    # 1e-9 m2/N are 1 mW mm2/(N W)
    facts = dict(results.facts(calibration()))
    assert facts == {
        "line": "(2 +- 0.25) v + (0.5 +- 0.1), in mW mm2/(N W) with v in m/s",
        "scatter of runs": "0.05 mW mm2/(N W)",
        "speeds covered": "20 mm/s to 80 mm/s",
        "power": "5 W for 1.25 N at 65.5 mm/s; 4 W to 6.5 W with 95 %",
    }
    assert dict(results.facts(calibration(None)))["power"].endswith("4 W to no bound with 95 %")
    assert "power" not in dict(results.facts(calibration(has_target=False)))


def test_an_efficiency_line_in_json_has_its_power_where_there_is_a_target() -> None:
    found = results.efficiency_object(calibration(None))
    assert found["runs"] == 7
    assert (found["slope"]["value"], found["intercept"]["value"]) == approx((2e-9, 0.5e-9), rel=1e-12)
    assert (found["friction_force"]["value"], found["sliding_speed"]["value"]) == approx((1.25, 0.0655))
    assert (found["actuator_power"]["value"], found["lowest_power"]["value"]) == approx((5.0, 4.0))
    assert "highest_power" not in found
    assert found["lowest_speed"] == {"value": 0.02, "unit": "m/s"}
    assert "actuator_power" not in results.efficiency_object(calibration(has_target=False))
