"""Answer of `control`: controller, margins, step response and energy, with figures, C source and lookup table."""

from collections.abc import Mapping, Sequence
from typing import Any

from sonolube.design import control as loops
from sonolube.design.control import figures
from sonolube.design.control.run_results import control_dataset
from sonolube.design.control.stick_slip import StickSlipSuppression
from sonolube.report import Drawing, Page
from sonolube.report.results.design import control_design as results
from sonolube.report.results.rig_text import amplitude_rows, operating_point, rig_settings
from sonolube.rig import Rig
from sonolube.tasks.answer import Answer, Block, Dataset, Rows, answer


@answer
class ControlAnswer(Answer):
    """A tuned controller with its margins, step response and energy, and stick-slip where it was computed."""

    rig: Rig
    settings: loops.ControlSettings
    study: loops.ControlDesign
    suppression: StickSlipSuppression | None
    assumed: Mapping[str, str]

    def blocks(self) -> Sequence[Block]:
        """Operating point, controller, margins, step response and energy."""
        return [
            operating_point(self.rig),
            Rows([*amplitude_rows(self.rig), *results.facts(self.settings, self.study, self.suppression)]),
        ]

    def object(self) -> dict[str, Any]:
        """Controller, margins, step response, energy and stick-slip."""
        return results.control_object(self.rig, self.settings, self.study, self.suppression)

    def caveats(self) -> Sequence[str]:
        """Those of the rig at its own operating point, a thin gain margin, and a resonance that tracking has lost."""
        return results.caveats(self.rig, self.study)

    def assumptions(self) -> Mapping[str, str]:
        """Assumptions of the rig file, of the resonance and of the holder."""
        assumptions = {**self.rig.assumptions, **self.assumed}
        if self.suppression is not None:
            assumptions["stick-slip"] = results.holder_text()
        return assumptions

    def figures(self) -> Mapping[str, Drawing]:
        """Run in closed loop, design of the loop, and stick-slip where it was computed."""
        study, suppression = self.study, self.suppression
        drawings = {
            self._name: Drawing(
                chart=lambda: figures.closed_loop_chart(study),
                caption=f"Friction of {self.rig.title} in closed loop; every point computed.",
            ),
            f"{self._name}-design": Drawing(
                chart=lambda: figures.control_design_chart(study),
                caption=f"Map from {study.plant.quantity.word} to friction of the controller, and magnitude of the"
                " sensitivity function.",
            ),
        }
        if suppression is not None:
            drawings[f"{self._name}-stick-slip"] = Drawing(
                chart=lambda: figures.stick_slip_chart(suppression),
                caption="Force in the holder of the slider as the counterface drags it along.",
            )
        return drawings

    def files(self) -> "Mapping[str, str | Dataset]":
        """Run as netCDF, controller as C source, and its lookup table."""
        controller, title = self.study.controller, self.rig.title
        return {
            f"{self._name}.nc": control_dataset(self.study, title=f"Friction control of {title}"),
            f"{self._name}.c": loops.controller_source(controller, self.study.tracker, title=title),
            f"{self._name}.csv": loops.lookup_table(controller),
        }

    def page(self) -> Page:
        """Page `control.html`."""
        return Page(
            name="control",
            title=f"Friction control of {self.rig.title}",
            settings=rig_settings(self.rig),
            facts=results.facts(self.settings, self.study, self.suppression),
            tables=[results.lookup_table(self.study)],
        )

    @property
    def _name(self) -> str:
        """Name of the files, without ending."""
        return f"{self.rig.name}-control"
