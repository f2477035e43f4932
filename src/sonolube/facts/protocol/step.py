"""Step of a protocol: what a kind of step gives, from which time line, limits, record, dry run and pages follow."""

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Final, Literal, Self, get_args

from sonolube.errors import InvalidInput
from sonolube.facts.protocol.quantity_text import Table
from sonolube.text.units import format_si

Waveform = Literal["sine", "square", "triangle", "sawtooth"]
Lane = Literal["motor", "drive", "record"]
"""Part of the rig whose set points a step sets; a recording that it begins counts as one."""

LONGEST_TEXT: Final = 2000
"""Number of characters of a text of a step."""

LANES: tuple[Lane, ...] = get_args(Lane)
"""All parts, in the order in which they are listed."""


@dataclass(frozen=True, kw_only=True, slots=True)
class MotorSetPoint:
    """Speed of the motor, of the contact or of the disc, the other one None.

    Parameters
    ----------
    sliding_speed : float or None
        [m/s]
    rotation_speed : float or None
        [1/s]
    """

    sliding_speed: float | None = None
    rotation_speed: float | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class DriveSetPoint:
    """Voltage of the actuator.

    Parameters
    ----------
    voltage_peak_to_peak : float
        0 switches the actuator off, whatever the frequency. [V]
    voltage_offset : float
        [V]
    frequency : float or None
        [Hz]
    waveform : str
    """

    voltage_peak_to_peak: float
    voltage_offset: float = 0.0
    frequency: float | None = None
    waveform: Waveform = "sine"


@dataclass(frozen=True, kw_only=True, slots=True)
class Recording:
    """Recording that begins, while the steps that follow run.

    Parameters
    ----------
    channels : tuple of str
    sample_rate : float
        [Hz]
    duration : float
        [s]
    """

    channels: tuple[str, ...]
    sample_rate: float
    duration: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Change:
    """Change of set points by a step, each None where it stays as it is, and the time until the next change.

    Parameters
    ----------
    duration : float
        [s]
    motor : MotorSetPoint or None
    drive : DriveSetPoint or None
    record : Recording or None
    normal_load : float or None
        [N]
    lubricant : str or None
    """

    duration: float = 0.0
    motor: MotorSetPoint | None = None
    drive: DriveSetPoint | None = None
    record: Recording | None = None
    normal_load: float | None = None
    lubricant: str | None = None

    @property
    def sets(self) -> tuple[Lane, ...]:
        """Parts of the rig that it sets."""
        return tuple(lane for lane in LANES if getattr(self, lane) is not None)


class StepTable(Table):
    """Step of a protocol; a kind of step is one final class with its entries, its key `kind`, and `changes`.

    Nothing else needs to know the kind: set points and their number, what is checked against devices and limits, what
    a record notes, the dry run, the lane of a page and the edits follow from the class.

    See Also
    --------
    sonolube.facts.protocol.record.Step : table of the kinds.
    """

    kind: str
    example: ClassVar[Mapping[str, Any]]
    """Entries of a new step of the kind, as they are written in TOML."""

    @abstractmethod
    def changes(self) -> Iterator[Change]:
        """Changes of set points that the step makes, at least one, in the order of time."""

    @property
    def change_count(self) -> int:
        """Number of changes; kinds with many give it without making them."""
        return sum(1 for _ in self.changes())

    @property
    def content(self) -> str:
        """Content of the step beside its set points, in one line."""
        return ""

    def at_conditions(self, *, normal_load: float, sliding_speed: float) -> Self:
        """Same step of a test at another load and speed.

        Parameters
        ----------
        normal_load : float
            [N]
        sliding_speed : float
            [m/s]

        Raises
        ------
        InvalidInput
            If the step sets load or speed, and its kind does not say how it would set others.
        """
        if any(change.motor is not None or change.normal_load is not None for change in self.changes()):
            there = f"{format_si(normal_load, 'N')} and {format_si(sliding_speed, 'm/s')}"
            raise InvalidInput(
                f"a step of kind {self.kind} sets load or speed, and has none for {there}; write them into the protocol"
            )
        return self
