"""From the words of the command `optimise` to what it is asked."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sonolube.actuator import CatalogueActuator, PreloadBolt, catalogue_actuator, catalogue_names, read_catalogue
from sonolube.cli.sweep_range import ends_of, values_of
from sonolube.design.optimisation import OWN_ACTUATOR, DesignSpace, HalfWaveHorn, Limits
from sonolube.errors import InvalidInput, UnknownName
from sonolube.materials import material
from sonolube.rig import Rig, structure_entries
from sonolube.rig.driven_rig import driven_rig
from sonolube.units import temperature_difference_to_si, to_si

_WAVEFORMS = ("sine", "square", "triangle", "sawtooth")
_THREAD = re.compile(r"M(\d+(?:\.\d+)?)x(.+)")
_STEEL = 205e9  # Pa


def wanted_ratio(rig: Rig, text: str) -> float:
    """Return friction wanted over friction without vibration, from a coefficient or a force."""
    name = "--target-friction"
    force = bool(re.search(r"[A-Za-z]\s*$", text.strip()))
    intrinsic = rig.friction_coefficient * (rig.normal_load if force else 1.0)
    wanted = to_si(text, unit="N" if force else "", name=name)
    if not 0 < wanted < intrinsic:
        told = f"{intrinsic:.4g}{' N' if force else ''}"
        raise InvalidInput(f"{name} {text} must lie between nought and friction without vibration, {told}")
    return wanted / intrinsic


def limits_of(
    volts: str | None,
    current: str | None,
    slew: str | None,
    pressure: str | None,
    warming: str | None,
    conductance: str | None,
    horn: str | None,
    horn_limit: str | None,
) -> Limits:
    """Return limits from the words of their options."""
    if (horn is None) != (horn_limit is None):
        raise InvalidInput("--horn and --horn-limit belong together: a material and the amplitude of stress it bears")
    if warming is not None and conductance is None:
        raise InvalidInput("--temperature-limit needs --conductance, the heat that the actuator loses per kelvin")
    bar = None
    if horn is not None and horn_limit is not None:
        known = material(horn)
        bar = HalfWaveHorn(
            density=known.value("density"),
            youngs_modulus=known.value("youngs_modulus"),
            stress_limit=to_si(horn_limit, unit="Pa", name="--horn-limit"),
        )
    return Limits(
        voltage_maximum=_si(volts, "V", "--voltage-limit"),
        current_maximum=_si(current, "A", "--current-limit"),
        slew_rate_maximum=_si(slew, "V/s", "--slew-limit"),
        nominal_pressure=_si(pressure, "Pa", "--stress-limit"),
        temperature_rise=None if warming is None else temperature_difference_to_si(warming, name="--temperature-limit"),
        thermal_conductance=_si(conductance, "W/K", "--conductance"),
        horn=bar,
    )


def bolt_of(bolt: str | None, pressed_by: str | None, strength: str) -> PreloadBolt | None:
    """Return the bolt that words such as M6x40mm and a preload describe."""
    if bolt is None and pressed_by is None:
        return None
    if bolt is None or pressed_by is None:
        raise InvalidInput("--bolt and --preload belong together, such as --bolt M6x40mm --preload 1kN")
    found = _THREAD.fullmatch(bolt.strip())
    if not found:
        raise InvalidInput(f"--bolt {bolt} must look like M6x40mm: thread and length that stretches")
    return PreloadBolt(
        thread_diameter=1e-3 * float(found[1]),
        length=to_si(found[2], unit="m", name="--bolt"),
        youngs_modulus=_STEEL,
        yield_strength=to_si(strength, unit="Pa", name="--bolt-strength"),
        preload=to_si(pressed_by, unit="N", name="--preload"),
    )


def space_of(
    rig: Rig,
    content: Mapping[str, Any],
    over: list[str],
    actuators: list[str],
    catalogue: Path | None,
    quality: float,
    bolt: PreloadBolt | None,
) -> DesignSpace:
    """Return what may be chosen."""
    rig = driven_rig(rig)
    drive = rig.drive
    known: dict[str, CatalogueActuator] = {name: catalogue_actuator(name) for name in catalogue_names()}
    if catalogue is not None:
        known |= read_catalogue(catalogue)
    entries = structure_entries(content)
    shapes = [words for words in over if _key(words) == "drive.waveform"]
    numbers = [words for words in over if words not in shapes]
    for words in numbers:
        _require_choice(_key(words), entries)
    ranges = ends_of(numbers)
    for key, (low, high) in ranges.items():
        if not 0 < low < high:
            raise InvalidInput(f"--over {key}: needs a range from above 0 that rises, got {low:g} to {high:g}")
    frequencies = ranges.pop("drive.frequency", (0.8 * drive.frequency, 1.2 * drive.frequency))
    return DesignSpace(
        rig=rig,
        entries=entries,
        frequencies=frequencies,
        ranges={key.removeprefix("structure."): ends for key, ends in ranges.items()},
        actuators=_named(actuators, known),
        waveforms=_waveforms(shapes, drive.waveform),
        catalogue=known,
        mechanical_quality_factor=quality,
        bolt=bolt,
    )


def _key(words: str) -> str:
    return words.partition("=")[0].strip()


def _require_choice(key: str, entries: Mapping[str, float]) -> None:
    table, _, name = key.rpartition(".")
    if table == "structure" and name not in entries:
        raise UnknownName.among(entries, kind="entry of structure", name=name)
    if table != "structure" and key != "drive.frequency":
        raise InvalidInput(f"--over {key}: choose over drive.frequency, drive.waveform or an entry of structure")


def _named(actuators: list[str], known: Mapping[str, CatalogueActuator]) -> tuple[str, ...]:
    """Return the actuators asked for, the whole catalogue that can be used under its own word."""
    names: list[str] = []
    for name in actuators or [OWN_ACTUATOR]:
        every = [each for each, entry in known.items() if entry.complete] if name == "catalogue" else [name]
        names += [each for each in every if each not in names]
    return tuple(names)


def _waveforms(shapes: list[str], own: str) -> tuple[str, ...]:
    asked = tuple(str(value) for value in values_of(shapes).get("drive.waveform", ()))
    for name in asked:
        if name not in _WAVEFORMS:
            raise InvalidInput(f"--over drive.waveform: {name!r} is none of {', '.join(_WAVEFORMS)}")
    return asked or (own,)


def _si(text: str | None, unit: str, name: str) -> float | None:
    return None if text is None else to_si(text, unit=unit, name=name)
