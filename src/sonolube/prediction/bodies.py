"""Bodies of a rig as its file names them: material, family and hardness."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.materials import material
from sonolube.rig import Rig
from sonolube.rig.file.derived import FROM_HARDNESS
from sonolube.text.units import to_si

_TABOR_FACTOR: Final = 3.0  # hardness over yield strength


@dataclass(frozen=True, kw_only=True, slots=True)
class NamedBody:
    """A body of a rig whose material is named.

    Parameters
    ----------
    name, title, family : str
        Of the material in the catalogue.
    hardness : float or None
        That of the rig file, else of the catalogue, else three times the yield strength. [Pa]
    is_estimated : bool
        Whether the hardness is such an estimate.
    """

    name: str
    title: str
    family: str
    hardness: float | None
    is_estimated: bool = False


def named_bodies(rig: Rig) -> tuple[NamedBody, ...]:
    """Bodies of a rig whose materials are named, the pin or the softer one first; none, one or two."""
    tables = _body_tables(rig)
    found = [
        _body(table["material"], strength=table.get("yield_strength"), is_measured=is_measured)
        for table, is_measured in tables
        if "material" in table
    ]
    if not found:
        found = [_body(name) for name in (rig.pin_material, rig.disc_material) if name is not None]
    return tuple(body for body in found if body is not None)


def _body_tables(rig: Rig) -> list[tuple[Mapping[str, Any], bool]]:
    """Tables of both bodies in the file of the rig, that of the pin first, and whether each stated a hardness."""
    try:
        contact = rig.content().get("contact", {})
    except InvalidInput:  # made or changed in Python
        return []
    tables = [
        (contact[name], FROM_HARDNESS in rig.assumptions.get(f"contact.{name}.yield_strength", ""))
        for name in ("softer", "harder")
        if name in contact
    ]
    order = {"pin": 0, "disc": 2}
    return sorted(tables, key=lambda each: order.get(each[0].get("role", ""), 1))


def _body(name: str, *, strength: str | float | None = None, is_measured: bool = False) -> NamedBody | None:
    """Body of a material of the catalogue, None of an unknown one; with the yield strength of its table.

    A stated hardness is kept in the file as the yield strength that follows from it.
    """
    try:
        known = material(name)
    except UnknownName:
        return None
    stated = to_si(strength, unit="Pa", name="yield_strength") if isinstance(strength, str) else strength
    own = known.properties.get("hardness")
    if stated is None and "yield_strength" in known.properties:
        stated = known.value("yield_strength")
    hardness = own.value if own is not None and not is_measured else None
    is_estimated = hardness is None and not is_measured
    if hardness is None and stated is not None:
        hardness = _TABOR_FACTOR * stated
    return NamedBody(
        name=known.name, title=known.title, family=known.family, hardness=hardness, is_estimated=is_estimated
    )
