"""Command `transient`: start-up of a rig from rest by time integration."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from sonolube.cli.console.answer import Answer, aligned, deliver, si
from sonolube.cli.console.options import OUT, Amplitude, Changes, Json, Out, RigPath, TypedNumber, loaded_rig, si_option
from sonolube.cli.console.outputs import OutputFolder
from sonolube.cli.console.progress import progress
from sonolube.compilation import few_points
from sonolube.report import Drawing
from sonolube.rig import Rig, StartUp, resolved_vibration, start_up
from sonolube.rig.figures import start_up_figure
from sonolube.rig.labelled_arrays import LabelledArrays
from sonolube.rig.result_datasets import start_up_arrays
from sonolube.units import format_si

_QUANTITIES = ("settling_time", "vibration_amplitude", "mean_displacement", "beat_frequency")


@few_points()
def transient(
    rig: RigPath,
    run_time: Annotated[float, si_option("s", "Time that is integrated.", "--duration")] = TypedNumber("0.1s", "s"),
    amplitude: Amplitude = None,
    changes: Changes = None,
    out: Annotated[Out, OutputFolder("{rig}-transient.*")] = OUT,
    json: Json = False,
) -> None:
    """Start-up from rest: settling of the tip's vibration, step by step.

    Example: sonolube transient examples/rigs/tribometer.toml --duration 0.06s
    """
    known = loaded_rig(rig, changes=changes, amplitude=amplitude)
    with progress("marching"):
        result = start_up(known, duration=run_time)
    deliver(StartUpAnswer(rig=known, result=result, name=f"{rig.stem}-transient"), folder=out, as_json=json)


@dataclass(frozen=True, kw_only=True)
class StartUpAnswer(Answer):
    """Start-up of a rig: settling time, final amplitude and slow oscillation."""

    rig: Rig
    result: StartUp
    name: str

    def lines(self) -> list[str]:
        """Settling time, amplitude, mean displacement, slow oscillation and status."""
        found = self.result
        rows = [
            ("amplitude settles", f"within 2 % after {format_si(found.settling_time, 's')}"),
            ("amplitude", f"{format_si(found.vibration_amplitude, 'm')}: {resolved_vibration(self.rig).text}"),
            ("mean displacement", format_si(found.mean_displacement, "m")),
            ("slow oscillation", format_si(found.beat_frequency, "Hz")),
            ("status", found.status + (f": {found.reason}" if found.reason else "")),
        ]
        return [f"{self.rig.title}, {format_si(self.rig.normal_load, 'N')}, from rest", *aligned(rows)]

    def object(self) -> dict[str, Any]:
        """Status, settling time, amplitude, mean displacement and frequency of the slow oscillation."""
        return {
            "rig": self.rig.title,
            "amplitude_source": resolved_vibration(self.rig).source,
            "status": self.result.status,
            "reason": self.result.reason,
            **si({name: getattr(self.result, name) for name in _QUANTITIES}),
        }

    def figures(self) -> Mapping[str, Drawing]:
        """Displacement of the tip over time."""
        return {self.name: Drawing(draw=lambda: start_up_figure(self.rig, self.result))}

    def files(self) -> Mapping[str, LabelledArrays]:
        """Trajectory as netCDF."""
        return {f"{self.name}.nc": start_up_arrays(self.rig, self.result)}
