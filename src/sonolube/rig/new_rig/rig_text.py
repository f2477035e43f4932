"""A first rig file from what people know: materials, shape of the pin, load, speed, vibration and finish.

What nobody has measured yet, such as dry friction and roughness, is a distribution with its reason.
"""

import json
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isclose, log
from typing import Final

from sonolube.checks import require_positive
from sonolube.contact import ElasticBody, contact_pair
from sonolube.errors import MissingProperty, SonolubeError
from sonolube.materials import Material, dry_friction, material, yield_strength_from_hardness
from sonolube.rig.file.guidance import guidance
from sonolube.rig.file.reader import rig_from
from sonolube.rig.file.stated_surface import deviation_of_range
from sonolube.rig.new_rig.contact_compliance import compliance_entries
from sonolube.rig.file.uncertainty import number_keys
from sonolube.rig.new_rig.known_surface import KnownSurface, lognormal_text, surfaces_in_contact
from sonolube.rig.new_rig.pin_and_vibration import Entries, PinShape, Vibration, toml_text
from sonolube.rig.record import Rig
from sonolube.rig.simulation import friction_point
from sonolube.vocabulary import quantity

_HEAD: Final = "# Written by sonolube new. Replace what you measure, and remove its line from [uncertainty]."
_CATALOGUE_STRENGTH: Final = 0.15
_NO_METALS: Final = ("ceramic", "coating", "glass", "piezo_ceramic", "polymer")
_POISSON_RATIO: Final = 0.33
_POISSON_REASON: Final = "not in the catalogue; 0.33 assumed: 0.25 to 0.4 changes the effective modulus by 5 %"
_MEASURED_FRICTION: Final = "normal 5 %"
_SAME_FORCE: Final = 1e-6  # relative difference of forces below which an entry changes nothing


@dataclass(frozen=True, kw_only=True, slots=True)
class KnownRig:
    """What is known of a rig before anything is measured on it.

    Parameters
    ----------
    pin, disc : str
        Materials of the catalogue.
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
        Measured without vibration; the range of the pair where None. []
    decay_length : float or None
        Length over which the contact force falls by a factor of e, where it is known; that of published tests where
        both it and the stiffness are None. [m]
    normal_stiffness : float or None
        Measured normal stiffness of the contact under its load, in place of the decay length. [N/m]
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

    def __post_init__(self) -> None:
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
    """Return a rig file of what is known, as TOML with comments.

    Parameters
    ----------
    known : KnownRig

    Returns
    -------
    str
        Entries that nobody measured are in its table `uncertainty`, each with its reason in `assumptions`.

    Raises
    ------
    InvalidInput
        If a value is impossible.
    MissingProperty
        If the catalogue lacks a property of a material, or no dry friction is known of the pair.
    """
    parts = [_contact(known), _friction(known), known.vibration.entries(known.frequency)]
    pin, disc = material(known.pin), material(known.disc)
    tables: dict[str, Mapping[str, str]] = {
        "": {"title": json.dumps(f"{pin.title} pin on {disc.title} disc"), "source": '"what was known before a test"'}
    }
    for part in parts:
        tables |= part.tables
    tables["uncertainty"] = _quoted([part.uncertainty for part in parts])
    tables["assumptions"] = _quoted([part.assumptions for part in parts])
    text = "\n".join([_HEAD, *(_table(name, entries) for name, entries in tables.items())])
    rig_from(tomllib.loads(text))
    return text


def least_known(rig: Rig, *, count: int = 3) -> Sequence[LeastKnown]:
    """Return the uncertain entries of a rig that are known least, by the standard deviation of their logarithm.

    Parameters
    ----------
    rig : Rig
    count : int
        Number of entries.

    Returns
    -------
    sequence of LeastKnown
        Those that friction depends on, the least known first; of entries that one measurement gives, the least known
        one.
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
    """Return whether friction under vibration differs between two values of an entry, or is not known at one."""
    unit = number_keys()[key].unit
    try:
        forces = [friction_point(rig.replace(key, f"{value:.9g} {unit}")).friction_force for value in (low, high)]
    except SonolubeError:
        return True
    return not isclose(*forces, rel_tol=_SAME_FORCE)


def _contact(known: KnownRig) -> Entries:
    """Return the tables of the contact: load, area, roughness, and both bodies, the softer by its hardness."""
    pin, disc = material(known.pin), material(known.disc)
    softer, harder = (disc, pin) if _hardness(disc) < _hardness(pin) else (pin, disc)
    strength, deviation, strength_reason = _yield_strength(softer)
    pair = contact_pair(softer=_body(softer), harder=_body(harder), yield_strength=strength)
    area = known.shape.nominal_area(effective_modulus=pair.effective_modulus, normal_load=known.normal_load)
    surface = surfaces_in_contact(known.pin_surface, known.disc_surface)
    roughness, place = surface.roughness, "contact.roughness"
    roles = {"softer": "pin", "harder": "disc"} if softer is pin else {"softer": "disc", "harder": "pin"}
    assumed = {"softer": _assumed(softer), "harder": _assumed(harder)}
    compliance = compliance_entries(decay_length=known.decay_length, normal_stiffness=known.normal_stiffness)
    return Entries(
        tables={
            "contact": {
                "normal_load": toml_text(known.normal_load, "N"),
                "nominal_area": toml_text(area, "m2"),
                **compliance.tables["contact"],
            },
            place: {
                "rms_height": toml_text(roughness.rms_height, "m"),
                "summit_radius": toml_text(roughness.summit_radius, "m"),
                "summit_density": toml_text(roughness.summit_density, "1/m2"),
            },
            "contact.softer": {
                "material": json.dumps(softer.name),
                "role": json.dumps(roles["softer"]),
                "yield_strength": toml_text(strength, "Pa"),
                **assumed["softer"],
            },
            "contact.harder": {
                "material": json.dumps(harder.name),
                "role": json.dumps(roles["harder"]),
                **assumed["harder"],
            },
        },
        assumptions={
            "contact.nominal_area": known.shape.text,
            **compliance.assumptions,
            f"{place}.rms_height": surface.height_reason,
            f"{place}.summit_radius": surface.summit_reason,
            f"{place}.summit_density": surface.summit_reason,
            "contact.softer.yield_strength": strength_reason,
            **{f"contact.{body}.{key}": _POISSON_REASON for body, keys in assumed.items() for key in keys},
        },
        uncertainty={
            **compliance.uncertainty,
            f"{place}.rms_height": lognormal_text(surface.height_deviation),
            f"{place}.summit_radius": lognormal_text(surface.radius_deviation),
            f"{place}.summit_density": lognormal_text(surface.density_deviation),
            "contact.softer.yield_strength": lognormal_text(deviation),
        },
    )


def _friction(known: KnownRig) -> Entries:
    """Return the tables of dry friction and sliding."""
    key, sliding = "friction.friction_coefficient", {"sliding_speed": toml_text(known.sliding_speed, "m/s")}
    if known.friction_coefficient is not None:
        value, reason, law = known.friction_coefficient, "as stated, taken as measured: 5 %", _MEASURED_FRICTION
    else:
        pair = dry_friction(known.pin, known.disc)
        value, law = (pair.low + pair.high) / 2, f"uniform {pair.low:g} to {pair.high:g}"
        reason = "; ".join(part for part in ("range of the pair", pair.source, pair.condition, pair.note) if part)
    return Entries(
        tables={"friction": {"friction_coefficient": f"{value:.4g}"}, "sliding": sliding},
        assumptions={key: reason},
        uncertainty={key: law},
    )


def _hardness(body: Material) -> float:
    """Return the hardness of a material, or three times its yield strength where the catalogue lacks it. [Pa]"""
    try:
        return body.value("hardness")
    except MissingProperty:
        return 3 * body.value("yield_strength")


def _yield_strength(body: Material) -> tuple[float, float, str]:
    """Return the yield strength of a material in Pa, the standard deviation of its logarithm, and where it is from.

    Tabor's relation holds for metals; of others the catalogue's strength comes first.
    """
    has_strength = "yield_strength" in body.properties
    if "hardness" not in body.properties or (body.family in _NO_METALS and has_strength):
        found = body.property("yield_strength")
        return found.value, _CATALOGUE_STRENGTH, f"of the catalogue, {found.source}; 15 % between batches assumed"
    hardness = body.value("hardness")
    estimate = yield_strength_from_hardness(hardness=hardness)
    beyond = "; beyond the metals that the relation is of" if body.family in _NO_METALS else ""
    reason = f"from {hardness / 9.80665e6:.0f} HV of the catalogue; {estimate.source}; {estimate.reason}{beyond}"
    return estimate.yield_strength, deviation_of_range(estimate.low, estimate.high), reason


def _assumed(body: Material) -> dict[str, str]:
    """Return properties that the catalogue lacks and that are assumed, as TOML: Poisson's ratio."""
    return {} if "poisson_ratio" in body.properties else {"poisson_ratio": f"{_POISSON_RATIO:g}"}


def _body(body: Material) -> ElasticBody:
    ratio = body.value("poisson_ratio") if "poisson_ratio" in body.properties else _POISSON_RATIO
    return ElasticBody(youngs_modulus=body.value("youngs_modulus"), poisson_ratio=ratio)


def _quoted(parts: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Return texts by dotted key as keys and values of TOML."""
    return {json.dumps(key): json.dumps(text) for part in parts for key, text in part.items()}


def _table(name: str, entries: Mapping[str, str]) -> str:
    """Return a table as TOML, each quantity with its meaning as a comment."""
    lines = [f"[{name}]"] if name else []
    return "\n".join([*lines, *(f"{key} = {value}{_comment(key)}" for key, value in entries.items())]) + "\n"


def _comment(key: str) -> str:
    advice = guidance().get(key)
    return "" if advice is None else f"  # {quantity(key).meaning}; from {advice.obtain}"
