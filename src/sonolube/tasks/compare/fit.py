"""Task `fit`: own measured runs against every model of friction under vibration, and what to measure next."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Unpack

from sonolube.measurement.run_columns import runs_help
from sonolube.report import Drawing
from sonolube.report.results import ranked_models
from sonolube.rig import Rig
from sonolube.tasks.answer import Answer, Block, Dataset, Table, answer
from sonolube.tasks.own_tables import MappedRuns, runs_of
from sonolube.tasks.parameters import File, OptionalRig, OwnRuns, Parameter, Watched, file_stem, optional_rig
from sonolube.tasks.progress import stage
from sonolube.tasks.task import task
from sonolube.validation import comparison
from sonolube.validation.runs_figures import runs_fit_chart
from sonolube.validation.runs_fit import RunsFit, fit_runs
from sonolube.validation.runs_tables import runs_fit_dataset

_CAPTION = (
    "Left: measured friction ratios of {runs} runs with their standard uncertainty, and the models of the least unseen"
    " error as curves. Right: root mean square errors of conditions that were left out of the fit, and of the fit."
)
_RUNS = File(runs_help("Own measured runs, a row each"), "RUNS.csv")


@task
def fit(
    runs: Annotated[OwnRuns, _RUNS],
    *,
    rig: OptionalRig = None,
    mapping: MappedRuns = None,
    model: Annotated[Sequence[str], Parameter("Only this model; may come again.", "NAME")] = (),
    **watch: Unpack[Watched],
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
    known, table = optional_rig(rig), runs_of(runs, mapping)
    with stage("fitting") as advance:
        result = fit_runs(table, known, models=comparison.compared_models(model), advance=advance)
    volts = None if known is None or "voltage_peak_to_peak" not in table else ranked_models.volts_per_amplitude(known)
    return FitAnswer(fit=result, rig=known, volts_per_amplitude=volts, name=f"{file_stem(runs)}-fit")


@answer
class FitAnswer(Answer):
    """Models ranked by the conditions that they predict unseen, with parameters, and the next condition to measure."""

    fit: RunsFit
    rig: Rig | None
    volts_per_amplitude: float | None
    name: str

    def blocks(self) -> Sequence[Block]:
        """Errors and parameters of each model, the verdict, models that do not apply, and what to measure."""
        table = self.fit.table
        scatter = "" if table.scatter is None else f", repeats scatter by {table.scatter:.3f}"
        return [
            f"{table.title}: {table.runs} runs under {len(table.conditions)} conditions{scatter}; errors of the ratio",
            Table(("model", "k", "unseen", "fit", "AICc", ""), ranked_models.error_rows(self.fit)),
            *ranked_models.parameter_lines(self.fit),
            f"  {self.fit.verdict}",
            *(ranked_models.next_line(one, self.volts_per_amplitude) for one in self.fit.next_conditions),
            *ranked_models.inapplicable_lines(self.fit),
        ]

    def object(self) -> dict[str, Any]:
        """Models with errors, parameters and predictions, the verdict and the next conditions."""
        return ranked_models.fit_object(self.fit)

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
