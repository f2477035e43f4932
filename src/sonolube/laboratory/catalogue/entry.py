"""Entry of a run in the catalogue: what runs are searched by, from the facts and the protocol of a run."""

import tomllib
from dataclasses import dataclass
from math import pi
from pathlib import Path

from sonolube.errors import SonolubeError
from sonolube.facts.protocol import Protocol, flattened, protocol_from
from sonolube.laboratory.records import Run, RunSummary, read_run
from sonolube.printable_text import printable


@dataclass(frozen=True, kw_only=True, slots=True)
class CatalogueEntry:
    """What a run is searched by.

    Parameters
    ----------
    summary : RunSummary
    pin_material, disc_material : str
        Empty where they are not known.
    normal_load : float or None
        [N]
    sliding_speed : float or None
        Highest of the protocol. [m/s]
    tags : tuple of str
    text : str
        Everything of the run that is text, for a search by words.
    """

    summary: RunSummary
    pin_material: str
    disc_material: str
    normal_load: float | None
    sliding_speed: float | None
    tags: tuple[str, ...]
    text: str


def catalogue_entry(folder: Path) -> CatalogueEntry:
    """Entry of a run by its folder; facts of the run go before its protocol.

    Parameters
    ----------
    folder : Path

    Returns
    -------
    CatalogueEntry

    Raises
    ------
    InvalidInput
        If the folder holds no run, or its facts are damaged.
    """
    run = read_run(folder)
    protocol = _protocol(run)
    materials = [_text(run, name) or (getattr(protocol.metadata, name) if protocol else "") for name in _MATERIALS]
    notes = [str(value) for note in run.notes for value in note.facts.values() if isinstance(value, str)]
    facts = [f"{name} {value}" for name, value in run.facts.items()]
    tags = (tag.strip() for tag in _text(run, "tags").split(","))
    return CatalogueEntry(
        summary=run.summary,
        pin_material=materials[0],
        disc_material=materials[1],
        normal_load=_number(run, "normal_load", None if protocol is None else protocol.metadata.normal_load),
        sliding_speed=_number(run, "sliding_speed", None if protocol is None else _speed(run, protocol)),
        tags=tuple(filter(None, tags)),
        text=printable("\n".join([folder.name, run.summary.title, run.summary.reason, run.protocol, *facts, *notes])),
    )


_MATERIALS = ("pin_material", "disc_material")


def _protocol(run: Run) -> Protocol | None:
    """Protocol of a run; None where there is none that can be read."""
    try:
        return protocol_from(tomllib.loads(run.protocol))
    except (SonolubeError, ValueError, RecursionError):
        return None


def _speed(run: Run, protocol: Protocol) -> float | None:
    """Highest sliding speed of a protocol; None where nothing slides or the groove is not known. [m/s]"""
    diameter = protocol.metadata.groove_diameter or _number(run, "groove_diameter", None)
    speeds = [0.0]
    for point in flattened(protocol):
        if point.sliding_speed is not None:
            speeds.append(point.sliding_speed)
        elif point.rotation_speed is not None and diameter is not None:
            speeds.append(pi * diameter * point.rotation_speed)
    return max(speeds) or None


def _text(run: Run, name: str) -> str:
    """Fact as text; empty where it is missing."""
    return str(run.facts.get(name, ""))


def _number(run: Run, name: str, otherwise: float | None) -> float | None:
    """Fact as a number."""
    value = run.facts.get(name)
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) else otherwise
