"""Reader of rig files: from TOML text to a `Rig`."""

import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import Any

from pydantic import ValidationError

from sonolube.actuator import PiezoStack
from sonolube.actuator.drive import Drive
from sonolube.actuator.waveguide import BarWaveguide, normal_amplitude
from sonolube.contact import (
    ASPERITY_LAWS,
    HEIGHT_DISTRIBUTIONS,
    ContactPair,
    ElasticBody,
    RoughContact,
    contact_pair,
    identical_materials_mindlin_ratio,
)
from sonolube.dynamics import Structure
from sonolube.errors import InvalidInput, MissingProperty, SonolubeError, suggestion
from sonolube.friction.models import FRICTION_MODELS, FrictionModel
from sonolube.materials import material
from sonolube.rig.driven_rig import driven_rig
from sonolube.rig.excitation import waveform_of
from sonolube.rig.file.json_schema import tables_of
from sonolube.rig.file.modes_file import read_modes
from sonolube.rig.file.renamed import refuse_former_names
from sonolube.rig.file.sections import BodySection, ContactSection, RigFile
from sonolube.rig.file.structures import STRUCTURES, ModesSection, PinOnDiscSection
from sonolube.rig.file.uncertainty import distributions_of
from sonolube.rig.record import Rig
from sonolube.surfaces import Roughness

_LARGEST_FILE = 1_000_000  # bytes; a rig is a page of text


def read_rig(path: str | Path, *, changes: Sequence[str] = ()) -> Rig:
    """Read a rig from a TOML file.

    Parameters
    ----------
    path : str or Path
        The file.
    changes : sequence of str
        Entries to replace, such as "drive.voltage_peak_to_peak=25.9V".

    Returns
    -------
    Rig

    Raises
    ------
    InvalidInput
        In one line that names the file, the key and the value.
    """
    content = rig_content(path, changes=changes)
    with _prefixed(str(path)):
        return rig_from(content)


def rig_content(path: str | Path, *, changes: Sequence[str] = ()) -> dict[str, Any]:
    """Return the content of a rig's file, its entries as they are written.

    Parameters
    ----------
    path : str or Path
        The file.
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
    path = Path(path)
    with _prefixed(str(path)):
        content = _parsed(path)
        for change in changes:
            _apply(change, content)
        return _with_modes(content, path.parent)


def structure_entries(content: Mapping[str, Any]) -> dict[str, float]:
    """Return masses, stiffness and damping of the pin-on-disc chain of a rig's file, in SI.

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
    refuse_former_names(content)
    try:
        file = RigFile.model_validate(content)
    except ValidationError as refusal:
        raise InvalidInput(_first_complaint(refusal)) from None
    _require_known_assumptions(file, content)
    return _rig(file)


def structure_by_stack(path: str | Path) -> tuple[PiezoStack, Callable[[PiezoStack], Structure]]:
    """Read a rig's stack, and its structure as it would be with another stack.

    Parameters
    ----------
    path : str or Path
        The rig's file, with the tables `stack` and `structure`.

    Returns
    -------
    stack : PiezoStack
    in_structure : callable
        Returns the structure with a stack in it, all else as the file says.

    Raises
    ------
    InvalidInput
        As `read_rig`, or if the file lacks the tables.
    """
    path = Path(path)
    stack = read_rig(path).stack
    section = RigFile.model_validate(rig_content(path)).structure
    if stack is None or section is None:
        raise InvalidInput(f"{path}: the tables stack and structure are missing")
    if isinstance(section, ModesSection):
        raise InvalidInput(f"{path}: the stack is part of the modes of its structure, and cannot be another")
    return stack, section.structure


def _parsed(path: Path) -> dict[str, Any]:
    try:
        if path.stat().st_size > _LARGEST_FILE:
            raise InvalidInput("larger than a rig file can be (1 MB)")
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except FileNotFoundError:
        raise InvalidInput("no such file") from None
    except OSError as failure:
        raise InvalidInput(f"cannot be read: {failure.strerror}") from None
    except UnicodeDecodeError as failure:
        raise InvalidInput(f"not UTF-8 text: byte {failure.object[failure.start]:#04x} at {failure.start}") from None
    except tomllib.TOMLDecodeError as failure:
        raise InvalidInput(f"not valid TOML: {failure}") from None
    except RecursionError:
        raise InvalidInput("not valid TOML: nested too deeply") from None


def _with_modes(content: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Return the content with the file of modes, where its structure names one, replaced by the modes."""
    structure = content.get("structure")
    if isinstance(structure, dict) and structure.get("kind") == "modes" and isinstance(structure.get("file"), str):
        rest = {key: value for key, value in structure.items() if key != "file"}
        with _prefixed("structure.file"):
            modes = read_modes(folder / structure["file"])
        if clash := next((name for name in modes if name in rest), None):
            raise InvalidInput(f"structure: give either the file of the modes or their lists, got file and {clash}")
        return content | {"structure": rest | modes}
    return content


def _apply(change: str, content: dict[str, Any]) -> None:
    path, equals, text = change.partition("=")
    *tables, key = path.strip().split(".")
    if not equals or not key or not all(tables):
        raise InvalidInput(f"change {change!r} must look like drive.frequency=22kHz")
    place = content
    for table in tables:
        place = place.setdefault(table, {})
        if not isinstance(place, dict):
            raise InvalidInput(f"change {change!r}: {table} is not a table")
    place[key] = text.strip()


def _first_complaint(refusal: ValidationError) -> str:
    complaints = refusal.errors(include_url=False, include_context=False)
    # a misspelt key explains the one that is missing
    first = min(complaints, key=lambda complaint: complaint["type"] != "extra_forbidden")
    key = _dotted(first["loc"])
    rest = f" (and {len(complaints) - 1} more)" if len(complaints) > 1 else ""
    return f"{key}: {_reason(first['type'], first['loc'], first['msg'])}{rest}".removeprefix(": ")


def _dotted(place: Iterable[str | int]) -> str:
    """Return the dotted key of a place in the file, without the kind that chose among tables."""
    parts = [str(part) for part in place]
    if parts[:1] == ["structure"] and len(parts) > 1 and parts[1] in STRUCTURES:
        del parts[1]
    return ".".join(parts)


def _reason(kind: str, place: Sequence[str | int], message: str) -> str:
    if kind == "extra_forbidden":
        *tables, key = map(str, place)
        close = suggestion(key, _known_keys(tables))
        return f"unknown key; {close}".removesuffix("; ")
    if kind == "missing":
        return "missing"
    return message.removeprefix("Value error, ").strip()


def _known_keys(tables: Sequence[str]) -> list[str]:
    """Return the keys of a table; the kind of a structure follows its table's name."""
    schema = RigFile.model_json_schema()
    places = [schema]
    for name in tables:
        if name in STRUCTURES:
            places = [place for place in places if place["properties"]["kind"]["const"] == name]
            continue
        entries = [place.get("properties", {}).get(name, {}) for place in places]
        places = [schema["$defs"][known] for entry in entries for known in tables_of(entry)]
    return [key for place in places for key in place.get("properties", {})]


def _require_known_assumptions(file: RigFile, content: Mapping[str, Any]) -> None:
    for key in file.assumptions:
        place: Any = content
        for part in key.split("."):
            if not isinstance(place, Mapping) or part not in place:
                raise InvalidInput(f"assumptions.{key}: the file has no entry {key}")
            place = place[part]


def _rig(file: RigFile) -> Rig:
    drive = None
    if file.drive is not None:
        with _prefixed("drive"):
            drive = Drive(**file.drive.model_dump())
            waveform_of(drive)
    stack, structure = _stack_and_structure(file)
    rig = Rig(
        title=file.title,
        source=file.source,
        contact=_contact(file.contact),
        normal_load=file.contact.normal_load,
        friction_coefficient=file.friction.friction_coefficient,
        friction_model=_friction_model(file),
        sliding_speed=file.sliding.sliding_speed,
        vibration_amplitude=_vibration_amplitude(file, drive),
        drive=drive,
        capacitance=file.actuator.capacitance if file.actuator else None,
        stack=stack,
        structure=structure,
        assumptions=MappingProxyType(dict(file.assumptions)),
        uncertainty=distributions_of(file),
    )
    return rig if structure is None else driven_rig(rig)


def _friction_model(file: RigFile) -> FrictionModel:
    with _prefixed("friction"):
        return FRICTION_MODELS[file.friction.model](**file.friction.model_parameters())


def _stack_and_structure(file: RigFile) -> tuple[PiezoStack | None, Structure | None]:
    if file.stack is None or file.structure is None:
        return None, None
    with _prefixed("stack"):
        stack = PiezoStack(**file.stack.model_dump())
    with _prefixed("structure"):
        return stack, file.structure.structure(stack)


def _contact(section: ContactSection) -> RoughContact:
    with _prefixed("contact.roughness"):
        roughness = Roughness(**section.roughness.model_dump())
    pair = _pair(section)
    with _prefixed("contact"):
        return RoughContact(
            roughness=roughness,
            pair=pair,
            nominal_area=section.nominal_area,
            heights=HEIGHT_DISTRIBUTIONS[section.height_distribution],
            asperity=ASPERITY_LAWS[section.asperity_law],
        )


def _pair(section: ContactSection) -> ContactPair:
    if section.pair is not None:
        with _prefixed("contact.pair"):
            ratio = identical_materials_mindlin_ratio(poisson_ratio=section.pair.poisson_ratio)
            return ContactPair(**section.pair.model_dump(), mindlin_ratio=ratio)
    assert section.softer is not None  # the file's own check
    assert section.harder is not None
    with _prefixed("contact.softer"):
        softer = _body(section.softer)
        yield_strength = _property(section.softer, "yield_strength")
    with _prefixed("contact.harder"):
        harder = _body(section.harder)
    return contact_pair(softer=softer, harder=harder, yield_strength=yield_strength)


def _body(section: BodySection) -> ElasticBody:
    return ElasticBody(
        youngs_modulus=_property(section, "youngs_modulus"), poisson_ratio=_property(section, "poisson_ratio")
    )


def _property(section: BodySection, name: str) -> float:
    given: float | None = getattr(section, name)
    if given is not None:
        return given
    if section.material is None:
        raise MissingProperty(f"{name}: missing; give it, or name a material")
    return material(section.material).value(name)


def _vibration_amplitude(file: RigFile, drive: Drive | None) -> float:
    if file.vibration is not None:
        return file.vibration.vibration_amplitude
    if file.waveguide is not None and drive is not None:
        with _prefixed("waveguide"):
            section = file.waveguide
            waveguide = BarWaveguide(**section.model_dump(exclude={"position"}), frequency=drive.frequency)
            return float(normal_amplitude(waveguide, position=section.position))
    assert drive is not None  # the file's own check
    assert file.actuator is not None
    assert file.actuator.amplitude_per_volt is not None
    assert drive.voltage_peak_to_peak is not None
    return file.actuator.amplitude_per_volt * drive.voltage_peak_to_peak


@contextmanager
def _prefixed(place: str) -> Iterator[None]:
    try:
        yield
    except SonolubeError as refusal:
        raise InvalidInput(f"{place}: {refusal}") from None
