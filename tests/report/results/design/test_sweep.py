"""Studies and sweeps in words: least friction of each curve, contact loss, powers, shares of points, the best point."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pytest import MonkeyPatch, approx

from sonolube.report.blocks import Rows
from sonolube.report.results.design import sweep as results

NAN = float("nan")
Columns = dict[str, Any]


def study(dims: tuple[str, ...], coords: Columns, columns: Columns, **attrs: Any) -> xr.Dataset:
    return xr.Dataset({name: (dims, np.array(values)) for name, values in columns.items()}, coords=coords, attrs=attrs)


VOLTAGES = study(
    ("voltage_peak_to_peak",),
    {"voltage_peak_to_peak": [10.0, 20.0, 30.0]},
    {
        "friction_ratio": [0.8, 0.35, 0.6],
        "vibration_amplitude": [1e-6, 2e-6, 3e-6],
        "contact_loss_fraction": [0.0, 0.1, 0.2],
        "power_to_supply": [1.0, 5.0, 9.0],
        "charging_power": [1.0, 5.0, 9.0],
        "dissipated_power": [0.5, 2.0, NAN],
    },
)


def test_a_study_over_voltage_has_its_least_friction_where_contact_is_lost_and_the_greatest_power() -> None:
    rows = results.rows(VOLTAGES, "voltage")
    assert rows[:3] == [
        ("least friction", "ratio 0.35 at 20 V"), ("contact is lost", "from 20 V"),
        ("power to supply", "at least 9 W at 30 V, the highest"),  # no structure gives its heat
    ]  # fmt: skip
    assert rows[3][0] == "energy"
    assert rows[3][1].startswith("5 W charges")  # of the point of least friction
    assert " 2 W is what the computed motion" in rows[3][1]
    held = VOLTAGES.assign(contact_loss_fraction=("voltage_peak_to_peak", np.zeros(3)))
    none = ("voltage_peak_to_peak", np.full(3, NAN))
    unknown = held.assign(power_to_supply=none, charging_power=none, dissipated_power=none)
    assert [name for name, _ in results.rows(unknown, "voltage")][:2] == ["least friction", "contact is lost"]
    assert results.rows(unknown, "voltage")[1][1] == "nowhere"
    assert "power to supply" not in dict(results.rows(unknown, "voltage"))
    bare = VOLTAGES.drop_vars(["vibration_amplitude", "power_to_supply", "charging_power", "dissipated_power"])
    amplitudes = bare.rename(voltage_peak_to_peak="vibration_amplitude")
    amplitudes = amplitudes.assign_coords(vibration_amplitude=[1e-6, 2e-6, 3e-6])
    assert results.rows(amplitudes, "amplitude") == [
        ("least friction", "ratio 0.35 at 2 um"), ("contact is lost", "from 2 um"),
    ]  # fmt: skip


CURVES = study(
    ("voltage_peak_to_peak", "frequency"),
    {"voltage_peak_to_peak": [10.0, 20.0], "frequency": [20e3, 21.5e3, 23e3]},
    {
        "friction_ratio": [[0.9, 0.7, 0.8], [0.5, 0.3, 0.4]],
        "vibration_amplitude": [[1e-6, 2e-6, 3e-6], [4e-6, 5e-6, 6e-6]],
        "power_to_supply": [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]],
        "charging_power": [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]],
        "dissipated_power": [[1.0, 1.0, 1.0], [1.0, 1.0, 1.0]],
    },
)


def test_a_study_over_frequency_has_the_least_friction_of_each_voltage() -> None:
    assert results.rows(CURVES, "frequency")[:2] == [
        ("at 10 V", "least friction ratio 0.7 at 21.5 kHz, 2 um, 2 W to supply"),
        ("at 20 V", "least friction ratio 0.3 at 21.5 kHz, 5 um, 5 W to supply"),
    ]
    lost = CURVES.assign(friction_ratio=CURVES["friction_ratio"].where(CURVES["voltage_peak_to_peak"] > 15))
    assert [row[0] for row in results.rows(lost, "frequency")][:1] == ["at 20 V"]


def test_a_study_over_speed_has_the_range_of_each_curve() -> None:
    powers = ["power_to_supply", "charging_power", "dissipated_power"]
    speeds = CURVES.rename(frequency="sliding_speed").drop_vars(powers)
    assert results.rows(speeds, "speed") == [
        ("at 10 V", "ratio 0.7 to 0.9, slow to fast"), ("at 20 V", "ratio 0.3 to 0.5, slow to fast"),
    ]  # fmt: skip


def test_a_study_of_power_has_the_least_power_to_supply_and_leaves_it_out_where_it_is_not_known() -> None:
    powers = study(
        ("frequency",),
        {"frequency": [20e3, 21e3, 22e3]},
        {
            "power_to_supply": [3.0, 7.0, 2.0],
            "charging_power": [3.0, 1.0, 2.0],
            "dissipated_power": [0.1, 7.0, 0.2],
            "voltage_peak_to_peak": [30.0, 20.0, 10.0],
            "friction_ratio": [0.4, 0.5, 0.6],
        },
    )
    assert results.rows(powers, "power")[:2] == [
        # at 21 kHz the capacitance takes the least, but the motion turns 7 W into heat
        ("least power to supply", "2 W at 22 kHz and 10 V for friction ratio 0.6"),
        ("energy", results.power_balance(powers.isel(frequency=2))),
    ]
    none = ("frequency", np.full(3, NAN))
    bare = powers.assign(power_to_supply=none, charging_power=none, dissipated_power=none)
    assert results.rows(bare, "power") == []


def test_waveforms_come_by_rising_friction_and_loads_with_the_frequency_of_the_arm() -> None:
    waveforms = study(
        ("waveform",), {"waveform": ["sine", "square"]},
        {"friction_ratio": [0.5, 0.25], "vibration_amplitude": [1e-6, 2e-6]},
    )  # fmt: skip
    assert results.rows(waveforms, "waveform") == [("square", "ratio 0.25, 2 um"), ("sine", "ratio 0.5, 1 um")]
    loads = study(
        ("normal_load",), {"normal_load": [3.0, 5.0]},
        {"friction_ratio": [0.51234, 0.61234], "natural_frequency": [100.0, 120.0]},
    )  # fmt: skip
    assert results.rows(loads, "load") == [
        ("friction ratio", "0.5123 to 0.6123"), ("arm's frequency", "100 Hz to 120 Hz"),
    ]  # fmt: skip
    assert [name for name, _ in results.rows(loads.drop_vars("natural_frequency"), "load")] == ["friction ratio"]


def test_the_best_points_in_json_have_what_is_known_of_them() -> None:
    first, second = results.best_objects(CURVES)
    assert first["voltage_peak_to_peak"] == {"value": 10.0, "unit": "V"}
    assert second["friction_ratio"] == {"value": 0.3, "unit": ""}
    assert second["frequency"] == {"value": 21.5e3, "unit": "Hz"}
    assert second["energy_balance"].startswith("5 W charges")
    for name in ("charging_power", "actuator_power"):  # and its former key
        assert second[name] == {"value": 5.0, "unit": "W"}
    assert "at_least" not in second
    (alone,) = results.best_objects(VOLTAGES.assign(vibration_amplitude=("voltage_peak_to_peak", [1.0, NAN, 1.0])))
    assert "vibration_amplitude" not in alone
    waveforms = study(("waveform",), {"waveform": ["sine", "square"]}, {"friction_ratio": [0.5, 0.25]})
    assert results.best_objects(waveforms) == [
        {"waveform": "square", "friction_ratio": {"value": 0.25, "unit": ""}}
    ]  # fmt: skip
    nothing = VOLTAGES.assign(friction_ratio=("voltage_peak_to_peak", np.full(3, NAN)))
    assert results.best_objects(nothing) == []
    assert "energy" not in dict(results.rows(nothing, "voltage"))


def test_shares_of_points_are_of_their_sum_or_of_a_total() -> None:
    counts = {"stable": 3, "lost": 1}
    assert results.count_table("Points", "points", counts).rows == (("stable", "3", "75.0%"), ("lost", "1", "25.0%"))
    whole = results.count_table("Points", "designs", counts, total=8)
    assert (whole.title, whole.heads) == ("Points", ("status", "designs", "share"))
    assert whole.rows == (("stable", "3", "37.5%"), ("lost", "1", "12.5%"))


@pytest.fixture(autouse=True)
def amplitude(monkeypatch: MonkeyPatch) -> None:
    """Let every rig have the amplitude that it states."""
    labels = {"amplitude_source": "file", "amplitude_origin": "stated"}
    monkeypatch.setattr("sonolube.rig.amplitude_labels", lambda rig: labels)


RIG: Any = SimpleNamespace(name="own", title="Own rig")
SWEPT = xr.Dataset(
    {
        "friction_ratio": ("point", [0.8, NAN, 0.35, 0.6]),
        "vibration_amplitude": ("point", [1e-6, NAN, 2e-6, 3e-6]),
        "power_to_supply": ("point", [1.0, NAN, 2.0, 9.0]),
        "charging_power": ("point", [1.0, NAN, NAN, 9.0]),
        "dissipated_power": ("point", [0.5, NAN, 2.0, 3.0]),
        "apparent_power": ("point", np.full(4, NAN)),
        "peak_current": ("point", np.full(4, NAN)),
        "status": ("point", [0, 1, 0, 0], {"flag_meanings": "stable failed"}),
        "reason": ("point", ["", "too fast", "", ""]),
    },
    attrs={"rig": "Own rig", "title": "Sweep of own"},
)
PLAN: Any = SimpleNamespace(
    content={"source": "measured"},
    digest="0123456789abcdef0123",
    rows=lambda first, last: {
        "drive.voltage_peak_to_peak": np.array([10.0, 15.0, 20.0, 30.0])[first:last],
        "drive.waveform": np.array(["sine", "sine", "square", "sine"])[first:last],
    },
)
BALANCE = results.power_balance(SWEPT.isel(point=2)) or ""
LEAST = [
    ("drive.voltage_peak_to_peak", "20 V"), ("drive.waveform", "square"), ("friction_ratio", "0.35"),
    ("vibration_amplitude", "2 um"), ("power_to_supply", "at least 2 W"), ("dissipated_power", "2 W"),
    ("energy", BALANCE),
]  # fmt: skip


def test_a_sweep_in_words_has_points_by_status_failures_and_the_point_of_least_friction() -> None:
    head, rows, failed, word, least = results.sweep_blocks(RIG, PLAN, SWEPT)
    assert head == "Own rig, 4 points"
    assert rows == Rows([("amplitude", "stated"), ("stable", "3"), ("failed", "1")])
    assert failed == "  without result: 1: too fast"
    assert (word, least) == ("least friction", Rows(LEAST))
    plain = SWEPT.assign_attrs(rig="Own rig")
    nothing = plain.assign(friction_ratio=("point", np.full(4, NAN)))
    assert results.sweep_blocks(RIG, PLAN, nothing)[0] == "Own rig, 4 points"
    assert "least friction" not in results.sweep_blocks(RIG, PLAN, nothing)
    assert results.sweep_object(RIG, PLAN, nothing)["least_friction"] == {}


def test_a_sweep_in_json_has_the_values_of_keys_and_the_outcomes_that_are_known() -> None:
    found = results.sweep_object(RIG, PLAN, SWEPT)
    assert found == {
        "rig": "Own rig", "amplitude_source": "file", "amplitude_origin": "stated", "points": 4,
        "statuses": {"stable": 3, "failed": 1}, "without_result": [{"reason": "too fast", "points": 1}],
        "least_friction": {
            "drive.voltage_peak_to_peak": 20.0, "drive.waveform": "square",
            "friction_ratio": {"value": approx(0.35), "unit": ""},
            "vibration_amplitude": {"value": approx(2e-6), "unit": "m"},
            "power_to_supply": {"value": approx(2.0), "unit": "W"},
            "dissipated_power": {"value": approx(2.0), "unit": "W"},
            "energy_balance": BALANCE,
            "at_least": ["power_to_supply"],
        },
    }  # fmt: skip


def test_the_page_of_a_sweep_has_the_number_of_results_and_tables_of_statuses_and_failures() -> None:
    page = results.sweep_page(RIG, PLAN, SWEPT)
    assert (page.name, page.title) == ("sweep", "Sweep of own")
    assert list(page.settings) == [
        ("rig", "Own rig (own)"), ("source of its numbers", "measured"), ("amplitude", "stated"),
    ]  # fmt: skip
    assert list(page.facts) == [
        ("points", "4, 3 with a result"),
        *((f"least friction: {name}", text) for name, text in LEAST),
        ("fingerprint", "0123456789abcdef"),
    ]
    statuses, failures = page.tables
    assert statuses.rows == (("stable", "3", "75.0%"), ("failed", "1", "25.0%"))
    assert (failures.heads, failures.rows) == (("reason", "points"), (("too fast", "1"),))
    assert len(results.status_tables(SWEPT, {})) == 1


def test_the_energy_of_the_best_point_is_labelled_in_words() -> None:
    full = SWEPT.assign(charging_power=("point", [1.0, NAN, 5.0, 9.0]))
    least = results.sweep_blocks(RIG, PLAN, full)[-1]
    assert isinstance(least, Rows)
    assert least.rows[-1][0] == "energy"
    assert least.rows[-1][1].startswith("5 W charges")
