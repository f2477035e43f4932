"""Task `sweep`: a rig over any of its parameters, on a grid, in a list or drawn, or over one standard quantity."""

from collections.abc import Mapping, Sequence
from glob import escape
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np

from sonolube import design
from sonolube.design import SweepPlan, grid_plan, latin_hypercube_plan, list_plan, sweep_chart, swept_variables
from sonolube.design.point_statistics import extreme_place, extreme_point, failure_counts, status_counts
from sonolube.errors import InvalidInput
from sonolube.files import expect_files
from sonolube.models.dynamics.backend import usable_backend
from sonolube.models.friction.models.range_check import ratio_caveats
from sonolube.report import Drawing, Page
from sonolube.rig import Rig, energy_balance, operating_caveats
from sonolube.tasks.answer import Answer, answer, si
from sonolube.tasks.blocks import Block, Rows
from sonolube.tasks.design.parametric_study import OUTCOMES, ParametricStudyAnswer, parametric_study
from sonolube.tasks.parameters import Backend, Keep, Parameter, RigFile, Stop, Watch, kept, rig_of
from sonolube.tasks.progress import stage
from sonolube.tasks.ranges import Values, ends_by_key, refuse_replaced, values_by_key
from sonolube.tasks.results.rig_text import amplitude_object, amplitude_rows
from sonolube.tasks.results.status_tables import status_tables
from sonolube.tasks.task import refuse_unused, shown, task
from sonolube.units import format_quantity

if TYPE_CHECKING:
    import xarray as xr


_OVER = Parameter(
    help="A key of the file with its values: first:last:count, first:last:count:log or one,two,...;"
    " first:last alone for the sample lhs. May come again.",
    kind="KEY=VALUES",
    is_mapping=True,
)
_CAPTIONS = {1: "Results of the rig over the key that was swept.", 2: "Friction over both keys that were swept."}
_CLOUD_CAPTION = (
    "Friction over each key that was swept, at all values of the others: points, at most 3000 of them, their median,"
    " and the interval of 90 %."
)
_LABELS = {"energy_balance": "energy"}
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
        Parameter(help="One quantity over its usual range, with a figure of its own."),
    ] = None,
    lowest: Annotated[str | None, Parameter(help="With of: lowest value.", kind="QUANTITY", option="--from")] = None,
    highest: Annotated[str | None, Parameter(help="With of: highest value.", kind="QUANTITY", option="--to")] = None,
    points: Annotated[
        int | None,
        Parameter(help="Number of points to draw for the sample lhs, or of values of one quantity.", lowest=1),
    ] = None,
    voltage: Annotated[
        Sequence[str], Parameter(help="With of speed or frequency: drive, peak to peak, of a curve. May come again.")
    ] = (),
    vibration: Annotated[
        Sequence[str],
        Parameter(
            help="With of speed: amplitude of a curve, of a rig without a voltage. May come again.", kind="LENGTH"
        ),
    ] = (),
    sample: Annotated[
        Literal["grid", "lhs", "list"],
        Parameter(help="Every value with every other, points drawn by Latin hypercube, or row by row."),
    ] = "grid",
    seed: Annotated[int, Parameter(help="Of the points drawn.", lowest=0)] = 0,
    workers: Annotated[int, Parameter(help="Threads, or processes of a local cluster.", lowest=1)] = 2,
    scheduler: Annotated[
        str | None, Parameter(help="Dask scheduler, or local for processes on this machine.", kind="ADDRESS")
    ] = None,
    chunk: Annotated[int, Parameter(help="Points computed and kept together.", lowest=1)] = 100_000,
    backend: Backend = "cpu",
    keep: Keep = None,
    progress: Watch = None,
    cancelled: Stop = None,
) -> "SweepAnswer | ParametricStudyAnswer":
    """Sweep: the rig over any of its parameters, or over one quantity; with a status for each point.

    Example: sonolube sweep examples/rigs/tribometer.toml --over drive.voltage_peak_to_peak=2V:28V:27
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

    rig: Rig
    plan: SweepPlan
    result: "xr.Dataset"
    folder: Path | None

    def blocks(self) -> Sequence[Block]:
        """Number of points by status, failures, and the point of least friction."""
        result = self.result
        device = f", on {result.attrs['device']}" if "device" in result.attrs else ""
        least = self._least_texts()
        return [
            f"{result.attrs['rig']}, {result['friction_ratio'].size} points{device}",
            Rows([*self._amplitude(), *((name, f"{count}") for name, count in status_counts(result).items())]),
            *[f"  without result: {count}: {reason}" for reason, count in self._failures().items()],
            *(("least friction", Rows(least)) if least else ()),
        ]

    def object(self) -> dict[str, Any]:
        """Number of points by status, failures, and the point of least friction."""
        result = self.result
        return {
            "rig": result.attrs["rig"],
            **amplitude_object(self.rig),
            **({"device": str(result.attrs["device"])} if "device" in result.attrs else {}),
            "points": int(result["friction_ratio"].size),
            "statuses": status_counts(result),
            "without_result": [{"reason": reason, "points": count} for reason, count in self._failures().items()],
            "least_friction": self._least(),
        }

    def caveats(self) -> Sequence[str]:
        """Caveats of the rig at its own operating point, and the meaning of ratios below 0 and above 1."""
        return (*operating_caveats(self.rig), *ratio_caveats(friction_ratio=self.result["friction_ratio"].values))

    def figures(self) -> Mapping[str, Drawing]:
        """Friction over the keys that were swept."""
        listed = self.result["friction_ratio"].dims == ("point",)
        caption = _CLOUD_CAPTION if listed else _CAPTIONS.get(len(swept_variables(self.result)), _CLOUD_CAPTION)
        return {"sweep": Drawing(chart=lambda: sweep_chart(self.result), caption=caption)}

    def files(self) -> "Mapping[str, Path | xr.Dataset]":
        """Dataset, which the sweep itself has written where there is a folder."""
        return {"sweep.nc": self.result if self.folder is None else self.folder / "sweep.nc"}

    def page(self) -> Page:
        """Page `sweep.html`."""
        source = str(self.plan.content.get("source", ""))
        points, failures = int(self.result["friction_ratio"].size), self._failures()
        return Page(
            name="sweep",
            title=self.result.attrs["title"],
            settings=[
                ("rig", f"{self.result.attrs['rig']} ({self.rig.name})"),
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
        return amplitude_rows(self.rig)

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


def _plan(rig: Rig, over: Values, sample: str, points: int | None, seed: int) -> SweepPlan:
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
