"""Reading a rig from its file: from text to the records that the models take."""

import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
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
    like_bodies_mindlin_ratio,
)
from sonolube.dynamics import Structure, chain_structure, pin_on_disc_chain
from sonolube.errors import InvalidInput, MissingProperty, SonolubeError, suggestion
from sonolube.materials import material
from sonolube.rig.excitation import waveform_of
from sonolube.rig.file.sections import BodySection, ContactSection, RigFile
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
        return content


def structure_entries(content: Mapping[str, Any]) -> dict[str, float]:
    """Return the table `structure` of a rig's file, in SI.

    Raises
    ------
    InvalidInput
        If the content is no rig's, or has no such table.
    """
    rig_from(content)
    section = RigFile.model_validate(content).structure
    if section is None:
        raise InvalidInput("structure: missing; give the tables stack and structure to compute a motion")
    return section.model_dump()


def rig_from(content: Mapping[str, Any]) -> Rig:
    """Build a rig from the content of its file.

    Raises
    ------
    InvalidInput
        In one line that names the key and the value.
    """
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
    section = RigFile.model_validate(_parsed(path)).structure
    if stack is None or section is None:
        raise InvalidInput(f"{path}: the tables stack and structure are missing")
    entries = section.model_dump()
    return stack, lambda other: chain_structure(pin_on_disc_chain(other, **entries))


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
    key = ".".join(str(part) for part in first["loc"])
    rest = f" (and {len(complaints) - 1} more)" if len(complaints) > 1 else ""
    return f"{key}: {_reason(first['type'], key, first['msg'])}{rest}".removeprefix(": ")


def _reason(kind: str, key: str, message: str) -> str:
    if kind == "extra_forbidden":
        close = suggestion(key.rpartition(".")[2], _known_keys(key.rpartition(".")[0]))
        return f"unknown key; {close}".removesuffix("; ")
    if kind == "missing":
        return "missing"
    return message.removeprefix("Value error, ").strip()


def _known_keys(table: str) -> list[str]:
    schema = RigFile.model_json_schema()
    place = schema
    for name in filter(None, table.split(".")):
        entry = place.get("properties", {}).get(name, {})
        options = entry.get("anyOf", [entry])
        reference = next((option["$ref"] for option in options if "$ref" in option), "")
        place = schema["$defs"].get(reference.rpartition("/")[2], {})
    return list(place.get("properties", {}))


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
    return Rig(
        title=file.title,
        source=file.source,
        contact=_contact(file.contact),
        normal_load=file.contact.normal_load,
        **file.friction.model_dump(),
        sliding_speed=file.sliding.sliding_speed,
        vibration_amplitude=_vibration_amplitude(file, drive),
        drive=drive,
        capacitance=file.actuator.capacitance if file.actuator else None,
        stack=stack,
        structure=structure,
        assumptions=MappingProxyType(dict(file.assumptions)),
        uncertainty=distributions_of(file),
    )


def _stack_and_structure(file: RigFile) -> tuple[PiezoStack | None, Structure | None]:
    if file.stack is None or file.structure is None:
        return None, None
    with _prefixed("stack"):
        stack = PiezoStack(**file.stack.model_dump())
    with _prefixed("structure"):
        return stack, chain_structure(pin_on_disc_chain(stack, **file.structure.model_dump()))


def _contact(section: ContactSection) -> RoughContact:
    with _prefixed("contact.roughness"):
        roughness = Roughness(**section.roughness.model_dump())
    pair = _pair(section)
    with _prefixed("contact"):
        return RoughContact(
            roughness=roughness,
            pair=pair,
            nominal_area=section.nominal_area,
            heights=HEIGHT_DISTRIBUTIONS[section.height_distribution](),
            asperity=ASPERITY_LAWS[section.asperity_law],
        )


def _pair(section: ContactSection) -> ContactPair:
    if section.pair is not None:
        with _prefixed("contact.pair"):
            ratio = like_bodies_mindlin_ratio(poisson_ratio=section.pair.poisson_ratio)
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
