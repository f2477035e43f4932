"""Catalogue of materials: scalar properties of each, every one with its source, and classes of materials.

A class, such as unspecified steel, has medians and spreads over the catalogue, or a cited range.
"""

import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from math import exp, log, sqrt
from statistics import fmean, stdev
from types import MappingProxyType
from typing import Any

from sonolube.errors import MissingProperty, UnknownName
from sonolube.text.units import format_si
from sonolube.vocabulary import quantity


@cache
def read_property_file(file_name: str) -> Mapping[str, Mapping[str, Any]]:
    """Entries of a property file of this package by name, each source in full where the file has its short key."""
    content = tomllib.loads(files("sonolube.facts.materials").joinpath(file_name).read_text(encoding="utf-8"))
    return _cited(content, content.pop("sources"))


def _cited(table: Mapping[str, Any], sources: Mapping[str, str]) -> dict[str, Any]:
    """Table with its sources in full, and those of the tables in it."""
    full: dict[str, Any] = {
        key: _cited(value, sources) if isinstance(value, dict) else value for key, value in table.items()
    }
    return full | {"source": sources[full["source"]]} if "source" in full else full


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
    deviation : float
        Standard deviation of its logarithm over the materials that a class covers; zero for one material.
    """

    value: float
    unit: str
    source: str
    condition: str = ""
    note: str = ""
    deviation: float = 0.0


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
    """A material, or a class of materials, with its scalar properties.

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
    is_class : bool
        Whether it stands for a class of materials, such as unspecified steel: its properties are medians, each
        with the standard deviation of its logarithm.
    """

    name: str
    title: str
    family: str
    properties: Mapping[str, SourcedValue]
    crystal_structure: SourcedText | None = None
    aliases: tuple[str, ...] = ()
    is_class: bool = False

    @property
    def words(self) -> str:
        """Title within a sentence, without its condition and without saying that a class has no grade."""
        name = self.title.split(",")[0].split(" (")[0].removeprefix("Unspecified ")
        name = name.removesuffix(" of unspecified temper")
        first = name.split(" ")[0]
        return name[0].lower() + name[1:] if first.replace("-", "").isalpha() and first[1:].islower() else name

    def property(self, property_name: str) -> SourcedValue:
        """Property with its unit and source.

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
        """Numerical value of a property, in SI.

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


_OF_RANGE = 4  # standard deviations between the ends of a range that holds 95 of 100


def classes_of(materials: Mapping[str, Material]) -> Mapping[str, Material]:
    r"""Classes of materials by name.

    Over n materials of a class a property has the median exp(m) and the standard deviation of its logarithm

    .. math:: s \sqrt{1 + 1/n}

    with the mean m and the standard deviation s of the logarithms: that of one more material of the class. Hardness and
    strength of a metal vary at least as those of one alloy over its tempers. A range that is cited instead is taken to
    hold 95 of 100: its median is the geometric middle, its standard deviation a quarter of the logarithm of its ratio.
    """
    entries = dict(read_property_file("classes.toml"))
    tempers = entries.pop("tempers")
    return {name: _class(name, entry, tempers, materials) for name, entry in entries.items()}


def _class(
    name: str, entry: Mapping[str, Any], tempers: Mapping[str, Any], materials: Mapping[str, Material]
) -> Material:
    """Class of one entry: properties of its members, and those that the entry cites."""
    family = entry.get("family", name)
    own = [each for each in materials.values() if each.family == family]
    members = [materials[each] for each in entry["members"]] if "members" in entry else own
    properties = {key: _over(key, members) for key in sorted({key for each in members for key in each.properties})}
    if entry.get("tempered", False):
        properties |= {key: _tempered(properties[key], tempers) for key in tempers["quantities"]}
    stated = {key: _ranged(value) for key, value in entry.get("properties", {}).items()}
    return Material(
        name=name,
        title=entry["title"],
        family=family,
        properties=MappingProxyType({**properties, **stated}),
        aliases=tuple(entry.get("aliases", ())),
        is_class=True,
    )


def _over(key: str, members: Sequence[Material]) -> SourcedValue:
    """Property over the members that have it."""
    known = {each.name: each.properties[key] for each in members if key in each.properties}
    first, count = next(iter(known.values())), len(known)
    logarithms = [log(each.value) for each in known.values()]
    if count == 1:
        return replace(first, source=f"of {next(iter(known))} alone, {first.source}")
    low, high = (format_si(exp(end(logarithms)), first.unit) for end in (min, max))
    return SourcedValue(
        value=exp(fmean(logarithms)),
        unit=first.unit,
        source=f"{low} to {high} over {count} materials of the catalogue: {', '.join(known)}",
        deviation=stdev(logarithms) * sqrt(1 + 1 / count),
    )


def _tempered(known: SourcedValue, tempers: Mapping[str, Any]) -> SourcedValue:
    """Property that varies at least as that of one alloy over its tempers."""
    least = log(tempers["high"] / tempers["low"]) / _OF_RANGE
    if known.deviation >= least:
        return known
    note = f"spread of the tempers of one alloy, {tempers['source']}: {tempers['note']}"
    return SourcedValue(value=known.value, unit=known.unit, source=known.source, note=note, deviation=least)


def _ranged(entry: Mapping[str, Any]) -> SourcedValue:
    """Property of a cited range, or of a cited value."""
    if "value" in entry:
        return SourcedValue(**entry)
    low, high = entry["low"], entry["high"]
    rest = {key: text for key, text in entry.items() if key not in ("low", "high", "note")}
    span = f"{format_si(low, entry['unit'])} to {format_si(high, entry['unit'])}"
    note = "; ".join(filter(None, (span, entry.get("note"))))
    return SourcedValue(value=sqrt(low * high), note=note, deviation=log(high / low) / _OF_RANGE, **rest)


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
    entries = (each for file_name in _FILES for each in read_property_file(file_name).items())
    return {name: _material(name, entry) for name, entry in entries}


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


def _material(name: str, entry: Mapping[str, Any]) -> Material:
    """Material of one entry of a property file."""
    structure = entry.get("crystal_structure")
    return Material(
        name=name,
        title=entry["title"],
        family=entry["family"],
        properties=MappingProxyType({key: SourcedValue(**value) for key, value in entry["properties"].items()}),
        crystal_structure=SourcedText(**structure) if structure else None,
        aliases=tuple(entry.get("aliases", ())),
    )
