"""The data files of this package: entries by name, and the citations that their sources stand for."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any


@dataclass(frozen=True, kw_only=True, slots=True)
class PropertyFile:
    """One data file.

    Parameters
    ----------
    sources : mapping of str to str
        Citations by the short keys that entries use.
    entries : mapping of str to mapping
        What the file says of each material.
    """

    sources: Mapping[str, str]
    entries: Mapping[str, Mapping[str, Any]]


@cache
def read_property_file(file_name: str) -> PropertyFile:
    """Return the content of a data file of this package."""
    content = tomllib.loads(files("sonolube.materials").joinpath(file_name).read_text(encoding="utf-8"))
    sources = content.pop("sources")
    return PropertyFile(sources=sources, entries=content)
