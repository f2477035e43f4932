"""A first rig file from what people know: materials, shape of the pin, load, speed, vibration and finish.

What nobody has measured yet, such as dry friction and roughness, is a distribution with its reason. Bodies are known by
their materials: elastic constants, hardness and strength, with how well they are known.
"""

import json
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import hypot, isclose, log
from typing import Final

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput, MissingProperty, SonolubeError
from sonolube.facts import materials
from sonolube.models.contact import ElasticBody, contact_pair
from sonolube.rig.file.contact_section import deviation_of_range
from sonolube.rig.file.entries import FileEntries, with_entries
from sonolube.rig.file.reader import rig_from
from sonolube.rig.file.section import guidance
from sonolube.rig.file.toml_file import number_keys
from sonolube.rig.new_rig.pin_and_vibration import (
    Entries,
    KnownSurface,
    PinShape,
    Vibration,
    compliance_entries,
    direction_entries,
    lognormal_text,
    surfaces_in_contact,
    toml_text,
)
from sonolube.rig.record import Rig
from sonolube.rig.simulation import friction_point
from sonolube.rig.vibration_direction import NORMAL, VibrationDirection
from sonolube.vocabulary import quantity

_CATALOGUE_STRENGTH: Final = 0.15
_METALS: Final = (
    *("aluminium", "brass", "bronze", "cast_iron", "cemented_carbide", "copper", "magnesium", "nickel"),
    *("stainless_steel", "steel", "titanium"),
)
_POISSON_RATIO: Final = 0.33
_POISSON_REASON: Final = "not in the catalogue; 0.33 assumed: 0.25 to 0.4 changes the effective modulus by 5 %"
_CLASS: Final = "the class, not the material, is known"
_LAYER: Final = {
    "dynamic_modulus_ratio": "dynamic_modulus_ratio",
    "layer_loss": "elastic_loss",
    "layer_density": "density",
}


@dataclass(frozen=True, kw_only=True, slots=True)
class YieldStrength:
    """Yield strength of a body.

    Parameters
    ----------
    yield_strength : float
        Median. [Pa]
    deviation : float
        Standard deviation of its logarithm.
    reason : str
        Where it comes from.
    """

    yield_strength: float
    deviation: float
    reason: str


@dataclass(frozen=True, kw_only=True, slots=True)
class KnownBody:
    """Body of a new rig by its material.

    Parameters
    ----------
    material : Material
        A material, or a class of materials whose spread enters the file.
    """

    material: materials.Material

    @property
    def elastic(self) -> ElasticBody:
        """Elastic constants, those that the catalogue lacks taken from the class or assumed."""
        ratio = self.material.properties.get("poisson_ratio")
        modulus = self._property("youngs_modulus").value
        return ElasticBody(youngs_modulus=modulus, poisson_ratio=_POISSON_RATIO if ratio is None else ratio.value)

    @property
    def hardness(self) -> float:
        """Hardness, or three times the strength where the catalogue lacks it. [Pa]"""
        if "hardness" in self.material.properties:
            return self.material.value("hardness")
        return 3 * self.strength.yield_strength

    @property
    def strength(self) -> YieldStrength:
        """Yield strength, of metals by Tabor's relation from their hardness, of others that of the catalogue."""
        is_metal, properties = self.material.family in _METALS, self.material.properties
        keys = ("hardness", "yield_strength") if is_metal else ("yield_strength", "hardness")
        own = next((key for key in (*keys, "ultimate_strength") if key in properties), None)
        key = "yield_strength" if own is None else own
        found = self._property(key)
        if key != "hardness":
            tension = "; strength in tension, taken as that at yield" if key == "ultimate_strength" else ""
            origin = _origin(found) if found.deviation else f"of the catalogue, {found.source}"
            return YieldStrength(
                yield_strength=found.value,
                deviation=hypot(found.deviation, _CATALOGUE_STRENGTH),
                reason=f"{origin}{tension}; 15 % between batches assumed",
            )
        estimate = materials.yield_strength_from_hardness(hardness=found.value)
        beyond = "" if is_metal else "; beyond the metals that the relation is of"
        origin = _origin(found) if found.deviation else ""
        reason = f"from {found.value / 9.80665e6:.0f} HV of the catalogue; {estimate.source}; {estimate.reason}{beyond}"
        return YieldStrength(
            yield_strength=estimate.yield_strength,
            deviation=hypot(found.deviation, deviation_of_range(estimate.low, estimate.high)),
            reason="; ".join(filter(None, (reason, origin))),
        )

    def entries(self, place: str, *, role: str, strength: YieldStrength | None = None) -> Entries:
        """Table of the body as the softer one, with its strength, or as the harder one.

        Properties that the catalogue lacks, and the modulus of a class with its spread, are stated.
        """
        table = {"material": json.dumps(self.material.name), "role": json.dumps(role)}
        reasons = {} if strength is None else {f"{place}.yield_strength": strength.reason}
        laws = {} if strength is None else {f"{place}.yield_strength": lognormal_text(strength.deviation)}
        modulus = self._property("youngs_modulus")
        if "youngs_modulus" not in self.material.properties or modulus.deviation:
            table["youngs_modulus"] = toml_text(modulus.value, "Pa")
            reasons[f"{place}.youngs_modulus"] = _origin(modulus)
        if modulus.deviation:
            laws[f"{place}.youngs_modulus"] = lognormal_text(modulus.deviation)
        if "poisson_ratio" not in self.material.properties:
            table["poisson_ratio"] = f"{_POISSON_RATIO:g}"
            reasons[f"{place}.poisson_ratio"] = _POISSON_REASON
        if strength is not None:
            table["yield_strength"] = toml_text(strength.yield_strength, "Pa")
        return Entries(tables={place: table}, assumptions=reasons, uncertainty=laws)

    def layer(self, layer_thickness: float) -> Entries:
        """Entries of a new rig file for this body as a soft layer: its stiffening, loss and density by its material."""
        if not is_soft(self.material):
            raise InvalidInput(
                f"layer_thickness is of a soft body, and {self.material.title} is none; leave it out, or name felt,"
                " webbing, rubber, skin or a plastic"
            )
        table = {"model": json.dumps("soft_layer"), "layer_thickness": toml_text(layer_thickness, "m")}
        reasons, laws = {"friction.layer_thickness": "as stated, on a rigid base"}, {}
        for key, name in _LAYER.items():
            found = self._property(name)
            table[key] = toml_text(found.value, found.unit) if found.unit else f"{found.value:.4g}"
            reasons[f"friction.{key}"] = _origin(found) if found.deviation else f"of the catalogue, {found.source}"
            if found.deviation:
                laws[f"friction.{key}"] = lognormal_text(found.deviation)
        return Entries(tables={"friction": table}, assumptions=reasons, uncertainty=laws)

    def _property(self, key: str) -> materials.SourcedValue:
        """Property of the material, or of the class of its family where the catalogue lacks it."""
        if key not in self.material.properties and self.material.family in materials.material_classes():
            of_class = materials.material(self.material.family)
            if key in of_class.properties:
                found = of_class.property(key)
                return replace(found, source=f"{of_class.title.lower()}, {found.source}")
        try:
            return self.material.property(key)
        except MissingProperty as refusal:
            raise MissingProperty(f"{str(refusal).partition(';')[0]}; name another material") from None


def is_soft(known: materials.Material) -> bool:
    """Whether a material is of a class that the catalogue knows as a soft layer: how it stiffens with the frequency."""
    classes = materials.material_classes()
    return known.family in classes and "dynamic_modulus_ratio" in materials.material(known.family).properties


def _origin(known: materials.SourcedValue) -> str:
    """Where a property of a class is from."""
    return "; ".join(filter(None, (f"{_CLASS}: {known.source}", known.note)))


_HEAD: Final = "# Written by sonolube new. Replace what you measure, and remove its line from [uncertainty]."
_MEASURED_FRICTION: Final = "normal 5 %"
_SAME_FORCE: Final = 1e-6  # relative difference of forces below which an entry changes nothing


@dataclass(frozen=True, kw_only=True, slots=True)
class KnownRig:
    """Statements about a rig before anything is measured on it.

    Parameters
    ----------
    pin, disc : str
        Materials or classes of materials of the catalogue.
    shape : PinShape
    normal_load : float
        Force pressing the bodies together. [N]
    sliding_speed : float
        Mean sliding speed. [m/s]
    frequency : float
        Of the vibration. [Hz]
    vibration : Vibration
    pin_surface, disc_surface : KnownSurface
    friction_coefficient : float or None
        Measured without vibration; the range of the pair, or of its class of pairs, where None. []
    decay_length : float or None
        Length over which the contact force falls by a factor of e, where it is known; that of published tests where
        both it and the stiffness are None. [m]
    normal_stiffness : float or None
        Measured normal stiffness of the contact under its load, in place of the decay length. [N/m]
    speed_reason : str
        How the sliding speed follows from a rotational speed; empty for a speed that is stated.
    direction : VibrationDirection
        Along the normal, or within the plane by Coulomb's law.
    layer_thickness : float or None
        Thickness of the softer body as a layer on a rigid base, whose friction is that of a soft layer. [m]
    """

    pin: str
    disc: str
    shape: PinShape
    normal_load: float
    sliding_speed: float
    frequency: float
    vibration: Vibration
    pin_surface: KnownSurface
    disc_surface: KnownSurface
    friction_coefficient: float | None = None
    decay_length: float | None = None
    normal_stiffness: float | None = None
    speed_reason: str = ""
    direction: VibrationDirection = NORMAL
    layer_thickness: float | None = None

    def __post_init__(self) -> None:
        if self.layer_thickness is not None:
            require_positive(layer_thickness=self.layer_thickness)
            if not self.direction.is_normal:
                raise InvalidInput(
                    f"layer_thickness: a soft layer has no law for a vibration {self.direction.text}; leave one out"
                )
        require_positive(normal_load=self.normal_load, sliding_speed=self.sliding_speed, frequency=self.frequency)
        if self.friction_coefficient is not None:
            require_positive(friction_coefficient=self.friction_coefficient)


@dataclass(frozen=True, kw_only=True, slots=True)
class LeastKnown:
    """Uncertain entry of a rig.

    Parameters
    ----------
    key : str
        Dotted key of the file.
    deviation : float
        Standard deviation of its logarithm, in nepers.
    text : str
        Its distribution.
    remedy : str
        How to measure it.
    """

    key: str
    deviation: float
    text: str
    remedy: str


def new_rig_text(known: KnownRig) -> str:
    """Rig file of what is known, as TOML with comments.

    Entries that nobody measured are in its table `uncertainty`, each with its reason in `assumptions`.
    """
    parts = [
        *_contact(known),
        _friction(known),
        known.vibration.entries(known.frequency),
        direction_entries(known.direction),
    ]
    pin, disc = (materials.material(name).words for name in (known.pin, known.disc))
    tables: dict[str, Mapping[str, str]] = {
        "": {
            "title": json.dumps(f"{pin[:1].upper()}{pin[1:]} pin on {disc} disc"),
            "source": '"what was known before a test"',
        }
    }
    for part in parts:
        tables |= {name: {**tables.get(name, {}), **table} for name, table in part.tables.items()}
    tables["uncertainty"] = _quoted([part.uncertainty for part in parts])
    tables["assumptions"] = _quoted([part.assumptions for part in parts])
    text = "\n".join([_HEAD, *(_table(name, entries) for name, entries in tables.items())])
    rig_from(tomllib.loads(text))
    return text


def rig_of_known(known: KnownRig) -> Rig:
    """Rig of what is known, which writes the file of `new_rig_text` with its comments."""
    text = new_rig_text(known)
    content = tomllib.loads(text)
    return with_entries(rig_from(content), FileEntries(content, rig_from, text=text))


def least_known(rig: Rig, *, count: int = 3) -> Sequence[LeastKnown]:
    """Uncertain entries of a rig that are known least, by the standard deviation of their logarithm.

    Those that friction depends on, the least known first; of entries that one measurement gives, the least known one.
    """
    entries: dict[str, LeastKnown] = {}
    for key, law in rig.uncertainty.items():
        low, high = (float(each) for each in law.quantile((0.1587, 0.8413)))
        if not _moves_friction(rig, key, low, high):
            continue
        remedy = guidance()[name].obtain if (name := key.rpartition(".")[2]) in guidance() else "a measurement"
        one = LeastKnown(key=key, deviation=log(high / low) / 2, text=law.text, remedy=remedy)
        if remedy not in entries or entries[remedy].deviation < one.deviation:
            entries[remedy] = one
    return sorted(entries.values(), key=lambda one: -one.deviation)[:count]


def _moves_friction(rig: Rig, key: str, low: float, high: float) -> bool:
    """Whether friction under vibration differs between two values of an entry, or is not known at one."""
    unit = number_keys()[key].unit
    try:
        forces = [friction_point(rig.replace(key, f"{value:.9g} {unit}")).friction_force for value in (low, high)]
    except SonolubeError:
        return True
    return not isclose(*forces, rel_tol=_SAME_FORCE)


def _contact(known: KnownRig) -> list[Entries]:
    """Tables of the contact: load, area, roughness, and both bodies, the softer by its hardness."""
    pin, disc = (KnownBody(material=materials.material(name)) for name in (known.pin, known.disc))
    softer, harder = (disc, pin) if disc.hardness < pin.hardness else (pin, disc)
    softer_role, harder_role = ("pin", "disc") if softer is pin else ("disc", "pin")
    strength = softer.strength
    pair = contact_pair(softer=softer.elastic, harder=harder.elastic, yield_strength=strength.yield_strength)
    area = known.shape.nominal_area(effective_modulus=pair.effective_modulus, normal_load=known.normal_load)
    pressed = {"normal_load": toml_text(known.normal_load, "N"), "nominal_area": toml_text(area, "m2")}
    stated = known.decay_length is not None or known.normal_stiffness is not None
    layer = [] if known.layer_thickness is None else [softer.layer(known.layer_thickness)]
    compliance = [compliance_entries(decay_length=known.decay_length, normal_stiffness=known.normal_stiffness)]
    return [
        Entries(tables={"contact": pressed}, assumptions={"contact.nominal_area": known.shape.text}),
        *([] if layer and not stated else compliance),  # of hard worn contacts, which tell nothing of a layer
        *layer,
        surfaces_in_contact(known.pin_surface, known.disc_surface).entries("contact.roughness"),
        softer.entries("contact.softer", role=softer_role, strength=strength),
        harder.entries("contact.harder", role=harder_role),
    ]


def _friction(known: KnownRig) -> Entries:
    """Tables of dry friction and sliding."""
    key, sliding = "friction.friction_coefficient", {"sliding_speed": toml_text(known.sliding_speed, "m/s")}
    if known.friction_coefficient is not None:
        value, reason, law = known.friction_coefficient, "as stated, taken as measured: 5 %", _MEASURED_FRICTION
    else:
        pair = materials.dry_friction(known.pin, known.disc)
        value, law = (pair.low + pair.high) / 2, f"uniform {pair.low:g} to {pair.high:g}"
        what = f"range of the class of pair, {pair.pair_class}" if pair.pair_class else "range of the pair"
        reason = "; ".join(part for part in (what, pair.source, pair.condition, pair.note) if part)
    return Entries(
        tables={"friction": {"friction_coefficient": f"{value:.4g}"}, "sliding": sliding},
        assumptions={key: reason} | ({"sliding.sliding_speed": known.speed_reason} if known.speed_reason else {}),
        uncertainty={key: law},
    )


def _quoted(parts: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Texts by dotted key as keys and values of TOML."""
    return {json.dumps(key): json.dumps(text) for part in parts for key, text in part.items()}


def _table(name: str, entries: Mapping[str, str]) -> str:
    """Table as TOML, each quantity with its meaning as a comment."""
    lines = [f"[{name}]"] if name else []
    return "\n".join([*lines, *(f"{key} = {value}{_comment(key)}" for key, value in entries.items())]) + "\n"


def _comment(key: str) -> str:
    advice = guidance().get(key)
    return "" if advice is None else f"  # {quantity(key).meaning}; from {advice.obtain}"
