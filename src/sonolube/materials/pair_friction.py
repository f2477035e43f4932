"""Ranges of the coefficient of dry friction by pair of materials, each with its source."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from sonolube.errors import MissingProperty
from sonolube.materials.catalogue import Material, material


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
    """

    low: float
    high: float
    source: str
    condition: str = ""
    note: str = ""


@dataclass(frozen=True, kw_only=True, slots=True)
class FrictionPair:
    """One entry of the table of dry friction.

    Parameters
    ----------
    sides : tuple of two frozensets of str
        Names of materials or families on each side.
    friction : DryFriction
        Friction between any of the one side and any of the other.
    """

    sides: tuple[frozenset[str], frozenset[str]]
    friction: DryFriction


def dry_friction(first: str, second: str) -> DryFriction:
    """Return the range of the coefficient of dry friction of a pair of materials.

    Parameters
    ----------
    first, second : str
        Names or aliases of materials, in any order.

    Returns
    -------
    DryFriction
        Of the two materials where a source has them, else of one material and the family of the other, else of both
        families.

    Raises
    ------
    UnknownName
        If the catalogue has no such material.
    MissingProperty
        If no source is known for the pair.
    """
    one, other = material(first), material(second)
    known = [(_specificity(pair, one, other), pair) for pair in dry_friction_pairs()]
    specificity, best = max(known, key=lambda each: each[0])
    if not specificity:
        raise MissingProperty(
            f"no dry friction is known of {one.name} on {other.name}: measure it without vibration, and give it in the "
            "rig file"
        )
    return best.friction


@cache
def dry_friction_pairs() -> tuple[FrictionPair, ...]:
    """Return all entries of the table of dry friction."""
    content = tomllib.loads(files("sonolube.materials").joinpath("dry_friction.toml").read_text(encoding="utf-8"))
    return tuple(_pair(entry, content["sources"]) for entry in content["pair"])


def _pair(entry: Mapping[str, Any], sources: Mapping[str, str]) -> FrictionPair:
    """Return one entry of the table with its sources spelt out."""
    numbers = {key: value for key, value in entry.items() if key not in ("first", "second", "source")}
    cited = "; ".join(sources[key] for key in entry["source"])
    return FrictionPair(
        sides=(frozenset(entry["first"]), frozenset(entry["second"])), friction=DryFriction(source=cited, **numbers)
    )


def _specificity(pair: FrictionPair, one: Material, other: Material) -> int:
    """Return 0 where an entry is not of two materials, else more the more of both it names."""
    left, right = pair.sides
    return max(_match(left, one) * _match(right, other), _match(left, other) * _match(right, one))


def _match(side: frozenset[str], body: Material) -> int:
    """Return 2 where a side names a material, 1 where it names its family, 0 where neither."""
    return 2 if body.name in side else int(body.family in side)
