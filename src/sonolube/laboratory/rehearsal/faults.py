"""Faults of a rig by name, for rehearsals: each with its effect on the signals, and what a generator tells of it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import sqrt
from types import MappingProxyType
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, suggestion
from sonolube.laboratory.block import Channel
from sonolube.laboratory.devices import DriveSetting
from sonolube.laboratory.virtual_tribometer.streams import OutputDistortion
from sonolube.text.units import format_si, to_si


@dataclass(frozen=True, kw_only=True, slots=True)
class Fault:
    """Fault of a rig.

    Parameters
    ----------
    name : str
    effect : str
        On the signals, in words.
    told_by : str
        Read-back of a generator that tells it, as in the checks of a device map; empty where none does.
    from_time : float
        Time of the rig from which on it acts, in s.
    """

    name: str
    effect: str
    told_by: str = ""
    from_time: float = 0.0

    @property
    def described(self) -> str:
        """Name, time and effect."""
        since = f" from {format_si(self.from_time, 's')} on" if self.from_time else ""
        return f"{self.name}{since}: {self.effect}"


_ALL: Final = (
    Fault(name="load_50_ohm", effect="twice the voltage: set for 50 ohm, into a high impedance", told_by="load"),
    Fault(name="unit_vrms", effect="numbers taken as Vrms: 2.83 times the voltage of a sine", told_by="unit"),
    Fault(
        name="channels_combined",
        effect="a second channel adds a sine of 1 kHz of the same amplitude",
        told_by="combination",
    ),
    Fault(
        name="am_left_on",
        effect="the amplitude goes up and down between 0 and its value at 100 Hz",
        told_by="modulation",
    ),
    Fault(name="overload_trip", effect="the overload protection has tripped: 0 V, recorded as set", told_by="trips"),
    Fault(name="off_ignored", effect="the drive stays on although off was sent and confirmed"),
    Fault(name="motor_stalls", effect="the disc stands, whatever was set"),
    Fault(name="friction_reversed", effect="friction force with the other sign: wires or sensor turned round"),
    Fault(name="thermocouple_open", effect="no number of instruments, the end of its range of an analogue input"),
    Fault(name="slow_sampling", effect="each acquisition samples at nine tenths of the rate that was asked for"),
    Fault(name="stale_block", effect="the block before comes once more"),
)
FAULTS: Final[Mapping[str, Fault]] = MappingProxyType({fault.name: fault for fault in _ALL})
"""Faults by name."""

_MODULATION: Final = 100.0  # Hz, of generators after they were switched on


def faults_named(texts: Sequence[str]) -> tuple[Fault, ...]:
    """Faults by their names, each with the time from which on it acts.

    Parameters
    ----------
    texts : sequence of str
        Such as load_50_ohm, or overload_trip@2s.

    Returns
    -------
    tuple of Fault

    Raises
    ------
    InvalidInput
        If a name is unknown, with all names; if it stands twice or its time is none.
    """
    found: dict[str, Fault] = {}
    for text in texts:
        name, at, since = text.partition("@")
        if name not in FAULTS:
            near = suggestion(name, list(FAULTS))
            raise InvalidInput(f"unknown fault {name[:40]!r}{near and f'; {near}'}; known: {', '.join(FAULTS)}")
        if name in found:
            raise InvalidInput(f"fault {name} is named twice; name it once")
        start = to_si(since, unit="s", name=f"fault {name}") if at else 0.0
        if start < 0:
            raise InvalidInput(f"fault {name}: its time must not be negative, got {since}")
        found[name] = replace(FAULTS[name], from_time=start)
    return tuple(found.values())


PEAK_TO_PEAK_OF_RMS: Final = MappingProxyType(
    {"sine": 2 * sqrt(2), "square": 2.0, "triangle": 2 * sqrt(3), "sawtooth": 2 * sqrt(3)}
)
"""Peak-to-peak value over the root mean square of each waveform. []"""

SLOW_SHARE: Final = 0.9
"""Sample rate over that which was asked for, where sampling is slow. []"""


class ActiveFaults:
    """Faults of a rehearsal, and which of them act.

    Parameters
    ----------
    faults : tuple of Fault
    """

    def __init__(self, faults: tuple[Fault, ...]) -> None:
        self.faults = faults
        self._acting = dict[str, Fault]()
        self._is_stale = False

    def begin(self, name: str) -> None:
        """Let a fault act from now on."""
        self._acting |= {fault.name: fault for fault in self.faults if fault.name == name}
        self._is_stale |= name == "stale_block"

    def acts(self, name: str) -> bool:
        """Whether a fault acts."""
        return name in self._acting

    def told_by(self, asked: Sequence[str]) -> list[Fault]:
        """Faults that act and that a read-back of these tells."""
        return [fault for fault in self._acting.values() if fault.told_by in asked]

    def takes_stale(self) -> bool:
        """Whether the block before comes once more, which it does once."""
        is_stale, self._is_stale = self._is_stale, False
        return is_stale

    def sensed(self, channel: Channel, values: Floats) -> Floats:
        """Values that the sensor of a channel passes on."""
        return -values if self.acts("friction_reversed") and channel.quantity == "friction_force" else values

    def read(self, channel: Channel, readings: Floats, *, broken: float) -> Floats:
        """Readings of a channel, of which that of a broken sensor is known."""
        is_open = self.acts("thermocouple_open") and channel.quantity == "temperature"
        return np.full_like(readings, broken) if is_open else readings

    def distortion(self, setting: DriveSetting | None) -> OutputDistortion:
        """Deviation of the output of the drive from a setting."""
        factor = 2.0 if self.acts("load_50_ohm") else 1.0
        if self.acts("unit_vrms") and setting is not None:
            factor *= PEAK_TO_PEAK_OF_RMS[setting.waveform]
        return OutputDistortion(
            factor=0.0 if self.acts("overload_trip") else factor,
            modulation_frequency=_MODULATION if self.acts("am_left_on") else 0.0,
            second_share=1.0 if self.acts("channels_combined") else 0.0,
        )
