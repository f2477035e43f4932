"""Estimates for contacts: ranges of dry friction by pair of materials, and yield strength from hardness by Tabor."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from sonolube.checks import require_positive
from sonolube.facts.materials.catalogue import Material, material

TABOR_FACTOR = 3.0
"""Hardness over yield strength, 2.8 to 3.2 by Tabor. []"""
_MIN_FACTOR, _LARGEST_FACTOR = 2.0, 6.0
_SOURCE = "D. Tabor, The Hardness and Strength of Metals, J. Inst. Met. 79, 1 (1951): H = c Y, c = 2.8 to 3.2"


@dataclass(frozen=True, kw_only=True, slots=True)
class YieldStrengthEstimate:
    """Yield strength of a metal estimated from its hardness, with the range of the relation.

    Parameters
    ----------
    yield_strength : float
        Estimate, a third of the hardness. [Pa]
    low, high : float
        Range that holds the 0.2 % proof stress of nearly all metals of this hardness, in pascals.
    source : str
        Source of the relation.
    reason : str
        Why the range is as wide as it is.
    """

    yield_strength: float
    low: float
    high: float
    source: str = _SOURCE
    reason: str = (
        "indentation strains the metal by about 8 %: what hardens by work is weaker at first yield, down to a sixth"
    )


def yield_strength_from_hardness(*, hardness: float) -> YieldStrengthEstimate:
    r"""Yield strength of a metal from its indentation hardness by Tabor's relation.

    Parameters
    ----------
    hardness : float
        Vickers or Brinell hardness as a pressure. [Pa]

    Returns
    -------
    YieldStrengthEstimate

    Raises
    ------
    InvalidInput
        If the hardness is not positive and finite.

    Notes
    -----
    .. math:: H = c\,Y

    with c = 2.8 to 3.2 for the flow stress at a strain of 0.08, the strain of a Vickers indentation. [1]_ [2]_ Over the
    0.2 % proof stress the factor is 2 to 6: metals that harden by work yield early. Not for ceramics or polymers.

    References
    ----------
    .. [1] D. Tabor, J. Inst. Met. 79, 1 (1951).
    .. [2] E. J. Pavlina and C. J. Van Tyne, J. Mater. Eng. Perform. 17, 888 (2008). doi:10.1007/s11665-008-9225-5

    Examples
    --------
    >>> from sonolube.facts.materials import yield_strength_from_hardness
    >>> from sonolube.text.units import format_si
    >>> format_si(yield_strength_from_hardness(hardness=1.2e9).yield_strength, "Pa")  # a third
    '400 MPa'
    """
    pressure = float(require_positive(hardness=hardness))
    return YieldStrengthEstimate(
        yield_strength=pressure / TABOR_FACTOR, low=pressure / _LARGEST_FACTOR, high=pressure / _MIN_FACTOR
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class DryFriction:
    """Range of the coefficient of dry friction between two materials.

    Parameters
    ----------
    low, high : float
        Range of the coefficient of sliding friction, unlubricated in air; a pure number.
    source : str
        Tables or papers from which it was read.
    condition : str
        Surfaces, loads and speeds for which it holds; empty where the source does not state any.
    note : str
        Further remarks, such as how the range was widened.
    pair_class : str
        Class of pairs that the range is of, such as "metal on ceramic"; empty for the range of a pair.
    """

    low: float
    high: float
    source: str
    condition: str = ""
    note: str = ""
    pair_class: str = ""


@dataclass(frozen=True, kw_only=True, slots=True)
class FrictionPair:
    """One entry of the table of dry friction.

    Parameters
    ----------
    sides : tuple of two frozensets of str
        Names of materials or families on each side.
    friction : DryFriction
        Friction between any of the one side and any of the other.
    alike : bool
        Whether it holds for two materials of one family only.
    """

    sides: tuple[frozenset[str], frozenset[str]]
    friction: DryFriction
    alike: bool = False


def dry_friction(first: str, second: str) -> DryFriction:
    """Range of the coefficient of dry friction of a pair of materials.

    Parameters
    ----------
    first, second : str
        Names or aliases of materials, in any order.

    Returns
    -------
    DryFriction
        Of the two materials where a source has them, else of one material and the family of the other, else of both
        families, else of their class of pairs, such as metal on ceramic.

    Raises
    ------
    UnknownName
        If the catalogue has no such material.

    Examples
    --------
    >>> from sonolube.facts.materials import dry_friction
    >>> friction = dry_friction("100Cr6", "aluminium_2024")
    >>> friction.low, friction.high
    (0.3, 0.65)
    """
    one, other = material(first), material(second)
    known = [(_specificity(pair, one, other), pair) for pair in dry_friction_pairs()]
    specificity, best = max(known, key=lambda each: each[0])
    if specificity:
        return best.friction
    return next(pair.friction for pair in dry_friction_classes() if _specificity(pair, one, other))


@cache
def dry_friction_pairs() -> tuple[FrictionPair, ...]:
    """All entries of the table of dry friction that name materials or families."""
    content = _content()
    return tuple(_pair(entry, entry["first"], entry["second"], content["sources"]) for entry in content["pair"])


@cache
def dry_friction_classes() -> tuple[FrictionPair, ...]:
    """Entries for classes of pairs, such as metal on ceramic, of which the first that fits holds."""
    content = _content()
    kinds: Mapping[str, Sequence[str]] = content["kinds"]
    kinds = {**kinds, "any": [family for families in kinds.values() for family in families]}
    return tuple(
        _pair(
            {**entry, "pair_class": _class_title(entry)},
            kinds[entry["first"]],
            kinds[entry["second"]],
            content["sources"],
        )
        for entry in content["class"]
    )


@cache
def _content() -> Mapping[str, Any]:
    """Content of the file of dry friction."""
    return tomllib.loads(files("sonolube.facts.materials").joinpath("dry_friction.toml").read_text(encoding="utf-8"))


def _class_title(entry: Mapping[str, Any]) -> str:
    """Class of pairs of an entry in words."""
    second = "one of its own family" if entry.get("alike") else {"any": "any material"}.get(entry["second"])
    return f"{entry['first']} on {second or entry['second']}"


def _pair(
    entry: Mapping[str, Any], first: Sequence[str], second: Sequence[str], sources: Mapping[str, str]
) -> FrictionPair:
    """One entry of the table with its sources spelt out."""
    numbers = {key: value for key, value in entry.items() if key not in ("first", "second", "source", "alike")}
    return FrictionPair(
        sides=(frozenset(first), frozenset(second)),
        friction=DryFriction(source="; ".join(sources[key] for key in entry["source"]), **numbers),
        alike=entry.get("alike", False),
    )


def _specificity(pair: FrictionPair, one: Material, other: Material) -> int:
    """0 where an entry is not of two materials, else more the more of both it names."""
    if pair.alike and one.family != other.family:
        return 0
    left, right = pair.sides
    return max(_match(left, one) * _match(right, other), _match(left, other) * _match(right, one))


def _match(side: frozenset[str], body: Material) -> int:
    """2 where a side names a material, 1 where it names its family, 0 where neither."""
    if body.name in side and body.name != body.family:
        return 2
    return int(body.family in side)
