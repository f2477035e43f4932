"""Plan of tests in words: size, facts, points, runs with empty cells, limits, and what the plan settles of a report."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pytest import approx

from sonolube.report.results.design import plan_of_tests as results

NAN = float("nan")


def plan(*, specimens: int = 1, **changes: Any) -> Any:
    """Two points of three candidates, twice each, on two pairs."""
    comparison = SimpleNamespace(
        specimens=specimens, deviation=lambda scatter: 0.5 * scatter.value, title="paired", name="paired"
    )
    part = SimpleNamespace(vibrated=(False, True, False))
    runs = [
        SimpleNamespace(run=number, block=block, point=point, specimens=(pair,), parts=(part,) * specimens)
        for number, block, point, pair in ((1, 1, 0, "A"), (2, 1, 1, "B"), (3, 2, 1, "A"), (4, 2, 0, "B"))
    ]
    values: dict[str, Any] = {
        "batch": SimpleNamespace(points=(2, 0), information=(0.4, 0.75)),
        "runs": runs,
        "question": SimpleNamespace(comparison=comparison, difference=0.1, significance=0.05),
        "replicates": 2,
        "duration": 5400.0,
        "scatter": SimpleNamespace(value=0.08, source="D Table 2.3"),
        "weights": {"kinematic": 0.25, "stick slip": 0.75},
        "entropy": 0.811,
        "power": 0.934,
        "procedure": SimpleNamespace(
            blocking=SimpleNamespace(title="a day"),
            intrinsic_distance=12.0,
            vibrated_distance=30.0,
            measuring_time=12.5,
        ),
        "candidates": SimpleNamespace(
            normal_load=np.array([3.0, 4.0, 5.0]),
            sliding_speed=np.array([0.02, 0.04, 0.06]),
            voltage_peak_to_peak=np.array([28.0, 10.0, NAN]),
            vibration_amplitude=np.array([2.5e-6, 1e-6, 1.5e-6]),
            power_to_supply=np.array([6.25, 1.0, NAN]),
            charging_power=np.array([6.25, 0.5, NAN]),
            dissipated_power=np.array([NAN, 1.0, NAN]),
            mean_temperature_rise=np.array([NAN, 1.0, 12.0]),
            refused=("", "beyond the amplifier", ""),
        ),
        "candidate": lambda run: (2, 0)[run.point],
        "states": lambda run, part: [SimpleNamespace(vibrated=on, duration=12.4 * (1 + on)) for on in part.vibrated],
        "median": np.array([0.35, 0.5, 0.6]),
        "interval": np.array([[0.2, 0.3, 0.4], [0.55, 0.7, 0.85]]),
        "chance": np.array([0.995, 0.5, 0.85]),
        "information": np.array([0.123, 0.2, 0.4]),
        "limits": SimpleNamespace(power_to_supply=10.0, mean_temperature_rise=50.0),
        "materials": ("brass", "steel"),
    }
    return SimpleNamespace(**(values | changes))


def test_the_size_counts_runs_or_tests_and_pairs_and_the_time_of_sliding() -> None:
    assert results.size_text(plan()) == "2 points, 2 times each: 4 runs on 2 pairs of specimens, 1.5 h of sliding"
    assert results.size_text(plan(specimens=2, duration=3599.0)) == (
        "2 points, 2 times each: 8 tests on 2 pairs of specimens, 60 min of sliding"
    )
    assert results.size_text(plan(duration=3600.0)).endswith("1 h of sliding")


def test_facts_have_difference_power_scatter_weights_and_the_last_information() -> None:
    facts = dict(results.facts(plan()))
    assert facts["comparison"] == (
        "paired: a reduction of 10 % is shown at each point with power 0.93 at significance 0.05"
    )
    assert facts["scatter"] == "4 % of friction for one difference (D Table 2.3)"
    assert facts["friction models"] == (
        "kinematic 25 %, stick slip 75 %; the plan is expected to give 0.75 of 0.81 bit about which holds"
    )
    assert facts["blocks"] == "2, each of every point once in random order, the first point first; each is a day"
    assert facts["order"].startswith("off, on, off in each run")
    assert dict(results.facts(plan(specimens=2)))["order"].startswith("the pair without vibration first")


def test_points_are_numbered_in_the_order_of_the_plan_with_dashes_for_what_is_not_known() -> None:
    assert results.point_rows(plan()) == [
        ["1", "5 N", "60 mm/s", "-", "1.5 um", "0.60 (0.40 to 0.85)", "85 %", "-", "12 K", "0.400 bit"],
        ["2", "3 N", "20 mm/s", "28 V", "2.5 um", "0.35 (0.20 to 0.55)", "100 %", "at least 6.25 W", "-", "0.123 bit"],
    ]
    assert len(results.POINT_HEADS) == 10


def test_runs_to_fill_have_their_settings_in_the_units_of_their_heads_and_empty_cells() -> None:
    rows = results.run_rows(plan())
    assert len(results.RUN_HEADS) == len(rows[0])
    assert rows[0] == ("1", "1", "A", "5", "60", "-", "1.5", "off 12, on 25, off 12", "", "", "", "")
    assert rows[1][:8] == ("2", "1", "B", "3", "20", "28", "2.5", "off 12, on 25, off 12")
    assert results.run_rows(plan(specimens=2))[0][7] == "off 12, on 25, off 12; off 12, on 25, off 12"


def test_limits_of_the_rig_stand_beside_those_of_the_protocol_where_they_were_stated() -> None:
    limits: Any = SimpleNamespace(voltage_maximum=30.0, friction_force_maximum=2.5)
    assert results.limit_rows(plan(), limits) == [
        ("Voltage, its offset included", "30 V"),
        ("Friction force", "2.5 N"),
        ("Temperature of the actuator", ""),
        ("Power of the amplifier", "10 W"),
        ("Rise of the contact by friction", "50 K"),
    ]
    limits.voltage_maximum, limits.friction_force_maximum = 0.0, None
    bare = SimpleNamespace(power_to_supply=None, mean_temperature_rise=None)
    assert results.limit_rows(plan(limits=bare), limits) == [
        ("Voltage, its offset included", "not planned: the vibration is switched by hand"),
        ("Friction force", "nan N"),
        ("Temperature of the actuator", ""),
    ]
    assert len(results.limit_rows(plan(materials=None), limits)) == 4


def test_the_report_has_the_ranges_of_the_points_alone() -> None:
    rig: Any = SimpleNamespace(drive=SimpleNamespace(frequency=22e3), title="Own rig")
    assert results.known_items(rig, plan()) == {
        "parameters": {
            "normal_load": "3 N to 5 N",
            "sliding_speed": "20 mm/s to 60 mm/s",
            "sliding_distance": "12 m and 30 m running-in without and with vibration, then 12.5 s each",
            "vibration": "22 kHz, 1.5 um to 2.5 um zero to peak, normal to the disc",
        },
        "pin": {"material": "brass"},
        "disc": {"material": "steel"},
    }
    rig.drive = None
    alone = plan(batch=SimpleNamespace(points=(1,), information=(0.4,)), materials=None)
    found = results.known_items(rig, alone)
    assert found["parameters"]["vibration"] == "1 um zero to peak, normal to the disc"
    assert found["parameters"]["normal_load"] == "4 N"
    assert found["pin"] == {"material": ""}


@pytest.fixture
def content() -> dict[str, Any]:
    rig: Any = SimpleNamespace(title="Own rig")
    return results.plan_object(rig, plan())


def test_a_plan_in_json_counts_points_from_one_and_lists_what_was_left_out(content: dict[str, Any]) -> None:
    assert content["scatter"] == {"value": approx(0.04), "source": "D Table 2.3"}
    assert content["duration"] == {"value": 5400.0, "unit": "s"}
    assert content["information"] == {"value": 0.75, "of": 0.811, "unit": "bit"}
    first, second = content["points"]
    assert first["voltage_peak_to_peak"] == {"value": None, "unit": "V"}
    assert first["normal_load"] == {"value": 5.0, "unit": "N"}
    assert first["friction_ratio"] == {"median": approx(0.6), "interval_80": approx([0.4, 0.85])}
    for name in ("power_to_supply", "charging_power", "actuator_power"):
        assert second[name] == {"value": 6.25, "unit": "W"}
    assert second["at_least"] == ["power_to_supply"]
    assert (first["information"], second["information"]) == approx((0.4, 0.123))
    assert content["left_out"] == [
        {"sliding_speed": {"value": 0.04, "unit": "m/s"}, "vibration_amplitude": {"value": 1e-6, "unit": "m"},
         "reason": "beyond the amplifier"}
    ]  # fmt: skip
    assert content["runs"][1] == {
        "run": 2, "block": 1, "point": 2, "specimens": ["B"], "vibrated": [[False, True, False]],
    }  # fmt: skip
    assert (content["power"], content["replicates"]) == (0.934, 2)
