"""Command `measure stiffness`: normal stiffness of a contact by the shift of a resonance between free and pressed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from sonolube.cli.console.answer import Answer, deliver
from sonolube.cli.console.options import OUT, Changes, Json, Load, Out, loaded_rig, refuse_unused, si_option
from sonolube.cli.console.outputs import OutputFolder
from sonolube.errors import InvalidInput
from sonolube.report import Drawing, MeasurementReport, measurement_caveats, measurement_lines, measurement_object
from sonolube.report.measured.contact_stiffness import StiffnessSettings, contact_stiffness_sheet
from sonolube.report.measured.sheet import Sheet
from sonolube.rig import Rig


def stiffness(
    context: typer.Context,
    free: Annotated[Path, typer.Argument(metavar="FREE", help="Spectrum with the contact lifted.")],
    pressed: Annotated[Path, typer.Argument(metavar="PRESSED", help="Spectrum under the load, at small drive.")],
    again: Annotated[
        Path | None, typer.Argument(metavar="[FREE2]", help="Lifted again afterwards: drift enters the interval.")
    ] = None,
    rig: Annotated[
        Path | None, typer.Option("--rig", metavar="RIG.toml", help="Rig, for its load and its structure.")
    ] = None,
    load: Load = None,
    mode_near: Annotated[
        float | None,
        si_option("Hz", "Free resonance to take, such as 154Hz; 0Hz for a floating mode; the strongest by default."),
    ] = None,
    pressed_near: Annotated[
        float | None, si_option("Hz", "Pressed resonance to take; by default the nearest above the free one.")
    ] = None,
    mass: Annotated[
        float | None, si_option("kg", "Of the mode at the contact, instead of the rig's structure.", "--modal-mass")
    ] = None,
    mass_uncertainty: Annotated[
        float | None, si_option("", "Standard uncertainty of the modal mass, such as 10%.", metavar="SHARE")
    ] = None,
    large: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Spectrum under the load at large drive, of constant amplitude.")
    ] = None,
    amplitude: Annotated[
        float | None, si_option("m", "At the contact at large drive, zero to peak, such as 2.5um.")
    ] = None,
    amplitude_uncertainty: Annotated[
        float | None, si_option("", "Its standard uncertainty, such as 5%.", metavar="SHARE")
    ] = None,
    changes: Changes = None,
    out: Annotated[Out, OutputFolder("{pressed}-stiffness.*")] = OUT,
    json: Json = False,
) -> None:
    """Normal stiffness of a contact, and its decay length, by the shift of a resonance from free to pressed.

    Example: sonolube measure stiffness free.csv pressed.csv again.csv --rig rig.toml --mode-near 154Hz
    """
    if large is None:
        refuse_unused(context, "amplitude", "amplitude_uncertainty", because="without --large, whose amplitude it is")
    elif amplitude is None:
        raise InvalidInput("--amplitude is missing; --large needs the amplitude at the contact, such as 2.5um")
    if rig is None:
        refuse_unused(context, "changes", because="without --rig, whose entries it replaces")
    known = None if rig is None else loaded_rig(rig, load=load, changes=changes)
    settings = StiffnessSettings(
        normal_load=_normal_load(known, load),
        structure=None if known is None or mass is not None else known.structure,
        modal_mass=mass,
        modal_mass_deviation=0.1 if mass_uncertainty is None else mass_uncertainty,
        mode_near=mode_near,
        pressed_near=pressed_near,
        vibration_amplitude=amplitude,
        log_amplitude_deviation=0.05 if amplitude_uncertainty is None else amplitude_uncertainty,
    )
    found, lines = contact_stiffness_sheet(free, pressed, settings=settings, again=again, large=large)
    deliver(
        StiffnessAnswer(rig=known, sheet=found, rig_lines=lines, name=f"{pressed.stem}-stiffness", settings=settings),
        folder=out,
        as_json=json,
    )


def _normal_load(rig: Rig | None, load: str | None) -> float:
    """Load by the option, else that of the rig. [N]"""
    if rig is not None:
        return rig.normal_load
    if load is None:
        raise InvalidInput("--rig is missing; give the rig, or --load and --modal-mass")
    from sonolube.units import to_si

    return to_si(load, unit="N", name="--load")


@dataclass(frozen=True, kw_only=True)
class StiffnessAnswer(Answer):
    """Stiffness of a contact with its interval, the lines of a rig file that state it, and the spectra."""

    rig: Rig | None
    sheet: Sheet
    rig_lines: tuple[str, ...]
    name: str
    settings: StiffnessSettings

    def lines(self) -> list[str]:
        """Numbers with their intervals, and what to write into the rig file."""
        advice = ["  for the rig file:", *(f"    {line}" for line in self.rig_lines)] if self.rig_lines else []
        return [*measurement_lines(self._report()), *advice]

    def object(self) -> dict[str, Any]:
        """Numbers with their intervals, and the lines for the rig file."""
        return measurement_object(self._report()) | {"rig_lines": list(self.rig_lines)}

    def caveats(self) -> Sequence[str]:
        """Caveats of fits and estimate."""
        return measurement_caveats(self._report())

    def assumptions(self) -> Mapping[str, str]:
        """Uncertainties that were not stated, and those entries of the rig on which the stiffness rests."""
        share = self.settings.modal_mass_deviation
        assumed = {"modal mass": f"known within {share:.0%}; the stiffness is proportional to it"}
        if self.settings.vibration_amplitude is not None:
            assumed["amplitude"] = f"known within {self.settings.log_amplitude_deviation:.0%}"
        known = {} if self.rig is None else self.rig.assumptions
        return assumed | {key: reason for key, reason in known.items() if key.startswith(("structure", "stack"))}

    def figures(self) -> Mapping[str, Drawing]:
        """Spectra with their fitted resonances."""
        return {self.name: Drawing(draw=self.sheet.figures[0].draw)}

    def _report(self) -> MeasurementReport:
        """Sheet as the report of one measurement."""
        return MeasurementReport(title="stiffness", settings={}, sheets=(self.sheet,), refused={})
