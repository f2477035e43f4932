"""Property files of this package (TOML): material entries by name, and the citations of their sources."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any


@dataclass(frozen=True, kw_only=True, slots=True)
class PropertyFile:
    """Content of one property file.

    Parameters
    ----------
    sources : mapping of str to str
        Citations by the short keys that the entries use.
    entries : mapping of str to mapping
        Content of the file for each material, by its name.
    """

    sources: Mapping[str, str]
    entries: Mapping[str, Mapping[str, Any]]


@cache
def read_property_file(file_name: str) -> PropertyFile:
    """Content of a property file of this package."""
    content = tomllib.loads(files("sonolube.facts.materials").joinpath(file_name).read_text(encoding="utf-8"))
    sources = content.pop("sources")
    return PropertyFile(sources=sources, entries=content)


def cited(entry: Mapping[str, Any], sources: Mapping[str, str]) -> dict[str, Any]:
    """Entry with the key of its source replaced by the citation."""
    return {**entry, "source": sources[entry["source"]]}
