"""Task `transient`: start-up of a rig from rest by time integration."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Unpack

from sonolube import rig as rigs
from sonolube.report import Drawing
from sonolube.rig.datasets import LabelledArrays
from sonolube.rig.figures import start_up_chart
from sonolube.rig.resolved_rig import resolved_rig
from sonolube.rig.result_datasets import start_up_arrays
from sonolube.tasks.answer import Answer, Block, Rows, answer, si
from sonolube.tasks.parameters import Number, Quantity, RigFile, Watched, rig_of
from sonolube.tasks.progress import stage
from sonolube.tasks.task import in_si, task
from sonolube.text.units import format_si

_QUANTITIES = ("settling_time", "vibration_amplitude", "mean_displacement", "beat_frequency")


@task
def transient(
    rig: RigFile,
    *,
    duration: Annotated[Number, Quantity("Time that is integrated.", "s")] = "0.1s",
    **watch: Unpack[Watched],
) -> "StartUpAnswer":
    """Start-up from rest: settling of the tip's vibration, step by step.

    Example: sonolube transient examples/rigs/tribometer.toml --duration 0.06s

    Examples
    --------
    >>> import sonolube as sl
    >>> from sonolube.text.units import format_si
    >>> answer = sl.transient("examples/rigs/tribometer.toml", duration="20ms")
    >>> format_si(answer.object()["settling_time"]["value"], "s", digits=2)
    '1.2 ms'
    """
    known = rig_of(rig)
    with stage("marching"):
        resolved = resolved_rig(known)
        result = rigs.start_up(resolved, duration=in_si("duration", duration))
    return StartUpAnswer(rig=known, vibration=resolved.vibration, result=result)


@answer
class StartUpAnswer(Answer):
    """Start-up of a rig: settling time, final amplitude and slow oscillation."""

    rig: rigs.Rig
    vibration: rigs.ResolvedVibration
    result: rigs.StartUp

    def blocks(self) -> Sequence[Block]:
        """Settling time, amplitude, mean displacement, slow oscillation and status."""
        found = self.result
        rows = [
            ("amplitude settles", f"within 2 % after {format_si(found.settling_time, 's')}"),
            ("amplitude", f"{format_si(found.vibration_amplitude, 'm')}: {self.vibration.text}"),
            ("mean displacement", format_si(found.mean_displacement, "m")),
            ("slow oscillation", format_si(found.beat_frequency, "Hz")),
            ("status", found.status + (f": {found.reason}" if found.reason else "")),
        ]
        return [f"{self.rig.title}, {format_si(self.rig.normal_load, 'N')}, from rest", Rows(rows)]

    def object(self) -> dict[str, Any]:
        """Status, settling time, amplitude, mean displacement and frequency of the slow oscillation."""
        return {
            "rig": self.rig.title,
            "amplitude_source": self.vibration.source,
            "status": self.result.status,
            "reason": self.result.reason,
            **si({name: getattr(self.result, name) for name in _QUANTITIES}),
        }

    def figures(self) -> Mapping[str, Drawing]:
        """Displacement of the tip over time."""
        return {f"{self.rig.name}-transient": Drawing(chart=lambda: start_up_chart(self.rig, self.result))}

    def files(self) -> Mapping[str, LabelledArrays]:
        """Trajectory as netCDF."""
        return {f"{self.rig.name}-transient.nc": start_up_arrays(self.rig, self.result)}
