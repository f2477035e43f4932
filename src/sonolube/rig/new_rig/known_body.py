"""Bodies of a new rig by their materials: elastic constants, hardness and strength, with how well they are known."""

import json
from dataclasses import dataclass, replace
from math import hypot
from typing import Final

from sonolube.errors import MissingProperty
from sonolube.facts import materials
from sonolube.models.contact import ElasticBody
from sonolube.rig.file.stated_surface import deviation_of_range
from sonolube.rig.new_rig.known_surface import lognormal_text
from sonolube.rig.new_rig.pin_and_vibration import Entries, toml_text

_CATALOGUE_STRENGTH: Final = 0.15
_METALS: Final = (
    *("aluminium", "brass", "bronze", "cast_iron", "cemented_carbide", "copper", "magnesium", "nickel"),
    *("stainless_steel", "steel", "titanium"),
)
_POISSON_RATIO: Final = 0.33
_POISSON_REASON: Final = "not in the catalogue; 0.33 assumed: 0.25 to 0.4 changes the effective modulus by 5 %"
_CLASS: Final = "the class, not the material, is known"


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

    def entries(self, place: str, *, role: str) -> Entries:
        """Table of the body as the softer or the harder one, without its strength.

        Properties that the catalogue lacks, and the modulus of a class with its spread, are stated.
        """
        table = {"material": json.dumps(self.material.name), "role": json.dumps(role)}
        reasons, laws = {}, {}
        modulus = self._property("youngs_modulus")
        if "youngs_modulus" not in self.material.properties or modulus.deviation:
            table["youngs_modulus"] = toml_text(modulus.value, "Pa")
            reasons[f"{place}.youngs_modulus"] = _origin(modulus)
        if modulus.deviation:
            laws[f"{place}.youngs_modulus"] = lognormal_text(modulus.deviation)
        if "poisson_ratio" not in self.material.properties:
            table["poisson_ratio"] = f"{_POISSON_RATIO:g}"
            reasons[f"{place}.poisson_ratio"] = _POISSON_REASON
        return Entries(tables={place: table}, assumptions=reasons, uncertainty=laws)

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


def _origin(known: materials.SourcedValue) -> str:
    """Where a property of a class is from."""
    return "; ".join(filter(None, (f"{_CLASS}: {known.source}", known.note)))
