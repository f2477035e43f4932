"""Closed loop interval by interval on friction that rises evenly, its figures of merit, and its figure, by hand."""

from dataclasses import dataclass, field, replace
from math import nan, pi
from typing import Any

import numpy as np
import pytest
from pytest import raises
from tests.laboratory.closed_loop.lagged_rig import LaggedDrive, LaggedRig
from tests.same import approx

from sonolube.charts import Band, Line, Rule
from sonolube.checks import Floats
from sonolube.design.control import FrictionCharacteristic, FrictionController, Process, tuned_controller
from sonolube.errors import InvalidInput
from sonolube.facts.protocol import Limits
from sonolube.laboratory import DriveSetting, Outputs, Verdict
from sonolube.laboratory.closed_loop import (
    FrictionHold,
    HeldFriction,
    SpeedStep,
    held_friction_chart,
    hold_friction,
    hold_metrics,
)
from sonolube.laboratory.closed_loop.loop import _settling_time, held_friction_dataset, require_holdable

LINE = FrictionCharacteristic(level=np.array([0.0, 30.0]), friction_force=np.array([1.0, 0.1]))
CONTROLLER: FrictionController = tuned_controller(
    LINE, Process(time_constant=5e-3, dead_time=0.0, sample_interval=0.05), level_maximum=30.0
)


def hold(**changes: Any) -> FrictionHold:
    limits = Limits.model_validate({"voltage_maximum": "30 V", "duration_maximum": "100 s"})
    wanted = FrictionHold(
        controller=CONTROLLER,
        friction_force=0.55,
        frequency=22e3,
        speeds=(SpeedStep(time=0.0, sliding_speed=0.02),),
        duration=0.5,
        limits=limits,
        run_in=0.2,
        sample_rate=1000.0,
    )
    return replace(wanted, **changes)


@dataclass
class NotedDrive(LaggedDrive):
    """Drive that notes what it is set to."""

    settings: list[DriveSetting] = field(default_factory=list)

    def drive(self, setting: DriveSetting) -> None:
        super().drive(setting)
        self.settings.append(setting)


def steady(volts: Floats, turns: float) -> Floats:
    return np.full(volts.size, 0.5)


def rising(**changes: Any) -> tuple[HeldFriction, NotedDrive, list[tuple[str, int, int]]]:
    """Loop on friction of 0.5 N that rises by 1 N/s whatever the drive does, with its drive and its progress."""
    rig = LaggedRig(steady, 5e-3, disturbance=lambda time: time)
    drive, told = NotedDrive(rig), list[tuple[str, int, int]]()
    devices = replace(rig.devices(), drive=drive)
    record = hold_friction(hold(**changes), devices, advance=lambda *args: told.append(args))
    return record, drive, told


def test_the_friction_of_an_interval_is_the_mean_of_its_last_part() -> None:
    # a fifth of 50 samples: the last ten, 40 to 49 ms into each interval, 44.5 ms in the mean
    record, _, _ = rising(averaging=0.2)
    begins = 0.2 + 0.05 * np.arange(10)
    assert record.time == approx(0.05 * np.arange(10))
    assert record.friction_force == approx(0.5 + begins + 0.0445)
    assert record.friction_force_deviation == approx(np.full(10, 1e-3 * np.sqrt(99 / 12)))  # of ten even steps
    assert record.intrinsic_friction_force == approx(0.5 + 0.075 + 0.0445)  # four intervals of the run-in
    assert (record.setpoint.tolist(), record.outcome, record.is_safe) == ([0.55] * 10, "completed", True)
    assert record.sliding_speed.tolist() == [0.02] * 10
    whole, _, _ = rising()
    assert whole.friction_force == approx(0.5 + begins + 0.0245)


@pytest.mark.parametrize(("run_in", "intervals"), [(0.0, 1), (0.05, 1), (0.21, 5)])
def test_the_run_in_takes_whole_intervals_and_one_at_least(run_in: float, intervals: int) -> None:
    record, _, _ = rising(run_in=run_in)
    assert record.friction_force[0] == approx(0.5 + 0.05 * intervals + 0.0245)
    assert record.intrinsic_friction_force == approx(0.5 + 0.05 * (intervals - 1) / 2 + 0.0245)


def test_the_drive_has_the_voltage_the_offset_of_its_ratio_and_the_frequency_of_the_hold() -> None:
    record, drive, _ = rising(offset_ratio=-0.25)
    volts = record.voltage_peak_to_peak[record.voltage_peak_to_peak > 0]
    assert [each.voltage_peak_to_peak for each in drive.settings] == approx(volts)
    assert [each.voltage_offset for each in drive.settings] == approx(-0.25 * volts)
    assert {each.frequency for each in drive.settings} == {22e3}
    assert volts.max() == approx(30.0)  # friction above the reference asks for all of it


def test_progress_tells_friction_voltage_and_the_time_in_milliseconds() -> None:
    record, _, told = rising()
    assert [each[1:] for each in told] == [(50 * number, 500) for number in range(10)]
    assert told[0][0].startswith("724 mN, ")  # 0.5 + 0.2 + 0.0245
    assert told[-1][0] == "1.17 N, 30 V"
    assert record.voltage_peak_to_peak[-1] == approx(30.0)


def test_a_friction_that_is_no_number_trips_the_loop() -> None:
    rig = LaggedRig(steady, 5e-3, disturbance=lambda time: nan if time > 0.4 else 0.0)
    record = hold_friction(hold(), rig.devices())
    assert (record.outcome, record.reason) == ("stopped", "channel friction_force gives no number")
    assert record.time.size == 4  # 0.2 to 0.4 s
    early = LaggedRig(steady, 5e-3, disturbance=lambda time: nan)
    never = hold_friction(hold(), early.devices())
    assert np.isnan(never.intrinsic_friction_force)
    with raises(InvalidInput, match="the controller never took over: channel friction_force gives no number"):
        hold_metrics(never)


def refusal(*, volts: float = 200.0, **changes: Any) -> str:
    """Why a hold is refused on a rig whose drive gives so much; empty where it is not."""
    rig = LaggedRig(steady, 5e-3)
    devices = replace(rig.devices(), drive=LaggedDrive(rig, voltage_maximum=volts))
    try:
        require_holdable(hold(**changes), devices)
    except InvalidInput as found:
        return str(found)
    return ""


FASTEST = 10 * pi * 0.0582  # m/s at ten turns a second


def test_devices_and_limits_that_just_allow_a_hold_are_enough_and_a_little_less_is_refused_by_name() -> None:
    assert refusal(volts=30.0) == ""  # half the swing and half of it as offset
    told = "the controller may command 30 V, its offset included; "
    assert refusal(volts=29.9) == f"{told}lagged drive allows 29.9 V: design it with a lower voltage"
    above = "the controller may command 33 V, its offset included; "  # (0.6 + 0.5) 30 V
    lower = ": design it with a lower voltage"
    assert refusal(offset_ratio=-0.6) == f"{above}limits.voltage_maximum allows 30 V{lower}"
    steps = (SpeedStep(time=0.0, sliding_speed=FASTEST), SpeedStep(time=0.1, sliding_speed=0.01))
    assert refusal(speeds=steps) == ""
    fast = (*steps, SpeedStep(time=0.2, sliding_speed=1.2 * FASTEST))
    assert refusal(speeds=fast) == "speeds need 12 1/s; lagged motor turns at most at 10 1/s"
    assert refusal(duration=99.8) == ""
    assert refusal(duration=100.0) == "duration: the test lasts 100 s; limits.duration_maximum is 100 s"
    assert refusal(duration=110.0) == "duration: the test lasts 110 s; limits.duration_maximum is 100 s"


def held(forces: list[float], volts: list[float], speeds: list[float], **changes: Any) -> HeldFriction:
    count = len(forces)
    known: dict[str, Any] = {
        "hold": hold(friction_force=0.5),
        "time": 2.0 + 0.05 * np.arange(count),
        "setpoint": np.full(count, 0.5),
        "friction_force": np.array(forces),
        "friction_force_deviation": np.linspace(0.01, 0.02, count),
        "voltage_peak_to_peak": np.array(volts),
        "sliding_speed": np.array(speeds),
        "intrinsic_friction_force": 1.3,
        "outcome": "stopped",
        "reason": "enough",
        "verdict": Verdict(Outputs.MEASURED_OFF),
    }
    return HeldFriction(**(known | changes))


RECORD = held(
    [0.9, 0.7, 0.6, 0.5, 0.54, 0.5, 0.54, 0.5, *(0.2, 0.6, 0.5, 0.6, 0.5)],
    [30.0, 30.0, 12.0, 0.0, 8.0, 10.0, 12.0, 14.0, *(5.0, 0.0, 20.0, 22.0, 29.9)],
    [0.02] * 8 + [0.05] * 5,
)


def test_the_figures_of_merit_of_each_speed_are_those_of_the_last_half_of_its_phase() -> None:
    slow, fast = hold_metrics(RECORD)
    # last four: 0.54, 0.5, 0.54, 0.5: mean 0.52, deviation 0.02, error sqrt(0.0016 / 2)
    assert (slow.start_time, slow.sliding_speed) == (2.0, 0.02)
    assert slow.friction_force == approx(0.52)
    assert slow.scatter == approx(0.02)
    assert slow.tracking_error == approx(np.sqrt(8e-4))
    assert slow.voltage_peak_to_peak == approx(11.0)
    assert slow.saturated_fraction == approx(3 / 8)  # at 30 V, and at none
    # 0.9 alone of those within 0.04 of 0.5 would be one in twenty: 0.5 at 150 ms is followed by five, all within
    assert slow.settling_time == approx(0.15)
    # last two of five: 0.6, 0.5
    assert (fast.start_time, fast.sliding_speed) == (approx(2.4), 0.05)
    assert (fast.friction_force, fast.scatter) == (approx(0.55), approx(0.05))
    assert fast.tracking_error == approx(np.sqrt(0.005))
    assert fast.voltage_peak_to_peak == approx((22.0 + 29.9) / 2)
    assert fast.saturated_fraction == approx(1 / 5)
    assert fast.settling_time is None


def test_a_phase_of_one_interval_is_its_own_steady_part() -> None:
    (only,) = hold_metrics(held([0.7], [12.0], [0.02]))
    assert (only.friction_force, only.scatter, only.tracking_error) == (approx(0.7), 0.0, approx(0.2))


@pytest.mark.parametrize(
    ("outside", "settled"),
    [
        ([*range(5)], 0.5),
        ([0, 20, 30], 0.1),  # two of the 49 that follow: 2.45 may
        ([0, 20, 30, 40], 3.1),  # of 29 one may; of 19 one may
        ([*range(45)], 4.5),
        ([*range(46)], None),  # four do not tell
        ([0, 1, 49], 0.2),
    ],
)
def test_friction_has_settled_where_at_most_one_interval_in_twenty_lies_outside(
    outside: list[int], settled: float | None
) -> None:
    is_outside = np.zeros(50, bool)
    is_outside[outside] = True
    found = _settling_time(0.1 * np.arange(50), is_outside)
    assert found == (None if settled is None else approx(settled))


def test_the_dataset_has_the_columns_in_si_and_what_was_wanted_and_found_as_attributes() -> None:
    found = held_friction_dataset(RECORD, title="Held")
    assert found.sizes == {"time": 13}
    for name in ("friction_force", "friction_force_deviation", "voltage_peak_to_peak", "sliding_speed"):
        assert found[name].to_numpy().tolist() == getattr(RECORD, name).tolist()
    assert found["time"].to_numpy()[:2] == approx([2.0, 2.05])
    assert [found[name].attrs["units"] for name in ("friction_force", "voltage_peak_to_peak", "time")] == [
        "N",
        "V",
        "s",
    ]
    told = {name: found.attrs[name] for name in ("title", "outcome", "reason")}
    assert told == {"title": "Held", "outcome": "stopped", "reason": "enough"}
    assert found.attrs["reference_friction_force"] == 0.5
    assert found.attrs["intrinsic_friction_force"] == 1.3


def test_the_figure_has_friction_with_its_band_drive_and_speed_under_axes_from_zero() -> None:
    chart = held_friction_chart(RECORD, simulated=False)
    friction, drive, speed = chart.panels
    band, line, reference, before = friction.parts
    assert isinstance(band, Band)
    assert isinstance(line, Line)
    assert isinstance(reference, Line)
    assert isinstance(before, Rule)
    assert band.low == approx(RECORD.friction_force - RECORD.friction_force_deviation)
    assert band.high == approx(RECORD.friction_force + RECORD.friction_force_deviation)
    assert (line.label, line.y.tolist()) == ("friction, measured", RECORD.friction_force.tolist())
    assert (reference.label, reference.y.tolist()) == ("reference", [0.5] * 13)
    assert (before.value, before.along, before.label) == (1.3, "y", "without vibration, before")
    volts, highest = drive.parts
    assert isinstance(volts, Line)
    assert isinstance(highest, Rule)
    assert (volts.y.tolist(), volts.is_stepped, highest.value) == (RECORD.voltage_peak_to_peak.tolist(), True, 30.0)
    (turning,) = speed.parts
    assert isinstance(turning, Line)
    assert (turning.y, turning.is_stepped) == (approx(1e3 * RECORD.sliding_speed), True)
    # 1.3 N without vibration is the greatest: 1.43; 1.35 * 30 V; 1.15 * 50 mm/s
    tops = [(panel.y.label, panel.y.unit, panel.y.lowest, panel.y.highest) for panel in chart.panels]
    assert tops == [
        ("Friction force", "N", 0.0, approx(1.43)),
        ("Drive, peak to peak", "V", 0.0, approx(40.5)),
        ("Sliding speed", "mm/s", 0.0, approx(57.5)),
    ]
    for panel in chart.panels:
        expected = ("Time under control", "s", 2.0, approx(2.6))
        assert (panel.x.label, panel.x.unit, panel.x.lowest, panel.x.highest) == expected
    assert chart.heights == approx((2, 1, 1))
    assert chart.size == approx((6.85, 5.2))
    assert chart.shares_x


def test_the_figure_of_a_simulated_hold_without_a_run_in_says_so_and_reaches_over_the_band() -> None:
    still = held([0.4, 0.8], [1.0, 1.0], [0.0, 0.0], intrinsic_friction_force=nan)
    chart = held_friction_chart(still, simulated=True)
    line = chart.panels[0].parts[1]
    assert isinstance(line, Line)
    assert line.label == "friction, simulated"
    assert chart.panels[0].y.highest == approx(1.1 * 0.82)
    assert chart.panels[2].y.highest == 1.0
    wanted = held([0.4, 0.8], [1.0, 1.0], [0.0, 0.0], intrinsic_friction_force=nan, setpoint=np.full(2, 2.0))
    assert held_friction_chart(wanted, simulated=True).panels[0].y.highest == approx(2.2)
