"""Bodies of a rig as its file names them, and their wear in words: its published pair, and the body that wears."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from typing import Any, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.materials import TABOR_FACTOR, material
from sonolube.prediction.hierarchy import central_interval
from sonolube.prediction.wear import published_pair, published_wear
from sonolube.rig import Rig
from sonolube.rig.file.entries import FROM_HARDNESS
from sonolube.text.units import format_si, to_si


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
        hardness = TABOR_FACTOR * stated
    return NamedBody(
        name=known.name, title=known.title, family=known.family, hardness=hardness, is_estimated=is_estimated
    )


def softer_hardness(rig: Rig, pin: str | None = None, disc: str | None = None) -> float | str:
    """Indentation hardness of the softer body of a rig, in Pa; or why it is not known.

    Of the materials given in place of the rig's, else of its named bodies; of a rig without names three times its yield
    strength.
    """
    own = {body.name: body for body in named_bodies(rig)}
    names = [name for name in (pin or rig.pin_material, disc or rig.disc_material) if name is not None]
    bodies = [own.get(body.name, body) for name in names if (body := _body(name))] or list(own.values())
    unknown = [body.title for body in bodies if body.hardness is None]
    if unknown:
        return f"no source states the hardness of {unknown[0]}; give contact.softer.hardness"
    if bodies:
        return min(body.hardness for body in bodies if body.hardness is not None)
    strength = rig.contact.pair.yield_strength
    if not isfinite(strength):
        return "the bodies do not yield; give the hardness of the softer one"
    return TABOR_FACTOR * strength


_NEAR_TIE: Final = 1.25  # ratio of hardnesses below which temper and hardening by work decide
_LARGE: Final = 0.1  # change of the wear rate that counts as one
_SMALL: Final = 0.02  # and one that counts as none
_PROBABILITY: Final = 0.8


@dataclass(frozen=True, kw_only=True, slots=True)
class WornBody:
    """The body of a rig that wears.

    Parameters
    ----------
    names : tuple of str
        Of the materials that may wear: one, two near a tie, none where nothing tells.
    sentence : str
        The same in words, with the hardnesses.
    """

    names: tuple[str, ...]
    sentence: str


def pair_of(rig: Rig) -> str | None:
    """Name of the published pair of materials of a rig, in either order.

    Of `published_wear`; the pair that names most of both materials. None where no published pair is of these materials
    or their families, or where the rig does not name both.
    """
    bodies = named_bodies(rig)
    if len(bodies) < 2:
        return None
    matches = {pair.name: _specificity(pair.sides, *bodies) for pair in published_wear()}
    best = max(matches, key=lambda name: matches[name])
    return best if matches[best] else None


def worn_body(rig: Rig) -> WornBody:
    """Body of a rig that wears: the softer one.

    By indentation hardness. Where one is less than 1.25 times the other, both may wear: tempers of one alloy and
    hardening by work differ by more.
    """
    bodies = named_bodies(rig)
    if len(bodies) < 2:
        return WornBody(
            names=(), sentence="Which body wears is not known: name the materials of both bodies in the rig file."
        )
    first, second = bodies
    if first.name == second.name:
        return WornBody(names=(first.name,), sentence=f"Both bodies are of {first.title} and may wear.")
    if first.hardness is None or second.hardness is None:
        unknown = first if first.hardness is None else second
        return WornBody(
            names=(), sentence=f"Which body wears is not known: no source states the hardness of {unknown.title}."
        )
    softer, harder = sorted(((first.hardness, first), (second.hardness, second)), key=lambda each: each[0])
    ratio = harder[0] / softer[0]
    compared = f"{_hardness_text(softer[1])} against {_hardness_text(harder[1])} of {harder[1].title}"
    if ratio < _NEAR_TIE:
        return WornBody(
            names=(softer[1].name, harder[1].name),
            sentence=f"Both bodies may wear: {softer[1].title} and {harder[1].title} differ by"
            f" {100 * (ratio - 1):.0f} % in hardness, {compared.partition(' of ')[0]}.",
        )
    return WornBody(names=(softer[1].name,), sentence=f"The softer body wears: {softer[1].title}, {compared}.")


def wear_statement(draws: Floats, *, pair: str | None, worn_body: WornBody) -> str:
    """Change of the wear rate in words, with the body that wears.

    Two sentences or three. Where the 80 % interval holds both an increase and a decrease by more than a tenth, the
    change is said to be not known.
    """
    low, high = (float(end) for end in central_interval(1 - np.asarray(draws), _PROBABILITY))
    return f"{_change(low, high, pair=pair, are_named=bool(worn_body.names))} {worn_body.sentence}"


def _change(low: float, high: float, *, pair: str | None, are_named: bool) -> str:
    """Sentences on the change of the wear rate by the ends of the interval of its reduction."""
    known = "" if pair is None else f" {_published(pair)}"
    more, less = f"{max(-100 * low, 0.0):.0f} % more", f"{100 * high:.0f} % less (80 %)"
    if max(abs(low), abs(high)) < _SMALL:
        return "Wear does not change: the vibration has no effect on the contact."
    if low < -_LARGE and high > _LARGE:
        advice = "measure wear with and without vibration" + ("" if are_named else ", or name both materials")
        return (
            f"Whether vibration reduces wear is not known, between {more} and {less}; {advice}."
            f"{known or _unknown_pair()}"
        )
    if low >= -_SMALL:
        return f"Wear falls by {max(100 * low, 0.0):.0f} to {100 * high:.0f} % (80 %).{known}"
    if high <= _SMALL:
        return f"Wear rises by {max(-100 * high, 0.0):.0f} to {-100 * low:.0f} % (80 %).{known}"
    return f"Wear goes from {more} to {less}.{known}"


def _published(pair: str) -> str:
    """Sentence on the tests of a published pair."""
    ratio = float(np.exp(np.mean(np.log(published_pair(pair).wear_rate_ratio))))
    count = published_pair(pair).wear_rate_ratio.size
    tests = "one test" if count == 1 else f"{count} tests"
    change = "it did not fall" if ratio >= 1 else f"it fell by {100 * (1 - ratio):.0f} %"
    return f"In {tests} of {pair} {change}."


def _unknown_pair() -> str:
    """Sentence on the published pairs together."""
    means = [float(np.exp(np.mean(np.log(each.wear_rate_ratio)))) for each in published_wear()]
    none = sum(mean >= 1 for mean in means)
    falls = [100 * (1 - mean) for mean in means if mean < 1]
    return (
        f" Of {len(means)} published pairs of materials wear fell by {min(falls):.0f} to {max(falls):.0f} % in"
        f" {len(falls)}, and not in {none}."
    )


def _specificity(sides: tuple[tuple[str, ...], tuple[str, ...]], one: NamedBody, other: NamedBody) -> int:
    """0 where a published pair is not of two bodies, else more the more of them it names."""
    left, right = sides
    return max(_match(left, one) * _match(right, other), _match(left, other) * _match(right, one))


def _match(side: tuple[str, ...], body: NamedBody) -> int:
    """2 where a side names the material, 1 where it names its family, 0 where neither."""
    return 2 if body.name in side else int(body.family in side)


def _hardness_text(body: NamedBody) -> str:
    """Hardness with its unit."""
    text = format_si(body.hardness or 0.0, "Pa")
    return f"about {text} (three times its yield strength)" if body.is_estimated else text
