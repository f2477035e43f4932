"""Control over the posterior: closed-form margins draw by draw, gains of known slopes, reach, cautious tuning."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from pytest import approx, fixture, mark, raises

import sonolube as sl
from sonolube.design.control import FrictionCharacteristic, Process, margins_at_gain, simc_gains, tuned_controller
from sonolube.design.control.friction_characteristic import (
    drawn_forces,
    linear_characteristic,
    predicted_characteristic,
)
from sonolube.design.control.predicted_loop import _cautious_tuning, drawn_gains, posterior_loop, predicted_margins
from sonolube.errors import InvalidInput
from sonolube.prediction.chances import ReductionChances, reduction_chances

RIGS = Path(__file__).parents[3] / "examples" / "rigs"
INTERVAL = 2e-4
PROCESS = Process(time_constant=3e-4, dead_time=1e-3, sample_interval=INTERVAL)
LEVELS = np.linspace(0.0, 2.5e-6, 6)
PLANT = FrictionCharacteristic(
    level=LEVELS, friction_force=np.linspace(1.0, 0.4, 6), vibration_amplitude=LEVELS
)  # 0.12 N a step


@fixture(scope="module")
def rig() -> sl.Rig:
    return sl.read_rig(RIGS / "tribometer.toml")


@fixture(scope="module")
def chances(rig: sl.Rig) -> ReductionChances:
    return reduction_chances(rig)


def closed_form(gain: float) -> tuple[float, float]:
    """Gain and phase margin of g k z^-d/(z - 1), k = T/(2 theta), at x = omega T: |L| = g k/(2 sin(x/2))."""
    d, k = PROCESS.dead_time_samples, INTERVAL / (2 * PROCESS.effective_dead_time)
    x = 2 * np.arcsin(gain * k / 2)
    return 2 * np.sin(np.pi / (2 * (2 * d + 1))) / (gain * k), np.pi / 2 - x * (d + 0.5)


def test_the_gain_is_that_of_the_slopes_where_the_friction_of_a_draw_falls_to_the_target() -> None:
    controller = tuned_controller(PLANT, PROCESS, level_maximum=LEVELS[-1])
    draws = np.array(
        [
            PLANT.friction_force,  # as expected
            [1.0, 0.94, 0.88, 0.82, 0.76, 0.7],  # half the slope, target out of reach
            [1.0, 0.76, 0.52, 0.28, 0.1, 0.05],  # twice the slope
            [0.6, 0.5, 0.4, 0.3, 0.2, 0.1],  # below the target without vibration
            [1.0, 0.9, 0.64, 0.65, 0.66, 0.6],  # falls to it, then rises again
        ]
    )
    found = drawn_gains(draws, PLANT, controller, friction_force=0.66)
    assert found == approx([1.0, np.nan, 2.0, np.nan, 0.26 / 0.12], nan_ok=True)
    straight = tuned_controller(linear_characteristic(PLANT), PROCESS, level_maximum=LEVELS[-1])
    assert drawn_gains(draws, PLANT, straight, friction_force=0.66) == approx(found, nan_ok=True)


def test_margins_over_the_posterior_are_those_of_its_draws_in_closed_form(
    rig: sl.Rig, chances: ReductionChances
) -> None:
    controller = tuned_controller(PLANT, PROCESS, level_maximum=LEVELS[-1])
    study: Any = SimpleNamespace(plant=PLANT, controller=controller, friction_force=0.75)
    found = posterior_loop(rig, study, chances)
    forces = drawn_forces(rig, PLANT, chances)
    assert found.force == approx(np.quantile(forces, [0.1, 0.5, 0.9], axis=0))
    gains, reached = [], 0
    for force in forces:  # one rig after another, by hand
        if not force.min() <= 0.75 < force[0]:
            continue
        cell = int(np.argmax(force <= 0.75))
        reached += 1
        gains.append((force[cell - 1] - force[cell]) / 0.12)
    assert found.target_chance == approx(reached / len(forces))
    margins = np.array([closed_form(gain) for gain in gains])
    for place, level in enumerate((0.9, 0.5, 0.1)):  # margins fall with the gain
        gain_margin, phase_margin = np.quantile(margins, level, axis=0)
        assert found.margins[place].gain_margin == approx(gain_margin, rel=0.01)
        assert found.margins[place].phase_margin == approx(phase_margin, abs=0.01)


@mark.parametrize("gain", [1.3, 2.5, 40.0])
def test_the_cautious_tuning_has_the_margins_of_the_rule_at_the_highest_gain(gain: float) -> None:
    found = _cautious_tuning(PROCESS, gain, None)
    gain_margin, phase_margin = closed_form(1.0)
    assert found.margins.gain_margin == approx(gain_margin, rel=1e-4)
    assert found.margins.phase_margin == approx(phase_margin, abs=1e-4)
    delay = PROCESS.effective_dead_time
    assert found.closed_loop_time + delay == approx(2 * gain * delay)
    assert found.given_up == approx(1 - 1 / gain)


def test_a_gain_below_one_asks_for_no_slower_loop() -> None:
    found = _cautious_tuning(PROCESS, 0.8, 2e-3)
    assert (found.closed_loop_time, found.given_up) == approx((2e-3, 0.0))
    assert found.gains == simc_gains(PROCESS, closed_loop_time=2e-3)


def test_a_slow_process_keeps_at_least_the_margins_of_the_rule() -> None:
    slow = replace(PROCESS, time_constant=0.1)
    usual = margins_at_gain(slow, simc_gains(slow), gain=1.0)
    found = _cautious_tuning(slow, 3.0, None).margins
    assert found.gain_margin >= usual.gain_margin * (1 - 1e-6)
    assert found.phase_margin >= usual.phase_margin - 1e-6


def test_the_least_friction_within_reach_is_the_predicted_force_at_the_highest_level(
    rig: sl.Rig, chances: ReductionChances
) -> None:
    one = sl.predict(rig)["friction_force"].quantile([0.1, 0.5, 0.9]).values
    many = drawn_forces(rig, PLANT, reduction_chances(rig, draws=4000))
    assert np.quantile(many[:, -1], [0.1, 0.5, 0.9]) == approx(one, rel=1e-3)
    forces = drawn_forces(rig, PLANT, chances)
    assert forces[:, 0] == approx(chances.intrinsic_coefficients() * rig.normal_load)
    table = predicted_characteristic(rig, PLANT, chances)
    assert table.highest_force == approx(rig.friction_coefficient * rig.normal_load)
    assert np.all(np.diff(table.friction_force) < 0)
    with raises(InvalidInput, match="the amplitude along the friction characteristic is not known"):
        drawn_forces(rig, replace(PLANT, vibration_amplitude=None), chances)


def test_an_unstable_loop_has_no_sensitivity_peak_and_the_others_rise_with_the_gain() -> None:
    gains = simc_gains(PROCESS)
    margins = tuple(margins_at_gain(PROCESS, gains, gain=each) for each in (0.5, 1.0, 40.0))
    found: Any = SimpleNamespace(margins=margins)
    peaks = predicted_margins(found)["sensitivity_peak"]
    assert 1 < peaks[0] < peaks[1]
    assert np.isnan(peaks[2])
    at = predicted_margins(found)["gain_margin"]
    assert [at[0], at[2]] == approx([2 * at[1], at[1] / 40])
    assert predicted_margins(SimpleNamespace(margins=())) == {}  # type: ignore[arg-type]
