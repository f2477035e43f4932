"""Entries of a rig file behind the rig read from it: replaced one by one, and written as a file again.

Some follow from what the file states instead: rms height of Ra, Rz or finish, strength of hardness.
"""

from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import dataclass, replace
from math import exp
from pathlib import Path
from typing import Any, Final

from sonolube.errors import InvalidInput
from sonolube.facts.materials import yield_strength_from_hardness
from sonolube.models.surfaces import typical_summits
from sonolube.rig.file.contact_section import (
    STATED_HEIGHTS,
    BodySection,
    StatedHeight,
    StatedRoughnessSection,
    deviation_of_range,
    height_from_maximum_height,
    height_from_roughness_average,
    height_of_finish,
)
from sonolube.rig.file.sections import RigFile
from sonolube.rig.file.toml_file import prefixed
from sonolube.rig.record import Rig
from sonolube.storage.files import write_atomically

ROUGHNESS: Final = "contact.roughness"
"""Table of the roughness."""

TYPICAL: Final = "typical of the height"
"""Beginning of the assumption about summits that the file does not give."""

FROM_HARDNESS: Final = "from the hardness"
"""Beginning of the assumption about a yield strength that follows from a stated hardness, by Tabor's factor."""

_BODIES: Final = ("softer", "harder")

REPLACED: Final[Mapping[str, str]] = {
    **{f"{ROUGHNESS}.{name}": f"{ROUGHNESS}.rms_height" for name in STATED_HEIGHTS},
    **{f"contact.{body}.hardness": f"contact.{body}.yield_strength" for body in _BODIES},
}
"""Keys of what a file may state instead of a number, each with the key of the number."""

ALTERNATIVES: Final[Mapping[str, tuple[str, ...]]] = {
    "contact.decay_length": ("contact.normal_stiffness", "contact.stiffness_load", "contact.decay_length_origin"),
    "contact.normal_stiffness": ("contact.decay_length", "contact.decay_length_origin"),
    "vibration.direction": ("vibration.vibration_direction",),
    "vibration.vibration_direction": ("vibration.direction", "vibration.torsion_radius"),
    "vibration.second_amplitude": ("vibration.second_fraction",),
    "vibration.second_fraction": ("vibration.second_amplitude",),
}
"""Keys of which a file has one, each with the entries whose place it takes where it is set."""

DERIVED_SUMMITS: Final = (f"{ROUGHNESS}.summit_radius", f"{ROUGHNESS}.summit_density")
"""Keys that follow from the height where the file does not give them."""


def with_derived(content: Mapping[str, Any], file: RigFile) -> dict[str, Any]:
    """Content of a rig file with the numbers that follow from its statements.

    Each derived number has an assumption with the relation and a distribution with its spread, unless the file gives
    one; content that states all numbers is returned as it is. A normal stiffness belongs to the load of the file, so
    that the decay length stays the same under another one.
    """
    section = file.contact
    contact = dict(content["contact"])
    reasons: dict[str, str] = {}
    laws: dict[str, str] = {}
    if isinstance(section.roughness, StatedRoughnessSection):
        contact["roughness"], more_reasons, more_laws = _roughness(section.roughness)
        reasons, laws = {**reasons, **more_reasons}, {**laws, **more_laws}
    for name in _BODIES:
        body: BodySection | None = getattr(section, name)
        if body is not None and body.hardness is not None:
            contact[name], more_reasons, more_laws = _body(contact[name], name, body.hardness)
            reasons, laws = {**reasons, **more_reasons}, {**laws, **more_laws}
    if section.normal_stiffness is not None and section.stiffness_load is None:
        contact["stiffness_load"] = contact["normal_load"]
    if not reasons:
        return {**content, "contact": contact}
    for key in file.uncertainty:
        if key in REPLACED:
            raise InvalidInput(f"uncertainty.{key}: give the distribution of {REPLACED[key]}, which follows from it")
    own = {REPLACED.get(key, key): text for key, text in file.assumptions.items()}
    merged = {key: f"{own[key]}; {reason}" if key in own else reason for key, reason in reasons.items()}
    return {**content, "contact": contact, "assumptions": own | merged, "uncertainty": laws | dict(file.uncertainty)}


def _roughness(section: StatedRoughnessSection) -> tuple[dict[str, Any], dict[str, str], dict[str, str]]:
    """Table of the roughness, reasons and distributions of what is derived."""
    height = _height(section)
    summits = typical_summits(rms_height=height.rms_height)
    table: dict[str, Any] = {"rms_height": f"{height.rms_height!r} m"}
    reasons = {f"{ROUGHNESS}.rms_height": height.reason}
    laws = {f"{ROUGHNESS}.rms_height": f"lognormal factor {height.factor:.4g}"}
    for name, unit, factor in (
        ("summit_radius", "m", summits.radius_factor),
        ("summit_density", "/m2", summits.density_factor),
    ):
        given: float | None = getattr(section, name)
        table[name] = f"{getattr(summits, name) if given is None else given!r} {unit}"
        if given is None:
            reasons[f"{ROUGHNESS}.{name}"] = f"{TYPICAL}; {summits.reason}"
            laws[f"{ROUGHNESS}.{name}"] = f"lognormal factor {factor**0.5:.4g}"
    return table, reasons, laws


def _height(section: StatedRoughnessSection) -> StatedHeight:
    if section.roughness_average is not None:
        return height_from_roughness_average(roughness_average=section.roughness_average)
    if section.maximum_height is not None:
        return height_from_maximum_height(maximum_height=section.maximum_height)
    assert section.finish is not None  # the check of the section
    return height_of_finish(section.finish)


def _body(
    table: Mapping[str, Any], name: str, hardness: float
) -> tuple[dict[str, Any], dict[str, str], dict[str, str]]:
    """Table of a body, reason and distribution of its yield strength."""
    found = yield_strength_from_hardness(hardness=hardness)
    rest = {key: value for key, value in table.items() if key != "hardness"}
    key = f"contact.{name}.yield_strength"
    law = f"lognormal factor {exp(deviation_of_range(found.low, found.high)):.4g}"
    return (
        rest | {"yield_strength": f"{found.yield_strength!r} Pa"},
        {key: f"{FROM_HARDNESS}; {found.source}"},
        {key: law} if name == "softer" else {},  # the strength of the harder body enters no model
    )


def entry_of(content: Mapping[str, Any], key: str) -> Any:
    """Entry of the content of a file by its dotted key; None where there is none."""
    place: Any = content
    for part in key.split("."):
        if not isinstance(place, Mapping) or part not in place:
            return None
        place = place[part]
    return place


@dataclass(frozen=True, slots=True)
class FileEntries:
    """Content of the file of a rig.

    Parameters
    ----------
    content : mapping
        Entries as they are written; a file of modes is read in its place.
    rig_from : callable
        Reader of such a content.
    text : str
        File with its comments, where it is kept; empty otherwise.
    path : str
        Of the file; empty where there is none.
    changes : tuple of str
        Entries that were replaced when it was read.
    """

    content: Mapping[str, Any]
    rig_from: Callable[[Mapping[str, Any]], Rig]
    text: str = ""
    path: str = ""
    changes: tuple[str, ...] = ()

    def replaced(self, key: str, value: str | float) -> Rig:
        """Rig of the file with one entry replaced."""
        content = deepcopy(dict(self.content))
        set_entry(content, key, value)
        with prefixed(f"replace({key!r}, {value!r})"):
            return from_file(self.rig_from(content), path=self.path, changes=self.changes)

    def write(self, path: str | Path) -> Path:
        """Write the file with its entries."""
        import tomli_w

        return write_atomically(Path(path), self.text or tomli_w.dumps(self.content))


def with_entries(rig: Rig, entries: FileEntries) -> Rig:
    """Rig that was just read, with the entries of its file."""
    object.__setattr__(rig, "_entries", entries)
    return rig


def from_file(rig: Rig, *, path: str, changes: tuple[str, ...]) -> Rig:
    """Rig that was just read, with the path of its file and the entries that were replaced."""
    entries: FileEntries = object.__getattribute__(rig, "_entries")
    return with_entries(rig, replace(entries, path=path, changes=changes))


def set_entry(content: dict[str, Any], key: str, value: str | float) -> None:
    """Set an entry of the content of a file, its tables made where they are missing."""
    *tables, name = key.strip().split(".")
    if tables and tables[0] == "uncertainty":
        tables, name = tables[:1], key.strip().partition(".")[2]  # the keys of this table are whole
    if not name or not all(tables):
        raise InvalidInput(f"{key!r} is no key of a rig file, such as drive.frequency")
    place = content
    for table in tables:
        place = place.setdefault(table, {})
        if not isinstance(place, dict):
            raise InvalidInput(f"{key}: {table} is not a table")
    if key.strip() in REPLACED:
        _forget(content, place, REPLACED[key.strip()])
    if key.strip() in ALTERNATIVES:
        for other in ALTERNATIVES[key.strip()]:
            _remove(content, place, other)
        content.get("assumptions", {}).pop(key.strip(), None)
    place[name] = value


def _forget(content: dict[str, Any], place: dict[str, Any], number: str) -> None:
    """Remove from a file a number, the entries that it could be derived from, and those derived with it."""
    table = number.rpartition(".")[0]
    assumptions = content.get("assumptions", {})
    derived = [key for key in DERIVED_SUMMITS if str(assumptions.get(key, "")).startswith(TYPICAL)]
    siblings = [each for each in REPLACED if REPLACED[each] == number]
    for each in (number, *siblings, *(derived if table == ROUGHNESS else ())):
        _remove(content, place, each)


def _remove(content: dict[str, Any], place: dict[str, Any], key: str) -> None:
    """Remove an entry of a table of a file, with its assumption and its distribution."""
    place.pop(key.rpartition(".")[2], None)
    content.get("assumptions", {}).pop(key, None)
    content.get("uncertainty", {}).pop(key, None)
