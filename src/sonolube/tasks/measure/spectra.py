"""Tasks `measure impedance` and `measure stiffness`: circuits of impedance spectra, and contacts by their resonance.

The normal stiffness of a contact follows from the shift of a resonance between free and pressed.
"""

from collections.abc import Mapping, Sequence
from functools import partial
from types import MappingProxyType
from typing import Annotated, Any, Final, Literal, Unpack

from sonolube.errors import InvalidInput
from sonolube.report import Drawing, MeasurementReport, measurement_object
from sonolube.report.measured.sheet import Sheet, sheet_blocks, sheets_dataset
from sonolube.report.measured.spectra import (
    ImpedanceSettings,
    StackInStructure,
    StiffnessSettings,
    contact_stiffness_sheet,
    impedance_sheet,
)
from sonolube.rig import Rig, structure_by_stack
from sonolube.tasks.answer import Answer, Block, Dataset, answer
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.measure.measured_files import Files, MeasuredFiles, TestSheet, measured
from sonolube.tasks.parameters import (
    File,
    Number,
    OptionalRig,
    OptionalRigSource,
    Parameter,
    Quantity,
    Watched,
    WatchedRigChanges,
    file_stem,
    optional_rig,
    rig_of,
)
from sonolube.tasks.progress import stage
from sonolube.tasks.task import in_si, refuse_unused, shown, task

_LEADS: Final = ("series_inductance", "series_resistance")
_PARTS: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {"plain": (), "loss": ("loss_tangent",), "leads": _LEADS, "loss-and-leads": ("loss_tangent", *_LEADS)}
)


@task
def impedance(
    files: Files,
    *,
    branches: Annotated[
        int | None, Parameter("Number of modes; as many as are significant by default.", lowest=1, highest=8)
    ] = None,
    residual: Annotated[
        Literal["log-complex", "log-magnitude", "linear-magnitude"], Parameter("Residual that the fit minimises.")
    ] = "log-complex",
    series_resistance: Annotated[
        Number | None, Quantity("Of the leads, such as 0.2ohm.", "series_resistance", kind="RESISTANCE")
    ] = None,
    circuit: Annotated[
        Literal["plain", "loss", "leads", "loss-and-leads"] | None,
        Parameter("Parts beside branches: none, or dielectric loss and leads; what the data demand by default."),
    ] = None,
    sweep: Annotated[str | None, Parameter("Sweep of the file, such as memory.", "NAME")] = None,
    stack_of: Annotated[OptionalRigSource, File("Fit the stack of this rig's structure.", "RIG.toml")] = None,
    test_sheet: TestSheet = None,
    **watch: Unpack[Watched],
) -> MeasuredFiles:
    """Impedance: the circuit that fits a spectrum, with quality, frequencies and coupling, or the stack of a rig.

    Example: sonolube measure impedance transducer.csv --residual linear-magnitude --report transducer.html
    """
    if stack_of is not None:
        because = f"for {shown('stack_of')}; it is for an equivalent circuit"
        refuse_unused("branches", "series_resistance", "circuit", because=because)
    settings = ImpedanceSettings(
        branches=branches,
        residual=residual,
        series_resistance=in_si("series_resistance", series_resistance) or 0.0,
        parts=None if circuit is None else _PARTS[circuit],
        sweep=sweep,
        stack=None if stack_of is None else StackInStructure(*structure_by_stack(rig_of(stack_of))),
    )
    return measured("impedance", files, partial(impedance_sheet, settings=settings), test_sheet, doing="fitting")


@task
def stiffness(
    free: Annotated[InputFile, File("Spectrum with the contact lifted.", "FREE")],
    pressed: Annotated[InputFile, File("Spectrum under the load, at small drive.", "PRESSED")],
    again: Annotated[InputFile | None, File("Lifted again afterwards: drift enters the interval.", "[FREE2]")] = None,
    *,
    rig: OptionalRig = None,
    load: Annotated[Number | None, Quantity("Normal load instead of the rig's, such as 40N.", "normal_load")] = None,
    mode_near: Annotated[
        Number | None,
        Quantity("Free resonance to take, such as 154Hz; 0Hz for a floating mode; the strongest by default.", "Hz"),
    ] = None,
    pressed_near: Annotated[
        Number | None, Quantity("Pressed resonance to take; by default the nearest above the free one.", "Hz")
    ] = None,
    modal_mass: Annotated[
        Number | None, Quantity("Of the mode at the contact, instead of the rig's structure.", "modal_mass")
    ] = None,
    mass_uncertainty: Annotated[
        Number | None, Quantity("Standard uncertainty of the modal mass, such as 10%.", "", kind="SHARE")
    ] = None,
    large: Annotated[
        InputFile | None, File("Spectrum under the load at large drive, of constant amplitude.", "FILE")
    ] = None,
    amplitude: Annotated[
        Number | None, Quantity("At the contact at large drive, zero to peak, such as 2.5um.", "vibration_amplitude")
    ] = None,
    amplitude_uncertainty: Annotated[
        Number | None, Quantity("Its standard uncertainty, such as 5%.", "", kind="SHARE")
    ] = None,
    **watch: Unpack[WatchedRigChanges],
) -> "StiffnessAnswer":
    """Normal stiffness of a contact, and its decay length, by the shift of a resonance from free to pressed.

    Example: sonolube measure stiffness free.csv pressed.csv again.csv --rig rig.toml --mode-near 154Hz
    """
    if large is None:
        because = f"without {shown('large')}, whose amplitude it is"
        refuse_unused("amplitude", "amplitude_uncertainty", because=because)
    elif amplitude is None:
        needing = f"{shown('large')} needs the amplitude at the contact, such as 2.5um"
        raise InvalidInput(f"{shown('amplitude')} is missing; {needing}")
    known = optional_rig(rig)
    mass, mass_share = in_si("modal_mass", modal_mass), in_si("mass_uncertainty", mass_uncertainty)
    amplitude_share = in_si("amplitude_uncertainty", amplitude_uncertainty)
    settings = StiffnessSettings(
        normal_load=_normal_load(known, in_si("load", load)),
        structure=None if known is None or mass is not None else known.structure,
        modal_mass=mass,
        modal_mass_deviation=0.1 if mass_share is None else mass_share,
        mode_near=in_si("mode_near", mode_near),
        pressed_near=in_si("pressed_near", pressed_near),
        vibration_amplitude=in_si("amplitude", amplitude),
        log_amplitude_deviation=0.05 if amplitude_share is None else amplitude_share,
    )
    paths = {name: None if file is None else file_path(file) for name, file in (("again", again), ("large", large))}
    with stage("fitting"):
        found, lines = contact_stiffness_sheet(file_path(free), file_path(pressed), settings=settings, **paths)
    name = f"{file_stem(pressed)}-stiffness"
    return StiffnessAnswer(rig=known, sheet=found, rig_lines=lines, name=name, settings=settings)


def _normal_load(rig: Rig | None, load: float | None) -> float:
    """Load as given, else that of the rig. [N]"""
    if load is not None:
        return load
    if rig is None:
        needed = f"give the rig, or {shown('load')} and {shown('modal_mass')}"
        raise InvalidInput(f"{shown('rig')} is missing; {needed}")
    return rig.normal_load


@answer
class StiffnessAnswer(Answer):
    """Stiffness of a contact with its interval, the lines of a rig file that state it, and the spectra."""

    rig: Rig | None
    sheet: Sheet
    rig_lines: Sequence[str]
    name: str
    settings: StiffnessSettings

    def blocks(self) -> Sequence[Block]:
        """Numbers with their intervals, and what to write into the rig file."""
        advice = ["  for the rig file:", *(f"    {line}" for line in self.rig_lines)] if self.rig_lines else []
        return [*sheet_blocks(self.sheet), *advice]

    def object(self) -> dict[str, Any]:
        """Numbers with their intervals, and the lines for the rig file."""
        measured = MeasurementReport(title="stiffness", settings={}, sheets=(self.sheet,), refused={})
        return measurement_object(measured) | {"rig_lines": list(self.rig_lines)}

    def dataset(self) -> Dataset:
        """Numbers with their intervals."""
        return sheets_dataset([self.sheet]).assign_attrs(self.notes())

    def caveats(self) -> Sequence[str]:
        """Caveats of fits and estimate."""
        return self.sheet.caveats

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
        return {self.name: Drawing(chart=self.sheet.figures[0].drawing.chart)}
