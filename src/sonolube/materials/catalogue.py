"""Catalogue of materials: scalar properties of each, every one with its source."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Any

from sonolube.errors import MissingProperty, UnknownName
from sonolube.materials.property_file import read_property_file
from sonolube.vocabulary import quantity


@dataclass(frozen=True, kw_only=True, slots=True)
class SourcedValue:
    """A numerical property with its unit and source.

    Parameters
    ----------
    value : float
        Value, in `unit`.
    unit : str
        Its SI unit; empty for dimensionless numbers.
    source : str
        Table, data sheet, handbook or paper.
    condition : str
        Temper, temperature or kind of test for which it holds; empty where the source does not state any.
    note : str
        Further remarks, such as a source that disagrees.
    """

    value: float
    unit: str
    source: str
    condition: str = ""
    note: str = ""


@dataclass(frozen=True, kw_only=True, slots=True)
class SourcedText:
    """A property in words with its source.

    Parameters
    ----------
    text : str
        The statement.
    source : str
        Table, data sheet, handbook or paper.
    note : str
        Further remarks.
    """

    text: str
    source: str
    note: str = ""


@dataclass(frozen=True, kw_only=True, slots=True)
class Material:
    """A material with its scalar properties.

    Parameters
    ----------
    name : str
        Its identifier in rig files and results, such as "m50".
    title : str
        Its name in prose.
    family : str
        Its kind, such as "steel", "brass", "ceramic" or "polymer": materials of one family rub alike.
    properties : mapping of str to SourcedValue
        Its scalar properties, by their vocabulary names.
    crystal_structure : SourcedText or None
        Its crystal structure, where a source states it.
    aliases : tuple of str
        Further names by which it is found.
    """

    name: str
    title: str
    family: str
    properties: Mapping[str, SourcedValue]
    crystal_structure: SourcedText | None = None
    aliases: tuple[str, ...] = ()

    def property(self, property_name: str) -> SourcedValue:
        """Return a property with its unit and source.

        Parameters
        ----------
        property_name : str
            Its name in the vocabulary, such as "youngs_modulus".

        Returns
        -------
        SourcedValue

        Raises
        ------
        MissingProperty
            If the catalogue has no source for it.
        UnknownName
            If the vocabulary has no such property.
        """
        try:
            return self.properties[property_name]
        except KeyError:
            quantity_name = quantity(property_name).name
            raise MissingProperty(
                f"{self.name} has no {quantity_name}: no source is known; give it in the rig file"
            ) from None

    def value(self, property_name: str) -> float:
        """Return the numerical value of a property, in SI.

        Parameters
        ----------
        property_name : str
            Its name in the vocabulary, such as "youngs_modulus".

        Returns
        -------
        float

        Raises
        ------
        MissingProperty
            If the catalogue has no source for it.
        UnknownName
            If the vocabulary has no such property.
        """
        return self.property(property_name).value


def material(name: str) -> Material:
    """Return a material of the catalogue by its name or alias.

    Parameters
    ----------
    name : str
        Such as "stainless_steel_316" or its alias "ss316"; case, spaces and punctuation do not matter ("AISI 316").

    Returns
    -------
    Material

    Raises
    ------
    UnknownName
        If the catalogue has no such material, with the closest name.
    """
    try:
        return _materials()[_names_by_key()[_key(name)]]
    except KeyError:
        names = (each for known in _materials().values() for each in (known.name, *known.aliases))
        raise UnknownName.among(names, kind="material", name=name) from None


def material_names() -> tuple[str, ...]:
    """Return the names of all materials, including piezoelectric ceramics, in alphabetical order."""
    return tuple(sorted(_materials()))


def material_families() -> tuple[str, ...]:
    """Return the families of all materials, in alphabetical order."""
    return tuple(sorted({each.family for each in _materials().values()}))


_FILES = ("engineering.toml", "piezo.toml")


@cache
def _materials() -> Mapping[str, Material]:
    """Return all materials of the property files by name."""
    tables = [read_property_file(file_name) for file_name in _FILES]
    return {name: _material(name, entry, table.sources) for table in tables for name, entry in table.entries.items()}


@cache
def _names_by_key() -> Mapping[str, str]:
    """Return the names of the materials by the keys of their names and aliases."""
    return {_key(each): known.name for known in _materials().values() for each in (known.name, *known.aliases)}


def _key(name: str) -> str:
    """Return a name without case, spaces and punctuation."""
    return re.sub(r"[\W_]+", "", name.lower())


def _material(name: str, entry: Mapping[str, Any], sources: Mapping[str, str]) -> Material:
    """Return the material of one entry of a property file."""
    structure = entry.get("crystal_structure")
    return Material(
        name=name,
        title=entry["title"],
        family=entry["family"],
        properties=MappingProxyType(
            {key: SourcedValue(**_cited(value, sources)) for key, value in entry["properties"].items()}
        ),
        crystal_structure=SourcedText(**_cited(structure, sources)) if structure else None,
        aliases=tuple(entry.get("aliases", ())),
    )


def _cited(entry: Mapping[str, Any], sources: Mapping[str, str]) -> dict[str, Any]:
    """Return an entry with the key of its source replaced by the citation."""
    return {**entry, "source": sources[entry["source"]]}
