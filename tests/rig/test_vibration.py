"""What a rig does where harmonic balance alone cannot say: marched as its drive is switched on, cut, and reported."""

import tomllib
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.actuator.drive import Drive
from sonolube.models.contact import ContactMotion
from sonolube.models.dynamics import (
    Status,
    contact_motion as vibration,
    steady_state,
    waveform_extremes,
    waveform_value,
)
from sonolube.models.dynamics.structure import contact_receptance, drive_receptance
from sonolube.models.friction import FRICTION_MODELS
from sonolube.rig import Simulation, read_rig, rig_from, simulate, start_up
from sonolube.rig.driven_rig import DriveVoltage, driven_rig, waveform_of
from sonolube.rig.resolved_rig import resolved_rig
from sonolube.rig.vibration import (
    _from_rest,
    _of_balance,
    _of_march,
    _same,
    _segments,
    contact_loss_fraction,
    steady_vibration,
)

TRIBOMETER = Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml"
COMPUTED = "vibration.amplitude_source=computed"
BEATING = (
    "contact.normal_load=61.209N",
    "drive.frequency=22436.58Hz",
    "drive.voltage_peak_to_peak=65.8644V",
    "drive.voltage_offset=0V",
)
DOUBLE = (
    "contact.normal_load=95.5875N",
    "drive.frequency=446.00634Hz",
    "drive.voltage_peak_to_peak=570.5942V",
    "drive.voltage_offset=0V",
)
SUBHARMONIC = (
    "contact.normal_load=27.7657N",
    "drive.frequency=733.7986Hz",
    "drive.voltage_peak_to_peak=178.279V",
    "drive.voltage_offset=0V",
)
NOT_FOUND = (
    "contact.normal_load=72.3823N",
    "drive.frequency=452.8423Hz",
    "drive.voltage_peak_to_peak=1041.759V",
    "drive.voltage_offset=0V",
)


@cache
def simulated(*changes: str) -> Simulation:
    return simulate(read_rig(TRIBOMETER, changes=changes))


def test_what_grows_from_an_unstable_vibration_is_told_with_its_range_and_its_beat() -> None:
    result = simulated(*BEATING).vibration
    assert (result.status, result.attractor, result.repetition_periods) == ("unstable", "beating", 0)
    assert result.lowest_amplitude is not None
    assert result.highest_amplitude is not None
    assert 1.03 * result.lowest_amplitude < result.vibration_amplitude < 0.97 * result.highest_amplitude
    assert result.beat_frequency == approx(519, rel=0.01)  # as DOP853 has it
    assert "another motion appears: beats at" in result.reason
    assert "segments" in result.reason


@pytest.mark.parametrize("model", [name for name in FRICTION_MODELS if not FRICTION_MODELS[name].for_soft_bodies])
def test_every_friction_model_takes_a_motion_that_does_not_repeat(model: str) -> None:
    assert 0 < simulated(*BEATING, f"friction.model={model}").friction.raw_friction_ratio < 5


def test_a_load_beside_which_the_tip_beats_is_still_carried_on_the_mean() -> None:
    motions = steady_vibration(read_rig(TRIBOMETER, changes=BEATING)).motions
    carried = np.average([m.normal_force.mean() for m in motions], weights=[1 / m.frequency for m in motions])
    assert carried == approx(61.209, rel=0.01)


def test_of_two_vibrations_the_one_that_the_ramp_reaches_is_taken_and_the_other_told() -> None:
    result = simulated(*DOUBLE, COMPUTED, "drive.ramp_duration=200ms", "drive.ramp_shape=cosine").vibration
    assert result.status == "multistable"
    assert result.vibration_amplitude == approx(1.740e-6, rel=1e-3)
    assert result.coexisting_amplitude == approx(11.82e-6, rel=1e-3)
    assert "cosine ramp of 200 ms, that of 1.74 um appears" in result.reason


def test_a_motion_of_two_periods_is_one_repetition_of_half_the_frequency() -> None:
    result = simulated(*SUBHARMONIC).vibration
    assert (result.status, result.attractor, result.repetition_periods) == ("unstable", "subharmonic", 2)
    assert result.motions[0].frequency == approx(733.7986 / 2)
    assert result.motions[0].normal_force.mean() == approx(27.7657, rel=1e-3)


def test_where_no_vibration_was_found_the_march_tells_what_there_is() -> None:
    result = simulated(*NOT_FOUND).vibration
    assert (result.status, result.attractor, result.repetition_periods) == ("not_converged", "subharmonic", 3)
    assert "a lower voltage or more damping may give one; switched on at once," in result.reason
    assert result.motions[0].normal_force.mean() == approx(72.3823, rel=2e-3)


def test_a_vibration_found_under_a_hard_drive_answers_its_own_force() -> None:
    rig = read_rig(TRIBOMETER)
    structure, law = driven_rig(rig).structure, resolved_rig(rig).gap_law
    load, frequency, voltage = 61.9955, 390.40532, 1162.227 / 2
    states = steady_state(structure, law, normal_load=load, frequency=frequency, voltage_amplitude=voltage)
    assert Status(int(states.status)) is Status.UNSTABLE
    contact = vibration(states, (), samples=2**14)
    force = 2 * np.fft.rfft(contact.normal_force)[1:27] / 2**14
    orders = np.arange(1, 27) * frequency
    answer = contact_receptance(structure, frequency=orders) * force
    answer[0] += complex(drive_receptance(structure, frequency=frequency)) * voltage
    found = 2 * np.fft.rfft(contact.displacement)[1:27] / 2**14
    assert contact.normal_force.mean() == approx(load, rel=1e-6)
    assert np.abs(found - answer).max() < 1e-6 * np.abs(found[0])


def test_lost_contact_is_told() -> None:
    result = simulated("drive.voltage_peak_to_peak=200V", "drive.voltage_offset=0V").vibration
    assert result.contact_loss_fraction == approx(np.mean(result.motions[0].normal_force < 0.03), abs=2e-3)
    assert f"contact is lost for {result.contact_loss_fraction:.2%} of the time" in result.reason


def test_a_slow_start_excites_the_arm_less() -> None:
    abrupt, slow = (
        start_up(read_rig(TRIBOMETER, changes=change), duration=0.1).trajectory.contact.displacement
        for change in ([], ["drive.ramp_duration=50ms", "drive.ramp_shape=cosine"])
    )
    last = slow[-1600:].max()
    assert slow.max() < 1.01 * last
    assert abrupt.max() > 1.1 * last


def sampled(samples: list[float], *, offset: str = "14 V") -> dict[str, object]:
    content = tomllib.loads(TRIBOMETER.read_text(encoding="utf-8"))
    content["drive"] |= {"waveform": "sampled", "waveform_samples": samples, "voltage_offset": offset}
    return content


def test_samples_of_a_triangle_are_the_triangle() -> None:
    named, given = read_rig(TRIBOMETER, changes=["drive.waveform=triangle"]), rig_from(sampled([0, 3, 0, -3]))
    assert simulate(given).vibration.vibration_amplitude == approx(
        simulate(named).vibration.vibration_amplitude, rel=1e-9
    )
    assert given.drive is not None
    assert waveform_value(waveform_of(given.drive), phase=np.pi / 2) == approx(0.5)


def test_the_voltage_of_a_lopsided_waveform_reaches_as_far_as_its_samples_do() -> None:
    drive = rig_from(sampled([1, 0, 0, 0], offset="10 V")).drive
    assert drive is not None
    assert waveform_extremes(waveform_of(drive)) == approx((-0.25, 0.75))
    assert DriveVoltage(drive=drive).range() == approx((10 - 7, 10 + 21))


@pytest.mark.parametrize(
    ("samples", "complaint"),
    [
        ([0.0, float("nan"), 1.0], r"drive.waveform_samples.1: Input should be a finite number"),
        ([1.0], r"drive: samples must be at least two"),
        ([1.0, 1.0], r"drive: samples must not all be equal"),
    ],
)
def test_samples_that_make_no_waveform_are_refused(samples: list[float], complaint: str) -> None:
    with raises(InvalidInput, match=complaint):
        rig_from(sampled(samples))


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ("drive.ramp_duration=-1ms", r"drive: ramp_duration must not be negative, got -0.001 s"),
        ("drive.ramp_shape=steep", r"drive.ramp_shape: Input should be 'linear' or 'cosine'"),
        ("drive.waveform=sampled", r"drive: waveform \"sampled\" and waveform_samples belong together"),
    ],
)
def test_a_drive_that_makes_no_sense_is_refused(change: str, complaint: str) -> None:
    with raises(InvalidInput, match=complaint):
        read_rig(TRIBOMETER, changes=[change])


def test_a_voltage_beyond_what_the_contact_is_defined_for_is_refused_before_any_march() -> None:
    # 0.0892 um/V at resonance: a megavolt would move the tip by 89 mm beside a contact of micrometres
    rig = read_rig(TRIBOMETER, changes=[COMPUTED, "drive.voltage_peak_to_peak=1e6V"])
    with raises(
        OutsideRange, match=r"drive.voltage_peak_to_peak 1 MV would move the tip by 89\.\d mm .* at most 14 kV"
    ):
        steady_vibration(rig)


RIG: Any = SimpleNamespace(normal_load=3.0)


def marched(steps: int, periods: int, beat: float) -> Any:
    return SimpleNamespace(
        steps_per_period=steps, periods=periods, attractor=SimpleNamespace(beat_frequency=beat), amplitudes=np.ones(3)
    )


def segments(x: np.ndarray, attained: Any, frequency: float) -> list[ContactMotion]:
    return _segments(RIG, x, 10 + x, attained, frequency)


def test_a_beating_motion_is_cut_at_its_widest_gaps_one_beat_apart() -> None:
    # 20 kHz in 32 steps a period, a beat of 1 kHz: 640 steps; the widest gaps lie at 100, 740, 1380, ...
    whole = 32 * 200
    n = np.arange(whole + 1)
    x = np.cos(2 * np.pi * (n - 100) / 640)
    found = segments(x, marched(32, 200, 1000.0), 20e3)
    assert len(found) == 9  # cuts from 100 to 5860, the last that leaves half a beat
    for each in found:
        assert each.frequency == approx(1000.0)
        assert each.displacement.size == 640
        assert each.displacement.max() == approx(1.0)
        assert each.normal_load == 3.0
    assert found[0].normal_force == approx(10 + x[100:740])


def test_a_segment_is_made_periodic_about_its_middle() -> None:
    # a slope of 1 from gap to gap is taken away, half of it added at the start
    whole = 32 * 200
    n = np.arange(whole + 1)
    x = np.cos(2 * np.pi * (n - 100) / 640) + n / 640 * 0.1
    found = segments(x, marched(32, 200, 1000.0), 20e3)
    first = found[1]
    assert first.displacement[0] == approx(first.displacement[-1], abs=2e-3)
    assert first.displacement.mean() == approx(x[first_cut(x) + 640 : first_cut(x) + 1280].mean(), abs=2e-3)


def first_cut(x: np.ndarray) -> int:
    return int(np.argmax(x[:640]))


@pytest.mark.parametrize("beat", [0.0, 16_000.0, 10.0])
def test_a_beat_that_is_none_too_fast_or_too_slow_gives_a_sixteenth_of_the_motion(beat: float) -> None:
    # 4 periods at least, a third of the motion at most; a sixteenth of 6400 steps is 400
    n = np.arange(6401)
    x = np.cos(2 * np.pi * (n - 7) / 400)
    found = segments(x, marched(32, 200, beat), 20e3)
    assert {each.displacement.size for each in found} == {400}
    assert found[0].frequency == approx(20e3 * 32 / 400)


def test_contact_is_lost_below_a_hundredth_of_the_load() -> None:
    force = np.array([0.0, 0.0199, 0.0201, 2.0, 6.0])
    motion = ContactMotion(displacement=np.zeros(10), normal_force=np.tile(force, 2), frequency=1.0, normal_load=2.0)
    assert contact_loss_fraction(motion) == approx(2 / 5)


@pytest.mark.parametrize(("other", "same"), [(1.0099, True), (0.9901, True), (1.0101, False), (0.9899, False)])
def test_two_vibrations_are_the_same_within_a_percent_of_the_amplitude(other: float, same: bool) -> None:
    states: Any = SimpleNamespace(vibration_amplitude=2e-6)
    attained: Any = SimpleNamespace(amplitudes=np.array([2e-6 * other, 9.0]))
    assert _same(states, attained) is same


def test_a_march_says_how_its_drive_was_switched_on() -> None:
    drive = Drive(frequency=20e3, voltage_peak_to_peak=10.0)
    assert _from_rest(drive) == "switched on at once,"
    slow = replace(drive, ramp_duration=0.2, ramp_shape="cosine")
    assert _from_rest(slow) == "with the voltage brought up by a cosine ramp of 200 ms,"


def attained_motion(order: int, beat: float) -> Any:
    """Two periods of 100 Hz in 8 steps each, with an elongation of 3 um that lags by 0.4 of a radian; closing samples.

    The stack moves by half of what the first coordinate does, and the drive vector over the charge is a quarter.
    """
    time = np.arange(17) / 800
    elongation = 3e-6 * np.cos(2 * np.pi * 100 * time - 0.4)
    x = 1e-6 * np.cos(2 * np.pi * 50 * time)
    return SimpleNamespace(
        attractor=SimpleNamespace(
            beat_frequency=beat, beat_amplitude=7e-9, order=order, kind="subharmonic", contact_loss_fraction=0.125
        ),
        record=SimpleNamespace(
            time=time,
            contact=SimpleNamespace(displacement=x, normal_force=3.0 + 1e6 * x),
            states=SimpleNamespace(coordinates=np.stack([8 * elongation, 0 * time], axis=1)),
        ),
        amplitudes=np.array([1e-6, 2e-6, 6e-6]),
        dissipated_power=0.25,
        steps_per_period=8,
        periods=2,
    )


@pytest.mark.parametrize("order", [1, 2])
def test_a_marched_motion_has_its_elongation_range_and_repetition(order: int) -> None:
    rig: Any = SimpleNamespace(
        drive=SimpleNamespace(frequency=100.0),
        structure=SimpleNamespace(drive_vector=np.array([0.5, 9.0])),
        stack=SimpleNamespace(charge_per_elongation=4.0),
        normal_load=3.0,
    )
    resolved: Any = SimpleNamespace(vibration=SimpleNamespace(source="computed", text="by its parts"), separation=2e-6)
    balanced: Any = SimpleNamespace(vibration_amplitude=np.float64(5e-6), status=Status.MULTISTABLE)
    found = _of_march(resolved, rig, attained_motion(order, 12.0), balanced, "why")
    assert found.elongation == approx(3e-6 * np.exp(-0.4j))
    assert found.vibration_amplitude == approx(3e-6)
    assert found.mean_displacement == approx(0.0, abs=1e-18)
    assert (found.status, found.attractor, found.reason) == ("multistable", "subharmonic", "why")
    assert found.coexisting_amplitude == approx(5e-6)
    assert found.contact_loss_fraction == approx(0.125)
    assert not found.gap_closed
    (motion,) = found.motions
    assert motion.displacement.size == 16
    assert motion.normal_force == approx(3.0 + 1e6 * motion.displacement)
    assert motion.frequency == approx(100.0 / order)
    if order == 1:
        assert (found.lowest_amplitude, found.highest_amplitude) == (None, None)
        assert (found.beat_frequency, found.beat_amplitude) == (None, None)
    else:
        assert (found.lowest_amplitude, found.highest_amplitude) == approx((1e-6, 6e-6))
        assert (found.beat_frequency, found.beat_amplitude) == approx((12.0, 7e-9))
    resolved.separation = 1e-6
    balanced.status = Status.UNSTABLE
    closed = _of_march(resolved, rig, attained_motion(order, 0.0), balanced, "why")
    assert closed.gap_closed
    assert closed.coexisting_amplitude is None
    assert closed.beat_frequency is None


def test_cuts_lie_in_the_middle_of_their_beat_where_it_drifts() -> None:
    # the widest gaps come every 640 steps, and from 1500 on 250 steps later: that at 1630 is less than half a beat on
    n = np.arange(32 * 200 + 1)
    late = np.where(n > 1500, n - 250, n)
    found = segments(np.cos(2 * np.pi * (late - 100) / 640), marched(32, 200, 1000.0), 20e3)
    assert [each.displacement.size for each in found[:4]] == [640, 640, 890, 640]


def test_the_elongation_of_a_balanced_motion_is_the_charge_beyond_that_of_the_held_stack_over_its_charge_per_metre(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # q = C V + b x, from the current i = 2 pi i f q: C = 2 nF, V = 10 V, b = 4 C/m, x = 3 um e^(-0.3 i)
    x = 3e-6 * np.exp(-0.3j)
    charge = 2e-9 * 10.0 + 4.0 * x
    states: Any = SimpleNamespace(
        status=Status.PERIODIC,
        vibration_amplitude=np.float64(2e-6),
        coexisting_amplitude=np.float64(np.nan),
        current_harmonics=np.array([2j * np.pi * 100.0 * charge, 9.0]),
        voltage_harmonics=np.array([10.0 + 0j, 7.0]),
        structure=SimpleNamespace(clamped_capacitance=2e-9),
        mean_displacement=np.float64(1e-7),
        contact_loss_fraction=np.float64(0.25),
        dissipated_power=np.float64(0.5),
        gap_closed=np.bool_(True),
    )
    rig: Any = SimpleNamespace(drive=SimpleNamespace(frequency=100.0), stack=SimpleNamespace(charge_per_elongation=4.0))
    resolved: Any = SimpleNamespace(vibration=SimpleNamespace(source="computed", text="by its parts"))
    monkeypatch.setattr("sonolube.rig.vibration.gap_motion", lambda states, point: ("motion", point))
    found: Any = _of_balance(resolved, rig, states, "why")
    assert found.elongation == approx(x)
    assert (found.status, found.reason, found.prescribed) == ("periodic", "why", False)
    assert (found.amplitude_source, found.amplitude_origin) == ("computed", "by its parts")
    assert found.motions == (("motion", ()),)
    assert (found.vibration_amplitude, found.mean_displacement) == approx((2e-6, 1e-7))
    assert (found.contact_loss_fraction, found.dissipated_power) == approx((0.25, 0.5))
    assert found.coexisting_amplitude is None
    assert found.gap_closed
    states.coexisting_amplitude = np.float64(5e-6)
    assert _of_balance(resolved, rig, states, "why").coexisting_amplitude == approx(5e-6)
