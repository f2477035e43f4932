"""Published friction tests as records: each source from its TOML file, those of the package or a user's own."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any, Final

from sonolube.prediction.source_file import PublishedPoint, SourceFile, TestedRigSection, published_point
from sonolube.rig.file.toml_file import prefixed, validated
from sonolube.text.toml_text import read_toml, require_plain_content, toml_content

SHIPPED_FOLDER: Final = "published"
"""Folder of the files in this package."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PublishedRig:
    """Points of one pair of bodies.

    Parameters
    ----------
    source : str
        Short name of the source.
    section : TestedRigSection
        As its file has it.
    points : tuple of PublishedPoint
    """

    source: str
    section: TestedRigSection
    points: tuple[PublishedPoint, ...]

    @property
    def is_normal(self) -> bool:
        """Whether the vibration is along the normal of the contact."""
        return self.section.path.is_normal


@dataclass(frozen=True, kw_only=True, slots=True)
class PublishedSource:
    """A published source.

    Parameters
    ----------
    file : str
        Name of its file.
    title, citation, doi, opened : str
    rigs : tuple of PublishedRig
    """

    file: str
    title: str
    citation: str
    doi: str
    opened: str
    rigs: tuple[PublishedRig, ...]

    @property
    def points(self) -> int:
        """Number of points."""
        return sum(len(rig.points) for rig in self.rigs)

    @property
    def reference(self) -> str:
        """Citation with its doi."""
        return f"{self.citation}. doi:{self.doi}" if self.doi else self.citation


def read_source(path: str | Path) -> PublishedSource:
    """Read a file of published tests.

    Parameters
    ----------
    path : str or Path

    Returns
    -------
    PublishedSource

    Raises
    ------
    InvalidInput
        In one line that names the file, the key and the value.
    """
    with prefixed(str(path)):
        return source_from(read_toml(Path(path), kind="a file of published tests"), file=Path(path).name)


def source_from(content: Mapping[str, Any], *, file: str) -> PublishedSource:
    """Source of the content of its file.

    Parameters
    ----------
    content : mapping
        As TOML gives it.
    file : str
        Name of the file.

    Returns
    -------
    PublishedSource

    Raises
    ------
    InvalidInput
        In one line that names the key and the value.
    """
    require_plain_content(content)
    found = validated(SourceFile, content)
    return PublishedSource(
        file=file,
        title=found.title,
        citation=found.citation,
        doi=found.doi,
        opened=found.opened,
        rigs=tuple(
            PublishedRig(
                source=found.title, section=rig, points=tuple(published_point(rig, point) for point in rig.points)
            )
            for rig in found.rigs
        ),
    )


@cache
def shipped_sources() -> tuple[PublishedSource, ...]:
    """Sources that ship with the package, in the order of their rigs' points.

    Returns
    -------
    tuple of PublishedSource
    """
    folder = files(__package__).joinpath(SHIPPED_FOLDER)
    found = [
        source_from(toml_content(entry.read_text(encoding="utf-8")), file=entry.name)
        for entry in folder.iterdir()
        if entry.name.endswith(".toml")
    ]
    return in_order(found)


def in_order(sources: Iterable[PublishedSource]) -> tuple[PublishedSource, ...]:
    """Sources in an order that does not depend on the names of their files."""
    return tuple(sorted(sources, key=lambda one: (one.rigs[0].points[0].label, one.title, one.citation)))
