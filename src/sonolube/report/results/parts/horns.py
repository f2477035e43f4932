"""Horns as text and JSON: friction along the face of a Poisson horn, and tuned horns with their modes and stress."""

from collections.abc import Mapping
from math import isnan
from typing import Any

from sonolube.design.horns.face import FaceFriction, HornFace, transition_region
from sonolube.design.horns.tuning import HornDesign, amplitude_limits, loaded_frequency
from sonolube.facts.materials import Material
from sonolube.report.blocks import Block, Rows
from sonolube.report.results.record_object import picked
from sonolube.text.units import format_like, format_si
from sonolube.vocabulary import si


def face_blocks(horn: str, face: HornFace, friction: FaceFriction) -> list[Block]:
    """Node, regions, and the greatest motor force."""
    ends = (-face.end, face.end)  # where the face drives nowhere
    low, high = (end if isnan(at) else at for at, end in zip(transition_region(friction), ends, strict=True))
    node, *known = format_like((friction.node, low, high, *face.measured, *ends), "m")
    rows = [
        ("Node of the axial motion", node),
        ("Friction at the node, of that at rest", f"{friction.at(friction.node):.0%}"),
        ("Transition region", f"{known[0]} to {known[1]}"),
        ("the same, measured", f"{known[2]} to {known[3]} ({face.source})"),
        ("Motor region, left", f"{known[4]} to {known[0]}"),
        ("Motor region, right", f"{known[1]} to {known[5]}"),
        ("Greatest motor force, of the friction at rest", f"{max(0.0, -friction.ratio.min()):.0%}"),
    ]
    return [f"Poisson horn of {horn}, positions from the centre of the face", Rows(rows)]


def face_object(horn: str, face: HornFace, friction: FaceFriction) -> dict[str, Any]:
    """Node, limits of the transition region computed and measured, least friction ratio, for JSON."""
    low, high = (None if isnan(limit) else limit for limit in transition_region(friction))
    start, end = face.measured
    return {
        "horn": horn,
        **si({"node_position": friction.node}, unit="m"),
        "transition_region": si({"start": low, "end": high}, unit="m"),
        "measured_transition_region": si({"start": start, "end": end}, unit="m"),
        **si({"friction_ratio_at_node": friction.at(friction.node)}, unit=""),
        **si({"least_friction_ratio": float(friction.ratio.min())}, unit=""),
    }


_NEAREST = 3  # neighbouring modes printed
_LIMITS = {"fatigue_strength": "fatigue limit", "yield_strength": "yield point"}
_QUANTITIES = ("displacement_gain", "node_position", "face_uniformity", "face_asymmetry", "stress_per_displacement")


def horn_blocks(
    design: HornDesign, material: Material, *, tool_mass: float, vibration_amplitude: float | None
) -> list[Block]:
    """Tuned size, frequency and what follows from the mode."""
    mode, thin, limits = design.tuned.mode, design.body.thin, amplitude_limits(design, material=material)
    sizes = ", ".join(f"{name} {format_si(value, 'm')}" for name, value in design.body.sizes.items())
    near = [f"{name} {at / mode.frequency - 1:+.1%}" for name, at in design.neighbours[:_NEAREST]]
    length = f"{1e3 * design.tuned.length:.2f} mm"
    gain = f"{design.displacement_gain:.2f}"
    if thin is not None:
        length += f"  (thin bar {1e3 * thin.length:.2f} mm)"
        gain += f"  (thin bar {thin.displacement_gain:.2f})"
    error = mode.frequency * mode.frequency_error
    loaded = loaded_frequency(design, tool_mass=tool_mass)
    rows = [
        (design.body.tuned_size, length),
        ("total length", f"{1e3 * design.total_length:.2f} mm"),
        ("frequency", f"{mode.frequency:.0f} Hz +-{error:.0f}  {mode.names[mode.row]}"),
        ("trim", f"{1e-3 * design.tuned.frequency_per_length:+.1f} Hz/mm"),
        ("neighbours", ", ".join(near) or "none below"),
        ("gain", gain),
        ("node", f"{1e3 * design.node_position:.1f} mm from the driven face"),
        ("face", f"Umin/Umax {design.face_uniformity:.3f}, asymmetry {design.face_asymmetry:.2g}"),
        ("peak stress", f"{1e-12 * design.stress_per_displacement:.2f} MPa per um of the working face"),
        *_stress_rows(design, limits, vibration_amplitude),
        *((_LIMITS[name], f"{1e6 * value:.0f} um, zero to peak") for name, value in limits.items()),
        ("tool", f"{1e3 * tool_mass:g} g on the face: {loaded - mode.frequency:+.0f} Hz"),
    ]
    return [f"{design.body.name} of {material.name}" + (f": {sizes}" if sizes else ""), Rows(rows)]


def horn_object(
    design: HornDesign, material: Material, *, tool_mass: float, vibration_amplitude: float | None
) -> dict[str, Any]:
    """Sizes, frequency, quantities of the mode, amplitudes allowed and neighbouring modes, for JSON."""
    tuned, thin = design.tuned, design.body.thin
    frequency, at = tuned.mode.frequency, vibration_amplitude
    peak = {} if at is None else {"vibration_amplitude": at, "peak_stress": design.stress_per_displacement * at}
    return {
        "part": design.body.name,
        "material": material.name,
        "mode": tuned.mode.names[tuned.mode.row],
        "tuned_size": design.body.tuned_size,
        "thin_bar_length": None if thin is None else {"value": thin.length, "unit": "m"},
        "sizes": si(design.body.sizes, unit="m"),
        **si(picked(tuned, "length", "frequency_per_length")),
        **si({"total_length": design.total_length}, unit="m"),
        **si(picked(tuned.mode, "frequency", "frequency_error")),
        **si(picked(design, *_QUANTITIES)),
        **si({"tool_mass": tool_mass, "loaded_frequency": loaded_frequency(design, tool_mass=tool_mass)}),
        **si({"stress_change": design.stress_change}, unit=""),
        **si(peak),
        "amplitude_limits": si(amplitude_limits(design, material=material), unit="m"),
        "neighbours": [
            {"name": name, **si({"frequency": at}), **si({"gap": at / frequency - 1}, unit="")}
            for name, at in design.neighbours
        ],
        "nodes": tuned.mode.model.mesh.node_count,
    }


def _stress_rows(
    design: HornDesign, limits: Mapping[str, float], vibration_amplitude: float | None
) -> list[tuple[str, str]]:
    """Peak stress at the amplitude that was asked for, beside each strength."""
    if vibration_amplitude is None:
        return []
    shares = [f"{vibration_amplitude / at:.0%} of the {_LIMITS[name]}" for name, at in limits.items()]
    stress = f"{1e-6 * design.stress_per_displacement * vibration_amplitude:.0f} MPa"
    return [(f"at {1e6 * vibration_amplitude:g} um", ", ".join([stress, *shares]))]
