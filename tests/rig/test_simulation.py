"""The multi-scale model of the tribometer: what the dissertation says of it, and what holds whatever the numbers."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytest import approx
from scipy.optimize import brentq
from scipy.special import i0

from sonolube.errors import InvalidInput
from sonolube.models.contact import normal_force, separation
from sonolube.models.friction import FRICTION_MODELS
from sonolube.rig import Simulation, read_rig, simulate, start_up
from sonolube.rig.responses import simulation_arrays

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


def tribometer(*changes: str) -> Simulation:
    return simulate(read_rig(RIGS / "tribometer.toml", changes=changes))


STILL = tribometer("drive.voltage_peak_to_peak=0V", "drive.voltage_offset=0V")
DRIVEN = tribometer()
GAUSSIAN = read_rig(RIGS / "tribometer.toml", changes=("contact.height_distribution=gaussian",))


def test_28_volts_give_the_amplitude_measured() -> None:
    assert DRIVEN.vibration.status == "periodic"
    assert DRIVEN.vibration.vibration_amplitude == approx(2.5e-6, rel=0.01)


@pytest.mark.parametrize("volts", [5.1, 10.3, 15.5, 20.7, 25.9])
def test_the_amplitude_is_proportional_to_the_voltage_as_table_4_1_prints(volts: float) -> None:
    amplitude = tribometer(f"drive.voltage_peak_to_peak={volts}V").vibration.vibration_amplitude
    assert amplitude == approx(2.31e-6 / 25.9 * volts, rel=0.01)


def test_the_tip_rises_until_the_mean_force_is_the_load_again() -> None:
    decay = 6e-6 / 3
    assert DRIVEN.vibration.mean_displacement == approx(
        decay * np.log(i0(DRIVEN.vibration.vibration_amplitude / decay)), rel=1e-3
    )


def test_without_voltage_nothing_moves_and_friction_is_what_it_was() -> None:
    assert STILL.vibration.vibration_amplitude == approx(0.0, abs=1e-15)
    assert STILL.friction.friction_ratio == approx(1.0, abs=1e-6)
    assert STILL.vibration.dissipated_power == approx(0.0, abs=1e-12)
    assert STILL.wear.wear_rate * 1e9 == approx(2.566e-2, abs=0.5e-5)  # mm3/m, D Table 3.4


def test_waveforms_move_the_tip_by_their_fundamentals_alone() -> None:
    # of a square, triangle and sawtooth of equal swing: 4/pi, 8/pi^2 and 2/pi of the sine's
    amplitudes = {
        name: tribometer(f"drive.waveform={name}").vibration.vibration_amplitude
        for name in ("square", "triangle", "sawtooth")
    }
    ratios = [amplitudes[name] / DRIVEN.vibration.vibration_amplitude for name in ("square", "triangle", "sawtooth")]
    assert ratios == approx([4 / np.pi, 8 / np.pi**2, 2 / np.pi], rel=0.01)


def test_waveforms_rank_as_section_3_3_5_says() -> None:
    ranked = [
        tribometer(f"drive.waveform={name}").friction.friction_ratio
        for name in ("square", "sine", "triangle", "sawtooth")
    ]
    assert ranked == sorted(ranked)


def test_friction_at_20_mm_per_second_lies_within_the_scatter_of_table_2_3() -> None:
    assert DRIVEN.friction.friction_force == approx(0.379, abs=0.041)


def test_faster_sliding_leaves_more_friction() -> None:
    ratios = [
        tribometer(f"sliding.sliding_speed={speed}mm/s").friction.friction_ratio for speed in (20.3, 40.6, 87, 500)
    ]
    assert np.all(np.diff(ratios) > 0)
    assert ratios[-1] == approx(1.0, abs=0.01)


def test_every_friction_model_finds_less_friction_at_20_mm_per_second() -> None:
    hard = [name for name, model in FRICTION_MODELS.items() if not model.for_soft_bodies]
    ratios = {name: tribometer(f"friction.model={name}").friction.friction_ratio for name in hard}
    assert ratios.pop("coulomb") == 1.0  # which knows no effect of vibration along the normal
    assert np.isnan(ratios.pop("dahl"))  # outside its range: the cube stiffens faster than its load
    assert all(0 < ratio < 1 for ratio in ratios.values()), ratios


def test_tension_in_a_stack_without_stated_preload_is_told() -> None:
    assert any("no preload is stated" in caveat for caveat in DRIVEN.caveats)


def test_a_voltage_beyond_the_stack_is_refused() -> None:
    with pytest.raises(InvalidInput, match="the drive goes up to 28 V; the highest admissible voltage is 20 V"):
        tribometer("stack.highest_voltage=20V")


def test_gaussian_heights_lift_the_tip_until_the_mean_force_is_the_load_again() -> None:
    result, contact = simulate(GAUSSIAN), GAUSSIAN.contact
    resting = separation(contact, normal_load=GAUSSIAN.normal_load)
    sine = result.vibration.vibration_amplitude * np.cos(2 * np.pi * (np.arange(256) + 0.5) / 256)
    risen = brentq(
        lambda rise: float(np.mean(normal_force(contact, separation=resting + rise + sine))) - GAUSSIAN.normal_load,
        0.0,
        result.vibration.vibration_amplitude,
    )
    assert result.vibration.mean_displacement == approx(risen, rel=1e-3)


def test_gaussian_heights_start_up_to_their_steady_vibration() -> None:
    result, started = simulate(GAUSSIAN), start_up(GAUSSIAN, duration=0.1)
    assert started.vibration_amplitude == approx(result.vibration.vibration_amplitude, rel=1e-3)
    assert started.mean_displacement == approx(result.vibration.mean_displacement, rel=0.01)


def test_a_rig_without_structure_vibrates_as_a_sine_of_its_stated_amplitude() -> None:
    result = simulate(read_rig(RIGS / "collar.toml"))
    assert result.vibration.vibration_amplitude == approx(2.17e-6, rel=1e-3)  # 77.55 nm/V at 28 V
    assert result.vibration.amplitude_source == "per-volt"
    assert result.vibration.dissipated_power is None


def test_the_arrays_of_a_simulation_hold_one_period_and_the_numbers_of_its_result() -> None:
    rig = read_rig(RIGS / "tribometer.toml")
    arrays = simulation_arrays(rig, DRIVEN)
    time, moved, pressed = (np.asarray(arrays[name].values) for name in ("time", "displacement", "normal_force"))
    assert time[0] == 0.0
    assert np.diff(time) == approx(np.full(time.size - 1, 1 / 22e3 / time.size))  # the next period begins at its end
    turned = np.exp(-2j * np.pi * 22e3 * time)
    assert 2 * abs(np.mean(moved * turned)) == approx(2.5e-6, rel=1e-3)
    assert np.mean(pressed) == approx(3.0, rel=1e-3)
    assert "displacement_along" not in arrays.variables
    numbers = {name: float(arrays[name].values) for name in ("friction_ratio", "friction_reduction", "charging_power")}
    assert numbers["friction_ratio"] + numbers["friction_reduction"] == approx(1.0)
    assert numbers["charging_power"] == approx(360e-9 * 28.0**2 * 22e3)  # D 1.9
    about = arrays.attrs
    assert (about["normal_load_N"], about["contact_loss_fraction"]) == approx((3.0, 0.0))
    assert about["mean_displacement_m"] == approx(np.mean(moved), rel=1e-3)
    assert float(normal_force(rig.contact, separation=about["separation_at_rest_m"])) == approx(3.0)
    assert (about["result"], about["interval"]) == ("simulation", "one period of the drive")
    assert about["assumptions"].splitlines()[0].startswith("vibration.normal_load: measured by")


@pytest.mark.parametrize(
    ("periods", "interval"),
    [
        (1, "one period of the drive"),
        (2, "2 periods of the drive, after which the motion repeats"),
        (0, "a stretch of a motion that does not repeat: aperiodic"),
    ],
)
def test_the_interval_of_a_motion_is_told_by_the_periods_after_which_it_repeats(periods: int, interval: str) -> None:
    motion = replace(DRIVEN.vibration, repetition_periods=periods, attractor="aperiodic")
    found = simulation_arrays(read_rig(RIGS / "tribometer.toml"), replace(DRIVEN, vibration=motion))
    assert found.attrs["interval"] == interval
    assert found.attrs["repetition_periods"] == periods
