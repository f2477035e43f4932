"""Standing rig, watched by a thread while an operator works at it: temperature, and that its outputs are off."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from math import inf
from threading import Event as Signal, Thread
from typing import Final

from sonolube.errors import SonolubeError
from sonolube.laboratory.block import BLOCK_DURATION, Block
from sonolube.laboratory.devices import RATE_ERROR, Acquisition, Devices
from sonolube.laboratory.interlocks import IDLE_RATE, SAMPLES_PER_PERIOD, WAVES, Interlock, RunLimits, first_trip
from sonolube.laboratory.states import Event, RunControl, RunEnded, ending
from sonolube.laboratory.watching import RunWatcher, told
from sonolube.text.units import format_si

_VIRTUAL: Final = 2.0  # s, of the time of virtual devices
SETTLING: Final = {"drive": 1.0, "motor": 10.0}
"""Time in which amplifier and disc come to rest. [s]"""


class StandingRig:
    """Watch over devices whose motor and drive were switched off.

    Parameters
    ----------
    devices : Devices
        Virtual ones, whose time does not go on by itself, are watched for two seconds.
    limits : RunLimits
        Of the run; those of the temperature hold here too.
    sample_rate : float
        Highest that the protocol uses. [Hz]
    watcher : RunWatcher, optional
        Shown every block.
    """

    def __init__(
        self, devices: Devices, limits: RunLimits, *, sample_rate: float, watcher: RunWatcher | None = None
    ) -> None:
        self._watcher = watcher
        self._acquisition = devices.acquisition
        channels, self._lasts = devices.acquisition.channels, inf if devices.clock is None else _VIRTUAL
        self._off = [(what, lock) for what, lock in limits.off if lock.channel.name in channels]
        self._always = [
            lock for lock in limits.locks if lock.channel.is_watched_at_rest and lock.channel.name in channels
        ]
        self._names = [lock.channel.name for lock in (*self._always, *(lock for _, lock in self._off))]
        self._wanted_rate, self._rate, self._time = min(sample_rate, IDLE_RATE), 0.0, 0.0
        self._failure: BaseException | None = None

    @contextmanager
    def watched(self, control: RunControl) -> Iterator[None]:
        """Watch inside a `with` block, by a thread, from when outputs were switched off."""
        if not self._names:
            yield
            return
        self._rate, self._time = self._acquisition.start(self._names, sample_rate=self._wanted_rate), 0.0
        ended = Signal()
        thread = Thread(target=self._look_on, args=(ended, control), daemon=True, name="sonolube standing rig")
        thread.start()
        try:
            yield
        finally:
            if self._lasts == inf:
                ended.set()
            thread.join()
            self._acquisition.stop()
        if self._failure is not None:
            raise self._failure

    def _look_on(self, ended: Signal, control: RunControl) -> None:
        """Read block after block until the end, or until something is wrong."""
        try:
            while not ended.is_set() and self._time < self._lasts:
                if trip := self._look():
                    raise RunEnded(Event.TRIP, trip)
        except BaseException as failure:  # whatever a driver raises, the rig is watched no more
            self._failure = failure
            control.stop(ending(failure)[1])

    def _look(self) -> str:
        """Read a block, and return what is wrong; empty where nothing is."""
        block = self._acquisition.read(max(1, round(BLOCK_DURATION * self._rate)))
        self._time += block.samples / self._rate
        told(self._watcher, lambda watcher: watcher.takes_aside(self._names, block))
        return first_trip(block, self._names, self._always) or still_on(block, self._names, self._off, self._time)


def measured_outputs(devices: Devices, limits: RunLimits) -> dict[str, str]:
    """Outputs that channels of the acquisition show after they were switched off.

    Parameters
    ----------
    devices : Devices
    limits : RunLimits
        Samples of the voltage of its drive show it from five a period of the highest frequency on.

    Returns
    -------
    dict of str to str
        By output, empty where it is off, else why it counts as on; outputs that no channel shows are left out.
    """
    channels = devices.acquisition.channels
    shown = [(what, lock) for what, lock in limits.off if lock.channel.name in channels]
    fast = max(IDLE_RATE, SAMPLES_PER_PERIOD * limits.frequency)
    slowly = [(what, lock) for what, lock in shown if lock.channel.name not in WAVES]
    found = _seen(devices.acquisition, shown, rate=fast)
    return found if found or len(slowly) == len(shown) else _seen(devices.acquisition, slowly, rate=IDLE_RATE)


def _seen(acquisition: Acquisition, bounds: Sequence[tuple[str, Interlock]], *, rate: float) -> dict[str, str]:
    """Whether outputs come to rest by channels sampled at a rate or more; empty where the acquisition cannot tell."""
    names, on, time = [lock.channel.name for _, lock in bounds], {what: "not seen" for what, _ in bounds}, 0.0
    if not on:
        return {}
    try:
        acquisition.stop()
        given = acquisition.start(names, sample_rate=rate)
        if given < rate * (1 - RATE_ERROR):
            return {}
        while any(on.values()) and time <= max(SETTLING[what] for what in on):
            block = acquisition.read(max(1, round(BLOCK_DURATION * given)))
            time += block.samples / given
            on = {what: still_on(block, names, [each for each in bounds if each[0] == what], inf) for what in on}
    except SonolubeError:
        return {}  # what answers no more shows nothing
    return on


def still_on(block: Block, names: Sequence[str], off: Sequence[tuple[str, Interlock]], stands: float) -> str:
    """Why an output that was switched off some time ago, in s, counts as on by a block; empty where none does."""
    for what, lock in off:
        trip = first_trip(block, names, [lock]) if stands > SETTLING[what] else ""
        if trip:
            most = format_si(lock.limit, lock.channel.unit)
            return f"the {what} was switched off, but {trip.partition(';')[0]} (off is up to {most}): cut the power"
    return ""
