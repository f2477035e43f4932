"""Reader of rig files: from TOML text to a `Rig`."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

from sonolube.actuator import PiezoStack
from sonolube.actuator.drive import Drive
from sonolube.actuator.waveguide import BarWaveguide, normal_amplitude
from sonolube.contact import ASPERITY_LAWS, HEIGHT_DISTRIBUTIONS, RoughContact
from sonolube.contact.pair import ContactPair, ElasticBody, contact_pair, identical_materials_mindlin_ratio
from sonolube.dynamics import Structure
from sonolube.errors import InvalidInput, MissingProperty
from sonolube.friction.models import FRICTION_MODELS, FrictionModel
from sonolube.materials import material
from sonolube.rig.driven_rig import driven_rig
from sonolube.rig.excitation import waveform_of
from sonolube.rig.file.entries import FileEntries, set_entry, with_entries
from sonolube.rig.file.modes_file import read_modes
from sonolube.rig.file.renamed import refuse_former_names
from sonolube.rig.file.sections import BodySection, ContactSection, RigFile
from sonolube.rig.file.structures import ModesSection, PinOnDiscSection
from sonolube.rig.file.toml_file import prefixed, validated
from sonolube.rig.file.uncertainty import distributions_of
from sonolube.rig.record import MeasuredUnder, Rig
from sonolube.surfaces import Roughness
from sonolube.toml_text import read_toml, require_plain_content


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
    with prefixed(str(path)):
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
    with prefixed(str(path)):
        content = read_toml(path, kind="a rig file")
        _refuse_repeated(changes)
        for change in changes:
            _apply(change, content)
        require_plain_content(content)
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
    file = validated(RigFile, content)
    _require_known_assumptions(file, content)
    return with_entries(_rig(file), FileEntries(content, rig_from))


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


def _with_modes(content: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Return the content with the file of modes, where its structure names one, replaced by the modes."""
    structure = content.get("structure")
    if isinstance(structure, dict) and structure.get("kind") == "modes" and isinstance(structure.get("file"), str):
        rest = {key: value for key, value in structure.items() if key != "file"}
        with prefixed("structure.file"):
            modes = read_modes(folder / structure["file"])
        if clash := next((name for name in modes if name in rest), None):
            raise InvalidInput(f"structure: give either the file of the modes or their lists, got file and {clash}")
        return content | {"structure": rest | modes}
    return content


def _refuse_repeated(changes: Sequence[str]) -> None:
    keys = [change.partition("=")[0].strip() for change in changes]
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
        place: Any = content
        for part in key.split("."):
            if not isinstance(place, Mapping) or part not in place:
                raise InvalidInput(f"assumptions.{key}: the file has no entry {key}")
            place = place[part]


def _rig(file: RigFile) -> Rig:
    drive = None
    if file.drive is not None:
        with prefixed("drive"):
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
        vibration_amplitude=None if file.vibration is None else file.vibration.vibration_amplitude,
        measured_under=_measured_under(file),
        amplitude_per_volt=None if file.actuator is None else file.actuator.amplitude_per_volt,
        waveguide_amplitude=_waveguide_amplitude(file, drive),
        amplitude_source=None if file.vibration is None else file.vibration.amplitude_source,
        drive=drive,
        capacitance=file.actuator.capacitance if file.actuator else None,
        stack=stack,
        structure=structure,
        assumptions=MappingProxyType(dict(file.assumptions)),
        uncertainty=distributions_of(file),
    )
    return rig if structure is None else driven_rig(rig)


def _friction_model(file: RigFile) -> FrictionModel:
    with prefixed("friction"):
        return FRICTION_MODELS[file.friction.model](**file.friction.model_parameters())


def _stack_and_structure(file: RigFile) -> tuple[PiezoStack | None, Structure | None]:
    if file.stack is None or file.structure is None:
        return None, None
    with prefixed("stack"):
        stack = PiezoStack(**file.stack.model_dump())
    with prefixed("structure"):
        return stack, file.structure.structure(stack)


def _contact(section: ContactSection) -> RoughContact:
    with prefixed("contact.roughness"):
        roughness = Roughness(**section.roughness.model_dump())
    pair = _pair(section)
    with prefixed("contact"):
        return RoughContact(
            roughness=roughness,
            pair=pair,
            nominal_area=section.nominal_area,
            heights=HEIGHT_DISTRIBUTIONS[section.height_distribution],
            asperity=ASPERITY_LAWS[section.asperity_law],
        )


def _pair(section: ContactSection) -> ContactPair:
    if section.pair is not None:
        with prefixed("contact.pair"):
            ratio = identical_materials_mindlin_ratio(poisson_ratio=section.pair.poisson_ratio)
            return ContactPair(**section.pair.model_dump(), mindlin_ratio=ratio)
    assert section.softer is not None  # the file's own check
    assert section.harder is not None
    with prefixed("contact.softer"):
        softer = _body(section.softer)
        yield_strength = _property(section.softer, "yield_strength")
    with prefixed("contact.harder"):
        harder = _body(section.harder)
    return contact_pair(softer=softer, harder=harder, yield_strength=yield_strength)


def _body(section: BodySection) -> ElasticBody:
    return ElasticBody(**{name: _property(section, name) for name in ("youngs_modulus", "poisson_ratio")})


def _property(section: BodySection, name: str) -> float:
    given: float | None = getattr(section, name)
    if given is not None:
        return given
    if section.material is None:
        raise MissingProperty(f"{name}: missing; give it, or name a material")
    return material(section.material).value(name)


def _measured_under(file: RigFile) -> MeasuredUnder | None:
    if file.vibration is None or file.vibration.vibration_amplitude is None:
        return None
    with prefixed("vibration"):
        return MeasuredUnder(**file.vibration.model_dump(include={"voltage_peak_to_peak", "frequency", "normal_load"}))


def _waveguide_amplitude(file: RigFile, drive: Drive | None) -> float | None:
    section = file.waveguide
    if section is None or drive is None:
        return None
    with prefixed("waveguide"):
        waveguide = BarWaveguide(**section.model_dump(exclude={"position"}), frequency=drive.frequency)
        return float(normal_amplitude(waveguide, position=section.position))
