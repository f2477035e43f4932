"""Answer of the task `optimise`: best designs, Pareto front, amplifier, matching networks and a rig file."""

from collections.abc import Mapping, Sequence
from typing import Any

import tomli_w

from sonolube.design.optimisation import OWN_ACTUATOR, DriveElectronics, Optimum, design_text, figures
from sonolube.design.optimisation.designs_dataset import design_counts, designs_dataset
from sonolube.report import Drawing, Page, PageTable
from sonolube.report.results.design import optimum as results
from sonolube.report.results.design.status_tables import count_table
from sonolube.report.results.rig_text import operating_point, rig_settings
from sonolube.rig import Rig, read_rig
from sonolube.storage.input_files import input_text
from sonolube.tasks.answer import Answer, Block, Dataset, Rows, Table, answer


@answer
class OptimisationAnswer(Answer):
    """Best designs and front of an optimisation, with the amplifier and the networks of the best."""

    rig: Rig
    optimum: Optimum
    electric: DriveElectronics

    def blocks(self) -> Sequence[Block]:
        """Best design, table of all, and actuators that were not used."""
        return [
            operating_point(self._space.rig),
            Rows(results.facts(self.optimum, self.electric)),
            Table(*results.designs_table(self.optimum)),
            *[f"  not used: {reason}" for reason in self.optimum.screening.refused.values()],
        ]

    def object(self) -> dict[str, Any]:
        """Best designs, front, number of designs, amplifier and networks."""
        return results.optimum_object(self.optimum, self.electric)

    def caveats(self) -> Sequence[str]:
        """Values at the end of their range, heat beyond the amplifier's power, and a preload that is not given."""
        return results.optimum_caveats(self.optimum)

    def assumptions(self) -> Mapping[str, str]:
        """Quality factor and loss tangent of the ceramics, and the assumptions of the rig file."""
        assumed = {}
        if any(point.candidate.actuator != OWN_ACTUATOR for point in self.optimum.designs):
            factor = self._space.mechanical_quality_factor
            assumed["quality factor"] = f"{factor:g} for the catalogue's ceramics; no sheet has it"
        loss = self.optimum.problem.limits.loss_tangent
        return assumed | {"loss tangent": f"{loss:g} for the ceramic, in its heat"} | dict(self._space.rig.assumptions)

    def figures(self) -> Mapping[str, Drawing]:
        """Objective over frequency, front, limits used, and power factor."""
        optimum, name = self.optimum, self._name
        drawings = {
            f"{name}-frequency": Drawing(
                chart=lambda: figures.frequency_chart(optimum),
                caption=f"Least {optimum.minimise} for the target at each frequency, over all structures of the"
                " screening; markers are the refined designs.",
            )
        }
        if optimum.front:
            drawings[f"{name}-front"] = Drawing(
                chart=lambda: figures.front_chart(optimum),
                caption=f"Pareto front of {optimum.minimise} and {optimum.second_objective} within the limits.",
            )
        if results.tightest_limit(optimum.best) != results.NO_LIMIT:
            drawings[f"{name}-limits"] = Drawing(
                chart=lambda: figures.limits_chart(optimum.best),
                caption="Fraction of each limit, set or of the actuator, that the best design uses.",
            )
        drawings[f"{name}-power-factor"] = Drawing(
            chart=lambda: figures.power_factor_chart(optimum, self.electric),
            caption="Power factor at the amplifier about the drive's frequency (vertical line).",
        )
        return drawings

    def files(self) -> "Mapping[str, str | Dataset]":
        """All designs as netCDF, and the best as a rig file."""
        content = self.rig.content()
        file = self.rig.file
        is_unchanged = file is not None and read_rig(file).content() == content
        source = input_text(file) if file is not None and is_unchanged else tomli_w.dumps(content)
        return {
            f"{self._name}.nc": designs_dataset(self.optimum),
            f"{self._name}.toml": design_text(source, content, self.optimum.problem, self.optimum.best),
        }

    def page(self) -> Page:
        """Page `optimise.html`."""
        optimum, rig = self.optimum, self._space.rig
        counts, total = design_counts(optimum), optimum.screening.frequency.size
        heads, rows = results.designs_table(optimum)
        refused = [("not used", reason) for reason in optimum.screening.refused.values()]
        return Page(
            name="optimise",
            title=f"Least {optimum.minimise} for a friction ratio of {optimum.problem.friction_ratio:.3g}: {rig.title}",
            settings=rig_settings(rig),
            facts=[*results.facts(optimum, self.electric), *refused],
            tables=[
                PageTable(title="Designs, the best first", heads=tuple(heads), rows=tuple(rows)),
                count_table("Screened designs by status", "designs", counts, total=total),
            ],
        )

    @property
    def _space(self) -> Any:
        """Design space of the problem."""
        return self.optimum.problem.space

    @property
    def _name(self) -> str:
        """Name of the files, without ending."""
        return f"{self.rig.name}-optimum"
