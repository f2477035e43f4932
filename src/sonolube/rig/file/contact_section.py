"""Table `contact` of a rig file: load, bodies, and roughness as measured or as it is stated on a drawing."""

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput, MissingProperty
from sonolube.facts.materials import material, yield_strength_from_hardness
from sonolube.models.contact import ASPERITY_LAWS, HEIGHT_DISTRIBUTIONS, RoughContact
from sonolube.models.contact.pair import ContactPair, ElasticBody, contact_pair, identical_materials_mindlin_ratio
from sonolube.models.surfaces import Roughness
from sonolube.rig.file.plausible import DECAY_LENGTHS
from sonolube.rig.file.section import NameIn, Section
from sonolube.rig.file.stated_surface import height_of_finish
from sonolube.rig.record import DecayLengthOrigin, check_stated
from sonolube.text.units import format_si

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
