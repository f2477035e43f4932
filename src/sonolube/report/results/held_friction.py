"""Friction held at each speed beside the margins of the controller: texts, and objects for JSON."""

from dataclasses import asdict
from math import degrees
from typing import Any, Final

from sonolube.design.control import ControlDesign
from sonolube.laboratory import verdict_text
from sonolube.laboratory.closed_loop import HeldFriction, HoldMetrics, hold_metrics
from sonolube.laboratory.records import Run
from sonolube.report.blocks import Block, Rows
from sonolube.report.results.record_object import picked
from sonolube.rig import Rig
from sonolube.text.units import format_si
from sonolube.vocabulary import si

_SATURATED: Final = 0.5  # share of the time
_MARGINS: Final = ("gain_margin", "phase_margin", "delay_margin", "sensitivity_peak")


def held_blocks(rig: Rig, held: HeldFriction, design: ControlDesign, run: Run, *, simulated: bool) -> list[Block]:
    """Reference, margins by the design, friction held at each speed, and the record."""
    rows = [
        ("outcome", held.outcome + (f": {held.reason}" if held.reason else "")),
        ("motor and drive", verdict_text(held.verdict)),
        ("reference", _reference_text(held)),
        ("controller", _controller_text(design)),
        ("margins told", _margins_text(design)),
        *((f"at {format_si(phase.sliding_speed, 'm/s')}", _phase_text(phase)) for phase in _phases(held)),
        ("record", str(run.folder)),
    ]
    return [f"{rig.title}, friction held" + (" (virtual)" if simulated else ""), Rows(rows)]


def held_object(rig: Rig, held: HeldFriction, design: ControlDesign, run: Run, *, simulated: bool) -> dict[str, Any]:
    """Reference, controller, margins, what was held at each speed, and the record, for JSON."""
    return {
        "rig": rig.title,
        **picked(held, "outcome", "reason"),
        "safe": held.is_safe,
        "outputs": verdict_text(held.verdict),
        "simulated": simulated,
        "folder": str(run.folder),
        "tags": run.facts.get("tags", ""),
        "recordings": [str(path) for path in run.recordings],
        **_held_object(held, design),
        "phases": [_phase_object(phase) for phase in _phases(held)],
    }


def _phases(held: HeldFriction) -> tuple[HoldMetrics, ...]:
    """Figures of merit at each speed that was reached under control."""
    return hold_metrics(held) if held.time.size else ()


def _held_object(held: HeldFriction, design: ControlDesign) -> dict[str, Any]:
    """Reference, margins, gains, and friction without vibration."""
    margins = picked(design.margins, *_MARGINS)
    gains = picked(design.controller.gains, "proportional_gain", "integral_time")
    intrinsic = held.intrinsic_friction_force
    return {
        **si({"friction_force": held.hold.friction_force, **margins, **gains}),
        **si({"intrinsic_friction_force": intrinsic if intrinsic == intrinsic else None}),
    }


def _reference_text(held: HeldFriction) -> str:
    """Reference, and the friction without vibration that was measured before."""
    text, intrinsic = format_si(held.hold.friction_force, "N"), held.intrinsic_friction_force
    return text if intrinsic != intrinsic else f"{text}; {format_si(intrinsic, 'N')} without vibration, before"


def saturation_lines(held: HeldFriction) -> list[str]:
    """Speeds at which the reference was out of reach."""
    return [
        f"at {format_si(phase.sliding_speed, 'm/s')} the voltage was at its limit or 0 for"
        f" {100 * phase.saturated_fraction:.0f} % of the time: no reach is left"
        for phase in _phases(held)
        if phase.saturated_fraction > _SATURATED
    ]


def _controller_text(design: ControlDesign) -> str:
    """Interval and gains of the controller."""
    gains, interval = design.controller.gains, format_si(design.controller.process.sample_interval, "s")
    return f"interval {interval}, K_c {gains.proportional_gain:.3g}, tau_I {format_si(gains.integral_time, 's')} (SIMC)"


def _margins_text(design: ControlDesign) -> str:
    """Stability margins of the design."""
    margins = design.margins
    return (
        f"gain {margins.gain_margin:.2f}, phase {degrees(margins.phase_margin):.1f} deg,"
        f" delay {format_si(margins.delay_margin, 's')}, Ms {margins.sensitivity_peak:.2f}"
    )


def _phase_text(one: HoldMetrics) -> str:
    """Figures of merit of friction held at one speed."""
    settled = "not settled" if one.settling_time is None else f"settled after {format_si(one.settling_time, 's')}"
    error = format_si(one.tracking_error, "N", scale=one.friction_force)
    return (
        f"{format_si(one.friction_force, 'N')}, error {error} rms, {settled},"
        f" {one.voltage_peak_to_peak:.3g} V peak to peak"
    )


def _phase_object(one: HoldMetrics) -> dict[str, Any]:
    """Figures of merit at one speed."""
    content = asdict(one)
    share, scatter = content.pop("saturated_fraction"), content.pop("scatter")
    times = {name: content.pop(name) for name in ("start_time", "settling_time")}
    return si(content) | si(times, unit="s") | si({"scatter": scatter}, unit="N") | {"saturated_fraction": share}
