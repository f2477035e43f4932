"""Steps that record, check, and ask the operator."""

import re
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, Final, Literal, Self, final

from pydantic import Field, field_validator, model_validator

from sonolube.facts.protocol.quantity_text import Hertz, Newtons, NoOrMoreNewtons, Seconds
from sonolube.facts.protocol.step import LONGEST_TEXT, Change, Recording, StepTable
from sonolube.text.units import format_si, to_si
from sonolube.vocabulary import unit_of

CheckedQuantity = Literal[
    "friction_force", "normal_load", "temperature", "sliding_speed", "rotation_speed", "vibration_amplitude"
]

_CHANNEL: Final = re.compile(r"[A-Za-z]\w{0,63}")
_LONGEST_NAME: Final = 500


@final
class Acquire(StepTable):
    """Start to record channels; the steps that follow run meanwhile.

    Parameters
    ----------
    channels : tuple of str
        Names, such as friction_force, voltage, current, temperature, gaussmeter.
    sample_rate : float
        Samples per second and channel. [Hz]
    duration : float
        [s]
    """

    example: ClassVar[Mapping[str, Any]] = MappingProxyType(
        {"channels": ["friction_force"], "sample_rate": "400 Hz", "duration": "1 s"}
    )

    kind: Literal["acquire"] = "acquire"
    channels: Annotated[tuple[str, ...], Field(strict=False, min_length=1, max_length=64)]
    sample_rate: Hertz
    duration: Seconds

    @field_validator("channels")
    @classmethod
    def _require_names(cls, channels: tuple[str, ...]) -> tuple[str, ...]:
        for channel in channels:
            if not _CHANNEL.fullmatch(channel):
                raise ValueError(
                    f"{channel[:40]!r} is no name of a channel; letters, digits and _, such as friction_force"
                )
        if len(set(channels)) < len(channels):
            raise ValueError("names a channel twice")
        return channels

    def changes(self) -> Iterator[Change]:
        """Recording that begins."""
        yield Change(record=Recording(channels=self.channels, sample_rate=self.sample_rate, duration=self.duration))


@final
class Check(StepTable):
    """Check that a quantity lies within bounds, each text with its unit; the run ends where it does not.

    Parameters
    ----------
    quantity : str
        Of the vocabulary.
    lowest, highest : str or None
        At least one of them.
    otherwise : str
        What to do where it does not: stop the test, wait until it does, or note it and go on.
    """

    example: ClassVar[Mapping[str, Any]] = MappingProxyType({"quantity": "temperature", "highest": "60 degC"})

    kind: Literal["check"] = "check"
    quantity: CheckedQuantity
    lowest: str | None = None
    highest: str | None = None
    otherwise: Literal["stop", "wait", "note"] = "stop"

    @model_validator(mode="after")
    def _require_bounds(self) -> Self:
        if self.lowest is None and self.highest is None:
            raise ValueError("needs lowest or highest")
        low, high = self.bounds
        if not low < high:
            raise ValueError(f"lowest {self.lowest!r} must be below highest {self.highest!r}")
        return self

    @property
    def bounds(self) -> tuple[float, float]:
        """Lowest and highest value in SI, infinite where absent."""
        unit = unit_of(self.quantity)
        low = float("-inf") if self.lowest is None else to_si(self.lowest, unit=unit, name="lowest")
        high = float("inf") if self.highest is None else to_si(self.highest, unit=unit, name="highest")
        return low, high

    def changes(self) -> Iterator[Change]:
        """None."""
        yield Change()

    @property
    def content(self) -> str:
        """Quantity with its bounds, and what is done otherwise."""
        return f"{self.quantity} from {self.lowest or 'any'} to {self.highest or 'any'}, else {self.otherwise}"


@final
class Prompt(StepTable):
    """Ask the operator to do something and to confirm it; the clock of the protocol stands still meanwhile.

    Parameters
    ----------
    task : str
        Kind of work.
    text : str
        What to do.
    normal_load : float or None
        That the operator sets, 0 for a lifted pin; None where it stays as it is. [N]
    lubricant : str or None
        That the operator applies, empty for a cleaned contact; None where it stays as it is.
    applied_force : float or None
        Greatest force with which the operator pulls at the pin along the sliding during the next recording, in loops
        of 30 s of which each goes further. [N]
    """

    example: ClassVar[Mapping[str, Any]] = MappingProxyType({"text": "Say here what the operator is to do."})

    kind: Literal["prompt"] = "prompt"
    task: Literal["cleaning", "mounting", "load", "profilometry", "other"] = "other"
    text: str = Field(min_length=1, max_length=LONGEST_TEXT)
    normal_load: NoOrMoreNewtons | None = None
    lubricant: str | None = Field(default=None, max_length=_LONGEST_NAME)
    applied_force: Newtons | None = None

    def changes(self) -> Iterator[Change]:
        """Load and lubricant that the operator changes."""
        yield Change(normal_load=self.normal_load, lubricant=self.lubricant)

    @property
    def content(self) -> str:
        """Task and text."""
        return f"{self.task}: {self.text}"

    def at_conditions(self, *, normal_load: float, sliding_speed: float) -> Self:
        """Same step with another load and its text, where it has a load."""
        del sliding_speed
        if self.normal_load is None:
            return self
        text = f"Set a normal load of {format_si(normal_load, 'N')}; bring the pin into contact."
        return self.model_copy(update={"normal_load": normal_load, "text": text})
