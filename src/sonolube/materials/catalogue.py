"""What is known of a material: one record of scalar properties, and for each of them where it was read."""

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
    """A number and where it was read.

    Parameters
    ----------
    value : float
        The number, in `unit`.
    unit : str
        Its SI unit; empty for pure numbers.
    source : str
        Table, data sheet, handbook or paper.
    condition : str
        Temper, temperature or kind of test it holds under; empty where the source says nothing.
    note : str
        What else to know of it, such as a source that disagrees.
    """

    value: float
    unit: str
    source: str
    condition: str = ""
    note: str = ""


@dataclass(frozen=True, kw_only=True, slots=True)
class SourcedText:
    """A statement in words and where it was read.

    Parameters
    ----------
    text : str
        The statement.
    source : str
        Table, data sheet, handbook or paper.
    note : str
        What else to know of it.
    """

    text: str
    source: str
    note: str = ""


@dataclass(frozen=True, kw_only=True, slots=True)
class Material:
    """One material.

    Parameters
    ----------
    name : str
        Its name in rig files and results, such as "m50".
    title : str
        Its name in prose.
    properties : mapping of str to SourcedValue
        Its scalar properties, by their names in the vocabulary.
    crystal_structure : SourcedText or None
        Its crystal structure, where a source states it.
    """

    name: str
    title: str
    properties: Mapping[str, SourcedValue]
    crystal_structure: SourcedText | None = None

    def property(self, property_name: str) -> SourcedValue:
        """Return a property with its unit and source.

        Raises
        ------
        MissingProperty
            If no source for it is known.
        UnknownName
            If the vocabulary has no such property.
        """
        try:
            return self.properties[property_name]
        except KeyError:
            known_word = quantity(property_name).name
            raise MissingProperty(
                f"{self.name} has no {known_word}: no source is known; give it in the rig file"
            ) from None

    def value(self, property_name: str) -> float:
        """Return the number of a property, in SI.

        Raises
        ------
        MissingProperty
            If no source for it is known.
        UnknownName
            If the vocabulary has no such property.
        """
        return self.property(property_name).value


def material(name: str) -> Material:
    """Return the material of this name or alias, such as "stainless_steel_316" or "ss316".

    Raises
    ------
    UnknownName
        If there is none.
    """
    try:
        return _materials()[_names_by_alias().get(name, name)]
    except KeyError:
        raise UnknownName.among((*material_names(), *_names_by_alias()), kind="material", name=name) from None


def material_names() -> tuple[str, ...]:
    """Return the names of all materials, piezoelectric ceramics among them, in order of the alphabet."""
    return tuple(sorted(_materials()))


_FILES = ("engineering.toml", "piezo.toml")


@cache
def _materials() -> Mapping[str, Material]:
    tables = [read_property_file(file_name) for file_name in _FILES]
    return {name: _material(name, entry, table.sources) for table in tables for name, entry in table.entries.items()}


@cache
def _names_by_alias() -> Mapping[str, str]:
    entries = {name: entry for file_name in _FILES for name, entry in read_property_file(file_name).entries.items()}
    return {alias: name for name, entry in entries.items() for alias in entry.get("aliases", ())}


def _material(name: str, entry: Mapping[str, Any], sources: Mapping[str, str]) -> Material:
    structure = entry.get("crystal_structure")
    return Material(
        name=name,
        title=entry["title"],
        properties=MappingProxyType(
            {key: SourcedValue(**_cited(value, sources)) for key, value in entry["properties"].items()}
        ),
        crystal_structure=SourcedText(**_cited(structure, sources)) if structure else None,
    )


def _cited(entry: Mapping[str, Any], sources: Mapping[str, str]) -> dict[str, Any]:
    return {**entry, "source": sources[entry["source"]]}
