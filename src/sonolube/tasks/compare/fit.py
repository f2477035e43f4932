"""Task `fit`: own measured runs against every model of friction under vibration, and what to measure next."""

from collections.abc import Iterator, Mapping, Sequence
from math import isfinite
from typing import Annotated, Any

import xarray as xr

from sonolube.measurement.run_columns import runs_help
from sonolube.report import Drawing
from sonolube.rig import Rig, steady_vibration
from sonolube.tasks.answer import Answer, answer
from sonolube.tasks.blocks import Block, Table
from sonolube.tasks.own_tables import MappedRuns, runs_of
from sonolube.tasks.parameters import OptionalRig, OwnRuns, Parameter, Stop, Watch, file_stem, optional_rig
from sonolube.tasks.progress import stage
from sonolube.tasks.task import task
from sonolube.units import format_si
from sonolube.validation.comparison import FittedParameter, compared_models
from sonolube.validation.ranked_models import RankedModel
from sonolube.validation.runs_figures import runs_fit_chart
from sonolube.validation.runs_fit import RunsFit, fit_runs
from sonolube.validation.runs_tables import runs_fit_dataset
from sonolube.validation.separating_condition import NextCondition
from sonolube.validation.tables import parameter_text

_CAPTION = (
    "Left: measured friction ratios of {runs} runs with their standard uncertainty, and the models of the least unseen"
    " error as curves. Right: root mean square errors of conditions that were left out of the fit, and of the fit."
)
_RUNS = Parameter(help=runs_help("Own measured runs, a row each"), kind="RUNS.csv", is_file=True)


@task
def fit(
    runs: Annotated[OwnRuns, _RUNS],
    *,
    rig: OptionalRig = None,
    mapping: MappedRuns = None,
    model: Annotated[Sequence[str], Parameter(help="Only this model; may come again.", kind="NAME")] = (),
    progress: Watch = None,
    cancelled: Stop = None,
) -> "FitAnswer":
    """Own runs against every applicable model: ranked by what each predicts unseen, and what to measure next.

    Example: sonolube fit examples/tribometer-runs.csv --rig examples/rigs/tribometer.toml
    """
    known, table = optional_rig(rig), runs_of(runs, mapping)
    with stage("fitting") as advance:
        result = fit_runs(table, known, models=compared_models(model), advance=advance)
    volts = None if known is None or "voltage_peak_to_peak" not in table else _volts_per_amplitude(known)
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
        heads = ("model", "k", "unseen", "fit", "AICc", "")
        rows = [row for model in self.fit.models for row in self._model_rows(model)]
        mean = ("mean of the other conditions", "0", f"{self.fit.rms_of_mean:.3f}", "", "", "")
        return [
            f"{table.title}: {table.runs} runs under {len(table.conditions)} conditions{scatter}; errors of the ratio",
            Table(heads, [*rows, mean]),
            *(f"  {model.name}: {text}" for model in self.fit.models for text in _parameter_texts(model)),
            f"  {self.fit.verdict}",
            *(f"  measure next: {_next_text(one, self.volts_per_amplitude)}" for one in self.fit.next_conditions),
            *(f"  not applicable: {line}" for line in self._inapplicable()),
        ]

    def object(self) -> dict[str, Any]:
        """Models with errors, parameters and predictions, the verdict and the next conditions."""
        table = self.fit.table
        return {
            "runs": table.runs,
            "conditions": [
                {
                    "label": one.label,
                    "friction_ratio": one.friction_ratio,
                    "uncertainty": one.uncertainty,
                    "repeats": one.repeats,
                }
                for one in table.conditions
            ],
            "scatter": table.scatter,
            "models": [self._model_object(model) for model in self.fit.models],
            "rms_of_mean": self.fit.rms_of_mean,
            "verdict": self.fit.verdict,
            "decided": self.fit.is_decided,
            "measure_next": [_next_object(one) for one in self.fit.next_conditions],
            "not_applicable": self.fit.inapplicable,
        }

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

    def files(self) -> Mapping[str, xr.Dataset]:
        """Every ratio, error and parameter as netCDF."""
        return {f"{self.name}.nc": runs_fit_dataset(self.fit)} if self.fit.models else {}

    def _model_rows(self, model: RankedModel) -> Iterator[tuple[str, ...]]:
        """Errors of a model."""
        aicc = "" if model.aicc is None else f"{model.aicc:.1f}"
        missed = len(self.fit.table.conditions) - model.reached
        about = "tied" if model.tied else f"out of range: {missed} conditions" if missed else ""
        errors = f"{model.rms_unseen:.3f}", f"{model.rms_fit:.3f}"
        yield (model.name, f"{len(model.parameters)}", *errors, aicc, about)

    def _model_object(self, model: RankedModel) -> dict[str, Any]:
        """Model for JSON."""
        return {
            "name": model.name,
            "source": model.fit.variant.source,
            "rms_unseen": _finite(model.rms_unseen),
            "rms": _finite(model.rms_fit),
            "aicc": model.aicc,
            "probability": model.probability,
            "tied": model.tied,
            "conditions_in_range": model.reached,
            "fitted": [_parameter_object(parameter) for parameter in model.parameters],
            "unseen_ratio": list(model.unseen),
            "fitted_ratio": list(model.fitted),
        }

    def _inapplicable(self) -> Iterator[str]:
        """Each reason once, with the models."""
        reasons: dict[str, list[str]] = {}
        for name, reason in self.fit.inapplicable.items():
            reasons.setdefault(reason, []).append(name)
        for reason, names in reasons.items():
            yield f"{', '.join(names)}: {reason}"


def _parameter_texts(model: RankedModel) -> Iterator[str]:
    """Fitted parameters of a model."""
    for parameter in model.parameters:
        yield parameter_text(parameter, left_out="one condition")


def _parameter_object(fitted: FittedParameter) -> dict[str, Any]:
    """Fitted parameter for JSON."""
    return {
        "name": fitted.parameter.name,
        "value": fitted.value,
        "unit": fitted.parameter.unit,
        "interval": fitted.interval,
        "leave_one_out_range": fitted.leave_one_out_range,
        "at_bound": fitted.at_bound,
    }


def _volts_per_amplitude(rig: Rig) -> float | None:
    """Peak-to-peak voltage per amplitude along the normal, in V/m; None where the rig states no voltage."""
    volts = None if rig.drive is None else rig.drive.voltage_peak_to_peak
    amplitude = steady_vibration(rig).vibration_amplitude
    return None if volts is None or not amplitude > 0 else volts / amplitude


def _next_text(one: NextCondition, volts_per_amplitude: float | None) -> str:
    """Next condition in a sentence."""
    where, amplitude = ", beyond the runs" if one.is_beyond else "", one.condition.vibration_amplitude
    if volts_per_amplitude is not None and amplitude is not None:
        where = f" ({format_si(volts_per_amplitude * amplitude, 'V')} peak to peak){where}"
    return (
        f"{one.condition.settings}{where}: {one.first} has {one.first_ratio:.2f}, {one.second} {one.second_ratio:.2f},"
        f" {one.contrast:.1f} of their errors apart"
    )


def _next_object(one: NextCondition) -> dict[str, Any]:
    """Next condition for JSON."""
    return {
        "vibration_amplitude": one.condition.vibration_amplitude,
        "vibration_velocity": one.condition.vibration_velocity,
        "sliding_speed": one.condition.sliding_speed,
        "models": [one.first, one.second],
        "friction_ratios": [one.first_ratio, one.second_ratio],
        "contrast": one.contrast,
        "beyond_the_runs": one.is_beyond,
    }


def _finite(value: float) -> float | None:
    """Value, or None where JSON has no notation for it."""
    return value if isfinite(value) else None
