"""The vocabulary of physical quantities: name, meaning, TeX symbol and SI unit of each.

The list is `vocabulary.toml` beside this module. Function arguments, results, rig files and published tables use its
names; tests compare the units in their docstrings with it.
"""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import Any

from sonolube.errors import entry_named


@dataclass(frozen=True, kw_only=True, slots=True)
class Quantity:
    """A physical quantity of the vocabulary.

    Parameters
    ----------
    name : str
        Name in code, files and results.
    symbol : str
        Symbol in equations, in TeX.
    unit : str
        SI unit; empty for pure numbers.
    meaning : str
        Technical term for the quantity, as written along an axis.
    text_unit : str
        Unit in text and figures where it is not the SI unit with a prefix, such as mm3/m of a wear rate; else empty.
    customary_unit : str
        Unit of a number that a person types without one, such as um of an amplitude; empty where none is customary.
    also : tuple of str
        Other headings of its columns in tables of measurements, in English and German; of no other quantity.
    """

    name: str
    symbol: str
    unit: str
    meaning: str
    text_unit: str = ""
    customary_unit: str = ""
    also: tuple[str, ...] = ()

    @property
    def axis_label(self) -> str:
        """Label of an axis: meaning and unit."""
        return f"{self.meaning} [{self.unit}]" if self.unit else self.meaning


@cache
def quantities() -> Mapping[str, Quantity]:
    """All quantities of the vocabulary by name."""
    text = files("sonolube").joinpath("vocabulary.toml").read_text(encoding="utf-8")
    return MappingProxyType({name: _quantity(name, **entry) for name, entry in tomllib.loads(text).items()})


def _quantity(name: str, *, also: Sequence[str] = (), **entry: str) -> Quantity:
    """Quantity of an entry of the file."""
    return Quantity(name=name, also=tuple(also), **entry)


def quantity(name: str) -> Quantity:
    """Quantity of a name.

    Examples
    --------
    >>> from sonolube.vocabulary import quantity
    >>> quantity("sliding_speed").axis_label
    'Sliding speed [m/s]'
    """
    return entry_named(quantities(), name, kind="quantity")


def unit_of(name: str) -> str:
    """SI unit of a name; empty for pure numbers and for names that are not in the vocabulary.

    Examples
    --------
    >>> from sonolube.vocabulary import unit_of
    >>> unit_of("wear_rate"), unit_of("friction_ratio")
    ('m2', '')
    """
    known = quantities().get(name)
    return known.unit if known else ""


def si(values: Mapping[str, float | None], *, unit: str | None = None) -> dict[str, Any]:
    """Quantities for JSON, each as its value with its SI unit.

    Such as {"normal_load": {"value": 3.0, "unit": "N"}}.
    """
    return {
        name: {"value": value, "unit": quantity(name).unit if unit is None else unit} for name, value in values.items()
    }
