"""Runs on supervised devices: connected with their outputs off, sampled, and off and released again however a run ends.

Blocks are held to the sample counter and to the limits, and recorded where a step says so.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import replace

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import SonolubeError
from sonolube.laboratory.block import BLOCK_DURATION, Block
from sonolube.laboratory.devices import (
    Acquisition,
    DeviceError,
    DeviceLost,
    Devices,
    DriveSetting,
    Recorder,
    connect_devices,
    require_gapless,
    switch_outputs_off,
)
from sonolube.laboratory.interlocks import IDLE_RATE, SAMPLES_PER_PERIOD, Interlock, RunLimits, first_trip
from sonolube.laboratory.own_clocks import OwnClocks
from sonolube.laboratory.run_plan import reserved
from sonolube.laboratory.set_and_measured import (
    SELF_TEST_TIME,
    SETTLING,
    difference,
    is_near,
    monitor_of,
    self_test_setting,
)
from sonolube.laboratory.standing_rig import measured_outputs
from sonolube.laboratory.states import (
    Event,
    RunControl,
    RunEnded,
    RunState,
    State,
    after,
    ending,
    release_devices,
    tried,
)
from sonolube.laboratory.supervision import Supervisor
from sonolube.laboratory.verdict import Verdict, verdict_on, verdict_text
from sonolube.laboratory.watching import RunWatcher, told


class Sampling:
    """Acquisition of a run, whose sample counter is the clock of the protocol.

    Parameters
    ----------
    acquisition : Acquisition
    recorder : Recorder or None
    locks : sequence of Interlock
        Those of other acquisitions are left to `beside`.
    beside : OwnClocks
        Acquisitions with clocks of their own, which were begun.
    also : sequence of str
        Channels that are sampled with them where the acquisition has them.
    watcher : RunWatcher, optional
        Shown every block.
    """

    def __init__(
        self,
        acquisition: Acquisition,
        recorder: Recorder | None,
        locks: Sequence[Interlock],
        *,
        beside: OwnClocks,
        also: Sequence[str] = (),
        watcher: RunWatcher | None = None,
    ) -> None:
        self._acquisition, self._recorder, self._beside = acquisition, recorder, beside
        self._watcher = watcher
        self._locks = [lock for lock in locks if lock.channel.name in acquisition.channels]
        self._watched = [lock.channel.name for lock in self._locks]
        self._watched += [name for name in also if name in acquisition.channels and name not in self._watched]
        self._names: list[str] = []
        self._recorded = 0  # of them, the first ones
        self._origin = 0.0  # time of the protocol at sample 0
        self._recording = False
        self._latest: Block | None = None
        self._expected: DriveSetting | None = None
        self._expected_from = 0.0  # time of the protocol from which it is compared with what is measured
        self.rate = 0.0
        self.sample = 0
        self.time = 0.0

    @property
    def is_running(self) -> bool:
        """Whether samples are taken."""
        return self.rate > 0

    @property
    def is_recording(self) -> bool:
        """Whether samples are recorded."""
        return self._recording

    def start(self, channels: Sequence[str], *, sample_rate: float) -> None:
        """Sample channels to be recorded, and those that limits watch, from sample 0 on.

        Parameters
        ----------
        channels : sequence of str
        sample_rate : float
            [Hz]
        """
        own = self._own(channels)
        watched = [name for name in self._watched if name not in own]
        self._names = [*own, *watched] or [next(iter(self._acquisition.channels))]
        self._recorded = len(own)
        self.rate = self._acquisition.start(self._names, sample_rate=sample_rate)
        self.sample, self._origin, self._latest = 0, self.time, None

    def expect(self, setting: DriveSetting | None) -> None:
        """Hold what is measured of the drive to a setting, a moment after it; to none where that is None.

        Of settings that follow each other closely, as those of a controller, the first has the moment.
        """
        if not is_near(self._expected, setting):
            self._expected_from = self.time + SETTLING
        self._expected = setting

    def stop(self) -> None:
        """Stop to sample and to record."""
        self.end_recording()
        if self.is_running:
            self.rate = 0.0
            self._acquisition.stop()

    def record(self, channels: Sequence[str], *, sample_rate: float) -> None:
        """Record channels from now on; the acquisition starts anew where it samples otherwise.

        Parameters
        ----------
        channels : sequence of str
        sample_rate : float
            [Hz]
        """
        own = self._own(channels)
        as_it_runs = self._names[: self._recorded] == own and bool(np.isclose(self.rate, sample_rate))
        if not as_it_runs:
            self.stop()
            self.start(channels, sample_rate=sample_rate)
        found = [self._acquisition.channels[name] for name in own]
        if self._recorder is not None:
            self._recorder.begin(found, sample_rate=self.rate)
        self._recording = True
        self._beside.record(channels)

    def end_recording(self) -> None:
        """Record no more."""
        if self._recording:
            self._recording = False
            if self._recorder is not None:
                self._beside.end_recording(self._recorder)
                self._recorder.end()

    def read_until(self, time: float) -> str:
        """Read the samples up to a time of the protocol, and return why one is beyond a limit; empty without. [s]"""
        count = round((time - self._origin) * self.rate) - self.sample
        trip = self._take(count) if count > 0 else ""
        self.time = time
        return trip

    def measure(self, channel: str) -> tuple[float | None, str]:
        """Mean of a channel over a block that is read for it while the clock of the protocol stands.

        Parameters
        ----------
        channel : str

        Returns
        -------
        float or None
            In SI; None where the channel is not sampled.
        str
            Why a sample is beyond a limit; empty where none is.
        """
        if self.mean(channel) is None and channel not in self._names:
            return None, ""
        count = max(1, round(BLOCK_DURATION * self.rate))
        trip = self._take(count)
        self._origin -= count / self.rate
        return self.mean(channel), trip

    def mean(self, channel: str) -> float | None:
        """Mean of a channel over the latest block, in SI; None where it is not sampled."""
        if channel not in self._names:
            return self._beside.mean(channel)
        return None if self._latest is None else float(np.mean(self.samples(channel)))

    def samples(self, channel: str) -> Floats:
        """Samples of a channel of the latest block, in SI."""
        assert self._latest is not None
        return self._latest.values[:, self._names.index(channel)]

    def _own(self, channels: Sequence[str]) -> list[str]:
        """Those of channels that the acquisition has."""
        return [name for name in channels if name in self._acquisition.channels]

    def _take(self, count: int) -> str:
        """Read samples, hold them to the counter and to the limits, and record them."""
        block = self._acquisition.read(count)
        require_gapless(block, self.sample, device=self._acquisition.name)
        self.sample, self._latest = block.next_sample, block
        if self._recording and self._recorder is not None:
            values = block.values[:, : self._recorded]
            self._recorder.append(Block(first_sample=block.first_sample, sample_rate=self.rate, values=values))
        trip = first_trip(block, self._names, self._locks)
        if self._expected is not None and self._origin + block.start >= self._expected_from:
            trip = trip or difference(block, self._names, self._expected)
        told(self._watcher, lambda watcher: watcher.takes(self._names, block, time=self._origin + block.start))
        if not trip:
            self._beside.keep(self._recorder)
        return trip


Advance = Callable[[str, int, int], None]
"""Takes what happens now, the time done and the whole time, in ms."""


class SupervisedRun(ABC):
    """One run: states, devices and record meet here and in what a run does between.

    Parameters
    ----------
    devices : Devices
        Not yet connected.
    recorder : Recorder or None
    control : RunControl
    watcher : RunWatcher, optional
    self_test : bool
        Whether what a channel measures of the drive is held to what was set, on devices that are not simulated and
        on those of a map that is rehearsed.
    """

    _clocks: OwnClocks
    _sampling: Sampling
    _limits: RunLimits

    def __init__(
        self,
        devices: Devices,
        recorder: Recorder | None,
        control: RunControl,
        watcher: RunWatcher | None = None,
        *,
        self_test: bool,
    ) -> None:
        self._tests_itself = self_test and (devices.rehearsed or not devices.simulated)
        self._supervisor, self._watcher = Supervisor(devices), watcher
        self._devices, self._recorder, self._control = self._supervisor.devices, recorder, control
        self._present, self._is_connected = RunState(), False

    @abstractmethod
    def _follow(self, advance: Advance | None) -> None:
        """Do what the run is for, on connected devices."""

    def _prepare(self, advance: Advance | None) -> None:  # noqa: B027  most runs prepare nothing
        """Prepare what takes the devices time, before anything is on."""

    def halt(self) -> None:
        """Switch drive and motor off at once, whatever the run waits for; never raises."""
        if self._is_connected:
            self._supervisor.halt()

    def _complete(self, advance: Advance | None) -> None:
        """Follow the run to its end, whatever that is."""
        fault: BaseException | None = None
        with self._supervisor.at_work(), ExitStack() as held:
            try:
                self._happens(Event.START)
                held.enter_context(reserved(self._devices.resources))
                self._prepare(advance)
                self._clocks.begin(self._end_if_asked)
                if self._devices.switch_off is not None:
                    self._devices.switch_off.begin()
                self._is_connected = True
                connect_devices(self._devices)
                self._happens(Event.PREPARED)
                self._follow(advance)
                self._happens(Event.COMPLETED)
            except BaseException as failure:
                self._happens(*ending(failure))
                fault = None if isinstance(failure, SonolubeError) else failure
            finally:
                self._close()
        if fault is not None:  # of the program, or of a function of the caller
            fault.add_note(f"motor and drive: {verdict_text(self._present.verdict)}")
            raise fault

    def _happens(self, event: Event, reason: str = "") -> None:
        """Change the state of the run by an event, and note it."""
        self._present = after(self._present, event, reason=reason)
        if event is not Event.START:
            verdict = {"outputs": verdict_text(self._present.verdict)} if event in (Event.OFF, Event.NOT_OFF) else {}
            self._note(event.value, reason=reason, state=self._present.state.value, **verdict)

    def _note(self, kind: str, **facts: str | float) -> None:
        """Note what happened; while a run ends, a record that cannot be written is no hindrance."""
        told(self._watcher, lambda watcher: watcher.notes(kind, facts))
        if self._recorder is None:
            return
        try:
            sample = self._sampling.sample if self._sampling.is_running else None
            self._recorder.note(kind, sample=sample, protocol_time=self._sampling.time, **facts)
        except SonolubeError:
            if self._present.state is State.RUNNING:
                raise

    def _end_if_asked(self) -> None:
        """End the run where that is wanted."""
        if self._control.stop_reason:
            raise RunEnded(Event.STOP, self._control.stop_reason)

    def _end_at(self, trip: str) -> None:
        """End the run at a sample beyond a limit, or before such a setting is sent."""
        if trip:
            raise RunEnded(Event.TRIP, trip)

    def _test_itself(self, first: DriveSetting | None) -> None:
        """Drive at a tenth of a first voltage, where a channel shows that, and compare set and measured."""
        setting, acquisition = self_test_setting(first), self._devices.acquisition
        if setting is None or not self._tests_itself:
            return
        rate = max(SAMPLES_PER_PERIOD * setting.frequency, IDLE_RATE)
        name = monitor_of(acquisition.channels, sample_rate=rate, frequency=setting.frequency)
        if not name:
            return
        facts: dict[str, str | float] = {
            "voltage_peak_to_peak": setting.voltage_peak_to_peak,
            "frequency": setting.frequency,
            "channel": name,
        }
        try:
            given = acquisition.start([name], sample_rate=rate)
        except DeviceLost:
            raise
        except DeviceError as refusal:  # of a rate that the run itself does not need
            self._note("self-test", **facts, reason=f"left out: {refusal}")
            return
        self._devices.drive.drive(setting)
        count = max(1, round(BLOCK_DURATION * given))
        locks = [each for each in self._limits.locks if each.channel.name == name]
        for number in range(round(SELF_TEST_TIME / BLOCK_DURATION)):
            block = acquisition.read(count)
            require_gapless(block, number * count, device=acquisition.name)
            self._end_at(first_trip(block, [name], locks))
        self._devices.drive.off()
        acquisition.stop()
        told = difference(block, [name], setting)
        self._note("self-test", **facts, reason=told)
        if told:
            raise RunEnded(Event.TRIP, f"self-test before the first step: {told}")

    def _read_back(self, **place: str) -> None:
        """Have the source of the drive say what it gives, and note that; it raises where that is not what was set."""
        read_back = getattr(self._devices.drive, "read_back", None)
        if read_back is not None and (answers := read_back()):
            self._note("read back", **place, answers=answers)

    def _switch_off(self) -> list[str]:
        """Switch drive and motor off where they were connected, and return what failed; never raises."""
        return switch_outputs_off(self._devices) if self._is_connected else []

    def _verdict(self) -> Verdict:
        """Switch motor and drive off, and say what is known of them then."""
        failures = [*self._switch_off(), *self._supervisor.settle()]
        measured = {} if failures else measured_outputs(self._devices, self._limits)
        return verdict_on(failures, measured)

    def _close(self) -> None:
        """Switch everything off, release the devices and close the record."""
        verdict, switch_off = self._verdict() if self._is_connected else None, self._devices.switch_off
        if verdict is not None and switch_off is not None:
            switch_off.tell(verdict)
        before = self._sampling.stop, self._clocks.end
        for reason in release_devices(self._devices, *before) if self._is_connected else tried(*before):
            self._note(Event.DEVICE_ERROR.value, reason=reason)
        is_off = verdict is None or verdict.is_off
        self._present = replace(self._present, verdict=verdict)
        self._happens(Event.OFF if is_off else Event.NOT_OFF, "" if verdict is None or is_off else verdict.text)
        if self._recorder is not None:
            self._recorder.finish(self._present.outcome, reason=self._present.reason)
        if switch_off is not None:
            switch_off.end()
