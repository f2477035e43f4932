"""A rig as a page shows it: its entries as fields with label, unit and usual range, and the drawing of its parts."""

import math
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from typing import Any, Final

from sonolube.browser.answers import names_only, requested_file
from sonolube.browser.requests import Places
from sonolube.browser.rig_sentence import rig_sentence, vibrating_body
from sonolube.design import map_kinds
from sonolube.errors import InvalidInput
from sonolube.example_files import example_files
from sonolube.facts.materials import material, material_classes, material_names
from sonolube.rig import Rig, commanded_quantity
from sonolube.rig.file.reader import rig_contents, rig_of_file
from sonolube.rig.file.section import guidance
from sonolube.tasks.design.sweep import studies_of
from sonolube.text.units import convert, to_si
from sonolube.vocabulary import quantities

_FIRST: Final = (
    "drive.voltage_peak_to_peak",
    "vibration.vibration_amplitude",
    "drive.frequency",
    "sliding.sliding_speed",
    "contact.normal_load",
    "friction.friction_coefficient",
)
"""Entries of the operating point, above all others."""

_CALIBRATION: Final = "vibration.calibration"
_CALIBRATION_HELP: Final = "voltage of the drive, peak to peak, and its amplitude, such as 25 V = 2 um"
_DECADE: Final = 10.0  # of the value of the file, over which a slider runs below and above
_PREFIXES: Final = {"n": 1e-9, "u": 1e-6, "m": 1e-3, "": 1.0, "k": 1e3, "M": 1e6, "G": 1e9}
_READABLE: Final = (1e-5, 1e7)  # sizes of the numbers along an axis
_STEPS: Final = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)


def rig_view(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Rig of a request as an object for JSON.

    Title, source, fields by table, the sentence that is the form of the first ones, what a drawing shows, assumptions,
    the rigs that may be chosen, and the studies and maps that the rig has.
    """
    with ExitStack() as stack:
        path, changes = requested_file(payload.get("rig"), places, stack)
        with names_only(path):
            original, content = rig_contents(path, (), changes)
            rig = rig_of_file(path, content, changes=changes)
    fields = [*rig_fields(content, original, rig.assumptions), *_calibration_to_add(content)]
    first = {key: place for place, key in enumerate(_FIRST)}
    return {
        "title": rig.title,
        "source": rig.source,
        "fields": sorted(fields, key=lambda each: first.get(each["key"], len(first))),
        "sentence": rig_sentence(rig, content, {each["key"] for each in fields}),
        "drawing": _drawing(rig) | {"vibrating_body": vibrating_body(content)},
        "assumptions": dict(rig.assumptions),
        "studies": studies_of(rig),
        "maps": map_kinds(commanded_quantity(rig)),
        "rigs": [*places.rigs, *(name for name, each in example_files().items() if each.is_rig)],
    }


def material_titles(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Titles of all materials by name, and words for classes of materials, such as "Brass, any"."""
    del payload, places
    classes = {name: f"{(words := material(name).words)[:1].upper()}{words[1:]}, any" for name in material_classes()}
    return {name: material(name).title for name in material_names()} | classes


def rig_fields(
    content: Mapping[str, Any], original: Mapping[str, Any], assumptions: Mapping[str, str]
) -> Iterator[dict[str, Any]]:
    """Entries of a rig file as fields, each with its number in every unit that the axis of a figure may have."""
    before = dict(_entries(original))
    for key, value in _entries(content):
        name = key.rpartition(".")[2]
        known = quantities().get(name)
        text = value if isinstance(value, str) else f"{value:.6g}"
        number, unit = _number_and_unit(text)
        ends = _ends(before.get(key, value), text)
        low, high = (None, None) if number is None or ends is None else ends
        advice = guidance().get(name)
        help_text = _CALIBRATION_HELP if key == _CALIBRATION else "" if advice is None else advice.text
        yield {
            "key": key,
            "label": known.meaning if known is not None else name.replace("_", " ").capitalize(),
            "text": text,
            "unit": unit,  # as it is written; empty for a pure number or a word
            "lowest": low,  # of a slider, in this unit; None for what is no number
            "highest": high,
            "assumed": assumptions.get(key, ""),
            "help": help_text,
            "is_first": key in _FIRST,
            "numbers": {} if known is None or number is None else _numbers(text, known.unit),
        }


def _calibration_to_add(content: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Empty field for the calibration of the drive where nothing scales the stated amplitude of a rig by a voltage."""
    vibration, others = content.get("vibration", {}), content.keys() & {"actuator", "drive", "waveguide", "structure"}
    if "vibration_amplitude" not in vibration or "calibration" in vibration:
        return []
    if "voltage_peak_to_peak" in vibration or any("voltage" in str(content[each]) for each in others):
        return []
    return [
        {
            **{"key": _CALIBRATION, "label": "Calibration", "text": "", "unit": "", "lowest": None, "highest": None},
            **{"assumed": "", "help": _CALIBRATION_HELP, "is_first": False, "numbers": {}},
        }
    ]


def _entries(content: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, str | float]]:
    """Entries of a file that are texts or numbers, with their dotted keys."""
    for name, value in content.items():
        key = f"{before}{name}"
        if key in ("title", "source", "assumptions", "uncertainty", "notes"):
            continue
        if isinstance(value, Mapping):
            yield from _entries(value, f"{key}.")
        elif isinstance(value, str | int | float) and not isinstance(value, bool):
            yield key, value


def _number_and_unit(text: str) -> tuple[float | None, str]:
    """Number and unit of a value as it is written; None and nothing for words and for two values."""
    if "=" in text:
        return None, ""
    number, _, unit = text.strip().partition(" ")
    try:
        return float(number), unit.strip()
    except ValueError:
        return None, ""


def _ends(original: str | float, text: str) -> tuple[float, float] | None:
    """Ends of a slider in the unit of the value: round numbers a decade below and above that of the file."""
    number, unit = _number_and_unit(str(original))
    _, shown = _number_and_unit(text)
    if number is None or not math.isfinite(number) or number <= 0:
        return None
    if unit != shown:
        try:
            number = convert(number, from_unit=unit, to_unit=shown)
        except InvalidInput:
            return None
    return _rounded(number / _DECADE), _rounded(number * _DECADE)


def _numbers(text: str, si: str) -> dict[str, float]:
    """Number of a value in its SI unit with each prefix that leaves it readable."""
    try:
        number = to_si(text, unit=si, name="value")
    except InvalidInput:
        return {}
    if not si or not si[0].isalpha() or si[-1].isdigit() or si.startswith("kg"):
        return {si: number}
    scaled = {f"{prefix}{si}": number / size for prefix, size in _PREFIXES.items()}
    return {unit: float(f"{each:.6g}") for unit, each in scaled.items() if _READABLE[0] <= abs(each) <= _READABLE[1]}


def _rounded(number: float) -> float:
    """Nearest round number."""
    decade = 10.0 ** math.floor(math.log10(number))
    return float(f"{decade * min(_STEPS, key=lambda step: abs(math.log(number / decade / step))):.3g}")


def _drawing(rig: Rig) -> dict[str, Any]:
    """Parts of the schematic of a rig, and the keys of the values beside them."""
    return {
        "has_drive": rig.drive is not None,
        "has_structure": rig.structure is not None,
        "friction_model": rig.friction_model.name,
        "direction": rig.direction.direction,
        "amplitude_source": rig.amplitude_source or "",
    }
