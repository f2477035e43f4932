"""Test protocol: the table of the kinds of its steps, the limits of the rig, and the specimens."""

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, Final, Literal, Self, final, get_args

from pydantic import Field, model_validator

from sonolube.facts.protocol.acquisition_and_operator import Acquire, Check, Prompt
from sonolube.facts.protocol.output_steps import Drive, MotorSpeed, Sweep, VoltageSteps, Wait
from sonolube.facts.protocol.quantity_text import (
    MAX_STEPS,
    Amperes,
    Kelvins,
    Metres,
    Newtons,
    Seconds,
    Table,
    Volts,
    written_out,
)
from sonolube.facts.protocol.step import Change, StepTable


@final
class Repeat(StepTable):
    """Make steps several times, or once for each value of variables.

    Parameters
    ----------
    count : int
    steps : tuple of step
        Written out for all values where there are variables.
    over : mapping of str to tuple of str
        Values of variables, which stand as {name} in the texts of the steps: all combinations, those of the last
        variable in turn for each of the one before. Empty in a record that was read, whose steps are written out.
    """

    example: ClassVar[Mapping[str, Any]] = MappingProxyType(
        {"count": 2, "steps": [{"kind": "wait", "duration": "1 s"}]}
    )

    kind: Literal["repeat"] = "repeat"
    count: int = Field(default=1, ge=1, le=10_000)
    steps: "Annotated[tuple[Step, ...], Field(strict=False, min_length=1, max_length=MAX_STEPS)]"
    over: dict[str, Annotated[tuple[str, ...], Field(strict=False, min_length=1, max_length=1000)]] = Field(
        default_factory=dict
    )

    @model_validator(mode="before")
    @classmethod
    def _write_out(cls, content: Any) -> Any:
        if not isinstance(content, dict):
            return content
        if "count" not in content and not content.get("over"):
            raise ValueError("needs count, or over with the values of variables")
        return written_out(content)

    def changes(self) -> Iterator[Change]:
        """Changes by its steps, as often as it makes them."""
        for _ in range(self.count):
            for step in self.steps:
                yield from step.changes()

    @property
    def change_count(self) -> int:
        """Number of changes by its steps, as often as it makes them."""
        return self.count * sum(step.change_count for step in self.steps)

    def at_conditions(self, *, normal_load: float, sliding_speed: float) -> Self:
        """Same steps at another load and speed."""
        steps = (step.at_conditions(normal_load=normal_load, sliding_speed=sliding_speed) for step in self.steps)
        return self.model_copy(update={"steps": tuple(steps)})


Step = Annotated[
    Wait | MotorSpeed | Drive | Acquire | VoltageSteps | Sweep | Repeat | Check | Prompt, Field(discriminator="kind")
]
"""Step of any kind, by its key `kind`: the table of the kinds, from which all other lists of them follow."""

Repeat.model_rebuild()

STEP_CLASSES: Final[Mapping[str, type[StepTable]]] = MappingProxyType(
    {each.model_fields["kind"].default: each for each in get_args(get_args(Step)[0])}
)
"""Classes of the steps by their `kind`."""

STEP_KINDS: Final = tuple(STEP_CLASSES)
"""Values of `kind`."""


_TEXT = 500


class Limits(Table):
    """Limits beyond which the test is ended.

    Parameters
    ----------
    voltage_maximum : float
        Magnitude of the drive voltage, its offset included. [V]
    duration_maximum : float
        Time of the whole test without prompts, in s.
    current_maximum : float or None
        Magnitude of the drive current. [A]
    temperature_maximum : float or None
        Of the actuator, in K.
    friction_force_maximum : float or None
        In N.
    """

    voltage_maximum: Volts
    duration_maximum: Seconds
    current_maximum: Amperes | None = None
    temperature_maximum: Kelvins | None = None
    friction_force_maximum: Newtons | None = None


class Metadata(Table):
    """Specimens and pair of materials of a test.

    Parameters
    ----------
    pin_material, disc_material : str
    normal_load : float or None
        [N]
    groove_diameter : float or None
        Of the middle of the wear track. [m]
    specimen : str
        Name of the pair of bodies.
    operator : str
        Who makes the test.
    humidity : str
        Relative humidity of the air, such as 45 %.
    calibrated : str
        Date of the latest calibration of the sensors, such as 2026-03-01.
    thermocouple : str
        Where the channel of the temperature measures: actuator or contact; empty where that is not said.
    creator : str
        Whose data the recordings are; the operator by default.
    institution : str
        Where the test is made.
    licence : str
        Under which others may use the recordings, such as CC-BY-4.0.
    run : int or None
        Row of the table of runs.
    block : int or None
        Runs made together, such as on one day.
    """

    pin_material: str = Field(default="", max_length=_TEXT)
    disc_material: str = Field(default="", max_length=_TEXT)
    normal_load: Newtons | None = None
    groove_diameter: Metres | None = None
    specimen: str = Field(default="", max_length=_TEXT)
    operator: str = Field(default="", max_length=_TEXT)
    humidity: str = Field(default="", max_length=_TEXT)
    calibrated: str = Field(default="", max_length=_TEXT)
    thermocouple: Literal["", "actuator", "contact"] = ""
    creator: str = Field(default="", max_length=_TEXT)
    institution: str = Field(default="", max_length=_TEXT)
    licence: str = Field(default="", max_length=_TEXT)
    run: int | None = Field(default=None, ge=1)
    block: int | None = Field(default=None, ge=1)


class Protocol(Table):
    """A test as a sequence of steps.

    Parameters
    ----------
    title : str
    source : str
        Where the procedure comes from.
    limits : Limits
    metadata : Metadata
    steps : tuple of step
        One after the other; `sonolube.facts.protocol.record` has their kinds.
    """

    title: str = Field(min_length=1, max_length=_TEXT)
    source: str = Field(min_length=1, max_length=_TEXT)
    limits: Limits
    metadata: Metadata = Metadata()
    steps: Annotated[tuple[Step, ...], Field(strict=False, min_length=1, max_length=1000)]
