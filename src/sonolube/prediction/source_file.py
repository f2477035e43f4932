"""Files of published friction tests: their keys, and the conditions and the friction ratio of each point.

One TOML file holds one source, with its tests by rig; a key of a rig holds for all of its points.
"""

import re
from dataclasses import dataclass
from math import hypot, pi
from typing import Annotated, Any, Final, Literal, TypeAlias

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput
from sonolube.rig.file.section import Section, quantity_in_si
from sonolube.rig.file.toml_file import prefixed
from sonolube.rig.vibration_direction import VibrationDirection
from sonolube.text.units import unit_description

_LARGEST_RATIO: Final = 3.0  # of friction; beyond it no test lies
_SMALLEST_UNCERTAINTY: Final = 1e-3  # of a ratio, below which a misprint is likely
_LARGEST_SPREAD: Final = 3.0  # of the logarithm of an amplitude
_RANGE: Final = re.compile(r"(.+?)\s+to\s+(.+)")
_SCATTER: Final = re.compile(r"(.+?)\s*(?:\+-|\+/-|±)\s*(.+)")


@dataclass(frozen=True, slots=True)
class Printed:
    """Printed value with its scatter or range.

    Parameters
    ----------
    value : float
        In SI; of a range its middle.
    scatter : float or None
        Half width of the scatter or range, in SI; None where none is printed.
    is_range : bool
        Whether a lower and an upper value are printed.
    """

    value: float
    scatter: float | None = None
    is_range: bool = False

    @property
    def ends(self) -> tuple[float, float]:
        """Lower and upper end."""
        half = self.scatter or 0.0
        return self.value - half, self.value + half


@dataclass(frozen=True)
class PrintedText:
    """Value written as "3 N", "3 N +- 0.1 N" or "2 N to 4 N"; to annotate a field with.

    Parameters
    ----------
    unit : str
        SI unit; empty for pure numbers, which need no quotes.
    """

    unit: str

    def printed(self, value: object) -> Printed:
        """Value with its scatter or range, in SI."""
        if isinstance(value, Printed):
            return value
        if isinstance(value, str) and (found := _RANGE.fullmatch(value.strip())):
            low, high = (quantity_in_si(each, unit=self.unit) for each in found.groups())
            if not low < high:
                raise ValueError(f"{value} is no range: its second value must be the larger")
            return Printed((low + high) / 2, (high - low) / 2, is_range=True)
        if isinstance(value, str) and (found := _SCATTER.fullmatch(value.strip())):
            middle, half = (quantity_in_si(each, unit=self.unit) for each in found.groups())
            if half < 0:
                raise ValueError(f"{value} has a negative scatter")
            return Printed(middle, half)
        return Printed(quantity_in_si(value, unit=self.unit))

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Read a text or a pure number."""
        return core_schema.no_info_plain_validator_function(self.printed)

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Text, or a number where it has no unit."""
        kind: Any = "string" if self.unit else ["number", "string"]
        return {"type": kind, "description": unit_description(self.unit), "x-si-unit": self.unit}


Force: TypeAlias = Annotated[Printed, PrintedText("N")]
Pure: TypeAlias = Annotated[Printed, PrintedText("")]
Direction: TypeAlias = Literal["normal", "along", "across"]

_WAYS: Final = (
    ("friction_ratio",),
    ("friction_reduction",),
    ("intrinsic_friction_force", "reduced_friction_force"),
    ("intrinsic_friction_coefficient", "reduced_friction_coefficient"),
)
"""Keys by which a point states its friction ratio, the first that is complete."""


class _Conditions(Section):
    """Keys that stand at a rig, for all of its points, or at a point."""

    normal_load: Force | None = Field(default=None, description='Normal load, such as "5 N" or "60 N to 240 N"')
    sliding_speed: float | None = None
    vibration_amplitude: float | None = None
    vibration_velocity: float | None = None
    frequency: float | None = None
    intrinsic_friction_force: Force | None = Field(
        default=None, description='Friction force without vibration, such as "3.2 N", "3.2 N +- 0.1 N" or "3 N to 4 N"'
    )
    reduced_friction_force: Force | None = Field(default=None, description="Friction force with vibration, likewise")
    intrinsic_friction_coefficient: Pure | None = Field(
        default=None, description="Coefficient of friction without vibration, such as 0.4 or '0.4 +- 0.02'"
    )
    reduced_friction_coefficient: Pure | None = Field(
        default=None, description="Coefficient of friction with vibration, likewise"
    )
    friction_ratio: Pure | None = Field(default=None, description="Friction with vibration over friction without")
    friction_reduction: Pure | None = Field(default=None, description="One less that ratio, such as 0.4 for 40 %")
    uncertainty: float | None = Field(
        default=None, description="Standard uncertainty of the friction ratio, in place of that from the scatter"
    )

    def require_possible(self) -> None:
        """Refuse conditions that no test has."""
        names = ("sliding_speed", "vibration_amplitude", "vibration_velocity", "frequency")
        for name in names:
            if (value := getattr(self, name)) is not None:
                require_positive(**{name: value})
        if self.uncertainty is not None and not _SMALLEST_UNCERTAINTY <= self.uncertainty <= 1.0:
            raise InvalidInput(
                f"uncertainty {self.uncertainty:g} must lie between {_SMALLEST_UNCERTAINTY:g} and 1: it is of the"
                " friction ratio; leave it out where no scatter is printed"
            )
        for name in ("friction_ratio", "friction_reduction"):
            if (ratio := getattr(self, name)) is not None and not -_LARGEST_RATIO < ratio.value <= _LARGEST_RATIO:
                raise InvalidInput(f"{name} {ratio.value:g} is none that was ever measured; 40 % is 0.4")


class PointSection(_Conditions):
    """One measured friction ratio."""

    label: str = Field(description='Name of the point, such as "A-1" or "figure 5, 20 mm/s"', min_length=1)
    note: str = Field(default="", description="What is particular about it")


class TestedRigSection(_Conditions):
    """Points measured on one pair of bodies of one rig."""

    __test__ = False

    set: str = Field(description="Name of this rig among those of the source", min_length=1)
    title: str = Field(description="Which rig and test, and where in the source")
    direction: Direction | None = Field(
        default=None, description='Direction of the vibration; "normal" where absent, the normal of the contact'
    )
    vibration_direction: float | None = None
    materials: str = Field(default="", description="Both bodies, dry")
    amplitude_known: str = Field(
        description='How the amplitude is known, such as "measured with a vibrometer under load"', min_length=1
    )
    amplitude_spread: float | None = Field(
        default=None, description="Standard deviation of the logarithm of the amplitude; 0.05 where absent"
    )
    amplitude_factor: float = Field(
        default=1.0, description="Median factor on the amplitude, where it was not measured, such as a resonance's gain"
    )
    roughness: str = Field(default="", description="Roughness, of which body, before or after the tests")
    not_printed: list[str] = Field(default=[], description="What the source does not tell")
    caveats: list[str] = Field(default=[], description="Reasons for which the points may not be what they seem")
    points: list[PointSection] = Field(description="Measured friction ratios", min_length=1)

    def require_possible(self) -> None:
        """Refuse an amplitude that cannot be, and points without the conditions that a prediction needs."""
        super().require_possible()
        require_positive(amplitude_factor=self.amplitude_factor)
        if self.amplitude_spread is not None and not 0 < self.amplitude_spread <= _LARGEST_SPREAD:
            raise InvalidInput(
                f"amplitude_spread {self.amplitude_spread:g} must lie above 0 and not above {_LARGEST_SPREAD:g}:"
                " 0.7 is a factor of two"
            )
        if self.direction is not None and self.vibration_direction is not None:
            raise InvalidInput("give either direction or vibration_direction, an angle within the plane, got both")
        labels = [point.label for point in self.points]
        for label in labels:
            if labels.count(label) > 1:
                raise InvalidInput(f'label "{label}" is that of {labels.count(label)} points; name each of its own')
        for point in self.points:
            with prefixed(f'point "{point.label}"'):
                published_point(self, point)

    @property
    def path(self) -> VibrationDirection:
        """Direction of the vibration."""
        if self.vibration_direction is not None:
            return VibrationDirection(vibration_direction=self.vibration_direction)
        return VibrationDirection(direction=self.direction or "normal")


class SourceFile(Section):
    """A published source with the friction tests that it prints."""

    title: str = Field(description='Short name, such as "Luo et al."', min_length=1)
    citation: str = Field(description="Authors, journal or kind, volume, page and year", min_length=1)
    doi: str = Field(default="", description='Such as "10.1038/s41598-024-73652-w"')
    opened: str = Field(
        description='What was read: "full text", or "as quoted by ..."; title and abstract alone are no points',
        min_length=1,
    )
    rigs: list[TestedRigSection] = Field(description="Tests by rig", min_length=1)

    def require_possible(self) -> None:
        """Refuse what is no doi, abstracts and rigs of one name."""
        if self.doi and not self.doi.startswith("10."):
            raise InvalidInput(f'doi "{self.doi}" must begin with 10., without the address of a page')
        if "abstract" in self.opened.casefold():
            raise InvalidInput(
                f'opened "{self.opened}": an abstract has no points; type in what the full text prints, or leave it out'
            )
        names = [rig.set for rig in self.rigs]
        for name in names:
            if names.count(name) > 1:
                raise InvalidInput(f'set "{name}" is that of {names.count(name)} rigs; name each of its own')


@dataclass(frozen=True, kw_only=True, slots=True)
class PublishedPoint:
    """Measured friction ratio with its conditions.

    Parameters
    ----------
    label, note : str
    normal_load : Printed or None
        None where it is not printed. [N]
    sliding_speed : float
        Mean sliding speed. [m/s]
    vibration_amplitude : float or None
        Zero to peak; None where it is not printed, within the plane. [m]
    frequency : float or None
        Of the vibration; None where it is not printed, within the plane. [Hz]
    vibration_velocity : float
        Peak velocity of the vibration. [m/s]
    states_velocity : bool
        Whether the velocity is stated, and the amplitude follows from it.
    friction_ratio : float
        Friction with vibration over friction without. []
    uncertainty : float or None
        Standard uncertainty of that ratio; None where no scatter is printed.
    """

    label: str
    note: str
    normal_load: Printed | None
    sliding_speed: float
    vibration_amplitude: float | None
    frequency: float | None
    vibration_velocity: float
    states_velocity: bool
    friction_ratio: float
    uncertainty: float | None


def evidence_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) that every file of published tests follows.

    Returns
    -------
    dict
    """
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "sonolube evidence"} | {
        key: value for key, value in SourceFile.model_json_schema().items() if key != "title"
    }


def published_point(rig: TestedRigSection, point: PointSection) -> PublishedPoint:
    """Point of a rig with the conditions that hold for all points of the rig.

    A velocity and a frequency give the amplitude, and an amplitude and a frequency the velocity. Along the normal both
    amplitude and frequency must be known; within the plane the velocity does.
    """
    at = {name: _stated(rig, point, name) for name in _Conditions.model_fields}
    speed, frequency, amplitude, velocity = (
        at[name] for name in ("sliding_speed", "frequency", "vibration_amplitude", "vibration_velocity")
    )
    if amplitude is not None and velocity is not None:
        raise InvalidInput("give either vibration_amplitude or vibration_velocity, got both")
    if speed is None:
        raise InvalidInput("sliding_speed is missing: no law can be held against the point; leave it out")
    states_velocity = velocity is not None
    if frequency is not None:
        omega = 2 * pi * frequency
        amplitude = velocity / omega if amplitude is None and velocity is not None else amplitude
        velocity = omega * amplitude if velocity is None and amplitude is not None else velocity
    if velocity is None or (rig.path.is_normal and amplitude is None):
        needed = "vibration_amplitude and frequency" if rig.path.is_normal else "vibration_velocity"
        raise InvalidInput(f"{needed} must be given, at the point or at its rig; leave the point out where unknown")
    ratio, uncertainty = _ratio(rig, point)
    return PublishedPoint(
        label=point.label,
        note=point.note,
        normal_load=at["normal_load"],
        sliding_speed=speed,
        vibration_amplitude=amplitude,
        frequency=frequency,
        vibration_velocity=velocity,
        states_velocity=states_velocity,
        friction_ratio=ratio,
        uncertainty=at["uncertainty"] or uncertainty,
    )


def _stated(rig: TestedRigSection, point: PointSection, name: str) -> Any:
    """Entry of a point, or of its rig."""
    own = getattr(point, name)
    return getattr(rig, name) if own is None else own


def _ratio(rig: TestedRigSection, point: PointSection) -> tuple[float, float | None]:
    """Friction ratio of a point, and its uncertainty from what is printed; two scatters are taken as independent.

    Of two ranges, the mean of the ratios of the lower and of the upper values.
    """
    ways = [way for way in _WAYS if all(_stated(rig, point, name) is not None for name in way)]
    if not ways:
        raise InvalidInput(
            "needs friction_ratio, friction_reduction, or the friction force (or coefficient) with and without"
            " vibration: intrinsic_friction_force and reduced_friction_force"
        )
    if len(ways) > 1:
        raise InvalidInput(f"states its ratio by {' and by '.join(way[0] for way in ways)}; leave one out")
    values: list[Printed] = [_stated(rig, point, name) for name in ways[0]]
    ratio, uncertainty = _of_one(ways[0][0], values[0]) if len(values) == 1 else _of_two(*values)
    if not 0 <= ratio <= _LARGEST_RATIO:
        raise InvalidInput(f"its friction ratio is {ratio:.3g}; expected 0 to {_LARGEST_RATIO:g}")
    return ratio, uncertainty


def _of_one(name: str, printed: Printed) -> tuple[float, float | None]:
    """Ratio by itself or by the reduction."""
    return (1 - printed.value if name == "friction_reduction" else printed.value), printed.scatter


def _of_two(off: Printed, on: Printed) -> tuple[float, float | None]:
    """Ratio of friction with and without vibration."""
    require_positive(friction_without_vibration=off.value)
    ratio = on.value / off.value
    if off.is_range and on.is_range:
        low, high = (with_it / without for with_it, without in zip(on.ends, off.ends, strict=True))
        return (low + high) / 2, abs(high - low) / 2
    if off.scatter is None and on.scatter is None:
        return ratio, None
    return ratio, hypot((on.scatter or 0.0) / off.value, ratio * (off.scatter or 0.0) / off.value)
