"""Reader of rig files, from TOML text to a `Rig`, and replacement of their tables.

A replaced table leaves the comments of the file.
"""

import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from pathlib import Path
from types import MappingProxyType
from typing import Any

from pydantic import ValidationError

from sonolube.errors import InvalidInput
from sonolube.models.actuator import PiezoStack
from sonolube.models.actuator.drive import Drive
from sonolube.models.actuator.waveguide import BarWaveguide, normal_amplitude
from sonolube.models.dynamics import Structure
from sonolube.rig.driven_rig import driven_rig
from sonolube.rig.file.contact_section import RoughnessSection
from sonolube.rig.file.entries import (
    ALTERNATIVES,
    REPLACED,
    FileEntries,
    entry_of,
    from_file,
    set_entry,
    with_derived,
    with_entries,
)
from sonolube.rig.file.modes_file import read_modes
from sonolube.rig.file.rig_folder import rig_file
from sonolube.rig.file.sections import RigFile
from sonolube.rig.file.structures import ModesSection, PinOnDiscSection
from sonolube.rig.file.toml_file import distributions_of, prefixed, validated
from sonolube.rig.record import Rig
from sonolube.text.toml_text import read_toml, require_plain_content


def read_rig(path: str | Path, *, changes: Sequence[str] = ()) -> Rig:
    """Read a rig from a TOML file.

    Parameters
    ----------
    path : str or Path
        The file, or the folder that has it as `rig.toml`.
    changes : sequence of str
        Entries to replace, such as "drive.voltage_peak_to_peak=25.9V".

    Returns
    -------
    Rig

    Raises
    ------
    InvalidInput
        In one line that names the file, the key and the value.

    Examples
    --------
    >>> import sonolube as sl
    >>> rig = sl.read_rig("examples/rigs/tribometer.toml")
    >>> rig.normal_load, rig.drive.voltage_peak_to_peak
    (3.0, 28.0)
    """
    return rig_of_file(path, rig_content(path, changes=changes), changes=changes)


def rig_of_file(path: str | Path, content: Mapping[str, Any], *, changes: Sequence[str]) -> Rig:
    """Rig of the content of a file in which entries were replaced, as `rig_contents` returns it."""
    with prefixed(str(path)):
        rig = rig_from(content)
    return from_file(rig, path=str(path), changes=tuple(changes))


def rig_content(path: str | Path, *, changes: Sequence[str] = ()) -> dict[str, Any]:
    """Content of a rig's file, its entries as they are written.

    Parameters
    ----------
    path : str or Path
        The file, or the folder that has it.
    changes : sequence of str
        Entries to replace, such as "drive.voltage_peak_to_peak=25.9V".

    Returns
    -------
    dict
        A file of modes that the table `structure` names is read in its place.

    Raises
    ------
    InvalidInput
        If the file cannot be read or is no TOML, or a change cannot be made.
    """
    (content,) = rig_contents(path, changes)
    return content


def rig_contents(path: str | Path, *variants: Sequence[str]) -> list[dict[str, Any]]:
    """Content of a rig's file, read once, with the changes of each variant, as `rig_content` returns it."""
    path = rig_file(Path(path))
    with prefixed(str(path)):
        content = read_toml(path, kind="a rig file")
        return [_changed(deepcopy(content), changes, folder=path.parent) for changes in variants]


def _changed(content: dict[str, Any], changes: Sequence[str], *, folder: Path) -> dict[str, Any]:
    """Content of a rig's file with some entries replaced."""
    _refuse_repeated(changes)
    # what another number follows from, such as a stiffness at the load of the file, before that load is replaced
    stated = [change for change in changes if _key(change) in {*REPLACED, *ALTERNATIVES}]
    for change in stated:
        _apply(change, content)
    content = _with_numbers(content)
    for change in changes:
        if change not in stated:
            _apply(change, content)
    require_plain_content(content)
    return _with_modes(content, folder)


def structure_entries(content: Mapping[str, Any]) -> dict[str, float]:
    """Masses, stiffness and damping of the pin-on-disc chain of a rig's file, in SI.

    Raises
    ------
    InvalidInput
        If the content is no rig's, or its structure is no such chain.
    """
    rig_from(content)
    section = RigFile.model_validate(content).structure
    if section is None:
        raise InvalidInput("structure: missing; give the tables stack and structure to compute a motion")
    if not isinstance(section, PinOnDiscSection):
        raise InvalidInput(f'structure.kind: "{section.kind}" has no entries to vary; only "pin_on_disc" has')
    return section.entries()


def rig_from(content: Mapping[str, Any]) -> Rig:
    """Build a rig from the content of its file.

    Raises
    ------
    InvalidInput
        In one line that names the key and the value.
    """
    file = validated(RigFile, content)
    derived = with_derived(content, file)
    if derived != content:
        content, file = derived, validated(RigFile, derived)
    _require_known_assumptions(file, content)
    return with_entries(_rig(file), FileEntries(content, rig_from))


def structure_by_stack(rig: Rig) -> tuple[PiezoStack, Callable[[PiezoStack], Structure]]:
    """Stack of a rig, and its structure as it would be with another stack.

    Parameters
    ----------
    rig : Rig
        From a file with the tables `stack` and `structure`.

    Returns
    -------
    stack : PiezoStack
    in_structure : callable
        Returns the structure with a stack in it, all else as the file says.

    Raises
    ------
    InvalidInput
        If the file lacks the tables, or the rig was not read from one.
    """
    section = RigFile.model_validate(rig.content()).structure
    if rig.stack is None or section is None:
        raise InvalidInput(f"{rig.file or rig.title}: the tables stack and structure are missing")
    if isinstance(section, ModesSection):
        raise InvalidInput(
            f"{rig.file or rig.title}: the stack is part of the modes of its structure, and cannot be another"
        )
    return rig.stack, section.structure


def _with_modes(content: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Content with the file of modes, where its structure names one, replaced by the modes."""
    structure = content.get("structure")
    if isinstance(structure, dict) and structure.get("kind") == "modes" and isinstance(structure.get("file"), str):
        rest = {key: value for key, value in structure.items() if key != "file"}
        with prefixed("structure.file"):
            modes = read_modes(folder / structure["file"])
        if clash := next((name for name in modes if name in rest), None):
            raise InvalidInput(f"structure: give either the file of the modes or their lists, got file and {clash}")
        return content | {"structure": rest | modes}
    return content


def _with_numbers(content: dict[str, Any]) -> dict[str, Any]:
    """Content with the numbers that follow from what it states, where it is valid."""
    try:
        return with_derived(content, RigFile.model_validate(content))
    except ValidationError:
        return content  # its reader says what is wrong


def _key(change: str) -> str:
    return change.partition("=")[0].strip()


def _refuse_repeated(changes: Sequence[str]) -> None:
    keys = [_key(change) for change in changes]
    for place, key in enumerate(keys):
        if key in keys[:place]:
            raise InvalidInput(f"{key} is to be replaced twice, the second time by {changes[place]!r}; give it once")


def _apply(change: str, content: dict[str, Any]) -> None:
    key, equals, text = change.partition("=")
    if not equals:
        raise InvalidInput(f"change {change!r} must look like drive.frequency=22kHz")
    with prefixed(f"change {change!r}"):
        set_entry(content, key, text.strip())


def _require_known_assumptions(file: RigFile, content: Mapping[str, Any]) -> None:
    for key in file.assumptions:
        if entry_of(content, key) is None:
            raise InvalidInput(f"assumptions.{key}: the file has no entry {key}")


def _rig(file: RigFile) -> Rig:
    drive = None if file.drive is None else file.drive.drive()
    stack, structure = _stack_and_structure(file)
    assert isinstance(file.contact.roughness, RoughnessSection)  # a stated one was replaced
    rig = Rig(
        title=file.title,
        source=file.source,
        contact=file.contact.contact(file.contact.roughness),
        normal_load=file.contact.normal_load,
        friction_coefficient=file.friction.friction_coefficient,
        friction_model=file.friction.friction_model(),
        sliding_speed=file.sliding.sliding_speed,
        vibration_amplitude=None if file.vibration is None else file.vibration.vibration_amplitude,
        measured_under=None if file.vibration is None else file.vibration.measured_under(),
        amplitude_per_volt=_amplitude_per_volt(file),
        waveguide_amplitude=_waveguide_amplitude(file, drive),
        amplitude_source=None if file.vibration is None else file.vibration.amplitude_source,
        direction=file.direction(),
        drive=drive,
        capacitance=file.actuator.capacitance if file.actuator else None,
        stack=stack,
        structure=structure,
        pin_material=file.contact.material_of("pin"),
        disc_material=file.contact.material_of("disc"),
        decay_length_origin=file.contact.origin_of_decay_length(),
        assumptions=MappingProxyType(dict(file.assumptions)),
        uncertainty=distributions_of(file),
    )
    return rig if structure is None else driven_rig(rig)


def _amplitude_per_volt(file: RigFile) -> float | None:
    calibration = None if file.vibration is None else file.vibration.calibrated()
    if calibration is not None:
        return calibration.amplitude_per_volt
    return None if file.actuator is None else file.actuator.amplitude_per_volt


def _stack_and_structure(file: RigFile) -> tuple[PiezoStack | None, Structure | None]:
    if file.stack is None or file.structure is None:
        return None, None
    stack = file.stack.stack()
    with prefixed("structure"):
        return stack, file.structure.structure(stack)


def _waveguide_amplitude(file: RigFile, drive: Drive | None) -> float | None:
    section = file.waveguide
    if section is None or drive is None:
        return None
    with prefixed("waveguide"):
        waveguide = BarWaveguide(**section.model_dump(exclude={"position"}), frequency=drive.frequency)
        return float(normal_amplitude(waveguide, position=section.position))


_HEADING = re.compile(r"^\[\[?([\w.]+)\]", re.MULTILINE)


def with_tables(text: str, tables: str) -> str:
    """Text of a rig file with some of its tables replaced.

    Parameters
    ----------
    text : str
        The file.
    tables : str
        The tables that take the place of those of the same name, or come last before `assumptions`.

    Returns
    -------
    str

    Raises
    ------
    InvalidInput
        If what comes out is no rig.
    """
    replaced = set(_HEADING.findall(tables))
    if "structure" in replaced:  # a table of one kind leaves nothing of another kind behind
        replaced |= {name for name, _ in _parts(text) if name.startswith("structure.")}
    kept = [(name, part) for name, part in _parts(text) if name not in replaced]
    last = [part for name, part in kept if name == "assumptions"]
    rest = [part for name, part in kept if name != "assumptions"]
    result = "".join([*(part.rstrip() + "\n\n" for part in rest), tables.rstrip() + "\n\n", *last]).rstrip() + "\n"
    rig_from(tomllib.loads(result))
    return result


def _parts(text: str) -> list[tuple[str, str]]:
    headings = list(_HEADING.finditer(text))
    ends = [heading.start() for heading in headings[1:]] + [len(text)]
    tables = [(heading[1], text[heading.start() : end]) for heading, end in zip(headings, ends, strict=True)]
    return [("", text[: headings[0].start()] if headings else text), *tables]
