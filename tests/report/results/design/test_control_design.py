"""Friction control in words: target, drive, delays, gains, margins, responses, energy, resonance and stick-slip."""

from math import pi
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pytest import MonkeyPatch, approx
from tests.names import names_of

from sonolube.report.results.design import control_design as results
from sonolube.rig import AMPLITUDE, VOLTAGE

RIG: Any = SimpleNamespace(title="Own rig", friction_model=SimpleNamespace(name="kinematic"))
SETTINGS: Any = SimpleNamespace(feed_forward="model")


def closed_loop(*, level: float, error: float, shift: float, electrical: bool = True) -> Any:
    """Run of ten samples whose last two, the last fifth, have a level and an error."""
    frequency = np.linspace(22e3, 22e3 + shift, 10)
    return SimpleNamespace(
        time=np.arange(10.0),
        level=np.array([0.0] * 8 + [level - 1, level + 1]),
        friction_force=np.array([9.0] * 8 + [1 + error, 1 - error]),
        setpoint=np.ones(10),
        frequency=frequency,
        resonance_frequency=frequency,
        electrical_energy=np.ones(10) if electrical else None,
    )


def design(**changes: Any) -> Any:
    """Loop of 5 kHz with five samples of delay."""
    values: dict[str, Any] = {
        "friction_force": 1.25,
        "plant": SimpleNamespace(
            quantity=VOLTAGE,
            highest_force=3.0,
            lowest_force=0.5,
            level=np.linspace(0, 30, 61),
            friction_force=3.0 - np.linspace(0, 2.5, 61),
        ),
        "mode": SimpleNamespace(time_constant=0.8e-3, frequency=22e3),
        "controller": SimpleNamespace(
            process=SimpleNamespace(dead_time_samples=5, sample_interval=0.2e-3),
            gains=SimpleNamespace(proportional_gain=0.4321, integral_time=2.5e-3),
        ),
        "tracker": None,
        "plant_gain": 1.234,
        "margins": SimpleNamespace(gain_margin=3.5, phase_margin=pi / 3, delay_margin=1.5e-3, sensitivity_peak=1.59),
        "level_maximum": 27.5,
        "limit": "voltage",
        "run": closed_loop(level=20.0, error=0.01, shift=-150.0),
        "fixed_frequency_run": None,
        "response": SimpleNamespace(rise_time=3e-3, settling_time=None, overshoot=0.042, tracking_error=0.005),
        "energy": SimpleNamespace(amplifier_energy=0.5, electrical_energy=0.2, saved_work=0.015),
    }
    return SimpleNamespace(**(values | changes))


def rejection(step: float = 0.1, back: float | None = 4e-3) -> Any:
    return SimpleNamespace(friction_step=step, peak_deviation=0.12, recovery_time=back)


SUPPRESSION: Any = SimpleNamespace(
    damping=(-2.5, 1.5),
    still=SimpleNamespace(stick_slip_amplitude=0.6, stick_fraction=0.43),
    vibrating=SimpleNamespace(stick_slip_amplitude=0.02, stick_fraction=0.01),
)


@pytest.fixture(autouse=True)
def amplitude(monkeypatch: MonkeyPatch) -> None:
    """Let every rig have the amplitude that it states, and caveats of its own."""
    monkeypatch.setattr("sonolube.rig.amplitude_labels", lambda rig: {"amplitude_origin": "stated"})
    monkeypatch.setattr(results, "operating_caveats", lambda rig: ["own"])


def test_the_facts_of_a_loop_have_delay_margins_and_step_in_words() -> None:
    assert dict(results.facts(SETTINGS, design(), rejection(), None)) == {
        "target friction": "1.25 N of 3 N; least within reach 0.5 N",
        "drive": "up to 27.5 V peak to peak, by the amplifier's voltage",
        "process": "vibration 800 us, delay 1 ms, interval 200 us",
        "controller": "K_c 0.432, tau_I 2.5 ms (SIMC), feed-forward model",
        "margins": "gain 3.50 where real friction changes 1.23 times as expected, phase 60.0 deg, delay 1.5 ms,"
        " Ms 1.59",
        "step": "rise 3 ms, within 5 % after never, overshoot 4.2 %",
        "disturbance": "10 % more friction: at most 120 mN off the target, back within 5 % of that after 4 ms",
        "tracking error": "5 mN rms once settled",
        "energy": "amplifier 500 mJ for the capacitance alone (D 1.9), heat of the motion 200 mJ,"
        " work of friction saved 15 mJ",
    }


def test_a_fall_of_friction_that_is_not_settled_and_energies_that_are_not_known_are_said_so() -> None:
    quiet = SimpleNamespace(amplifier_energy=None, electrical_energy=0.2, saved_work=0.015)
    facts = dict(results.facts(SETTINGS, design(energy=quiet), rejection(-0.05, None), None))
    assert facts["disturbance"] == "5 % less friction: at most 120 mN off the target, not back"
    assert facts["energy"] == "amplifier heat of the motion 200 mJ, work of friction saved 15 mJ"
    nothing = SimpleNamespace(amplifier_energy=None, electrical_energy=None, saved_work=0.015)
    assert dict(results.facts(SETTINGS, design(energy=nothing), rejection(), None))["energy"] == (
        "work of friction saved 15 mJ"
    )


def test_resonance_and_stick_slip_are_compared_with_and_without() -> None:
    fixed = design(fixed_frequency_run=closed_loop(level=26.0, error=0.3, shift=-150.0))
    facts = dict(results.facts(SETTINGS, fixed, rejection(), SUPPRESSION))
    assert (
        facts["resonance"] == "moves by -150 Hz; tracked 20 V and 10 mN rms, at a fixed frequency 26 V and 300 mN rms"
    )
    assert facts["stick-slip without"] == "600 mN, sticks 43 % of the time, damping of sliding -2.5 N s/m"
    assert facts["stick-slip with"] == "20 mN, sticks 1 % of the time, damping of sliding 1.5 N s/m"


def test_a_commanded_amplitude_is_the_set_point_of_a_generator() -> None:
    plant = SimpleNamespace(
        quantity=AMPLITUDE, highest_force=3.0, lowest_force=0.5, level=np.linspace(0, 3e-6, 5),
        friction_force=np.linspace(3, 1, 5),
    )  # fmt: skip
    held = design(
        plant=plant, level_maximum=2.5e-6, run=closed_loop(level=2e-6, error=0.01, shift=0.0, electrical=False)
    )
    assert dict(results.facts(SETTINGS, held, rejection(), None))["drive"] == (
        "amplitude up to 2.5 um zero to peak, as the set point of a generator"
    )
    table = results.lookup_table(held, "no prediction")
    assert table.title == "Friction by the rig's model, at 5 of the map's 5 amplitudes"
    assert table.heads == ("amplitude, zero to peak", "friction by the model")
    assert table.rows[1] == ("750 nm", "2.5 N")
    assert any("the rig has no voltage" in each for each in results.caveats(RIG, held))
    found = results.control_object(RIG, SETTINGS, held, rejection(), None)
    assert found["amplitude_maximum"] == {"value": 2.5e-6, "unit": "m"}
    assert not {"amplifier_energy", "electrical_energy"} & set(found)
    assert found["saved_work"]["value"] == approx(0.015)


def test_the_lookup_table_has_a_dozen_rows_with_both_ends() -> None:
    table = results.lookup_table(design(), "no prediction")
    assert table.title == "Friction by the rig's model, at 12 of the map's 61 voltages"
    assert len(table.rows) == 12
    assert (table.rows[0], table.rows[-1]) == (("0 V", "3 N"), ("30 V", "500 mN"))


def test_a_loop_in_json_has_its_delay_margins_and_a_summary_in_words() -> None:
    found = results.control_object(RIG, SETTINGS, design(), rejection(), SUPPRESSION)
    assert found["rig"] == "Own rig"
    assert found["dead_time"] == {"value": approx(1e-3), "unit": "s"}
    assert found["voltage_maximum"] == {"value": 27.5, "unit": "V"}
    assert found["time_constant"] == {"value": 0.8e-3, "unit": "s"}
    assert found["amplifier_energy"] == {"value": 0.5, "unit": "J"}
    assert found["electrical_energy"] == {"value": 0.2, "unit": "J"}
    assert (found["feed_forward"], found["limit"], found["friction_model"]) == ("model", "voltage", "kinematic")
    texts = {each["label"]: each["text"] for each in found["summary"]}
    assert texts["Settling time"] == "never"
    assert texts["Overshoot over the step"] == "4.2 %"
    assert texts["Phase margin"] == "60 deg"
    assert texts["Recovery time after a disturbance"] == "4 ms"
    assert found["stick_slip"]["with"] == {
        "stick_slip_amplitude": {"value": 0.02, "unit": "N"}, "stick_fraction": 0.01,
        "damping": {"value": 1.5, "unit": "N s/m"},
    }  # fmt: skip
    assert found["stick_slip"]["without"]["damping"]["value"] == approx(-2.5)
    assert "stick_slip" not in results.control_object(RIG, SETTINGS, design(), rejection(), None)


@pytest.mark.parametrize(
    ("margin", "verdict"), [(1.7, None), (1.69, "is near instability"), (1.0, "is near instability"),
                            (0.99, "is unstable")],
)  # fmt: skip
def test_a_gain_margin_below_that_of_textbooks_is_a_caveat(margin: float, verdict: str | None) -> None:
    margins = SimpleNamespace(gain_margin=margin)
    found = results.caveats(RIG, design(margins=margins))
    text = (
        f"the loop {verdict} at the target, where real friction changes 1.23 times as the controller expects: ask for"
        " a slower closed loop"
    )
    assert found == (["own"] if verdict is None else ["own", text])


def test_a_drive_at_the_end_of_its_band_has_lost_the_resonance(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(results, "capture_limit", lambda mode: mode.frequency + 250.0)
    band = SimpleNamespace(lowest_frequency=21850.0, highest_frequency=23e3)
    assert results.caveats(RIG, design(tracker=band)) == [
        "own",
        "the drive ends at 21.85 kHz, the end of its band, and has lost the resonance: it returns to it from up to"
        " 250 Hz above it; warm slower or keep the drive on",
    ]


def test_the_holder_is_said_with_stiffness_mass_in_grams_damping_and_static_friction(monkeypatch: MonkeyPatch) -> None:
    for name, value in (("STIFFNESS", 2e3), ("MASS", 0.025), ("DAMPING_RATIO", 0.02)):
        monkeypatch.setattr(names_of(results).holder, f"HOLDER_{name}", value)
    monkeypatch.setattr(names_of(results).holder, "STATIC_FRICTION_FACTOR", 1.3)
    assert results.holder_text() == (
        "a holder of 2 kN/m and 25 g, damping ratio 0.02; static friction 1.3 times that of sliding, falling over the"
        " sliding speed"
    )
