"""Report of a dry run made by hand: refusals, caveats, lines, sums and chart against values worked out on paper."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.same import approx

from sonolube.charts import Axis, Line, Rule, Zone
from sonolube.design.control import Amplifier
from sonolube.facts.protocol import Protocol, SetPoint, protocol_from
from sonolube.facts.protocol.step import Lane
from sonolube.laboratory.dry_run.record import DriveLoad, DryRun, Heating, PlannedPoint
from sonolube.laboratory.dry_run.report import (
    SAFETY,
    caveats_of,
    clock,
    dry_run_cells,
    dry_run_chart,
    dry_run_lines,
    dry_run_sums,
    refusals_of,
)
from sonolube.rig import power_to_supply

WAIT = {"kind": "wait", "duration": "1 s"}


def protocol(*steps: dict[str, Any], **limits: str) -> Protocol:
    known = {"voltage_maximum": "100 V", "duration_maximum": "10 h"}
    return protocol_from({"title": "t", "source": "s", "limits": known | limits, "steps": list(steps or (WAIT,))})


def load(current: float, *, slew: float = 1e6, power: float = 1.0) -> DriveLoad:
    supplied = power_to_supply(charging_power=power, dissipated_power=0.0)
    assert supplied is not None
    return DriveLoad(peak_current=current, slew_rate=slew, power=supplied, capacitive_power=0.3)


def point(time: float, step: str, kind: str = "wait", *, lasts: float = 1.0, **more: Any) -> PlannedPoint:
    planned = {"content", "sliding_speed", "vibration_amplitude", "friction_force", "load"}
    set_points = {k: v for k, v in more.items() if k not in planned}
    begins: tuple[Lane, ...] = ("record",) if kind == "acquire" else ()
    setting = SetPoint(time=time, step=step, kind=kind, sets=begins, **set_points)
    return PlannedPoint(setting=setting, duration=lasts, **{k: v for k, v in more.items() if k in planned})


def run(*points: PlannedPoint, of: Protocol | None = None, **more: Any) -> DryRun:
    known = {"duration": points[-1].setting.time, "prompt_time": 0.0} | more
    return DryRun(protocol=of or protocol(), rig_title="rig", points=points, **known)


def heating(rises: list[float], times: list[float], **more: Any) -> Heating:
    known: dict[str, Any] = {"contact_rise": None, "pin_rise": None, "frictional_heat": 0.0, "actuator_heat": 0.0}
    rise = np.array(rises)
    return Heating(time=np.array(times), actuator_rise=rise, ambient_temperature=294.15, **(known | more))


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.0, "0:00"),
        (32.5, "0:32.5"),
        (59.94, "0:59.9"),
        (59.96, "1:00"),
        (61.04, "1:01"),
        (725.3, "12:05.3"),
        (3599.96, "1:00:00"),
        (14_400.0, "4:00:00"),
        (3725.5, "1:02:05.5"),
    ],
)
def test_a_time_is_told_in_hours_minutes_and_tenths_of_a_second(seconds: float, text: str) -> None:
    assert clock(seconds) == text


STRONG = Amplifier(voltage_maximum=20.0, current_maximum=0.2, slew_rate_maximum=2e6)


def test_steps_that_rise_beyond_the_amplifier_are_named_and_those_of_one_value_together() -> None:
    volts = [("1", 10.0), ("2", 25.0), ("3", 25.0), ("4", 20.0), ("5", 25.0), ("6", 30.0), ("6", 28.0), ("7", 20.0)]
    points = [point(float(i), step, voltage_peak_to_peak=volt) for i, (step, volt) in enumerate(volts)]
    # step 3 keeps the voltage of step 2; 20 V are just given; of step 6 the highest counts
    assert refusals_of(run(*points), STRONG) == (
        "step 2, 5: needs 25 V peak to peak; the amplifier gives 20 V",
        "step 6: needs 30 V peak to peak; the amplifier gives 20 V",
    )


def test_currents_and_slopes_beyond_amplifier_and_limit_are_told_in_their_units() -> None:
    points = (point(0.0, "1", load=load(0.2, slew=2e6)), point(1.0, "2", load=load(0.25, slew=3.5e6)), point(2.0, "3"))
    found = run(*points, of=protocol(current_maximum="150 mA"))
    assert refusals_of(found, STRONG) == (
        "step 2: needs 250 mA peak; the amplifier gives 200 mA",
        "step 2: needs 3.5 V/us; the amplifier gives 2 V/us",
        "step 1: reaches 200 mA; limits.current_maximum of 150 mA ends the test",
        "step 2: reaches 250 mA; limits.current_maximum of 150 mA ends the test",
    )
    assert refusals_of(replace(found, protocol=protocol()), None) == ()


def test_friction_beyond_its_limit_is_told_and_at_its_limit_is_not() -> None:
    points = (point(0.0, "1", friction_force=0.9), point(1.0, "2", friction_force=1.25), point(2.0, "3"))
    found = run(*points, of=protocol(friction_force_maximum="900 mN"))
    assert refusals_of(found, STRONG) == (
        "step 2: reaches 1.25 N of friction; limits.friction_force_maximum of 900 mN ends the test",
    )


def test_the_moment_at_which_the_actuator_is_too_hot_lies_on_the_line_between_two_temperatures() -> None:
    points = (
        point(0.0, "1", lasts=5.0),
        point(5.0, "2", lasts=8.0),
        point(13.0, "3", lasts=0.0),
        point(13.0, "4", lasts=0.0),
        point(15.0, "5", lasts=15.0),
        point(30.0, "", "end", lasts=0.0),
    )
    warm = heating([0.0, 4.0, 10.0, 9.0], [0.0, 10.0, 20.0, 30.0])
    # 27 degC are a rise of 6 K over 21 degC: 10 s + 10 s (6 - 4)/(10 - 4) = 13.3 s, while step 2 still lasts
    found = run(*points, of=protocol(temperature_maximum="27 degC"), heating=warm)
    assert refusals_of(found, None) == (
        "step 2: reaches 31 degC at the actuator, too hot after 13.3 s; limits.temperature_maximum of 27 degC ends the"
        " test",
    )
    assert refusals_of(replace(found, protocol=protocol(temperature_maximum="31 degC")), None) == ()
    assert refusals_of(replace(found, heating=None), None) == ()


def test_a_room_warmer_than_the_limit_is_too_hot_from_the_first_step_on() -> None:
    points = (point(0.0, "1", lasts=0.0), point(0.0, "2", lasts=5.0), point(5.0, "", "end", lasts=0.0))
    found = run(*points, of=protocol(temperature_maximum="20 degC"), heating=heating([0.0, 1.0], [0.0, 5.0]))
    assert refusals_of(found, None) == (
        "step 2: reaches 22 degC at the actuator, too hot after 0 s; limits.temperature_maximum of 20 degC ends the"
        " test",
    )


@pytest.mark.parametrize(
    ("limit", "told"), [("1.1 N", False), ("1.2 N", True), ("1.5 N", True), ("1.62 N", False), ("2 N", False)]
)
def test_static_friction_is_told_where_it_alone_may_trip_the_limit(limit: str, told: bool) -> None:
    # sliding 1.2 N, static 1.35 * 1.2 N = 1.62 N
    points = (point(0.0, "1", friction_force=0.4), point(1.0, "2", friction_force=1.2), point(2.0, "3"))
    found = list(caveats_of(run(*points, of=protocol(friction_force_maximum=limit))))
    line = (
        "static friction may reach 1.62 N at the start, 1.35 times that of sliding (D 4.1.2), and trip"
        " limits.friction_force_maximum"
    )
    assert found == [SAFETY, line] if told else found == [SAFETY]


def test_what_a_test_says_before_it_begins_stands_once_each_and_only_where_it_applies() -> None:
    quiet = run(point(0.0, "1", load=load(0.0)), point(1.0, "2"))
    assert list(caveats_of(quiet)) == [SAFETY]
    checks: list[dict[str, Any]] = [
        {"kind": "acquire", "channels": ["voltage"], "sample_rate": "400 Hz", "duration": "10 s"},
        {"kind": "drive", "voltage_peak_to_peak": "10 V", "frequency": "22 kHz"},
        {"kind": "check", "quantity": "sliding_speed", "lowest": "1 mm/s"},
        {"kind": "check", "quantity": "temperature", "highest": "30 degC", "otherwise": "wait"},
        {"kind": "check", "quantity": "normal_load", "highest": "9 N"},
        {"kind": "repeat", "count": 2, "steps": [{**WAIT}]},
    ]
    rate = 1e6
    acquiring: dict[str, Any] = {"channels": ("a", "b"), "sample_rate": rate, "recorded_until": 70.0}
    points = (
        point(0.0, "1", "acquire", **acquiring),
        point(0.0, "2", "drive", load=load(0.1)),
        point(0.0, "3", "check"),
        point(0.0, "4", "check"),
        point(0.5, "4", "check"),
        point(0.5, "5", "check"),
        point(70.0, "", "end"),
    )
    flash = heating([0.0], [0.0], contact_rise=np.array([0.0]))
    assert list(caveats_of(run(*points, of=protocol(*checks), heating=flash))) == [
        SAFETY,
        "currents are those of the capacitance; near resonance that of the motion adds to them",
        "the rise of the contact is the mean over its nominal area by heat of friction alone; asperities flash hotter,"
        " and a thermocouple in the contact has read 53 degC (D 4.3.5), far more",
        "voltage at 400 Hz does not resolve the drive (fewer than five samples a period)",
        "step 3: checks the speed that is set, unless a channel rotation_speed measures it",
        "checks that wait until they hold may take longer: step 4",
        "the recordings need 1.12 GB of disk",  # 70 s at 1 MHz, two channels of 8 bytes
    ]
    slower = replace(points[0], setting=replace(points[0].setting, sample_rate=8e5))
    small = run(slower, *points[1:], of=protocol(*checks))
    assert not any("of disk" in line for line in caveats_of(small))  # 0.896 GB


TOLD = point(
    12.5,
    "7",
    "acquire",
    rotation_speed=2.0,
    sliding_speed=0.0655,
    voltage_peak_to_peak=25.9,
    frequency=22e3,
    channels=("friction_force", "voltage"),
    sample_rate=400.0,
    recorded_until=42.5,
    vibration_amplitude=2.31e-6,
    friction_force=0.89,
    load=load(0.322, power=5.31),
    content="seen",
    lasts=80.0,
)


def test_a_set_point_is_told_with_everything_that_follows_from_it_in_order() -> None:
    found = run(TOLD, point(3725.0, "", "end", lasts=0.0))
    assert dry_run_cells(TOLD, found) == (
        " 0:12.5",  # as wide as 1:02:05
        "7",
        "acquire",
        "120 rpm  65.5 mm/s  25.9 V pp 22 kHz  2.31 um  322 mA peak  890 mN  friction_force, voltage at 400 Hz for"
        " 0:30  seen",
    )
    setting = replace(TOLD.setting, kind="motor_speed", sets=())
    later = replace(TOLD, setting=setting, vibration_amplitude=None, load=None)
    assert dry_run_cells(later, found)[2:] == (
        "motor speed",
        "120 rpm  65.5 mm/s  25.9 V pp 22 kHz  890 mN  seen",  # it is recorded since an earlier step
    )
    still = point(0.0, "1", "wait", sliding_speed=0.0, friction_force=0.0, vibration_amplitude=0.0)
    assert dry_run_cells(still, found)[3] == ""
    asked = replace(TOLD, setting=replace(TOLD.setting, kind="prompt"), content="load: hang it")
    assert dry_run_cells(asked, found)[2:] == ("prompt", "load: hang it")


SUMMED = run(
    point(0.0, "1", "prompt", lasts=0.0, load=load(0.0, power=0.0)),
    replace(TOLD, setting=replace(TOLD.setting, time=0.0, recorded_until=30.0)),
    point(80.0, "8", lasts=12.5, load=load(0.2, power=1.5)),
    point(92.5, "", "end", lasts=0.0, load=load(0.0, power=0.0)),
    prompt_time=120.0,
    heating=heating([0.0, 9.4, 3.0], [0.0, 1.0, 2.0], contact_rise=np.array([0.0, 4.2, 1.0]), frictional_heat=12.3),
)


def test_the_sums_are_those_of_times_samples_powers_and_rises() -> None:
    assert list(dry_run_sums(SUMMED)) == [
        ("duration", "1:32.5, about 3:32.5 with 1 prompt"),
        ("data", "1 recording, 24,000 samples, 0.192 MB"),  # 30 s at 400 Hz of two channels
        ("drive", "at most 322 mA peak, 5.31 W to supply, 444 J in all"),  # 5.31 W 80 s + 1.5 W 12.5 s
        ("friction", "12.3 J of work"),
        ("contact", "warms by 4.2 K at most"),
        ("actuator", "warms by 9.4 K at most"),
    ]


def test_sums_of_what_is_not_known_are_left_out() -> None:
    bare = [replace(each, load=None) for each in SUMMED.points[1:]]
    two = run(bare[0], bare[0], *bare[1:], point(92.5, "9", "prompt"), point(92.5, "9", "prompt"), prompt_time=60.0)
    assert list(dry_run_sums(two)) == [
        ("duration", "1:32.5, about 2:32.5 with 2 prompts"),
        ("data", "2 recordings, 48,000 samples, 0.384 MB"),
    ]
    idle = replace(SUMMED, points=tuple(replace(each, load=load(0.0)) for each in SUMMED.points[1:]))
    flashless = replace(idle, heating=heating([0.0, 9.4], [0.0, 1.0], frictional_heat=2.0))
    assert list(dry_run_sums(flashless)) == [
        ("duration", "1:32.5"),
        ("data", "1 recording, 24,000 samples, 0.192 MB"),
        ("friction", "2 J of work"),
        ("actuator", "warms by 9.4 K at most"),
    ]
    partly = replace(SUMMED, points=(*SUMMED.points[:2], replace(SUMMED.points[2], load=None)), heating=None)
    assert dict(dry_run_sums(partly))["drive"] == "at most 322 mA peak, 5.31 W to supply"


def test_the_lines_are_columns_of_the_set_points_and_of_the_sums() -> None:
    lines = dry_run_lines(SUMMED)
    assert lines[0] == "  0:00  1     prompt"  # as wide as 1:32.5
    assert lines[1].startswith("  0:00  7     acquire       120 rpm  65.5 mm/s")
    assert lines[4:6] == ["", "duration     1:32.5, about 3:32.5 with 1 prompt"]
    assert len(lines) == 4 + 1 + 6


def charted(scale: float, **more: Any) -> DryRun:
    """Two recordings, two prompts and a drive, stretched in time."""
    driven = {"voltage_peak_to_peak": 20.0, "frequency": 22e3}
    return run(
        point(0.0, "1", "acquire", recorded_until=10 * scale, sliding_speed=0.02, sample_rate=1.0, channels=("a",)),
        point(20 * scale, "2", "prompt", sliding_speed=0.05, **driven),
        point(20 * scale, "2", "prompt", sliding_speed=0.05, **driven),
        point(30 * scale, "3", "acquire", recorded_until=70 * scale, sliding_speed=0.0, channels=("a",), **driven),
        point(80 * scale, "4", "prompt", sliding_speed=0.0, **driven),
        point(100 * scale, "", "end", sliding_speed=0.0),
        **more,
    )


@pytest.mark.parametrize(
    ("scale", "unit", "last"),
    [(1.0, "s", 100.0), (1.79, "s", 179.0), (1.8, "min", 3.0), (71.9, "min", 7190 / 60), (72.0, "h", 2.0)],
)
def test_the_axis_of_time_has_seconds_minutes_from_three_and_hours_from_two(
    scale: float, unit: str, last: float
) -> None:
    chart = dry_run_chart(charted(scale))
    for panel in chart.panels:
        expected = ("Time without prompts", unit, approx(-0.01 * last), approx(1.01 * last))
        assert (panel.x.label, panel.x.unit, panel.x.lowest, panel.x.highest) == expected
        lines = [part for part in panel.parts if isinstance(part, Line)]
        assert [line.x[-1] for line in lines] == [approx(last)]


def test_the_chart_shades_recordings_once_and_marks_each_prompt_once() -> None:
    chart = dry_run_chart(charted(1.8))
    assert (chart.size, chart.shares_x) == (approx((6.85, 1.2 + 2 * 1.45)), True)
    first, second = chart.panels
    (zone,) = (part for part in first.parts if isinstance(part, Zone))
    assert (zone.first, zone.last, zone.label) == (approx([0.0, 0.9]), approx([0.3, 2.1]), "recorded")
    rules = [[(part.value, part.label) for part in panel.parts if isinstance(part, Rule)] for panel in chart.panels]
    assert rules == [[(approx(0.6), "prompt"), (approx(2.4), "")], [(approx(0.6), ""), (approx(2.4), "")]]
    assert not any(isinstance(part, Zone) for part in second.parts)
    many = [point(float(time), "1", "prompt", sliding_speed=0.0) for time in range(50)]
    panel = dry_run_chart(run(*many)).panels[0]
    assert [part.value for part in panel.parts if isinstance(part, Rule)] == approx(np.arange(40.0))
    assert not any(isinstance(part, Zone) for part in panel.parts)


def curve(axis: Axis, parts: tuple[Any, ...]) -> tuple[str, str, float | None, float | None, list[float]]:
    (line,) = (part for part in parts if isinstance(part, Line))
    assert line.is_stepped
    return axis.label, axis.unit, axis.lowest, axis.highest, line.y.tolist()


def test_speed_and_voltage_are_drawn_in_their_units_from_zero_to_a_little_over_the_greatest() -> None:
    speed, volts = (curve(panel.y, panel.parts) for panel in dry_run_chart(charted(1.0)).panels)
    assert speed == ("Sliding speed", "mm/s", 0.0, approx(57.5), approx([20.0, 50.0, 50.0, 0.0, 0.0, 0.0]))
    assert volts == ("Drive, peak to peak", "V", 0.0, approx(23.0), [0.0, 20.0, 20.0, 20.0, 20.0, 0.0])
    unknown = run(point(0.0, "1", rotation_speed=2.0), point(1.0, "2", sliding_speed=0.01, rotation_speed=None))
    speed, volts = (curve(panel.y, panel.parts) for panel in dry_run_chart(unknown).panels)
    assert speed == ("Speed of the disc", "rpm", 0.0, approx(138.0), [120.0, 0.0])
    assert volts == ("Drive, peak to peak", "V", 0.0, 1.0, [0.0, 0.0])


def test_a_swept_frequency_has_a_panel_in_kilohertz_and_a_steady_one_has_none() -> None:
    swept = [point(float(i), "1", sliding_speed=0.0, frequency=f) for i, f in enumerate((None, 20e3, 24e3))]
    label, unit, _, _, values = curve(
        dry_run_chart(run(*swept)).panels[2].y, dry_run_chart(run(*swept)).panels[2].parts
    )
    assert (label, unit, values) == ("Frequency", "kHz", approx([np.nan, 20.0, 24.0], nan_ok=True))
    assert len(dry_run_chart(run(*swept[:2])).panels) == 2


def test_the_rises_of_contact_pin_and_actuator_are_drawn_where_they_are_known() -> None:
    warm = heating(
        [0.0, 9.0], [0.0, 180.0], contact_rise=np.array([0.0, 4.0]), pin_rise=np.array([0.0, 1.0]), frictional_heat=1.0
    )
    panel = dry_run_chart(charted(1.8, heating=warm)).panels[-1]
    assert (panel.y.label, panel.y.unit, panel.y.lowest) == ("Computed rise", "K", 0.0)
    drawn = [(part.label, part.x[-1], part.y.tolist()) for part in panel.parts if isinstance(part, Line)]
    assert drawn == [("contact, mean", 3.0, [0.0, 4.0]), ("pin", 3.0, [0.0, 1.0]), ("actuator", 3.0, [0.0, 9.0])]
    alone = dry_run_chart(charted(1.8, heating=heating([0.0, 9.0], [0.0, 180.0]))).panels[-1]
    assert [part.label for part in alone.parts if isinstance(part, Line)] == ["actuator"]
