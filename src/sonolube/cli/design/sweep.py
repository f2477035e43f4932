"""Command `sweep`: a rig over any of its parameters, on a grid, in a list or drawn, or over one standard quantity."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from glob import escape
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
import typer

from sonolube import design
from sonolube.cli.console.answer import Answer, aligned, deliver, si
from sonolube.cli.console.backend import Backend, BackendName, gpu_warning
from sonolube.cli.console.options import (
    OUT,
    Amplitude,
    Changes,
    Json,
    RigPath,
    refuse_replaced,
    refuse_unused,
    with_amplitude,
)
from sonolube.cli.console.outputs import OutputFolder
from sonolube.cli.console.progress import progress
from sonolube.cli.console.ranges import ends_by_key, values_by_key
from sonolube.cli.console.rig_text import amplitude_object, amplitude_rows
from sonolube.cli.design.parametric_study import OUTCOMES, Parameter, parametric_study
from sonolube.cli.design.status_tables import status_tables
from sonolube.compilation import few_points
from sonolube.design import SweepPlan, grid_plan, latin_hypercube_plan, list_plan, sweep_figure, swept_variables
from sonolube.design.point_statistics import extreme_place, extreme_point, failure_counts, status_counts
from sonolube.errors import InvalidInput
from sonolube.files import expect_files
from sonolube.models.dynamics.backend import usable_backend
from sonolube.models.friction.models.range_check import ratio_caveats
from sonolube.report import Drawing, Page
from sonolube.rig import Rig, energy_balance, operating_caveats
from sonolube.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr


_CAPTIONS = {1: "Results of the rig over the key that was swept.", 2: "Friction over both keys that were swept."}
_CLOUD_CAPTION = (
    "Friction over each key that was swept, at all values of the others: points, at most 3000 of them, their median,"
    " and the interval of 90 %."
)
_LABELS = {"energy_balance": "energy"}
_OVER_ONLY = ("sample", "seed", "workers", "scheduler", "chunk", "backend")  # options without meaning for --of
_FILES = ("sweep.nc", "sweep.json", "sweep.html", "sweep.png", "sweep.svg sweep.pdf")
_OF_ONLY = ("lowest", "highest", "voltages")  # options without meaning for --over


class Sample(StrEnum):
    """Choice of the points of a sweep."""

    GRID = "grid"
    LHS = "lhs"
    LIST = "list"


@few_points()
def sweep(
    context: typer.Context,
    rig: RigPath,
    over: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=VALUES",
            help="A key of the file with its values: first:last:count, first:last:count:log or one,two,...;"
            " first:last alone for --sample lhs. May come again.",
        ),
    ] = None,
    of: Annotated[
        Parameter | None, typer.Option(help="One quantity over its usual range, with a figure of its own.")
    ] = None,
    lowest: Annotated[str | None, typer.Option("--from", metavar="QUANTITY", help="With --of: lowest value.")] = None,
    highest: Annotated[str | None, typer.Option("--to", metavar="QUANTITY", help="With --of: highest value.")] = None,
    points: Annotated[
        int | None, typer.Option(help="Number of points to draw for --sample lhs, or of values for --of.", min=1)
    ] = None,
    voltages: Annotated[
        list[str] | None,
        typer.Option(
            "--voltage", help="With --of speed or frequency: drive, peak to peak, of a curve. May come again."
        ),
    ] = None,
    sample: Annotated[
        Sample, typer.Option(help="Every value with every other, points drawn by Latin hypercube, or row by row.")
    ] = Sample.GRID,
    seed: Annotated[int, typer.Option(help="Of the points drawn.", min=0)] = 0,
    workers: Annotated[int, typer.Option(help="Threads, or processes of a local cluster.", min=1)] = 2,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Dask scheduler, or local for processes on this machine.")
    ] = None,
    chunk: Annotated[int, typer.Option(help="Points computed and kept together.", min=1)] = 100_000,
    backend: BackendName = Backend.CPU,
    amplitude: Amplitude = None,
    changes: Changes = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder for report, figures and data; out by default. With --over also for finished chunks, from which"
            " an interrupted run continues; then a folder of its own in out by default."
        ),
        OutputFolder(f"{' '.join(_FILES)} {{rig}}-{{of}}.*"),
    ] = None,
    json: Json = False,
) -> None:
    """Sweep: the rig over any of its parameters, or over one quantity; with a status for each point.

    Example: sonolube sweep examples/rigs/tribometer.toml --over drive.voltage_peak_to_peak=2V:28V:27
    """
    changes = with_amplitude(changes, amplitude)
    if (of is None) == (not over):
        raise InvalidInput("needs either --over, keys with their values, or --of, one quantity over its usual range")
    if of is not None:
        refuse_unused(context, *_OVER_ONLY, because="for --of")
        expect_files(out or OUT, (f"{escape(rig.stem)}-{of.value}.*",))
        study = parametric_study(
            rig, of=of.value, lowest=lowest, highest=highest, points=points, voltages=voltages, changes=changes
        )
        return deliver(study, folder=out or OUT, as_json=json)
    refuse_unused(context, *_OF_ONLY, because="for --over")
    refuse_replaced(changes, over)
    if sample is not Sample.LHS:
        refuse_unused(context, "seed", because=f"for --sample {sample}, which draws nothing; it is for lhs")
    if scheduler not in (None, "local"):
        refuse_unused(context, "workers", because="for a --scheduler at an address, which has its own")
    return _sweep_over(
        context,
        _plan(rig, over or [], sample, points, seed, changes),
        folder=out,
        json=json,
        backend=backend.value,
        options={"chunk_points": chunk, "workers": workers, "scheduler": scheduler},
    )


def _sweep_over(
    context: typer.Context,
    plan: SweepPlan,
    *,
    folder: Path | None,
    json: bool,
    backend: Literal["cpu", "gpu"],
    options: Mapping[str, Any],
) -> None:
    """Compute every point of a plan, in a folder of its own by default, and deliver the answer."""
    rig_file = context.params["rig"]
    with gpu_warning():
        chosen = usable_backend(backend)
    folder = folder or OUT / f"{rig_file.stem}-sweep-{plan.digest[:8]}{'-gpu' if chosen == 'gpu' else ''}"
    expect_files(folder, _FILES)
    with gpu_warning(), progress("sweeping") as advance:
        result = design.sweep(
            plan, folder=folder, advance=lambda done, total: advance("points", done, total), backend=chosen, **options
        )
    answer = SweepAnswer(plan=plan, rig_file=rig_file, result=result, data_file=folder / "sweep.nc", rig=plan.own_rig())
    deliver(answer, folder=folder, as_json=json, context=context)


@dataclass(frozen=True, kw_only=True)
class SweepAnswer(Answer):
    """Points of a sweep by status, reasons of those without a result, and the point of least friction."""

    plan: SweepPlan
    rig_file: Path
    result: "xr.Dataset"
    data_file: Path
    rig: Rig | None = None

    def lines(self) -> list[str]:
        """Number of points by status, failures, and the point of least friction."""
        result = self.result
        device = f", on {result.attrs['device']}" if "device" in result.attrs else ""
        least = [f"  {line}" for line in aligned(self._least_texts())]
        return [
            f"{result.attrs['rig']}, {result['friction_ratio'].size} points{device}",
            *aligned([*self._amplitude(), *((name, f"{count}") for name, count in status_counts(result).items())]),
            *[f"  without result: {count}: {reason}" for reason, count in self._failures().items()],
            *(["  least friction", *least] if least else []),
        ]

    def object(self) -> dict[str, Any]:
        """Number of points by status, failures, and the point of least friction."""
        result = self.result
        return {
            "rig": result.attrs["rig"],
            **({} if self.rig is None else amplitude_object(self.rig)),
            **({"device": str(result.attrs["device"])} if "device" in result.attrs else {}),
            "points": int(result["friction_ratio"].size),
            "statuses": status_counts(result),
            "without_result": [{"reason": reason, "points": count} for reason, count in self._failures().items()],
            "least_friction": self._least(),
        }

    def assumptions(self) -> Mapping[str, str]:
        """Assumptions of the rig file."""
        assumptions: Mapping[str, str] = self.plan.content.get("assumptions", {})
        return assumptions

    def caveats(self) -> Sequence[str]:
        """Caveats of the rig at its own operating point, and the meaning of ratios below 0 and above 1."""
        own = () if self.rig is None else operating_caveats(self.rig)
        return (*own, *ratio_caveats(friction_ratio=self.result["friction_ratio"].values))

    def figures(self) -> Mapping[str, Drawing]:
        """Friction over the keys that were swept."""
        listed = self.result["friction_ratio"].dims == ("point",)
        caption = _CLOUD_CAPTION if listed else _CAPTIONS.get(len(swept_variables(self.result)), _CLOUD_CAPTION)
        return {"sweep": Drawing(draw=lambda: sweep_figure(self.result), caption=caption)}

    def files(self) -> Mapping[str, Path]:
        """Dataset that the sweep itself has written."""
        return {self.data_file.name: self.data_file}

    def page(self) -> Page:
        """Page `sweep.html`."""
        source = str(self.plan.content.get("source", ""))
        points, failures = int(self.result["friction_ratio"].size), self._failures()
        return Page(
            name="sweep",
            title=self.result.attrs["title"],
            settings=[
                ("rig", f"{self.result.attrs['rig']} ({self.rig_file.name})"),
                *([("source of its numbers", source)] if source else []),
                *self._amplitude(),
            ],
            facts=[
                ("points", f"{points}, {points - sum(failures.values())} with a result"),
                *[(f"least friction: {name}", text) for name, text in self._least_texts()],
                ("fingerprint", self.plan.digest[:16]),
            ],
            tables=status_tables(self.result, failures),
        )

    def _amplitude(self) -> list[tuple[str, str]]:
        """Source of the amplitude at the rig's own operating point."""
        return [] if self.rig is None else amplitude_rows(self.rig)

    def _failures(self) -> dict[str, int]:
        """Number of points without a result, by the reason."""
        return failure_counts(self.result, outcome="friction_ratio")

    def _least(self) -> dict[str, Any]:
        """Values of the swept keys and outcomes at the point of least friction; empty where no point has a result."""
        place = extreme_place(self.result, outcome="friction_ratio")
        point = extreme_point(self.result[list(OUTCOMES)], outcome="friction_ratio")
        if place is None or point is None:
            return {}
        swept = {key: values[0].item() for key, values in self.plan.rows(place, place + 1).items()}
        powers = {name: float(point[name]) for name in ("actuator_power", "dissipated_power")}
        balance = energy_balance(**powers)
        return (
            swept
            | si({name: float(point[name]) for name in OUTCOMES if np.isfinite(point[name])})
            | ({} if balance is None else {"energy_balance": balance})
        )

    def _least_texts(self) -> list[tuple[str, str]]:
        """The same as text."""
        return [(_LABELS.get(name, name), _as_text(name, value)) for name, value in self._least().items()]


def _as_text(name: str, value: Any) -> str:
    """Value of a swept key, or of an outcome, with its unit."""
    if isinstance(value, dict):
        return format_quantity(value["value"], name)
    return value if isinstance(value, str) else format_quantity(value, name.rpartition(".")[2])


def _plan(
    rig: Path, over: list[str], sample: Sample, points: int | None, seed: int, changes: list[str] | None
) -> SweepPlan:
    """Points of a sweep on a grid, in a list, or drawn by Latin hypercube."""
    if sample is Sample.LHS:
        if points is None:
            raise InvalidInput("--sample lhs needs --points, how many to draw")
        return latin_hypercube_plan(rig, over=ends_by_key(over), points=points, seed=seed, changes=changes or ())
    if points is not None:
        raise InvalidInput(f"--points has no meaning for --sample {sample}; it is for lhs, and for --of")
    return (grid_plan if sample is Sample.GRID else list_plan)(rig, over=values_by_key(over), changes=changes or ())
