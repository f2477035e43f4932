"""Answer of `lab hold`: friction held at each speed, beside the margins of the controller."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sonolube.design.control import ControlDesign
from sonolube.laboratory.closed_loop import (
    HeldFriction,
    HoldMetrics,
    held_friction_dataset,
    held_friction_figure,
    hold_metrics,
)
from sonolube.laboratory.records import Run
from sonolube.report import Drawing
from sonolube.rig import Rig
from sonolube.tasks.answer import Answer, answer, si
from sonolube.tasks.blocks import Block, Rows
from sonolube.tasks.lab.run_answer import SIMULATED, off_text
from sonolube.units import format_si

if TYPE_CHECKING:
    import xarray as xr

_SATURATED = 0.5  # share of the time


@answer
class HoldAnswer(Answer):
    """Friction held at each speed, beside the margins of the controller.

    Parameters
    ----------
    rig : Rig
    design : ControlDesign
    held : HeldFriction
    run : Run
        Read back from its folder.
    simulated : bool
    assumed : mapping of str to str
        Beside the assumptions of the rig file.
    folder : Path
        For figure and dataset, in that of the run.
    """

    rig: Rig
    design: ControlDesign
    held: HeldFriction
    run: Run
    simulated: bool
    assumed: Mapping[str, str]
    folder: Path

    def blocks(self) -> Sequence[Block]:
        """Reference, margins by the design, friction held at each speed, and the record."""
        held, design = self.held, self.design
        rows = [
            ("outcome", held.outcome + (f": {held.reason}" if held.reason else "")),
            ("motor and drive", off_text(is_off=held.is_safe)),
            ("reference", self._reference()),
            ("controller", f"interval {format_si(design.controller.process.sample_interval, 's')}, {_gains(design)}"),
            ("margins told", _margins(design)),
            *((f"at {format_si(phase.sliding_speed, 'm/s')}", _phase_text(phase)) for phase in self._phases()),
            ("record", str(self.run.folder)),
        ]
        return [f"{self.rig.title}, friction held" + (" (virtual)" if self.simulated else ""), Rows(rows)]

    def object(self) -> dict[str, Any]:
        """Reference, controller, margins, what was held at each speed, and the record."""
        held, design = self.held, self.design
        margins = {
            name: getattr(design.margins, name)
            for name in ("gain_margin", "phase_margin", "delay_margin", "sensitivity_peak")
        }
        gains = {name: getattr(design.controller.gains, name) for name in ("proportional_gain", "integral_time")}
        intrinsic = held.intrinsic_friction_force
        return {
            "rig": self.rig.title,
            "outcome": held.outcome,
            "reason": held.reason,
            "safe": held.is_safe,
            "simulated": self.simulated,
            "folder": str(self.run.folder),
            "tags": self.run.facts.get("tags", ""),
            "recordings": [str(path) for path in self.run.recordings],
            **si({"friction_force": held.hold.friction_force, **margins, **gains}),
            **si({"intrinsic_friction_force": intrinsic if intrinsic == intrinsic else None}),
            "phases": [_phase_object(phase) for phase in self._phases()],
        }

    def caveats(self) -> Sequence[str]:
        """What speaks against the record, speeds at which the reference was out of reach, and a simulation."""
        told = list(self.run.caveats)
        for phase in self._phases():
            if phase.saturated_fraction > _SATURATED:
                share, speed = f"{100 * phase.saturated_fraction:.0f} %", format_si(phase.sliding_speed, "m/s")
                told.append(f"at {speed} the voltage was at its limit or 0 for {share} of the time: no reach is left")
        if self.simulated:
            told.append(SIMULATED)
        return told

    def assumptions(self) -> Mapping[str, str]:
        """Assumptions of the rig file and of the resonance."""
        return {**self.rig.assumptions, **self.assumed}

    def figures(self) -> Mapping[str, Drawing]:
        """Friction with its reference, voltage and speed over time."""
        held, simulated = self.held, self.simulated
        if not held.time.size:
            return {}
        caption = f"Friction held at {format_si(held.hold.friction_force, 'N')} by the drive voltage."
        return {"held-friction": Drawing(draw=lambda: held_friction_figure(held, simulated=simulated), caption=caption)}

    def files(self) -> "Mapping[str, xr.Dataset]":
        """Intervals of the controller as netCDF."""
        if not self.held.time.size:
            return {}
        return {"held-friction.nc": held_friction_dataset(self.held, title=f"Friction held on {self.rig.title}")}

    @property
    def is_failure(self) -> bool:
        """Whether the loop ended before its time."""
        return self.held.outcome != "completed"

    def _phases(self) -> tuple[HoldMetrics, ...]:
        """Figures of merit at each speed that was reached under control."""
        return hold_metrics(self.held) if self.held.time.size else ()

    def _reference(self) -> str:
        """Reference, and the friction without vibration that was measured before."""
        text, intrinsic = format_si(self.held.hold.friction_force, "N"), self.held.intrinsic_friction_force
        return text if intrinsic != intrinsic else f"{text}; {format_si(intrinsic, 'N')} without vibration, before"


def _gains(design: ControlDesign) -> str:
    """Gains of the controller."""
    gains = design.controller.gains
    return f"K_c {gains.proportional_gain:.3g}, tau_I {format_si(gains.integral_time, 's')} (SIMC)"


def _margins(design: ControlDesign) -> str:
    """Stability margins of the design."""
    margins = design.margins
    return (
        f"gain {margins.gain_margin:.2f}, phase {degrees(margins.phase_margin):.1f} deg,"
        f" delay {format_si(margins.delay_margin, 's')}, Ms {margins.sensitivity_peak:.2f}"
    )


def _phase_text(phase: HoldMetrics) -> str:
    """How friction was held at one speed."""
    settled = "not settled" if phase.settling_time is None else f"settled after {format_si(phase.settling_time, 's')}"
    error = format_si(phase.tracking_error, "N", scale=phase.friction_force)
    return (
        f"{format_si(phase.friction_force, 'N')}, error {error} rms, {settled},"
        f" {phase.voltage_peak_to_peak:.3g} V peak to peak"
    )


def _phase_object(phase: HoldMetrics) -> dict[str, Any]:
    """Figures of merit at one speed."""
    content = asdict(phase)
    share, scatter = content.pop("saturated_fraction"), content.pop("scatter")
    times = {name: content.pop(name) for name in ("start_time", "settling_time")}
    return si(content) | si(times, unit="s") | si({"scatter": scatter}, unit="N") | {"saturated_fraction": share}
