"""Runner: a protocol on the devices of a rig, recorded block by block; however it ends, motor and drive are off."""

from collections.abc import Callable
from itertools import pairwise
from math import pi
from threading import Event as Signal
from typing import Final

from sonolube.facts.protocol import Check, Prompt, Protocol, SetPoint, step_at
from sonolube.laboratory.block import BLOCK_DURATION
from sonolube.laboratory.devices import DeviceError, Devices, DriveSetting, Recorder
from sonolube.laboratory.interlocks import set_point_trip
from sonolube.laboratory.own_clocks import OwnClocks
from sonolube.laboratory.run_plan import (
    SETTLING,
    SPEED_CHANNEL,
    SPEEDS,
    CheckedValue,
    RunPlan,
    drive_setting,
    planned_run,
    rotation_speed,
    speed_checks,
)
from sonolube.laboratory.standing_rig import StandingRig
from sonolube.laboratory.states import Event, RunControl, RunEnded, RunState
from sonolube.laboratory.supervised_run import Advance, Sampling, SupervisedRun
from sonolube.laboratory.watching import RunWatcher, told
from sonolube.storage.interruption import asked_by_signal, undone_at_signal
from sonolube.text.units import format_si

_POLL: Final = 0.1  # s, between two looks at requests while a run is paused

Operator = Callable[[Prompt], bool]
"""Shows a prompt, and returns whether the operator has confirmed it; False ends the run."""


def run_protocol(
    protocol: Protocol,
    devices: Devices,
    recorder: Recorder,
    *,
    operator: Operator,
    control: RunControl | None = None,
    advance: Advance | None = None,
    watcher: RunWatcher | None = None,
    self_test: bool = True,
) -> RunState:
    """Run a protocol on devices and record it.

    Parameters
    ----------
    protocol : Protocol
    devices : Devices
        Not yet connected; released at the end.
    recorder : Recorder
        Of a new run; finished at the end.
    operator : callable
        Confirms prompts.
    control : RunControl, optional
        Requests of others.
    advance : callable, optional
        Reports progress.
    watcher : RunWatcher, optional
        Shown set points, blocks and events.
    self_test : bool
        Of devices that are not simulated, or stand for those of a device map, drive at a tenth of the first voltage for
        0.3 s before the first step and compare it with what a channel measures, and do so at every block. It vibrates
        the specimens.

    Returns
    -------
    RunState
        SAFE, or FAILED where motor or drive may be on; also where a device, a limit, the disk or the operator has ended
        the run.

    Raises
    ------
    InvalidInput
        If the devices cannot do what the protocol says; then nothing was connected.

    Notes
    -----
    The clock of the protocol is the sample counter of the acquisition, which samples from the first step to the last,
    recorded or not: so the limits are watched all the time. Blocks end where a set point changes. While an operator is
    asked, motor and drive are off, and the clock stands.
    """
    plan, control = planned_run(protocol, devices), control or RunControl()
    run = _Run(plan, devices, recorder, operator, control, watcher, self_test=self_test)
    with undone_at_signal(run.halt), asked_by_signal(control.stop):
        return run.complete(advance)


class _Run(SupervisedRun):
    """One run of a protocol."""

    def __init__(
        self,
        plan: RunPlan,
        devices: Devices,
        recorder: Recorder,
        operator: Operator,
        control: RunControl,
        watcher: RunWatcher | None,
        *,
        self_test: bool,
    ) -> None:
        super().__init__(devices, recorder, control, watcher, self_test=self_test)
        self._plan, self._protocol, self._operator = plan, plan.protocol, operator
        self._points, self._point, self._diameter = plan.points, plan.points[0], plan.groove_diameter
        self._limits = limits = plan.limits
        self._standing = StandingRig(self._devices, limits, sample_rate=plan.idle_rate, watcher=watcher)
        measured = [SPEED_CHANNEL] if speed_checks(plan.protocol) else []
        self._clocks = OwnClocks(devices, limits, watcher)
        self._sampling = Sampling(
            self._devices.acquisition, recorder, limits.locks, beside=self._clocks, also=measured, watcher=watcher
        )
        told(watcher, lambda each: each.begins(devices.channels, limits.locks))
        self._drive: DriveSetting | None = None
        self._turns = 0.0
        self._conditions: dict[str, float | str] = {"lubricant": ""}

    def complete(self, advance: Advance | None) -> RunState:
        """Follow the protocol to its end, whatever that is."""
        self._complete(advance)
        return self._present

    def _follow(self, advance: Advance | None) -> None:
        """Reach one set point after the other."""
        self._test_itself(self._plan.first_setting)
        for point, following in pairwise(self._points):
            self._reach(point)
            self._run_until(following.time, advance)
        self._read_back_drive()

    def _switch_off(self) -> list[str]:
        """Switch drive and motor off where they were connected, and return what failed; never raises."""
        failures = super()._switch_off()
        self._drive, self._turns = None, 0.0
        self._sampling.expect(None)
        return failures

    def _prepare(self, advance: Advance | None) -> None:
        """Prepare the set points that take the devices time, before anything is on."""
        prepare = self._devices.prepare
        if prepare is None:
            return
        wanted = dict.fromkeys((drive_setting(point), rotation_speed(point, self._diameter)) for point in self._points)
        for number, (setting, turns) in enumerate(wanted):
            self._end_if_asked()
            if advance is not None:
                advance("preparing set points", number, len(wanted))
            prepare(setting, turns)

    def _reach(self, point: SetPoint) -> None:
        """Set the set points with which a step begins, or begin its recording."""
        self._point = point
        told(self._watcher, lambda watcher: watcher.reaches(point))
        step = step_at(self._protocol, point.step)
        if isinstance(step, Prompt):
            self._ask(step)
        self._note_conditions()
        if not self._sampling.is_running:
            self._sample_again()
        if isinstance(step, Check):
            self._check(step)
        if point.begins_recording:
            assert point.sample_rate is not None
            self._sampling.record(point.channels, sample_rate=point.sample_rate)
            self._note("acquire", step=point.step, sample_rate=self._sampling.rate)
        self._set_outputs()
        self._read_back_drive()

    def _read_back_drive(self) -> None:
        """Read the drive back where it is on."""
        if self._drive is not None:
            self._read_back(step=self._point.step)

    def _sample_again(self) -> None:
        """Start to sample what is recorded now, or next."""
        later = (point for point in self._points if point.time >= self._sampling.time and point.channels)
        point = self._point if self._records_now else next(later, self._point)
        if self._records_now:
            assert point.sample_rate is not None
            self._sampling.record(point.channels, sample_rate=point.sample_rate)
        else:
            self._sampling.start(point.channels, sample_rate=point.sample_rate or self._plan.idle_rate)

    @property
    def _records_now(self) -> bool:
        """Whether the present set point is within a recording that has begun before it."""
        until = self._point.recorded_until
        return not self._point.begins_recording and until is not None and self._sampling.time < until

    def _set_outputs(self) -> None:
        """Set motor and drive as the present set point says."""
        point = self._point
        turns = rotation_speed(point, self._diameter)
        if turns != self._turns:
            self._devices.motor.turn(turns)
            self._turns = turns
            self._note("motor", step=point.step, rotation_speed=turns, sliding_speed=turns * pi * self._diameter)
        setting = drive_setting(point)
        if setting != self._drive:
            if setting is None:
                self._devices.drive.off()
            else:
                self._end_at(set_point_trip(setting, self._limits.stated))
                self._devices.drive.drive(setting)
            self._drive = setting
            self._sampling.expect(setting if self._tests_itself else None)
            frequency = 0.0 if setting is None else setting.frequency
            self._note("drive", step=point.step, voltage_peak_to_peak=point.voltage_peak_to_peak, frequency=frequency)

    def _note_conditions(self) -> None:
        """Note load and lubricant where the protocol tells others than before."""
        found: dict[str, float | str] = {"lubricant": self._point.lubricant}
        if self._point.normal_load is not None:
            found["normal_load"] = self._point.normal_load
        if found != self._conditions:
            self._conditions = found
            self._note("conditions", step=self._point.step, **found)

    def _ask(self, prompt: Prompt) -> None:
        """Ask the operator with motor and drive off, while the clock stands."""
        self._pause(f"{prompt.task}: {prompt.text}")
        with self._standing.watched(self._control), self._clocks.watched(self._control):
            is_confirmed = self._operator(prompt)
        if self._control.stop_reason:
            asked = (
                "interrupted by the operator"
                if self._control.stop_reason == "interrupted"
                else self._control.stop_reason
            )
            raise RunEnded(Event.STOP, f"{asked}, while asked: {prompt.text}")
        if not is_confirmed:
            raise RunEnded(Event.STOP, f"the operator did not confirm: {prompt.text}")
        if self._devices.attend is not None:
            self._devices.attend(prompt)
        self._happens(Event.RESUME)

    def _pause(self, reason: str) -> None:
        """Switch motor and drive off and stop to sample; what is recorded goes on in a part of its own."""
        self._happens(Event.PAUSE, reason)
        failures = self._switch_off()
        if failures:
            raise DeviceError("; ".join(failures))
        self._sampling.stop()

    def _wait_while_paused(self) -> None:
        """Hold the run while a pause is wanted."""
        self._pause("on request")
        wait = Signal()
        with self._standing.watched(self._control), self._clocks.watched(self._control):
            while self._control.is_paused and not self._control.stop_reason:
                wait.wait(_POLL)
        self._end_if_asked()
        self._happens(Event.RESUME)
        self._sample_again()
        self._set_outputs()

    def _run_until(self, time: float, advance: Advance | None) -> None:
        """Read block after block until a time of the protocol."""
        sampling, until = self._sampling, self._point.recorded_until
        while sampling.time < time:
            self._obey_requests()
            ends = [time, sampling.time + BLOCK_DURATION]
            if sampling.is_recording and until is not None:
                ends.append(until)
            self._end_at(sampling.read_until(min(ends)))
            if sampling.is_recording and until is not None and sampling.time >= until:
                sampling.end_recording()
                self._note("recorded")
            if advance is not None:
                advance(self._doing(), round(1e3 * sampling.time), round(1e3 * self._points[-1].time))

    def _obey_requests(self) -> None:
        """Stop or pause where that is wanted."""
        self._end_if_asked()
        if self._control.is_paused:
            self._wait_while_paused()

    def _check(self, check: Check) -> None:
        """Look at a quantity until it lies within its bounds, or do what the step says otherwise."""
        waited, longest = 0.0, self._protocol.limits.duration_maximum
        while True:
            found = self._checked(check)
            if found.holds:
                self._note("check", **found.facts)
                return
            is_settling = check.quantity in SPEEDS and not found.is_set and waited < SETTLING
            if not is_settling and check.otherwise == "note":
                self._note("check", reason=found.reason)
                return
            may_wait = found.value is not None and (is_settling or (check.otherwise == "wait" and waited <= longest))
            if not may_wait:
                raise RunEnded(Event.STOP, found.reason)
            self._obey_requests()
            waited += BLOCK_DURATION

    def _checked(self, check: Check) -> CheckedValue:
        """Value of a checked quantity, as measured; of a speed that nothing measures, as it is set."""
        is_speed = check.quantity in SPEEDS
        is_set = is_speed and SPEED_CHANNEL not in self._devices.channels
        value: float | None = self._turns
        if not is_set:
            value, trip = self._sampling.measure(SPEED_CHANNEL if is_speed else check.quantity)
            self._end_at(trip)
        if check.quantity == "sliding_speed" and value is not None:
            value = value * pi * self._diameter
        return CheckedValue(check=check, value=value, is_set=is_set)

    def _doing(self) -> str:
        """Line of progress, with friction and temperature where they are measured."""
        now = [f"step {self._point.step}", self._point.kind.replace("_", " ")]
        for name, unit in (("friction_force", "N"), ("temperature", "K")):
            value = self._sampling.mean(name)
            if value is not None:
                now.append(format_si(value, unit, digits=3))
        return ", ".join(now)
