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
from sonolube.errors import SonolubeError
from sonolube.facts import materials
from sonolube.models.contact import contact_pair
from sonolube.rig.file.entries import FileEntries, with_entries
from sonolube.rig.file.guidance import guidance
from sonolube.rig.file.reader import rig_from
from sonolube.rig.file.uncertainty import number_keys
from sonolube.rig.new_rig.contact_compliance import compliance_entries
from sonolube.rig.new_rig.known_body import KnownBody
from sonolube.rig.new_rig.known_surface import KnownSurface, lognormal_text, surfaces_in_contact
from sonolube.rig.new_rig.pin_and_vibration import Entries, PinShape, Vibration, toml_text
from sonolube.rig.record import Rig
from sonolube.rig.simulation import friction_point
from sonolube.vocabulary import quantity

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
    """Rig file of what is known, as TOML with comments.

    Entries that nobody measured are in its table `uncertainty`, each with its reason in `assumptions`.
    """
    parts = [_contact(known), _friction(known), known.vibration.entries(known.frequency)]
    pin, disc = materials.material(known.pin), materials.material(known.disc)
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


def _contact(known: KnownRig) -> Entries:
    """Tables of the contact: load, area, roughness, and both bodies, the softer by its hardness."""
    pin, disc = (KnownBody(material=materials.material(name)) for name in (known.pin, known.disc))
    softer, harder = (disc, pin) if disc.hardness < pin.hardness else (pin, disc)
    strength = softer.strength
    pair = contact_pair(softer=softer.elastic, harder=harder.elastic, yield_strength=strength.yield_strength)
    area = known.shape.nominal_area(effective_modulus=pair.effective_modulus, normal_load=known.normal_load)
    surface = surfaces_in_contact(known.pin_surface, known.disc_surface)
    roughness, place = surface.roughness, "contact.roughness"
    softer_role, harder_role = ("pin", "disc") if softer is pin else ("disc", "pin")
    softer_entries = softer.entries("contact.softer", role=softer_role)
    harder_entries = harder.entries("contact.harder", role=harder_role)
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
                **softer_entries.tables["contact.softer"],
                "yield_strength": toml_text(strength.yield_strength, "Pa"),
            },
            **harder_entries.tables,
        },
        assumptions={
            "contact.nominal_area": known.shape.text,
            **compliance.assumptions,
            f"{place}.rms_height": surface.height_reason,
            f"{place}.summit_radius": surface.summit_reason,
            f"{place}.summit_density": surface.summit_reason,
            "contact.softer.yield_strength": strength.reason,
            **softer_entries.assumptions,
            **harder_entries.assumptions,
        },
        uncertainty={
            **compliance.uncertainty,
            f"{place}.rms_height": lognormal_text(surface.height_deviation),
            f"{place}.summit_radius": lognormal_text(surface.radius_deviation),
            f"{place}.summit_density": lognormal_text(surface.density_deviation),
            "contact.softer.yield_strength": lognormal_text(strength.deviation),
            **softer_entries.uncertainty,
            **harder_entries.uncertainty,
        },
    )


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
