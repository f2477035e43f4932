"""Answer of `lab hold`: friction held at each speed, beside the margins of the controller."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from sonolube.design.control import ControlDesign
from sonolube.laboratory import closed_loop
from sonolube.laboratory.records import Run
from sonolube.report import Drawing
from sonolube.report.results import held_friction as results
from sonolube.report.results.ended_run import SIMULATED
from sonolube.rig import Rig
from sonolube.tasks.answer import Answer, Block, Dataset, answer
from sonolube.text.units import format_si


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
    held: closed_loop.HeldFriction
    run: Run
    simulated: bool
    assumed: Mapping[str, str]
    folder: Path

    def blocks(self) -> Sequence[Block]:
        """Reference, margins by the design, friction held at each speed, and the record."""
        return results.held_blocks(self.rig, self.held, self.design, self.run, simulated=self.simulated)

    def object(self) -> dict[str, Any]:
        """Reference, controller, margins, what was held at each speed, and the record."""
        return results.held_object(self.rig, self.held, self.design, self.run, simulated=self.simulated)

    def caveats(self) -> Sequence[str]:
        """Caveats of the record, speeds at which the reference was out of reach, and a mark of simulated runs."""
        told = (*self.run.caveats, *results.saturation_lines(self.held))
        return (*told, SIMULATED) if self.simulated else told

    def assumptions(self) -> Mapping[str, str]:
        """Assumptions of the rig file and of the resonance."""
        return {**self.rig.assumptions, **self.assumed}

    def figures(self) -> Mapping[str, Drawing]:
        """Friction with its reference, voltage and speed over time."""
        held, simulated = self.held, self.simulated
        if not held.time.size:
            return {}
        caption = f"Friction held at {format_si(held.hold.friction_force, 'N')} by the drive voltage."
        return {
            "held-friction": Drawing(
                chart=lambda: closed_loop.held_friction_chart(held, simulated=simulated), caption=caption
            )
        }

    def files(self) -> Mapping[str, Dataset]:
        """Intervals of the controller as netCDF."""
        if not self.held.time.size:
            return {}
        return {
            "held-friction.nc": closed_loop.held_friction_dataset(self.held, title=f"Friction held on {self.rig.title}")
        }

    @property
    def is_failure(self) -> bool:
        """Whether the loop ended before its time."""
        return self.held.outcome != "completed"
