"""Task `sweep`: a rig over any of its parameters, on a grid, in a list or drawn, or over one standard quantity.

Over one quantity: friction over voltage, amplitude, speed, frequency, waveform or load, and power over frequency.
"""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from glob import escape
from pathlib import Path
from typing import Annotated, Any, Literal, Unpack

import numpy as np

from sonolube import design, rig as rigs
from sonolube.charts import Chart
from sonolube.checks import Floats, require_positive
from sonolube.design import SweepPlan, grid_plan, latin_hypercube_plan, list_plan, sweep_chart, swept_variables
from sonolube.design.point_statistics import failure_counts
from sonolube.design.predicted_results import PredictedColumns, with_predictions
from sonolube.design.sweep_plan import OPERATING_CONDITIONS
from sonolube.errors import InvalidInput
from sonolube.measurement.run_columns import runs_help
from sonolube.models.friction.models.range_check import ratio_caveats
from sonolube.prediction.evidence_posterior import EvidencePosterior
from sonolube.prediction.predicted_points import PredictedRig, predicted_rig
from sonolube.report import Drawing, Page
from sonolube.report.results.design import sweep as results
from sonolube.report.results.design.predicted_points import (
    predicted_blocks,
    predicted_object,
    predicted_tables,
    verdict_lines,
)
from sonolube.report.results.record_object import amplitude_object, amplitude_rows, friction_model_text
from sonolube.report.results.rig_point import own_point_lines, own_point_object
from sonolube.rig.resolved_rig import resolved_rig
from sonolube.storage.files import expect_files
from sonolube.tasks.answer import Answer, Block, Dataset, Rows, answer
from sonolube.tasks.own_evidence import Evidence, evidence_of
from sonolube.tasks.own_tables import MappedRuns, Values, ends_by_key, refuse_replaced, runs_of, values_by_key
from sonolube.tasks.parameters import File, Keep, KeyValues, Parameter, RigFile, RunsSource, WatchedRig, kept, rig_of
from sonolube.tasks.progress import stage
from sonolube.tasks.task import refuse_unused, shown, task
from sonolube.text.units import format_si, to_si
from sonolube.vocabulary import unit_of

_POINTS_AT_RESONANCE = 41  # frequencies about each resonance
_MAX_POINTS = 10_000
_OF_STRUCTURE = ("frequency", "power", "waveform")  # studies of a computed motion


@dataclass(frozen=True, slots=True)
class _Range:
    """Function of a study in `rig`, its quantity, and its default range."""

    study: str
    quantity: str
    lowest: str
    highest: str
    points: int
    even_ratios: bool = False
    from_zero: bool = False


_RANGES = {
    "voltage": _Range("voltage_study", "voltage_peak_to_peak", lowest="0V", highest="200V", points=101, from_zero=True),
    "amplitude": _Range(
        "amplitude_study", "vibration_amplitude", lowest="0um", highest="10um", points=101, from_zero=True
    ),
    "speed": _Range("speed_study", "sliding_speed", lowest="1mm/s", highest="1m/s", points=61, even_ratios=True),
    "frequency": _Range("frequency_study", "frequency", lowest="1kHz", highest="100kHz", points=120),
    "power": _Range("least_power_study", "frequency", lowest="1kHz", highest="100kHz", points=60),
    "load": _Range("load_study", "normal_load", lowest="3N", highest="9N", points=25),
}


def parametric_study(
    rig: rigs.Rig,
    *,
    of: str,
    lowest: str | None,
    highest: str | None,
    points: int | None,
    voltages: Sequence[str],
    amplitudes: Sequence[str],
    runs: "Dataset | None" = None,
    evidence: EvidencePosterior | None = None,
) -> "ParametricStudyAnswer":
    """Study of a rig over one quantity, whose range has ends with units; default ones where None.

    `runs`: Own measured runs, on which the predicted friction ratio rests beside the published tests.
    `evidence`: Posterior by own published tests too, in place of the shipped one.
    """
    _require_studied(rig, of)
    curves = _curves(rig, of, voltages, amplitudes)
    if of == "waveform":
        if lowest or highest or points:
            raise InvalidInput(
                f"{shown('lowest')}, {shown('highest')} and {shown('points')} have no meaning for {shown('of')}"
                " waveform, which runs over names"
            )
        run: Callable[..., Dataset] = partial(rigs.waveform_study, rig)
    else:
        usual = _RANGES[of]
        values = {usual.quantity: _values(rig, of, lowest, highest, points)}
        own = {"friction_ratio": _present_ratio(rig)} if of == "power" else {}
        run = partial(getattr(rigs, usual.study), rig, **values, **curves, **own)
    with stage("sweeping") as advance:
        result = run(advance=lambda done, total: advance(of, done, total))
    predicted = _predicted_rig(rig, result["status"].size, runs, evidence)
    answer = ParametricStudyAnswer(rig=rig, of=of, study=with_predictions(result, predicted), predicted=predicted)
    if result["friction_ratio"].isnull().all():
        raise InvalidInput(f"no point has a result: {next(iter(answer.failures()))}")
    return answer


@answer
class ParametricStudyAnswer(Answer):
    """Least friction over one quantity, and the points without a result."""

    rig: rigs.Rig
    of: str
    study: Dataset
    predicted: PredictedRig

    def blocks(self) -> Sequence[Block]:
        """Main results over the quantity, and the points without a result."""
        points, load = self.study["status"].size, format_si(self.rig.normal_load, "N")
        return [
            f"{self.rig.title}, {load}, {points} points, {friction_model_text(self.rig)}",
            *own_point_lines(self.rig),
            *verdict_lines(self.study),
            Rows([*amplitude_rows(self.rig), *results.rows(self.study, self.of)]),
            *[f"  without result: {count} of {points}: {reason}" for reason, count in self.failures().items()],
            *predicted_blocks(self.study, self.predicted),
        ]

    def object(self) -> dict[str, Any]:
        """Point of least friction of each curve, and the points without a result."""
        return {
            "rig": self.rig.title,
            "study": self.of,
            "friction_model": self.rig.friction_model.name,
            **amplitude_object(self.rig),
            **own_point_object(self.rig),
            **predicted_object(self.study, self.predicted),
            "least_friction": results.best_objects(self.study),
            "points": int(self.study["status"].size),
            "without_result": results.failure_objects(self.failures()),
        }

    @property
    def _name(self) -> str:
        return f"{self.rig.name}-{self.of}"

    def caveats(self) -> Sequence[str]:
        """Caveats of the rig at its own operating point, of ratios, and of the prediction."""
        return (
            *rigs.operating_caveats(self.rig),
            *ratio_caveats(friction_ratio=self.study["friction_ratio"].values),
            *self.predicted.caveats(self.study["verdict"].values),
        )

    def figures(self) -> Mapping[str, Drawing]:
        """Figure of the study."""

        def chart() -> Chart:
            return replace(rigs.STUDY_CHARTS[self.of](self.study), title=self.study.attrs["rig"])

        return {self._name: Drawing(chart=chart)}

    def files(self) -> Mapping[str, Dataset]:
        """Every point as netCDF."""
        return {f"{self._name}.nc": self.study}

    def failures(self) -> dict[str, int]:
        """Number of points without a result, by the reason."""
        return failure_counts(self.study, outcome="friction_ratio")


def _curves(rig: rigs.Rig, of: str, voltages: Sequence[str], amplitudes: Sequence[str]) -> dict[str, Any]:
    """Voltages or amplitudes of the curves of a study by name; empty where none are given."""
    if voltages and of not in ("speed", "frequency"):
        raise InvalidInput(f"{shown('voltage')} has no meaning for {shown('of')} {of}; it is for speed and frequency")
    if amplitudes and of != "speed":
        raise InvalidInput(f"{shown('vibration')} has no meaning for {shown('of')} {of}; it is for speed")
    own = rigs.commanded_quantity(rig)
    name, texts, others = (
        ("voltage", voltages, amplitudes) if own is rigs.VOLTAGE else ("vibration", amplitudes, voltages)
    )
    if others:
        raise InvalidInput(f"{rig.title}: its {own.word} sets its vibration; give {shown(name)} of each curve")
    if not texts:
        return {}
    read = [to_si(text, unit=own.unit, name=shown(name)) for text in texts]
    return {own.name: require_positive(**{own.name: read})}


def studies_of(rig: rigs.Rig) -> list[str]:
    """Names of the studies over one quantity that a rig has."""
    found = []
    for name in _RANGES | {"waveform": None}:
        with suppress(InvalidInput):
            _require_studied(rig, name)
            found.append(name)
    return found


def _require_studied(rig: rigs.Rig, of: str) -> None:
    """Raise if a rig lacks the structure that a study computes, or another quantity sets its vibration."""
    resolved = resolved_rig(rig)
    own = rigs.commanded_quantity(resolved)
    if of in (rigs.VOLTAGE.word, rigs.AMPLITUDE.word) and of != own.word:
        why = "has no drive voltage" if own is rigs.AMPLITUDE else "has a drive voltage, which sets its amplitude"
        raise InvalidInput(f"{rig.title} {why}: take {shown('of')} {own.word}")
    if of in _OF_STRUCTURE:
        _ = resolved.moved  # which refuses a rig without a structure that moves it
    elif of != "speed":
        _ = resolved.vibration  # which refuses a rig without an amplitude


def _values(rig: rigs.Rig, of: str, lowest: str | None, highest: str | None, points: int | None) -> Floats:
    """Values that a study runs over."""
    usual = _RANGES[of]
    unit = unit_of(usual.quantity)
    low = to_si(lowest or usual.lowest, unit=unit, name=shown("lowest"))
    high = to_si(highest or usual.highest, unit=unit, name=shown("highest"))
    if low < 0 or (low == 0 and not usual.from_zero) or low >= high:
        floor = f"not lie below 0 {unit}" if usual.from_zero else f"lie above 0 {unit}"
        raise InvalidInput(
            f"{shown('lowest')} {lowest or usual.lowest} must {floor} and must lie below {shown('highest')}"
            f" {highest or usual.highest}"
        )
    count = usual.points if points is None else points
    if not 2 <= count <= _MAX_POINTS:
        raise InvalidInput(f"{shown('points')} {count} must lie between 2 and {_MAX_POINTS} for {shown('of')} {of}")
    if of in ("frequency", "power"):
        return rigs.frequency_grid(rig, lowest=low, highest=high, points=count, resonance_points=_POINTS_AT_RESONANCE)
    return np.geomspace(low, high, count) if usual.even_ratios else np.linspace(low, high, count)


def _present_ratio(rig: rigs.Rig) -> float:
    """Friction ratio of the rig as it is driven."""
    own = rigs.operating_points(rig)
    if bool(own.failed):
        raise InvalidInput(f"{rig.title} has no friction ratio of its own to be had elsewhere: {own.reason}")
    return float(own.friction_ratio)


_OVER = KeyValues(
    "A key of the file with its values: first:last:count, first:last:count:log or one,two,...;"
    " first:last alone for the sample lhs. May come again.",
    "KEY=VALUES",
)
_RUNS = File(
    runs_help("Own measured runs, on which the predicted friction ratio rests beside the published tests. Columns"),
    "RUNS.csv",
    option="--runs --measured",
)
_CAPTIONS = {1: "Results of the rig over the key that was swept.", 2: "Friction over both keys that were swept."}
_CLOUD_CAPTION = (
    "Friction over each key that was swept, at all values of the others: points, at most 3000 of them, their median,"
    " and the interval of 90 %."
)
# arguments without meaning for one quantity
_PREDICTED_KEYS = (*OPERATING_CONDITIONS, rigs.AMPLITUDE.key)  # along which a prediction of the rig holds
_OVER_ONLY = ("sample", "seed", "workers", "scheduler", "chunk")
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
    runs: Annotated[RunsSource, _RUNS] = None,
    mapping: MappedRuns = None,
    evidence: Evidence = None,
    keep: Keep = None,
    **watch: Unpack[WatchedRig],
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
    measured, learned = runs_of(runs, mapping, known), evidence_of(evidence, known)
    if (of is None) == (not over):
        raise InvalidInput(
            f"needs either {shown('over')}, keys with their values, or {shown('of')}, one quantity over its usual range"
        )
    if of is not None:
        refuse_unused(*_OVER_ONLY, because=f"for {shown('of')}")
        if (place := kept(keep, "")) is not None:
            expect_files(place, (f"{escape(known.name)}-{of}.*",))
        return parametric_study(
            known,
            of=of,
            lowest=lowest,
            highest=highest,
            points=points,
            voltages=voltage,
            amplitudes=vibration,
            runs=measured,
            evidence=learned,
        )
    refuse_unused(*_OF_ONLY, because=f"for {shown('over')}")
    refuse_replaced(known, over or {})
    if sample != "lhs":
        refuse_unused("seed", because=f"for {shown('sample')} {sample}, which draws nothing; it is for lhs")
    if scheduler not in (None, "local"):
        refuse_unused("workers", because=f"for a {shown('scheduler')} at an address, which has its own")
    plan = _plan(known, over or {}, sample, points, seed)
    folder = kept(keep, f"{known.name}-sweep-{plan.digest[:8]}")
    if folder is not None:
        expect_files(folder, _FILES)
    predicted = _predicted(plan, known, measured, learned)
    with stage("sweeping") as advance:
        result = design.sweep(
            plan,
            folder=folder,
            advance=lambda done, total: advance("points", done, total),
            chunk_points=chunk,
            workers=workers,
            scheduler=scheduler,
            further=None if isinstance(predicted, str) else PredictedColumns(predicted),
        )
    return SweepAnswer(rig=known, plan=plan, result=result, folder=folder, predicted=predicted)


def _predicted(
    plan: SweepPlan, rig: rigs.Rig, runs: "Dataset | None", evidence: EvidencePosterior | None
) -> PredictedRig | str:
    """Prediction of the rig of a sweep; why there is none where its points are of other rigs."""
    others = [key for key in plan.values if key not in _PREDICTED_KEYS]
    if not others:
        return _predicted_rig(rig, plan.points, runs, evidence)
    reason = (
        f"{others[0]} changes the rig, and a prediction is of one rig at other"
        f" {', '.join(key.rpartition('.')[2].replace('_', ' ') for key in _PREDICTED_KEYS)}"
    )
    if runs is not None:
        raise InvalidInput(f"{shown('runs')} has no meaning here: {reason}")
    refuse_unused("evidence", because=f"here: {reason}")
    return reason


def _predicted_rig(
    rig: rigs.Rig, points: int, runs: "Dataset | None", evidence: EvidencePosterior | None
) -> PredictedRig:
    """Prediction of the rig at its points; evidence that it does not rest on is refused."""
    found = predicted_rig(rig, points=points, runs=runs, evidence=evidence)
    if found.chances is None:
        refuse_unused("evidence", because=f"where nothing is predicted: {found.reason}")
    return found


@answer
class SweepAnswer(Answer):
    """Points of a sweep by status, reasons of those without a result, and the point of least friction."""

    rig: rigs.Rig
    plan: SweepPlan
    result: Dataset
    folder: Path | None
    predicted: PredictedRig | str

    def blocks(self) -> Sequence[Block]:
        """Number of points by status, failures, and the point of least friction."""
        title, *rest = results.sweep_blocks(self.rig, self.plan, self.result)
        if isinstance(self.predicted, str):
            return [title, *own_point_lines(self.rig), *rest, f"  not predicted: {self.predicted}"]
        leading = [*own_point_lines(self.rig), *verdict_lines(self.result)]
        return [title, *leading, *rest, *predicted_blocks(self.result, self.predicted)]

    def object(self) -> dict[str, Any]:
        """Number of points by status and by verdict, failures, and the point of least friction."""
        found = results.sweep_object(self.rig, self.plan, self.result) | own_point_object(self.rig)
        if isinstance(self.predicted, str):
            return found | {"prediction": {"runs": 0, "reason": self.predicted}}
        return found | predicted_object(self.result, self.predicted)

    def caveats(self) -> Sequence[str]:
        """Caveats of the rig at its own operating point, and the meaning of ratios below 0 and above 1."""
        own = (*rigs.operating_caveats(self.rig), *ratio_caveats(friction_ratio=self.result["friction_ratio"].values))
        if isinstance(self.predicted, str):
            return own
        return (*own, *self.predicted.caveats(self.result["verdict"].values))

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
        page = results.sweep_page(self.rig, self.plan, self.result)
        if isinstance(self.predicted, str):
            return page
        return replace(page, tables=[*page.tables, *predicted_tables(self.result, self.predicted)])


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
