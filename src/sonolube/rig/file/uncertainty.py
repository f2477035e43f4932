"""Table `uncertainty` of a rig file: distributions such as "normal 0.5 um" about the values of the rig."""

import math
import re
from collections.abc import Iterator, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any, get_args, get_origin

from sonolube.errors import InvalidInput, suggestion
from sonolube.rig.distribution import Distribution, Law, LogNormal, Normal, Uniform
from sonolube.rig.file.section import Section
from sonolube.rig.file.sections import RigFile
from sonolube.rig.file.toml_file import prefixed
from sonolube.text.units import format_si, to_si
from sonolube.vocabulary import Quantity

EXAMPLES = (
    "normal 0.5 um",
    "normal 3 %",
    "uniform 10 %",
    "uniform 1 um to 2 um",
    "lognormal 20 %",
    "lognormal factor 2",
)
"""Notation of distributions in a rig file."""

_ENTRY = re.compile(r"(normal|lognormal|uniform)\s+(\S.*)")
_ENDS = re.compile(r"(.+?)\s+to\s+(.+)")
_NUMBER = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
_SHARE = re.compile(_NUMBER + r"\s*%")
_FACTOR = re.compile(r"factor\s+" + _NUMBER)
_EITHER_SIGN = ("voltage_offset", "lowest_voltage", "highest_voltage", "in_plane_phase", "position")
_POSSIBLE = {"poisson_ratio": (0.0, 0.5), "coupling_factor": (0.0, 1.0)} | dict.fromkeys(
    _EITHER_SIGN, (-math.inf, math.inf)
)


def distributions_of(file: RigFile) -> Mapping[str, Distribution]:
    """Distributions of a rig file's uncertain entries, by dotted key.

    Cut off where the quantity can have no value: below zero for most.
    """
    found = {}
    for key, text in file.uncertainty.items():
        with prefixed(f"uncertainty.{key}"):
            found[key] = _distribution(_quantity(key), text, _value(file, key))
    return MappingProxyType(found)


@cache
def number_keys() -> Mapping[str, Quantity]:
    """Quantity of every single number of a rig file, by dotted key."""
    return MappingProxyType(dict(_number_keys(RigFile, "")))


def _number_keys(section: type[Section], place: str) -> Iterator[tuple[str, Quantity]]:
    for name, field in section.model_fields.items():
        for table in _sections(field.annotation):
            yield from _number_keys(table, f"{place}{name}.")
        if known := section.quantity_of(name):
            yield f"{place}{name}", known


def _sections(annotation: Any) -> Iterator[type[Section]]:
    """Yield the tables that a key may hold, those of a list left out."""
    if isinstance(annotation, type) and issubclass(annotation, Section):
        yield annotation
    elif get_origin(annotation) is not list:
        for part in get_args(annotation):
            yield from _sections(part)


def _quantity(key: str) -> Quantity:
    if key not in number_keys():
        last = [known for known in number_keys() if known.rpartition(".")[2] == key.rpartition(".")[2]]
        close = f"did you mean {last[0]}?" if last else suggestion(key, number_keys())
        raise InvalidInput(f"no number of a rig file; {close}".removesuffix("; "))
    return number_keys()[key]


def _value(file: RigFile, key: str) -> float | None:
    place: Any = file
    for part in key.split("."):
        place = getattr(place, part, None)
    return None if place is None else float(place)


def _distribution(known: Quantity, text: str, value: float | None) -> Distribution:
    name, unit = known.name, known.unit
    match = _ENTRY.fullmatch(" ".join(text.split()))
    if match is None:
        raise InvalidInput(f"{text!r} is no distribution; write it like {', '.join(EXAMPLES[:4])} or {EXAMPLES[-1]}")
    kind, rest = match[1], match[2].strip()
    ends = _ENDS.fullmatch(rest)
    if kind == "uniform" and ends is not None:
        low, high = (to_si(end, unit=unit, name=kind) for end in ends.groups())
        law: Law = Uniform(low=low, high=high)
    elif value is None:
        raise InvalidInput(f"the file has no value that {text!r} could be about; give one, or write {EXAMPLES[3]!r}")
    elif kind == "lognormal":
        law = LogNormal(median=value, factor=_factor(rest))
    elif kind == "normal":
        law = Normal(middle=value, deviation=_width(kind, rest, unit, value))
    else:
        width = _width(kind, rest, unit, value)
        law = Uniform(low=value - width, high=value + width)
    lowest, highest = _POSSIBLE.get(name, (0.0, math.inf))
    return Distribution(law=law, lowest=lowest, highest=highest, text=_text(law, unit))


def _factor(rest: str) -> float:
    share, factor = _SHARE.fullmatch(rest), _FACTOR.fullmatch(rest)
    if share is not None:
        return 1 + float(share[1]) / 100
    if factor is not None:
        return float(factor[1])
    raise InvalidInput(f"lognormal {rest}: write {EXAMPLES[4]!r} or {EXAMPLES[5]!r}")


def _width(kind: str, rest: str, unit: str, value: float) -> float:
    share = _SHARE.fullmatch(rest)
    width = to_si(rest, unit=unit, name=kind) if share is None else abs(value) * float(share[1]) / 100
    if not width > 0:
        raise InvalidInput(f"{kind} {rest} is no width" + " about the file's zero" * (value == 0))
    return width


def _text(law: Law, unit: str) -> str:
    match law:
        case Normal():
            return f"normal, {format_si(law.middle, unit)} +- {format_si(law.deviation, unit)}"
        case LogNormal():
            return f"lognormal, {format_si(law.median, unit)} within a factor of {law.factor:.3g}"
        case Uniform():
            return f"uniform, {format_si(law.low, unit)} to {format_si(law.high, unit)}"
