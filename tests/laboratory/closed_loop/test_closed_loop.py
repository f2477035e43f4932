"""Closed loop on devices: reference held after a step of speed, margins as told, everything off however it ends."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.laboratory.closed_loop.lagged_rig import LaggedRig
from tests.laboratory.patience import be_patient
from tests.laboratory.simulated_rig import Fault, MemoryRecord

from sonolube.charts import draw_chart
from sonolube.checks import Floats
from sonolube.design.control import (
    Amplifier,
    ControlDesign,
    ControlSettings,
    FrictionCharacteristic,
    FrictionController,
    Process,
    computed_characteristic,
    design_control,
    friction_at_level,
    stability_margins,
    tuned_controller,
)
from sonolube.errors import InvalidInput
from sonolube.facts.protocol import Limits
from sonolube.figure import publication_style, render_figure
from sonolube.laboratory import Block, Devices, RunControl
from sonolube.laboratory.closed_loop import (
    FrictionHold,
    HeldFriction,
    SpeedStep,
    held_friction_chart,
    hold_friction,
    hold_metrics,
)
from sonolube.laboratory.virtual_tribometer import virtual_tribometer
from sonolube.rig import read_rig

TRIBOMETER = Path(__file__).parents[3] / "examples" / "rigs" / "tribometer.toml"
INTERVAL = 0.05  # s
SLOW, FAST = 20.3e-3, 40.6e-3  # m/s, D Table 2.3
SCATTER = 0.035  # N, of friction with vibration at 40.6 mm/s, D Table 2.3
LINE = FrictionCharacteristic(level=np.array([0.0, 30.0]), friction_force=np.array([1.0, 0.1]))


@dataclass(frozen=True)
class Plant:
    """Rig's static characteristics at two speeds, by the turns of the disc."""

    design: ControlDesign
    slow: FrictionCharacteristic
    fast: FrictionCharacteristic

    def friction(self, volts: Floats, turns: float) -> Floats:
        found = self.slow if turns < 0.17 else self.fast  # 0.111 and 0.222 turns a second
        return friction_at_level(found, level=volts)


@pytest.fixture(scope="module")
def plant() -> Plant:
    rig = read_rig(TRIBOMETER)
    settings = ControlSettings(
        amplifier=Amplifier(voltage_maximum=28.0), sample_interval=INTERVAL, dead_time=0.0, duration=10.0
    )
    return Plant(
        design=design_control(rig, settings),
        slow=computed_characteristic(rig, level_maximum=28.0),
        fast=computed_characteristic(replace(rig, sliding_speed=FAST), level_maximum=28.0),
    )


def limits(volts: str = "30 V", lasts: str = "100 s", **further: str) -> Limits:
    return Limits.model_validate({"voltage_maximum": volts, "duration_maximum": lasts, **further})


def controller(*, dead_time: float = 0.0) -> FrictionController:
    process = Process(time_constant=5e-3, dead_time=dead_time, sample_interval=INTERVAL)
    return tuned_controller(LINE, process, level_maximum=30.0)


def hold(of: FrictionController, **changes: Any) -> FrictionHold:
    wanted = FrictionHold(
        controller=of,
        friction_force=0.55,
        frequency=22e3,
        speeds=(SpeedStep(time=0.0, sliding_speed=SLOW),),
        duration=5.0,
        limits=limits(),
        run_in=0.2,
        sample_rate=1000.0,
    )
    return replace(wanted, **changes)


def straight(volts: Floats, turns: float) -> Floats:
    return friction_at_level(LINE, level=volts)


@pytest.fixture(scope="module")
def held(plant: Plant) -> HeldFriction:
    rig = LaggedRig(plant.friction, plant.design.mode.time_constant, deviation=SCATTER)
    wanted = hold(
        plant.design.controller,
        friction_force=plant.design.friction_force,
        speeds=(SpeedStep(time=0.0, sliding_speed=SLOW), SpeedStep(time=5.0, sliding_speed=FAST)),
        duration=10.0,
    )
    return hold_friction(wanted, rig.devices())


def test_a_step_of_speed_changes_the_friction_that_is_not_controlled(plant: Plant) -> None:
    volts = np.array([20.0])
    before, after = plant.friction(volts, 0.111), plant.friction(volts, 0.222)
    assert abs(after - before) > 3 * SCATTER


def test_the_reference_is_held_within_the_scatter_after_a_step_of_speed(held: HeldFriction) -> None:
    slow, fast = hold_metrics(held)
    assert held.outcome == "completed"
    assert (slow.sliding_speed, fast.sliding_speed) == (SLOW, FAST)
    for phase in (slow, fast):
        assert abs(phase.friction_force - held.hold.friction_force) < SCATTER
        assert phase.tracking_error < SCATTER
        assert phase.settling_time is not None
        assert phase.settling_time < 1.0
        assert phase.saturated_fraction < 0.05
    assert fast.voltage_peak_to_peak > 1.1 * slow.voltage_peak_to_peak


def test_friction_before_the_controller_takes_over_is_that_without_vibration(held: HeldFriction, plant: Plant) -> None:
    assert held.intrinsic_friction_force == pytest.approx(plant.slow.highest_force, abs=SCATTER)


def is_stable(of: FrictionController, gain: float, extra_delay: float = 0.0, averaging: float = 0.04) -> bool:
    """Whether a loop forgets a small disturbance, about an operating point in the middle of the line."""

    def friction(volts: Floats, turns: float) -> Floats:
        middle = 0.55
        return middle + gain * (straight(volts, turns) - middle)

    rig = LaggedRig(
        friction,
        of.process.time_constant,
        delay=of.process.dead_time_samples * INTERVAL + extra_delay,
        disturbance=lambda time: 1e-3 if time > 10.0 else 0.0,
    )
    record = hold_friction(hold(of, duration=60.0, averaging=averaging), rig.devices())
    assert record.outcome == "completed"
    early, late = (float(np.std(record.friction_force[part])) for part in (slice(250, 450), slice(-200, None)))
    return late < max(0.5 * early, 1e-9)


def bisected(is_stable_at: Callable[[float], bool], low: float, high: float) -> float:
    """Largest value at which a loop is stable."""
    assert is_stable_at(low)
    assert not is_stable_at(high)
    for _ in range(8):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if is_stable_at(middle) else (low, middle)
    return low


@pytest.mark.parametrize("dead_time", [0.0, INTERVAL])
def test_the_gain_at_which_the_loop_starts_to_oscillate_is_the_margin_told(dead_time: float) -> None:
    of = controller(dead_time=dead_time)
    told = stability_margins(of.process, of.gains).gain_margin
    found = bisected(lambda gain: is_stable(of, gain), 1.0, 2 * told)
    assert found == pytest.approx(told, rel=0.03)


@pytest.mark.parametrize("dead_time", [0.0, INTERVAL])
def test_the_loop_bears_as_many_intervals_of_delay_as_its_margin_tells_and_not_one_more(dead_time: float) -> None:
    of = controller(dead_time=dead_time)
    told = stability_margins(of.process, of.gains).delay_margin / INTERVAL  # 1.0 and 3.2
    borne = math.ceil(told) - 1  # a sampled loop sees whole intervals
    assert is_stable(of, 1.0, extra_delay=borne * INTERVAL)
    assert not is_stable(of, 1.0, extra_delay=(math.floor(told) + 1) * INTERVAL)


def measured_sensitivity(of: FrictionController, cycles: int, intervals: int = 400) -> complex:
    """Friction over a sinusoidal disturbance of it, by a number of cycles in a number of intervals."""
    omega = 2 * math.pi * cycles / (intervals * INTERVAL)
    rig = LaggedRig(
        straight,
        of.process.time_constant,
        delay=of.process.dead_time_samples * INTERVAL,
        disturbance=lambda time: 0.01 * math.sin(omega * time),
    )
    wanted = hold(of, duration=2 * intervals * INTERVAL, averaging=0.02)  # the last sample of each interval
    record = hold_friction(wanted, rig.devices())
    last_sample = record.time[-intervals:] + wanted.run_in + INTERVAL - 1 / wanted.sample_rate
    turning = np.exp(-1j * omega * last_sample)
    response = np.sum((record.friction_force[-intervals:] - wanted.friction_force) * turning)
    return complex(response / np.sum(0.01 * np.sin(omega * last_sample) * turning))


@pytest.mark.parametrize("dead_time", [0.0, INTERVAL])
def test_phase_margin_and_sensitivity_by_a_frequency_sweep_are_those_told(dead_time: float) -> None:
    of = controller(dead_time=dead_time)
    told = stability_margins(of.process, of.gains)
    cycles = [*range(8, 120, 6), 140, 160, 180, 199]
    sensitivity = np.array([measured_sensitivity(of, each) for each in cycles])
    loop = 1 / sensitivity - 1
    below = int(np.flatnonzero(np.abs(loop) < 1)[0])
    around = slice(below - 1, below + 1)
    log_gain, phase = np.log(np.abs(loop[around])), np.angle(loop[around])
    at_crossover = float(np.interp(0.0, log_gain[::-1], phase[::-1]))
    assert math.pi + at_crossover == pytest.approx(told.phase_margin, rel=0.01)
    assert np.abs(sensitivity).max() == pytest.approx(told.sensitivity_peak, rel=0.01)


def test_a_mean_over_the_whole_interval_costs_a_tenth_of_the_gain_margin_at_most() -> None:
    of = controller()
    told = stability_margins(of.process, of.gains).gain_margin
    found = bisected(lambda gain: is_stable(of, gain, averaging=1.0), 1.0, 2 * told)
    assert 0.9 * told < found < 1.3 * told


def test_the_voltage_never_passes_the_limit_of_the_controller() -> None:
    rig = LaggedRig(straight, 5e-3)
    record = hold_friction(hold(controller(), friction_force=0.0), rig.devices())  # out of reach
    assert max(rig.peaks) == pytest.approx(30.0)  # unipolar: offset and half the swing
    assert record.voltage_peak_to_peak.max() <= 30.0
    assert hold_metrics(record)[0].saturated_fraction > 0.9


@pytest.mark.parametrize("call", range(0, 60, 3))
def test_whatever_call_fails_everything_is_off_and_what_was_measured_is_kept(call: int) -> None:
    rig = LaggedRig(straight, 5e-3, fault=Fault(call=call))
    record = hold_friction(hold(controller(), duration=2.0), rig.devices())
    assert record.outcome == "failed"
    assert record.reason == "simulated: answers no more"
    assert rig.is_off
    assert record.is_safe
    assert record.time.shape == record.friction_force.shape == record.voltage_peak_to_peak.shape


def test_an_interrupt_passes_through_with_everything_off() -> None:
    def interrupt(stage: str, done: int, total: int) -> None:
        raise KeyboardInterrupt

    rig = LaggedRig(straight, 5e-3)
    with pytest.raises(KeyboardInterrupt):
        hold_friction(hold(controller()), rig.devices(), advance=interrupt)
    assert rig.is_off


def test_lost_samples_end_the_loop() -> None:
    rig = LaggedRig(straight, 5e-3, skip_at=500)
    record = hold_friction(hold(controller()), rig.devices())
    assert (record.outcome, rig.is_off) == ("failed", True)
    assert "1 samples are missing" in record.reason


def test_friction_beyond_its_limit_ends_the_loop() -> None:
    rig = LaggedRig(straight, 5e-3, disturbance=lambda time: 1.0 if time > 2 else 0.0)
    record = hold_friction(hold(controller(), limits=limits(friction_force_maximum="1.2 N")), rig.devices())
    assert (record.outcome, rig.is_off) == ("stopped", True)
    assert "friction_force is 1." in record.reason
    assert 0 < record.time.size < 100


def test_a_request_to_stop_ends_the_loop_after_the_present_interval() -> None:
    rig, control = LaggedRig(straight, 5e-3), RunControl()

    def stop_later(doing: str, done: int, total: int) -> None:
        if done >= 1000:
            control.stop("enough")

    record = hold_friction(hold(controller()), rig.devices(), control=control, advance=stop_later)
    assert (record.outcome, record.reason, rig.is_off) == ("stopped", "enough", True)
    assert record.time[-1] == pytest.approx(1.0)


def test_an_output_that_does_not_go_off_is_told() -> None:
    rig = LaggedRig(straight, 5e-3, is_stuck=True)
    record = hold_friction(hold(controller(), duration=0.5), rig.devices())
    assert rig.swing == 0  # the drive went off all the same
    assert not record.is_safe
    assert record.outcome == "failed"
    assert "relay welded" in record.reason


def test_every_sample_is_recorded_and_a_full_disk_ends_the_loop() -> None:
    rig, whole = LaggedRig(straight, 5e-3), MemoryRecord()
    record = hold_friction(hold(controller(), duration=2.0), rig.devices(), recorder=whole)
    assert whole.samples() == [2200]
    assert (whole.outcome, record.outcome, whole.is_open) == ("completed", "completed", False)
    rig, full = LaggedRig(straight, 5e-3), MemoryRecord(blocks_until_full=10)
    record = hold_friction(hold(controller(), duration=2.0), rig.devices(), recorder=full)
    assert (record.outcome, full.outcome, rig.is_off) == ("failed", "failed", True)


def test_states_and_speeds_are_noted_with_their_time() -> None:
    rig, record = LaggedRig(straight, 5e-3), MemoryRecord()
    speeds = (SpeedStep(time=0.0, sliding_speed=SLOW), SpeedStep(time=1.0, sliding_speed=FAST))
    hold_friction(hold(controller(), duration=2.0, speeds=speeds), rig.devices(), recorder=record)
    told = [
        (kind, facts["protocol_time"], facts.get("state", facts.get("sliding_speed"))) for kind, facts in record.notes
    ]
    assert told == [
        ("prepared", 0.0, "running"),
        ("motor", 0.0, SLOW),
        ("motor", pytest.approx(1.2), FAST),
        ("completed", pytest.approx(2.2), "stopping"),
        ("off", pytest.approx(2.2), "safe"),
    ]


@pytest.mark.parametrize("broken", ["begin", "end"])
def test_a_record_that_fails_ends_the_loop_with_everything_off(broken: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: Any, **__: Any) -> None:
        raise InvalidInput("record: no space left on device")

    rig, record = LaggedRig(straight, 5e-3), MemoryRecord()
    monkeypatch.setattr(record, broken, fail)
    found = hold_friction(hold(controller(), duration=0.5), rig.devices(), recorder=record)
    assert (rig.is_off, found.is_safe) == (True, True)
    assert record.outcome == found.outcome == "failed"
    assert "no space left" in found.reason


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"speeds": ()}, "speeds must start at 0 s"),
        ({"speeds": (SpeedStep(time=1.0, sliding_speed=0.1),)}, "speeds must start at 0 s"),
        ({"sample_rate": 33.0}, "sample_rate 33 Hz makes 1.65 samples"),
        ({"averaging": 0.0}, "averaging must be above 0"),
        ({"frequency": -1.0}, "frequency must be positive"),
    ],
)
def test_what_has_no_meaning_is_refused_by_name(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        hold(controller(), **changes)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"limits": limits("20 V")}, r"may command 30 V.*allows 20 V"),
        ({"limits": limits(lasts="2 s")}, r"lasts 5\.2 s; limits\.duration_maximum"),
        ({"speeds": (SpeedStep(time=0.0, sliding_speed=10.0),)}, r"turns at most at 10 /s|turns at most at 10 1/s"),
    ],
)
def test_what_limits_or_devices_forbid_is_refused_before_anything_moves(changes: dict[str, Any], message: str) -> None:
    rig = LaggedRig(straight, 5e-3)
    with pytest.raises(InvalidInput, match=message):
        hold_friction(hold(controller(), **changes), rig.devices())
    assert rig.fault.count == 0


def test_the_figure_shows_friction_drive_and_speed_with_units(held: HeldFriction) -> None:
    chart = held_friction_chart(held, simulated=True)
    with publication_style():
        assert render_figure(draw_chart(chart), "png")
    assert [panel.y.unit for panel in chart.panels] == ["N", "V", "mm/s"]
    assert chart.size[0] * 25.4 == pytest.approx(174, abs=1)


@pytest.mark.parametrize("seed", [0, 2])
def test_friction_of_the_virtual_tribometer_is_held_under_a_step_of_speed(seed: int) -> None:
    rig = read_rig(TRIBOMETER)
    virtual = virtual_tribometer(rig, seed=seed)
    reference = 0.8 * float(virtual.truth()["friction_coefficient"]) * rig.normal_load
    settings = ControlSettings(
        amplifier=Amplifier(voltage_maximum=28.0), sample_interval=INTERVAL, dead_time=0.0, duration=10.0
    )
    wanted = hold(
        design_control(rig, settings).controller,
        friction_force=reference,
        speeds=(SpeedStep(time=0.0, sliding_speed=SLOW), SpeedStep(time=6.0, sliding_speed=1.3 * SLOW)),
        duration=12.0,
    )
    found = hold_friction(wanted, virtual.devices)
    assert (found.outcome, found.is_safe) == ("completed", True)
    for phase in hold_metrics(found):
        assert phase.friction_force == pytest.approx(reference, rel=0.02)
        assert phase.tracking_error < SCATTER


@dataclass
class MonitoredRig(LaggedRig):
    """A rig that is no simulation to the program, whose drive gives a multiple of what is set and says what that is."""

    gain: float = 1.0
    gain_from: float = 0.0  # time in s from which on that is so

    def devices(self) -> Devices:
        found = replace(super().devices(), simulated=False)
        found.drive.read_back = lambda: f"AMPL {self.swing:g}"  # type: ignore[attr-defined]
        return found

    def read(self, samples: int) -> Block:
        block, column = super().read(samples), list(self.names).index("voltage_peak_to_peak")
        if block.start >= self.gain_from:
            block.values[:, column] *= self.gain
        return block


def test_a_hold_tests_itself_reads_the_drive_back_and_compares_every_interval(monkeypatch: pytest.MonkeyPatch) -> None:
    be_patient(monkeypatch)
    rig, record = MonitoredRig(straight, 5e-3), MemoryRecord()
    held = hold_friction(hold(controller(), duration=1.0), rig.devices(), recorder=record)
    assert (held.outcome, held.reason) == ("completed", "")
    (tested,) = [facts for kind, facts in record.notes if kind == "self-test"]
    assert (tested["voltage_peak_to_peak"], tested["reason"]) == (pytest.approx(3.0), "")  # a tenth of 30 V
    answers = [facts["answers"] for kind, facts in record.notes if kind == "read back"]
    assert answers == [f"AMPL {each:g}" for each in held.voltage_peak_to_peak[[0, -1]]]


@pytest.mark.parametrize(
    ("gain_from", "self_test", "reason"),
    [
        (0.0, True, "self-test before the first step: channel voltage_peak_to_peak measures 6 V"),
        (1.0, True, "channel voltage_peak_to_peak measures"),
        (0.0, False, ""),
    ],
)
def test_a_hold_whose_drive_gives_twice_the_voltage_ends_off(
    gain_from: float, self_test: bool, reason: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    be_patient(monkeypatch)
    rig = MonitoredRig(straight, 5e-3, gain=2.0, gain_from=gain_from)
    wanted = hold(controller(), duration=2.0, limits=limits("100 V"))
    held = hold_friction(wanted, rig.devices(), self_test=self_test)
    assert held.outcome == ("stopped" if reason else "completed")
    assert held.reason.startswith(reason)
    assert rig.is_off
