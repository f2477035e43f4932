"""Loop: blocks of one control interval are read, the voltage computed and set; however it ends, all is off."""

from math import ceil, nan, pi
from typing import Final

import numpy as np

from sonolube.design.control import initial_state, next_level
from sonolube.errors import InvalidInput
from sonolube.laboratory.closed_loop.plan import FrictionHold, HeldFriction, recorded_channels
from sonolube.laboratory.devices import DeviceError, Devices, DriveSetting, Recorder
from sonolube.laboratory.interlocks import interlocks_for
from sonolube.laboratory.own_clocks import OwnClocks
from sonolube.laboratory.states import Event, RunControl, RunEnded, State
from sonolube.laboratory.supervised_run import Advance, Sampling, SupervisedRun
from sonolube.storage.interruption import asked_by_signal, undone_at_signal
from sonolube.text.units import format_si

_FRICTION: Final = "friction_force"


def hold_friction(
    hold: FrictionHold,
    devices: Devices,
    *,
    recorder: Recorder | None = None,
    control: RunControl | None = None,
    advance: Advance | None = None,
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
    loop = _Loop(hold, devices, recorder, control)
    with undone_at_signal(loop.halt), asked_by_signal(control.stop):
        return loop.complete(advance)


class _Loop(SupervisedRun):
    """One loop on devices."""

    def __init__(self, hold: FrictionHold, devices: Devices, recorder: Recorder | None, control: RunControl) -> None:
        super().__init__(devices, recorder, control)
        self._hold = hold
        channels = devices.acquisition.channels
        locks = interlocks_for(hold.limits, devices.channels, hold.drive_sampling)
        self._clocks = OwnClocks(devices, locks)
        self._sampling = Sampling(self._devices.acquisition, recorder, locks, beside=self._clocks)
        self._names = recorded_channels(hold, channels)
        self._interval = nan  # of the controller by the clock of the acquisition, in s
        self._rows: list[tuple[float, float, float, float]] = []
        self._run_in_means: list[float] = []

    def complete(self, advance: Advance | None) -> HeldFriction:
        """Run the loop to its end, whatever that is."""
        self._complete(advance)
        return self._result()

    def _follow(self, advance: Advance | None) -> None:
        """Run in, then control."""
        self._sample()
        self._control_friction(self._running_in(), advance)
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

    def _drive(self, voltage: float) -> None:
        """Set the drive to a peak-to-peak voltage."""
        if voltage <= 0:
            self._devices.drive.off()
            return
        setting = DriveSetting(
            voltage_peak_to_peak=voltage,
            voltage_offset=self._hold.offset_ratio * voltage,
            frequency=self._hold.frequency,
        )
        self._require_within(setting, self._hold.limits)
        self._devices.drive.drive(setting)

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
            is_safe=self._present.state is State.SAFE,
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
    interlocks_for(hold.limits, devices.channels, hold.drive_sampling)
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
