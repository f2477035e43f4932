"""Command `fit`: own measured runs against every model of friction under vibration, and what to measure next."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Annotated, Any

import typer
import xarray as xr

from sonolube.cli.console.answer import Answer, deliver
from sonolube.cli.console.options import OUT, Amplitude, Changes, Json, Out, measured_runs, optional_rig
from sonolube.cli.console.outputs import OutputFolder
from sonolube.cli.console.progress import progress
from sonolube.compilation import few_points
from sonolube.measurement.measured_runs import runs_help
from sonolube.report import Drawing
from sonolube.rig import Rig, steady_vibration
from sonolube.units import format_si
from sonolube.validation.comparison import FittedParameter, compared_models
from sonolube.validation.ranked_models import RankedModel
from sonolube.validation.runs_figures import runs_fit_figure
from sonolube.validation.runs_fit import RunsFit, fit_runs
from sonolube.validation.runs_tables import runs_fit_dataset
from sonolube.validation.separating_condition import NextCondition
from sonolube.validation.tables import parameter_text

_CAPTION = (
    "Left: measured friction ratios of {runs} runs with their standard uncertainty, and the models of the least unseen"
    " error as curves. Right: root mean square errors of conditions that were left out of the fit, and of the fit."
)


@few_points()
def fit(
    runs: Annotated[Path, typer.Argument(metavar="RUNS.csv", help=runs_help("Own measured runs, a row each"))],
    rig: Annotated[
        Path | None,
        typer.Option(
            metavar="RIG.toml",
            help="The rig: roughness and contact for models that need them, the amplitude of a voltage, and what the"
            " runs do not state.",
        ),
    ] = None,
    models: Annotated[
        list[str] | None, typer.Option("--model", metavar="NAME", help="Only this model; may come again.")
    ] = None,
    amplitude: Amplitude = None,
    changes: Changes = None,
    out: Annotated[Out, OutputFolder("{runs}-fit.*")] = OUT,
    json: Json = False,
) -> None:
    """Own runs against every applicable model: ranked by what each predicts unseen, and what to measure next.

    Example: sonolube fit examples/tribometer-runs.csv --rig examples/rigs/tribometer.toml
    """
    known = optional_rig(rig, changes=changes, amplitude=amplitude)
    table = measured_runs(runs)
    with progress("fitting") as advance:
        result = fit_runs(table, known, models=compared_models(models or ()), advance=advance)
    volts = None if known is None or "voltage_peak_to_peak" not in table else _volts_per_amplitude(known)
    answer = FitAnswer(result=result, rig=known, volts_per_amplitude=volts, name=f"{runs.stem}-fit")
    deliver(answer, folder=out, as_json=json)


@dataclass(frozen=True, kw_only=True)
class FitAnswer(Answer):
    """Models ranked by the conditions that they predict unseen, with parameters, and the next condition to measure."""

    result: RunsFit
    rig: Rig | None
    volts_per_amplitude: float | None
    name: str

    def lines(self) -> list[str]:
        """Errors and parameters of each model, the verdict, models that do not apply, and what to measure."""
        table, models = self.result.table, self.result.models
        width = max((len(model.name) for model in models), default=0)
        scatter = "" if table.scatter is None else f", repeats scatter by {table.scatter:.3f}"
        return [
            f"{table.title}: {table.runs} runs under {len(table.conditions)} conditions{scatter}; errors of the ratio",
            f"  {'model':<{width}}  k  unseen     fit    AICc",
            *(line for model in models for line in self._model_lines(model, width)),
            f"  {'mean of the other conditions':<{width}}  0  {self.result.rms_of_mean:6.3f}",
            f"  {self.result.verdict}",
            *(f"  measure next: {_next_text(one, self.volts_per_amplitude)}" for one in self.result.next_conditions),
            *(f"  not applicable: {line}" for line in self._inapplicable()),
        ]

    def object(self) -> dict[str, Any]:
        """Models with errors, parameters and predictions, the verdict and the next conditions."""
        table = self.result.table
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
            "models": [self._model_object(model) for model in self.result.models],
            "rms_of_mean": self.result.rms_of_mean,
            "verdict": self.result.verdict,
            "decided": self.result.is_decided,
            "measure_next": [_next_object(one) for one in self.result.next_conditions],
            "not_applicable": self.result.inapplicable,
        }

    def caveats(self) -> Sequence[str]:
        """Runs that were left out or are copies, and the direction that is taken for the vibration."""
        conditions = self.result.table.conditions
        taken: tuple[str, ...] = ()
        if all(one.vibration_direction is None for one in conditions):
            taken = ("the vibration is taken to be along the normal; vibration_direction [deg] says otherwise",)
        return (*self.result.table.caveats, *taken)

    def figures(self) -> Mapping[str, Drawing]:
        """Measured ratios with the best models, and the errors of all."""
        if not self.result.models:
            return {}
        caption = _CAPTION.format(runs=self.result.table.runs)
        return {self.name: Drawing(draw=lambda: runs_fit_figure(self.result), caption=caption)}

    def files(self) -> Mapping[str, xr.Dataset]:
        """Every ratio, error and parameter as netCDF."""
        return {f"{self.name}.nc": runs_fit_dataset(self.result)} if self.result.models else {}

    def _model_lines(self, model: RankedModel, width: int) -> Iterator[str]:
        """Errors of a model, then its parameters."""
        aicc = "" if model.aicc is None else f"{model.aicc:.1f}"
        missed = len(self.result.table.conditions) - model.reached
        about = "  tied" if model.tied else f"  out of range: {missed} conditions" if missed else ""
        yield (
            f"  {model.name:<{width}} {len(model.parameters):>2}  {model.rms_unseen:6.3f}  {model.rms_fit:6.3f}"
            f"  {aicc:>6}{about}".rstrip()
        )
        for parameter in model.parameters:
            yield f"      {parameter_text(parameter, left_out='one condition')}"

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
        for name, reason in self.result.inapplicable.items():
            reasons.setdefault(reason, []).append(name)
        for reason, names in reasons.items():
            yield f"{', '.join(names)}: {reason}"


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
