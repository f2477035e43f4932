"""Task `efficiency`: efficiency line of a rig from measured runs, and the power that a friction force requires."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Unpack

from sonolube.design.efficiency import EfficiencyCalibration, calibrate_efficiency, efficiency_chart, efficiency_dataset
from sonolube.report import Drawing, Page
from sonolube.report.results.design import friction_map as results
from sonolube.report.results.record_object import rig_settings
from sonolube.rig import Rig
from sonolube.tasks.answer import Answer, Block, Dataset, Rows, answer
from sonolube.tasks.design.control import friction_force
from sonolube.tasks.own_tables import MappedRuns, required_runs
from sonolube.tasks.parameters import (
    File,
    Number,
    OwnRuns,
    Parameter,
    Quantity,
    RigChanges,
    RigParameter,
    RigSource,
    file_stem,
    rig_of,
)
from sonolube.tasks.task import in_si, refuse_unused, shown, task

_CAPTION = (
    "Efficiency coefficient (equation 4.1 of the dissertation) of {runs} runs over sliding speed, with the line of"
    " least squares, the band of the"
    " line and that of one more run."
)


@task
def efficiency(
    runs: Annotated[OwnRuns, File("Measured runs, a row each.", "RUNS.csv")],
    *,
    rig: Annotated[RigSource, RigParameter(without=("load", "amplitude"))],
    mapping: MappedRuns = None,
    target_friction: Annotated[
        str | float | None,
        Parameter("Target, a coefficient or a force, such as 0.1 or 0.5N, for its power.", "FRICTION"),
    ] = None,
    speed: Annotated[Number | None, Quantity("Sliding speed of that target.", "m/s")] = None,
    level: Annotated[float, Parameter("Confidence level.", lowest=0.5, highest=0.9999)] = 0.95,
    **entries: Unpack[RigChanges],
) -> "EfficiencyAnswer":
    """Efficiency line from measured runs by the dissertation's section 4.1, and the power that a friction takes.

    Example: sonolube efficiency examples/efficiency-runs.csv --rig examples/rigs/power_map.toml

    Examples
    --------
    >>> import sonolube as sl
    >>> answer = sl.efficiency("examples/efficiency-runs.csv", rig="examples/rigs/power_map.toml")
    >>> line = answer["efficiency_coefficient"]
    >>> round(1e9 * float(line.interp(sliding_speed=0.1)), 2)  # mW mm2/(N W) at 100 mm/s
    0.38
    """
    if target_friction is None:
        refuse_unused("speed", because=f"without {shown('target_friction')}, whose power is at this speed")
    known = rig_of(rig)
    target = None
    if target_friction is not None:
        target = friction_force("target_friction", target_friction, normal_load=known.normal_load)
    calibration = calibrate_efficiency(
        known,
        required_runs(runs, mapping, known),
        friction_force=target,
        sliding_speed=in_si("speed", speed),
        confidence_level=level,
    )
    return EfficiencyAnswer(rig=known, calibration=calibration, name=f"{file_stem(runs)}-efficiency")


@answer
class EfficiencyAnswer(Answer):
    """Efficiency line of a rig with its uncertainty, and the power for a target of the friction."""

    rig: Rig
    calibration: EfficiencyCalibration
    name: str

    def blocks(self) -> Sequence[Block]:
        """Line, scatter and range of the runs, and the power."""
        return [f"{self.rig.title}, {self.calibration.fit.runs} runs", Rows(results.facts(self.calibration))]

    def object(self) -> dict[str, Any]:
        """Slope and intercept with their uncertainties, range of speeds, and the power with its interval."""
        return {"rig": self.rig.title, **results.efficiency_object(self.calibration)}

    def caveats(self) -> Sequence[str]:
        """Runs that were left out, and those whose power was more than the friction needed."""
        saturated = self.calibration.saturated_runs
        if not saturated:
            return self.calibration.caveats
        return (
            *self.calibration.caveats,
            f"{saturated} runs left less than a tenth of the friction: power beyond what is needed makes the line low",
        )

    def figures(self) -> Mapping[str, Drawing]:
        """Coefficients of the runs over speed, the line and its bands."""
        caption = _CAPTION.format(runs=self.calibration.fit.runs)
        return {self.name: Drawing(chart=lambda: efficiency_chart(self.calibration), caption=caption)}

    def files(self) -> Mapping[str, Dataset]:
        """Line and bands as netCDF."""
        return {f"{self.name}.nc": efficiency_dataset(self.calibration)}

    def page(self) -> Page:
        """Page `efficiency.html`."""
        return Page(
            name="efficiency",
            title=f"Efficiency line: {self.rig.title}",
            settings=rig_settings(self.rig),
            facts=results.facts(self.calibration),
        )
