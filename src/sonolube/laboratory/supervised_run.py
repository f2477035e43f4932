"""Runs on supervised devices: connected with their outputs off, and off and released again however a run ends."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from contextlib import ExitStack

from sonolube.errors import SonolubeError
from sonolube.facts.protocol import Limits
from sonolube.laboratory.devices import Devices, DriveSetting, Recorder, connect_devices, switch_outputs_off
from sonolube.laboratory.ending import RunEnded, ending, release_devices, tried
from sonolube.laboratory.interlocks import Trip, set_point_trip
from sonolube.laboratory.own_clocks import OwnClocks
from sonolube.laboratory.reservation import reserved
from sonolube.laboratory.run_control import RunControl
from sonolube.laboratory.sampling import Sampling
from sonolube.laboratory.states import Event, RunState, State, after
from sonolube.laboratory.supervision import Supervisor

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
    """

    _clocks: OwnClocks
    _sampling: Sampling

    def __init__(self, devices: Devices, recorder: Recorder | None, control: RunControl) -> None:
        self._supervisor = Supervisor(devices)
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
        with self._supervisor.at_work(), ExitStack() as held:
            try:
                self._happens(Event.START)
                held.enter_context(reserved(self._devices.resources))
                self._prepare(advance)
                self._clocks.begin(self._end_if_asked)
                self._is_connected = True
                connect_devices(self._devices)
                self._happens(Event.PREPARED)
                self._follow(advance)
                self._happens(Event.COMPLETED)
            except BaseException as failure:
                self._happens(*ending(failure))
                if not isinstance(failure, SonolubeError):
                    raise
            finally:
                self._close()

    def _happens(self, event: Event, reason: str = "") -> None:
        """Change the state of the run by an event, and note it."""
        self._present, _ = after(self._present, event, reason=reason)
        if event is not Event.START:
            self._note(event.value, reason=reason, state=self._present.state.value)

    def _note(self, kind: str, **facts: str | float) -> None:
        """Note what happened; while a run ends, a record that cannot be written is no hindrance."""
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

    def _end_at(self, trip: Trip | None) -> None:
        """End the run at a sample beyond a limit."""
        if trip is not None:
            raise RunEnded(Event.TRIP, trip.reason)

    def _require_within(self, setting: DriveSetting, limits: Limits) -> None:
        """End the run before a setting beyond the limit of the voltage is sent."""
        excess = set_point_trip(setting, limits)
        if excess:
            raise RunEnded(Event.TRIP, excess)

    def _switch_off(self) -> list[str]:
        """Switch drive and motor off where they were connected, and return what failed; never raises."""
        return switch_outputs_off(self._devices) if self._is_connected else []

    def _close(self) -> None:
        """Switch everything off, release the devices and close the record."""
        failures = self._switch_off()
        before = self._sampling.stop, self._clocks.end
        for reason in release_devices(self._devices, *before) if self._is_connected else tried(*before):
            self._note(Event.DEVICE_ERROR.value, reason=reason)
        self._happens(Event.NOT_OFF if failures else Event.OFF, "; ".join(failures))
        if self._recorder is not None:
            self._recorder.finish(self._present.outcome, reason=self._present.reason)
