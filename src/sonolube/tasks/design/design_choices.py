"""Arguments of the task `optimise` as a design space, horn, bolt and target."""

from collections.abc import Mapping, Sequence

from sonolube.design.optimisation import OWN_ACTUATOR, DesignSpace, HalfWaveHorn
from sonolube.design.optimisation.bolt_thread import preload_bolt
from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.materials import material
from sonolube.models.actuator import CatalogueActuator, PreloadBolt, catalogue_actuator, catalogue_names, read_catalogue
from sonolube.rig import Rig, structure_entries
from sonolube.rig.driven_rig import driven_rig
from sonolube.tasks.design.closed_loop import friction_force
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.ranges import Values, ends_by_key, values_by_key
from sonolube.tasks.task import shown
from sonolube.text.units import format_si

_WAVEFORM = "drive.waveform"
_WAVEFORMS = ("sine", "square", "triangle", "sawtooth")


def target_ratio(rig: Rig, target: str | float) -> float:
    """Target friction over friction without vibration, from a coefficient or a force."""
    force = friction_force("target_friction", target, normal_load=rig.normal_load)
    intrinsic = rig.friction_coefficient * rig.normal_load
    if not force < intrinsic:
        limit = f"{rig.friction_coefficient:.4g} or {format_si(intrinsic, 'N')}"
        raise InvalidInput(f"{shown('target_friction')} {target} must lie below friction without vibration, {limit}")
    return force / intrinsic


def half_wave_horn(material_name: str | None, limit: float | None) -> HalfWaveHorn | None:
    """Half-wave horn of a material with the stress amplitude allowed in it; None without both."""
    if material_name is None and limit is None:
        return None
    if material_name is None or limit is None:
        raise InvalidInput(
            f"{shown('horn')} and {shown('horn_limit')} belong together: a material and the stress it bears"
        )
    solid = material(material_name)
    return HalfWaveHorn(
        density=solid.value("density"), youngs_modulus=solid.value("youngs_modulus"), stress_limit=limit
    )


def bolt_of_thread(thread: str | None, tension: float | None, strength: float) -> PreloadBolt | None:
    """Preload bolt of a thread such as M6x40mm; None without thread and tension."""
    if thread is None and tension is None:
        return None
    if thread is None or tension is None:
        raise InvalidInput(
            f"{shown('bolt')} and {shown('preload')} belong together, such as {shown('bolt')} M6x40mm"
            f" {shown('preload')} 1kN"
        )
    return preload_bolt(thread, preload=tension, yield_strength=strength, name=shown("bolt"))


def design_space(
    rig: Rig,
    *,
    over: Values,
    actuators: Sequence[str],
    catalogue: InputFile | None,
    mechanical_quality_factor: float,
    bolt: PreloadBolt | None,
) -> DesignSpace:
    """Design space of actuators, frequencies, waveforms and entries of the structure."""
    driven = driven_rig(rig)
    drive = driven.drive
    known: dict[str, CatalogueActuator] = {name: catalogue_actuator(name) for name in catalogue_names()}
    if catalogue is not None:
        known |= read_catalogue(file_path(catalogue))
    entries = structure_entries(rig.content())
    numbers = {key: ends for key, ends in over.items() if key != _WAVEFORM}
    for key in numbers:
        _require_range_key(key, entries)
    ranges = ends_by_key(numbers)
    for key, (low, high) in ranges.items():
        if not 0 < low < high:
            raise InvalidInput(f"{shown('over')} {key}: needs a range from above 0 that rises, got {low:g} to {high:g}")
    frequencies = ranges.pop("drive.frequency", (0.8 * drive.frequency, 1.2 * drive.frequency))
    return DesignSpace(
        rig=driven,
        entries=entries,
        frequencies=frequencies,
        ranges={key.removeprefix("structure."): ends for key, ends in ranges.items()},
        actuators=_actuator_names(actuators, known),
        waveforms=_waveform_names(over, drive.waveform),
        catalogue=known,
        mechanical_quality_factor=mechanical_quality_factor,
        bolt=bolt,
    )


def _require_range_key(key: str, entries: Mapping[str, float]) -> None:
    """Raise for a key that no range can be chosen over."""
    table, _, name = key.rpartition(".")
    if table == "structure" and name not in entries:
        raise UnknownName.among(entries, kind="entry of structure", name=name)
    if table != "structure" and key != "drive.frequency":
        raise InvalidInput(
            f"{shown('over')} {key}: choose over drive.frequency, drive.waveform or an entry of structure"
        )


def _actuator_names(actuators: Sequence[str], known: Mapping[str, CatalogueActuator]) -> tuple[str, ...]:
    """Names of the actuators to choose from, "catalogue" replaced by those whose data sheets are complete."""
    names: list[str] = []
    for name in actuators or [OWN_ACTUATOR]:
        every = [each for each, entry in known.items() if entry.complete] if name == "catalogue" else [name]
        names += [each for each in every if each not in names]
    return tuple(names)


def _waveform_names(over: Values, default: str) -> tuple[str, ...]:
    """Names of the waveforms to choose from."""
    chosen = {key: values for key, values in over.items() if key == _WAVEFORM}
    names = tuple(str(value) for value in values_by_key(chosen).get(_WAVEFORM, ()))
    for name in names:
        if name not in _WAVEFORMS:
            raise InvalidInput(f"{shown('over')} {_WAVEFORM}: {name!r} is none of {', '.join(_WAVEFORMS)}")
    return names or (default,)
