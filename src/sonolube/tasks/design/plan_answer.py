"""Answer of `plan`: points and replicates as text, table and protocols as files, a sheet to print as the page."""

from collections.abc import Mapping, Sequence
from typing import Any

from sonolube.design.test_plan.figure import plan_chart
from sonolube.design.test_plan.plan import TestPlan
from sonolube.design.test_plan.run_protocols import run_protocols
from sonolube.design.test_plan.run_table import has_results, run_table
from sonolube.facts.protocol import Protocol, protocol_text
from sonolube.report import Drawing, Page, PageTable
from sonolube.report.pin_on_disc_sheet import pin_on_disc_checklist
from sonolube.report.results.design import plan_of_tests as results
from sonolube.rig import Rig
from sonolube.tasks.answer import Answer, Block, Rows, Table, answer

_CAPTION = (
    "Left: candidates over speed and amplitude, coloured by the information that the replicates at one of them are"
    " expected to give about which friction model holds; the points of the plan are numbered, the rig's own first, the"
    " others in the order of their gain."
    " Right: predicted friction ratio at these points with its interval of 80 %, and the median of each model."
)


@answer
class PlanAnswer(Answer):
    """Plan of tests in words, a table of its runs, their protocols, a figure and a sheet to print."""

    rig: Rig
    plan: TestPlan

    def blocks(self) -> Sequence[Block]:
        """Difference to be shown, its power, and the points of the plan."""
        return [
            f"{self.rig.title}: {results.size_text(self.plan)}",
            Rows(results.facts(self.plan)),
            Table(results.POINT_HEADS, results.point_rows(self.plan)),
        ]

    def object(self) -> dict[str, Any]:
        """Question, scatter, replicates, points and runs."""
        return results.plan_object(self.rig, self.plan)

    def caveats(self) -> Sequence[str]:
        """Caveats of the plan."""
        return self.plan.caveats

    def figures(self) -> Mapping[str, Drawing]:
        """Candidates with their information, and the prediction at the points."""
        return {self._name: Drawing(chart=lambda: plan_chart(self.plan), caption=_CAPTION)}

    def files(self) -> Mapping[str, str]:
        """Table of the runs to be filled, and the protocol of each."""
        return {
            f"{self._name}-runs.csv": run_table(self.plan),
            **{f"{self._name}/{name}.toml": protocol_text(each) for name, each in self._protocols().items()},
        }

    def page(self) -> Page:
        """Sheet to print: points, runs with empty cells, what to report, limits."""
        plan, limits = self.plan, next(iter(self._protocols().values())).limits
        known = results.known_items(self.rig, plan)
        heads = tuple(map(str.capitalize, results.POINT_HEADS))
        facts = [(name.capitalize(), text) for name, text in results.facts(self.plan)]
        return Page(
            name=self._name,
            title=f"Test plan: {self.rig.title}",
            settings=(("Rig", self.rig.title), ("Source", self.rig.source)),
            facts=[("Plan", results.size_text(self.plan)), *facts],
            tables=(
                PageTable(title="Points", heads=heads, rows=tuple(map(tuple, results.point_rows(plan)))),
                PageTable(title="Runs in their order", heads=results.RUN_HEADS, rows=tuple(results.run_rows(plan))),
                PageTable(title="Limits", heads=("Limit", "Value"), rows=tuple(results.limit_rows(plan, limits))),
                PageTable(
                    title="To be reported, in the order of ASTM G99",
                    heads=("Part", "Item", "Value"),
                    rows=tuple(pin_on_disc_checklist(known)),
                ),
            ),
        )

    def keeps(self, name: str, present: str) -> bool:
        """Whether a table of runs holds results, which a new plan would lose."""
        return name.endswith("-runs.csv") and has_results(present)

    @property
    def _name(self) -> str:
        return f"{self.rig.name}-plan"

    def _protocols(self) -> dict[str, Protocol]:
        """Protocol of each run by its name."""
        return run_protocols(self.plan)
