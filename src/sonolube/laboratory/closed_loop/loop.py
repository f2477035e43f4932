"""Closed loop of friction: control intervals, the voltage off however it ends, and the results over time."""

from dataclasses import dataclass
from itertools import pairwise
from math import ceil, nan, pi
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.charts import Axis, Band, Chart, Line, Panel, Rule
from sonolube.design.control import initial_state, next_level
from sonolube.errors import InvalidInput
from sonolube.laboratory.closed_loop.plan import FrictionHold, HeldFriction, recorded_channels
from sonolube.laboratory.devices import DeviceError, Devices, DriveSetting, Recorder
from sonolube.laboratory.interlocks import run_limits, set_point_trip
from sonolube.laboratory.own_clocks import OwnClocks
from sonolube.laboratory.states import Event, RunControl, RunEnded
from sonolube.laboratory.supervised_run import Advance, Sampling, SupervisedRun
from sonolube.rig import dataset
from sonolube.storage.interruption import asked_by_signal, undone_at_signal
from sonolube.text.units import format_si

if TYPE_CHECKING:
    import xarray as xr

_FRICTION: Final = "friction_force"


def hold_friction(
    hold: FrictionHold,
    devices: Devices,
    *,
    recorder: Recorder | None = None,
    control: RunControl | None = None,
    advance: Advance | None = None,
    self_test: bool = True,
) -> HeldFriction:
    """Hold friction at a reference on devices, by the controller that `sonolube control` designs.

    Parameters
    ----------
    hold : FrictionHold
    devices : Devices
        Not yet connected; released at the end.
    recorder : Recorder, optional
        Of a new run; finished at the end.
    control : RunControl, optional
        Requests of others to stop.
    advance : callable, optional
        Reports progress.
    self_test : bool
        Of devices that are not simulated, drive at a tenth of the highest voltage for 0.3 s before the run-in and
        compare it with what a channel measures, and do so at every interval. It vibrates the specimens.

    Returns
    -------
    HeldFriction
        Also where a device, a limit or the disk has ended the loop, with what was measured until then.

    Raises
    ------
    InvalidInput
        If the devices cannot do what is wanted; then nothing was connected.

    Notes
    -----
    In interval n the voltage follows by `sonolube.design.control.next_level` from the friction of interval n - 1. The
    loop is then that of `sonolube.design.control.stability_margins` where the friction at the end of an interval is
    that of its voltage; a mean over the whole interval delays the measurement by up to half of it.
    """
    require_holdable(hold, devices)
    control = control or RunControl()
    loop = _Loop(hold, devices, recorder, control, self_test=self_test)
    with undone_at_signal(loop.halt), asked_by_signal(control.stop):
        return loop.complete(advance)


class _Loop(SupervisedRun):
    """One loop on devices."""

    def __init__(
        self, hold: FrictionHold, devices: Devices, recorder: Recorder | None, control: RunControl, *, self_test: bool
    ) -> None:
        super().__init__(devices, recorder, control, self_test=self_test)
        self._hold, self._limits = hold, run_limits(hold.limits, devices, hold.drive_sampling)
        channels = devices.acquisition.channels
        self._clocks = OwnClocks(devices, self._limits)
        self._sampling = Sampling(self._devices.acquisition, recorder, self._limits.locks, beside=self._clocks)
        self._names = recorded_channels(hold, channels)
        self._interval = nan  # of the controller by the clock of the acquisition, in s
        self._rows: list[tuple[float, float, float, float]] = []
        self._run_in_means: list[float] = []
        self._is_on, self._was_read_back = False, False

    def complete(self, advance: Advance | None) -> HeldFriction:
        """Run the loop to its end, whatever that is."""
        self._complete(advance)
        return self._result()

    def _follow(self, advance: Advance | None) -> None:
        """Run in, then control; the source of the drive is read back when it is first on, and at the end."""
        self._test_itself(self._setting(self._hold.controller.level_maximum))
        self._sample()
        self._control_friction(self._running_in(), advance)
        if self._is_on:
            self._read_back()
        self._sampling.end_recording()

    def _sample(self) -> None:
        """Start to sample and to record."""
        sampling = self._sampling
        sampling.start(self._names, sample_rate=self._hold.sample_rate)
        try:
            self._interval = self._hold.samples_per_interval(sampling.rate) / sampling.rate
        except InvalidInput as refusal:
            raise DeviceError(f"{self._devices.acquisition.name}: {refusal}") from None
        sampling.record(self._names, sample_rate=sampling.rate)

    def _running_in(self) -> float:
        """Slide without vibration, and return the friction of the last interval. [N]"""
        self._turn(self._hold.speeds[0].sliding_speed)
        intervals = max(1, ceil(self._hold.run_in / self._interval - 1e-9))
        self._run_in_means = [self._measure()[0] for _ in range(intervals)]
        return self._run_in_means[-1]

    def _control_friction(self, measured: float, advance: Advance | None) -> None:
        """Compute, set and measure, interval by interval."""
        hold, state = self._hold, initial_state(self._hold.controller)
        coming = list(hold.speeds[1:])
        speed = hold.speeds[0].sliding_speed
        intervals = round(hold.duration / self._interval)
        for number in range(intervals):
            now = number * self._interval
            while coming and now >= coming[0].time - 1e-9:
                speed = coming.pop(0).sliding_speed
                self._turn(speed)
            voltage = next_level(hold.controller, state, hold.friction_force, measured)
            self._drive(voltage)
            measured, deviation = self._measure()
            self._rows.append((measured, deviation, voltage, speed))
            if advance is not None:
                doing = f"{format_si(measured, 'N', digits=3)}, {format_si(voltage, 'V', digits=3)}"
                advance(doing, round(1e3 * now), round(1e3 * hold.duration))

    def _turn(self, speed: float) -> None:
        """Set the speed of the disc for a sliding speed."""
        self._devices.motor.turn(speed / (pi * self._devices.groove_diameter))
        self._note("motor", sliding_speed=speed)

    def _setting(self, voltage: float) -> DriveSetting:
        """Output of the drive at a peak-to-peak voltage."""
        return DriveSetting(
            voltage_peak_to_peak=voltage,
            voltage_offset=self._hold.offset_ratio * voltage,
            frequency=self._hold.frequency,
        )

    def _drive(self, voltage: float) -> None:
        """Set the drive to a peak-to-peak voltage."""
        self._is_on = voltage > 0
        setting = self._setting(voltage) if self._is_on else None
        self._sampling.expect(setting if self._tests_itself else None)
        if setting is None:
            self._devices.drive.off()
            return
        self._end_at(set_point_trip(setting, self._limits.stated))
        self._devices.drive.drive(setting)
        if not self._was_read_back:
            self._was_read_back = True
            self._read_back()

    def _measure(self) -> tuple[float, float]:
        """Mean friction and its deviation over the end of the next interval, held to counter and limits. [N]"""
        self._end_if_asked()
        self._end_at(self._sampling.read_until(self._sampling.time + self._interval))
        samples = self._sampling.samples(_FRICTION)
        samples = samples[-max(1, round(self._hold.averaging * samples.size)) :]
        mean = float(np.mean(samples))
        if not np.isfinite(mean):
            raise RunEnded(Event.TRIP, f"channel {_FRICTION} gives no number")
        return mean, float(np.std(samples))

    def _result(self) -> HeldFriction:
        """Measured and set values."""
        rows = np.array(self._rows, dtype=np.float64).reshape(-1, 4)
        run_in = self._run_in_means
        return HeldFriction(
            hold=self._hold,
            time=np.arange(rows.shape[0], dtype=np.float64) * self._interval,
            setpoint=np.full(rows.shape[0], self._hold.friction_force),
            friction_force=rows[:, 0],
            friction_force_deviation=rows[:, 1],
            voltage_peak_to_peak=rows[:, 2],
            sliding_speed=rows[:, 3],
            intrinsic_friction_force=float(np.mean(run_in)) if run_in else nan,
            outcome=self._present.outcome,
            reason=self._present.reason,
            verdict=self._present.verdict,
        )


def require_holdable(hold: FrictionHold, devices: Devices) -> None:
    """Raise where devices or limits do not allow what a loop may do, before anything is connected.

    Parameters
    ----------
    hold : FrictionHold
    devices : Devices

    Raises
    ------
    InvalidInput
        Naming what is asked for, and the device or limit that forbids it.
    """
    run_limits(hold.limits, devices, hold.drive_sampling)
    if _FRICTION not in devices.acquisition.channels:
        raise InvalidInput(f"{devices.acquisition.name} has no channel {_FRICTION}, which the loop needs")
    reached = format_si(hold.voltage_maximum, "V")
    for owner, most in (
        (devices.drive.name, devices.drive.voltage_maximum),
        ("limits.voltage_maximum", hold.limits.voltage_maximum),
    ):
        if hold.voltage_maximum > most * (1 + 1e-9):
            allowed = format_si(most, "V")
            raise InvalidInput(
                f"the controller may command {reached}, its offset included; {owner} allows {allowed}: design it with a"
                " lower voltage"
            )
    fastest = max(step.sliding_speed for step in hold.speeds) / (pi * devices.groove_diameter)
    if fastest > devices.motor.rotation_speed_maximum * (1 + 1e-9):
        most_turns = format_si(devices.motor.rotation_speed_maximum, "1/s")
        raise InvalidInput(
            f"speeds need {format_si(fastest, '1/s')}; {devices.motor.name} turns at most at {most_turns}"
        )
    total = hold.run_in + hold.duration
    if total > hold.limits.duration_maximum * (1 + 1e-9):
        lasts, allowed = format_si(total, "s"), format_si(hold.limits.duration_maximum, "s")
        raise InvalidInput(f"duration: the test lasts {lasts}; limits.duration_maximum is {allowed}")


_SETTLED = 2.0  # deviations of the scatter
_FINAL_FRACTION = 2  # the last half of a phase is its steady part


@dataclass(frozen=True, kw_only=True, slots=True)
class HoldMetrics:
    """Figures of merit of friction held at one sliding speed.

    Parameters
    ----------
    start_time : float
        When the speed was set. [s]
    sliding_speed : float
        [m/s]
    friction_force : float
        Mean over the last half of the phase. [N]
    tracking_error : float
        Root mean square of friction less reference over that half. [N]
    scatter : float
        Standard deviation of the friction over that half, in N.
    settling_time : float or None
        After which the friction stays within two deviations of the scatter of its reference, but for one interval in
        twenty; None where it does not. [s]
    voltage_peak_to_peak : float
        Mean over the last half. [V]
    saturated_fraction : float
        Share of the intervals of the phase at the highest voltage or at none.
    """

    start_time: float
    sliding_speed: float
    friction_force: float
    tracking_error: float
    scatter: float
    settling_time: float | None
    voltage_peak_to_peak: float
    saturated_fraction: float


def hold_metrics(record: HeldFriction) -> tuple[HoldMetrics, ...]:
    """Figures of merit from one change of speed to the next.

    Parameters
    ----------
    record : HeldFriction

    Returns
    -------
    tuple of HoldMetrics
        One for each speed that was reached.

    Raises
    ------
    InvalidInput
        If the controller never took over.
    """
    if record.time.size == 0:
        raise InvalidInput(f"the controller never took over: {record.reason}")
    changes = np.flatnonzero(np.diff(record.sliding_speed)) + 1
    edges = [0, *changes.tolist(), record.time.size]
    return tuple(_phase(record, slice(a, b)) for a, b in pairwise(edges))


def _phase(record: HeldFriction, part: slice) -> HoldMetrics:
    """Figures of merit of one phase."""
    force, volts = record.friction_force[part], record.voltage_peak_to_peak[part]
    time, error = record.time[part], force - record.setpoint[part]
    last = slice(-max(force.size // _FINAL_FRACTION, 1), None)
    scatter = float(np.std(force[last]))
    saturated = (volts >= record.hold.controller.level_maximum * (1 - 1e-9)) | (volts <= 0)
    return HoldMetrics(
        start_time=float(time[0]),
        sliding_speed=float(record.sliding_speed[part][0]),
        friction_force=float(np.mean(force[last])),
        tracking_error=float(np.sqrt(np.mean(error[last] ** 2))),
        scatter=scatter,
        settling_time=_settling_time(time - time[0], np.abs(error) > _SETTLED * scatter),
        voltage_peak_to_peak=float(np.mean(volts[last])),
        saturated_fraction=float(np.mean(saturated)),
    )


def _settling_time(time: "np.ndarray", outside: "np.ndarray") -> float | None:
    """First time from which on at most one entry in twenty lies outside."""
    later = np.cumsum(outside[::-1])[::-1]
    remaining = np.arange(time.size, 0, -1)
    settled = np.flatnonzero(~outside & (later <= np.maximum(remaining / 20, 1)) & (remaining >= 5))
    return float(time[settled[0]]) if settled.size else None


_COLUMNS = ("time", "friction_force", "friction_force_deviation", "voltage_peak_to_peak", "sliding_speed")


def held_friction_dataset(record: HeldFriction, *, title: str) -> "xr.Dataset":
    """Friction, voltage and speed of each interval of the controller as a labelled dataset.

    Parameters
    ----------
    record : HeldFriction
    title : str

    Returns
    -------
    xarray.Dataset
        Over `time` since the controller took over; reference, intrinsic friction, outcome and reason are attributes.
    """
    found = dataset({name: getattr(record, name) for name in _COLUMNS}, along="time", title=title)
    return found.assign_attrs(
        reference_friction_force=record.hold.friction_force,
        intrinsic_friction_force=record.intrinsic_friction_force,
        outcome=record.outcome,
        reason=record.reason,
    )


_SIZE = (6.85, 5.2)  # inches: 174 mm


def held_friction_chart(record: HeldFriction, *, simulated: bool) -> Chart:
    """Friction force with its reference, drive voltage and sliding speed over time.

    Parameters
    ----------
    record : HeldFriction
    simulated : bool
        Whether no hardware moved.

    Returns
    -------
    Chart
        Friction as means over the intervals, with the deviation of the samples within each as a band.
    """
    time, force, band = record.time, record.friction_force, record.friction_force_deviation
    intrinsic, highest = record.intrinsic_friction_force, record.hold.controller.level_maximum
    source = "simulated" if simulated else "measured"
    friction = (
        Band(x=time, low=force - band, high=force + band, label="±1 deviation of samples", colour=5, opacity=0.5),
        Line(x=time, y=force, label=f"friction, {source}"),
        Line(x=time, y=record.setpoint, label="reference", colour=6, dash=1, weight=0.85),
        Rule(value=intrinsic, along="y", label="without vibration, before", colour=1, dash=3),
    )
    drive = (
        Line(x=time, y=record.voltage_peak_to_peak, colour=1, is_stepped=True),
        Rule(value=highest, along="y", label="highest of the controller", colour="0.45", dash=2),
    )
    speed = (Line(x=time, y=1e3 * record.sliding_speed, is_stepped=True),)
    greatest = float(np.nanmax([*(force + band), *record.setpoint, intrinsic]))
    fastest = 1.15e3 * float(record.sliding_speed.max(initial=0.0)) or 1.0
    x = Axis(label="Time under control", unit="s", lowest=float(time[0]), highest=float(time[-1]))
    panels = (
        Panel(x=x, y=Axis(label="Friction force", unit="N", lowest=0.0, highest=1.1 * greatest), parts=friction),
        Panel(x=x, y=Axis(label="Drive, peak to peak", unit="V", lowest=0.0, highest=1.35 * highest), parts=drive),
        Panel(x=x, y=Axis(label="Sliding speed", unit="mm/s", lowest=0.0, highest=fastest), parts=speed),
    )
    return Chart(panels=panels, size=_SIZE, heights=(2, 1, 1), legend="top", legend_columns=4, shares_x=True)
