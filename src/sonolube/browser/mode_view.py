"""Parts, their sizes and materials as fields of the page Modes; and mode shapes and drawings as files of its jobs."""

import base64
import inspect
import json
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from sonolube.browser.requests import Places

if TYPE_CHECKING:
    from sonolube.models.fem.results.mode_surfaces import SurfaceModes
    from sonolube.tasks.answer import Answer

SHAPES_FILE: Final = "mode-shapes.json"
"""Name of the file of a job with the surface of its part and the modes on it."""

_MEGAPASCAL_PER_MICROMETRE: Final = 1e-12  # Pa/m
_STARTS: Final = {
    **{"length": "127 mm", "width": "60.96 mm", "thickness": "25.4 mm", "radius": "20 mm", "end_radius": "10 mm"},
    **{"end_length": "60 mm", "flange_radius": "30 mm", "flange_thickness": "6 mm"},
    **{"outer_radius": "20 mm", "inner_radius": "8 mm"},
}
"""Sizes that the fields of a part without defaults begin with."""


def mode_parts(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Parts with their sizes, and materials, as the page Modes offers them."""
    from sonolube.design.horns.shapes import SHAPES
    from sonolube.facts.materials import material, material_names, piezo_ceramic_names
    from sonolube.models.fem import PARTS
    from sonolube.tasks.parts.named_parts import DEFAULT_MATERIAL, transducers

    del payload, places
    offered = transducers()
    ceramics = piezo_ceramic_names()
    elastic = ("youngs_modulus", "poisson_ratio", "density")
    solids = {name: material(name) for name in material_names() if name not in ceramics}
    return {
        "parts": [
            {"name": name, "sizes": _sizes(function), "is_transducer": name in offered, "is_horn": name in SHAPES}
            for name, function in {**PARTS, **offered}.items()
        ],
        "materials": [
            [name, solid.title] for name, solid in solids.items() if all(each in solid.properties for each in elastic)
        ],
        "material": DEFAULT_MATERIAL,
        "ceramics": list(ceramics),
    }


def _sizes(function: Callable[..., Any]) -> list[dict[str, Any]]:
    """Sizes of a part as fields: name, label, default as text, and the text to begin with where there is none."""
    from sonolube.vocabulary import quantities

    found = []
    for name, entry in inspect.signature(function).parameters.items():
        if name not in quantities():
            continue
        known, is_needed = quantities()[name], entry.default is entry.empty
        default = "" if is_needed or entry.default is None else _size_text(float(entry.default), known.unit)
        found.append(
            {"name": name, "label": known.meaning, "default": default, "start": _STARTS[name] if is_needed else ""}
        )
    return found


@runtime_checkable
class _HasModes(Protocol):
    """Answer with modes on the surface of a part."""

    def surface_modes(self) -> "SurfaceModes":
        """Modes on the surface of the part."""


def _size_text(value: float, unit: str) -> str:
    """Size as its field shows it, lengths in mm."""
    return f"{1e3 * value:.6g} mm" if unit == "m" else f"{value:.6g} {unit}".strip()


def mode_files(answer: "Answer") -> dict[str, str | bytes]:
    """Files of a job beside those of its answer: mode shapes, and the drawing of a horn; none without a solid."""
    if not isinstance(answer, _HasModes):
        return {}
    from sonolube.figure import render_figure

    drawn = {
        f"{name}.svg": render_figure(drawing.figure(), "svg")
        for name, drawing in answer.figures().items()
        if name.endswith("-drawing")
    }
    return {SHAPES_FILE: json.dumps(shapes_object(answer.surface_modes())), **drawn}


def shapes_object(found: "SurfaceModes") -> dict[str, Any]:
    """Surface and modes as an object for JSON; arrays as base 64 of 32 bits, little-endian."""
    return {
        "points": _packed(found.points, "<f4"),
        "triangles": _packed(found.triangles, "<u4"),
        "axis": found.axis,
        "modes": [
            {
                "name": mode.name,
                "frequency": mode.frequency_text,
                "reference": mode.reference,
                "shape": _packed(mode.shape, "<f4"),
                "stress": None if mode.stress is None else _packed(_MEGAPASCAL_PER_MICROMETRE * mode.stress, "<f4"),
                "peak_stress": _scaled(mode.stress_per_displacement),
                "end_ratio": None if mode.motion is None else mode.motion.end_ratio,
                "nodal_planes": None if mode.motion is None else [1e3 * each for each in mode.motion.nodal_planes],
            }
            for mode in found.modes
        ],
    }


def _scaled(stress: float | None) -> float | None:
    """Stress per displacement in MPa/um."""
    return None if stress is None else _MEGAPASCAL_PER_MICROMETRE * stress


def _packed(values: NDArray[Any], kind: str) -> str:
    """Values of an array in base 64."""
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode()
