"""Classes of materials, such as unspecified steel: medians and spreads over the catalogue or a cited range."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import exp, log, sqrt
from statistics import fmean, stdev
from types import MappingProxyType
from typing import Any

from sonolube.facts.materials.property_file import cited, read_property_file
from sonolube.facts.materials.records import Material, SourcedValue
from sonolube.text.units import format_si

_OF_RANGE = 4  # standard deviations between the ends of a range that holds 95 of 100


def classes_of(materials: Mapping[str, Material]) -> Mapping[str, Material]:
    r"""Classes of materials by name.

    Over n materials of a class a property has the median exp(m) and the standard deviation of its logarithm

    .. math:: s \sqrt{1 + 1/n}

    with the mean m and the standard deviation s of the logarithms: that of one more material of the class. Hardness and
    strength of a metal vary at least as those of one alloy over its tempers. A range that is cited instead is taken to
    hold 95 of 100: its median is the geometric middle, its standard deviation a quarter of the logarithm of its ratio.
    """
    content = read_property_file("classes.toml")
    entries = dict(content.entries)
    tempers = cited(entries.pop("tempers"), content.sources)
    return {name: _class(name, entry, content.sources, tempers, materials) for name, entry in entries.items()}


def _class(
    name: str,
    entry: Mapping[str, Any],
    sources: Mapping[str, str],
    tempers: Mapping[str, Any],
    materials: Mapping[str, Material],
) -> Material:
    """Class of one entry: properties of its members, and those that the entry cites."""
    family = entry.get("family", name)
    own = [each for each in materials.values() if each.family == family]
    members = [materials[each] for each in entry["members"]] if "members" in entry else own
    properties = {key: _over(key, members) for key in sorted({key for each in members for key in each.properties})}
    if entry.get("tempered", False):
        properties |= {key: _tempered(properties[key], tempers) for key in tempers["quantities"]}
    stated = {key: _ranged(cited(value, sources)) for key, value in entry.get("properties", {}).items()}
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
