"""Tasks `compare` and `fit`: models of friction under vibration against published tests, a rig and own runs."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Unpack

from sonolube.measurement.measured_runs import runs_text
from sonolube.measurement.run_columns import runs_help
from sonolube.report import Drawing
from sonolube.report.results import model_comparison as results
from sonolube.rig import FrictionPoint, Rig, friction_point
from sonolube.tasks.answer import Answer, Block, Dataset, Table, answer
from sonolube.tasks.own_tables import MappedRuns, required_runs, runs_of
from sonolube.tasks.parameters import (
    File,
    OptionalRig,
    OwnRuns,
    Parameter,
    RunsSource,
    WatchedRig,
    file_stem,
    optional_rig,
)
from sonolube.tasks.progress import stage
from sonolube.tasks.task import task
from sonolube.validation import comparison
from sonolube.validation.comparison import RunsPrediction, predict_runs
from sonolube.validation.figures import comparison_figures, rig_chart, runs_fit_chart, runs_prediction_chart
from sonolube.validation.model_variant import vibrated_rig
from sonolube.validation.run_conditions import RunsTable, run_conditions
from sonolube.validation.runs_fit import RunsFit, fit_runs
from sonolube.validation.tables import comparison_csv, comparison_dataset, runs_fit_dataset

_RUNS = File(runs_help("Own measured runs, which each model predicts as published tests fitted it"), "RUNS.csv")


@task
def compare(
    rig: OptionalRig = None,
    *,
    model: Annotated[Sequence[str], Parameter("Only this model; may come again.", "NAME")] = (),
    runs: Annotated[RunsSource, _RUNS] = None,
    mapping: MappedRuns = None,
    **watch: Unpack[WatchedRig],
) -> "ComparisonAnswer":
    """Models of friction under vibration against every published test: fitted, cross-validated, and on your rig.

    Example: sonolube compare examples/rigs/tribometer.toml --model asperity-stick-slip --model kinematic

    Examples
    --------
    >>> import sonolube as sl
    >>> answer = sl.compare(model=["kinematic"])
    >>> round(answer["rms"].item(), 2)  # error of the friction ratio of published tests
    0.25
    """
    known = optional_rig(rig)
    own_runs = runs_of(runs, mapping, known)
    point = None if known is None else vibrated_rig(known)
    table = None if own_runs is None else run_conditions(own_runs, known)
    with stage("comparing") as advance:
        fits = comparison.compare_models(comparison.compared_models(model), advance=advance)
        predictions = () if point is None else comparison.predict_rig(fits, point)
    return ComparisonAnswer(
        fits=fits,
        rig=known,
        own=None if known is None else friction_point(known),
        predictions=predictions,
        table=table,
        of_runs=() if table is None else predict_runs(fits, table),
    )


@answer
class ComparisonAnswer(Answer):
    """Errors of models on published tests, fitted and cross-validated, and their predictions of a rig."""

    fits: tuple[comparison.ComparedFit, ...]
    rig: Rig | None
    own: FrictionPoint | None
    predictions: tuple[comparison.RigPrediction, ...]
    table: RunsTable | None = None
    of_runs: tuple[RunsPrediction, ...] = ()

    def blocks(self) -> Sequence[Block]:
        """Errors and fitted parameters of each model, refused tests, and predictions of the rig."""
        return [
            *results.fit_blocks(self.fits),
            *(() if self.rig is None or self.own is None else results.rig_blocks(self.rig, self.own, self.predictions)),
            *(() if self.table is None else results.runs_blocks(self.table, self.of_runs)),
        ]

    def object(self) -> dict[str, Any]:
        """Errors, fitted parameters and predictions of each model, and the predictions of the rig."""
        content: dict[str, Any] = {
            "sets": dict(comparison.DATA_SETS),
            "only_predicted": dict(comparison.ONLY_PREDICTED),
            "models": list(map(results.model_object, self.fits)),
        }
        if self.table is not None:
            content["runs"] = results.runs_object(self.table, self.of_runs)
        if self.rig is None or self.own is None:
            return content
        return content | {"rig": results.rig_object(self.rig, self.own, self.predictions)}

    def caveats(self) -> Sequence[str]:
        """Those of the rig at its operating point, and of own runs."""
        own = () if self.own is None else self.own.caveats
        return own if self.table is None else (*own, *self.table.caveats)

    def figures(self) -> Mapping[str, Drawing]:
        """Predicted against measured ratios, ratios over speed and amplitude, and the predictions of the rig."""
        drawings = {}
        if any(one.assessment for one in self.fits):
            every = comparison_figures(lambda: self.fits)
            drawings = {figure.name: Drawing(chart=figure.chart, caption=figure.caption) for figure in every}
        if self.rig is not None and any(one.friction_ratio is not None for one in self.predictions):
            drawings["models-on-the-rig"] = Drawing(chart=lambda: rig_chart(self._dataset()))
        table = self.table
        if table is not None and any(one.rms is not None for one in self.of_runs):
            drawings["models-on-own-runs"] = Drawing(chart=lambda: runs_prediction_chart(self.of_runs, table))
        return drawings

    def files(self) -> "Mapping[str, str | Dataset]":
        """Errors as CSV, and every ratio as netCDF."""
        return {"models.csv": comparison_csv(self.fits), "models.nc": self._dataset()}

    def _dataset(self) -> Dataset:
        """Every ratio and error over models and tests, and the predictions of the rig."""
        labelled = comparison_dataset(self.fits, self.predictions)
        return labelled if self.rig is None else labelled.assign_attrs(rig=self.rig.title)


_CAPTION = (
    "Left: measured friction ratios of {runs} runs with their standard uncertainty, and the models of the least unseen"
    " error as curves. Right: root mean square errors of conditions that were left out of the fit, and of the fit."
)
_RUNS_TO_FIT = File(runs_help("Own measured runs, a row each"), "RUNS.csv")


@task
def fit(
    runs: Annotated[OwnRuns, _RUNS_TO_FIT],
    *,
    rig: OptionalRig = None,
    mapping: MappedRuns = None,
    model: Annotated[Sequence[str], Parameter("Only this model; may come again.", "NAME")] = (),
    **watch: Unpack[WatchedRig],
) -> "FitAnswer":
    """Own runs against every applicable model: ranked by what each predicts unseen, and what to measure next.

    Example: sonolube fit examples/tribometer-runs.csv --rig examples/rigs/tribometer.toml

    Examples
    --------
    >>> import sonolube as sl
    >>> runs, rig = "examples/tribometer-runs.csv", "examples/rigs/tribometer.toml"
    >>> answer = sl.fit(runs, rig=rig, model=["asperity-stick-slip", "kinematic"])
    >>> answer["rms_unseen"].values.round(2).tolist()  # error of the friction ratio of unseen runs, by model
    [0.07, 0.34]
    """
    known = optional_rig(rig)
    table = required_runs(runs, mapping, known)
    with stage("fitting") as advance:
        result = fit_runs(table, known, models=comparison.compared_models(model), advance=advance)
    volts = None if known is None or "voltage_peak_to_peak" not in table else results.volts_per_amplitude(known)
    name, read_as = f"{file_stem(runs)}-fit", runs_text(table)
    return FitAnswer(fit=result, rig=known, volts_per_amplitude=volts, name=name, read_as=read_as)


@answer
class FitAnswer(Answer):
    """Models ranked by the conditions that they predict unseen, with parameters, and the next condition to measure."""

    fit: RunsFit
    rig: Rig | None
    volts_per_amplitude: float | None
    name: str
    read_as: str = ""

    def blocks(self) -> Sequence[Block]:
        """Errors and parameters of each model, the verdict, models that do not apply, and what to measure."""
        table = self.fit.table
        scatter = "" if table.scatter is None else f", repeats scatter by {table.scatter:.3f}"
        return [
            *([self.read_as] if self.read_as else []),
            f"{table.title}: {table.runs} runs under {len(table.conditions)} conditions{scatter}; errors of the ratio",
            Table(("model", "k", "unseen", "fit", "AICc", ""), results.error_rows(self.fit)),
            *results.parameter_lines(self.fit),
            f"  {self.fit.verdict}",
            *(results.next_line(one, self.volts_per_amplitude) for one in self.fit.next_conditions),
            *results.inapplicable_lines(self.fit),
        ]

    def object(self) -> dict[str, Any]:
        """Models with errors, parameters and predictions, the verdict and the next conditions."""
        return results.fit_object(self.fit)

    def caveats(self) -> Sequence[str]:
        """Runs that were left out or are copies, and the direction that is taken for the vibration."""
        conditions = self.fit.table.conditions
        taken: tuple[str, ...] = ()
        if all(one.vibration_direction is None for one in conditions):
            taken = ("the vibration is taken to be along the normal; vibration_direction [deg] says otherwise",)
        return (*self.fit.table.caveats, *taken)

    def figures(self) -> Mapping[str, Drawing]:
        """Measured ratios with the best models, and the errors of all."""
        if not self.fit.models:
            return {}
        caption = _CAPTION.format(runs=self.fit.table.runs)
        return {self.name: Drawing(chart=lambda: runs_fit_chart(self.fit), caption=caption)}

    def files(self) -> Mapping[str, Dataset]:
        """Every ratio, error and parameter as netCDF."""
        return {f"{self.name}.nc": runs_fit_dataset(self.fit)} if self.fit.models else {}
