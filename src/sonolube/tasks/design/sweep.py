"""Task `sweep`: a rig over any of its parameters, on a grid, in a list or drawn, or over one standard quantity."""

from collections.abc import Mapping, Sequence
from glob import escape
from pathlib import Path
from typing import Annotated, Any, Literal, Unpack

from sonolube import design, rig as rigs
from sonolube.design import SweepPlan, grid_plan, latin_hypercube_plan, list_plan, sweep_chart, swept_variables
from sonolube.errors import InvalidInput
from sonolube.models.dynamics.backend import usable_backend
from sonolube.models.friction.models.range_check import ratio_caveats
from sonolube.report import Drawing, Page
from sonolube.report.results.design import sweep as results
from sonolube.storage.files import expect_files
from sonolube.tasks.answer import Answer, Block, Dataset, answer
from sonolube.tasks.design.parametric_study import ParametricStudyAnswer, parametric_study
from sonolube.tasks.parameters import Backend, Keep, KeyValues, Parameter, RigFile, Watched, kept, rig_of
from sonolube.tasks.progress import stage
from sonolube.tasks.ranges import Values, ends_by_key, refuse_replaced, values_by_key
from sonolube.tasks.task import refuse_unused, shown, task

_OVER = KeyValues(
    "A key of the file with its values: first:last:count, first:last:count:log or one,two,...;"
    " first:last alone for the sample lhs. May come again.",
    "KEY=VALUES",
)
_CAPTIONS = {1: "Results of the rig over the key that was swept.", 2: "Friction over both keys that were swept."}
_CLOUD_CAPTION = (
    "Friction over each key that was swept, at all values of the others: points, at most 3000 of them, their median,"
    " and the interval of 90 %."
)
# arguments without meaning for one quantity
_OVER_ONLY = ("sample", "seed", "workers", "scheduler", "chunk", "backend")
_FILES = ("sweep.nc", "sweep.json", "sweep.html", "sweep.png", "sweep.svg", "sweep.pdf")
_OF_ONLY = ("lowest", "highest", "voltage", "vibration")  # arguments without meaning for keys


@task
def sweep(
    rig: RigFile,
    *,
    over: Annotated[Values | None, _OVER] = None,
    of: Annotated[
        Literal["voltage", "amplitude", "speed", "frequency", "power", "waveform", "load"] | None,
        Parameter("One quantity over its usual range, with a figure of its own."),
    ] = None,
    lowest: Annotated[str | None, Parameter("With of: lowest value.", "QUANTITY", option="--from")] = None,
    highest: Annotated[str | None, Parameter("With of: highest value.", "QUANTITY", option="--to")] = None,
    points: Annotated[
        int | None, Parameter("Number of points to draw for the sample lhs, or of values of one quantity.", lowest=1)
    ] = None,
    voltage: Annotated[
        Sequence[str], Parameter("With of speed or frequency: drive, peak to peak, of a curve. May come again.")
    ] = (),
    vibration: Annotated[
        Sequence[str],
        Parameter("With of speed: amplitude of a curve, of a rig without a voltage. May come again.", "LENGTH"),
    ] = (),
    sample: Annotated[
        Literal["grid", "lhs", "list"],
        Parameter("Every value with every other, points drawn by Latin hypercube, or row by row."),
    ] = "grid",
    seed: Annotated[int, Parameter("Of the points drawn.", lowest=0)] = 0,
    workers: Annotated[int, Parameter("Threads, or processes of a local cluster.", lowest=1)] = 2,
    scheduler: Annotated[
        str | None, Parameter("Dask scheduler, or local for processes on this machine.", "ADDRESS")
    ] = None,
    chunk: Annotated[int, Parameter("Points computed and kept together.", lowest=1)] = 100_000,
    backend: Backend = "cpu",
    keep: Keep = None,
    **watch: Unpack[Watched],
) -> "SweepAnswer | ParametricStudyAnswer":
    """Sweep: the rig over any of its parameters, or over one quantity; with a status for each point.

    Example: sonolube sweep examples/rigs/tribometer.toml --over drive.voltage_peak_to_peak=2V:28V:27

    Examples
    --------
    >>> import sonolube as sl
    >>> answer = sl.sweep("examples/rigs/tribometer.toml", over={"drive.voltage_peak_to_peak": "14V:28V:2"})
    >>> answer["friction_ratio"].values.round(2).tolist()
    [0.66, 0.35]
    """
    known = rig_of(rig)
    if (of is None) == (not over):
        raise InvalidInput(
            f"needs either {shown('over')}, keys with their values, or {shown('of')}, one quantity over its usual range"
        )
    if of is not None:
        refuse_unused(*_OVER_ONLY, because=f"for {shown('of')}")
        if (place := kept(keep, "")) is not None:
            expect_files(place, (f"{escape(known.name)}-{of}.*",))
        return parametric_study(
            known, of=of, lowest=lowest, highest=highest, points=points, voltages=voltage, amplitudes=vibration
        )
    refuse_unused(*_OF_ONLY, because=f"for {shown('over')}")
    refuse_replaced(known, over or {})
    if sample != "lhs":
        refuse_unused("seed", because=f"for {shown('sample')} {sample}, which draws nothing; it is for lhs")
    if scheduler not in (None, "local"):
        refuse_unused("workers", because=f"for a {shown('scheduler')} at an address, which has its own")
    plan = _plan(known, over or {}, sample, points, seed)
    chosen = usable_backend(backend)
    folder = kept(keep, f"{known.name}-sweep-{plan.digest[:8]}{'-gpu' if chosen == 'gpu' else ''}")
    if folder is not None:
        expect_files(folder, _FILES)
    with stage("sweeping") as advance:
        result = design.sweep(
            plan,
            folder=folder,
            advance=lambda done, total: advance("points", done, total),
            backend=chosen,
            chunk_points=chunk,
            workers=workers,
            scheduler=scheduler,
        )
    return SweepAnswer(rig=known, plan=plan, result=result, folder=folder)


@answer
class SweepAnswer(Answer):
    """Points of a sweep by status, reasons of those without a result, and the point of least friction."""

    rig: rigs.Rig
    plan: SweepPlan
    result: Dataset
    folder: Path | None

    def blocks(self) -> Sequence[Block]:
        """Number of points by status, failures, and the point of least friction."""
        return results.sweep_blocks(self.rig, self.plan, self.result)

    def object(self) -> dict[str, Any]:
        """Number of points by status, failures, and the point of least friction."""
        return results.sweep_object(self.rig, self.plan, self.result)

    def caveats(self) -> Sequence[str]:
        """Caveats of the rig at its own operating point, and the meaning of ratios below 0 and above 1."""
        return (*rigs.operating_caveats(self.rig), *ratio_caveats(friction_ratio=self.result["friction_ratio"].values))

    def figures(self) -> Mapping[str, Drawing]:
        """Friction over the keys that were swept."""
        listed = self.result["friction_ratio"].dims == ("point",)
        caption = _CLOUD_CAPTION if listed else _CAPTIONS.get(len(swept_variables(self.result)), _CLOUD_CAPTION)
        return {"sweep": Drawing(chart=lambda: sweep_chart(self.result), caption=caption)}

    def files(self) -> "Mapping[str, Path | Dataset]":
        """Dataset, which the sweep itself has written where there is a folder."""
        return {"sweep.nc": self.result if self.folder is None else self.folder / "sweep.nc"}

    def page(self) -> Page:
        """Page `sweep.html`."""
        return results.sweep_page(self.rig, self.plan, self.result)


def _plan(rig: rigs.Rig, over: Values, sample: str, points: int | None, seed: int) -> SweepPlan:
    """Points of a sweep on a grid, in a list, or drawn by Latin hypercube."""
    if sample == "lhs":
        if points is None:
            raise InvalidInput(f"{shown('sample')} lhs needs {shown('points')}, how many to draw")
        return latin_hypercube_plan(rig, over=ends_by_key(over), points=points, seed=seed)
    if points is not None:
        raise InvalidInput(
            f"{shown('points')} has no meaning for {shown('sample')} {sample}; it is for lhs, and for {shown('of')}"
        )
    return (grid_plan if sample == "grid" else list_plan)(rig, over=values_by_key(over))
