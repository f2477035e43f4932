"""Catalogue of materials: scalar properties of each, every one with its source."""

import re
from collections.abc import Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

from sonolube.errors import UnknownName
from sonolube.facts.materials.classes import classes_of
from sonolube.facts.materials.property_file import cited, read_property_file
from sonolube.facts.materials.records import Material, SourcedText, SourcedValue


def material(name: str) -> Material:
    """Material of the catalogue, or a class of materials, by its name or alias.

    Parameters
    ----------
    name : str
        Such as "stainless_steel_316" or its alias "ss316", or the class "steel"; case, spaces and punctuation do not
        matter ("AISI 316").

    Returns
    -------
    Material

    Raises
    ------
    UnknownName
        If the catalogue has no such material, with the closest name.

    Examples
    --------
    >>> from sonolube.facts.materials import material
    >>> steel = material("AISI 316")
    >>> steel.name, steel.properties["density"].value
    ('stainless_steel_316', 8000.0)
    """
    try:
        return _known()[_names_by_key()[_key(name)]]
    except KeyError:
        names = (each for known in _known().values() for each in (known.name, *known.aliases))
        raise UnknownName.among(names, kind="material", name=name) from None


def material_names() -> tuple[str, ...]:
    """Names of all materials, including piezoelectric ceramics, in alphabetical order; without classes."""
    return tuple(sorted(_materials()))


def material_classes() -> tuple[str, ...]:
    """Names of the classes of materials, such as "steel" or "rubber", in alphabetical order."""
    return tuple(sorted(_classes()))


def material_families() -> tuple[str, ...]:
    """Families of all materials and classes, in alphabetical order."""
    return tuple(sorted({each.family for each in _known().values()}))


_FILES = ("engineering.toml", "piezo.toml")


@cache
def _materials() -> Mapping[str, Material]:
    """All materials of the property files by name."""
    tables = [read_property_file(file_name) for file_name in _FILES]
    return {name: _material(name, entry, table.sources) for table in tables for name, entry in table.entries.items()}


@cache
def _classes() -> Mapping[str, Material]:
    """All classes of materials by name."""
    return classes_of(_materials())


@cache
def _known() -> Mapping[str, Material]:
    """All materials and classes by name."""
    return {**_materials(), **_classes()}


@cache
def _names_by_key() -> Mapping[str, str]:
    """Names of the materials and classes by the keys of their names and aliases."""
    return {_key(each): known.name for known in _known().values() for each in (known.name, *known.aliases)}


def _key(name: str) -> str:
    """Name without case, spaces and punctuation."""
    return re.sub(r"[\W_]+", "", name.lower())


def _material(name: str, entry: Mapping[str, Any], sources: Mapping[str, str]) -> Material:
    """Material of one entry of a property file."""
    structure = entry.get("crystal_structure")
    return Material(
        name=name,
        title=entry["title"],
        family=entry["family"],
        properties=MappingProxyType(
            {key: SourcedValue(**cited(value, sources)) for key, value in entry["properties"].items()}
        ),
        crystal_structure=SourcedText(**cited(structure, sources)) if structure else None,
        aliases=tuple(entry.get("aliases", ())),
    )
