"""Task `compare`: models of friction under vibration against published tests, and on a rig."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Unpack

from sonolube.measurement.run_columns import runs_help
from sonolube.report import Drawing
from sonolube.report.results import model_comparison as results
from sonolube.rig import FrictionPoint, Rig, friction_point
from sonolube.tasks.answer import Answer, Block, Dataset, answer
from sonolube.tasks.own_tables import MappedRuns, runs_of
from sonolube.tasks.parameters import File, OptionalRig, Parameter, RunsSource, Watched, optional_rig
from sonolube.tasks.progress import stage
from sonolube.tasks.task import task
from sonolube.validation import comparison
from sonolube.validation.figures import comparison_figures, rig_chart
from sonolube.validation.rig_conditions import vibrated_rig
from sonolube.validation.run_conditions import RunsTable, run_conditions
from sonolube.validation.runs_comparison import RunsPrediction, predict_runs
from sonolube.validation.runs_figures import runs_prediction_chart
from sonolube.validation.tables import comparison_csv, comparison_dataset

_RUNS = File(runs_help("Own measured runs, which each model predicts as published tests fitted it"), "RUNS.csv")


@task
def compare(
    rig: OptionalRig = None,
    *,
    model: Annotated[Sequence[str], Parameter("Only this model; may come again.", "NAME")] = (),
    runs: Annotated[RunsSource, _RUNS] = None,
    mapping: MappedRuns = None,
    **watch: Unpack[Watched],
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
    known, own_runs = optional_rig(rig), runs_of(runs, mapping)
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
