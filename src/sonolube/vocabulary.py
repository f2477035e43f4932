"""The one list of quantities: what each name means, its symbol and its SI unit.

The list itself is `vocabulary.toml` beside this module. Function arguments, results, rig files and published
tables use its names, and a test holds their docstrings to it.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from types import MappingProxyType

from sonolube.errors import UnknownName


@dataclass(frozen=True, kw_only=True, slots=True)
class Quantity:
    """One physical quantity.

    Parameters
    ----------
    name : str
        Its name in code, files and results.
    symbol : str
        Its symbol in equations, in TeX.
    unit : str
        Its SI unit; empty for pure numbers.
    meaning : str
        What it is, in a few words of the field, fit for an axis.
    """

    name: str
    symbol: str
    unit: str
    meaning: str

    @property
    def axis_label(self) -> str:
        """Meaning and unit as written along an axis."""
        return f"{self.meaning} [{self.unit}]" if self.unit else self.meaning


@cache
def quantities() -> Mapping[str, Quantity]:
    """Return every quantity of the vocabulary by name."""
    text = files("sonolube").joinpath("vocabulary.toml").read_text(encoding="utf-8")
    return MappingProxyType({name: Quantity(name=name, **entry) for name, entry in tomllib.loads(text).items()})


def quantity(name: str) -> Quantity:
    """Return the quantity called `name`.

    Raises
    ------
    UnknownName
        If the vocabulary has no such quantity.
    """
    try:
        return quantities()[name]
    except KeyError:
        raise UnknownName.among(quantities(), kind="quantity", name=name) from None


def unit_of(name: str) -> str:
    """Return the SI unit of the quantity called `name`; empty for pure numbers and for names that are no quantity."""
    known = quantities().get(name)
    return known.unit if known else ""
