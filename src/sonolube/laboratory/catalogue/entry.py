"""Entry of a run in the catalogue: what runs are searched by, from the facts and the protocol of a run."""

import tomllib
from dataclasses import dataclass
from math import pi
from pathlib import Path

from sonolube.errors import SonolubeError
from sonolube.facts.protocol import Protocol, SetPoint, flattened, protocol_from
from sonolube.laboratory.records import Run, RunSummary, read_run
from sonolube.laboratory.records.run_folder import number_of
from sonolube.text.plain_text import printable


@dataclass(frozen=True, kw_only=True, slots=True)
class CatalogueEntry:
    """Facts by which a run is found.

    Parameters
    ----------
    summary : RunSummary
    pin_material, disc_material : str
        Empty where they are not known.
    normal_loads : tuple of float
        All that were set, ascending, in N.
    sliding_speeds : tuple of float
        All above 0 that were set, ascending, in m/s.
    tags : tuple of str
    text : str
        Everything of the run that is text, for a search by words.
    """

    summary: RunSummary
    pin_material: str
    disc_material: str
    normal_loads: tuple[float, ...]
    sliding_speeds: tuple[float, ...]
    tags: tuple[str, ...]
    text: str

    @property
    def normal_load(self) -> float | None:
        """Load of the run; None where it is not known, or there were several. [N]"""
        return self.normal_loads[0] if len(self.normal_loads) == 1 else None

    @property
    def sliding_speed(self) -> float | None:
        """Sliding speed of the run; None where it is not known, or there were several. [m/s]"""
        return self.sliding_speeds[0] if len(self.sliding_speeds) == 1 else None


def catalogue_entry(folder: Path) -> CatalogueEntry:
    """Entry of a run by its folder; facts of the run go before its protocol, but for what its steps set.

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
        normal_loads=_loads(run, protocol),
        sliding_speeds=_speeds(run, protocol),
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


def _loads(run: Run, protocol: Protocol | None) -> tuple[float, ...]:
    """Loads that were set while the disc turned, those of prompts before that of the facts. [N]"""
    stated = protocol.metadata.normal_load if protocol else None
    known = number_of(run.facts, "normal_load")
    known = stated if known is None else known
    loads = {known}
    if protocol is not None:
        points = flattened(protocol)
        told = {point.normal_load if point.normal_load != stated else known for point in points if _turns(point)}
        loads = told or loads
    return tuple(sorted(load for load in loads if load))


def _turns(point: SetPoint) -> bool:
    """Whether the disc turns."""
    return bool(point.sliding_speed or point.rotation_speed)


def _speeds(run: Run, protocol: Protocol | None) -> tuple[float, ...]:
    """Sliding speeds above 0 that were set; none where the groove is not known. [m/s]"""
    stated = number_of(run.facts, "sliding_speed")
    if stated is not None or protocol is None:
        return () if stated is None else (stated,)
    diameter = protocol.metadata.groove_diameter or number_of(run.facts, "groove_diameter")
    speeds = set()
    for point in flattened(protocol):
        if point.sliding_speed is not None:
            speeds.add(point.sliding_speed)
        elif point.rotation_speed is not None and diameter is not None:
            speeds.add(pi * diameter * point.rotation_speed)
    return tuple(sorted(speeds - {0.0}))


def _text(run: Run, name: str) -> str:
    """Fact as text; empty where it is missing."""
    return str(run.facts.get(name, ""))
