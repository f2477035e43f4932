"""Guidance on the entries that a rig file requires: source and typical values of each, from `guidance.toml`."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from types import MappingProxyType


@dataclass(frozen=True, kw_only=True, slots=True)
class Guidance:
    """Guidance on obtaining a number of a rig file.

    Parameters
    ----------
    obtain : str
        What measures or gives it.
    typical : str
        Range of usual values, with the unit.
    """

    obtain: str
    typical: str

    @property
    def text(self) -> str:
        """Both, as they follow the meaning of the number in a sentence."""
        return f"from {self.obtain}; typically {self.typical}"


@cache
def guidance() -> Mapping[str, Guidance]:
    """Guidance to every number that a rig file requires, by the name of its key."""
    text = files("sonolube.rig.file").joinpath("guidance.toml").read_text(encoding="utf-8")
    return MappingProxyType({name: Guidance(**entry) for name, entry in tomllib.loads(text).items()})
