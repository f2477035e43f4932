"""Table `contact` of a rig file: load, bodies, and roughness as measured or as it is stated on a drawing.

The root mean square height follows from Ra, Rz or a finish, with the spread of the relation.
"""

import re
from dataclasses import dataclass, replace
from math import exp, hypot, log
from typing import Annotated, Any, Final, Literal

from pydantic import Discriminator, Field, Tag

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput, MissingProperty, UnknownName
from sonolube.facts.materials import material, yield_strength_from_hardness
from sonolube.models import surfaces
from sonolube.models.contact import ASPERITY_LAWS, HEIGHT_DISTRIBUTIONS, RoughContact
from sonolube.models.contact.elastic_bodies import (
    ContactPair,
    ElasticBody,
    contact_pair,
    identical_materials_mindlin_ratio,
)
from sonolube.models.surfaces import Roughness
from sonolube.rig.file.section import DECAY_LENGTHS, NameIn, Section
from sonolube.rig.record import DecayLengthOrigin, check_stated
from sonolube.text.units import format_si, to_si

FINISH_FORMS: Final = (
    "write a process, an ISO grade, both, Ra or Rz: 'ground', 'lapped', 'turned', 'N6', 'ground N6', 'Ra 0.4um',"
    " 'Rz 3.2um'"
)
"""Forms of a finish that are read, for refusals."""

_NUMBER: Final = re.compile(
    r"(?:(?!(?:ra|rz|rq|sa|sq|rms)\b)(?P<process>[a-z][a-z _-]*?)[ ,]+)?(?P<parameter>ra|rz|rq|sa|sq|rms)?[ ]*[=:]?[ ]*"
    r"(?P<number>(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:e-?\d+)?)[ ]*(?P<unit>[a-zµμ\"]*)",
    re.IGNORECASE,
)
_THOUSANDS: Final = re.compile(r"[1-9]\d{0,2},\d{3}")
_FINISHES: Final = (1e-10, 2e-4)  # m
_RMS_BETWEEN_PLACES: Final = (1 / 1.2, 1.2)  # two standard deviations of 10 %


@dataclass(frozen=True, kw_only=True, slots=True)
class StatedHeight:
    """Root mean square height inferred from what is stated of a surface.

    Parameters
    ----------
    rms_height : float
        Median. [m]
    factor : float
        Geometric standard deviation: 68 % lies between the median over it and the median times it.
    reason : str
        What was stated, and the relation.
    """

    rms_height: float
    factor: float
    reason: str


def deviation_of_range(low: float, high: float) -> float:
    """Standard deviation of the logarithm of a quantity of which a range holds 95 of 100. []"""
    return log(high / low) / 4


def height_from_roughness_average(*, roughness_average: float) -> StatedHeight:
    """Root mean square height of a surface by its Ra."""
    found = surfaces.rms_height_from_roughness_average(arithmetic_mean_height=roughness_average)
    return _stated(found, f"Ra {format_si(roughness_average, 'm')}")


def height_from_maximum_height(*, maximum_height: float) -> StatedHeight:
    """Root mean square height of a surface by its Rz."""
    found = surfaces.rms_height_from_maximum_height(mean_section_height=maximum_height)
    return _stated(found, f"Rz {format_si(maximum_height, 'm')}")


def height_of_finish(text: str) -> StatedHeight:
    """Root mean square height of a surface by its process, its ISO grade or both, or by Ra, Rz or Rq."""
    number = _NUMBER.fullmatch(text.strip())
    if number is not None:
        return _height_of_number(text.strip(), **number.groupdict(default=""))
    finish = _finish(text)
    low, high = finish.roughness_average_low, finish.roughness_average_high
    found = surfaces.rms_height_from_roughness_average(arithmetic_mean_height=finish.arithmetic_mean_height)
    stated = f"{finish.title}, Ra {format_si(low, 'm')} to {format_si(high, 'm')} by {finish.source}"
    return _stated(found, stated, deviation=deviation_of_range(low, high))


def _finish(text: str) -> surfaces.SurfaceFinish:
    """Process, a grade or both; refuse others with the forms that are read."""
    try:
        return surfaces.surface_finish(text)
    except (InvalidInput, UnknownName) as refusal:
        raise type(refusal)(f"{str(refusal).partition('; known:')[0]}; {FINISH_FORMS}") from None


def is_roughness(text: str) -> bool:
    """Whether a finish is stated as a number, such as "Ra 0.4" or "0.4um"."""
    return _NUMBER.fullmatch(text.strip()) is not None


def _height_of_number(text: str, *, process: str, parameter: str, number: str, unit: str) -> StatedHeight:
    """Height by Ra, Rz or Rq, with what was assumed in reading it."""
    if process:
        _finish(process)
    if _THOUSANDS.fullmatch(number):
        raise InvalidInput(f"surface finish {text!r} may mean two numbers; write it without a comma")
    assumed = "" if parameter else "read as Ra"
    if not unit:
        if not parameter:
            raise InvalidInput(f"surface finish {text!r} has neither a unit nor Ra, Rz or Rq; {FINISH_FORMS}")
        unit, assumed = "um", "um assumed"
    height = to_si(f"{number.replace(',', '.')} {unit}", unit="m", name="surface finish")
    low, high = _FINISHES
    if not low <= height <= high:
        raise InvalidInput(
            f"surface finish {text!r} lies beyond any finish: expected {format_si(low, 'm')} to {format_si(high, 'm')}"
        )
    said = f"stated as {text!r}" + f", {assumed}" * bool(assumed)
    if parameter.lower() in ("rq", "sq", "rms"):
        deviation = deviation_of_range(*_RMS_BETWEEN_PLACES)
        return StatedHeight(
            rms_height=height, factor=exp(deviation), reason=f"Rq {format_si(height, 'm')}, {said}; 10 % between places"
        )
    named = (
        height_from_maximum_height(maximum_height=height)
        if parameter.lower() == "rz"
        else height_from_roughness_average(roughness_average=height)
    )
    relation = named.reason.partition("; ")[2]
    letter = "Rz" if parameter.lower() == "rz" else "Ra"
    return replace(named, reason=f"from {letter} {format_si(height, 'm')}, {said}; {relation}")


def _stated(found: surfaces.RmsHeightEstimate, stated: str, *, deviation: float = 0.0) -> StatedHeight:
    """Height with the spread of the relation and that of what was stated."""
    return StatedHeight(
        rms_height=found.rms_height,
        factor=exp(hypot(deviation, deviation_of_range(found.low, found.high))),
        reason=f"from {stated}; {found.source}",
    )


Text = Annotated[str, Field(min_length=1, max_length=1000)]

STATED_HEIGHTS = ("roughness_average", "maximum_height", "finish")
"""Keys of which one stands in place of the root mean square height."""


class RoughnessSection(Section):
    """Combined roughness of both surfaces."""

    rms_height: float
    summit_radius: float
    summit_density: float

    def require_possible(self) -> None:
        """Refuse heights, radii and densities that are not positive."""
        self.roughness()

    def roughness(self) -> Roughness:
        """Roughness."""
        return Roughness(**self.model_dump())


class StatedRoughnessSection(Section):
    """Combined roughness of both surfaces as a drawing or an instrument states it: by Ra, Rz or the finish."""

    roughness_average: float | None = None
    maximum_height: float | None = None
    finish: Text | None = Field(
        default=None,
        description="Process, ISO grade or both, or Ra or Rz with its number, of the rougher surface",
        examples=["ground", "N6", "ground N6", "Ra 0.4um", "Rz 3.2um"],
    )
    summit_radius: float | None = None
    summit_density: float | None = None
    rms_height: float | None = None

    def require_possible(self) -> None:
        """Refuse several heights, those that are not positive, and unknown finishes."""
        given = [name for name in ("rms_height", *STATED_HEIGHTS) if getattr(self, name) is not None]
        if len(given) > 1:
            raise InvalidInput(f"give one of rms_height, {', '.join(STATED_HEIGHTS)}, got {' and '.join(given)}")
        names = ("roughness_average", "maximum_height", "summit_radius", "summit_density")
        check_stated(require_positive, self, *names)
        if self.finish is not None:
            height_of_finish(self.finish)


def _roughness_kind(table: Any) -> str:
    if isinstance(table, dict):
        return "stated" if any(name in table for name in STATED_HEIGHTS) else "measured"
    return "stated" if isinstance(table, StatedRoughnessSection) else "measured"


ROUGHNESS_KINDS = ("measured", "stated")
"""Kinds of the table `contact.roughness`, by which of its keys are there."""

AnyRoughness = Annotated[
    Annotated[RoughnessSection, Tag("measured")] | Annotated[StatedRoughnessSection, Tag("stated")],
    Discriminator(_roughness_kind),
]
"""The table `contact.roughness`."""


class BodySection(Section):
    """One body: a material of the catalogue, its own properties, or a material with some properties replaced."""

    material: Text | None = None
    youngs_modulus: float | None = None
    poisson_ratio: float | None = None
    yield_strength: float | None = None
    hardness: float | None = Field(default=None, description="in place of yield_strength, such as 200 HV or 2 GPa")
    role: Literal["pin", "disc"] | None = Field(
        default=None, description="Which of both bodies this one is; the other body is the other"
    )

    def require_possible(self) -> None:
        """Refuse unknown materials, moduli that are not positive, and yield strength beside hardness."""
        if self.hardness is not None:
            require_positive(hardness=self.hardness)
            if self.yield_strength is not None:
                raise InvalidInput("give either yield_strength or hardness, got both")
        self.elastic()

    def elastic(self) -> ElasticBody:
        """Elastic constants."""
        return ElasticBody(youngs_modulus=self.value_of("youngs_modulus"), poisson_ratio=self.value_of("poisson_ratio"))

    def value_of(self, name: str) -> float:
        """Property of the body, its own or that of its material."""
        given: float | None = getattr(self, name)
        if given is not None:
            return given
        if name == "yield_strength" and self.hardness is not None:
            return yield_strength_from_hardness(hardness=self.hardness).yield_strength
        if self.material is None:
            raise MissingProperty(f"{name}: missing; give it, or name a material")
        return material(self.material).value(name)


class PairSection(Section):
    """Both bodies together, where only their combined properties are known."""

    effective_modulus: float
    poisson_ratio: float
    yield_strength: float

    def require_possible(self) -> None:
        """Refuse moduli and strengths that are not positive."""
        self.pair()

    def pair(self) -> ContactPair:
        """Constants of the pair."""
        ratio = identical_materials_mindlin_ratio(poisson_ratio=self.poisson_ratio)
        return ContactPair(**self.model_dump(), mindlin_ratio=ratio)


class ContactSection(Section):
    """The contact: its load, its bodies, their roughness, and its decay length where that is known itself."""

    normal_load: float
    nominal_area: float
    roughness: AnyRoughness
    decay_length: float | None = None
    decay_length_origin: DecayLengthOrigin | None = Field(
        default=None, description='How decay_length is known; "stated" where absent'
    )
    normal_stiffness: float | None = Field(default=None, description="in place of decay_length")
    stiffness_load: float | None = None
    softer: BodySection | None = None
    harder: BodySection | None = None
    pair: PairSection | None = None
    height_distribution: Annotated[str, NameIn(HEIGHT_DISTRIBUTIONS)] = "exponential"
    asperity_law: Annotated[str, NameIn(ASPERITY_LAWS)] = "chang_etsion_bogy"

    def require_possible(self) -> None:
        """Refuse a load or area that is not positive, bodies that are not both there, and two of one role."""
        both_bodies = self.softer is not None and self.harder is not None
        any_body = self.softer is not None or self.harder is not None
        if both_bodies == (self.pair is not None) or any_body != both_bodies:
            raise InvalidInput("give either both tables contact.softer and contact.harder, or the table contact.pair")
        if self.softer is not None and self.harder is not None and self.softer.role == self.harder.role is not None:
            raise InvalidInput(f'softer.role and harder.role are both "{self.softer.role}"; give one of them')
        require_positive(normal_load=self.normal_load)
        self._require_one_decay_length()
        if isinstance(self.roughness, RoughnessSection):
            self.contact(self.roughness)

    def contact(self, roughness: RoughnessSection) -> RoughContact:
        """Contact with a roughness."""
        return RoughContact(
            roughness=roughness.roughness(),
            pair=self._pair(),
            nominal_area=self.nominal_area,
            heights=HEIGHT_DISTRIBUTIONS[self.height_distribution],
            asperity=ASPERITY_LAWS[self.asperity_law],
            decay_length=self.own_decay_length(),
        )

    def own_decay_length(self) -> float | None:
        """Decay length of the file, by itself or by the normal stiffness; None without either. [m]"""
        if self.normal_stiffness is None:
            return self.decay_length
        return (self.normal_load if self.stiffness_load is None else self.stiffness_load) / self.normal_stiffness

    def origin_of_decay_length(self) -> DecayLengthOrigin | None:
        """Origin of the decay length; None where the file gives none."""
        if self.normal_stiffness is not None:
            return "normal_stiffness"
        return None if self.decay_length is None else self.decay_length_origin or "stated"

    def material_of(self, role: str) -> str | None:
        """Material of the pin or the disc, where a body has that role and a material."""
        for body, other in ((self.softer, self.harder), (self.harder, self.softer)):
            if body is not None and other is not None and (body.role == role or other.role not in (None, role)):
                return None if body.material is None else material(body.material).name
        return None

    def _require_one_decay_length(self) -> None:
        """Refuse two decay lengths, implausible ones, and entries about one that is absent."""
        check_stated(require_positive, self, "decay_length", "normal_stiffness", "stiffness_load")
        if self.decay_length is not None and self.normal_stiffness is not None:
            raise InvalidInput("give either decay_length or normal_stiffness, got both")
        if self.stiffness_load is not None and self.normal_stiffness is None:
            raise InvalidInput("stiffness_load is the load of a measured normal_stiffness, which is missing")
        if self.decay_length_origin is not None and self.decay_length is None:
            raise InvalidInput(
                "decay_length_origin says how decay_length is known, which is missing"
                if self.normal_stiffness is None
                else "decay_length_origin follows from normal_stiffness: leave it out"
            )
        length, (shortest, longest) = self.own_decay_length(), DECAY_LENGTHS
        if length is not None and not shortest <= length <= longest:
            given = "decay_length" if self.normal_stiffness is None else "load over normal_stiffness"
            bounds = f"{format_si(shortest, 'm')} to {format_si(longest, 'm')}"
            raise InvalidInput(f"{given} {format_si(length, 'm')} lies beyond any contact: expected {bounds}")

    def _pair(self) -> ContactPair:
        if self.pair is not None:
            return self.pair.pair()
        assert self.softer is not None  # the check of the section
        assert self.harder is not None
        return contact_pair(
            softer=self.softer.elastic(),
            harder=self.harder.elastic(),
            yield_strength=self.softer.value_of("yield_strength"),
        )
