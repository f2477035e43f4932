"""Each channel of the virtual rig with one disturbance at a time, against the law that it is said to follow."""

from dataclasses import replace
from math import exp, pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from pytest import raises
from tests.same import approx

from sonolube.checks import Floats
from sonolube.facts.protocol import PROMPT_DURATIONS, Prompt
from sonolube.laboratory.devices import DeviceError, DriveSetting
from sonolube.laboratory.heating_assumptions import HeatingAssumptions
from sonolube.laboratory.virtual_tribometer import UNDISTURBED, Disturbances
from sonolube.laboratory.virtual_tribometer.simulation import VirtualRig
from sonolube.models.dynamics.structure import electrical_admittance
from sonolube.rig import Rig, read_rig

EXAMPLES = Path(__file__).parents[3] / "examples" / "rigs"
RIG = read_rig(EXAMPLES / "power_map.toml")
DIAMETER = 0.028
DRIVE = DriveSetting(voltage_peak_to_peak=25.9, frequency=22e3, voltage_offset=12.95)
QUICK = replace(UNDISTURBED, motor_time=1e-6, holder_stiffness=1e9)  # at speed, and sliding, at once


def virtual(sizes: Disturbances = QUICK, *, rig: Rig = RIG, seed: int = 0) -> VirtualRig:
    return VirtualRig(rig, seed, sizes, HeatingAssumptions(), DIAMETER, False)


def value(rig: VirtualRig, name: str) -> float:
    return float(rig.truth()[name])


def read(rig: VirtualRig, samples: int) -> Floats:
    return np.asarray(rig.read(samples).values[:, 0])


def slide(rig: VirtualRig, *names: str, speed: float = 0.0655, rate: float = 1000.0) -> None:
    rig.start(names, rate)
    rig.turn(speed / (pi * DIAMETER))


def attend(rig: VirtualRig, *names: str, rate: float, **prompt: str) -> None:
    """Attend to a prompt while nothing is sampled, and sample again."""
    rig.stop()
    rig.attend(Prompt.model_validate({"text": "Look.", **prompt}))
    rig.start(names, rate)


@pytest.fixture(scope="module")
def bare(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    """The rig without stack and structure."""
    text = (EXAMPLES / "power_map.toml").read_text(encoding="utf-8")
    path = tmp_path_factory.mktemp("rigs") / "bare.toml"
    without = text.partition("[stack]")[0] + "[uncertainty]" + text.partition("[uncertainty]")[2]
    path.write_text("\n".join(line for line in without.splitlines() if not line.startswith('"structure"')))
    return read_rig(path)


def test_the_gauge_reaches_five_times_the_load_and_sixty_newton_at_least() -> None:
    ranges = {name: (each.lowest, each.highest) for name, each in virtual().channels.items()}
    assert ranges == {
        "friction_force": (-60.0, 60.0),
        "normal_load": (-60.0, 60.0),
        "voltage": (-400.0, 400.0),  # twice the 200 V of the amplifier
        "voltage_peak_to_peak": (-1.0, 800.0),
        "current": (-100.0, 100.0),
        "temperature": (173.0, 773.0),
        "gaussmeter": (-0.3, 0.3),
        "displacement": (-1e-3, 1e-3),
    }
    assert virtual(rig=replace(RIG, normal_load=20.0)).channels["friction_force"].highest == 100.0
    assert virtual().channels["gaussmeter"].quantity == "magnetic_flux_density"


def test_blocks_count_on_from_zero_and_the_clock_goes_on_by_the_samples() -> None:
    rig = virtual()
    with raises(DeviceError, match="call start first"):
        rig.read(1)
    rig.start(["temperature", "normal_load"], 100.0)
    first, second = rig.read(30), rig.read(20)
    assert (first.first_sample, second.first_sample, second.sample_rate) == (0, 30, 100.0)
    assert second.values.shape == (20, 2)
    assert second.values[0] == approx([294.15, 5.0])
    assert rig.clock() == approx(0.5)
    rig.stop()
    with raises(DeviceError, match="nothing is sampled"):
        rig.read(1)
    rig.start(["temperature"], 10.0)
    assert (rig.read(5).first_sample, rig.clock()) == (0, approx(1.0))


def test_the_load_wobbles_once_and_twice_a_turn_about_its_mean_and_friction_with_it() -> None:
    rig = virtual(replace(QUICK, wobble_1=0.06, wobble_2=0.02))
    slide(rig, "normal_load", "friction_force", speed=2 * pi * DIAMETER)  # two turns a second
    rig.read(1)
    load, force = rig.read(10_000).values.T  # twenty turns
    spectrum = np.abs(np.fft.rfft(load)) / load.size
    shares = 2 * spectrum[[20, 40]] / 5.0
    assert spectrum[0] == approx(5.0)
    assert shares == approx([value(rig, "wobble_1"), value(rig, "wobble_2")], rel=1e-4)
    spectrum[[0, 20, 40]] = 0
    assert spectrum.max() < 1e-5
    assert force == approx(value(rig, "friction_coefficient") * load)


def test_the_phases_of_the_wobble_and_the_drift_are_other_ones_for_another_specimen() -> None:
    loads = []
    for seed in (0, 1):
        rig = virtual(replace(QUICK, wobble_1=0.06, drift_rate=1e-3), seed=seed)
        rig.start(["normal_load"], 100.0)
        loads.append(rig.read(1).values[0, 0])
        assert value(rig, "force_drift_rate") != 0
    assert loads[0] != approx(loads[1], rel=1e-4)


def test_vibration_lowers_the_friction_with_its_own_time_constant() -> None:
    rig = virtual(replace(QUICK, vibration_time=0.05))
    slide(rig, "friction_force")
    without = read(rig, 100)[-1]
    rig.drive(DRIVE)
    force = read(rig, 1000)
    ratio = float(rig.truth()["friction_ratio"][-1])
    time = np.arange(1000) / 1000.0
    assert without == approx(value(rig, "friction_coefficient") * 5.0)
    assert force == approx(without * (ratio + (1 - ratio) * np.exp(-time / 0.05)))
    rig.drive(None)
    assert read(rig, 1000)[[0, -1]] == approx([ratio * without, without])


def test_the_pin_is_drawn_as_by_its_spring_until_it_slides_at_every_start_and_not_at_a_change_of_speed() -> None:
    rig = virtual(replace(QUICK, holder_stiffness=50.0, static_share=0.4))
    level = value(rig, "friction_coefficient") * 5.0
    peak = level * (1 + value(rig, "static_share"))
    for _ in range(2):
        slide(rig, "friction_force", speed=0.1)
        force, spring = read(rig, 2000), 50.0 * 0.1 * np.arange(2000) / 1000.0
        rising = spring < 0.999 * peak
        assert force[rising] == approx(spring[rising], abs=2e-5)
        slipping = force[spring > 1.001 * peak]
        assert slipping.mean() == approx(level, rel=0.2)
        rig.turn(0.2 / (pi * DIAMETER))
        assert read(rig, 10).min() > 0.2 * level  # it slides on
        rig.turn(0.0)
        assert read(rig, 100)[1:] == approx(0.0, abs=1e-6)  # at rest


def test_friction_is_run_in_by_the_distance_under_load_and_not_while_the_pin_is_lifted() -> None:
    rig = virtual(replace(QUICK, run_in_share=0.3, run_in_distance=0.4))
    slide(rig, "friction_force", speed=0.1, rate=100.0)
    first = read(rig, 300)  # 0.3 m
    share, length = value(rig, "run_in_share"), value(rig, "run_in_distance")
    steady = value(rig, "friction_coefficient") * 5.0
    expected = steady * (1 + share * np.exp(-0.1 * np.arange(300) / 100 / length))
    assert first[1:] == approx(expected[1:], rel=1e-4)  # at sample 0 it stands
    for _ in range(2):
        rig.turn(0.0)
        attend(rig, "friction_force", rate=100.0, normal_load="0 N")
        rig.turn(0.1 / (pi * DIAMETER))
        assert read(rig, 200) == approx(0.0)
        rig.turn(0.0)
        attend(rig, "friction_force", rate=100.0, normal_load="5 N")
    rig.turn(0.1 / (pi * DIAMETER))
    read(rig, 1)
    assert read(rig, 1)[0] == approx(steady * (1 + share * exp(-0.301 / length)), rel=1e-4)


def test_a_prompt_takes_its_time_since_the_outputs_were_switched_off_and_sets_the_load() -> None:
    rig, lasts = virtual(), PROMPT_DURATIONS["load"]
    rig.start(["normal_load"], 10.0)
    read(rig, 50)
    attend(rig, "normal_load", rate=10.0, task="load", normal_load="8 N")
    assert rig.clock() == approx(5.0 + lasts)
    rig.drive(None)
    assert read(rig, 20) == approx(8.0)  # which were watched meanwhile
    attend(rig, "normal_load", rate=10.0, task="load")
    assert rig.clock() == approx(5.0 + 2 * lasts)
    assert read(rig, 1) == approx(8.0)
    rig.drive(None)
    began = rig.clock()
    read(rig, round(10 * lasts) + 100)
    attend(rig, "normal_load", rate=10.0, task="load")
    assert rig.clock() == approx(began + lasts + 10.0)  # it had more time than it needs
    truth = rig.truth()
    assert truth["normal_load"].to_numpy() == approx(8.0)
    assert truth["start_time"].to_numpy()[0] == approx(5.0 + lasts)


def test_a_drift_counts_from_the_last_zero_of_the_gauge() -> None:
    rig = virtual(replace(QUICK, drift_rate=1e-2))
    rig.start(["friction_force"], 10.0)
    rate = value(rig, "force_drift_rate")
    assert read(rig, 30) == approx(rate * np.arange(30) / 10)
    attend(rig, "friction_force", rate=10.0)
    assert read(rig, 30) == approx(rate * np.arange(30) / 10)


def test_a_pull_acts_on_force_and_deflection_from_its_prompt_to_the_next() -> None:
    rig = virtual(replace(QUICK, deflected_stiffness=4e6))
    rig.start(["friction_force", "displacement"], 10.0)
    rig.read(7)
    attend(rig, "friction_force", "displacement", rate=10.0, applied_force="10 N")
    pulled = rig.read(1500).values
    assert pulled[[150, 450, 1350], 0] == approx([2.0, 4.0, 10.0])  # the middle of loops of 30 s
    assert pulled[:, 1] == approx(pulled[:, 0] / 4e6)
    attend(rig, "friction_force", "displacement", rate=10.0)
    assert rig.read(400).values == approx(0.0)


def test_the_deflection_is_that_of_friction_over_the_stiffness_less_the_play() -> None:
    rig = virtual(replace(QUICK, deflected_stiffness=4e6, wobble_1=0.06))
    slide(rig, "friction_force", "displacement")
    rig.read(1)
    force, bent = rig.read(2000).values.T
    assert bent == approx(force / 4e6)
    loose = virtual(replace(QUICK, deflected_stiffness=4e6, deflection_play=3e-8))
    slide(loose, "displacement")
    loose.drive(DRIVE)
    loose.drive(None)
    assert read(loose, 500)[-1] == approx(value(loose, "friction_coefficient") * 5 / 4e6 - 3e-8)
    loose.turn(0.0)
    assert read(loose, 50)[-1] == approx(3e-8)  # it stays behind by the play on the other side


def test_a_deflection_within_the_play_shows_nothing_and_a_loop_is_as_wide_as_twice_its_half() -> None:
    # Friction of some 1 N bends the holder of 4 N/um by 0.25 um; the wobble bends it by 6 % of that to and fro.
    held = virtual(replace(QUICK, deflected_stiffness=4e6, wobble_1=0.06, deflection_play=5e-6))
    slide(held, "friction_force", "displacement")
    force, shown = held.read(2000).values.T
    assert np.ptp(force) > 0.05
    assert shown == approx(0.0, abs=1e-15)
    loose = virtual(replace(QUICK, deflected_stiffness=4e6, wobble_1=0.06, deflection_play=2e-9))
    slide(loose, "friction_force", "displacement")
    force, shown = loose.read(4000).values[2000:].T
    behind = force / 4e6 - shown
    assert (behind.max(), behind.min()) == (approx(2e-9), approx(-2e-9))


def test_the_play_of_the_gauge_goes_on_from_block_to_block() -> None:
    rig = virtual(replace(QUICK, hysteresis=0.3))
    slide(rig, "friction_force")
    rig.read(1)
    level = value(rig, "friction_coefficient") * 5
    assert read(rig, 5) == approx(level - 0.3)
    rig.turn(0.0)
    read(rig, 1)
    assert read(rig, 5) == approx(0.3, abs=1e-6)
    assert read(rig, 5) == approx(0.3, abs=1e-6)


def deviation(sizes: Disturbances, name: str, *, drive: DriveSetting | None = None) -> float:
    """Standard deviation of a channel of a standing rig, or of a sliding one by its friction."""
    rig = virtual(sizes)
    rig.start([name], 1000.0)
    if name == "friction_force":
        rig.turn(0.0655 / (pi * DIAMETER))
    rig.drive(drive)
    rig.read(1000)
    return float(np.std(read(rig, 20_000)))


def test_the_noise_of_each_channel_has_the_deviation_that_is_stated() -> None:
    level = value(virtual(), "friction_coefficient") * 5
    assert deviation(replace(QUICK, sensor_noise=0.03), "normal_load") == approx(0.03, rel=0.03)
    assert deviation(replace(QUICK, sensor_noise=0.03), "friction_force") == approx(0.03, rel=0.03)
    assert deviation(replace(QUICK, temperature_noise=0.05), "temperature") == approx(0.05, rel=0.03)
    assert deviation(replace(QUICK, current_noise=1e-4), "current") == approx(1e-4, rel=0.03)
    assert deviation(replace(QUICK, displacement_noise=1e-7), "displacement") == approx(1e-7, rel=0.03)
    assert deviation(replace(QUICK, flux_noise=0.2), "gaussmeter") == approx(0.2 * 0.01, rel=0.03)
    assert deviation(replace(QUICK, voltage_noise=2e-3), "voltage") == approx(2e-3, rel=0.03)
    monitor = replace(QUICK, voltage_noise=2e-3)
    assert deviation(monitor, "voltage_peak_to_peak") == approx(2e-3, rel=0.03)
    assert deviation(monitor, "voltage_peak_to_peak", drive=DRIVE) == approx(2e-3 * 25.9, rel=0.03)
    slow = replace(QUICK, friction_noise=0.05, noise_time=5e-3)
    assert deviation(slow, "friction_force") == approx(0.05 * level, rel=0.06)
    ringing = virtual(replace(QUICK, ringing=0.05))
    assert deviation(replace(QUICK, ringing=0.05), "friction_force") == approx(
        value(ringing, "ringing") * level, rel=0.15
    )


def test_slow_fluctuations_forget_themselves_in_their_correlation_time() -> None:
    rig = virtual(replace(QUICK, friction_noise=0.05, noise_time=0.02))
    slide(rig, "friction_force")
    rig.read(100)
    force = read(rig, 100_000)
    force -= force.mean()
    assert np.mean(force[20:] * force[:-20]) / np.var(force) == approx(exp(-1), abs=0.05)


def test_noise_goes_on_where_sampling_begins_anew() -> None:
    whole, parts = virtual(replace(QUICK, sensor_noise=0.03)), virtual(replace(QUICK, sensor_noise=0.03))
    for rig in (whole, parts):
        rig.start(["normal_load"], 1000.0)
    expected, found = read(whole, 20), read(parts, 8)
    parts.start(["normal_load"], 500.0)
    assert np.concatenate([found, read(parts, 12)]) == approx(expected)


def wave(rig: VirtualRig, frequency: float, rate: float) -> Floats:
    """Complex amplitudes of the channels of a rig at a frequency, over whole periods."""
    values = rig.read(20_000).values
    turning = np.exp(-2j * pi * frequency * np.arange(20_000) / rate)
    return np.asarray(2 * turning @ values / 20_000)


def test_the_voltage_has_amplitude_offset_and_the_frequency_of_the_generators_clock() -> None:
    rig = virtual(replace(QUICK, clock_error=0.01))
    rig.start(["voltage", "voltage_peak_to_peak"], 200e3)
    rig.drive(replace(DRIVE, frequency=1e3, voltage_offset=-4.0))
    volts, monitor = rig.read(20_000).values.T
    turning = np.exp(-2j * pi * 1010.0 * np.arange(20_000) / 200e3)
    assert abs(2 * turning @ volts / 20_000) == approx(12.95, rel=1e-6)
    assert volts.mean() == approx(-4.0, abs=1e-9)
    assert monitor == approx(25.9)
    rig.drive(None)
    assert rig.read(100).values == approx(0.0)
    noisy = virtual(replace(QUICK, voltage_noise=0.1))
    noisy.start(["voltage"], 200e3)
    noisy.drive(replace(DRIVE, voltage_peak_to_peak=6.0, frequency=1e3, waveform="square", voltage_offset=0.0))
    assert np.std(np.abs(read(noisy, 20_000))) == approx(0.1 * 3.0, rel=0.05)


def test_the_current_is_that_of_the_admittance_of_the_structure_for_a_sine() -> None:
    assert RIG.structure is not None
    rig, frequency = virtual(), 22e3
    rig.start(["voltage", "current"], 1e6)
    rig.drive(replace(DRIVE, frequency=frequency))
    volts, current = wave(rig, frequency, 1e6)
    expected = complex(electrical_admittance(RIG.structure, frequency=np.array([frequency]))[0])
    assert current / volts == approx(expected, rel=1e-6)


def test_the_current_of_a_capacitance_is_its_charge_by_the_slope_of_the_voltage(bare: Rig) -> None:
    capacitance = 360e-9
    alone = virtual(rig=bare)
    alone.start(["voltage", "current"], 200e3)
    alone.drive(replace(DRIVE, frequency=1e3))
    volts, current = wave(alone, 1e3, 200e3)
    assert current / volts == approx(2j * pi * 1e3 * capacitance, rel=1e-4)
    for rig in (virtual(), alone):  # also of a rig with a structure
        rig.start(["voltage", "current"], 200e3)
        rig.drive(replace(DRIVE, frequency=1e3, waveform="triangle"))
        volts, current = rig.read(2000).values.T
        rising = np.gradient(volts) > 0
        steep = 2 * 25.9 * 1e3 * capacitance  # peak to peak in half a period
        assert np.sort(np.abs(current))[40:] == approx(steep)  # but at the corners
        assert np.mean((current > 0) == rising) > 0.98


def test_each_magnet_gives_a_pulse_of_ten_millitesla_a_turn() -> None:
    rig = virtual(replace(QUICK, magnets=3))
    slide(rig, "gaussmeter", speed=0.5 * pi * DIAMETER)
    flux = read(rig, 4000)  # two turns of three magnets
    peaks = np.flatnonzero((flux[1:-1] >= flux[:-2]) & (flux[1:-1] > flux[2:]))
    assert len(peaks) == 6
    assert flux.max() == approx(0.01, rel=1e-3)
    assert flux[flux > 0.005].size / 4000 == approx(0.06 * 2 * sqrt(2 * np.log(2)), abs=0.01)


def test_distance_and_wear_add_up_over_changes_of_speed_drive_and_load() -> None:
    rig = virtual()
    slide(rig, "friction_force", speed=0.05)
    rig.read(2000)
    rig.turn(0.1 / (pi * DIAMETER))
    rig.read(3000)
    first = rig.truth()
    assert float(first["sliding_distance"]) == approx(0.05 * 2 + 0.1 * 3, rel=1e-4)
    rates = first["wear_rate"].to_numpy()
    assert rates == approx(rates[0])
    assert float(first["wear_volume"]) == approx(rates[0] * 0.4, rel=1e-4)
    rig.drive(DRIVE)
    rig.read(2000)
    last = rig.truth()
    vibrated = float(last["wear_rate"][-1])
    assert vibrated != approx(rates[0], rel=0.01)
    assert float(last["wear_volume"]) == approx(rates[0] * 0.4 + vibrated * 0.2, rel=1e-4)
    assert last["sliding_speed"].to_numpy() == approx([0.05, 0.1, 0.1])
    assert last["start_time"].to_numpy() == approx([0.0, 2.0, 5.0])
    assert last["voltage_peak_to_peak"].to_numpy() == approx([0.0, 0.0, 25.9])


def test_stick_slip_stands_in_the_truth_and_in_the_force_without_vibration_alone() -> None:
    sizes = replace(QUICK, static_share=0.2, holder_stiffness=2e3, holder_mass=2e-3, holder_damping_ratio=0.02)
    rig = virtual(sizes)
    slide(rig, "friction_force", speed=2e-3)
    rig.read(2000)
    slips = read(rig, 4000)
    truth = rig.truth()
    excess = value(rig, "static_share") * value(rig, "friction_coefficient") * 5.0
    rise, omega = 2 * excess / (2e3 * 2e-3), sqrt(2e3 / 2e-3)
    slip = 2 / omega * (pi - np.arctan(omega * excess / (2e3 * 2e-3)))
    assert float(truth["stick_slip_frequency"][0]) == approx(1 / (rise + slip))
    assert float(truth["stick_slip_fall"][0]) == approx(2 * np.hypot(excess, 2e3 * 2e-3 / omega))
    assert float(truth["stick_slip_fraction"][0]) == 1.0
    assert np.ptp(slips) == approx(float(truth["stick_slip_fall"][0]), rel=0.02)
    rig.drive(DRIVE)
    rig.read(500)
    assert np.ptp(read(rig, 2000)) < 1e-3 * excess
    driven = rig.truth()
    assert [float(driven[f"stick_slip_{name}"][-1]) for name in ("frequency", "fall", "fraction")] == [0.0, 0.0, 0.0]
    assert float(driven["frequency"][-1]) == 22e3


def test_the_arm_swings_as_the_holder_where_the_rig_has_no_structure(bare: Rig) -> None:
    rig = virtual(replace(QUICK, holder_stiffness=5e3, holder_mass=0.02), rig=bare)
    assert value(rig, "arm_frequency") == approx(500.0 / (2 * pi))  # sqrt(5000/0.02)
    assert value(rig, "arm_damping_ratio") == approx(0.01)


@pytest.mark.parametrize("name", ["friction_coefficient", "wear_volume", "actuator_temperature_rise"])
def test_a_truth_before_anything_happened_has_no_setting_and_no_wear(name: str) -> None:
    truth = virtual().truth()
    assert truth.sizes["setting"] == 0
    assert truth.attrs["title"] == f"Truth of {RIG.title}"
    assert float(truth[name]) == approx(0.0 if name != "friction_coefficient" else float(truth[name]))
